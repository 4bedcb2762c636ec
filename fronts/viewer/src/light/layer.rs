//! What pictures show.

/// What a picture shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Layer {
    /// All light.
    #[default]
    Picture,
    /// What surfaces scatter of light.
    Albedo,
    /// Normals, from -1 to 1 as 0 to 1.
    Normals,
    /// Emission, and light straight from lights and lamps.
    Direct,
    /// Light of the sky and of all bounces.
    Indirect,
    /// What surfaces mirror.
    Mirrored,
}

impl Layer {
    /// All of them.
    pub const EVERY: [Self; 6] =
        [Self::Picture, Self::Albedo, Self::Normals, Self::Direct, Self::Indirect, Self::Mirrored];

    /// Its name on command lines and in file names.
    pub fn name(self) -> &'static str {
        match self {
            Self::Picture => "picture",
            Self::Albedo => "albedo",
            Self::Normals => "normals",
            Self::Direct => "direct",
            Self::Indirect => "indirect",
            Self::Mirrored => "mirrored",
        }
    }
}
