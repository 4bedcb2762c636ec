//! Columns, nearest lines, occlusion and pictures of a frame.

use bytemuck::Pod;
use casca_stage::canvas::Target;
use casca_stage::gpu::{Gpu, GpuError};
use casca_stage::kernel::{Bound, Kernel, among, filled};
use casca_stage::timing::Clock;
use casca_stage::wgpu::{Buffer, BufferUsages, TextureFormat};
use glam::Vec3;

use crate::buffers::Fragment;
use crate::gpu::context::{ContextPass, GpuContext};
use crate::gpu::culling::Seen;
use crate::gpu::error::LinesGpuError;
use crate::gpu::frame::{Frame, GpuFragment};
use crate::gpu::hidden::{Drawn, LineCulling};
use crate::gpu::nearest::{Nearest, Pixels};
use crate::gpu::picture::Picture;
use crate::gpu::rays::Rays;
use crate::gpu::set::GpuLines;
use crate::gpu::settings::{GpuAo, Settings};
use crate::gpu::shader::shader;
use crate::gpu::sides::GpuSides;
use crate::occlusion::sector_of;
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
    columns: Kernel,
    nearest: Nearest,
    context: ContextPass,
    estimate: Kernel,
    rays: Rays,
    /// For cells in parts, once there are some.
    split_rays: Option<Rays>,
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
        let raster = shader(
            gpu,
            "raster",
            concat!(
                include_str!("shaders/keys.wgsl"),
                include_str!("shaders/raster.wgsl"),
                include_str!("shaders/thick.wgsl")
            ),
        );
        let occlusion = shader(
            gpu,
            "occlusion",
            concat!(include_str!("shaders/receiver.wgsl"), include_str!("shaders/occlusion.wgsl")),
        );
        Ok(Self {
            columns: Kernel::new(gpu, &raster, "columns", &[0, 2, 3, 4, 5, 6, 7]),
            nearest: Nearest::new(gpu, &raster)?,
            context: ContextPass::new(gpu),
            estimate: Kernel::new(gpu, &occlusion, "estimate", &[0, 6, 7, 12, 15, 16, 17]),
            rays: Rays::new(gpu, false),
            split_rays: None,
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
        let of_samples = |s: &Settings| (s.samples, s.sets, s.seed, s.by_rays());
        settings.check()?;
        if of_samples(&settings) != of_samples(&self.settings) {
            self.samples = samples(gpu, &settings)?;
        }
        self.settings = settings;
        Ok(())
    }

    /// Whether lines that lie wholly behind nearer lines are left out: of large sets, at first.
    pub fn cull_lines(&mut self, culling: LineCulling) {
        self.nearest.culling = culling;
    }

    /// Computes a view of lines: columns of `seen.read` unless rays are taken, the nearest lines of
    /// `seen.drawn`, and the occlusion. `context` hides lines; it takes no part in the occlusion.
    ///
    /// Time: proportional to the vertices of the bundles, to the pixels that lines cross, and to
    /// the pixels with lines times the samples. Memory on the device: 56 bytes a pixel without
    /// antialiasing; with columns 80 bytes a column with 128 slices, 160 with 256.
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
        let antialiasing = self.settings.antialiasing;
        let (samples, layers) = (antialiasing.samples_of(view)?.size(), antialiasing.layers_of(view.size()));
        let (read, drawn) = (lines.chunks(&seen.read)?, lines.chunks(&seen.drawn)?);
        self.nearest.fit(gpu, (lines, &drawn), samples)?;
        let Some(frame) = &mut self.frame else { return Ok(()) };
        frame.colours = lines.coloured.then(|| lines.colours.clone());
        let frame = &*frame;
        let settings = &self.settings;
        let sides = lines.sides_for(settings)?;
        let is_split =
            settings.by_rays() && (lines.cells.is_split() || sides.is_some_and(GpuSides::is_split));
        if is_split && self.split_rays.is_none() {
            self.split_rays = Some(Rays::new(gpu, true));
        }
        let rays = self.split_rays.as_ref().filter(|_| is_split).unwrap_or(&self.rays);
        let storage = BufferUsages::STORAGE;
        let (read_list, drawn_list) = (filled(gpu, &read, storage)?, filled(gpu, &drawn, storage)?);
        let ao = filled(
            gpu,
            &[GpuAo::new(settings, layers, sides.map_or(0, GpuSides::tangents))],
            BufferUsages::UNIFORM,
        )?;
        let set: [Bound<'_>; 3] = [(2, &lines.vertices), (3, &lines.segments), (4, &lines.order)];
        if !settings.by_rays() {
            clock.stage(gpu, "columns", |encoder| {
                [&frame.bits, &frame.lengths].into_iter().for_each(|b| encoder.clear_buffer(b, 0, None));
                let bound = [(0, &frame.grid_lens), (5, &read_list), (6, &frame.bits), (7, &frame.lengths)];
                self.columns.run_groups(gpu, encoder, read.len(), &among(&[&set[..], &bound[..]].concat()));
            })?;
        }
        clock.stage(gpu, "context", |encoder| {
            self.context.draw(gpu, encoder, (&frame.lens, context), &frame.surfaces);
        })?;
        let pixels = Pixels {
            size: view.size(),
            has_samples: antialiasing.has_samples(),
            lens: &frame.lens,
            nearest: &frame.nearest,
            owners: &frame.owners,
            layers: &frame.layers,
            fragments: &frame.fragments,
            surfaces: &frame.surfaces,
        };
        clock.stage(gpu, "nearest lines", |encoder| {
            self.nearest.run(gpu, encoder, (lines, &drawn, &drawn_list), &pixels);
        })?;
        let receivers: [Bound<'_>; 4] =
            [(12, &frame.fragments), (15, &self.samples), (16, &ao), (17, &frame.occlusion)];
        let seen: [Bound<'_>; 2] = [(0, &frame.lens), (2, &lines.vertices)];
        let bound = [&receivers[..], &seen[..], &lines.cells.bound()[..]].concat();
        if let (Some(sides), Some(work)) = (sides, &frame.work) {
            rays.places.run(gpu, (sides, work), settings, (&bound, layers), clock)?;
            return Ok(());
        }
        clock.stage(gpu, "occlusion", |encoder| {
            if settings.by_rays() {
                rays.of_pixels(gpu, encoder, layers, &bound);
            } else {
                let bound: [Bound<'_>; 3] = [(0, &frame.grid_lens), (6, &frame.bits), (7, &frame.lengths)];
                let bound = [&receivers[..], &bound[..]].concat();
                self.estimate.run_pixels(gpu, encoder, layers, &among(&bound));
            }
        })?;
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

    /// The words of all columns, row by row: bit 0 of the first is the nearest slice.
    ///
    /// # Errors
    /// As [`Gpu::read_buffer`].
    pub fn read_columns(&self, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        self.read(gpu, |frame| &frame.bits)
    }

    /// The length in each group of slices of each column, row by row, in units of the scene.
    ///
    /// # Errors
    /// As [`Gpu::read_buffer`].
    pub fn read_lengths(&self, gpu: &Gpu) -> Result<Vec<f64>, GpuError> {
        let words: Vec<u64> = self.read(gpu, |frame| &frame.lengths)?;
        let range = self.frame.as_ref().map_or(0.0, |f| f.grid.depths()[1] - f.grid.depths()[0]);
        Ok(words.into_iter().map(|w| w as f64 * range / crate::gpu::numeric::LENGTH_UNITS).collect())
    }

    /// The nearest line of each pixel, row by row, as [`crate::buffers::LineBuffer`] has it. With
    /// antialiasing four layers follow each other: the line that the first sample of a pixel shows,
    /// then up to three others.
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

    /// How much was drawn of the last view.
    ///
    /// # Errors
    /// As [`Gpu::read_buffer`].
    pub fn read_drawn(&self, gpu: &Gpu) -> Result<Drawn, GpuError> {
        self.nearest.drawn(gpu)
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
    let make = if settings.by_rays() { SampleSets::spirals } else { SampleSets::new };
    let sets = make(settings.samples, settings.sets, settings.seed)?;
    let all = (0..sets.count()).flat_map(|i| sets.set(i));
    let flat: Vec<[f32; 4]> = all.map(|s| [s.at.x, s.at.y, s.area, sector_of(s) as f32]).collect();
    Ok(filled(gpu, &flat, BufferUsages::STORAGE)?)
}
