//! The town of the example and of the window, of any size: one house to twenty things around it.

use super::{Component, Transform, Vec3};

/// From the middle of a house to that of the next one, in metres.
const PITCH: f32 = 24.0;

/// The side of a house.
const HOUSE: f32 = 16.0;

/// What a box of the town is.
#[derive(Component, PartialEq)]
pub enum Part {
    Ground,
    House,
    Thing,
}

/// Numbers that look like chance.
pub fn dice(n: usize) -> f32 {
    let x = (n as u32).wrapping_mul(0x9e37_79b9).rotate_left(13).wrapping_mul(0x85eb_ca6b);
    ((x ^ x >> 15).wrapping_mul(0xc2b2_ae35) >> 8) as f32 / (1 << 24) as f32
}

/// So many boxes, with their numbers, middles and sizes.
pub fn boxes(size: usize) -> impl Iterator<Item = (Part, usize, Vec3, Vec3)> {
    let row = ((size / 20) as f32).sqrt().ceil() as usize;
    let side = row as f32 * PITCH;
    let ground = Vec3::new(side + 50.0, 1.0, side + 50.0);
    let houses = (0..row * row).map(move |i| {
        let height = 8.0 + 30.0 * dice(i);
        let (x, z) = ((i % row) as f32 * PITCH - side / 2.0, (i / row) as f32 * PITCH - side / 2.0);
        (Part::House, i, Vec3::new(x, height / 2.0, z), Vec3::new(HOUSE, height, HOUSE))
    });
    let things = (row * row + 1..size).map(move |i| {
        let middle = Vec3::new((dice(i) - 0.5) * side, 0.9, (dice(i + 77_777) - 0.5) * side);
        (Part::Thing, i, middle, Vec3::new(0.6, 1.8, 0.4))
    });
    [(Part::Ground, 0, Vec3::new(0.0, -0.5, 0.0), ground)].into_iter().chain(houses).chain(things)
}

/// Where the camera is on its way along a street, from 0 to 1: it looks around.
pub fn street(t: f32) -> Transform {
    let at = Vec3::new(-PITCH / 2.0, 1.7, 20.0 - 20.0 * t);
    Transform::from_translation(at).looking_to(Vec3::new((3.0 * t).sin(), 0.0, -(3.0 * t).cos()), Vec3::Y)
}
