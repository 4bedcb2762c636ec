/// What can be chosen about a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneOptions {
    /// Random seed.
    pub seed: u64,
    /// Frames of the path.
    pub frames: usize,
    /// Multiplies the number of objects where the scene allows it; 1 is the standard.
    pub scale: f32,
    /// `Spheres` only: builds a closed bunker beside the scene, with as many small dynamic spheres
    /// inside, where nobody sees them.
    pub bunker: Option<usize>,
    /// `Spheres` only: puts closed walls around the scene and as many static spheres
    /// beyond them, as densely as inside.
    pub beyond_walls: Option<usize>,
}

impl Default for SceneOptions {
    fn default() -> Self {
        Self { seed: 1, frames: 150, scale: 1.0, bunker: None, beyond_walls: None }
    }
}
