//! Rolling ground, one mesh, and what stands on it: houses and small things.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::motion::{Path, Walk};
use super::noise::Noise;
use super::options::SceneOptions;
use super::parts::{object, placed};
use crate::random::Dice;
use crate::world::{Mesh, Object, World};

pub(super) const SIZE: f32 = 320.0;
/// Squares along each side, of two triangles each.
const SQUARES: usize = 160;
const PITCH: f32 = SIZE / SQUARES as f32;
/// Height of a walker's eyes.
pub(super) const EYE: f32 = 1.7;
/// Metres between two places of a walk.
const STRIDE: f32 = 0.5;

/// Heights above corners of squares.
pub(super) struct Ground(Vec<f32>);

impl Ground {
    pub(super) fn new(dice: &mut Dice) -> Self {
        let noise = Noise::new(dice);
        let side = SQUARES + 1;
        let height = |i: usize| {
            let p = Vec3::new((i % side) as f32, 0.0, (i / side) as f32) * PITCH;
            let octave = |metres: f32, layer: f32| noise.at(p / metres + Vec3::Y * layer);
            20.0 + 11.0 * octave(60.0, 0.0) + 3.0 * octave(23.0, 3.0) + 0.35 * octave(7.0, 6.0)
        };
        Self((0..side * side).map(height).collect())
    }

    /// Height of the triangles of the mesh at a place.
    pub(super) fn at(&self, x: f32, z: f32) -> f32 {
        let (u, v) = ((x / PITCH).clamp(0.0, SQUARES as f32), (z / PITCH).clamp(0.0, SQUARES as f32));
        let (i, j) = ((u as usize).min(SQUARES - 1), (v as usize).min(SQUARES - 1));
        let (u, v) = (u - i as f32, v - j as f32);
        let corner = |di: usize, dj: usize| self.0[(j + dj) * (SQUARES + 1) + i + di];
        let (near, far) = (corner(0, 0), corner(1, 1));
        // The diagonal goes from the least to the greatest corner.
        if u > v {
            near + (corner(1, 0) - near) * u + (far - corner(1, 0)) * v
        } else {
            near + (corner(0, 1) - near) * v + (far - corner(0, 1)) * u
        }
    }

    pub(super) fn mesh(&self) -> Mesh {
        let side = SQUARES + 1;
        let corner =
            |(i, &y): (usize, &f32)| Vec3::new((i % side) as f32 * PITCH, y, (i / side) as f32 * PITCH);
        let mut triangles = Vec::with_capacity(2 * SQUARES * SQUARES);
        for square in 0..SQUARES * SQUARES {
            let a = (square / SQUARES * side + square % SQUARES) as u32;
            let (b, c, d) = (a + 1, a + side as u32, a + side as u32 + 1);
            triangles.extend([[a, d, b], [a, c, d]]);
        }
        Mesh { positions: self.0.iter().enumerate().map(corner).collect(), triangles, ..Mesh::default() }
    }

    /// A walk over hills past places given by x and z, at the height of the eyes.
    pub(super) fn path(&self, stops: &[(f32, f32)]) -> Path {
        let stops: Vec<Vec3> = stops.iter().map(|&(x, z)| Vec3::new(x, 0.0, z)).collect();
        let flat = Path::new(&stops);
        let mut eyes = flat.samples((flat.length() / STRIDE) as usize);
        eyes.iter_mut().for_each(|p| p.y = self.at(p.x, p.z) + EYE);
        Path::new(&eyes)
    }
}

/// A roof over the square from -1 to 1 in x and z, with its ridge along z at y = 1.
fn roof() -> Mesh {
    let corners = [(-1.0, 0.0), (1.0, 0.0), (0.0, 1.0)];
    let positions = [-1.0, 1.0].into_iter().flat_map(|z| corners.map(|(x, y)| Vec3::new(x, y, z)));
    Mesh {
        positions: positions.collect(),
        triangles: vec![
            [0, 2, 1],
            [3, 4, 5],
            [0, 1, 4],
            [0, 4, 3],
            [1, 2, 5],
            [1, 5, 4],
            [2, 0, 3],
            [2, 3, 5],
        ],
        ..Mesh::default()
    }
}

/// Where things may stand: on the ground, and off the path.
pub(super) struct Places {
    ground: Ground,
    path: Vec<Vec2>,
}

impl Places {
    pub(super) fn new(ground: Ground, path: &Path) -> Self {
        let eyes = path.samples((path.length() / STRIDE) as usize);
        Self { ground, path: eyes.iter().map(|eye| Vec2::new(eye.x, eye.z)).collect() }
    }

    /// A place farther than `margin` from the path and the border.
    pub(super) fn pick(&self, dice: &mut Dice, margin: f32) -> Vec3 {
        loop {
            let p = Vec2::new(dice.range(margin, SIZE - margin), dice.range(margin, SIZE - margin));
            if self.path.iter().all(|s| s.distance(p) > margin) {
                return Vec3::new(p.x, self.ground.at(p.x, p.y), p.y);
            }
        }
    }
}

pub(super) fn houses(dice: &mut Dice, places: &Places, count: usize, objects: &mut Vec<Object>) {
    let walls = Arc::new(Mesh::cuboid(Vec3::new(-1.0, 0.0, -1.0), Vec3::ONE));
    let roof = Arc::new(roof());
    for _ in 0..count {
        let base = places.pick(dice, 12.0) - Vec3::Y * 2.0;
        let (half, turn) =
            (dice.point(Vec3::new(3.0, 5.0, 4.0), Vec3::new(5.0, 8.5, 7.0)), dice.range(0.0, TAU));
        objects.push(object("house", placed(&walls, half, turn, base)));
        // The eaves stick out.
        let over = Vec3::new(half.x + 0.5, dice.range(2.0, 4.0), half.z + 0.5);
        objects.push(object("roof", placed(&roof, over, turn, base + Vec3::Y * half.y)));
    }
}

pub(super) fn small_things(dice: &mut Dice, places: &Places, count: usize, objects: &mut Vec<Object>) {
    let (stone, crate_) = (
        Arc::new(Mesh::ball(0)),
        Arc::new(Mesh::cuboid(Vec3::new(-0.5, 0.0, -0.5), Vec3::new(0.5, 1.0, 0.5))),
    );
    for _ in 0..count {
        let base = places.pick(dice, 2.0);
        let (size, turn) = (dice.point(Vec3::splat(0.2), Vec3::splat(0.9)), dice.range(0.0, TAU));
        let (name, model) = if dice.chance(0.5) { ("stone", &stone) } else { ("crate", &crate_) };
        objects.push(object(name, placed(model, size, turn, base)));
    }
}

/// A scene on the ground in which nothing moves but the walker.
pub(super) fn world(name: &str, objects: Vec<Object>, path: Path, options: &SceneOptions) -> World {
    let walk = Walk { far: 500.0, ..Walk::along(path, options) };
    walk.through(name, objects, [Vec3::ZERO, Vec3::new(SIZE, 56.0, SIZE)], 2.0)
}

#[cfg(test)]
mod tests {
    use super::super::{SceneKind, build};
    use super::*;
    use crate::world::Shape;

    #[test]
    fn the_eye_is_at_a_walkers_height_and_things_stand_on_the_ground() {
        for kind in [SceneKind::Terrain, SceneKind::Valley, SceneKind::Leaves] {
            let world = build(kind, &SceneOptions::default());
            let mut meshes = world.objects.iter().filter_map(|o| match &o.shape {
                Shape::Mesh { mesh, transform } => Some((o.name.as_str(), mesh, transform.translation)),
                _ => None,
            });
            let ground = Ground(meshes.next().unwrap().1.positions.iter().map(|p| p.y).collect());
            let stand = ["crate", "fir", "broadleaf", "tree", "fern"];
            let bases: Vec<_> = meshes.filter(|(name, ..)| stand.contains(name)).map(|m| m.2).collect();
            assert!(bases.len() > 100 && bases.iter().all(|b| (b.y - ground.at(b.x, b.z)).abs() < 1e-3));
            for frame in 0..world.frames {
                let eye = world.camera(frame, 1.5).eye;
                let height = eye.y - ground.at(eye.x, eye.z);
                assert!((height - EYE).abs() < 0.05, "{kind:?} frame {frame}: {height} m above the ground");
                let off = bases.iter().map(|b| (eye.x - b.x).hypot(eye.z - b.z)).fold(f32::MAX, f32::min);
                assert!(off > 1.9, "{kind:?} frame {frame}: {off} m off what stands there");
            }
        }
    }

    #[test]
    fn the_ground_between_corners_is_that_of_the_mesh() {
        let ground = Ground::new(&mut Dice::new(2, 6));
        let mesh = ground.mesh();
        for t in mesh.triangles.iter().step_by(97) {
            let middle = t.map(|v| mesh.positions[v as usize]).iter().sum::<Vec3>() / 3.0;
            assert!((ground.at(middle.x, middle.z) - middle.y).abs() < 1e-3);
        }
    }

    #[test]
    fn roofs_are_closed_and_the_ground_is_not() {
        assert!(roof().is_closed());
        assert!(!Ground::new(&mut Dice::new(2, 6)).mesh().is_closed());
    }
}
