//! The pictures of the suite, and the table of jitter.

use super::run::{Finding, HZB};
use super::tables::accuracy;
use super::{gaps, jitter, resolution};
use crate::lab::{Lab, LabError, Section, Table};
use crate::pictures::{Axis, Line, lines};

/// The methods that are drawn, in the order of their colours.
const METHODS: [&str; 4] = ["point", "cell", "hzb", "rays"];

/// Puts lines with the same points into one, so that none covers another.
fn joined(lines: Vec<Line>) -> Vec<Line> {
    let mut out: Vec<Line> = Vec::new();
    for line in lines {
        match out.iter_mut().find(|l| l.points == line.points) {
            Some(same) => same.label += &format!(" and {}", line.label),
            None => out.push(line),
        }
    }
    out
}

/// Labels as a reader knows the settings.
fn label(findings: &[Finding], method: &str, fixed: bool) -> String {
    let setting = findings.first().and_then(|f| f.of(method)).map(|o| o.setting.clone());
    match setting {
        Some(setting) if fixed => format!("{method} ({setting})"),
        _ => method.to_owned(),
    }
}

/// A table of flips and flicker by amplitude, and a chart of the flips.
pub(super) fn of_jitter(lab: &Lab, findings: &[Finding], section: &mut Section) -> Result<(), LabError> {
    let columns = [
        "scene",
        "amplitude, m and rad",
        "method",
        "flips per frame, % of the frustum",
        "flicker",
        "flicker of the exact set",
    ];
    let mut table = Table::new("stability-jitter-flips", &columns);
    let amplitudes = jitter::AMPLITUDES;
    let length = jitter::frames(lab);
    let mut sums = vec![vec![0.0; amplitudes.len()]; METHODS.len()];
    for (i, finding) in findings.iter().enumerate() {
        let Some(&amplitude) = amplitudes.get(i % amplitudes.len()) else { continue };
        let scene = jitter::SCENES.get(i / amplitudes.len()).map_or("", |k| k.name());
        let truth = jitter::exact_flicker(finding, length);
        for (m, &method) in METHODS.iter().enumerate() {
            let Some(outcome) = finding.of(method) else { continue };
            let unrest = jitter::unrest(&outcome.found, &finding.exact, length, finding.in_frustum);
            sums[m][i % amplitudes.len()] += unrest.flips;
            table.row([
                scene.to_owned(),
                format!("{amplitude:e}"),
                method.to_owned(),
                format!("{:.3}", unrest.flips),
                unrest.flicker.to_string(),
                truth.to_string(),
            ]);
        }
    }
    section.table(table);
    let scenes = jitter::SCENES.len() as f64;
    let drawn: Vec<Line> = METHODS
        .iter()
        .zip(&sums)
        .map(|(method, sums)| {
            let points = amplitudes.iter().zip(sums).map(|(&a, s)| (f64::from(a), s / scenes));
            Line::new(label(findings, method, true), points.collect())
        })
        .collect();
    let file = "stability-jitter.png";
    let x = Axis {
        holds: amplitudes.iter().map(|&a| f64::from(a)).collect(),
        ..Axis::log("jitter of the camera, metres and radians")
    };
    let y = Axis::log("objects that flip per frame, % of those in the frustum");
    lines(&lab.folder.join(file), "Unsteadiness under a trembling camera", &x, &y, &drawn)?;
    section.picture(
        file,
        "Objects that come or go from frame to frame although their visibility stays the same, mean of the scenes. \
         A method without a point at some amplitude did not flip there at all.",
    );
    Ok(())
}

/// A chart of what is lost through slits.
pub(super) fn of_gaps(lab: &Lab, findings: &[Finding], section: &mut Section) -> Result<(), LabError> {
    let widths = gaps::widths_in_pixels();
    let drawn: Vec<Line> = METHODS
        .iter()
        .map(|method| {
            let points = widths.iter().enumerate().map(|(w, &width)| {
                let (mut lost, mut shown) = (0, 0);
                for finding in findings.iter().skip(w).step_by(widths.len()) {
                    lost += finding.of(method).map_or(0, |o| o.lost_known);
                    shown += finding.known - finding.refuted;
                }
                (1.0 / width, 100.0 * lost as f64 / (shown as f64).max(1.0))
            });
            Line::new(label(findings, method, true), points.collect())
        })
        .collect();
    let file = "stability-gaps.png";
    let x = Axis::log(&format!("width of a pixel of the {HZB} wide buffer, divided by that of the slit"));
    let y = Axis { holds: vec![0.0, 110.0], ..Axis::linear("objects lost, % of those seen through slits") };
    let title = "Objects lost behind slits (narrower to the right)";
    lines(&lab.folder.join(file), title, &x, &y, &joined(drawn))?;
    section.picture(
        file,
        "Share of the objects in sight behind slits that each method leaves out, over all three kinds of wall. \
         At 1 a slit is one pixel wide, at 100 a hundredth.",
    );
    Ok(())
}

/// A chart of the ratio against resolution for each scene.
pub(super) fn of_resolution(lab: &Lab, findings: &[Finding], section: &mut Section) -> Result<(), LabError> {
    let resolutions = resolution::resolutions(lab);
    for (k, kind) in resolution::SCENES.iter().enumerate() {
        let of_scene = || findings.iter().skip(k * resolutions.len()).take(resolutions.len());
        let mut drawn = Vec::new();
        let mut most = 1.0f64;
        for method in METHODS {
            let mut points: Vec<(f64, f64)> = Vec::new();
            for (&n, finding) in resolutions.iter().zip(of_scene()) {
                // Coarser masks than 64 there are none.
                if method == "cell" && n < 64 {
                    continue;
                }
                let Some(ratio) = finding.of(method).and_then(|o| accuracy(finding, o)) else { continue };
                points.push((n as f64, ratio));
                most = most.max(ratio);
            }
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            drawn.push(Line::new(method, points));
        }
        let file = format!("stability-resolution-{}.png", kind.name());
        let x = Axis::log("pixels across the picture (hzb, rays) or a side of the view cube (point, cell)");
        // Room for the legend above the lines.
        let y = Axis {
            holds: vec![1.0, most.powf(1.35)],
            ..Axis::log("PVS/EVS: objects found / objects visible")
        };
        let title = format!("Resolution and accuracy: {}", kind.name());
        lines(&lab.folder.join(&file), &title, &x, &y, &drawn)?;
        section.picture(
            &file,
            "Objects found over objects visible. Below 1 more was lost than found in vain; the table says how much.",
        );
    }
    Ok(())
}
