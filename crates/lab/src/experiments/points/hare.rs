//! A hare: a closed surface with ears, legs and hollows between them, for clouds whose truth is
//! known.
//!
//! A distance function of rounded parts becomes a mesh by naive surface nets (Gibson 1998,
//! "Constrained Elastic Surface Nets").

use std::collections::HashMap;

use glam::{UVec3, Vec3};

use casca_scenes::world::Mesh;

/// How far apart parts are when the surface begins to flow from one to the other.
const BLEND: f32 = 0.14;
/// Bounds of the hare, with some room.
const LOW: Vec3 = Vec3::new(-1.6, -0.25, -1.0);
const HIGH: Vec3 = Vec3::new(1.75, 3.25, 1.0);

/// Parts on one side: from, to and radius. The z of both ends is mirrored.
const PAIRS: [([f32; 3], [f32; 3], f32); 5] = [
    // Ears, upper arms, paws, thighs and feet.
    ([0.85, 1.85, 0.16], [0.35, 2.9, 0.36], 0.13),
    ([0.45, 0.75, 0.35], [0.75, 0.15, 0.35], 0.16),
    ([0.7, 0.05, 0.35], [1.05, 0.03, 0.35], 0.13),
    ([-0.55, 0.55, 0.42], [-0.3, 0.4, 0.5], 0.36),
    ([-0.5, 0.05, 0.5], [0.1, 0.0, 0.52], 0.16),
];
/// Parts in the middle.
const SINGLE: [([f32; 3], [f32; 3], f32); 5] = [
    // Rump, chest, head, snout and tail.
    ([-0.45, 0.72, 0.0], [-0.1, 0.8, 0.0], 0.62),
    ([0.1, 0.85, 0.0], [0.45, 1.0, 0.0], 0.46),
    ([0.8, 1.55, 0.0], [0.95, 1.52, 0.0], 0.37),
    ([1.15, 1.42, 0.0], [1.3, 1.38, 0.0], 0.2),
    ([-1.12, 0.72, 0.0], [-1.2, 0.8, 0.0], 0.22),
];

/// The distance from the hare's surface, negative inside; exact but where parts flow into each
/// other.
fn distance(p: Vec3) -> f32 {
    let part = |p: Vec3, (from, to, radius): ([f32; 3], [f32; 3], f32)| {
        let (from, to) = (Vec3::from(from), Vec3::from(to));
        let along = ((p - from).dot(to - from) / (to - from).length_squared()).clamp(0.0, 1.0);
        p.distance(from + (to - from) * along) - radius
    };
    let mirrored = Vec3::new(p.x, p.y, p.z.abs());
    let parts = SINGLE.map(|s| part(p, s)).into_iter().chain(PAIRS.map(|s| part(mirrored, s)));
    parts.fold(f32::INFINITY, |a, b| {
        let share = (BLEND - (a - b).abs()).max(0.0) / BLEND;
        a.min(b) - share * share * BLEND / 4.0
    })
}

/// The hare as a closed mesh with `cells` cells along its height of 3.2: about `3.7 cells^2`
/// triangles of even size.
pub fn hare(cells: u32) -> Mesh {
    surface(distance, LOW, HIGH, (HIGH.y - LOW.y) / cells.clamp(8, 1000) as f32)
}

/// The surface where a function is 0, with a vertex for each cell that it passes; counter-clockwise
/// where the function is positive.
fn surface(function: impl Fn(Vec3) -> f32, low: Vec3, high: Vec3, cell: f32) -> Mesh {
    let size = ((high - low) / cell).ceil().as_uvec3() + 1;
    let number = |at: UVec3| ((at.z * size.y + at.y) * size.x + at.x) as usize;
    let place = |at: UVec3| low + at.as_vec3() * cell;
    let lattice = |size: UVec3| {
        (0..size.z)
            .flat_map(move |z| (0..size.y).flat_map(move |y| (0..size.x).map(move |x| UVec3::new(x, y, z))))
    };
    let values: Vec<f32> = lattice(size).map(|at| function(place(at))).collect();
    let inside = |at: UVec3| values[number(at)] < 0.0;
    let mut mesh = Mesh::default();
    let mut vertices = HashMap::new();
    for at in lattice(size - 1) {
        let crossings: Vec<Vec3> = edges(at)
            .filter(|&(a, b)| inside(a) != inside(b))
            .map(|(a, b)| {
                let (va, vb) = (values[number(a)], values[number(b)]);
                place(a).lerp(place(b), va / (va - vb))
            })
            .collect();
        if !crossings.is_empty() {
            vertices.insert(at, mesh.positions.len() as u32);
            mesh.positions.push(crossings.iter().sum::<Vec3>() / crossings.len() as f32);
        }
    }
    // An edge that the surface crosses gives a square of the vertices around it.
    for at in lattice(size - 1) {
        for axis in 0..3 {
            let [x, y, z] = [0, 1, 2].map(|i| unit((axis + i) % 3));
            let around = [UVec3::ZERO, y, y + z, z];
            let corner = |back: UVec3| vertices.get(&at.checked_sub(back)?).copied();
            let [Some(a), Some(b), Some(c), Some(d)] = around.map(corner) else { continue };
            if inside(at) != inside(at + x) {
                let square = if inside(at) { [a, b, c, d] } else { [d, c, b, a] };
                mesh.triangles.extend(halves(&mesh.positions, square));
            }
        }
    }
    mesh
}

fn unit(axis: usize) -> UVec3 {
    UVec3::AXES[axis]
}

/// The ends of the twelve edges of a cell.
fn edges(at: UVec3) -> impl Iterator<Item = (UVec3, UVec3)> {
    (0..3).flat_map(move |axis| {
        let [x, y, z] = [0, 1, 2].map(|i| unit((axis + i) % 3));
        [at, at + y, at + z, at + y + z].map(|from| (from, from + x))
    })
}

/// A square cut along its shorter diagonal.
fn halves(positions: &[Vec3], [a, b, c, d]: [u32; 4]) -> [[u32; 3]; 2] {
    let length = |p: u32, q: u32| positions[p as usize].distance_squared(positions[q as usize]);
    if length(a, c) <= length(b, d) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
}
