//! What casca-fur does otherwise than the thesis that it comes from (B. P. Evangelista, UFMG 2009):
//! its fur maps, its lookups and its normals, in numbers.

use std::collections::HashSet;
use std::error::Error;

use casca_fur::mesh::{self, Vertex, continuous_normals, weld};
use casca_scenes::random::generator;
use glam::Vec3;
use rand::seq::SliceRandom;

#[path = "../src/samples.rs"]
#[expect(dead_code, reason = "tests have more meshes")]
mod samples;

const SIDE: i32 = 256;
/// Two unit vectors whose sum is shorter than this are opposite, but for rounding: the sum has no
/// direction.
const OPPOSITE: f32 = 1e-6;

/// A map of hairs at random texels that repeats without seams (algorithm 4), and the share of texels
/// with a hair when the goal is reached or no texel is free. Each texel is tried once, in random
/// order: the loop of the thesis tries for ever where the neighbours of hairs leave no room.
fn fur_map(density: f64, taken: &[(i32, i32)]) -> (Vec<bool>, f64) {
    let mut order: Vec<i32> = (0..SIDE * SIDE).collect();
    order.shuffle(&mut generator(3, 0));
    let (mut hairs, mut count) = (vec![false; (SIDE * SIDE) as usize], 0);
    for at in order {
        let beside = |&(dx, dy): &(i32, i32)| {
            let (x, y) = ((at % SIDE + dx).rem_euclid(SIDE), (at / SIDE + dy).rem_euclid(SIDE));
            hairs[(y * SIDE + x) as usize]
        };
        if f64::from(count) < density * f64::from(SIDE * SIDE) && !taken.iter().any(beside) {
            hairs[at as usize] = true;
            count += 1;
        }
    }
    (hairs, f64::from(count) / f64::from(SIDE * SIDE))
}

/// Where a direction meets a map on the faces of a cube (algorithm 5): the face of the largest
/// component, and the place on it. Faces are +x, -x, +y, -y, +z, -z.
fn cube_place(direction: Vec3) -> (usize, [f32; 2]) {
    let axis = direction.abs().max_position();
    let is_back = direction[axis] < 0.0;
    let Vec3 { x, y, z } = direction / direction[axis].abs();
    let [u, v] = match (axis, is_back) {
        (0, false) => [-z, -y],
        (0, true) => [z, -y],
        (1, false) => [x, z],
        (1, true) => [x, -z],
        (_, false) => [x, -y],
        (_, true) => [-x, -y],
    };
    (2 * axis + usize::from(is_back), [(u + 1.0) * 0.5, (v + 1.0) * 0.5])
}

/// The sum of the normals at a position that differ (algorithm 2), or of all.
fn summed(soup: &[Vertex], position: Vec3, distinct: bool) -> Vec3 {
    let mut seen = HashSet::new();
    let here = soup.iter().filter(|v| v.position == position);
    let counts = here.filter(|v| seen.insert(v.normal.to_array().map(f32::to_bits)) || !distinct);
    counts.map(|v| v.normal).sum::<Vec3>().normalize_or_zero()
}

fn main() -> Result<(), Box<dyn Error>> {
    let four = [(1, 0), (-1, 0), (0, 1), (0, -1)];
    let eight = [&four[..], &[(1, 1), (-1, 1), (1, -1), (-1, -1)]].concat();
    for (name, taken) in [("no", &[][..]), ("four", &four[..]), ("eight", &eight[..])] {
        println!("a fur map with {name} free neighbours holds {:.3} of 0.5", fur_map(0.5, taken).1);
    }
    let (hairs, _) = fur_map(0.2, &[]);

    // The thesis looks fur up in the direction normal + position: some places have none.
    let soup = samples::torus(3.0, 1.0, 24, 8);
    let mut smooth = soup.clone();
    continuous_normals(&mut smooth)?;
    let mesh = weld(&smooth, &[])?;
    let sums = mesh.vertices().iter().map(|v| v.normal + v.position.normalize());
    let (found, none): (Vec<Vec3>, Vec<Vec3>) = sums.partition(|sum| sum.length() > OPPOSITE);
    let shown = found.iter().filter(|&&sum| {
        let (face, [u, v]) = cube_place(sum);
        let texel = |x: f32| (x * (SIDE - 1) as f32) as usize;
        face < 6 && hairs[texel(v) * SIDE as usize + texel(u)]
    });
    println!(
        "of {} vertices of a torus {} have no place on a cube map; {} others lie on a hair",
        mesh.vertices().len(),
        none.len(),
        shown.count()
    );

    // Flat sides that are cut differently pull the sum of all normals aside.
    let of = |distinct: bool| {
        let away =
            mesh.vertices().iter().map(|v| summed(&soup, v.position, distinct).angle_between(v.normal));
        away.fold(0.0, f32::max).to_degrees()
    };
    println!(
        "normals there differ from those weighed by angles by up to {:.2} degrees summed, {:.2} summed once each",
        of(false),
        of(true)
    );
    println!(
        "indexing it takes {} bytes instead of {}; {:.2} vertices a triangle miss a cache of 16, {:.2} in order",
        mesh.bytes(),
        24 * soup.len(),
        mesh.acmr(16),
        mesh.ordered().acmr(16)
    );
    Ok(())
}
