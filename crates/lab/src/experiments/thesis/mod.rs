//! The thesis' experiments (its chapter 4), with today's code.
//!
//! The thesis measured whole frames on a graphics card of its time. Here frames are drawn by a
//! software depth buffer, so that "depth buffer alone" has a price too; what is compared are
//! ratios and the shapes of curves.

mod angle;
mod hidden;
mod profile;
mod resolution;
mod setting;
mod walk;

use super::{Lab, LabError, Section, Table};

/// Runs the thesis' experiments: hidden dynamic objects, a walk, PVS against exact visibility,
/// the angle of view, the resolution of the grid, and a profile.
///
/// # Errors
/// If a scene is refused.
pub fn thesis(lab: &Lab) -> Result<Section, LabError> {
    let mut section = Section::new("The thesis' experiments, with today's code");
    section.text(
        "The experiments of chapter 4 of the thesis of 2002, on scenes made as it describes them: clusters \
         of spheres, 4,800 static and 200 that move. Its times come from an Athlon XP at 1.5 GHz with a \
         GeForce2, so ratios are compared. `cell` is the thesis' kind of visibility. An object is visible if \
         an item buffer of 1920x1080 shows a pixel of it.",
    );
    let mut table = Table::new("thesis-findings", &["section", "the thesis found", "we find"]);
    for experiment in [hidden::run, walk::run, angle::run, resolution::run, profile::run] {
        for (place, thesis, here) in experiment(lab)? {
            table.row([place.to_owned(), thesis, here]);
        }
    }
    section.table(table);
    Ok(section)
}
