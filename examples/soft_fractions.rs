//! Prints how far the bounds of visible fractions are from the truth, which rays find among the
//! shapes themselves, in four kinds of scenes: `cargo run --release --features soft --example
//! soft_fractions`

use casca::glam::{UVec3, Vec3};
use casca::soft::{Layer, SoftGrid};
use casca::{Aabb, Error, GridSpec, Sphere};

/// The scenes are cubes of this edge.
const SIZE: f32 = 64.0;
/// Pairs of an eye and a ball of which something is seen, for each row.
const PAIRS: usize = 300;
/// Rays of an answer, and of the truth.
const RAYS: u32 = 64;
const TRUE_RAYS: u32 = 1024;

/// Numbers from 0 to 1 that look random (Knuth's generator).
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    fn between(&mut self, from: f32, to: f32) -> f32 {
        from + (to - from) * self.next()
    }

    fn point(&mut self, from: f32, to: f32) -> Vec3 {
        Vec3::from_array([(); 3].map(|()| self.between(from, to)))
    }
}

/// Makes the shapes of a scene.
type Maker = fn(&mut Dice) -> Vec<Aabb>;

/// Boxes at random.
fn boxes(dice: &mut Dice) -> Vec<Aabb> {
    (0..60).map(|_| Aabb::from_center(dice.point(0.0, SIZE), dice.point(0.5, 4.0))).collect()
}

/// Rooms of 8 x 8 with walls of 0.2, as high as the scene, and a door in each wall.
fn rooms(dice: &mut Dice) -> Vec<Aabb> {
    let mut walls = Vec::new();
    for line in 1..8 {
        for part in 0..8 {
            for along in [0, 2] {
                let (at, from) = (line as f32 * 8.0, part as f32 * 8.0);
                let door = from + dice.between(1.0, 5.5);
                for (from, to) in [(from, door), (door + 1.5, from + 8.0)] {
                    let (mut min, mut max) = (Vec3::splat(from), Vec3::splat(to));
                    (min[2 - along], max[2 - along]) = (at - 0.1, at + 0.1);
                    (min.y, max.y) = (0.0, SIZE);
                    walls.push(Aabb::new(min, max));
                }
            }
        }
    }
    walls
}

/// Trunks of 0.4 to 1.2 in width.
fn forest(dice: &mut Dice) -> Vec<Aabb> {
    let trunk = |_| {
        let (at, half) = (dice.point(0.0, SIZE), dice.between(0.2, 0.6));
        Aabb::new(Vec3::new(at.x - half, 0.0, at.z - half), Vec3::new(at.x + half, SIZE, at.z + half))
    };
    (0..400).map(trunk).collect()
}

/// Houses in rows, with streets of 3 between them.
fn town(dice: &mut Dice) -> Vec<Aabb> {
    let house = |i: u8| {
        let corner = Vec3::new(f32::from(i % 6), 0.0, f32::from(i / 6)) * 11.0;
        Aabb::new(corner, corner + Vec3::new(8.0, dice.between(8.0, SIZE), 8.0))
    };
    (0..36).map(house).collect()
}

/// Whether a segment meets a box.
fn meets(shape: &Aabb, from: Vec3, to: Vec3) -> bool {
    let (way, mut near, mut far) = (to - from, 0.0f32, 1.0f32);
    for axis in 0..3 {
        let (a, b) = ((shape.min[axis] - from[axis]) / way[axis], (shape.max[axis] - from[axis]) / way[axis]);
        (near, far) = (near.max(a.min(b)), far.min(a.max(b)));
    }
    near <= far
}

/// The share of a ball that an eye sees: random directions of the cone around it.
fn truth(shapes: &[Aabb], eye: Vec3, ball: &Sphere, dice: &mut Dice) -> f32 {
    let (mut open, mut all) = (0, 0);
    while all < TRUE_RAYS {
        let direction = (ball.center + dice.point(-ball.radius, ball.radius) - eye).normalize();
        let way = ball.center - eye;
        let middle = way.dot(direction);
        let half = ball.radius * ball.radius - way.length_squared() + middle * middle;
        // Even in solid angle: a point of the cube is taken with a chance by the angle it stands for.
        if half < 0.0 || dice.next() > (middle / way.length()).powi(3) {
            continue;
        }
        all += 1;
        let to = eye + direction * (middle - half.sqrt());
        open += u32::from(!shapes.iter().any(|shape| meets(shape, eye, to)));
    }
    open as f32 / all as f32
}

fn main() -> Result<(), Error> {
    println!(
        "scene  | ball | cells | truth | least: error | middle | most | truth within 0.1 of the bounds | wholly seen: least, most"
    );
    let scenes: [(&str, Maker); 4] = [("boxes", boxes), ("rooms", rooms), ("forest", forest), ("town", town)];
    for (name, make) in scenes {
        for radius in [0.3, 2.0] {
            let shapes = make(&mut Dice(5));
            let mut pairs = Vec::new();
            let mut dice = Dice(9);
            while pairs.len() < PAIRS {
                let (eye, center) = (dice.point(2.0, SIZE - 2.0), dice.point(2.0, SIZE - 2.0));
                let ball = Sphere::new(center, radius);
                let apart = |p: Vec3, r: f32| shapes.iter().all(|s| p.clamp(s.min, s.max).distance(p) > r);
                if eye.distance(center) > 4.0 * radius + 1.0 && apart(eye, 0.2) && apart(center, radius + 0.2)
                {
                    let share = truth(&shapes, eye, &ball, &mut dice);
                    if share > 0.0 {
                        pairs.push((eye, ball, share));
                    }
                }
            }
            for n in [32, 64, 128, 256] {
                let cell = SIZE / n as f32;
                let mut soft = SoftGrid::new(&GridSpec { min: Vec3::ZERO, cell, dims: UVec3::splat(n) })?;
                for shape in &shapes {
                    soft.insert(*shape, Layer::Fixed)?;
                }
                soft.rebuild();
                let (mut errors, mut mean, mut within) = ([0.0; 3], 0.0, 0);
                let (mut whole, mut ends) = (0, [0.0; 2]);
                for (eye, ball, share) in &pairs {
                    let seen = soft.visible_fraction(*eye, *ball, RAYS)?;
                    for (error, answer) in errors.iter_mut().zip([seen.least, seen.middle(), seen.most]) {
                        *error += (answer - share).abs() / PAIRS as f32;
                    }
                    mean += share / PAIRS as f32;
                    within += usize::from((seen.least - 0.1..=seen.most + 0.1).contains(share));
                    if *share == 1.0 {
                        whole += 1;
                        ends = [ends[0] + seen.least, ends[1] + seen.most];
                    }
                }
                let ends = ends.map(|end| end / whole.max(1) as f32);
                println!(
                    "{name:6} | {radius:4} | {n:5} | {mean:.2}  | {:.3}        | {:.3}  | {:.3} | {:5.1} % | {:.2}, {:.2}",
                    errors[0],
                    errors[1],
                    errors[2],
                    100.0 * within as f32 / PAIRS as f32,
                    ends[0],
                    ends[1],
                );
            }
        }
    }
    Ok(())
}
