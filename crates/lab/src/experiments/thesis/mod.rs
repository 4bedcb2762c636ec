//! The thesis' experiments (its chapter 4), with today's code.
//!
//! The thesis measured whole frames on a graphics card of its time. Here frames are drawn by a
//! software depth buffer, so that "depth buffer alone" has a price too; what is compared are
//! ratios and the shapes of curves.

mod angle;
mod hidden;
mod profile;
mod resolution;
mod walk;

use casca::GridSpec;
use glam::UVec3;

use super::{ASPECT, Lab, LabError, Section, Table};
use crate::pictures::palette::{self, Style};
use casca_scenes::drive::grid_for;
use casca_scenes::world::World;

/// Pixels of the software depth buffer that stands for the graphics card.
const SCREEN: (usize, usize) = (1280, 720);
/// Pixels of the item buffer that says what is visible.
const EXACT: (usize, usize) = (1920, 1080);
/// The two grids of the thesis.
const COARSE: UVec3 = UVec3::new(50, 30, 50);
const FINE: UVec3 = UVec3::new(100, 60, 100);

/// A finding of the thesis, and the one of this run.
struct Finding {
    place: &'static str,
    thesis: String,
    here: String,
}

impl Finding {
    fn new(place: &'static str, thesis: impl Into<String>, here: impl Into<String>) -> Self {
        Self { place, thesis: thesis.into(), here: here.into() }
    }
}

/// The style of a way; dashed on the coarse grid.
fn style(name: &str) -> Style {
    let style = palette::method(name).unwrap_or(palette::other(8));
    if name.contains("50x30x50") { style.dashed() } else { style }
}

fn grid(world: &World, dims: UVec3) -> Result<GridSpec, LabError> {
    Ok(grid_for(&world.grid, Some(dims))?)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// A over b, or 0 where there is no b.
fn ratio(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 0.0 }
}

/// Runs the thesis' experiments: hidden dynamic objects, a walk, PVS against exact visibility,
/// the angle of view, the resolution of the grid, and a profile.
///
/// # Errors
/// If a picture cannot be written, or a scene is refused.
pub fn thesis(lab: &Lab) -> Result<Section, LabError> {
    let mut body = Section::new("");
    let mut findings = Vec::new();
    for experiment in [hidden::run, walk::run, angle::run, resolution::run, profile::run] {
        findings.extend(experiment(lab, &mut body)?);
    }
    let mut section = Section::on_its_own_page("The thesis' experiments, with today's code");
    section.text(
        "casca follows a thesis of 2002. Here are the experiments of its chapter 4, on scenes made as it describes them: \
         clusters of spheres, 4,800 static and 200 that move. Its times come from an Athlon XP at 1.5 GHz with a GeForce2, so \
         ratios and shapes of curves are compared. Its charts are lost; black marks in ours are the numbers that \
         its text gives. `cell` is the thesis' kind of visibility. An object is visible if an exact item buffer of \
         1920x1080 shows a pixel of it.",
    );
    let mut table = Table::new("thesis-findings", &["section", "the thesis found", "we find"]);
    for f in findings {
        table.row([f.place.to_owned(), f.thesis, f.here]);
    }
    section.table(table);
    section.blocks.extend(body.blocks);
    Ok(section)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_of_nothing_are_nothing() {
        assert_eq!((ratio(3.0, 2.0), ratio(3.0, 0.0), mean(&[])), (1.5, 0.0, 0.0));
        assert_eq!(mean(&[1.0, 4.0]), 2.5);
    }
}
