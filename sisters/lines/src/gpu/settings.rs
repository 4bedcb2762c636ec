//! What is computed, and what the shaders are told of it.

use bytemuck::{Pod, Zeroable};

use crate::gpu::antialiasing::Antialiasing;
use crate::gpu::error::LinesGpuError;
use crate::numeric::{USUAL_RAYS, USUAL_SIDE_RAYS};
use crate::occlusion::{AoOptions, Estimator};
use crate::view::View;

/// What is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The occlusion, by rays or places.
    pub ao: AoOptions,
    /// Rays of a pixel, or of a side of a place.
    pub samples: u32,
    /// Sets of their directions.
    pub sets: u32,
    /// Whether borders of lines are smooth.
    pub antialiasing: Antialiasing,
}

impl Settings {
    /// [`USUAL_RAYS`] rays from pixels, at tubes of a radius. Where lines stand still and the view
    /// moves, [`Self::of_places`] costs a tenth.
    pub fn new(radius: f32, line_radius: f32) -> Self {
        let ao = AoOptions::rays(radius, line_radius);
        Self { ao, samples: USUAL_RAYS, sets: 16, antialiasing: Antialiasing::None }
    }

    /// Rays from places along the lines: [`USUAL_SIDE_RAYS`] of a side of a place.
    pub fn of_places(radius: f32, line_radius: f32) -> Self {
        let ao = AoOptions::places(radius, line_radius);
        Self { ao, samples: USUAL_SIDE_RAYS, ..Self::new(radius, line_radius) }
    }

    /// Whether rays are sent from places along the lines.
    pub(super) fn by_places(&self) -> bool {
        matches!(self.ao.estimator, Estimator::Places { .. })
    }

    /// How far from the middle of a pixel, in units of the scene, lines can be that it shows: the
    /// side of a pixel at the farthest depth. A pixel shows a line where the ray through its centre
    /// meets no wall; the line itself is up to 0.71 pixels beside that ray, maybe behind the wall's
    /// edge. Rays need no reach: their cells hold all lines.
    pub fn reach(&self, view: &View) -> f32 {
        let pixel = view.pixel_size(view.depths()[1]);
        (pixel * (1.0 + self.antialiasing.beyond())) as f32
    }

    pub(super) fn check(&self) -> Result<(), LinesGpuError> {
        self.ao.check()?;
        self.antialiasing.check()
    }
}

/// `Ao` of rays.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub(super) struct GpuAo {
    radius: f32,
    tube: f32,
    sets: u32,
    samples: u32,
    size: [u32; 2],
    tangents: u32,
    solid: u32,
}

impl GpuAo {
    /// For a picture of a size; the tangents of places begin at a place of their buffer.
    pub(super) fn new(settings: &Settings, size: [u32; 2], tangents: u32) -> Self {
        let Settings { sets, samples, ao, .. } = *settings;
        let tube = ao.estimator.line_radius();
        Self { radius: ao.radius, tube, sets, samples, size, tangents, solid: ao.solid.into() }
    }
}
