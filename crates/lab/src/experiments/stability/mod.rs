//! The stability suite: worlds, views and motion under stress, for every method.
//!
//! Each case is a small world with the cameras of its frames. Exact visibility comes from the
//! [oracle](casca_truth::oracle), and from points that a case was built to show.

mod arena;
mod case;
mod degenerate;
mod gaps;
mod motion;
mod places;
mod run;
mod shapes;
#[cfg(test)]
mod tests;
mod walks;

use arena::Arena;
use case::Case;
use run::{Finding, Outcome};

use super::{Lab, LabError, Section, Table};

type Cases = fn(&Lab) -> Result<Vec<Case>, LabError>;

/// Cases of one kind: their name, and what is awkward about them.
const GROUPS: &[(&str, &str, Cases)] = &[
    ("jitter", "cameras that tremble", walks::jitter),
    (
        "places",
        "eyes on corners of cells, on and beyond the border of the grid, in solids and on their faces",
        places::cases,
    ),
    ("offset", "worlds up to 1e7 m away from the origin, as rounded there", walks::offset),
    (
        "gaps",
        "slits down to a hundredth of a pixel, with an object behind each that shows by construction",
        gaps::cases,
    ),
    ("thin", "walls down to no thickness", |lab| Arena::new(lab).thin()),
    ("grazing", "views along walls", |lab| Arena::new(lab).grazing()),
    ("touching", "occluders that touch, overlap and coincide", |lab| Arena::new(lab).touching()),
    ("nested", "objects that are their own occluders or hold each other", |lab| Arena::new(lab).nested()),
    ("sizes", "points, and objects that hold the whole scene", |lab| Arena::new(lab).sizes()),
    ("meshes", "degenerate meshes", |lab| Arena::new(lab).meshes()),
    (
        "motion",
        "jumps, speeds beyond what was promised, and clocks that leap or run backwards",
        motion::cases,
    ),
    ("views", "angles of view from 179 to 0.1 degrees, extreme planes and pictures", walks::views),
];

/// Runs the cases of a group.
fn findings(lab: &Lab, cases: Cases) -> Result<Vec<Finding>, LabError> {
    cases(lab)?.iter().map(|case| run::run(lab, case)).collect()
}

/// The suite: the objects that every method loses in each case.
///
/// Takes some minutes, a quick run some seconds.
///
/// # Errors
/// If the library refuses a world.
pub fn stability(lab: &Lab) -> Result<Section, LabError> {
    let mut section = Section::new("Stability");
    let columns = ["group", "case", "method", "visible", "found", "objects lost"];
    let mut table = Table::new("stability", &columns);
    let mut all = Vec::new();
    for (name, _, cases) in GROUPS {
        let found = findings(lab, *cases)?;
        add_rows(&mut table, name, &found);
        all.extend(found);
    }
    let kinds: Vec<&str> = GROUPS.iter().map(|(_, text, _)| *text).collect();
    section.text(format!(
        "{} cases: {}. An object is lost if it is left out although it is visible beyond the doubt of \
         rounding: it shows in an item buffer of {}x{} pixels, or is hit by one of {} rays aimed at every \
         object in the frustum or by one to a point that the case was built to show. `point` and `cell` have \
         default settings and `hzb` {}x{} pixels.",
        all.len(),
        kinds.join("; "),
        run::item_width(lab),
        run::rows(run::item_width(lab)),
        run::aimed_rays(lab),
        run::HZB,
        run::rows(run::HZB),
    ));
    section.table(summary(&all));
    section.rows("All cases as CSV", table);
    Ok(section)
}

/// Adds a row for each case of a group and method but the frustum.
fn add_rows(table: &mut Table, group: &str, findings: &[Finding]) {
    for finding in findings {
        for outcome in finding.outcomes.iter().filter(|o| o.method != "frustum") {
            table.row([
                group.to_owned(),
                finding.case.clone(),
                outcome.method.to_owned(),
                finding.visible.to_string(),
                outcome.found.to_string(),
                outcome.lost.to_string(),
            ]);
        }
    }
}

/// One row for each method: how it fared in all cases.
fn summary(findings: &[Finding]) -> Table {
    let columns =
        ["method", "cases", "cases with losses", "objects lost", "of sightings", "worst case", "lost in it"];
    let mut table = Table::new("stability-summary", &columns);
    let names: Vec<&str> =
        findings.first().map_or(Vec::new(), |f| f.outcomes.iter().map(|o| o.method).collect());
    let sure: usize = findings.iter().map(|f| f.sure).sum();
    for name in names {
        let outcomes: Vec<(&str, &Outcome)> =
            findings.iter().filter_map(|f| Some((f.case.as_str(), f.of(name)?))).collect();
        let worst = outcomes.iter().max_by_key(|(_, o)| o.lost).filter(|(_, o)| o.lost > 0);
        let lost: usize = outcomes.iter().map(|(_, o)| o.lost).sum();
        table.row([
            name.to_owned(),
            outcomes.len().to_string(),
            outcomes.iter().filter(|(_, o)| o.lost > 0).count().to_string(),
            lost.to_string(),
            sure.to_string(),
            worst.map_or("-".to_owned(), |(case, _)| (*case).to_owned()),
            worst.map_or(0, |(_, o)| o.lost).to_string(),
        ]);
    }
    table
}
