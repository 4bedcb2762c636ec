//! What can be chosen about a scene.

/// What can be chosen about a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneOptions {
    /// Random seed.
    pub seed: u64,
    /// Frames of the path.
    pub frames: usize,
    /// Multiplies the number of objects where the scene allows it; 1 is the standard.
    pub scale: f32,
    /// `Spheres` only: builds a closed bunker beside the scene.
    pub bunker: bool,
    /// `Spheres` only: small dynamic spheres inside the bunker, where nobody sees them.
    pub hidden_extra: usize,
    /// `Spheres` only: puts closed walls around the scene and as many static spheres
    /// beyond them, as densely as inside.
    pub beyond_walls: Option<usize>,
}

impl Default for SceneOptions {
    fn default() -> Self {
        Self { seed: 1, frames: 150, scale: 1.0, bunker: false, hidden_extra: 0, beyond_walls: None }
    }
}
