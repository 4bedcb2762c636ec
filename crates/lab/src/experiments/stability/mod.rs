//! The stability suite: worlds, views and motion under stress, for every method.
//!
//! Each case is a small world with the cameras of its frames. Exact visibility comes from the
//! [oracle](casca_truth::oracle), and from points that a case was built to show.

mod arena;
mod case;
mod charts;
mod degenerate;
mod gaps;
mod jitter;
mod motion;
mod offset;
mod places;
mod resolution;
mod run;
mod shapes;
mod tables;
#[cfg(test)]
mod tests;
mod views;
mod walks;

use case::Case;
use run::Finding;

use super::{Lab, LabError, Section, grouped};

type Cases = fn(&Lab) -> Result<Vec<Case>, LabError>;
type Charts = fn(&Lab, &[Finding], &mut Section) -> Result<(), LabError>;

/// Cases of one kind.
struct Group {
    /// The stem of its table's name.
    name: &'static str,
    title: &'static str,
    /// The cases, in a sentence or two.
    text: &'static str,
    cases: Cases,
    charts: Option<Charts>,
}

const fn group(name: &'static str, title: &'static str, text: &'static str, cases: Cases) -> Group {
    Group { name, title, text, cases, charts: None }
}

impl Group {
    const fn drawn(self, charts: Charts) -> Self {
        Self { charts: Some(charts), ..self }
    }
}

const GROUPS: &[Group] = &[
    group(
        "jitter",
        "Camera jitter",
        "The camera trembles about four places while the world stands still.",
        jitter::cases,
    )
    .drawn(charts::of_jitter),
    group(
        "places",
        "Places of the eye",
        "The eye is on faces, edges and corners of cells, on and beyond the border of the grid, inside solids, on their \
         faces, and so close to a wall that the near plane cuts into it.",
        places::cases,
    ),
    group(
        "offset",
        "World offset",
        "The whole world moves up to 1e7 m away from the origin, where single precision has steps of 1 m; exact \
         visibility is that of the rounded world.",
        offset::cases,
    ),
    group(
        "gaps",
        "Gaps",
        "A wall 10 m away has up to 40 slits, from 10 cells wide to a hundredth of a pixel, and an object behind each, \
         visible by construction. The wall is made of thin boxes, mesh sheets or closed meshes.",
        gaps::cases,
    )
    .drawn(charts::of_gaps),
    group(
        "thin",
        "Thin walls",
        "A wall of 12 x 8 m stands before a crowd, from 4 cells thick down to nothing. `cell` hides only by cells \
         wholly inside solids, so thin walls are of no use to it.",
        shapes::thin,
    ),
    group(
        "grazing",
        "Grazing walls",
        "The eye looks along a wall, from 4 m off its face to exactly on its plane; small objects stick to both sides.",
        degenerate::grazing,
    ),
    group(
        "touching",
        "Coplanar and touching occluders",
        "The parts of a wall touch, overlap, coincide or leave 0.1 mm between them; objects lie in its plane, on it and \
         in it.",
        shapes::touching,
    ),
    group(
        "nested",
        "Nested objects",
        "Objects are their own occluders, coincide with other occluders, or contain each other.",
        shapes::nested,
    ),
    group(
        "sizes",
        "Zero-size and scene-size objects",
        "Points as spheres, boxes and triangles stand before and beside the wall; others contain the whole scene, up to \
         1e6 m.",
        shapes::sizes,
    ),
    group(
        "meshes",
        "Degenerate meshes",
        "Meshes have triangles without area, needles, repeated and turned triangles, T-junctions, holes, no thickness, or \
         are inside out or open; closed ones rest and turn.",
        degenerate::meshes,
    ),
    group(
        "motion",
        "Teleports, broken promises and time",
        "Camera or objects jump in each frame, outrun their promised speed, or go unreported while hidden; the clock \
         runs backwards, leaps or stands still.",
        motion::cases,
    ),
    group(
        "views",
        "Views",
        "Angles of view from 179 degrees to a tenth of a degree, pictures ten times as wide as high and the other way \
         round, extreme near and far planes, reversed depth, and a tilted camera.",
        views::cases,
    ),
    group(
        "resolution",
        "Resolution",
        "All methods have the same number of pixels, from 8 to 2048: across the picture for `hzb` and `rays`, on 90 \
         degrees for `point`, of the masks for `cell`, which has 64 at least.",
        resolution::cases,
    )
    .drawn(charts::of_resolution),
];

/// Runs the cases of a group.
fn findings(lab: &Lab, group: &Group) -> Result<Vec<Finding>, LabError> {
    (group.cases)(lab)?.iter().map(|case| run::run(lab, case)).collect()
}

/// The suite: lost objects, PVS/visible and time of every method in each case, and why objects are
/// lost.
///
/// Writes its charts into the lab's folder. Takes some minutes, a quick run some seconds.
///
/// # Errors
/// If the library refuses a world, or a picture cannot be written.
pub fn stability(lab: &Lab) -> Result<Section, LabError> {
    let mut section = Section::on_its_own_page("Stability");
    let mut all = Vec::new();
    let (mut items, mut pictures) = (Section::new(""), Section::new(""));
    for group in GROUPS {
        let found = findings(lab, group)?;
        items.item(
            format!("**{}.** {} {}", group.title, group.text, tables::words(&found)),
            tables::table(&format!("stability-{}", group.name), &found),
        );
        if let Some(charts) = group.charts {
            charts(lab, &found, &mut pictures)?;
        }
        // Only numbers are needed from here on.
        all.extend(found);
    }
    let all: Vec<&Finding> = all.iter().collect();
    let lost = |method: &str| match all.iter().filter_map(|f| f.of(method)).map(|o| o.lost).sum() {
        0 => "none".to_owned(),
        n => grouped(n),
    };
    let known: usize = all.iter().map(|f| f.known - f.refuted).sum();
    section.text(format!(
        "**Visible objects lost in {} cases: `point` {}, `cell` {}, `hzb` {}, `rays` {}.** An object is lost if \
         it is left out although it is visible beyond the doubt of rounding: it shows in an item buffer of {}x{} pixels, \
         is hit by one of {} rays aimed at every object in the frustum, or by a ray to one of {} points that the case was \
         built to show. `point` and `cell` have default settings, `hzb` has {}x{} pixels and `rays` {}x{}; both get the objects \
         in the frustum for nothing. A sighting is an object in a frame.",
        all.len(),
        lost("point"),
        lost("cell"),
        lost("hzb"),
        lost("rays"),
        run::item_width(lab),
        run::rows(run::item_width(lab)),
        run::aimed_rays(lab),
        grouped(known),
        run::HZB,
        run::rows(run::HZB),
        run::RAYS,
        run::rows(run::RAYS),
    ));
    section.table(tables::summary(&all));
    section.blocks.extend(pictures.blocks);
    section.text("### Cases");
    section.blocks.extend(items.blocks);
    Ok(section)
}
