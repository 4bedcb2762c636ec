//! Buildings with rooms, doors, windows and furniture, made by rules.

use crate::scenes::Scene;
use glam::{Mat3, Vec3, vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// The sides of rooms, the height of a storey and the thickness of walls and floors, in metres.
const ROOM: f32 = 5.0;
const HIGH: f32 = 2.8;
const THICK: f32 = 0.2;
/// Openings: from the floor, height and width.
const DOOR: [f32; 3] = [0.0, 2.05, 0.95];
const WINDOW: [f32; 3] = [0.9, 1.3, 1.4];

/// The buildings that constants were chosen on: a flat, a turned house of three storeys, and a hall
/// among round columns, behind a fence.
pub fn all(seed: u64) -> Vec<Scene> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    vec![
        building("flat", [4, 1, 3], 0.0, &mut random),
        building("turned house", [3, 3, 3], 0.55, &mut random),
        hall(&mut random),
    ]
}

#[derive(Default)]
struct Build(Vec<[Vec3; 3]>);

impl Build {
    fn cuboid(&mut self, low: Vec3, high: Vec3) {
        for axis in 0..3 {
            for (from, flip) in [(low, false), (high, true)] {
                let (mut u, mut v) = (Vec3::ZERO, Vec3::ZERO);
                u[(axis + 1) % 3] = (high - low)[(axis + 1) % 3];
                v[(axis + 2) % 3] = (high - low)[(axis + 2) % 3];
                let (u, v) = if flip { (-u, -v) } else { (u, v) };
                self.0.extend([[from, from + u, from + u + v], [from, from + u + v, from + v]]);
            }
        }
    }

    fn column(&mut self, foot: Vec3, radius: f32, high: f32) {
        let at = |i: usize| {
            let (y, x) = (std::f32::consts::TAU * i as f32 / 24.0).sin_cos();
            foot + vec3(x, 0.0, y) * radius
        };
        for i in 0..24 {
            let (a, b, up) = (at(i), at(i + 1), Vec3::Y * high);
            self.0.extend([[a, b, b + up], [a, b + up, a + up]]);
        }
    }

    /// A wall along x or z from a place, with an opening in its middle.
    fn wall(&mut self, from: Vec3, along: usize, length: f32, opening: Option<[f32; 3]>) {
        let across = 2 - along;
        let mut part = |start: f32, end: f32, low: f32, high: f32| {
            let (mut a, mut b) = (from + Vec3::Y * low, from + Vec3::Y * high);
            a[along] += start;
            b[along] += end;
            a[across] -= THICK / 2.0;
            b[across] += THICK / 2.0;
            if (b - a).min_element() > 1e-3 {
                self.cuboid(a, b);
            }
        };
        let Some([sill, tall, wide]) = opening else { return part(0.0, length, 0.0, HIGH - THICK) };
        let (left, right) = ((length - wide) / 2.0, (length + wide) / 2.0);
        part(0.0, left, 0.0, HIGH - THICK);
        part(right, length, 0.0, HIGH - THICK);
        part(left, right, 0.0, sill);
        part(left, right, sill + tall, HIGH - THICK);
    }

    fn scene(self, name: &str, turn: f32, eyes: Vec<Vec3>) -> Scene {
        let turn = Mat3::from_rotation_y(turn);
        let triangles = self.0.into_iter().map(|t| t.map(|p| turn * p)).collect();
        Scene { name: name.into(), triangles, eyes: eyes.into_iter().map(|p| turn * p).collect() }
    }
}

/// Rooms side by side and above each other. Walls between them have doors or none, outer ones
/// windows or none. Eyes are in rooms and before the house.
fn building(name: &str, rooms: [usize; 3], turn: f32, random: &mut Pcg64Mcg) -> Scene {
    let mut build = Build::default();
    let [nx, ny, nz] = rooms;
    let size = vec3(nx as f32, 0.0, nz as f32) * ROOM;
    build.cuboid(vec3(-12.0, -0.6, -12.0), size + vec3(12.0, -0.4, 12.0));
    let edge = vec3(THICK, 0.0, THICK) / 2.0;
    for storey in 0..=ny {
        let y = HIGH * storey as f32;
        build.cuboid(vec3(0.0, y - THICK, 0.0) - edge, size + edge + Vec3::Y * y);
    }
    let mut eyes = vec![vec3(-6.0, 1.5, size.z / 2.0), vec3(size.x / 2.0 + 1.0, 4.0, -9.0)];
    for storey in 0..ny {
        for (along, across) in [(0, 2), (2, 0)] {
            for line in 0..=rooms[across] {
                for room in 0..rooms[along] {
                    let outer = line == 0 || line == rooms[across];
                    let mut from = Vec3::Y * HIGH * storey as f32;
                    from[along] = ROOM * room as f32;
                    from[across] = ROOM * line as f32;
                    let open = random.random_range(0..3) > 0;
                    let opening = if outer { WINDOW } else { DOOR };
                    build.wall(from, along, ROOM, open.then_some(opening));
                }
            }
        }
        for (x, z) in (0..nx).flat_map(|x| (0..nz).map(move |z| (x, z))) {
            let at = vec3(ROOM * x as f32, HIGH * storey as f32, ROOM * z as f32);
            furnish(&mut build, at, random);
            if (x + z + storey) % 3 == 1 {
                eyes.push(at + vec3(1.3, 1.6, 1.2));
            }
        }
    }
    build.scene(name, turn, eyes)
}

fn furnish(build: &mut Build, room: Vec3, random: &mut Pcg64Mcg) {
    for _ in 0..4 {
        let half =
            vec3(random.random_range(0.2..0.7), random.random_range(0.2..0.6), random.random_range(0.2..0.6));
        let x = random.random_range(1.2..ROOM - 1.0);
        let z = random.random_range(2.2..ROOM - 1.0);
        let middle = room + vec3(x, half.y, z);
        build.cuboid(middle - half, middle + half);
    }
}

/// A hall with columns and an inner room, a fence of slats before it.
fn hall(random: &mut Pcg64Mcg) -> Scene {
    let mut build = Build::default();
    build.cuboid(vec3(-10.0, -0.3, -10.0), vec3(30.0, -0.1, 22.0));
    for along in [0, 2] {
        for far in [0.0, if along == 0 { 3.0 * ROOM } else { 4.0 * ROOM }] {
            let rooms = if along == 0 { 4 } else { 3 };
            for room in 0..rooms {
                let mut from = Vec3::ZERO;
                from[along] = ROOM * room as f32;
                from[2 - along] = far;
                let opening = [Some(DOOR), Some(WINDOW), None][room % 3];
                build.wall(from, along, ROOM, opening);
            }
        }
    }
    build.cuboid(vec3(-0.1, HIGH - THICK, -0.1), vec3(4.0 * ROOM + 0.1, HIGH, 3.0 * ROOM + 0.1));
    for along in [0, 2] {
        for far in [0.0, ROOM] {
            let mut from = vec3(7.5, 0.0, 5.0);
            from[2 - along] += far;
            build.wall(from, along, ROOM, (along == 0 && far == 0.0).then_some(DOOR));
        }
    }
    for i in 0..5 {
        build.column(vec3(2.0 + 4.0 * i as f32, 0.0, 2.5), 0.3, HIGH - THICK);
        furnish(&mut build, vec3(7.5, 0.0, 5.0 + random.random_range(-0.2..0.2)), random);
        furnish(&mut build, vec3(13.0, 0.0, 8.0), random);
    }
    for i in 0..60 {
        let x = -4.0 + 0.45 * i as f32;
        build.cuboid(vec3(x, 0.0, -5.0), vec3(x + 0.12, 1.8, -4.96));
    }
    let eyes = vec![
        vec3(10.0, 1.6, -8.0),
        vec3(10.0, 1.6, 7.0),
        vec3(3.0, 1.6, 12.0),
        vec3(18.0, 1.6, 4.0),
        vec3(-6.0, 1.6, 6.0),
    ];
    build.scene("hall and fence", 0.0, eyes)
}
