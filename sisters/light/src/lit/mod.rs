//! Lit scenes for tests and for programs that show light: triangles with materials, lights and a
//! camera.
//!
//! - [`Kind`]: generated scenes, such as the Cornell box.
//! - `casca-lit` reads glTF files with their materials and lights.
//! - [`path`]: what light reaches a camera, by a path tracer: the truth beside the cache.
//!
//! Units are metres and linear RGB. Surfaces are flat: each triangle has one normal and one
//! material, and looks the same from both sides, unless light passes it from its back. Panes are left
//! out: light passes them untinted and unbent, and they mirror nothing.

mod light;
pub mod path;
mod scenes;

#[cfg(test)]
mod tests;

use std::sync::Arc;

use glam::{Affine3A, Vec2, Vec3};

use casca_scenes::world::{Camera, Mesh, Sides, turn_of};

use crate::{Grid, Light, Object, Scene, Sky, Texture, Triangle};

pub use light::Incident;
pub use scenes::Kind;

/// The exponent of a lobe is 2 to the power of this times the gloss plus 1.
const SHARPEST: f64 = 11.0;

/// How a surface reflects and emits light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Share of light that is reflected diffusely (Lambert), 0 to 1 by channel.
    pub albedo: Vec3,
    /// Share of light that is reflected around the mirror direction when looked at head-on, 0 to 1
    /// by channel; 0 for matt surfaces. The sum of `albedo` and `specular` is at most 1.
    pub specular: Vec3,
    /// How sharp reflections are, from 0 (matt) to 1 (a mirror).
    pub gloss: f32,
    /// Radiance that the surface emits to both sides, 0 or more.
    pub emission: Vec3,
    /// From which sides it is seen, and stops what looks at it; from others there is nothing.
    pub sides: Sides,
    /// Index into [`LitScene::textures`]: its colours times `albedo` are what is reflected diffusely, and
    /// nothing is in its holes.
    pub texture: Option<u32>,
}

impl Material {
    /// A matt surface that emits nothing.
    pub const fn matt(albedo: Vec3) -> Self {
        let (specular, emission) = (Vec3::ZERO, Vec3::ZERO);
        Self { albedo, specular, gloss: 0.0, emission, sides: Sides::Both, texture: None }
    }

    /// A black surface that emits.
    pub const fn emitter(emission: Vec3) -> Self {
        Self { emission, ..Self::matt(Vec3::ZERO) }
    }

    /// The same with all values in range. Colours that are not finite become black, a gloss that is
    /// not becomes 0.
    pub fn sound(&self) -> Self {
        let finite = |v: Vec3| if v.is_finite() { v.max(Vec3::ZERO) } else { Vec3::ZERO };
        let specular = finite(self.specular).min(Vec3::ONE);
        let gloss = if self.gloss.is_finite() { self.gloss.clamp(0.0, 1.0) } else { 0.0 };
        let albedo = finite(self.albedo).min(Vec3::ONE - specular);
        Self { albedo, specular, gloss, emission: finite(self.emission), ..*self }
    }

    /// The exponent of the lobe around the mirror direction: 2 for a gloss of 0, 4096 for one of 1.
    pub fn exponent(&self) -> f64 {
        (SHARPEST * f64::from(self.gloss) + 1.0).exp2()
    }

    /// Whether it emits light.
    pub fn emits(&self) -> bool {
        self.emission.max_element() > 0.0
    }
}

/// An object: a mesh with a material for each triangle.
#[derive(Debug, Clone)]
pub struct LitObject {
    /// The mesh in object space.
    pub mesh: Arc<Mesh>,
    /// By triangle of the mesh: an index into [`LitScene::materials`].
    pub materials: Arc<[u32]>,
    /// By triangle: where its corners lie in the texture of its material; none if nothing is painted.
    pub uv: Arc<[[Vec2; 3]]>,
    /// Object space to world space.
    pub transform: Affine3A,
}

impl LitObject {
    /// Its triangles in world space, as those of an object of this number in a scene with these
    /// materials; without those that [`LitScene::triangles`] leaves out.
    pub fn triangles<'a>(
        &'a self,
        number: u32,
        materials: &'a [Material],
    ) -> impl Iterator<Item = LitTriangle> + 'a {
        let pairs = self.mesh.triangles.iter().zip(self.materials.iter()).enumerate();
        let mirrors = turn_of(&self.transform) < 0.0;
        pairs.filter_map(move |(i, (corners, &material))| {
            let mut uv = self.uv.get(i).copied().unwrap_or_default();
            let mut corners = corners_of(&self.mesh, corners)?.map(|p| self.transform.transform_point3(p));
            if mirrors {
                corners.swap(1, 2);
                uv.swap(1, 2);
            }
            let stops = materials.get(material as usize).is_some_and(|m| m.sides != Sides::Neither);
            let is_sound = corners.iter().all(|p| p.is_finite()) && stops;
            is_sound.then_some(LitTriangle { corners, uv, material, object: number })
        })
    }

    /// Its sound triangles where it is now, for a scene with these materials: see
    /// [`Cache::set_objects`](crate::Cache::set_objects). All stop light from both sides.
    pub fn lit(&self, materials: &[Material]) -> Object {
        let triangle = |t: LitTriangle| (Triangle { corners: t.corners, material: t.material }, t.uv);
        let (triangles, uv) = self.triangles(0, materials).map(triangle).unzip();
        Object { triangles, uv: if self.uv.is_empty() { Vec::new() } else { uv } }
    }
}

/// A triangle in world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LitTriangle {
    /// Its corners, counter-clockwise seen from the front.
    pub corners: [Vec3; 3],
    /// Where these lie in the texture of its material.
    pub uv: [Vec2; 3],
    /// Index into [`LitScene::materials`].
    pub material: u32,
    /// Index into [`LitScene::objects`].
    pub object: u32,
}

impl LitTriangle {
    /// Twice the area times the unit normal of the front.
    pub fn cross(&self) -> Vec3 {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a)
    }

    fn area(&self) -> f64 {
        let [a, b, c] = self.corners.map(|p| p.as_dvec3());
        (b - a).cross(c - a).length() / 2.0
    }
}

/// A scene with materials and lights.
#[derive(Debug, Clone)]
pub struct LitScene {
    /// A name for files and captions.
    pub name: String,
    /// All objects.
    pub objects: Vec<LitObject>,
    /// All materials.
    pub materials: Vec<Material>,
    /// What is painted on them.
    pub textures: Vec<Texture>,
    /// Lights that are no surfaces.
    pub lights: Vec<Light>,
    /// Radiance that comes from all directions where nothing is hit.
    pub sky: Vec3,
    /// Where pictures are taken from; its matrices are for pictures [`ASPECT`] times as wide as
    /// high.
    pub camera: Camera,
}

/// Width over height of the pictures that the camera of a [`LitScene`] is for.
pub const ASPECT: f32 = 4.0 / 3.0;

impl LitScene {
    /// All triangles in world space, object by object. Those that have a corner that is not finite,
    /// or a material that does not exist or stops no light, are left out. O(triangles).
    pub fn triangles(&self) -> Vec<LitTriangle> {
        let objects = (0..).zip(&self.objects);
        objects.flat_map(|(i, o)| o.triangles(i, &self.materials)).collect()
    }

    /// The least and the greatest corner of all triangles but those that [`Grid::around`] leaves
    /// out.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let grid = Grid::around(&Scene::from(self).objects, 1);
        (grid.min, grid.max)
    }
}

impl From<&LitScene> for Scene {
    /// Matt light of all surfaces: what they mirror is left out.
    ///
    /// Objects without sound triangles are empty, so that the others keep their numbers.
    fn from(scene: &LitScene) -> Self {
        let material = |m: &Material| crate::Material {
            texture: m.texture,
            ..crate::Material::new(m.sound().albedo, m.sound().emission)
        };
        Self {
            objects: scene.objects.iter().map(|o| o.lit(&scene.materials)).collect(),
            materials: scene.materials.iter().map(material).collect(),
            textures: scene.textures.clone(),
            lights: scene.lights.clone(),
            sky: Sky::Even(scene.sky),
        }
    }
}

fn corners_of(mesh: &Mesh, triangle: &[u32; 3]) -> Option<[Vec3; 3]> {
    let at = |v: u32| mesh.positions.get(v as usize).copied();
    Some([at(triangle[0])?, at(triangle[1])?, at(triangle[2])?])
}
