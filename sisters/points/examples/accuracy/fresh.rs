//! Scenes that no constant and no rule of `surface` was chosen on, and whose results changed
//! nothing: they tell how well the others hold.

use crate::scenes::{Build, Scene};
use glam::{Quat, Vec3, vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::f32::consts::TAU;

pub fn scenes(seed: u64) -> Vec<Scene> {
    let mut random = Pcg64Mcg::seed_from_u64(seed ^ 0xf7e5);
    vec![bicycle(), shelf(&mut random), street(&mut random)]
}

/// The middle, radius and number of parts of a ring of tubes.
type Ring = (Vec3, f32, usize);

fn ring(build: &mut Build, (middle, radius, parts): Ring, thick: f32) {
    let at =
        |i: usize| middle + radius * Quat::from_rotation_z(TAU * i as f32 / parts as f32).mul_vec3(Vec3::X);
    for i in 0..parts {
        build.tube([at(i), at(i + 1)], [thick, thick], 10);
    }
}

/// Two wheels with spokes and a frame, before a grating and a wall.
fn bicycle() -> Scene {
    let mut build = Build::default();
    build.cuboid(vec3(-1.6, -0.05, -1.0), vec3(1.6, 0.0, 1.0));
    build.cuboid(vec3(-1.6, 0.0, -1.05), vec3(1.6, 1.6, -1.0));
    for x in [-0.52, 0.52] {
        let hub = vec3(x, 0.34, 0.0);
        ring(&mut build, (hub, 0.33, 36), 0.018);
        build.tube([hub - Vec3::Z * 0.05, hub + Vec3::Z * 0.05], [0.025, 0.025], 10);
        for i in 0..18 {
            let out = Quat::from_rotation_z(TAU * i as f32 / 18.0).mul_vec3(Vec3::X);
            build.tube([hub + out * 0.02, hub + out * 0.32], [0.003, 0.003], 6);
        }
    }
    let [rear, front, crank] = [vec3(-0.52, 0.34, 0.0), vec3(0.52, 0.34, 0.0), vec3(-0.08, 0.32, 0.0)];
    let [seat, head] = [vec3(-0.22, 0.85, 0.0), vec3(0.4, 0.8, 0.0)];
    for (a, b) in [(rear, crank), (rear, seat), (crank, seat), (crank, head), (seat, head), (head, front)] {
        build.tube([a, b], [0.018, 0.018], 12);
    }
    build.cuboid(seat + vec3(-0.12, 0.06, -0.06), seat + vec3(0.14, 0.1, 0.06));
    build.tube([head + vec3(0.0, 0.12, -0.25), head + vec3(0.0, 0.12, 0.25)], [0.014, 0.014], 10);
    for i in 0..30 {
        let x = -1.45 + 0.1 * i as f32;
        build.cuboid(vec3(x, 0.0, -0.52), vec3(x + 0.03, 1.3, -0.5));
    }
    build.cuboid(vec3(-1.5, 1.3, -0.53), vec3(1.5, 1.36, -0.49));
    build.scene("bicycle", &[vec3(0.3, 1.2, 2.4), vec3(-2.0, 1.0, 1.5), vec3(2.2, 0.7, 0.9)])
}

/// Books that stand, lean and lie in an open shelf without a back, and a wall behind it.
fn shelf(random: &mut Pcg64Mcg) -> Scene {
    let mut build = Build::default();
    build.cuboid(vec3(-2.0, -0.1, -0.7), vec3(2.0, 2.4, -0.6));
    build.cuboid(vec3(-2.0, -0.1, -0.6), vec3(2.0, 0.0, 2.0));
    for x in [-1.5, -0.51, 0.49, 1.48] {
        build.cuboid(vec3(x, 0.0, 0.0), vec3(x + 0.02, 2.1, 0.32));
    }
    for level in 0..6 {
        let y = 0.05 + 0.4 * level as f32;
        build.cuboid(vec3(-1.48, y, 0.0), vec3(1.48, y + 0.02, 0.32));
        for column in 0..3 {
            let (mut x, end) = (-1.46 + 0.99 * column as f32, -0.53 + 0.99 * column as f32);
            while level < 5 && x < end - 0.12 {
                let (w, h) = (random.random_range(0.015..0.05), random.random_range(0.2..0.34));
                let deep = random.random_range(0.12..0.22);
                let low = vec3(x, y + 0.02, 0.3 - deep);
                match random.random_range(0..12) {
                    0 => x += random.random_range(0.05..0.3),
                    1 => {
                        let size = vec3(0.08, h, deep);
                        build.turned(
                            low + size / 2.0,
                            vec3(w, h * 0.95, deep) / 2.0,
                            Quat::from_rotation_z(-0.2),
                        );
                        x += 0.12;
                    }
                    _ => {
                        build.cuboid(low, low + vec3(w, h, deep));
                        x += w + 0.001;
                    }
                }
            }
        }
    }
    build.scene("bookshelf", &[vec3(0.4, 1.5, 2.6), vec3(-1.8, 1.2, 1.6), vec3(1.2, 0.7, 1.2)])
}

/// Houses with windows along a street, trees of balls on stems, a bench, lamps and cars.
fn street(random: &mut Pcg64Mcg) -> Scene {
    let mut build = Build::default();
    build.cuboid(vec3(-20.0, -0.3, -9.0), vec3(20.0, 0.0, 9.0));
    for side in [-1.0_f32, 1.0] {
        for house in 0..4 {
            let (x, high) = (-19.0 + 9.6 * house as f32, random.random_range(5.0..9.0_f32));
            let front = side * 7.0;
            let (low, far) = (front.min(side * 9.0), front.max(side * 9.0));
            build.cuboid(vec3(x, 0.0, low), vec3(x + 8.5, high, far));
            for i in 0..12 {
                let at = vec3(x + 0.8 + 1.9 * (i % 4) as f32, 1.0 + 1.4 * (i / 4) as f32, front);
                build.turned(at + Vec3::Y * 0.45, vec3(0.5, 0.05, 0.2), Quat::IDENTITY);
                build.turned(at, vec3(0.04, 0.5, 0.08), Quat::IDENTITY);
            }
        }
        for i in 0..9 {
            let foot = vec3(-17.0 + 4.2 * i as f32, 0.0, side * 4.5);
            let high = random.random_range(1.8..2.6);
            build.tube([foot, foot + Vec3::Y * high], [0.14, 0.09], 10);
            for _ in 0..7 {
                let shift = Vec3::from_array(std::array::from_fn(|_| random.random_range(-0.7..0.7)));
                build.ball(foot + Vec3::Y * (high + 0.7) + shift, random.random_range(0.3..0.6));
            }
            build.tube([foot + Vec3::X * 2.0, foot + vec3(2.0, 4.0, 0.0)], [0.05, 0.04], 8);
        }
        for i in 0..5 {
            let at = vec3(-15.0 + 7.0 * i as f32 + random.random_range(-1.0..1.0), 0.0, side * 2.6);
            build.cuboid(at + vec3(-2.0, 0.25, -0.8), at + vec3(2.0, 0.85, 0.8));
            build.cuboid(at + vec3(-1.2, 0.85, -0.7), at + vec3(1.0, 1.4, 0.7));
            for (x, z) in [(-1.3, -0.7), (1.3, -0.7), (-1.3, 0.7), (1.3, 0.7_f32)] {
                let wheel = at + vec3(x, 0.3, z);
                build.tube([wheel - Vec3::Z * 0.1, wheel + Vec3::Z * 0.1], [0.3, 0.3], 16);
            }
        }
    }
    build.scene("street", &[vec3(-18.0, 1.7, 0.5), vec3(6.0, 6.0, 0.0), vec3(1.0, 1.6, -3.8)])
}
