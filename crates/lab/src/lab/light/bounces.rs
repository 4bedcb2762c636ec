//! The first and the second bounce, by resolution, by step of the cones, and against time.

use std::time::Instant;

use super::gather::turn_of;
use super::{Case, Difference, Gather, LightVolume, Voxels, difference, digits, tile};
use crate::lab::{Lab, LabError, Section, Table};
use crate::lit::HdrImage;
use crate::oracle::path::Quantity;
use crate::pictures::palette::other;
use crate::pictures::{Axis, Line, Tile, lines, sheet};

/// Cells along an axis.
const SIZES: [u32; 3] = [32, 64, 128];
/// Steps of cones, in diameters: those of the thesis.
const STEPS: [f32; 5] = [0.1, 0.25, 0.5, 1.0, 2.5];
const CONES: Gather = Gather::Cones { count: 16, step: 0.5, corrected: true };
const WALKS: Gather = Gather::Walks(64);

/// A bounce of a scene by one way of gathering.
struct Row {
    scene: String,
    bounce: u32,
    n: u32,
    gather: Gather,
    difference: Difference,
    /// Milliseconds for the voxels with their light, the pyramid, and the gathering for all pixels.
    ms: [f64; 3],
}

impl Gather {
    fn words(&self) -> String {
        match self {
            Self::Cones { count, step, corrected } => {
                format!("{count} cones, step {step}{}", if *corrected { "" } else { ", not corrected" })
            }
            Self::Walks(count) => format!("{count} walks"),
        }
    }
}

/// Gathers bounces in a scene and compares them with the truths; also gives the last picture of each bounce.
fn measure(
    case: &Case,
    truths: &[HdrImage],
    n: u32,
    gather: Gather,
    rows: &mut Vec<Row>,
) -> Result<Vec<HdrImage>, LabError> {
    let start = Instant::now();
    let ms = |since: Instant| since.elapsed().as_secs_f64() * 1e3;
    let voxels = Voxels::new(&case.scene, n)?;
    let mut sides = if case.held == 0 { voxels.emission() } else { voxels.direct(&case.scene.lights) };
    let mut made = ms(start);
    let mut images = Vec::new();
    for (bounce, truth) in (1..).zip(truths) {
        let start = Instant::now();
        let volume = LightVolume::new(&voxels, sides, case.scene.sky);
        let pyramid = ms(start);
        let start = Instant::now();
        let image = case.image(|at| {
            let (point, normal) = (at.point.as_vec3(), at.normal.as_vec3());
            case.albedo(at) * volume.gather(point, normal, gather, turn_of(point))
        })?;
        let gathered = ms(start);
        rows.push(Row {
            scene: case.scene.name.clone(),
            bounce,
            n,
            gather,
            difference: difference(truth, &image)?,
            ms: [made, pyramid, gathered],
        });
        images.push(image);
        let start = Instant::now();
        sides = if bounce as usize == truths.len() { Vec::new() } else { volume.bounce(gather) };
        made = ms(start);
    }
    Ok(images)
}

fn table(name: &str, rows: &[Row]) -> Table {
    let columns =
        ["scene", "bounce", "N", "gathered by", "RMSE", "FLIP", "voxels, ms", "pyramid, ms", "gather, ms"];
    let mut table = Table::new(name, &columns);
    for r in rows {
        let first = [r.scene.clone(), r.bounce.to_string(), r.n.to_string(), r.gather.words()];
        let last = [digits(r.difference.rmse), digits(r.difference.flip)];
        table.row(first.into_iter().chain(last).chain(r.ms.map(|v| format!("{v:.1}"))));
    }
    table
}

/// Measures both bounces of all scenes.
pub(super) fn bounces(lab: &Lab, cases: &[Case], section: &mut Section) -> Result<(), LabError> {
    let sizes: &[u32] = lab.pick(&SIZES, &SIZES[..1]);
    let mut rows = Vec::new();
    let mut first = None;
    for case in cases {
        (lab.progress)(&case.scene.name);
        let truths = [1, 2].map(|b| case.truth(lab, &Quantity::Radiance(case.held + b..=case.held + b)));
        let [one, two] = truths;
        let truths = [one?, two?];
        let exposures = truths.each_ref().map(HdrImage::exposure);
        let mut tiles: Vec<Vec<Tile>> = (0..2)
            .map(|b| vec![tile(format!("bounce {}: path tracer", b + 1), &truths[b], exposures[b])])
            .collect();
        for &n in sizes {
            for gather in [CONES, WALKS] {
                let images = measure(case, &truths, n, gather, &mut rows)?;
                if gather == CONES {
                    for (b, image) in images.iter().enumerate() {
                        let caption = format!("N = {n}, {}", gather.words());
                        tiles[b].push(tile(caption, image, exposures[b]));
                    }
                }
            }
        }
        pictures(lab, section, case, &tiles, &rows)?;
        first.get_or_insert(truths);
    }
    by_size(lab, section, &rows)?;
    section.table(table("light-bounces", &rows));
    if let (Some(case), Some(truths)) = (cases.first(), first) {
        by_time(lab, section, case, &truths[..1])?;
    }
    Ok(())
}

fn pictures(
    lab: &Lab,
    section: &mut Section,
    case: &Case,
    tiles: &[Vec<Tile>],
    rows: &[Row],
) -> Result<(), LabError> {
    let name = &case.scene.name;
    let finest =
        |bounce| rows.iter().rev().find(|r| r.scene == *name && r.bounce == bounce && r.gather == CONES);
    let words =
        [1, 2].map(|b| finest(b).map_or(String::new(), |r| format!("{:.0}%", 100.0 * r.difference.rmse)));
    let title = format!(
        "{name}: cones through the finest voxels miss the first bounce by {}, the second by {}",
        words[0], words[1]
    );
    let file = format!("light-{name}.png");
    let subtitle =
        "Light of one bounce alone, at the exposure of the path tracer's picture. N: voxels along an axis.";
    sheet(&lab.folder.join(&file), &title, subtitle, tiles)?;
    section.picture(&file, &title);
    Ok(())
}

/// Draws errors by resolution.
fn by_size(lab: &Lab, section: &mut Section, rows: &[Row]) -> Result<(), LabError> {
    let mut all: Vec<Line> = Vec::new();
    let mut series: Vec<(&str, u32)> = Vec::new();
    for r in rows {
        let key = (r.scene.as_str(), r.bounce);
        let number = series.iter().position(|k| *k == key).unwrap_or_else(|| {
            series.push(key);
            series.len() - 1
        });
        let (kind, style) = match r.gather {
            Gather::Walks(_) => ("walks", other(number).dashed()),
            Gather::Cones { .. } => ("cones", other(number)),
        };
        let label = format!("{}, bounce {}, {kind}", r.scene, r.bounce);
        let point = (f64::from(r.n), r.difference.rmse);
        match all.iter_mut().find(|l| l.label == label) {
            Some(line) => line.points.push(point),
            None => all.push(Line::new(label, style, vec![point])),
        }
    }
    let mean = |n: u32| {
        let some: Vec<f64> =
            rows.iter().filter(|r| r.n == n && r.gather == CONES).map(|r| r.difference.rmse).collect();
        some.iter().sum::<f64>() / some.len().max(1) as f64
    };
    let (coarse, fine) =
        (rows.iter().map(|r| r.n).min().unwrap_or(0), rows.iter().map(|r| r.n).max().unwrap_or(0));
    let title = format!(
        "From N = {coarse} to N = {fine} the error of cones goes from {:.0}% to {:.0}% of the light, on average",
        100.0 * mean(coarse),
        100.0 * mean(fine)
    );
    let axes = (
        &Axis::log("N: voxels along an axis (logarithmic)"),
        &Axis::linear("RMSE over the mean light of the bounce"),
    );
    let file = "light-size.svg";
    lines(
        &lab.folder.join(file),
        &title,
        "16 cones with steps of half a diameter, or 64 exact walks, for each pixel and voxel.",
        axes,
        &all,
    )?;
    section.picture(file, &title);
    Ok(())
}

/// Draws errors against time, for many settings in one scene.
fn by_time(lab: &Lab, section: &mut Section, case: &Case, truths: &[HdrImage]) -> Result<(), LabError> {
    let n = lab.pick(64, 32);
    let cones = |count, step, corrected| Gather::Cones { count, step, corrected };
    let groups: [(&str, Vec<Gather>); 4] = [
        ("16 cones, steps of 0.1 to 2.5", STEPS.map(|s| cones(16, s, true)).to_vec()),
        ("the same, not corrected", STEPS.map(|s| cones(16, s, false)).to_vec()),
        ("6 to 96 cones, steps of 0.5", [6, 12, 24, 48, 96].map(|c| cones(c, 0.5, true)).to_vec()),
        ("16 to 1024 walks", [16, 64, 256, 1024].map(Gather::Walks).to_vec()),
    ];
    let (mut rows, mut all) = (Vec::new(), Vec::new());
    for (i, (label, settings)) in groups.iter().enumerate() {
        (lab.progress)(label);
        let from = rows.len();
        for &gather in settings {
            measure(case, truths, n, gather, &mut rows)?;
        }
        let points = rows[from..].iter().map(|r: &Row| (r.ms[2], r.difference.rmse)).collect();
        all.push(Line::new(*label, other(i), points));
    }
    let best = |some: &dyn Fn(&Row) -> bool| {
        let least =
            rows.iter().filter(|r| some(r)).min_by(|a, b| a.difference.rmse.total_cmp(&b.difference.rmse));
        least.map_or(String::new(), |r| format!("{:.0}% in {:.0} ms", 100.0 * r.difference.rmse, r.ms[2]))
    };
    let title = format!(
        "{}, first bounce, N = {n}: cones come as near as {}, walks {}",
        case.scene.name,
        best(&|r| matches!(r.gather, Gather::Cones { .. })),
        best(&|r| matches!(r.gather, Gather::Walks(_)))
    );
    let axes = (
        &Axis::log("time to gather for all pixels, ms (logarithmic)"),
        &Axis::linear("RMSE over the mean light of the bounce"),
    );
    let file = "light-time.svg";
    lines(
        &lab.folder.join(file),
        &title,
        "Each mark is a setting; lower left is better. Two cores.",
        axes,
        &all,
    )?;
    section.picture(file, &title);
    section.table(table("light-steps", &rows));
    Ok(())
}
