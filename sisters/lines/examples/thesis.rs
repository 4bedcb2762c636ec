//! The method of the thesis (Benevides, PUC-Rio 2015) beside the rays and the places that replaced
//! it, on generated sets like those of the thesis: how near the occlusion comes to 400 rays in
//! double precision, and how much it changes when the picture moves. Prints the tables of the
//! README.
//!
//! `cargo run --release -p casca-lines --example thesis -- [receivers, 300 if none are given]`

use std::error::Error;

use casca_lines::buffers::{Fragment, nearest_lines};
use casca_lines::cells::Cells;
use casca_lines::glam::{DVec3, Vec2, Vec3};
use casca_lines::numeric::{ALONG_VIEW, USUAL_RAYS, USUAL_SIDE_RAYS, hash};
use casca_lines::occlusion::{AoOptions, Occlusion, Sides};
use casca_lines::samples::SampleSets;
use casca_lines::sets::generate::{Family, Recipe};
use casca_lines::sets::random::{self, Random};
use casca_lines::sets::{LineSet, Segment};
use casca_lines::view::View;
use casca_lines::walk::walk;
use rayon::prelude::*;
use truth::{Tubes, agreement};

#[path = "../tests/truth/mod.rs"]
mod truth;

const SIZE: [u32; 2] = [480, 360];
/// The radius of the occlusion as a share of the extent.
const RADIUS: f32 = 0.13;
/// The square root of the rays of the truth.
const RAYS: u32 = 20;
const SETS: u32 = 16;

/// The thesis' slices of a column, samples, and factor.
const SLICES: u32 = 128;
const SAMPLES: u32 = 150;
const FACTOR: f32 = 4.0;
/// The radii of the discs of its samples, a third in each: they are denser in the middle, where the
/// lines are that darken most.
const RADII: [f32; 3] = [0.2, 0.5, 1.0];
/// Candidates for each of its samples.
const CANDIDATES: usize = 12;
/// The least sine of an angle to the tangent that the ratio of sines divides by: it keeps a single
/// column, whose far end lies on the line's own direction, from outweighing all others.
const LEAST_SINE: f32 = 1e-3;
/// A base plane whose normal has a component along the column below this is parallel to it: the
/// crossing would lie thousands of radii away, so that the column is wholly above the plane or
/// wholly below.
const PARALLEL: f32 = 1e-6;

/// The thesis' method: a column of 128 bits along the view behind each pixel (Eisemann and Décoret
/// 2008, "Single-pass GPU solid voxelization for real-time applications"), in which a line sets all
/// slices from the depth where it enters the column to that where it leaves it.
struct Thesis<'a> {
    view: &'a View,
    columns: Vec<u128>,
    sets: Vec<Vec<Vec2>>,
    radius: f32,
}

impl<'a> Thesis<'a> {
    fn new(lines: &LineSet, view: &'a View, radius: f32) -> Self {
        let set = |number: u32| {
            let mut random = Random::new(random::hash(1) ^ u64::from(number));
            RADII.iter().flat_map(|r| disc(SAMPLES / 3, &mut random).into_iter().map(|p| p * *r)).collect()
        };
        let [width, height] = SIZE.map(|s| s as usize);
        let sets = (0..SETS).map(set).collect();
        let mut all = Self { view, columns: vec![0; width * height], sets, radius };
        for Segment { a, b, .. } in lines.segments() {
            let ends = [a, b].map(|v| view.to_eye(lines.points()[v as usize]));
            walk(view, ends, |[x, y], part| {
                let [from, to] = part.map(|t| all.slice_of(-(ends[0].z + (ends[1].z - ends[0].z) * t)));
                all.columns[y as usize * width + x as usize] |= mask(from.min(to), from.max(to));
            });
        }
        all
    }

    /// The slice of a depth, clamped to those that there are.
    fn slice_of(&self, depth: f64) -> u32 {
        let [near, far] = self.view.depths();
        // Conversion saturates.
        (((depth - near) / (far - near) * f64::from(SLICES)) as u32).min(SLICES - 1)
    }

    /// The share of set slices in a range of depths of a column; none outside of the view's depths.
    fn share(&self, [x, y]: [u32; 2], [from, to]: [f64; 2]) -> Option<f32> {
        let [near, far] = self.view.depths();
        let is_inside = from <= to && from <= far && to >= near;
        let [first, last] = [from, to].map(|depth| self.slice_of(depth));
        let column = self.columns[(y * SIZE[0] + x) as usize];
        let on = (column & mask(first, last)).count_ones();
        is_inside.then(|| on as f32 / (last - first + 1) as f32)
    }

    /// The occlusion of the hemisphere around a point of a line (table 3.1): the mean of the shares
    /// of the columns through samples of a disc across the view, weighted by angle and distance.
    /// Lengths are in radii of the hemisphere. Columns outside of the picture are left out.
    fn at(&self, [x, y]: [u32; 2], at: &Fragment) -> f32 {
        let away = self.view.away(at.position);
        let pole = -away - at.tangent * at.tangent.dot(-away);
        let pole = if pole.length() > ALONG_VIEW { pole.normalize() } else { -away };
        let right = (Vec3::X - away * away.x).normalize_or(Vec3::Y);
        let across = [right, right.cross(away)];
        let (mut ratios, mut columns) = (0.0, 0.0);
        // Noise stands still on the screen.
        for sample in &self.sets[hash(x, y) as usize % self.sets.len()] {
            // The column has the points `start + t * step`; t is a depth, counted from the start.
            let start = across[0] * sample.x + across[1] * sample.y;
            let place = at.position + start * self.radius;
            let step = place / -place.z;
            let (a, b) = (step.length_squared(), step.dot(start));
            let root = b * b - a * (start.length_squared() - 1.0);
            if root.is_nan() || root <= 0.0 {
                continue;
            }
            let (mut from, mut to) = ((-b - root.sqrt()) / a, (-b + root.sqrt()) / a);
            let (height, slope) = (pole.dot(start), pole.dot(step));
            if slope.abs() < PARALLEL {
                if height < 0.0 {
                    continue;
                }
            } else if slope < 0.0 {
                // The thesis' equation 3.17 has the other sign, which mirrors the hemisphere in depth.
                to = to.min(-height / slope);
            } else {
                // The pole may turn away from the viewer in perspective: the column then enters the
                // hemisphere through its base.
                from = from.max(-height / slope);
            }
            let Some(pixel) = self.view.pixel(place).filter(|_| from < to) else { continue };
            let radius = f64::from(self.radius);
            let depths =
                [from, to].map(|t| -f64::from(at.position.z) + (f64::from(t) - f64::from(start.z)) * radius);
            let Some(share) = self.share(pixel, depths) else { continue };
            let ends = [from, to].map(|t| start + step * t);
            // In radii: the thesis' units would make the result depend on the size of the scene.
            let distance = (ends[0].length() + ends[1].length()) / 2.0;
            let sine = ends.map(|e| at.tangent.cross(e.normalize_or_zero()).length());
            let sines = (sine[0] + sine[1]) / 2.0 / sine[0].max(LEAST_SINE);
            ratios += share * sines / (distance * distance);
            columns += 1.0;
        }
        if columns > 0.0 { (ratios / columns * FACTOR).clamp(0.0, 1.0) } else { 0.0 }
    }
}

/// The slices `first` to `last`, both inclusive.
fn mask(first: u32, last: u32) -> u128 {
    (u128::MAX << first) & (u128::MAX >> (SLICES - 1 - last))
}

/// Points of the unit disc that keep apart (best candidates of Mitchell 1991, "Spectrally optimal
/// sampling for distribution ray tracing").
fn disc(count: u32, random: &mut Random) -> Vec<Vec2> {
    let mut points: Vec<Vec2> = Vec::new();
    let mut candidate = || loop {
        let p = Vec2::new(random.within(-1.0, 1.0) as f32, random.within(-1.0, 1.0) as f32);
        if p.length() < 0.999 {
            return p;
        }
    };
    for _ in 0..count {
        let mut best = (candidate(), -1.0);
        for _ in 0..CANDIDATES {
            let p = candidate();
            let apart = points.iter().map(|q| q.distance_squared(p)).fold(f32::INFINITY, f32::min);
            if apart > best.1 {
                best = (p, apart);
            }
        }
        points.push(best.0);
    }
    points
}

/// A pixel that shows a line, and its nearest point.
type Receiver = ([u32; 2], Fragment);

/// A set in a view, with some of the pixels that show a line.
struct Case {
    lines: LineSet,
    view: View,
    receivers: Vec<Receiver>,
    radius: f32,
    /// Half of a pixel, in the middle of the depths.
    tube: f32,
}

impl Case {
    fn new(lines: LineSet, most: usize) -> Result<Self, Box<dyn Error>> {
        let view = View::around(lines.bounds(), Vec3::new(0.5, 0.6, 1.0), Some(40f64.to_radians()), SIZE)?;
        let place = |i: usize| [i as u32 % SIZE[0], i as u32 / SIZE[0]];
        let nearest = nearest_lines(&lines, &view);
        let shown: Vec<Receiver> =
            nearest.iter().enumerate().filter_map(|(i, f)| Some((place(i), (*f)?))).collect();
        // Steps that share no factor with the picture's width.
        let step = (shown.len() / most.max(1)).max(1) | 1;
        let receivers = shown.into_iter().step_by(step).collect();
        let ([min, max], [near, far]) = (lines.bounds(), view.depths());
        let radius = RADIUS * (max - min).max_element();
        let tube = view.pixel_size((near + far) / 2.0) as f32 / 2.0;
        Ok(Self { lines, view, receivers, radius, tube })
    }

    /// The occlusion by rays in double precision.
    fn truth(&self, solid: bool) -> Vec<f64> {
        let tubes = Tubes::new(&self.lines, f64::from(self.tube), solid);
        let one = |(i, (_, f)): (usize, &Receiver)| {
            tubes.occlusion(&self.view, f, f64::from(self.radius), RAYS, &mut Random::new(i as u64))
        };
        self.receivers.par_iter().enumerate().map(one).collect()
    }

    /// By the thesis' columns, rays and places.
    fn estimates(&self, view: &View, receivers: &[Receiver], solid: bool) -> [Vec<f64>; 3] {
        let thesis = Thesis::new(&self.lines, view, self.radius);
        let thesis = receivers.iter().map(|(pixel, f)| f64::from(thesis.at(*pixel, f))).collect();
        let values = |by: Occlusion<'_>| receivers.iter().map(|(_, f)| f64::from(by.at(f))).collect();
        let options = AoOptions { solid, ..AoOptions::rays(self.radius, self.tube) };
        let cells = Cells::new(&self.lines, options.margin());
        let sets = SampleSets::spirals(USUAL_RAYS, SETS).expect("sets");
        let rays = values(Occlusion::by_rays(&cells, view, &sets, options).expect("options"));
        let options = AoOptions { solid, ..AoOptions::places(self.radius, self.tube) };
        let sets = SampleSets::spirals(USUAL_SIDE_RAYS, SETS).expect("sets");
        let sides = Sides::new(&self.lines, &cells, &sets, options).expect("options");
        [thesis, rays, values(Occlusion::by_places(&sides, view))]
    }

    /// The root of the mean square change of each method at the same places of lines, when the
    /// picture moves.
    fn change(&self, view: &View) -> [f64; 3] {
        let by = view.eye_from_world() * self.view.eye_from_world().inverse();
        let moved = |(_, f): &Receiver| {
            let position = by.transform_point3(f.position.as_dvec3()).as_vec3();
            let tangent = (by.matrix3 * f.tangent.as_dvec3()).as_vec3();
            Some((view.pixel(position)?, Fragment { position, tangent, ..*f }))
        };
        let pairs = self.receivers.iter().filter_map(|old| Some((*old, moved(old)?)));
        let (old, new): (Vec<_>, Vec<_>) = pairs.unzip();
        let (old, new) = (self.estimates(&self.view, &old, false), self.estimates(view, &new, false));
        std::array::from_fn(|i| agreement(&old[i], &new[i])[1])
    }
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

/// Tufts of strands beside each other, less than a pixel apart: `strands` in each, `wide` from its
/// middle at most.
fn tufts(strands: u32, wide: f64) -> Result<LineSet, Box<dyn Error>> {
    let mut random = Random::new(5);
    let mut point = |s: f64| DVec3::from_array(std::array::from_fn(|_| random.within(-s, s)));
    let mut lines = Vec::new();
    for _ in 0..40 {
        let (from, to, bend) = (point(1.0), point(1.0), point(0.8));
        for _ in 0..strands {
            let (root, tip) = (point(wide), point(wide));
            lines.push((0..=40).map(move |i| {
                let t = f64::from(i) / 40.0;
                let middle = from.lerp(to, t) + bend * (t * (1.0 - t) * 4.0);
                (middle + root.lerp(tip, t)).as_vec3()
            }));
        }
    }
    Ok(LineSet::new(lines)?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let most = std::env::args().nth(1).and_then(|word| word.parse().ok()).unwrap_or(300);
    let mut cases: Vec<(&str, Case)> = Vec::new();
    for family in Family::ALL {
        cases.push((family.name(), Case::new(Recipe::new(family, 1).make()?, most)?));
    }
    for (name, strands, wide) in
        [("loose tufts", 60, 0.06), ("tufts", 300, 0.05), ("dense tufts", 1000, 0.03)]
    {
        cases.push((name, Case::new(tufts(strands, wide)?, most)?));
    }
    let cell = |found: &[f64], wanted: &[f64]| agreement(found, wanted).map(|v| format!("{v:.3}")).join(", ");
    println!("Pearson correlation and RMSE to {} rays, {} x {} pixels:\n", RAYS * RAYS, SIZE[0], SIZE[1]);
    println!(
        "| set | thesis, factor 4 | thesis, fitted | {USUAL_RAYS} rays | places |\n|---|---:|---:|---:|---:|"
    );
    let mut solid = Vec::new();
    for (name, case) in &cases {
        let [wanted, of_solid] = [false, true].map(|solid| case.truth(solid));
        let [thesis, open, places] = case.estimates(&case.view, &case.receivers, false);
        let factor = fitted(&thesis, &wanted);
        let scaled: Vec<f64> = thesis.iter().map(|v| (v * factor).min(1.0)).collect();
        let fit = format!("{} ({:.1})", cell(&scaled, &wanted), f64::from(FACTOR) * factor);
        let [rough, rays, places] = [&thesis, &open, &places].map(|found| cell(found, &wanted));
        println!("| {name} | {rough} | {fit} | {rays} | {places} |");
        let buried = wanted.iter().zip(&of_solid).filter(|(open, solid)| solid > open).count();
        let [_, rays, places] = case.estimates(&case.view, &case.receivers, true);
        let [open, rays, places] = [&open, &rays, &places].map(|found| cell(found, &of_solid));
        let buried = 100.0 * buried as f64 / wanted.len() as f64;
        solid.push(format!("| {name} | {buried:.0}% | {open} | {rays} | {places} |"));
    }
    println!("\nBeside solid tubes:\n\n| set | buried | rays | solid rays | solid places |");
    println!("|---|---:|---:|---:|---:|\n{}", solid.join("\n"));
    println!("\nRMS change at the same places of lines: thesis, rays, places\n");
    println!("| set | a pixel to the right | turned by 0.2° |\n|---|---:|---:|");
    for (name, case) in &cases {
        let cells = [case.view.moved_by_pixels(1.0, 0.0), case.view.turned(0.2f64.to_radians())]
            .map(|view| case.change(&view).map(|v| format!("{v:.3}")).join(", "));
        println!("| {name} | {} |", cells.join(" | "));
    }
    Ok(())
}
