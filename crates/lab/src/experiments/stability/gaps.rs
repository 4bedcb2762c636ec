//! Slits in a wall, and behind each of them an object that is known to be seen through it.

use std::f32::consts::TAU;

use glam::{DVec3, Quat, Vec3};

use super::case::{ASPECT, Case, Known, block, dice, glass, hexahedron, placed, quad, solid, sphere, still};
use super::run::HZB;
use crate::experiments::{Lab, LabError};
use casca_scenes::world::{Camera, Shape};

/// Of the grid, in metres.
const CELL: f32 = 0.125;
/// From the eye to the wall.
const DISTANCE: f32 = 10.0;
/// The wall reaches this far from its middle to all sides.
const REACH: f32 = 14.0;
/// Slits lie at most this far from the middle.
const SPREAD: f32 = 8.5;
const FOV: f32 = 60.0;

/// What a wall is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Wall {
    /// Boxes a quarter as thick as the slits are wide, 0.1 m at most.
    Boxes,
    /// Meshes without thickness.
    Sheets,
    /// Closed meshes 1 m thick whose sides run along the lines of sight.
    Wedges,
}

/// The width of a pixel of the usual rasterised buffer on the wall, in metres.
fn pixel() -> f32 {
    2.0 * DISTANCE * (FOV.to_radians() * 0.5).tan() * ASPECT / HZB as f32
}

/// The widths of slits: a name, and metres.
fn widths() -> Vec<(String, f32)> {
    let cells = ("10 cells".to_owned(), 10.0 * CELL);
    let pixels = [10.0, 3.0, 1.0, 0.5, 0.2, 0.1, 0.03, 0.01f32];
    let pixels =
        pixels.map(|n| (if n == 1.0 { "1 pixel".to_owned() } else { format!("{n} pixels") }, n * pixel()));
    std::iter::once(cells).chain(pixels).collect()
}

/// How many pixels wide the slits of each width are, in the order of the cases of a wall.
#[cfg(test)]
pub(super) fn widths_in_pixels() -> Vec<f64> {
    widths().iter().map(|w| f64::from(w.1 / pixel())).collect()
}

/// A piece of the wall between two places along it.
fn strip(wall: Wall, x0: f32, x1: f32, slit: f32) -> Shape {
    let at = |x, y, z| Vec3::new(x, y, z);
    match wall {
        Wall::Boxes => {
            let back = -DISTANCE - (slit * 0.25).min(0.1);
            block(at(x0, -REACH, back), at(x1, REACH, -DISTANCE))
        }
        Wall::Sheets => quad([
            at(x0, -REACH, -DISTANCE),
            at(x1, -REACH, -DISTANCE),
            at(x1, REACH, -DISTANCE),
            at(x0, REACH, -DISTANCE),
        ]),
        Wall::Wedges => {
            let grown = (DISTANCE + 1.0) / DISTANCE;
            hexahedron([0, 1, 2, 3, 4, 5, 6, 7].map(|i| {
                let (x, y) = (if i & 1 == 0 { x0 } else { x1 }, if i & 2 == 0 { -REACH } else { REACH });
                if i & 4 == 0 { at(x * grown, y, -DISTANCE - 1.0) } else { at(x, y, -DISTANCE) }
            }))
        }
    }
}

fn case(wall: Wall, name: &str, slit: f32, lab: &Lab) -> Result<Case, LabError> {
    let mut dice = dice(lab.seed, 2);
    let count = (SPREAD / slit).floor().clamp(1.0, 40.0);
    let pitch = 2.0 * SPREAD / count;
    let slits: Vec<f32> = (0..count as usize)
        .map(|i| {
            let room = (pitch - slit).max(0.0) * 0.4;
            -SPREAD + pitch * (i as f32 + 0.5) + dice.range(-room, room)
        })
        .collect();
    let mut objects = Vec::new();
    let mut from = -REACH;
    for &x in slits.iter().chain([&(REACH + slit)]) {
        objects.push(solid("wall", strip(wall, from, (x - slit * 0.5).min(REACH), slit)));
        from = x + slit * 0.5;
    }
    // Where the line of sight through the middle of a slit is in the middle of the wall, too.
    let depth = match wall {
        Wall::Boxes => DISTANCE + (slit * 0.25).min(0.1) * 0.5,
        Wall::Sheets | Wall::Wedges => DISTANCE,
    };
    let mut known = Vec::new();
    for &x in &slits {
        let way =
            DVec3::new(f64::from(x), f64::from(dice.range(-3.5, 3.5)), -f64::from(depth)) / f64::from(depth);
        let radius = dice.range(0.1, 0.2);
        let center = (way * f64::from(dice.range(12.0, 15.0))).as_vec3();
        // The point where the line of sight comes nearest to the centre, moved onto the surface.
        let along = way * (center.as_dvec3().dot(way) / way.length_squared());
        let back = (f64::from(radius).powi(2) - along.distance_squared(center.as_dvec3())).max(0.0).sqrt();
        known.push(Known { object: objects.len(), point: along - way.normalize() * back });
        objects.push(glass("target", sphere(center, radius)));
    }
    for _ in 0..lab.pick(300, 100) {
        let center = dice.point(Vec3::new(-12.0, -12.0, -23.0), Vec3::new(12.0, 12.0, -12.0));
        objects.push(glass("hidden", sphere(center, dice.range(0.05, 0.2))));
    }
    let base = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, FOV, ASPECT, 0.1, 100.0);
    let frames = lab.pick(6, 3);
    // Upright first, then tilted, and turned a little so that slits meet pixels anywhere.
    let cameras = (0..frames).map(|i| {
        let roll = Quat::from_rotation_z(0.7 * (i as f32 / frames as f32));
        let turn = Quat::from_rotation_y(0.03 * (TAU * 0.37 * i as f32).sin());
        placed(&base, Vec3::ZERO, turn * roll)
    });
    Ok(Case::new(name, objects, CELL, still(cameras)).with_known(known))
}

/// Each wall with slits of each width.
pub(super) fn cases(lab: &Lab) -> Result<Vec<Case>, LabError> {
    let mut cases = Vec::new();
    for (wall, what) in
        [(Wall::Boxes, "thin boxes"), (Wall::Sheets, "mesh sheets"), (Wall::Wedges, "closed meshes")]
    {
        for (width, metres) in widths() {
            let case = case(wall, &format!("{what}, slits of {width}"), metres, lab)?;
            cases.push(case);
        }
    }
    Ok(cases)
}
