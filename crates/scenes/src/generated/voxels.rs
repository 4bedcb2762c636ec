//! A world of blocks of one metre: hills, trees and caves, in chunks of 16x16 columns, each a mesh
//! of greedily merged quads; small things on the ground and in caves. The walk is on the
//! surface first and then in caves.

use glam::{IVec3, USizeVec3, Vec3};

use super::motion::{Path, Walk};
use super::noise::Noise;
use super::options::SceneOptions;
use super::parts::{mesh, object, standing_box};
use crate::random::Dice;
use crate::world::{Mesh, World};

/// Columns along a side of a chunk, and of the world.
const CHUNK: usize = 16;
const SIDE: usize = 12 * CHUNK;
const HEIGHT: usize = 256;
const TREES: f32 = 260.0;
/// Small things on the surface, and as many in caves.
const THINGS: f32 = 800.0;
/// Height of the eyes above the ground, and how far below that the walk goes through caves.
const EYE: f32 = 1.7;
const DEPTH: f32 = 26.0;
/// No block is closer to the walk, and no thing to its eyes.
const CLEAR: f32 = 1.8;

const STOPS: [(f32, f32); 6] =
    [(24.0, 30.0), (96.0, 36.0), (160.0, 60.0), (120.0, 116.0), (40.0, 96.0), (60.0, 164.0)];

/// Which blocks are solid, column by column.
struct Blocks {
    solid: Vec<bool>,
    /// Height of the surface above columns, before anything is dug.
    surface: Vec<f32>,
}

impl Blocks {
    /// Hills with caves: tunnels where two random functions are small, and halls where one is large.
    fn new(dice: &mut Dice) -> Self {
        let [hills, one, two] = [(); 3].map(|()| Noise::new(dice));
        let columns = (0..SIDE * SIDE).map(|i| Vec3::new((i / SIDE) as f32, 0.0, (i % SIDE) as f32) + 0.5);
        let octave = |p: Vec3, metres: f32| hills.at(Vec3::new(p.x, 3.0 * metres, p.z) / metres);
        let height = |p: Vec3| 66.0 + 20.0 * octave(p, 60.0) + 7.0 * octave(p, 23.0) + 1.5 * octave(p, 8.0);
        let surface: Vec<f32> = columns.clone().map(height).collect();
        let mut solid = vec![false; SIDE * SIDE * HEIGHT];
        for ((p, top), blocks) in columns.zip(&surface).zip(solid.chunks_exact_mut(HEIGHT)) {
            for (y, block) in blocks.iter_mut().enumerate().take(*top as usize) {
                let p = p + Vec3::Y * y as f32;
                let a = one.at(p / Vec3::new(26.0, 16.0, 26.0));
                let b = || two.at(p / Vec3::new(30.0, 18.0, 30.0));
                *block = y < 3 || a < 0.5 && (a.abs() > 0.2 || a.abs() + b().abs() > 0.2);
            }
        }
        Self { solid, surface }
    }

    fn index(at: USizeVec3) -> usize {
        (at.x * SIDE + at.z) * HEIGHT + at.y
    }

    /// Whether a block is solid; those below and beside the world are, those above are not.
    fn at(&self, at: IVec3) -> bool {
        let side = SIDE as i32;
        let beside = at.y < 0 || at.x < 0 || at.z < 0 || at.x >= side || at.z >= side;
        beside || at.y < HEIGHT as i32 && self.solid[Self::index(at.as_usizevec3())]
    }

    /// Sets all blocks whose middles are closer to a place.
    fn fill(&mut self, middle: Vec3, reach: f32, solid: bool) {
        let (lo, hi) = ((middle - reach).as_ivec3(), (middle + reach).as_ivec3());
        for (x, y) in (lo.x..=hi.x).flat_map(|x| (lo.y..=hi.y).map(move |y| (x, y))) {
            for block in (lo.z..=hi.z).map(|z| IVec3::new(x, y, z)) {
                let inside = block.cmpge(IVec3::ZERO).all() && block.max_element() < SIDE as i32;
                if inside && middle.distance(block.as_vec3() + 0.5) < reach {
                    self.solid[Self::index(block.as_usizevec3())] = solid;
                }
            }
        }
    }

    /// The surface above a place, between columns.
    fn surface(&self, x: f32, z: f32) -> f32 {
        let (i, j) = ((x - 0.5) as usize, (z - 0.5) as usize);
        let (u, v) = (x - 0.5 - i as f32, z - 0.5 - j as f32);
        let row = |i: usize| self.surface[i * SIDE + j] * (1.0 - v) + self.surface[i * SIDE + j + 1] * v;
        row(i) * (1.0 - u) + row(i + 1) * u
    }

    /// Over hills, then down into caves.
    fn path(&self) -> Path {
        let flat = Path::new(&STOPS.map(|(x, z)| Vec3::new(x, 0.0, z)));
        let mut eyes = flat.samples(flat.length() as usize);
        let last = (eyes.len() - 1) as f32;
        for (i, p) in eyes.iter_mut().enumerate() {
            let down = ((i as f32 / last - 0.55) / 0.15).clamp(0.0, 1.0);
            p.y = self.surface(p.x, p.z) + EYE - DEPTH * down * down * (3.0 - 2.0 * down);
        }
        Path::new(&eyes)
    }

    /// A trunk with a crown of leaves, which are solid.
    fn tree(&mut self, dice: &mut Dice, x: usize, z: usize) {
        let base = self.surface[x * SIDE + z] as usize;
        let height = dice.range(4.0, 7.99) as usize;
        let middle = Vec3::new(x as f32 + 0.5, (base + height) as f32, z as f32 + 0.5);
        self.fill(middle, dice.range(2.0, 3.0), true);
        let trunk = Self::index(USizeVec3::new(x, base, z));
        self.solid[trunk..trunk + height].fill(true);
    }

    /// The faces of a chunk's blocks towards air, with as few quads as merging along rows gives.
    fn chunk(&self, corner: IVec3) -> Mesh {
        let size = IVec3::new(CHUNK as i32, HEIGHT as i32, CHUNK as i32);
        let mut chunk = Mesh::default();
        for (axis, ahead) in (0..6).map(|side| (side / 2, side % 2 == 1)) {
            let [w, u, v] = [0, 1, 2].map(|i| IVec3::AXES[(axis + i) % 3]);
            let (across, down) = (size.dot(u), size.dot(v));
            for layer in 0..size.dot(w) {
                let block = |i: i32, j: i32| corner + w * layer + u * i + v * j;
                let next = if ahead { w } else { -w };
                let faces = (0..across * down).map(|k| block(k % across, k / across));
                let mut faces: Vec<bool> = faces.map(|b| self.at(b) && !self.at(b + next)).collect();
                let row = |i: i32, end: i32, j: i32| (j * across + i) as usize..(j * across + end) as usize;
                for (i, j) in (0..down).flat_map(|j| (0..across).map(move |i| (i, j))) {
                    let width = faces[row(i, across, j)].iter().take_while(|face| **face).count() as i32;
                    if width > 0 {
                        let whole = |j: &i32| faces[row(i, i + width, *j)].iter().all(|face| *face);
                        let height = (j..down).take_while(whole).count() as i32;
                        (j..j + height).for_each(|j| faces[row(i, i + width, j)].fill(false));
                        let low = block(i, j) + if ahead { w } else { IVec3::ZERO };
                        let (a, b) = if ahead { (u * width, v * height) } else { (v * height, u * width) };
                        let first = chunk.positions.len() as u32;
                        chunk.positions.extend([low, low + a, low + a + b, low + b].map(|p| p.as_vec3()));
                        chunk.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|v| first + v)));
                    }
                }
            }
        }
        chunk
    }

    /// The floor of a random place: on the surface, or in a cave.
    fn floor(&self, dice: &mut Dice, below: bool) -> Vec3 {
        loop {
            let at = dice.point(Vec3::splat(2.0), Vec3::splat(SIDE as f32 - 2.0)).floor();
            let top = self.surface[at.x as usize * SIDE + at.z as usize].floor();
            let at = if below { at } else { at.with_y(top) };
            let deep = !below || at.y < top - 4.0;
            if deep && self.at(at.as_ivec3() - IVec3::Y) && !self.at(at.as_ivec3()) {
                return at + Vec3::new(0.5, 0.0, 0.5);
            }
        }
    }
}

pub(super) fn build(options: &SceneOptions) -> World {
    let mut dice = Dice::new(options.seed, 14);
    let mut blocks = Blocks::new(&mut dice);
    for _ in 0..(TREES * options.scale) as usize {
        let [x, z] = [(); 2].map(|()| dice.range(4.0, SIDE as f32 - 4.0) as usize);
        blocks.tree(&mut dice, x, z);
    }
    let path = blocks.path();
    let eyes = path.samples(2 * path.length() as usize);
    eyes.iter().for_each(|eye| blocks.fill(*eye, CLEAR, false));
    let corners = (0..SIDE).step_by(CHUNK);
    let corners = corners.clone().flat_map(|x| corners.clone().map(move |z| USizeVec3::new(x, 0, z)));
    let mut objects: Vec<_> =
        corners.map(|corner| object("chunk", mesh(blocks.chunk(corner.as_ivec3())))).collect();
    for i in 0..2 * (THINGS * options.scale) as usize {
        let base = blocks.floor(&mut dice, i % 2 == 1);
        if eyes.iter().all(|eye| eye.distance(base) > CLEAR + 1.0) {
            let thing = standing_box("thing", base, dice.point(Vec3::splat(0.3), Vec3::splat(0.8)));
            objects.push(crate::world::Object { occludes: false, ..thing });
        }
    }
    let size = Vec3::new(SIDE as f32, HEIGHT as f32, SIDE as f32);
    Walk::along(path, options).through("voxels", objects, [Vec3::ZERO, size], 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quads_show_each_face_towards_air_once() {
        let blocks = Blocks::new(&mut Dice::new(1, 14));
        let corner = IVec3::new(32, 0, 48);
        let chunk = blocks.chunk(corner);
        let area: f32 = (chunk.triangles.iter().map(|t| t.map(|v| chunk.positions[v as usize])))
            .map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length())
            .sum();
        let mut faces = 0;
        let columns = (0..CHUNK * CHUNK).map(|i| IVec3::new((i / CHUNK) as i32, 0, (i % CHUNK) as i32));
        for block in columns.flat_map(|c| (0..HEIGHT as i32).map(move |y| corner + c + IVec3::Y * y)) {
            let open =
                |axis: &IVec3| [block + *axis, block - *axis].iter().filter(|b| !blocks.at(**b)).count();
            faces += if blocks.at(block) { IVec3::AXES.iter().map(open).sum() } else { 0 };
        }
        assert!(area == faces as f32 && chunk.triangles.len() < faces, "{area} of {faces}");
        let outside = chunk.triangles.iter().all(|t| {
            let [a, b, c] = t.map(|v| chunk.positions[v as usize]);
            let normal = (b - a).cross(c - a).normalize() * 0.5;
            let [inside, outside] = [-normal, normal].map(|way| ((a + b + c) / 3.0 + way).floor().as_ivec3());
            blocks.at(inside) && !blocks.at(outside)
        });
        assert!(outside, "a face does not look from a block into air");
    }

    #[test]
    fn the_walk_goes_over_the_surface_and_below_it() {
        let blocks = Blocks::new(&mut Dice::new(1, 14));
        let eyes = blocks.path().samples(200);
        let heights = eyes.iter().map(|e| e.y - blocks.surface(e.x, e.z));
        let outside = heights.clone().filter(|h| (h - EYE).abs() < 0.5).count();
        assert!(outside > 60 && heights.filter(|h| *h < -20.0).count() > 60);
    }
}
