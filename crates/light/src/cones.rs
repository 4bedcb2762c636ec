//! How light is gathered: the cones for a hemisphere, in rings around the normal, and how they
//! march.
//!
//! The hemisphere is cut into sectors without gaps or overlaps (the thesis' six cones cover 59 % of
//! it). A cone goes to the middle of a sector, with the same solid angle; its weight is the
//! integral of the cosine over the sector, divided by π. The weights add up to 1.

use std::f32::consts::{FRAC_PI_2, TAU};

use crate::error::LightError;
pub use crate::numeric::MOST_CONES;
use crate::numeric::{LEAST_STEP, NARROWEST};
use crate::volume::Volume;

/// How many cones gather diffuse light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ConeCount {
    /// One along the normal and five around it.
    #[default]
    Six,
    /// One, five and ten.
    Sixteen,
}

/// A cone around a normal along z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    /// Unit vector.
    pub direction: [f32; 3],
    /// Tangent of half its angle.
    pub slope: f32,
    /// Its share of diffuse light.
    pub share: f32,
}

impl ConeCount {
    /// Where rings end, as squares of sines, and the cones of each.
    fn rings(self) -> &'static [(f32, u32)] {
        match self {
            Self::Six => &[(0.25, 1), (1.0, 5)],
            Self::Sixteen => &[(0.08, 1), (0.42, 5), (1.0, 10)],
        }
    }

    /// The cones.
    pub fn cones(self) -> Vec<Cone> {
        let mut cones = Vec::new();
        let mut inner = 0.0_f32;
        for &(outer, count) in self.rings() {
            // Half of the ring's light comes from nearer to the normal.
            let tilt: f32 = if count == 1 { 0.0 } else { (0.5 * (inner + outer)).sqrt().asin() };
            let solid_angle = TAU * ((1.0_f32 - inner).sqrt() - (1.0 - outer).max(0.0).sqrt()) / count as f32;
            let half = (1.0 - solid_angle / TAU).acos().min(FRAC_PI_2);
            for i in 0..count {
                let (sin, cos) = (i as f32 * TAU / count as f32).sin_cos();
                let direction = [tilt.sin() * cos, tilt.sin() * sin, tilt.cos()];
                cones.push(Cone { direction, slope: half.tan(), share: (outer - inner) / count as f32 });
            }
            inner = outer;
        }
        cones
    }
}

/// How light is gathered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Cells along the longest axis: 16 to 512.
    pub resolution: u32,
    /// Length of a step in texels, a texel being half as wide as the cone: 0.1 to 5. The thesis'
    /// step factor, in diameters, is half of it. Light leaks through thin walls above 1.
    pub step: f32,
    /// How far cones gather, as a share of the grid's longest edge: 0.01 to 2.
    pub reach: f32,
    /// Cones of diffuse light.
    pub cones: ConeCount,
    /// Tangent of half the angle of the narrowest reflection: 0.001 to 1.
    pub aperture: f32,
    /// Whether voxels get light from other voxels: the second bounce.
    pub bounce: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            resolution: 128,
            step: 1.0,
            reach: 1.0,
            cones: ConeCount::Six,
            aperture: NARROWEST,
            bounce: true,
        }
    }
}

impl Settings {
    /// Refuses what is out of its range.
    pub(crate) fn check(&self) -> Result<(), LightError> {
        for (name, value, low, high) in [
            ("the step", self.step, LEAST_STEP, 5.0),
            ("the reach", self.reach, 0.01, 2.0),
            ("the aperture", self.aperture, 0.001, 1.0),
        ] {
            if !(low..=high).contains(&value) {
                return Err(LightError::Setting { name, value, low, high });
            }
        }
        Ok(())
    }

    /// How far cones gather, in cells.
    pub(crate) fn reach_cells(&self, volume: &Volume) -> f32 {
        self.reach * volume.dims.max_element() as f32
    }
}
