//! Bounces by the step of cones, their number and that of walks, at one resolution: errors by step,
//! and against time.

use super::case::{Case, Truth, order_name};
use super::gather::Gather;
use super::metric::difference;
use super::rows::{BY_STEP, BY_TIME, CONES, ERROR, FLIP, Row, STEPS, Words, chart, table};
use super::voxels::Voxels;
use crate::experiments::{Lab, LabError, Section};
use crate::pictures::Line;
use crate::pictures::palette::other;

/// Settings that differ in one number, with their name.
fn groups() -> [(&'static str, Vec<Gather>); 4] {
    let cones = |count, step, corrected| Gather::Cones { count, step, corrected };
    [
        ("16 cones, steps of 0.1 to 2.5", STEPS.map(|s| cones(16, s, true)).to_vec()),
        ("the same, not corrected", STEPS.map(|s| cones(16, s, false)).to_vec()),
        ("6 to 96 cones, steps of 0.5", [6, 12, 24, 48, 96].map(|c| cones(c, 0.5, true)).to_vec()),
        ("16 to 256 walks", [16, 64, 256].map(Gather::Walks).to_vec()),
    ]
}

/// Measures all settings in some scenes, for both bounces.
pub(super) fn sweep(
    lab: &Lab,
    section: &mut Section,
    cases: &[(&Case, &Vec<Truth>)],
    n: u32,
) -> Result<(), LabError> {
    let mut rows: Vec<(usize, Row)> = Vec::new();
    for (case, truths) in cases {
        (lab.progress)(&format!("{}, steps", case.scene.name));
        let voxels = Voxels::new(&case.scene, n)?;
        // The light in the voxels is the same for all settings, so that only the gathering for
        // pixels differs.
        let stages = case.stages(&voxels, CONES)?;
        for (group, (_, settings)) in groups().iter().enumerate() {
            for &gather in settings {
                for ((order, truth), stage) in case.orders().zip(*truths).zip(&stages) {
                    let (image, time) = case.gathered(&stage.volume, gather)?;
                    let ms = [stage.ms[0], stage.ms[1], time];
                    let (difference, noise) = (difference(&truth.image, &image)?, truth.noise);
                    let scene = case.scene.name.clone();
                    rows.push((group, Row { scene, order, n, gather, difference, noise, ms }));
                }
            }
        }
    }
    by_step(lab, section, &rows)?;
    for (case, _) in cases {
        for order in case.orders() {
            by_time(lab, section, &case.scene.name, order, &rows)?;
        }
    }
    let rows: Vec<Row> = rows.into_iter().map(|(_, row)| row).collect();
    section.rows("All settings, as CSV", table("light-steps", &rows));
    Ok(())
}

fn by_step(lab: &Lab, section: &mut Section, rows: &[(usize, Row)]) -> Result<(), LabError> {
    for (measure, label) in [("error", ERROR), ("flip", FLIP)] {
        let value = |r: &Row| r.value(measure);
        let (mut all, mut colours): (Vec<Line>, Vec<String>) = (Vec::new(), Vec::new());
        for (_, r) in rows.iter().filter(|(group, _)| *group < 2) {
            let Gather::Cones { step, corrected, .. } = r.gather else { continue };
            let kind = format!("{}, {}", r.scene, order_name(r.order));
            let label = format!("{kind}{}", if corrected { "" } else { ", not corrected" });
            let point = (f64::from(step), value(r));
            if let Some(line) = all.iter_mut().find(|l| l.label == label) {
                line.points.push(point);
                continue;
            }
            let number = colours.iter().position(|k| *k == kind).unwrap_or_else(|| {
                colours.push(kind);
                colours.len() - 1
            });
            let style = other(number);
            all.push(Line::new(label, if corrected { style } else { style.dashed() }, vec![point]));
        }
        let spread = |corrected: bool| {
            let some =
                rows.iter().filter(|(group, _)| *group == usize::from(!corrected)).map(|(_, r)| value(r));
            let (lo, hi) = some.fold((f64::INFINITY, 0.0f64), |(lo, hi), v| (lo.min(v), hi.max(v)));
            format!("{lo:.2} to {hi:.2}")
        };
        let title = format!(
            "By the step the {} is {} with opacities corrected, {} without",
            if measure == "flip" { "FLIP" } else { measure },
            spread(true),
            spread(false)
        );
        let n = rows.first().map_or(0, |(_, r)| r.n);
        let subtitle = format!("16 cones a pixel, N = {n}. The light in the voxels is the same for all.");
        let file = format!("light-step-{measure}.svg");
        chart(
            lab,
            section,
            &file,
            &Words { title: &title, subtitle: &subtitle, across: BY_STEP, up: label },
            &all,
        )?;
    }
    Ok(())
}

fn by_time(
    lab: &Lab,
    section: &mut Section,
    scene: &str,
    order: u32,
    rows: &[(usize, Row)],
) -> Result<(), LabError> {
    let some: Vec<_> = rows.iter().filter(|(_, r)| r.scene == scene && r.order == order).collect();
    let lines: Vec<Line> = groups()
        .iter()
        .enumerate()
        .map(|(i, (label, _))| {
            let mine = some.iter().filter(|(group, _)| *group == i);
            Line::new(*label, other(i), mine.map(|(_, r)| (r.ms[2], r.value("error"))).collect())
        })
        .collect();
    let best = |walks: bool| {
        let least = some
            .iter()
            .filter(|(_, r)| matches!(r.gather, Gather::Walks(_)) == walks)
            .min_by(|a, b| a.1.value("error").total_cmp(&b.1.value("error")));
        least.map_or(String::new(), |(_, r)| format!("{:.2} in {:.0} ms", r.value("error"), r.ms[2]))
    };
    let name = order_name(order);
    let title = format!(
        "{scene}, {name}, N = {}: cones come as near as {}, walks {}",
        some.first().map_or(0, |(_, r)| r.n),
        best(false),
        best(true)
    );
    let subtitle = format!(
        "Each mark is a setting; lower left is better. Time to gather for all pixels with {} threads.",
        rayon::current_num_threads()
    );
    let file = format!("light-time-{scene}-{}.svg", name.replace(' ', "-"));
    chart(
        lab,
        section,
        &file,
        &Words { title: &title, subtitle: &subtitle, across: BY_TIME, up: ERROR },
        &lines,
    )
}
