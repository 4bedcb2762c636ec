//! The stability suite: worlds, views and motion under stress, for every method.
//!
//! Each case is a small world with the cameras of its frames. Exact visibility comes from the
//! [oracle](crate::oracle), and from points that a case was built to show.

mod case;
mod charts;
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

use super::{Lab, LabError, Section};

type Cases = fn(&Lab) -> Result<Vec<Case>, LabError>;
type Charts = fn(&Lab, &[Finding], &mut Section) -> Result<(), LabError>;

/// Cases of one kind.
struct Group {
    /// The stem of its table's name.
    name: &'static str,
    title: &'static str,
    /// What was done.
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
        "The camera trembles about four places and directions while the world stands still. A flip is an object that \
         comes or goes from one frame to the next although its exact visibility does not change; flicker is an \
         object found, not found and found again in three frames on end.",
        jitter::cases,
    )
    .drawn(charts::of_jitter),
    group(
        "places",
        "Places of the eye",
        "The eye on faces, edges and corners of cells, on the border and the corners of the grid, beyond the grid, \
         inside solids, on their faces, and so close to a wall that the near plane cuts into it. A sampled buffer \
         that starts its rays at the eye takes what lies before the near plane for an occluder, although it is cut away.",
        places::cases,
    ),
    group(
        "offset",
        "World offset",
        "The whole world is moved away from the origin, and its coordinates are rounded to single precision, whose \
         steps are 1 m at 1e7 m. Exact visibility is that of the rounded world. Methods that project with a \
         single-precision matrix place objects wrongly there; the library moves the planes of the matrix outwards \
         by what rounding leaves open, and takes the eye as it is given.",
        offset::cases,
    ),
    group(
        "gaps",
        "Gaps",
        "A wall 10 m away with up to 40 slits, from 10 cells wide to a hundredth of a pixel of the 640 wide buffer, \
         and behind each slit an object on the line of sight through its middle, which is visible by construction. \
         The wall is made of boxes thinner than a cell, of mesh sheets, or of closed meshes 1 m thick; cells are 1/8 m. \
         A sample that misses the slit sees only wall, so the narrower the slit, the more is lost.",
        gaps::cases,
    )
    .drawn(charts::of_gaps),
    group(
        "thin",
        "Thin walls",
        "A wall of 12 x 8 m before a crowd, from 4 cells thick to a thousandth of a cell and to nothing. `cell` hides \
         only by cells wholly inside solids, so it has no use for thin walls; `point` draws them as they are, as long as \
         they are solids or meshes: a box without thickness is neither, and hides nothing for it.",
        shapes::thin,
    ),
    group(
        "grazing",
        "Grazing walls",
        "The eye looks along a wall that runs past it, from 4 m off its face to exactly on its plane; small objects stick \
         to both sides. The near plane at 0.01 m cuts into the wall where it is closer than that.",
        shapes::grazing,
    ),
    group(
        "touching",
        "Coplanar and touching occluders",
        "The wall is put together from parts that touch, overlap, coincide or leave 0.1 mm between them, and objects \
         lie in its plane, on it and in it.",
        shapes::touching,
    ),
    group(
        "nested",
        "Objects equal to occluders, and nested ones",
        "Objects that are their own occluders, that coincide with another object's occluder, and objects inside each \
         other. An object whose surface is the occluder's is in sight.",
        shapes::nested,
    ),
    group(
        "sizes",
        "Zero-size and scene-size objects",
        "Points as spheres, boxes and triangles before and beside the wall; objects and occluders that hold the whole \
         scene, up to 1e6 m. What is smaller than a pixel lies between samples, but a rectangle that is rounded \
         outwards still finds most of it.",
        shapes::sizes,
    ),
    group(
        "meshes",
        "Degenerate occluders and meshes",
        "Meshes with triangles without area, needles, repeated and turned triangles, T-junctions, holes, without \
         thickness, inside out or open; and closed meshes in place of boxes, at rest and turning.",
        shapes::meshes,
    ),
    group(
        "motion",
        "Teleports, broken promises and time",
        "The camera or the moving objects jump in each frame; objects outrun the speed that they promised, which is \
         found out when they are reported; objects go unreported while hidden (they keep their promise then) under a \
         clock that runs backwards, leaps, stands still or takes huge steps. An unreported object counts as visible as soon as \
         the volume that holds it comes into sight, which makes the set larger. `rays` starts at the eye and hits what the \
         near plane cuts away.",
        motion::cases,
    ),
    group(
        "views",
        "Views",
        "From 179 degrees to a tenth of a degree, pictures ten times as wide as high and the other way round, near and \
         far planes at their limits, reversed depth, and a tilted camera.",
        views::cases,
    ),
    group(
        "resolution",
        "Resolution",
        "All methods at the same number of pixels, from 8 to 2048: across the picture for `hzb` and `rays`; of 90 degrees \
         for `point`, without a least number of pixels; of the masks of `cell`, which has 64 at least. Times are \
         against 256 pixels.",
        resolution::cases,
    )
    .drawn(charts::of_resolution),
];

/// Runs the cases of a group.
fn findings(lab: &Lab, group: &Group) -> Result<Vec<Finding>, LabError> {
    (group.cases)(lab)?.iter().map(|case| run::run(lab, case)).collect()
}

/// The suite: false negatives, PVS/EVS and time of every method in each case, and why objects are lost.
///
/// Writes its charts into the lab's folder. Takes some minutes, a quick run some seconds.
///
/// # Errors
/// If the library refuses a world, or a picture cannot be written.
pub fn stability(lab: &Lab) -> Result<Section, LabError> {
    let mut section = Section::new("Stability");
    let mut all = Vec::new();
    let mut details = Section::new("");
    for group in GROUPS {
        let found = findings(lab, group)?;
        details.text(format!("### {}\n\n{}\n\n{}", group.title, group.text, tables::words(&found)));
        if let Some(charts) = group.charts {
            charts(lab, &found, &mut details)?;
        }
        details.table(tables::table(&format!("stability-{}", group.name), &found));
        // Only numbers are needed from here on.
        all.extend(found);
    }
    let all: Vec<&Finding> = all.iter().collect();
    let known: usize = all.iter().map(|f| f.known - f.refuted).sum();
    let tested: usize = all.iter().map(|f| f.in_frustum).sum();
    let sure: usize = all.iter().map(|f| f.sure).sum();
    section.text(format!(
        "Every case is run with `point` and `cell` at their defaults, `hzb` (rasterised depth, {}x{}) and `rays` (ray-cast \
         depth, {}x{}), which get the objects in the frustum for nothing. A false negative is an object that is visible \
         beyond the doubt of rounding and left out: it shows in an item buffer of {}x{} pixels, is hit by one of {} rays \
         aimed at every object in the frustum, or by a ray to a point that the case was built to show. \"Visible\" (EVS) is \
         the mean number of visible objects. Times are medians, against the calm case above the row; they grow, too, where a case shows more objects. Of {tested} objects \
         in the frustum, summed over all frames, {sure} are visible for certain, {known} of them at built points.",
        run::HZB,
        run::rows(run::HZB),
        run::RAYS,
        run::rows(run::RAYS),
        run::item_width(lab),
        run::rows(run::item_width(lab)),
        run::aimed_rays(lab),
    ));
    section.table(tables::summary(&all));
    let lost = |method: &str| -> usize { all.iter().filter_map(|f| f.of(method)).map(|o| o.lost).sum() };
    section.text(format!(
        "**`point` and `cell`: {} rows, {} false negatives.**",
        2 * all.len(),
        lost("point") + lost("cell")
    ));
    section.blocks.extend(details.blocks);
    Ok(section)
}
