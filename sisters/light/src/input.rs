//! What goes in: triangles, materials, lights, the sky, the grid and the settings.

use glam::{Vec2, Vec3};

use crate::error::{LightError, bright, numbers, some_rays, way};
use crate::numeric::{ABSURD, FINEST, MOST_CELLS, OUTLIER};
use crate::texture::Texture;

/// A triangle. Its front is where its corners run counter-clockwise; both sides reflect and emit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triangle {
    /// Its corners, in metres.
    pub corners: [Vec3; 3],
    /// Index into [`Scene::materials`].
    pub material: u32,
}

/// Triangles that move together.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Object {
    /// The triangles. Those that are not finite or have no area are left out and counted.
    pub triangles: Vec<Triangle>,
    /// By triangle: where its corners lie in the texture of its material. A triangle beyond the end is
    /// as if its material had none.
    pub uv: Vec<[Vec2; 3]>,
}

impl From<Vec<Triangle>> for Object {
    fn from(triangles: Vec<Triangle>) -> Self {
        Self { triangles, uv: Vec::new() }
    }
}

/// What a surface does to light.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Material {
    /// The share of light that is scattered diffusely, by channel, 0 to 1.
    pub albedo: Vec3,
    /// Emitted radiance, in watts per square metre and steradian, by channel.
    pub emission: Vec3,
    /// Index into [`Scene::textures`]: its colours times `albedo` are the albedo, and light passes its
    /// holes.
    pub texture: Option<u32>,
}

impl Material {
    /// A material of an albedo and an emission, without a texture.
    pub const fn new(albedo: Vec3, emission: Vec3) -> Self {
        Self { albedo, emission, texture: None }
    }

    /// Whether its surfaces are lamps.
    pub(crate) fn emits(&self) -> bool {
        self.emission.max_element() > 0.0
    }
}

/// A light that is no surface of the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Light {
    /// A ball that shines into all directions.
    Point {
        /// Its centre, in metres.
        position: Vec3,
        /// Radiant intensity, in watts per steradian.
        intensity: Vec3,
        /// Its radius, in metres; 0 for sharp shadows.
        radius: f32,
    },
    /// A ball that shines into a cone.
    Spot {
        /// Its centre, in metres.
        position: Vec3,
        /// The axis of the cone, of any length but 0.
        direction: Vec3,
        /// Radiant intensity within the inner cone, in watts per steradian.
        intensity: Vec3,
        /// Half the angle of the full light, in radians.
        inner: f32,
        /// Half the angle beyond which there is none, in radians; not less than `inner`. Between
        /// both, the light falls by the smooth cubic of the cosine.
        outer: f32,
        /// Its radius, in metres; 0 for sharp shadows.
        radius: f32,
    },
    /// Light from far away.
    Sun {
        /// Where it travels to, of any length but 0.
        direction: Vec3,
        /// Irradiance of a surface that faces it, in watts per square metre.
        irradiance: Vec3,
        /// Half the angle that it is seen under, in radians, 0 to 1.5; 0 for sharp shadows.
        half_angle: f32,
    },
}

impl Light {
    /// A ball without size.
    pub const fn point(position: Vec3, intensity: Vec3) -> Self {
        Self::Point { position, intensity, radius: 0.0 }
    }

    /// The light, so many times as strong.
    pub fn scaled(mut self, factor: f32) -> Self {
        let (Self::Point { intensity: strength, .. }
        | Self::Spot { intensity: strength, .. }
        | Self::Sun { irradiance: strength, .. }) = &mut self;
        *strength *= factor;
        self
    }
}

/// The radiance from directions in which nothing is hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sky {
    /// The same from everywhere.
    Even(Vec3),
    /// Linear in the product of the direction with `up`, from -1 over 0 to 1.
    Gradient {
        /// The axis, of any length but 0.
        up: Vec3,
        /// Radiance at the zenith.
        zenith: Vec3,
        /// Radiance at the horizon.
        horizon: Vec3,
        /// Radiance at the nadir.
        nadir: Vec3,
    },
}

impl Sky {
    /// The radiance from a unit direction.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        match *self {
            Self::Even(radiance) => radiance,
            Self::Gradient { up, zenith, horizon, nadir } => {
                let height = direction.dot(up.normalize_or_zero()).clamp(-1.0, 1.0);
                horizon.lerp(if height > 0.0 { zenith } else { nadir }, height.abs())
            }
        }
    }

    pub(crate) fn check(&self) -> Result<(), LightError> {
        match *self {
            Self::Even(radiance) => bright("the sky", 0, radiance),
            Self::Gradient { up, zenith, horizon, nadir } => {
                way("the sky", 0, up)?;
                [zenith, horizon, nadir].iter().try_for_each(|c| bright("the sky", 0, *c))
            }
        }
    }
}

impl Default for Sky {
    /// Night.
    fn default() -> Self {
        Self::Even(Vec3::ZERO)
    }
}

/// What is lit.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scene {
    /// The surfaces.
    pub objects: Vec<Object>,
    /// What they are of.
    pub materials: Vec<Material>,
    /// What is painted on them.
    pub textures: Vec<Texture>,
    /// Lights that are no surfaces.
    pub lights: Vec<Light>,
    /// The light from outside.
    pub sky: Sky,
}

/// The grid: a box in cells. What is outside neither hides nor lights, and reflects nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// The least corner, in metres.
    pub min: Vec3,
    /// The greatest corner, in metres.
    pub max: Vec3,
    /// Cells along the longest axis, 1 to 512. Others have as many as cover the box.
    pub cells: u32,
}

impl Grid {
    /// The grid around all triangles; a cube of a metre around the origin if there are none.
    ///
    /// A triangle does not count if it has a corner a thousand times as far from the middle as the
    /// median triangle, or beyond 1e8 m. So one stray object does not swallow the others. Costs
    /// O(n log n) for n triangles.
    pub fn around(objects: &[Object], cells: u32) -> Self {
        let triangles = objects.iter().flat_map(|o| &o.triangles);
        // Not true of NaN.
        let is_near = |p: &Vec3| p.abs().cmple(Vec3::splat(ABSURD)).all();
        let finite: Vec<_> = triangles.filter(|t| t.corners.iter().all(is_near)).collect();
        let none = Self { min: Vec3::splat(-0.5), max: Vec3::splat(0.5), cells };
        let middle = Vec3::from_array([0, 1, 2].map(|axis| {
            let mut all: Vec<f32> = finite.iter().map(|t| t.corners[0][axis]).collect();
            median(&mut all)
        }));
        let far =
            |t: &Triangle| t.corners.iter().map(|p| (*p - middle).abs().max_element()).fold(0.0, f32::max);
        let mut reaches: Vec<f32> = finite.iter().map(|t| far(t)).collect();
        let most = median(&mut reaches) * OUTLIER;
        let corners = finite.iter().filter(|t| far(t) <= most).flat_map(|t| t.corners);
        let bounds = corners.fold(None, |b: Option<(Vec3, Vec3)>, p| {
            Some(b.map_or((p, p), |(min, max)| (min.min(p), max.max(p))))
        });
        bounds.map_or(none, |(min, max)| Self { min, max, cells })
    }

    pub(crate) fn check(&self) -> Result<(), LightError> {
        numbers("the cells of grid", 0, Vec3::splat(self.cells as f32), 1.0..=MOST_CELLS as f32)?;
        let size = self.max - self.min;
        let is_sound = self.min.is_finite()
            && size.is_finite()
            && size.min_element() >= 0.0
            && size.max_element() > f32::MIN_POSITIVE;
        let (min, max) = (self.min.to_array(), self.max.to_array());
        if is_sound { Ok(()) } else { Err(LightError::Box { min, max }) }
    }
}

fn median(values: &mut [f32]) -> f32 {
    values.sort_unstable_by(f32::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// A box of finer cells, around a point that may move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Its middle, in metres. A window that would reach beyond the box around it moves inwards, and
    /// its faces move to the next faces of cells there.
    pub middle: Vec3,
    /// Half of its edges, in metres. At most 512 of its cells along each axis.
    pub half: f32,
    /// Its cells along an edge of a cell around it: 2, 4, 8 or 16; the product of all windows is at
    /// most 16.
    pub finer: u32,
}

/// How a cache works.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The grid.
    pub grid: Grid,
    /// Finer cells around the eye, in a box, or in another one within it, too: see
    /// [`Cache::move_windows`](crate::Cache::move_windows).
    pub windows: [Option<Window>; 2],
    /// Rays of a question that no state answers, 1 to 4096.
    pub answer_rays: u32,
    /// Points of emissive triangles that are weighed for each state or question, 1 to 4096.
    pub lamp_points: u32,
    /// Shadow rays to them, 1 to 4096.
    pub lamp_rays: u32,
    /// Shadow rays to each light with a size, 1 to 4096.
    pub light_rays: u32,
}

impl Settings {
    /// No windows, 64 rays of a question, 512 weighed points and 32 shadow rays of lamps, and 8 of
    /// lights.
    pub const fn new(grid: Grid) -> Self {
        Self { grid, windows: [None; 2], answer_rays: 64, lamp_points: 512, lamp_rays: 32, light_rays: 8 }
    }

    pub(crate) fn check(&self) -> Result<(), LightError> {
        self.grid.check()?;
        check_windows(&self.grid, &self.windows)?;
        let counts = [
            ("answer_rays", self.answer_rays),
            ("lamp_points", self.lamp_points),
            ("lamp_rays", self.lamp_rays),
            ("light_rays", self.light_rays),
        ];
        counts.into_iter().try_for_each(|(what, value)| some_rays(what, value))
    }
}

impl Scene {
    pub(crate) fn check(&self) -> Result<(), LightError> {
        for (index, m) in self.materials.iter().enumerate() {
            numbers("the albedo of material", index, m.albedo, 0.0..=1.0)?;
            bright("the emission of material", index, m.emission)?;
            let count = self.textures.len();
            if let Some(number) = m.texture.map(|t| t as usize).filter(|t| *t >= count) {
                let of = format!("material {index}");
                return Err(LightError::Missing { of, what: "texture", number, count });
            }
        }
        for (object, o) in self.objects.iter().enumerate() {
            o.check(object, self.materials.len())?;
        }
        check_lights(&self.lights)?;
        self.sky.check()
    }
}

impl Object {
    pub(crate) fn check(&self, object: usize, count: usize) -> Result<(), LightError> {
        match self.triangles.iter().position(|t| t.material as usize >= count) {
            None => Ok(()),
            Some(triangle) => {
                let number = self.triangles[triangle].material as usize;
                let of = format!("triangle {triangle} of object {object}");
                Err(LightError::Missing { of, what: "material", number, count })
            }
        }
    }
}

pub(crate) fn check_windows(grid: &Grid, windows: &[Option<Window>]) -> Result<(), LightError> {
    let mut finest = 1;
    let mut cell = (grid.max - grid.min).max_element() / grid.cells as f32;
    for (index, window) in windows.iter().flatten().enumerate() {
        numbers("the middle of window", index, window.middle, -f32::MAX..=f32::MAX)?;
        if !window.finer.is_power_of_two() || !(2..=FINEST / finest).contains(&window.finer) {
            return Err(LightError::Finer { index, finer: window.finer, most: FINEST / finest });
        }
        finest *= window.finer;
        cell /= window.finer as f32;
        let most = 0.5 * MOST_CELLS as f32 * cell;
        numbers("half an edge of window", index, Vec3::splat(window.half), f32::MIN_POSITIVE..=most)?;
    }
    Ok(())
}

pub(crate) fn check_lights(lights: &[Light]) -> Result<(), LightError> {
    let most = -f32::MAX..=f32::MAX;
    for (index, light) in lights.iter().enumerate() {
        match *light {
            Light::Point { position, intensity, radius } => {
                numbers("the position of light", index, position, most.clone())?;
                bright("the intensity of light", index, intensity)?;
                numbers("the radius of light", index, Vec3::splat(radius), 0.0..=f32::MAX)?;
            }
            Light::Spot { position, direction, intensity, inner, outer, radius } => {
                numbers("the position of light", index, position, most.clone())?;
                way("the direction of light", index, direction)?;
                bright("the intensity of light", index, intensity)?;
                numbers("the outer angle of light", index, Vec3::splat(outer), 0.0..=std::f32::consts::PI)?;
                numbers("the inner angle of light", index, Vec3::splat(inner), 0.0..=outer)?;
                numbers("the radius of light", index, Vec3::splat(radius), 0.0..=f32::MAX)?;
            }
            Light::Sun { direction, irradiance, half_angle } => {
                way("the direction of light", index, direction)?;
                bright("the irradiance of light", index, irradiance)?;
                numbers("the half angle of light", index, Vec3::splat(half_angle), 0.0..=1.5)?;
            }
        }
    }
    Ok(())
}
