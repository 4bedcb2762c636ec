//! The pictures of the suite, and the table of jitter.

use super::run::{Finding, HZB};
use super::tables::accuracy;
use super::{gaps, jitter, resolution};
use crate::experiments::{Lab, LabError, Section, Table};
use crate::pictures::palette::{POINT, Style, method as style_of};
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

/// The style of a method.
fn style(method: &str) -> Style {
    style_of(method).unwrap_or(POINT)
}

/// A value of each line, in percent: "point 0.1%, cell 0.2%".
fn percents(lines: &[Line], at: impl Fn(&Line) -> Option<f64>) -> String {
    let said = |l: &Line| {
        let name = l.label.split(" (").next().unwrap_or_default();
        let digits = |v: f64| match v {
            v if v > 0.0 && v < 0.1 => format!("{v:.2}"),
            v if v > 0.0 && v < 10.0 => format!("{v:.1}"),
            v => format!("{v:.0}"),
        };
        at(l).map(|v| format!("{name} {}%", digits(v)))
    };
    lines.iter().filter_map(said).collect::<Vec<_>>().join(", ")
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
    let scenes = jitter::SCENES.len() as f64;
    let drawn: Vec<Line> = METHODS
        .iter()
        .zip(&sums)
        .map(|(method, sums)| {
            let points = amplitudes.iter().zip(sums).map(|(&a, s)| (f64::from(a), s / scenes));
            Line::new(label(findings, method, true), style(method), points.collect())
        })
        .collect();
    let file = "stability-jitter.svg";
    let x = Axis {
        holds: amplitudes.iter().map(|&a| f64::from(a)).collect(),
        ..Axis::log("jitter of the camera, metres and radians")
    };
    let y = Axis::log("flips per frame, % of the objects in the frustum");
    let middle = |l: &Line| l.points.iter().find(|p| p.0 > 5e-4 && p.0 < 5e-3).map(|p| p.1);
    let title = format!(
        "Objects that flip in a frame when the camera trembles by 1 mm: {}",
        percents(&drawn, middle)
    );
    let subtitle = "A flip is an object that comes or goes although its exact visibility stays the same; mean of the \
                    scenes. A method without a mark at an amplitude did not flip at all.";
    lines(&lab.folder.join(file), &title, subtitle, (&x, &y), &drawn)?;
    section.picture(file, &title);
    section.rows("Flips and flicker by amplitude as CSV", table);
    Ok(())
}

/// A chart of the objects lost through slits.
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
            Line::new(label(findings, method, true), style(method), points.collect())
        })
        .collect();
    let file = "stability-gaps.svg";
    let x = Axis::log(&format!("width of a pixel of the {HZB} wide buffer, divided by that of the slit"));
    let y = Axis { holds: vec![0.0, 110.0], ..Axis::linear("objects lost, % of those seen through slits") };
    let title = format!(
        "Objects lost behind slits a hundredth of a pixel wide: {}",
        percents(&drawn, |l| l.points.last().map(|p| p.1))
    );
    let subtitle = "Share of the objects in sight that each method leaves out, over three kinds of wall; slits get narrower \
                    to the right. At 1 a slit is one pixel wide, at 100 a hundredth.";
    lines(&lab.folder.join(file), &title, subtitle, (&x, &y), &joined(drawn))?;
    section.picture(file, &title);
    Ok(())
}

/// A chart of the ratio against resolution for each scene.
pub(super) fn of_resolution(lab: &Lab, findings: &[Finding], section: &mut Section) -> Result<(), LabError> {
    let resolutions = resolution::resolutions(lab);
    for (k, kind) in resolution::SCENES.iter().enumerate() {
        let of_scene = || findings.iter().skip(k * resolutions.len()).take(resolutions.len());
        let mut drawn = Vec::new();
        for method in METHODS {
            let mut points: Vec<(f64, f64)> = Vec::new();
            for (&n, finding) in resolutions.iter().zip(of_scene()) {
                // Coarser masks than 64 there are none.
                if method == "cell" && n < 64 {
                    continue;
                }
                let Some(ratio) = finding.of(method).and_then(|o| accuracy(finding, o)) else { continue };
                points.push((n as f64, ratio));
            }
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            drawn.push(Line::new(method, style(method), points));
        }
        let file = format!("stability-resolution-{}.svg", kind.name());
        let x = Axis::log("pixels across the picture (hzb, rays) or a side of the view cube (point, cell)");
        let y = Axis { holds: vec![1.0], ..Axis::log("PVS/visible") };
        let (title, subtitle) = resolution_words(kind.name(), of_scene());
        lines(&lab.folder.join(&file), &title, &subtitle, (&x, &y), &drawn)?;
        section.picture(&file, &title);
    }
    Ok(())
}

/// How much each method lost over all resolutions of a scene, and how the chart is to be read.
fn resolution_words<'a>(
    scene: &str,
    findings: impl Iterator<Item = &'a Finding> + Clone,
) -> (String, String) {
    let lost = |method: &str| {
        let lost: usize = findings.clone().filter_map(|f| f.of(method)).map(|o| o.lost).sum();
        format!("{method} {}", if lost == 0 { "none".to_owned() } else { lost.to_string() })
    };
    let title = format!("Objects lost at 8 to 2048 pixels, {scene}: {}", METHODS.map(lost).join(", "));
    let subtitle = "Objects found for each visible one, by resolution. Where a line is below 1, more is lost than found in \
                    vain.";
    (title, subtitle.to_owned())
}
