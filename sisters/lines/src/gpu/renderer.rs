//! The nearest lines, the occlusion and the pictures of a frame.

use bytemuck::Pod;
use casca_stage::canvas::Target;
use casca_stage::gpu::{Gpu, GpuError};
use casca_stage::kernel::{Bound, among, filled};
use casca_stage::timing::Clock;
use casca_stage::wgpu::{Buffer, BufferUsages, TextureFormat};
use glam::Vec3;

use crate::buffers::Fragment;
use crate::gpu::context::{ContextPass, GpuContext};
use crate::gpu::culling::Seen;
use crate::gpu::error::LinesGpuError;
use crate::gpu::frame::{Frame, GpuFragment};
use crate::gpu::lens::shader;
use crate::gpu::nearest::Nearest;
use crate::gpu::picture::Picture;
use crate::gpu::rays::Rays;
use crate::gpu::set::GpuLines;
use crate::gpu::settings::{GpuAo, Settings};
use crate::gpu::sides::GpuSides;
use crate::samples::SampleSets;
use crate::view::View;

/// How a picture looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Look {
    /// Lines in flat colours.
    Plain,
    /// Lit as tubes.
    Diffuse,
    /// Lit as tubes, darkened by their occlusion.
    Occluded,
    /// The occlusion alone: white in the open.
    Occlusion,
}

/// Draws lines.
pub struct Renderer {
    settings: Settings,
    nearest: Nearest,
    context: ContextPass,
    rays: Rays,
    picture: Picture,
    samples: Buffer,
    frame: Option<Frame>,
}

impl Renderer {
    /// Compiles the shaders, for pictures of a format.
    ///
    /// # Errors
    /// If a setting is out of its range, or the device has no room.
    pub fn new(gpu: &Gpu, format: TextureFormat, settings: Settings) -> Result<Self, LinesGpuError> {
        let text = concat!(include_str!("shaders/raster.wgsl"), include_str!("shaders/thick.wgsl"));
        let raster = shader(gpu, "raster", text);
        Ok(Self {
            nearest: Nearest::new(gpu, &raster)?,
            context: ContextPass::new(gpu),
            rays: Rays::new(gpu),
            picture: Picture::new(gpu, format),
            samples: samples(gpu, &settings)?,
            settings,
            frame: None,
        })
    }

    /// What is computed.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Changes what is computed. After an error the old settings stay.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn set_settings(&mut self, gpu: &Gpu, settings: Settings) -> Result<(), LinesGpuError> {
        let of_samples = |s: &Settings| (s.samples, s.sets);
        settings.check()?;
        if of_samples(&settings) != of_samples(&self.settings) {
            self.samples = samples(gpu, &settings)?;
        }
        self.settings = settings;
        Ok(())
    }

    /// Computes a view of lines: the nearest lines of `seen`, and the occlusion. `context` hides
    /// lines; it takes no part in the occlusion.
    ///
    /// Time: proportional to the vertices of the bundles, to the pixels that lines cross, and to
    /// the pixels with lines times the rays. Memory on the device: 56 bytes a pixel without
    /// antialiasing.
    ///
    /// # Errors
    /// If the device has no room or is lost, a bundle is not there, rays are to meet tubes thicker
    /// than the margin of the cells, or a depth of the view is more than
    /// [`FARTHEST`](crate::gpu::numeric::FARTHEST) times the range of its depths away.
    pub fn update(
        &mut self,
        gpu: &Gpu,
        view: &View,
        (lines, seen): (&GpuLines, &Seen),
        context: &[GpuContext],
        clock: &mut Clock,
    ) -> Result<(), LinesGpuError> {
        Frame::fit(&mut self.frame, gpu, view, &self.settings)?;
        let layers = self.settings.antialiasing.layers_of(view.size());
        let drawn = lines.chunks(&seen.drawn)?;
        let Some(frame) = &mut self.frame else { return Ok(()) };
        frame.colours = lines.coloured.then(|| lines.colours.clone());
        let frame = &*frame;
        let settings = &self.settings;
        let sides = lines.sides_for(settings)?;
        let drawn_list = filled(gpu, &drawn, BufferUsages::STORAGE)?;
        let ao = GpuAo::new(settings, layers, sides.map_or(0, GpuSides::tangents));
        let ao = filled(gpu, &[ao], BufferUsages::UNIFORM)?;
        clock.stage(gpu, "context", |encoder| {
            self.context.draw(gpu, encoder, (&frame.lens, context), &frame.surfaces);
        })?;
        clock.stage(gpu, "nearest lines", |encoder| {
            let chunks = (lines, &drawn_list, drawn.len());
            self.nearest.run(gpu, encoder, chunks, (frame, view.size()));
        })?;
        let receivers: [Bound<'_>; 4] =
            [(12, &frame.fragments), (15, &self.samples), (16, &ao), (17, &frame.occlusion)];
        let seen: [Bound<'_>; 2] = [(0, &frame.lens), (2, &lines.vertices)];
        let bound = [&receivers[..], &seen[..], &lines.cells.bound()[..]].concat();
        match (sides, &frame.work) {
            (Some(sides), Some(work)) => {
                self.rays.places.run(gpu, (sides, work), settings, (&bound, layers), clock)?
            }
            _ => clock.stage(gpu, "occlusion", |encoder| {
                self.rays.of_pixels(gpu, encoder, layers, &bound);
            })?,
        }
        Ok(())
    }

    /// Paints the last frame, and the background alone if there is none: before the first, and
    /// after one that the device had no room for. `strength` scales the occlusion.
    ///
    /// # Errors
    /// If the device is lost or out of memory.
    pub fn paint(
        &self,
        gpu: &Gpu,
        target: &Target,
        look: Look,
        strength: f32,
        background: Vec3,
        clock: &mut Clock,
    ) -> Result<(), LinesGpuError> {
        let [r, g, b] = background.to_array().map(f32::to_bits);
        let coloured = self.frame.as_ref().is_some_and(|f| f.colours.is_some());
        let words = [r, g, b, look as u32, strength.to_bits(), u32::from(coloured), 0, 0];
        let look = filled(gpu, &words, BufferUsages::UNIFORM)?;
        let none = filled(gpu, &[[0u32; 4]], BufferUsages::STORAGE)?;
        let bound = self.frame.as_ref().map(|frame| -> [Bound<'_>; 7] {
            [
                (0, &frame.lens),
                (9, &frame.owners),
                (12, &frame.fragments),
                (17, &frame.occlusion),
                (18, &look),
                (23, frame.colours.as_ref().unwrap_or(&none)),
                (28, &frame.layers),
            ]
        });
        clock.stage(gpu, "picture", |encoder| match (&self.frame, &bound) {
            (Some(frame), Some(bound)) => {
                let lookup = frame.surfaces.with(among(bound));
                self.picture.paint(gpu, encoder, (target, background), Some((&lookup, frame.has_samples())));
            }
            _ => self.picture.paint(gpu, encoder, (target, background), None),
        })?;
        Ok(())
    }

    /// The nearest line of each pixel, row by row, as [`crate::buffers::nearest_lines`] finds it.
    /// With antialiasing four layers follow each other: the line that the first sample of a pixel
    /// shows, then up to three others.
    ///
    /// # Errors
    /// As [`Gpu::read_buffer`].
    pub fn read_fragments(&self, gpu: &Gpu) -> Result<Vec<Option<Fragment>>, GpuError> {
        let all: Vec<GpuFragment> = self.read(gpu, |frame| &frame.fragments)?;
        let fragment = |f: &GpuFragment| {
            let (position, tangent) = (Vec3::from_array(f.position), Vec3::from_array(f.tangent));
            (f.line != u32::MAX).then_some(Fragment { position, tangent, line: f.line, along: f.along })
        };
        Ok(all.iter().map(fragment).collect())
    }

    /// The occlusion of each fragment, row by row and layer by layer.
    ///
    /// # Errors
    /// As [`Gpu::read_buffer`].
    pub fn read_occlusion(&self, gpu: &Gpu) -> Result<Vec<f32>, GpuError> {
        self.read(gpu, |frame| &frame.occlusion)
    }

    /// The values of places that the last frame computed; 0 with other estimators.
    ///
    /// # Errors
    /// As [`Gpu::read_buffer`].
    pub fn read_computed(&self, gpu: &Gpu) -> Result<u32, GpuError> {
        let work = self.frame.as_ref().and_then(|frame| frame.work.as_ref());
        work.map_or(Ok(0), |work| work.computed(gpu))
    }

    fn read<T: Pod>(&self, gpu: &Gpu, of: impl Fn(&Frame) -> &Buffer) -> Result<Vec<T>, GpuError> {
        let bytes = self.frame.as_ref().map_or(Ok(Vec::new()), |frame| gpu.read_buffer(of(frame)))?;
        Ok(bytemuck::pod_collect_to_vec(&bytes))
    }
}

fn samples(gpu: &Gpu, settings: &Settings) -> Result<Buffer, LinesGpuError> {
    settings.check()?;
    let sets = SampleSets::spirals(settings.samples, settings.sets)?;
    let flat: Vec<[f32; 2]> = sets.all().iter().map(|p| p.to_array()).collect();
    Ok(filled(gpu, &flat, BufferUsages::STORAGE)?)
}
