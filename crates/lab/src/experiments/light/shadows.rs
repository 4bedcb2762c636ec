//! Soft shadows of lights with a size, and ambient occlusion, by the library's marches: by
//! resolution, by step, and against time.

use casca::soft::{Cone, March};
use glam::Vec3;

use super::case::{Case, Truth, cornell_ball, generated, milliseconds, size, sponza};
use super::metric::{Difference, difference, less_noise};
use super::rows::{
    BY_SIZE, BY_STEP, BY_TIME, ERROR, FLIP, MIDDLE, SIZES, STEPS, Words, chart, digits, mean_of, tile,
};
use super::voxels::{OFF, Voxels};
use crate::experiments::{Lab, LabError, Section, Table};
use crate::pictures::palette::{Style, other};
use crate::pictures::{Line, Tile, sheet};
use casca_scenes::lit::{HdrImage, Kind, LitScene};
use casca_truth::oracle::path::{Quantity, Surface};

/// Least tangent of a cone that the library takes.
const NARROWEST: f32 = 0.001;
/// Lights are seen under cones of this cosine at most: a point in a light has no cone.
const WIDEST: f32 = 0.05;
/// How far ambient occlusion reaches, in metres.
const REACH: f32 = 2.0;

fn samples(step: f32, corrected: bool) -> March {
    March::Samples { step, start: 0.0, first: 1.0, corrected }
}

/// The ways to follow a cone by resolution.
fn marches() -> [(&'static str, March); 4] {
    [
        ("samples, rule of 2016", March::OLD),
        ("samples, corrected", samples(0.5, true)),
        ("slabs", March::Slabs),
        ("64 exact rays", March::Rays(64)),
    ]
}

/// The ways at one resolution: groups with their names, and for each march its step or number of
/// rays.
fn groups() -> [(&'static str, Vec<(f32, March)>); 4] {
    let rays = [4, 16, 64, 256];
    [
        ("samples, steps of 0.1 to 2.5, corrected", STEPS.map(|s| (s, samples(s, true))).to_vec()),
        ("the same, not corrected", STEPS.map(|s| (s, samples(s, false))).to_vec()),
        ("slabs", vec![(0.0, March::Slabs)]),
        ("4 to 256 exact rays", rays.map(|r| (r as f32, March::Rays(r))).to_vec()),
    ]
}

/// A quantity in a scene, with its truth.
struct Question {
    name: String,
    case: Case,
    quantity: Quantity,
    truth: Truth,
}

impl Question {
    fn new(lab: &Lab, what: &str, scene: LitScene, quantity: Quantity) -> Result<Self, LabError> {
        let name = format!("{what}, {}", scene.name);
        (lab.progress)(&name);
        let case = Case::new(scene, size(lab))?;
        let Truth { image, noise } = case.truth(lab, &quantity)?;
        // Where nothing is seen both are black.
        let pixels = case.surfaces.iter().zip(image.pixels());
        let seen = pixels.map(|(s, p)| if s.is_some() { *p } else { Vec3::ZERO }).collect();
        let image = HdrImage::new(case.size.0, case.size.1, seen)?;
        Ok(Self { name, case, quantity, truth: Truth { image, noise } })
    }

    fn error(&self, found: Difference) -> f64 {
        less_noise(found.rmse, self.truth.noise)
    }

    /// The picture by voxels, how far it is from the truth, and the milliseconds that it took.
    fn ask(&self, voxels: &Voxels, march: &March) -> Result<(HdrImage, Difference, f64), LabError> {
        let share = |at: &Surface| match &self.quantity {
            Quantity::Ambient(reach) => ambient(voxels, at, *reach, march),
            _ => shadow(&self.case, voxels, at, march),
        };
        let (image, ms) = milliseconds(|| self.case.image(|at| share(at).map(Vec3::splat)));
        let image = image?;
        let difference = difference(&self.truth.image, &image)?;
        Ok((image, difference, ms))
    }
}

/// The share of the first light that a cone lets through to a surface; 0 for surfaces that face
/// away, and without lights.
pub(super) fn shadow(case: &Case, voxels: &Voxels, at: &Surface, march: &March) -> Result<f32, casca::Error> {
    let (point, normal) = (at.point.as_vec3(), at.normal.as_vec3());
    let Some(light) = case.scene.lights.first().and_then(|l| l.incident(point)) else { return Ok(0.0) };
    if light.direction.dot(normal) <= 0.0 {
        return Ok(0.0);
    }
    let cos = light.cos_half_angle.max(WIDEST);
    let cone = Cone {
        apex: point + normal * (OFF * voxels.cell),
        direction: light.direction,
        tan: ((1.0 - cos * cos).max(0.0).sqrt() / cos).clamp(NARROWEST, 10.0),
        reach: light.distance,
    };
    Ok(voxels.soft.cone(&cone, march)?.transmittance)
}

fn ambient(voxels: &Voxels, at: &Surface, reach: f32, march: &March) -> Result<f32, casca::Error> {
    let hidden = voxels.soft.ambient_occlusion(at.point.as_vec3(), at.normal.as_vec3(), reach, march)?;
    Ok(1.0 - hidden)
}

/// The scenes: a thin block, the Cornell box by a ball of light, and Sponza if it is there; then
/// ambient occlusion.
fn questions(lab: &Lab) -> Result<Vec<Question>, LabError> {
    let mut scenes = vec![generated(Kind::Plane), cornell_ball()];
    if let (false, Ok(scene)) = (lab.quick, sponza()) {
        scenes.push(scene);
    }
    let shadows = scenes.into_iter().map(|s| Question::new(lab, "soft shadow", s, Quantity::Shadow(0)));
    let open = Question::new(lab, "ambient occlusion", generated(Kind::Cornell), Quantity::Ambient(REACH));
    shadows.chain([open]).collect()
}

const COLUMNS: [&str; 8] = ["quantity", "N", "march", "error", "RMSE", "noise", "FLIP", "ms"];

fn row(table: &mut Table, q: &Question, n: u32, march: String, found: Difference, ms: f64) {
    let first = [q.name.clone(), n.to_string(), march];
    let last = [q.error(found), found.rmse, q.truth.noise, found.flip].map(digits);
    table.row(first.into_iter().chain(last).chain([format!("{ms:.1}")]));
}

/// Measures both by resolution and march.
pub(super) fn shadows(lab: &Lab, section: &mut Section) -> Result<(), LabError> {
    let (questions, mut table) = (questions(lab)?, Table::new("light-shadows", &COLUMNS));
    let sizes = lab.pick(&SIZES[..], &SIZES[..1]);
    let middle = lab.pick(MIDDLE, SIZES[0]);
    let (mut rmse, mut flip, mut rows): (Vec<Line>, Vec<Line>, Vec<Vec<Tile>>) = Default::default();
    for (number, q) in questions.iter().enumerate() {
        let mut tiles = vec![tile(q.name.clone(), &q.truth.image, 1.0)];
        let mut found: Vec<[Vec<(f64, f64)>; 2]> = vec![Default::default(); marches().len()];
        for &n in sizes {
            let voxels = Voxels::new(&q.case.scene, n)?;
            for (points, (name, march)) in found.iter_mut().zip(marches()) {
                let (image, difference, ms) = q.ask(&voxels, &march)?;
                points[0].push((n.into(), q.error(difference)));
                points[1].push((n.into(), difference.flip));
                row(&mut table, q, n, name.to_owned(), difference, ms);
                if n == middle {
                    tiles.push(tile(format!("N = {n}, {name}"), &image, 1.0));
                }
            }
        }
        rows.push(tiles);
        for (i, ([a, b], (name, _))) in found.into_iter().zip(marches()).enumerate() {
            // The rule of 2016 and the plain samples are in the table.
            let Some(dashed) = [None, Some(true), Some(false), None][i] else { continue };
            let style = |s: Style| if dashed { s.dashed() } else { s };
            let label = format!("{}, {name}", q.name);
            rmse.push(Line::new(label.clone(), style(other(number)), a));
            flip.push(Line::new(label, style(other(number)), b));
        }
    }
    for (name, up, all) in [("error", ERROR, &rmse), ("flip", FLIP, &flip)] {
        let mean = |march: &str| {
            let some = all.iter().filter(|l| l.label.ends_with(march)).filter_map(|l| l.points.last());
            mean_of(some.map(|p| p.1))
        };
        let title = format!(
            "At the finest voxels soft shadows and ambient occlusion have {} of {:.2} with slabs, {:.2} with samples, on average",
            if name == "flip" { "FLIP" } else { name },
            mean("slabs"),
            mean("corrected")
        );
        let subtitle =
            format!("The share of the light, or of the directions free for {REACH} m, that is not hidden.");
        let file = format!("light-shadows-size-{name}.svg");
        chart(lab, section, &file, &Words { title: &title, subtitle: &subtitle, across: BY_SIZE, up }, all)?;
    }
    let title = format!("Soft shadows and ambient occlusion at N = {middle}");
    let subtitle = "Left the path tracer. White where all of the light, or of the directions, is free.";
    sheet(&lab.folder.join("light-shadows.png"), &title, subtitle, &rows)?;
    section.picture("light-shadows.png", &title);
    section.rows("Shadows by resolution, as CSV", table);
    steps(lab, section, &questions, middle)
}

/// By step and against time, at one resolution.
fn steps(lab: &Lab, section: &mut Section, questions: &[Question], n: u32) -> Result<(), LabError> {
    let mut table = Table::new("light-shadow-steps", &COLUMNS);
    let (mut by_step, mut by_time): ([Vec<Line>; 2], Vec<Vec<Line>>) = Default::default();
    for (number, q) in questions.iter().enumerate() {
        (lab.progress)(&format!("{}, steps", q.name));
        let voxels = Voxels::new(&q.case.scene, n)?;
        let mut times = Vec::new();
        for (g, (group, settings)) in groups().into_iter().enumerate() {
            let mut points: [Vec<(f64, f64)>; 2] = Default::default();
            let mut time = Vec::new();
            for (setting, march) in settings {
                let (_, found, ms) = q.ask(&voxels, &march)?;
                points[0].push((setting.into(), q.error(found)));
                points[1].push((setting.into(), found.flip));
                time.push((ms, q.error(found)));
                let words = match march {
                    March::Samples { corrected: true, .. } => format!("samples, step {setting}"),
                    March::Samples { .. } => format!("samples, step {setting}, not corrected"),
                    March::Rays(rays) => format!("{rays} rays"),
                    _ => group.to_owned(),
                };
                row(&mut table, q, n, words, found, ms);
            }
            times.push(Line::new(group, other(g), time));
            if g < 2 {
                let style = if g == 1 { other(number).dashed() } else { other(number) };
                let label = format!("{}{}", q.name, ["", ", not corrected"][g]);
                let lines = by_step.iter_mut().zip(points);
                lines.for_each(|(lines, p)| lines.push(Line::new(label.clone(), style, p)));
            }
        }
        by_time.push(times);
    }
    for (name, up, all) in [("error", ERROR, &by_step[0]), ("flip", FLIP, &by_step[1])] {
        let spread = |corrected: bool| {
            let some = all.iter().filter(|l| l.label.ends_with("not corrected") != corrected);
            let values = some.flat_map(|l| &l.points).map(|p| p.1);
            let (lo, hi) = values.fold((f64::INFINITY, 0.0f64), |(lo, hi), v| (lo.min(v), hi.max(v)));
            format!("{lo:.2} to {hi:.2}")
        };
        let title = format!(
            "By the step of a sampled cone the {} of shadows is {} with opacities corrected, {} without",
            if name == "flip" { "FLIP" } else { name },
            spread(true),
            spread(false)
        );
        let file = format!("light-shadows-step-{name}.svg");
        let subtitle = format!("N = {n}; one cone for a shadow, six for ambient occlusion.");
        chart(lab, section, &file, &Words { title: &title, subtitle: &subtitle, across: BY_STEP, up }, all)?;
    }
    for (q, all) in questions.iter().zip(&by_time) {
        let least = |l: &Line| {
            let best = l.points.iter().min_by(|a, b| a.1.total_cmp(&b.1));
            best.map_or(String::new(), |p| format!("{:.2} in {:.0} ms", p.1, p.0))
        };
        let title = format!(
            "{}, N = {n}: samples come as near as {}, slabs {}, rays {}",
            q.name,
            least(&all[0]),
            least(&all[2]),
            least(&all[3])
        );
        let subtitle = format!(
            "Each mark is a setting; lower left is better. {} threads.",
            rayon::current_num_threads()
        );
        let file = format!("light-shadows-time-{}.svg", q.name.replace(", ", "-").replace(' ', "-"));
        chart(
            lab,
            section,
            &file,
            &Words { title: &title, subtitle: &subtitle, across: BY_TIME, up: ERROR },
            all,
        )?;
    }
    section.rows("Shadows by march, as CSV", table);
    Ok(())
}
