//! How near the occlusion of lines comes to that of rays, on kinds of sets that the library does
//! not make, at the program's default settings; how much it changes from one frame to the next; and
//! its costs. Prints tables in Markdown.
//!
//! `cargo run --release -p casca-lines --example accuracy -- [receivers] [words of kinds...]`
//!
//! With `--simplified` it compares simplified lines with the truth of those that they were made of.
//! With `--pictures FOLDER` it draws the first of these kinds by each method and by rays instead.

mod kinds;
mod methods;
mod pictures;
mod simplified;
mod truth;

use std::error::Error;

use casca_lines::buffers::{Fragment, LineBuffer};
use casca_lines::glam::{DMat4, DQuat, DVec3, Vec3};
use casca_lines::sets::LineSet;
use casca_lines::sets::random::Random;
use casca_lines::view::View;
use kinds::{KINDS, Kind};
use methods::{METHODS, Setting};
use rayon::prelude::*;
use truth::Tubes;

/// The radius of the occlusion as a share of the extent, and half of a pixel for tubes, as the
/// program has them.
const RADIUS: f32 = 0.13;
/// The square root of the rays of the truth.
const RAYS: u32 = 20;
/// Pixels whose time is taken.
const BLOCK: usize = 4000;
const SIZES: [[u32; 2]; 2] = [[480, 360], [1440, 1080]];

/// A set in a view, with some of the pixels that show a line.
struct Case {
    lines: LineSet,
    view: View,
    buffer: LineBuffer,
    receivers: Vec<([u32; 2], Fragment)>,
    /// Pixels side by side, whose time is taken: as in a picture, they use the same cells.
    block: Vec<([u32; 2], Fragment)>,
    setting: Setting,
}

impl Case {
    fn new(kind: &Kind, size: [u32; 2], most: usize) -> Result<Self, Box<dyn Error>> {
        let lines = kind.lines(1)?;
        let view = View::around(lines.bounds(), Vec3::new(0.5, 0.6, 1.0), Some(40f64.to_radians()), size)?;
        let buffer = LineBuffer::new(&lines, &view);
        let place = |i: usize| [i as u32 % size[0], i as u32 / size[0]];
        let shown = buffer.fragments().iter().enumerate().filter_map(|(i, f)| Some((place(i), (*f)?)));
        let all: Vec<_> = shown.collect();
        let block = all[all.len() * 2 / 5..].iter().take(BLOCK).copied().collect();
        // Steps that share no factor with the picture's width.
        let step = (all.len() / most.max(1)).max(1) | 1;
        let receivers = all.into_iter().step_by(step).collect();
        let [min, max] = lines.bounds();
        let [near, far] = view.depths();
        let setting = Setting {
            radius: RADIUS * (max - min).max_element(),
            tube: view.pixel_size((near + far) / 2.0) as f32 / 2.0,
        };
        Ok(Self { lines, view, buffer, receivers, block, setting })
    }

    /// The occlusion by `side * side` rays.
    fn truth(&self, view: &View, receivers: &[([u32; 2], Fragment)], side: u32) -> Vec<f64> {
        let tubes = Tubes::new(&self.lines, f64::from(self.setting.tube));
        let one = |(i, (_, f)): (usize, &([u32; 2], Fragment))| {
            tubes.occlusion(view, f, f64::from(self.setting.radius), side, &mut Random::new(i as u64))
        };
        receivers.par_iter().enumerate().map(one).collect()
    }

    /// The same places in another view, as far as it shows them.
    fn seen(&self, view: &View) -> Vec<Option<([u32; 2], Fragment)>> {
        let change = view.eye_from_world() * self.view.eye_from_world().inverse();
        let moved = |(_, f): &([u32; 2], Fragment)| {
            let position = change.transform_point3(f.position.as_dvec3()).as_vec3();
            let tangent = (change.matrix3 * f.tangent.as_dvec3()).as_vec3();
            Some((view.pixel(position)?, Fragment { position, tangent, ..*f }))
        };
        self.receivers.iter().map(moved).collect()
    }

    /// The view turned around the middle of its depths.
    fn turned(&self, degrees: f64) -> Result<View, Box<dyn Error>> {
        let [near, far] = self.view.depths();
        let middle = DVec3::new(0.0, 0.0, -(near + far) / 2.0);
        let turn = DMat4::from_quat(DQuat::from_rotation_y(degrees.to_radians()));
        let about = DMat4::from_translation(middle) * turn * DMat4::from_translation(-middle);
        let world = DMat4::from(self.view.eye_from_world());
        Ok(View::new(about * world, self.view.lens(), self.view.depths(), self.view.size())?)
    }
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len().max(1) as f64;
    values.sum::<f64>() / count
}

fn rmse(a: &[f64], b: &[f64]) -> f64 {
    mean(a.iter().zip(b).map(|(a, b)| (a - b).powi(2))).sqrt()
}

fn pearson(a: &[f64], b: &[f64]) -> f64 {
    let (ma, mb) = (mean(a.iter().copied()), mean(b.iter().copied()));
    let sum = |f: &dyn Fn(f64, f64) -> f64| a.iter().zip(b).map(|(a, b)| f(a - ma, b - mb)).sum::<f64>();
    let spread = (sum(&|a, _| a * a) * sum(&|_, b| b * b)).sqrt();
    if spread > 0.0 { sum(&|a, b| a * b) / spread } else { 0.0 }
}

fn agreement(cases: &[(&Kind, Case)]) {
    let names: Vec<&str> = METHODS.iter().map(|m| m.name).collect();
    println!("| kind | {} |\n|---|{}", names.join(" | "), "---:|".repeat(METHODS.len()));
    for (kind, case) in cases {
        let truth = case.truth(&case.view, &case.receivers, RAYS);
        let cell = |m: &methods::Method| {
            let found = m.prepared(case, &case.view).values(&case.receivers);
            format!("{:.3}, {:.3}", pearson(&found, &truth), rmse(&found, &truth))
        };
        let cells: Vec<String> = METHODS.iter().map(cell).collect();
        let held = if kind.is_held_out { " (held out)" } else { "" };
        println!("| {}{held} | {} |", kind.name, cells.join(" | "));
    }
}

fn stability(cases: &[(&Kind, Case)]) -> Result<(), Box<dyn Error>> {
    println!(
        "| kind | change | {} | truth |",
        METHODS.iter().map(|m| m.name).collect::<Vec<_>>().join(" | ")
    );
    println!("|---|---|{}", "---:|".repeat(METHODS.len() + 1));
    for (kind, case) in cases {
        let views = [
            ("none", case.view),
            ("a pixel", case.view.moved_by_pixels(1.0, 0.0)),
            ("0.2°", case.turned(0.2)?),
        ];
        for (name, view) in views {
            let seen = case.seen(&view);
            let (before, after): (Vec<_>, Vec<_>) =
                case.receivers.iter().zip(seen).filter_map(|(a, b)| Some((*a, b?))).unzip();
            let cell = |m: &methods::Method| {
                let old = m.prepared(case, &case.view).values(&before);
                format!("{:.4}", rmse(&old, &m.prepared(case, &view).values(&after)))
            };
            let cells: Vec<String> = METHODS.iter().map(cell).collect();
            let [old, new] =
                [(case.view, &before), (view, &after)].map(|(view, at)| case.truth(&view, at, RAYS));
            println!("| {} | {name} | {} | {:.4} |", kind.name, cells.join(" | "), rmse(&old, &new));
        }
    }
    Ok(())
}

fn costs(cases: &[(&Kind, Case)]) {
    println!("| kind | {} |", METHODS.iter().map(|m| m.name).collect::<Vec<_>>().join(" | "));
    println!("|---|{}", "---:|".repeat(METHODS.len()));
    for (kind, case) in cases {
        let cell = |m: &methods::Method| {
            let (prepare, each) = m.times(case);
            format!("{prepare:.0} ms, {each:.1} µs")
        };
        let cells: Vec<String> = METHODS.iter().map(cell).collect();
        println!("| {} | {} |", kind.name, cells.join(" | "));
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    if words.first().is_some_and(|w| w == "--pictures") {
        let folder = words.get(1).ok_or("--pictures needs a folder")?;
        let kind = KINDS.iter().find(|k| words.get(2).is_none_or(|w| k.name.contains(w.as_str())));
        return pictures::draw(kind.ok_or("no kind has this name")?, folder.as_ref());
    }
    let simplified = words.first().is_some_and(|w| w == "--simplified");
    if simplified {
        words.remove(0);
    }
    let most = words.first().and_then(|w| w.parse().ok());
    if most.is_some() {
        words.remove(0);
    }
    let wanted = |k: &&Kind| words.is_empty() || words.iter().any(|w| k.name.contains(w.as_str()));
    for size in SIZES {
        let case = |k| Ok((k, Case::new(k, size, most.unwrap_or(1000))?));
        let cases: Vec<(&Kind, Case)> =
            KINDS.iter().filter(wanted).map(case).collect::<Result<_, Box<dyn Error>>>()?;
        if simplified {
            println!(
                "\nSimplified lines at {} x {}, against {} rays at the whole ones:\n",
                size[0],
                size[1],
                RAYS * RAYS
            );
            simplified::print(&cases);
            continue;
        }
        println!("\nPearson and RMSE to {} rays at {} x {}:\n", RAYS * RAYS, size[0], size[1]);
        agreement(&cases);
        if size == SIZES[0] {
            println!("\nRMS change at the same places from one frame to the next:\n");
            stability(&cases)?;
            println!(
                "\nMilliseconds before the first pixel (all threads), microseconds a pixel (one thread):\n"
            );
            costs(&cases);
        }
    }
    Ok(())
}
