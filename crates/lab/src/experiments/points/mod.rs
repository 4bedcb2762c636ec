//! Point clouds whose truth is known, and the operators of `casca-points` beside it.
//!
//! Every table has two kinds of errors apart: points found visible that are hidden, and points
//! found hidden that are visible. E is the single number of the thesis (Tavares 2009): half of
//! their sum over the truly visible points.

mod clusters;
mod cost;
mod failures;
mod hpr;
mod judge;
mod splat;
mod study;

pub mod cloud;
pub mod hare;
pub mod sample;

pub use judge::Confusion;

use super::{Effort, Lab, LabError, Section};
use study::Study;

/// The introduction of the page.
pub const HEAD: &str = "# Point clouds whose truth is known\n\n\
    How well the operators of `casca-points` tell the visible points of a cloud, and in which time. Points are samples of a surface that the \
    operators do not know; the truth comes from that surface: rays at its triangles, or a formula for spheres, cubes and squares.\n\n\
    - **False visible**: hidden points that an operator finds visible. **False hidden**: visible points that it leaves out.\n\
    - **E** is the single number of the source (Tavares, UFRGS 2009): half of the sum of both over the truly visible points, in percent.\n\
    - `log10 R` is the parameter of hidden point removal (HPR): the radius of the sphere around the eye over the largest distance of a point.\n\
    - A *spacing* is the side of the square of surface that a point stands for. Radii of splats are half sides.\n";

/// All experiments on points; `effort` chooses the numbers of points whose cost is measured: up to
/// a million by hulls and ten million by splats in a short run, ten times as many in a full one.
/// Writes charts and pictures into the lab's folder.
///
/// # Errors
/// If a file of the lab cannot be read, or a picture cannot be written.
pub fn points(lab: &Lab, effort: Effort) -> Result<Section, LabError> {
    let mut study = Study::new(lab)?;
    let radius = hpr::radius(&mut study)?;
    hpr::exponential(&mut study)?;
    clusters::clusters(&mut study, radius)?;
    splat::filters(&mut study)?;
    splat::bias(&mut study)?;
    splat::automatic(&mut study)?;
    hpr::noise(&mut study, radius)?;
    failures::failures(&mut study, radius)?;
    cost::cost(&mut study, effort, radius)?;
    Ok(study.finish())
}
