//! A lit scene on the device: its voxels, their light and its pictures, with what is to be done
//! again after a change (thesis 4.1.1).
//!
//! | change | done again |
//! |---|---|
//! | a light, or how cones march | light in voxels and mips |
//! | an object moved | the moving layer, both layers as one where it was and is, direct light where shadows may change, the second bounce where cones may read a change, mips |
//! | the scene | everything: make a new renderer |
//!
//! Changes of one frame add up. Light is only brought up to date in bricks that the picture can
//! read: see [`crate::reach`].

use bytemuck::{Pod, Zeroable};
use casca_scenes::lit::{self, LitScene};
use casca_stage::camera::Camera;
use casca_stage::canvas::Target;
use casca_stage::gpu::Gpu;
use casca_stage::timing::Clock;
use casca_stage::wgpu::{BindingResource, Buffer, BufferUsages, DownlevelFlags};
use glam::{Affine3A, Vec3};

use crate::cones::MOST_CONES;
pub use crate::cones::Settings;
use crate::data::{Geometry, Light, Triangle, lights_of, materials_of, sound};
use crate::device::filled;
use crate::error::{LightError, Part};
use crate::layers::Layers;
use crate::numeric::{LARGEST_HALF, MOST_SHADOW_PAIRS, STORAGE_BUFFERS, WIDEST_REFLECTION};
use crate::picture::{Layer, Picture};
use crate::reach::{Mask, Reach, beside, bricks_read, grown, shadows_change};
use crate::shading::{List, Shading};
use crate::volume::Volume;

/// The grid and the settings as the shaders take them.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct Uniform {
    dims: [u32; 3],
    cone_count: u32,
    bricks: [u32; 3],
    light_count: u32,
    sky: [f32; 3],
    pad: f32,
    step: f32,
    reach: f32,
    cell: f32,
    specular_floor: f32,
    cones: [[f32; 4]; MOST_CONES],
    shares: [[f32; 4]; MOST_CONES],
}

/// Bricks that an update worked on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Updated {
    /// With voxels, in all.
    pub bricks: usize,
    /// Whose voxels were made again.
    pub merged: usize,
    /// Whose direct light was.
    pub shaded: usize,
    /// Whose second bounce was.
    pub bounced: usize,
    /// Whose texels and mips were written.
    pub written: usize,
}

/// What changed since the last update.
#[derive(Debug, Clone, Copy)]
struct Changes {
    fixed: bool,
    moved: bool,
}

/// As errors name it.
const LIGHTS: Part = Part { name: "the list of lights", by: "lights" };

/// A lit scene on the device.
pub struct Renderer {
    /// How pictures are exposed: light times this is shown, and 1 is white.
    pub exposure: f32,
    volume: Volume,
    settings: Settings,
    geometry: Geometry,
    sky: [f32; 3],
    /// As the shaders take them.
    shining: Vec<Light>,
    /// Tangent of half the angle of the widest reflection; 0 if nothing reflects.
    widest: f32,
    uniform: Buffer,
    triangles: Buffer,
    materials: Buffer,
    lights: Buffer,
    layers: Layers,
    shading: Shading,
    picture: Picture,
    changes: Changes,
    /// An update began and did not end: buffers may be lost or hold anything.
    torn: bool,
    /// By brick: whether its direct light, its second bounce and its texels are up to date.
    shaded: Mask,
    bounced: Mask,
    written: Mask,
}

impl Renderer {
    /// Puts a scene on the device. Costs its triangles; voxels and light are made by the first
    /// [`Renderer::update`].
    ///
    /// # Errors
    /// A setting out of its range, a scene without triangles or with too many, and what the adapter
    /// lacks or cannot hold.
    pub fn new(gpu: &Gpu, scene: &LitScene, settings: Settings) -> Result<Self, LightError> {
        settings.check()?;
        if gpu.device.limits().max_storage_buffers_per_shader_stage < STORAGE_BUFFERS {
            return Err(LightError::Lacks("nine storage buffers for a shader"));
        }
        if !gpu.adapter.get_downlevel_capabilities().flags.contains(DownlevelFlags::VERTEX_STORAGE) {
            return Err(LightError::Lacks("storage buffers in vertex shaders"));
        }
        let volume = Volume::new(scene.bounds(), settings.resolution)?;
        let geometry = Geometry::new(scene, &volume)?;
        let layers = Layers::new(gpu, volume, &geometry.triangles, geometry.fixed)?;
        let shading = Shading::new(gpu, volume, layers.capacity())?;
        let materials = materials_of(scene);
        let lights = lights_of(&scene.lights, &volume);
        let no_brick = vec![false; volume.brick_count()];
        let new = Self {
            exposure: 1.0,
            settings,
            sky: sound(scene.sky, LARGEST_HALF),
            widest: if scene.materials.iter().any(|m| m.specular.max_element() > 0.0) {
                WIDEST_REFLECTION
            } else {
                0.0
            },
            uniform: filled(gpu, Part::of_cells("the grid"), &[Uniform::zeroed()], BufferUsages::UNIFORM)?,
            triangles: filled(
                gpu,
                Part { name: "the list of triangles", by: "triangles" },
                &geometry.triangles,
                BufferUsages::STORAGE,
            )?,
            materials: filled(
                gpu,
                Part { name: "the list of materials", by: "materials" },
                &materials,
                BufferUsages::STORAGE,
            )?,
            lights: filled(gpu, LIGHTS, &lights, BufferUsages::STORAGE)?,
            shining: lights,
            layers,
            shading,
            picture: Picture::new(gpu)?,
            changes: Changes { fixed: true, moved: false },
            torn: false,
            shaded: no_brick.clone(),
            bounced: no_brick.clone(),
            written: no_brick,
            volume,
            geometry,
        };
        new.write_uniform(gpu);
        Ok(new)
    }

    fn write_uniform(&self, gpu: &Gpu) {
        let cones = self.settings.cones.cones();
        let mut uniform = Uniform {
            dims: self.volume.dims.to_array(),
            cone_count: cones.len() as u32,
            bricks: self.volume.bricks().to_array(),
            light_count: self.shining.len() as u32,
            sky: self.sky,
            step: self.settings.step,
            reach: self.settings.reach_cells(&self.volume),
            cell: self.volume.cell,
            specular_floor: self.settings.aperture,
            ..Uniform::zeroed()
        };
        for (i, cone) in cones.iter().enumerate() {
            let [x, y, z] = cone.direction;
            (uniform.cones[i], uniform.shares[i]) = ([x, y, z, cone.slope], [cone.share, 0.0, 0.0, 0.0]);
        }
        gpu.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
    }

    /// The grid of voxels.
    pub fn volume(&self) -> &Volume {
        &self.volume
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The voxels.
    pub fn layers(&self) -> &Layers {
        &self.layers
    }

    /// The light of voxels.
    pub fn shading(&self) -> &Shading {
        &self.shading
    }

    /// Changes how light is gathered; the resolution stays as it is.
    ///
    /// # Errors
    /// A setting out of its range. The renderer then keeps the old ones.
    pub fn set_settings(&mut self, gpu: &Gpu, settings: Settings) -> Result<(), LightError> {
        settings.check()?;
        self.settings = Settings { resolution: self.settings.resolution, ..settings };
        self.write_uniform(gpu);
        self.light_changed();
        Ok(())
    }

    /// Changes the lights.
    ///
    /// # Errors
    /// The adapter has no buffer for so many.
    pub fn set_lights(&mut self, gpu: &Gpu, lights: &[lit::Light]) -> Result<(), LightError> {
        let lights = lights_of(lights, &self.volume);
        self.lights = filled(gpu, LIGHTS, &lights, BufferUsages::STORAGE)?;
        self.shining = lights;
        self.write_uniform(gpu);
        self.light_changed();
        Ok(())
    }

    /// Moves an object that may move. What leaves the grid has no voxels; it is still drawn.
    ///
    /// # Errors
    /// There is no such object, or it does not move.
    pub fn move_object(&mut self, gpu: &Gpu, object: usize, transform: Affine3A) -> Result<(), LightError> {
        let moved = self.geometry.move_object(object, transform, &self.volume)?;
        let at = (moved.start * size_of::<Triangle>()) as u64;
        gpu.queue.write_buffer(&self.triangles, at, bytemuck::cast_slice(&self.geometry.triangles[moved]));
        self.changes.moved = true;
        Ok(())
    }

    fn light_changed(&mut self) {
        self.shaded.fill(false);
        self.bounced.fill(false);
    }

    /// The bricks that a picture can read, if the boxes that its camera may see (in metres) are
    /// those that `sees` says.
    pub fn reach(&self, sees: &dyn Fn((Vec3, Vec3)) -> bool) -> Reach {
        let mut full = vec![false; self.volume.brick_count()];
        let mut seen = full.clone();
        self.layers.bricks().iter().for_each(|&brick| full[brick as usize] = true);
        for t in &self.geometry.triangles[self.geometry.fixed..] {
            // Slots follow moves only in the next update.
            if self.changes.moved {
                self.volume.bricks_of(t.corners(), &mut |brick| full[brick as usize] = true);
            }
            beside(&self.volume, t.corners(), self.settings.step, &mut seen);
        }
        for (brick, seen) in seen.iter_mut().enumerate() {
            *seen |= full[brick] && sees(self.volume.brick_box(brick as u32));
        }
        Reach::around(&self.volume, seen, self.bricks_read(), self.settings.bounce)
    }

    /// How far from its start's brick a cone reads, in bricks.
    fn bricks_read(&self) -> u32 {
        let slope = self.settings.cones.cones().iter().map(|c| c.slope).fold(self.widest, f32::max);
        bricks_read(self.settings.reach_cells(&self.volume), slope)
    }

    /// Marks the light that other voxels in these bricks may change: direct light where shadows may
    /// change, and the second bounce where cones may read a change.
    fn voxels_changed(&mut self, changed: &[u32]) {
        if changed.is_empty() {
            return;
        }
        let bricks = self.layers.bricks();
        let is_few = changed.len() * bricks.len() * self.shining.len() < MOST_SHADOW_PAIRS;
        let mut touched = vec![false; self.volume.brick_count()];
        changed.iter().for_each(|&b| touched[b as usize] = true);
        for &b in bricks {
            touched[b as usize] |= !is_few || shadows_change(&self.volume, &self.shining, changed, b);
        }
        touched.iter().zip(&mut self.shaded).for_each(|(t, shaded)| *shaded &= !t);
        let read = grown(touched, self.volume.bricks(), self.bricks_read());
        read.iter().zip(&mut self.bounced).for_each(|(r, bounced)| *bounced &= !r);
    }

    /// Brings voxels and light up to date: all light, or that in the bricks that a picture can read
    /// ([`Renderer::reach`]).
    ///
    /// # Errors
    /// What the adapter cannot hold; the device is lost. The next update then makes everything
    /// again.
    pub fn update(
        &mut self,
        gpu: &Gpu,
        reach: Option<&Reach>,
        clock: &mut Clock,
    ) -> Result<Updated, LightError> {
        if self.torn {
            self.changes = Changes { fixed: true, moved: true };
        }
        let updated = self.update_all(gpu, reach, clock);
        self.torn = updated.is_err();
        updated
    }

    fn update_all(
        &mut self,
        gpu: &Gpu,
        reach: Option<&Reach>,
        clock: &mut Clock,
    ) -> Result<Updated, LightError> {
        let merged = self.update_voxels(gpu, clock)?;
        self.voxels_changed(&merged);
        let everything = Reach::all(&self.volume);
        let reach = reach.unwrap_or(&everything);
        let bricks = self.layers.bricks();
        let those = |wanted: &Mask, done: &Mask| -> Vec<u32> {
            bricks.iter().copied().filter(|&b| wanted[b as usize] && !done[b as usize]).collect()
        };
        let to_shade = those(&reach.lit, &self.shaded);
        let to_bounce = if self.settings.bounce { those(&reach.gathered, &self.bounced) } else { Vec::new() };
        let updated = Updated {
            bricks: bricks.len(),
            merged: merged.len(),
            shaded: to_shade.len(),
            bounced: to_bounce.len(),
            written: 0,
        };
        if merged.is_empty() && to_shade.is_empty() && to_bounce.is_empty() {
            return Ok(updated);
        }
        // Opacity is written wherever it changed, for shadows; light where it can be read.
        let mut is_written = self.written.clone();
        bricks.iter().for_each(|&b| is_written[b as usize] = true);
        let mut changed = vec![false; self.volume.brick_count()];
        merged.iter().for_each(|&b| changed[b as usize] = true);
        let to_write = |b: &u32| is_written[*b as usize] && (reach.lit[*b as usize] || changed[*b as usize]);
        let to_write: Vec<u32> = (0..self.volume.brick_count() as u32).filter(to_write).collect();
        self.update_light(gpu, clock, [&to_shade, &to_bounce, &to_write])?;
        to_shade.iter().for_each(|&b| self.shaded[b as usize] = true);
        to_bounce.iter().for_each(|&b| self.bounced[b as usize] = true);
        to_write.iter().for_each(|&b| self.written[b as usize] = self.layers.slot(b).is_some());
        Ok(Updated { written: to_write.len(), ..updated })
    }

    /// Voxelizes what changed; returns the bricks whose voxels are others now.
    fn update_voxels(&mut self, gpu: &Gpu, clock: &mut Clock) -> Result<Vec<u32>, LightError> {
        let Changes { fixed, moved } = self.changes;
        if !(fixed || moved) {
            return Ok(Vec::new());
        }
        let mut changed = Vec::new();
        if moved {
            let capacity = self.layers.capacity();
            changed = self.layers.move_triangles(gpu, &self.geometry.triangles, self.geometry.fixed)?;
            if self.torn || self.layers.capacity() != capacity {
                self.shading.resize(gpu, self.layers.capacity())?;
                self.light_changed();
            }
        }
        if fixed {
            clock.stage(gpu, "voxelize fixed", |e| {
                self.layers.voxelize(gpu, e, false, &|b| self.resource(b))
            })?;
            changed.extend_from_slice(self.layers.bricks());
            // Bricks that lost their slot in a torn update are still written.
            changed.extend((0..self.written.len() as u32).filter(|&b| self.torn && self.written[b as usize]));
            changed.sort_unstable();
            changed.dedup();
        }
        clock.stage(gpu, "voxelize moving", |e| self.layers.voxelize(gpu, e, true, &|b| self.resource(b)))?;
        let full: Vec<u32> = changed.iter().copied().filter(|&b| self.layers.slot(b).is_some()).collect();
        let list = List::new(gpu, &full)?;
        clock.stage(gpu, "merge layers", |e| {
            self.layers.merge(gpu, e, &list.buffer, list.count, &|b| self.resource(b));
        })?;
        self.changes = Changes { fixed: false, moved: false };
        Ok(changed)
    }

    fn update_light(&self, gpu: &Gpu, clock: &mut Clock, lists: [&[u32]; 3]) -> Result<(), LightError> {
        let [to_shade, to_bounce, to_write] = [0, 1, 2].map(|i| List::new(gpu, lists[i]));
        let (to_shade, to_bounce, to_write) = (to_shade?, to_bounce?, to_write?);
        let others = &|b| self.resource(b);
        clock.stage(gpu, "shade", |e| self.shading.shade(gpu, e, &to_shade, others))?;
        if to_bounce.count > 0 {
            clock.stage(gpu, "write voxels", |e| self.shading.inject(gpu, e, &to_write, false, others))?;
            clock.stage(gpu, "mips", |e| self.shading.reduce(gpu, e, &to_write, others))?;
            clock.stage(gpu, "bounce", |e| self.shading.bounce(gpu, e, &to_bounce, others))?;
        }
        let with_bounce = self.settings.bounce;
        clock.stage(gpu, "write voxels", |e| self.shading.inject(gpu, e, &to_write, with_bounce, others))?;
        clock.stage(gpu, "mips", |e| self.shading.reduce(gpu, e, &to_write, others))?;
        Ok(())
    }

    /// Draws a picture of a layer, as large as the target.
    ///
    /// # Errors
    /// The adapter has no buffer as large; the device is lost.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        target: &Target,
        camera: &Camera,
        layer: Layer,
        clock: &mut Clock,
    ) -> Result<(), LightError> {
        self.picture.set(gpu, (camera, &self.volume), target.size(), (layer, self.exposure))?;
        let count = self.geometry.triangles.len();
        clock.stage(gpu, "G-buffer", |e| self.picture.draw_items(gpu, e, count, &|b| self.resource(b)))?;
        clock.stage(gpu, "cones", |e| self.picture.gather(gpu, e, &|b| self.resource(b)))?;
        clock.stage(gpu, "show", |e| self.picture.show(gpu, e, target))?;
        Ok(())
    }

    /// The light of the last picture: see [`Picture::read`].
    ///
    /// # Errors
    /// The device is lost.
    pub fn read_light(&self, gpu: &Gpu) -> Result<Vec<[f32; 4]>, LightError> {
        self.picture.read(gpu)
    }

    fn resource(&self, binding: u32) -> Option<BindingResource<'_>> {
        match binding {
            0 => Some(self.uniform.as_entire_binding()),
            5 => Some(self.lights.as_entire_binding()),
            20 => Some(self.triangles.as_entire_binding()),
            21 => Some(self.materials.as_entire_binding()),
            other => self.layers.resource(other).or_else(|| self.shading.resource(other)),
        }
    }
}
