//! The speed of the splat operator: `cargo run --release -p casca-points --example splat_speed -- [POINTS] [ROUNDS]`.
//!
//! Points on a sphere with waves, in random order, all in the picture.

use casca_points::splat::{Bias, Filter, Radius, SplatOptions, visible_points};
use casca_points::{Camera, spacing};
use glam::Vec3;
use rand::{RngExt, SeedableRng};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut numbers = std::env::args().skip(1).filter_map(|arg| arg.parse().ok());
    let (count, rounds) = (numbers.next().unwrap_or(10_000_000), numbers.next().unwrap_or(9).max(1));
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(1);
    let mut wave = || {
        let (z, angle) = (random.random::<f32>() * 2.0 - 1.0, random.random::<f32>() * std::f32::consts::TAU);
        let p = Vec3::new((1.0 - z * z).sqrt() * angle.cos(), (1.0 - z * z).sqrt() * angle.sin(), z);
        p * (1.0 + 0.1 * (9.0 * p.x).sin() * (7.0 * p.y).sin() * (8.0 * p.z).sin())
    };
    let points: Vec<Vec3> = (0..count).map(|_| wave()).collect();
    let start = Instant::now();
    let automatic = spacing::automatic_radius(&points)?;
    println!("automatic radius {automatic:.5} in {:.2} s", start.elapsed().as_secs_f64());
    let each = vec![automatic; count];
    for size in [(640, 480), (1024, 768), (2048, 1536)] {
        let camera = Camera::look_at(Vec3::new(0.0, -3.0, 1.0), Vec3::ZERO, Vec3::Z, 0.8, size, 0.1, 10.0)?;
        let one = Radius::Same(automatic);
        let cases = [
            ("one radius", one, false),
            ("one radius, slopes", one, true),
            ("eight times as large", Radius::Same(8.0 * automatic), false),
            ("a radius each", Radius::Each(&each), false),
            ("a radius each, slopes", Radius::Each(&each), true),
        ];
        for (name, radius, slopes) in cases {
            let options =
                SplatOptions { radius, bias: Bias::World(8.0 * automatic), filter: Filter::Max, slopes };
            let mut seconds: Vec<f64> = Vec::new();
            let mut visible = 0;
            for _ in 0..rounds {
                let start = Instant::now();
                visible = visible_points(&points, &camera, &options)?.visible.count_ones();
                seconds.push(start.elapsed().as_secs_f64());
            }
            seconds.sort_by(f64::total_cmp);
            let median = seconds[rounds / 2];
            println!(
                "{size:?}, {name}: {:.0} million points/s, median of {rounds}, best {:.0}, {visible} visible",
                count as f64 / seconds[0] / 1e6,
                count as f64 / median / 1e6
            );
        }
    }
    Ok(())
}
