//! The method of the thesis (Benevides, PUC-Rio 2015) beside the rays and the places that replaced
//! it, on generated sets like those of the thesis: how near the occlusion comes to 400 rays in
//! double precision, how much it changes when the picture moves, and its time by the number of
//! samples. Prints the tables of the README.
//!
//! `cargo run --release -p casca-lines --example thesis -- [receivers, 300 if none are given]`

use std::error::Error;
use std::time::Instant;

use casca_lines::buffers::{Fragment, LineBuffer};
use casca_lines::cells::Cells;
use casca_lines::glam::{DMat4, Vec3};
use casca_lines::numeric::{USUAL_RAYS, USUAL_SIDE_RAYS};
use casca_lines::occlusion::{AoOptions, Occlusion, Sides};
use casca_lines::samples::SampleSets;
use casca_lines::sets::LineSet;
use casca_lines::sets::generate::{Family, Recipe};
use casca_lines::sets::random::Random;
use casca_lines::slabs::SlabGrid;
use casca_lines::view::View;
use rayon::prelude::*;
use truth::{Tubes, agreement};

#[path = "../tests/truth/mod.rs"]
mod truth;

const SIZE: [u32; 2] = [480, 360];
/// The radius of the occlusion as a share of the extent.
const RADIUS: f32 = 0.13;
/// The square root of the rays of the truth.
const RAYS: u32 = 20;
/// The samples of the thesis, and its numbers of them whose time it takes.
const SAMPLES: u32 = 150;
const NUMBERS: [u32; 8] = [8, 16, 32, 64, 96, 128, 150, 256];
const SETS: u32 = 16;

/// A set in a view, with some of the pixels that show a line.
struct Case {
    lines: LineSet,
    view: View,
    receivers: Vec<([u32; 2], Fragment)>,
    radius: f32,
    /// Half of a pixel, in the middle of the depths.
    tube: f32,
}

impl Case {
    fn new(family: Family, most: usize) -> Result<Self, Box<dyn Error>> {
        let lines = Recipe::new(family, 1).make()?;
        let view = View::around(lines.bounds(), Vec3::new(0.5, 0.6, 1.0), Some(40f64.to_radians()), SIZE)?;
        let place = |i: usize| [i as u32 % SIZE[0], i as u32 / SIZE[0]];
        let buffer = LineBuffer::new(&lines, &view);
        let shown = buffer.fragments().iter().enumerate().filter_map(|(i, f)| Some((place(i), (*f)?)));
        // Steps that share no factor with the picture's width.
        let step = (buffer.covered() / most.max(1)).max(1) | 1;
        let receivers = shown.step_by(step).collect();
        let ([min, max], [near, far]) = (lines.bounds(), view.depths());
        let radius = RADIUS * (max - min).max_element();
        let tube = view.pixel_size((near + far) / 2.0) as f32 / 2.0;
        Ok(Self { lines, view, receivers, radius, tube })
    }

    /// The occlusion by rays in double precision.
    fn truth(&self) -> Vec<f64> {
        let tubes = Tubes::new(&self.lines, f64::from(self.tube));
        let one = |(i, (_, f)): (usize, &([u32; 2], Fragment))| {
            tubes.occlusion(&self.view, f, f64::from(self.radius), RAYS, &mut Random::new(i as u64))
        };
        self.receivers.par_iter().enumerate().map(one).collect()
    }

    /// By the thesis' columns, and microseconds a pixel on one thread.
    fn thesis(&self, view: &View, receivers: &[([u32; 2], Fragment)], samples: u32) -> (Vec<f64>, f64) {
        let grid = SlabGrid::of_lines(&self.lines, view);
        let sets = SampleSets::discs(samples, SETS, 1).expect("sets");
        let options = AoOptions::thesis(self.radius);
        values(Occlusion::by_columns(&grid, &sets, options).expect("options"), receivers)
    }

    fn rays(&self, view: &View, receivers: &[([u32; 2], Fragment)]) -> (Vec<f64>, f64) {
        let options = AoOptions::rays(self.radius, self.tube);
        let cells = Cells::new(&self.lines, options.margin());
        let sets = SampleSets::spirals(USUAL_RAYS, SETS, 1).expect("sets");
        values(Occlusion::by_rays(&cells, view, &sets, options).expect("options"), receivers)
    }

    fn places(&self, view: &View, receivers: &[([u32; 2], Fragment)]) -> (Vec<f64>, f64) {
        let options = AoOptions::places(self.radius, self.tube);
        let cells = Cells::new(&self.lines, options.margin());
        let sets = SampleSets::spirals(USUAL_SIDE_RAYS, SETS, 1).expect("sets");
        let sides = Sides::new(&self.lines, &cells, &sets, options).expect("options");
        values(Occlusion::by_places(&sides, view), receivers)
    }

    /// The root of the mean square change of each method at the same places of lines, when the
    /// picture moves.
    fn change(&self, view: &View) -> [f64; 3] {
        let by = view.eye_from_world() * self.view.eye_from_world().inverse();
        let moved = |(_, f): &([u32; 2], Fragment)| {
            let position = by.transform_point3(f.position.as_dvec3()).as_vec3();
            let tangent = (by.matrix3 * f.tangent.as_dvec3()).as_vec3();
            Some((view.pixel(position)?, Fragment { position, tangent, ..*f }))
        };
        let pairs = self.receivers.iter().filter_map(|old| Some((*old, moved(old)?)));
        let (old, new): (Vec<_>, Vec<_>) = pairs.unzip();
        let thesis = [(&self.view, &old), (view, &new)].map(|(view, at)| self.thesis(view, at, SAMPLES).0);
        let rays = [(&self.view, &old), (view, &new)].map(|(view, at)| self.rays(view, at).0);
        let places = [(&self.view, &old), (view, &new)].map(|(view, at)| self.places(view, at).0);
        [thesis, rays, places].map(|[old, new]| agreement(&old, &new)[1])
    }
}

/// The occlusion at receivers, and microseconds for each.
fn values(by: Occlusion<'_>, receivers: &[([u32; 2], Fragment)]) -> (Vec<f64>, f64) {
    let start = Instant::now();
    let at = |(pixel, f): &([u32; 2], Fragment)| f64::from(by.at(f, by.set_of(f, *pixel)));
    let all: Vec<f64> = receivers.iter().map(at).collect();
    (all, start.elapsed().as_secs_f64() * 1e6 / receivers.len().max(1) as f64)
}

/// The factor of least error, as the thesis' users set theirs by eye.
fn fitted(found: &[f64], wanted: &[f64]) -> f64 {
    let error = |factor: f64| {
        let scaled: Vec<f64> = found.iter().map(|v| (v * factor).min(1.0)).collect();
        agreement(&scaled, wanted)[1]
    };
    let all = (1..=80).map(|i| f64::from(i) * 0.05);
    all.min_by(|a, b| error(*a).total_cmp(&error(*b))).unwrap_or(1.0)
}

fn main() -> Result<(), Box<dyn Error>> {
    let most = std::env::args().nth(1).and_then(|word| word.parse().ok()).unwrap_or(300);
    let cases: Vec<(Family, Case)> = Family::ALL
        .into_iter()
        .map(|f| Ok((f, Case::new(f, most)?)))
        .collect::<Result<_, Box<dyn Error>>>()?;
    println!("Pearson correlation and RMSE to {} rays, {} x {} pixels:\n", RAYS * RAYS, SIZE[0], SIZE[1]);
    println!(
        "| set | thesis, factor 4 | thesis, fitted | {USUAL_RAYS} rays | places |\n|---|---:|---:|---:|---:|"
    );
    for (family, case) in &cases {
        let wanted = case.truth();
        let thesis = case.thesis(&case.view, &case.receivers, SAMPLES).0;
        let factor = fitted(&thesis, &wanted);
        let scaled: Vec<f64> = thesis.iter().map(|v| (v * factor).min(1.0)).collect();
        let [rays, places] =
            [case.rays(&case.view, &case.receivers).0, case.places(&case.view, &case.receivers).0];
        let cell = |found: &[f64]| agreement(found, &wanted).map(|v| format!("{v:.3}")).join(", ");
        let fit = format!("{} ({:.1})", cell(&scaled), 4.0 * factor);
        println!("| {} | {} | {fit} | {} | {} |", family.name(), cell(&thesis), cell(&rays), cell(&places));
    }
    println!("\nRMS change at the same places of lines: thesis, rays, places\n");
    println!("| set | a pixel to the right | turned by 0.2° |\n|---|---:|---:|");
    for (family, case) in &cases {
        let turn = DMat4::from_rotation_y(0.2f64.to_radians()) * DMat4::from(case.view.eye_from_world());
        let turned = View::new(turn, case.view.lens(), case.view.depths(), SIZE)?;
        let cells = [case.view.moved_by_pixels(1.0, 0.0), turned]
            .map(|view| case.change(&view).map(|v| format!("{v:.3}")).join(", "));
        println!("| {} | {} |", family.name(), cells.join(" | "));
    }
    let (_, spiral) = &cases[0];
    println!("\nMicroseconds a pixel of the spiral, one thread; the thesis' by its samples:\n");
    let least = |run: &dyn Fn() -> f64| (0..3).map(|_| run()).fold(f64::INFINITY, f64::min);
    for samples in NUMBERS {
        let time = least(&|| spiral.thesis(&spiral.view, &spiral.receivers, samples).1);
        println!("{samples:4} samples {time:8.2}");
    }
    let rays = least(&|| spiral.rays(&spiral.view, &spiral.receivers).1);
    println!("{USUAL_RAYS:4} rays    {rays:8.2}");
    Ok(())
}
