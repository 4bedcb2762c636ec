//! Triangles, materials and lights as the shaders take them: lengths in cells from the corner of
//! the grid.

use std::collections::{BTreeMap, BTreeSet};
use std::f32::consts::PI;

use bytemuck::{Pod, Zeroable};
use casca_scenes::lit::{self, LightKind, LitObject, LitScene};
use glam::{Affine3A, Vec3};

use crate::error::LightError;
use crate::numeric::{BRIGHTEST, FARTHEST, GROWTH, MOST_TRIANGLES};
use crate::volume::Volume;

/// A triangle in cells.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Triangle {
    a: [f32; 3],
    material: u32,
    b: [f32; 3],
    /// Voxels emit this share of what the material does: see [`emission_share`].
    share: f32,
    c: [f32; 3],
    pad_c: u32,
}

impl Triangle {
    /// Its corners, in cells.
    pub fn corners(&self) -> [Vec3; 3] {
        [self.a, self.b, self.c].map(Vec3::from_array)
    }
}

/// A material.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Material {
    albedo: [f32; 3],
    gloss: f32,
    specular: [f32; 3],
    pad: f32,
    emission: [f32; 3],
    pad_e: f32,
}

/// Numbers from 0 to `most`; infinite ones and those that are no numbers become 0.
pub(crate) fn sound(v: Vec3, most: f32) -> [f32; 3] {
    v.to_array().map(|c| if c.is_finite() { c.clamp(0.0, most) } else { 0.0 })
}

impl Material {
    fn new(m: &lit::Material) -> Self {
        let gloss = if m.gloss.is_finite() { m.gloss.clamp(0.0, 1.0) } else { 0.0 };
        let (albedo, specular) = (sound(m.albedo, 1.0), sound(m.specular, 1.0));
        Self { albedo, gloss, specular, pad: 0.0, emission: sound(m.emission, BRIGHTEST), pad_e: 0.0 }
    }
}

/// Kinds of lights, by number.
#[derive(Debug, Clone, Copy)]
pub enum LightKindNumber {
    /// See [`LightKind::Directional`].
    Directional,
    /// See [`LightKind::Point`].
    Point,
    /// See [`LightKind::Spot`].
    Spot,
}

/// A light.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Light {
    position: [f32; 3],
    kind: u32,
    color: [f32; 3],
    radius: f32,
    axis: [f32; 3],
    inner: f32,
    falloff: [f32; 3],
    outer: f32,
}

impl Light {
    /// A light that shines on nothing if its values are not sound.
    fn new(light: &lit::Light, volume: &Volume) -> Self {
        let f = light.falloff;
        let mut new = Self {
            color: sound(light.color, BRIGHTEST),
            falloff: [f.constant, f.linear, f.quadratic],
            ..Self::zeroed()
        };
        let axis = match light.kind {
            LightKind::Directional { direction, half_angle } => {
                new.kind = LightKindNumber::Directional as u32;
                // A sun wider than that would be a sky.
                new.radius = half_angle.clamp(0.0, 1.5).tan();
                new.position = (-direction).normalize_or_zero().to_array();
                direction
            }
            LightKind::Point { position, radius } => {
                new.kind = LightKindNumber::Point as u32;
                (new.position, new.radius) =
                    (volume.cells_from(position).to_array(), radius.max(0.0) / volume.cell);
                Vec3::Y
            }
            LightKind::Spot { position, direction, radius, inner, outer } => {
                new.kind = LightKindNumber::Spot as u32;
                (new.position, new.radius) =
                    (volume.cells_from(position).to_array(), radius.max(0.0) / volume.cell);
                (new.inner, new.outer) = (inner.cos(), outer.cos().min(inner.cos() - f32::EPSILON));
                direction
            }
        };
        new.axis = axis.normalize_or_zero().to_array();
        let numbers: &[f32] = &[new.position, new.axis, new.falloff].concat();
        let is_sound = numbers.iter().chain(&[new.radius, new.inner, new.outer]).all(|v| v.is_finite());
        if is_sound && axis.try_normalize().is_some() {
            new
        } else {
            Self { color: [0.0; 3], falloff: [1.0, 0.0, 0.0], ..Self::zeroed() }
        }
    }
}

impl Light {
    /// Where its light comes from, as seen from a point, in cells; `None` if it is black.
    pub fn place(&self, from: Vec3) -> Option<Vec3> {
        let at = Vec3::from_array(self.position);
        let is_far = self.kind == LightKindNumber::Directional as u32;
        let is_black = self.color.iter().all(|c| *c <= 0.0);
        (!is_black).then_some(if is_far { from + at * FARTHEST } else { at })
    }
}

/// Lights in the units of a grid. There is at least one, so that there is something to bind: it may
/// be black.
pub fn lights_of(lights: &[lit::Light], volume: &Volume) -> Vec<Light> {
    let black = lit::Light::point(Vec3::ZERO, Vec3::ZERO);
    let lights = if lights.is_empty() { std::slice::from_ref(&black) } else { lights };
    lights.iter().map(|light| Light::new(light, volume)).collect()
}

/// The triangles of a scene: those of objects that stay, then those of objects that move.
#[derive(Debug, Clone)]
pub struct Geometry {
    /// All triangles.
    pub triangles: Vec<Triangle>,
    /// How many of them stay where they are.
    pub fixed: usize,
    /// The objects that may move: their number in the scene, and the first of their triangles.
    moving: Vec<(usize, usize)>,
    objects: Vec<LitObject>,
    /// By material, whether it emits.
    emits: Vec<bool>,
}

impl Geometry {
    /// The triangles of a scene in the cells of a grid.
    ///
    /// # Errors
    /// There are none, or too many.
    pub fn new(scene: &LitScene, volume: &Volume) -> Result<Self, LightError> {
        let count = scene.objects.iter().map(|o| o.mesh.triangles.len()).sum();
        if count > MOST_TRIANGLES {
            return Err(LightError::TooManyTriangles(count));
        }
        let mut new = Self {
            triangles: Vec::with_capacity(count),
            fixed: 0,
            moving: Vec::new(),
            objects: scene.objects.clone(),
            emits: scene.materials.iter().map(|m| m.emission.max_element() > 0.0).collect(),
        };
        let put = |new: &mut Self, i: usize| {
            let object = &scene.objects[i];
            new.triangles.extend(triangles_of(object, volume, &new.emits));
        };
        (0..scene.objects.len()).filter(|&i| !scene.objects[i].moves).for_each(|i| put(&mut new, i));
        new.fixed = new.triangles.len();
        for i in (0..scene.objects.len()).filter(|&i| scene.objects[i].moves) {
            new.moving.push((i, new.triangles.len()));
            put(&mut new, i);
        }
        new.check(scene)?;
        Ok(new)
    }

    /// Refuses scenes of which nothing is sound.
    fn check(&self, scene: &LitScene) -> Result<(), LightError> {
        if self.triangles.iter().any(|t| *t != NOWHERE) {
            return Ok(());
        }
        let triangles = self.triangles.len();
        if triangles == 0 {
            return Err(LightError::NoTriangles);
        }
        let (mut corners, mut materials) = (0, 0);
        for o in &scene.objects {
            for (i, t) in o.mesh.triangles.iter().enumerate() {
                let is_finite = |v: &u32| {
                    let at = o.mesh.positions.get(*v as usize);
                    at.is_some_and(|p| o.transform.transform_point3(*p).is_finite())
                };
                if !t.iter().all(is_finite) {
                    corners += 1;
                } else if o.materials.get(i).is_none_or(|m| *m as usize >= self.emits.len()) {
                    materials += 1;
                }
            }
        }
        let far = triangles - corners - materials;
        Err(LightError::NoSoundTriangles { triangles, corners, far, materials })
    }

    /// Moves an object; returns the numbers of its triangles. Those that have corners that are not
    /// finite become empty.
    ///
    /// # Errors
    /// There is no such object, or it does not move.
    pub fn move_object(
        &mut self,
        object: usize,
        transform: Affine3A,
        volume: &Volume,
    ) -> Result<std::ops::Range<usize>, LightError> {
        let at =
            self.moving.binary_search_by_key(&object, |m| m.0).map_err(|_| LightError::Object(object))?;
        let start = self.moving[at].1;
        self.objects[object].transform = transform;
        let new = triangles_of(&self.objects[object], volume, &self.emits);
        let end = start + new.len();
        self.triangles[start..end].copy_from_slice(&new);
        Ok(start..end)
    }
}

/// A point outside of the grid.
const NOWHERE: Triangle = {
    let at = [-FARTHEST; 3];
    Triangle { a: at, material: 0, b: at, share: 0.0, c: at, pad_c: 0 }
};

/// The triangles of an object in cells. Those that are not sound are a point outside of the grid,
/// so that the others keep their numbers.
fn triangles_of(object: &LitObject, volume: &Volume, emits: &[bool]) -> Vec<Triangle> {
    let mesh = &object.mesh;
    let corner = |v: u32| {
        let at = mesh.positions.get(v as usize).copied()?;
        let at = volume.cells_from(object.transform.transform_point3(at));
        (at.abs().max_element() < FARTHEST).then_some(at)
    };
    let triangle = |(i, t): (usize, &[u32; 3])| {
        let material = object.materials.get(i).copied().filter(|&m| (m as usize) < emits.len())?;
        let [a, b, c] = [corner(t[0])?, corner(t[1])?, corner(t[2])?].map(|p| p.to_array());
        Some(Triangle { a, material, b, share: 1.0, c, pad_c: 0 })
    };
    let mut triangles: Vec<_> =
        mesh.triangles.iter().enumerate().map(|t| triangle(t).unwrap_or(NOWHERE)).collect();
    let share = emission_share(&triangles, emits);
    triangles.iter_mut().filter(|t| **t != NOWHERE).for_each(|t| t.share = share);
    triangles
}

/// The area of the triangles that emit, as a share of that of their voxels, which are larger: a
/// body grows by [`GROWTH`] on all sides (Steiner's formula: by the bends of its edges), a sheet by
/// half a cell along its rim. So the power of a small lamp does not depend on the cells. Rooms that
/// are closed around the light do not grow inwards. O(n log n).
fn emission_share(triangles: &[Triangle], emits: &[bool]) -> f32 {
    let (mut areas, mut corners, mut edges) = (Vec::new(), BTreeSet::new(), BTreeMap::<_, Vec<_>>::new());
    for t in triangles.iter().filter(|t| **t != NOWHERE && emits[t.material as usize]) {
        let c = t.corners();
        let cross = (c[1] - c[0]).cross(c[2] - c[0]);
        let Some(normal) = cross.try_normalize() else { continue };
        areas.push(0.5 * cross.length());
        for i in 0..3 {
            let [p, q] = [c[i], c[(i + 1) % 3]].map(|p| p.to_array().map(f32::to_bits));
            corners.insert(p);
            edges.entry([p.min(q), p.max(q)]).or_default().push((normal, c[(i + 2) % 3], p < q));
        }
    }
    // Sorted and in double precision, sums do not depend on the order of triangles.
    areas.sort_unstable_by(f32::total_cmp);
    let area: f64 = areas.iter().copied().map(f64::from).sum();
    let (mut bends, mut rims) = (0.0_f64, 0.0_f64);
    for (ends, sides) in &mut edges {
        sides.sort_unstable_by_key(|side| side.1.to_array().map(f32::to_bits));
        let [p, q] = ends.map(|p| Vec3::from_array(p.map(f32::from_bits)));
        match sides[..] {
            [_] => rims += f64::from(p.distance(q)),
            // Convex if the second triangle lies behind the first; neighbours run along their edge
            // in opposite ways.
            [(n, _, forward), (m, third, other)] if forward != other => {
                let bend = n.dot(m).clamp(-1.0, 1.0).acos().copysign(n.dot(p - third));
                bends += f64::from(p.distance(q) * bend);
            }
            _ => {}
        }
    }
    // Euler's characteristic counts bodies twice and sheets once.
    let count = corners.len() as f64 + areas.len() as f64 - edges.len() as f64;
    let growth = f64::from(GROWTH);
    let end = if rims > 0.0 { 1.0 } else { 2.0 * f64::from(PI) * growth * growth };
    let grown = area + growth * bends + 0.5 * rims + end * count.max(0.0);
    if area < grown { (area / grown) as f32 } else { 1.0 }
}

/// Materials. There is at least one.
pub fn materials_of(scene: &LitScene) -> Vec<Material> {
    let grey = lit::Material::matt(Vec3::splat(0.5));
    let materials = if scene.materials.is_empty() { std::slice::from_ref(&grey) } else { &scene.materials };
    materials.iter().map(Material::new).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use casca_scenes::world::Mesh;
    use std::sync::Arc;

    #[test]
    fn lamps_emit_less_by_as_much_as_their_voxels_are_larger() {
        let volume = Volume { origin: Vec3::ZERO, cell: 1.0, dims: glam::UVec3::splat(64) };
        let square = Mesh {
            positions: [[0, 0], [1, 0], [1, 1], [0, 1]]
                .map(|[x, z]| Vec3::new(x as f32, 0.0, z as f32))
                .into(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        };
        let cube = Mesh::cuboid(Vec3::ZERO, Vec3::ONE);
        let mut room = cube.clone();
        room.triangles.iter_mut().for_each(|t| t.reverse());
        let share = |mesh: &Mesh, size: f32| {
            let object = LitObject {
                name: String::new(),
                materials: vec![0; mesh.triangles.len()].into(),
                mesh: Arc::new(mesh.clone()),
                transform: Affine3A::from_scale(Vec3::splat(size)),
                moves: false,
            };
            triangles_of(&object, &volume, &[true])[0].share
        };
        // Twenty bodies or sheets in one object, far from one another.
        let twenty = |mesh: &Mesh| {
            let mut all = Mesh { positions: Vec::new(), triangles: Vec::new() };
            for i in 0..20 {
                let first = all.positions.len() as u32;
                all.positions.extend(mesh.positions.iter().map(|p| p + Vec3::X * 4.0 * i as f32));
                all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| v + first)));
            }
            all
        };
        for size in [0.5_f32, 4.0, 30.0] {
            for mesh in [&square, &cube, &Mesh::ball(2)] {
                let (one, many) = (share(mesh, size), share(&twenty(mesh), size));
                assert!((one - many).abs() < 1e-3, "{size}: {one} and {many}");
            }
            // The cells that an axis-parallel square or cube of this size touches, on the mean over
            // its places.
            let grown = (size / (size + 1.0)).powi(2);
            assert!((share(&square, size) - grown).abs() < 1e-4, "{size}: {}", share(&square, size));
            assert!((share(&cube, size) - grown).abs() < 0.02, "{size}: {}", share(&cube, size));
            let (ball, r) = (share(&Mesh::ball(3), size), size);
            let grown = PI * r * r / (PI * r * r + 4.0 * r + 1.0);
            assert!((ball - grown).abs() < 0.03, "{size}: {ball}, not {grown}");
            assert!(size < 4.0 || share(&room, size) == 1.0);
        }
    }
}
