//! Prints the costs of soft visibility: nanoseconds for each question beside the error of its
//! answer, and bytes, at three resolutions of one scene: `cargo run --release --features soft
//! --example soft_costs`

use std::time::Instant;

use casca::glam::{UVec3, Vec3};
use casca::soft::{Cone, Layer, March, SoftGrid};
use casca::{Aabb, Error, GridSpec, Sphere};

/// Questions of each kind.
const QUESTIONS: usize = 2000;
/// Runs of each.
const RUNS: usize = 5;

/// Numbers from 0 to 1 that look random (Knuth's generator).
fn random(state: &mut u64) -> f32 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 40) as f32 / (1u64 << 24) as f32
}

fn point(state: &mut u64, from: f32, to: f32) -> Vec3 {
    Vec3::from_array([(); 3].map(|()| from + (to - from) * random(state)))
}

/// A room of 64 units with 60 boxes and balls, in cells of 64 / n.
fn room(n: u32) -> Result<SoftGrid, Error> {
    let mut soft =
        SoftGrid::new(&GridSpec { min: Vec3::ZERO, cell: 64.0 / n as f32, dims: UVec3::splat(n) })?;
    let mut state = 7;
    for i in 0..60 {
        let (at, half) = (point(&mut state, 0.0, 64.0), point(&mut state, 0.5, 4.0));
        match i % 3 {
            0 => soft.insert(Sphere::new(at, half.x), Layer::Fixed)?,
            _ => soft.insert(Aabb::from_center(at, half), Layer::Fixed)?,
        };
    }
    soft.rebuild();
    Ok(soft)
}

/// The time of a question in nanoseconds: the mean of each one's quickest run, since other programs
/// interrupt. And the answers.
fn ask<T>(
    questions: &[T],
    mut answer: impl FnMut(&T) -> Result<f32, Error>,
) -> Result<(f64, Vec<f32>), Error> {
    let (mut times, mut answers) = (vec![f64::INFINITY; questions.len()], Vec::new());
    for _ in 0..RUNS {
        answers.clear();
        for (question, time) in questions.iter().zip(&mut times) {
            let start = Instant::now();
            answers.push(answer(question)?);
            *time = time.min(start.elapsed().as_nanos() as f64);
        }
    }
    Ok((times.iter().sum::<f64>() / times.len() as f64, answers))
}

fn print(n: u32, question: &str, (time, answers): (f64, Vec<f32>), truth: &[f32]) {
    let error = answers.iter().zip(truth).map(|(a, b)| (a - b).abs()).sum::<f32>() / truth.len() as f32;
    println!("{n:4} | {question:42} | {time:9.0} ns | {error:.3}");
}

fn main() -> Result<(), Error> {
    println!(
        "   N | question                                   | time         | mean error against many rays in this grid"
    );
    for n in [64, 128, 256] {
        let soft = room(n)?;
        let mut state = 1;
        let open = |p: &Vec3| !soft.pyramid().any(0, soft.grid().cell_of(p.as_dvec3()));
        let places = std::iter::repeat_with(|| point(&mut state, 1.0, 63.0)).filter(open).take(QUESTIONS);
        let places: Vec<Vec3> = places.collect();
        let pairs: Vec<(Vec3, Vec3)> = places.iter().copied().zip(places.iter().rev().copied()).collect();
        let clear = |&(a, b): &(Vec3, Vec3)| Ok(f32::from(u8::from(soft.first_hit(a, b)?.is_none())));
        let walks = ask(&pairs, clear)?;
        print(n, "segment, 33 units on average", walks.clone(), &walks.1);
        for (name, degrees) in [("1", 1f32), ("10", 10.0), ("30", 30.0)] {
            let cone = |march: March| {
                let soft = &soft;
                move |&(apex, to): &(Vec3, Vec3)| {
                    let tan = degrees.to_radians().tan();
                    Ok(soft
                        .cone(&Cone { apex, direction: to - apex, tan, reach: 30.0 }, &march)?
                        .transmittance)
                }
            };
            let few = &pairs[..QUESTIONS / 10];
            let (_, truth) = ask(few, cone(March::Rays(1024)))?;
            let samples = |step, corrected| March::Samples { step, start: 2.0, first: 2.0, corrected };
            for (way, march) in [
                ("slabs", March::Slabs),
                ("old rule, step 0.5", samples(0.5, false)),
                ("corrected, step 0.5", samples(0.5, true)),
                ("corrected, step 0.25", samples(0.25, true)),
                ("4 rays", March::Rays(4)),
                ("16 rays", March::Rays(16)),
                ("64 rays", March::Rays(64)),
            ] {
                print(n, &format!("cone of {name} degrees, {way}"), ask(few, cone(march))?, &truth);
            }
        }
        let sky = |march: March| {
            let soft = &soft;
            move |&(at, to): &(Vec3, Vec3)| soft.ambient_occlusion(at, to - at, 30.0, &march)
        };
        let few = &pairs[..QUESTIONS / 10];
        let (_, truth) = ask(few, sky(March::Rays(4096)))?;
        for (way, march) in [
            ("slabs", March::Slabs),
            ("old rule", March::OLD),
            ("corrected", March::Samples { step: 0.5, start: 0.0, first: 1.0, corrected: true }),
            ("4 rays", March::Rays(4)),
            ("16 rays", March::Rays(16)),
            ("64 rays", March::Rays(64)),
            ("256 rays", March::Rays(256)),
        ] {
            print(n, &format!("ambient occlusion, {way}"), ask(few, sky(march))?, &truth);
        }
        let balls: Vec<(Vec3, Sphere)> =
            pairs.iter().map(|&(a, b)| (a, Sphere::new(b, 2.0))).take(200).collect();
        let seen = |rays| {
            let soft = &soft;
            move |&(eye, ball): &(Vec3, Sphere)| Ok(soft.visible_fraction(eye, ball, rays)?.middle())
        };
        let (_, truth) = ask(&balls, seen(4096))?;
        for rays in [8, 32, 128] {
            print(n, &format!("visible fraction of a ball, {rays} rays"), ask(&balls, seen(rays))?, &truth);
        }
        let mut moved = soft.clone();
        let id = moved.insert(Sphere::new(Vec3::splat(20.0), 2.0), Layer::Moving)?;
        let (time, _) = ask(&balls, |&(_, ball)| {
            moved.update(id, ball)?;
            Ok(moved.rebuild() as f32)
        })?;
        println!("{n:4} | a ball of radius 2 moves, with rebuild      | {time:9.0} ns |");
        let start = Instant::now();
        let again = room(n)?;
        println!(
            "{n:4} | all from the start                         | {:9.0} ns |",
            start.elapsed().as_nanos()
        );
        let (held, dense) = (again.memory_bytes(), 20.43 * f64::from(n).powi(3));
        println!("{n:4} | memory: {held} bytes, {:.3} of the dense volumes' 20.43 N^3", held as f64 / dense);
    }
    Ok(())
}
