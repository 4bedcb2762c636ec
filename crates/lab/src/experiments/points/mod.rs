//! Point clouds whose truth is known, and the operators of `casca-points` beside it.
//!
//! Every table has two kinds of errors apart: points found visible that are hidden, and points found hidden that are visible. E is the
//! single number of the thesis (Tavares 2009): half of their sum over the truly visible points.

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

use super::{Lab, LabError, Section};
use cloud::Cloud;
use study::Study;

/// The introduction of the page.
pub const HEAD: &str = "# Point clouds whose truth is known\n\n\
    How well the operators of `casca-points` tell the visible points of a cloud, and in which time. Points are samples of a surface that the \
    operators do not know; the truth comes from that surface: rays at its triangles, or a formula for spheres, cubes and squares.\n\n\
    - **False visible**: hidden points that an operator finds visible. **False hidden**: visible points that it leaves out.\n\
    - **E** is the single number of the source (Tavares, UFRGS 2009): half of the sum of both over the truly visible points, in percent.\n\
    - `log10 R` is the parameter of hidden point removal (HPR): the radius of the sphere around the eye over the largest distance of a point.\n\
    - A *spacing* is the side of the square of surface that a point stands for. Radii of splats are half sides.\n";

/// How far the sizes of the cost go.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// A smoke run.
    Quick,
    /// A million points by hulls, ten million by splats.
    Short,
    /// Ten times as many of each: takes some GB of memory.
    Full,
}

/// All experiments on points. Writes charts and pictures into the lab's folder.
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

/// The clouds: the hare, shapes with formulas, and the lab's files.
fn clouds(lab: &Lab) -> Result<Vec<Cloud>, LabError> {
    let count = lab.pick(20_000, 2000);
    let hare = Cloud::hare(lab.pick(30_000, 3000));
    let mesh = hare::hare(lab.pick(110, 40));
    let sampled = Cloud::of_mesh("hare, sampled", mesh, hare.points.len(), lab.seed, hare.look)?;
    let mut clouds = vec![
        hare,
        sampled,
        Cloud::sphere(count),
        Cloud::cube(count, lab.seed)?,
        Cloud::sheets(count, lab.seed)?,
    ];
    for file in &lab.files {
        (lab.progress)(&format!("rays at {}", file.display()));
        clouds.push(Cloud::of_file(file, lab.pick(200_000, 3000), lab.seed)?);
    }
    Ok(clouds)
}
