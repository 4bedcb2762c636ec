//! Runs a case with every method and judges what they find.

use casca::{Method, ObjectDesc};

use super::case::{ASPECT, Case};
use crate::experiments::{Contender, FrameInput, Lab, LabError};
use casca_scenes::drive::Driver;
use casca_scenes::world::{Camera, Motion, Object, Shape};
use casca_truth::oracle::{FrameVerdict, Frustum, Oracle, OracleOptions};

/// Rows of the baselines' buffers for a number of columns.
pub(super) fn rows(columns: usize) -> usize {
    (columns as f32 / ASPECT).ceil() as usize
}

/// Columns of the baselines' buffers at their usual settings.
pub(super) const HZB: usize = 640;

/// Pixels across the item buffer.
pub(super) fn item_width(lab: &Lab) -> usize {
    lab.pick(960, 320)
}

/// Rays aimed at each object that no pixel shows.
pub(super) fn aimed_rays(lab: &Lab) -> usize {
    lab.pick(32, 12)
}

/// What a method made of a case.
#[derive(Default)]
pub(super) struct Outcome {
    pub(super) method: &'static str,
    /// Objects found, summed over the frames.
    pub(super) found: usize,
    /// Visible objects that it lacks, summed over the frames.
    pub(super) lost: usize,
    /// Of those, the ones whose known points were in sight.
    pub(super) lost_known: usize,
    /// The first of them: frame and object.
    pub(super) first_lost: Option<(usize, usize)>,
}

/// A case, and what all methods made of it.
#[derive(Default)]
pub(super) struct Finding {
    pub(super) case: String,
    /// Visible objects, summed over the frames.
    pub(super) visible: usize,
    /// Objects visible beyond the doubt of rounding, summed over the frames: those that can be
    /// lost.
    pub(super) sure: usize,
    /// Points that the case was built to show, summed over the frames that hold them.
    pub(super) known: usize,
    /// Of those, the ones that another object hides after all; they do not count.
    pub(super) refuted: usize,
    pub(super) outcomes: Vec<Outcome>,
}

impl Finding {
    /// Of a method by its name.
    pub(super) fn of(&self, method: &str) -> Option<&Outcome> {
        self.outcomes.iter().find(|o| o.method == method)
    }
}

/// The methods at their usual settings; the frustum first, `point` next.
fn contenders() -> Result<Vec<Contender>, LabError> {
    let casca = |method| Contender::casca("", method);
    Ok(vec![
        casca(Method::Frustum)?,
        casca(Method::point())?,
        casca(Method::cell())?,
        Contender::hzb(HZB, rows(HZB)),
    ])
}

/// Whether a shape may meet the frustum; meshes are taken to.
fn may_meet(frustum: &Frustum, shape: &Shape) -> bool {
    match shape {
        Shape::Sphere { center, radius } => frustum.may_meet_sphere(center.as_dvec3(), f64::from(*radius)),
        Shape::Box { min, max } => frustum.may_meet_box(min.as_dvec3(), max.as_dvec3()),
        Shape::Mesh { .. } => true,
    }
}

/// Brings the scene up to date.
fn advance(
    case: &Case,
    number: usize,
    objects: &mut [Object],
    driver: &mut Driver,
    seen: &[usize],
) -> Result<Vec<usize>, LabError> {
    let shot = &case.shots[number];
    let due = driver.scene.begin_frame(shot.time)?;
    let mut moved = Vec::with_capacity(shot.moves.len());
    for (i, shape) in &shot.moves {
        if let Some(object) = objects.get_mut(*i) {
            object.shape = shape.clone();
            moved.push(*i);
        }
    }
    if case.unreported {
        let reported: Vec<usize> = (0..objects.len())
            .filter(|&i| objects[i].motion != Motion::Static)
            .filter(|&i| number == 0 || seen.binary_search(&i).is_ok() || due.contains(&driver.id(i)))
            .collect();
        driver.update(objects, &reported)?;
    } else {
        driver.update(objects, &moved)?;
    }
    Ok(moved)
}

/// A frame as it stands.
struct Now<'a> {
    driver: &'a Driver,
    objects: &'a [Object],
    camera: &'a Camera,
    frustum: Frustum,
}

/// An object that is seen beyond doubt.
struct Sure {
    object: usize,
    /// Whether the case says so.
    known: bool,
}

/// Runs all contenders on a frame.
fn ask(now: &Now, contenders: &mut [Contender], finding: &mut Finding) -> Result<(), LabError> {
    let Now { driver, objects, camera, .. } = *now;
    let mut in_frustum = Vec::new();
    for (k, contender) in contenders.iter_mut().enumerate() {
        let frame = FrameInput { driver, objects, in_frustum: &in_frustum, camera };
        contender.run(&frame)?;
        if let (0, Some(pvs)) = (k, contender.pvs()) {
            // Objects whose place the library does not know count as seen; the baselines know it.
            in_frustum = (0..objects.len())
                .filter(|&i| driver.sees(pvs, i) && may_meet(&now.frustum, &objects[i].shape))
                .collect();
        }
        finding.outcomes[k].found += contender.found().len();
    }
    Ok(())
}

/// The objects that the oracle sees and those that the case knows of; the exact set goes into the
/// finding.
fn surely_seen(
    case: &Case,
    now: &Now,
    oracle: &Oracle,
    verdict: FrameVerdict,
    finding: &mut Finding,
) -> Vec<Sure> {
    let mut sure: Vec<Sure> =
        verdict.false_negatives.iter().map(|f| Sure { object: f.object, known: false }).collect();
    let mut exact = verdict.exact;
    for known in &case.known {
        if !now.frustum.surely_contains(known.point) {
            continue;
        }
        finding.known += 1;
        let origin = now.frustum.start(known.point);
        if oracle.rays().occluded(origin, known.point, known.object) {
            finding.refuted += 1;
            continue;
        }
        match sure.iter_mut().find(|s| s.object == known.object) {
            Some(s) => s.known = true,
            None => sure.push(Sure { object: known.object, known: true }),
        }
        exact.push(known.object);
    }
    exact.sort_unstable();
    exact.dedup();
    finding.visible += exact.len();
    finding.sure += sure.len();
    sure
}

/// Counts what a method lost in a frame.
fn count_losses(number: usize, contender: &Contender, sure: &[Sure], outcome: &mut Outcome) {
    for lost in sure.iter().filter(|s| !contender.sees(s.object)) {
        outcome.lost += 1;
        outcome.lost_known += usize::from(lost.known);
        outcome.first_lost.get_or_insert((number, lost.object));
    }
}

/// Runs all frames of a case.
///
/// # Errors
/// If the library refuses the case.
pub(super) fn run(lab: &Lab, case: &Case) -> Result<Finding, LabError> {
    (lab.progress)(&case.name);
    let mut objects = case.objects.clone();
    let adapt = |object: &Object, desc: ObjectDesc| match object.motion {
        Motion::Dynamic { .. } if case.unreported => desc.reported_on_expiry(),
        _ => desc,
    };
    let mut driver = Driver::with(&objects, case.cell, None, adapt, |_| ())?;
    let mut contenders = contenders()?;
    let options = OracleOptions {
        width: item_width(lab),
        height: rows(item_width(lab)),
        samples_per_object: aimed_rays(lab),
        seed: lab.seed,
        ..OracleOptions::default()
    };
    let mut oracle = Oracle::new(&objects, options);
    let outcome = |contender: &Contender| Outcome { method: contender.method, ..Outcome::default() };
    let outcomes = contenders.iter().map(outcome).collect();
    let mut finding = Finding { case: case.name.clone(), outcomes, ..Finding::default() };
    let mut seen = Vec::new();
    for (number, shot) in case.shots.iter().enumerate() {
        let camera = &shot.camera;
        let moved = advance(case, number, &mut objects, &mut driver, &seen)?;
        let now = Now { driver: &driver, objects: &objects, camera, frustum: Frustum::new(camera) };
        ask(&now, &mut contenders, &mut finding)?;
        // Nothing is taken for granted: the oracle looks for every object in view.
        let verdict = oracle.frame(&objects, &moved, camera, &|_| false);
        let sure = surely_seen(case, &now, &oracle, verdict, &mut finding);
        for (contender, outcome) in contenders.iter().zip(&mut finding.outcomes) {
            count_losses(number, contender, &sure, outcome);
        }
        // Only `point` says what is hidden, so that as much as possible is.
        if let Some(pvs) = contenders.get(1).and_then(Contender::pvs) {
            seen = driver.found(pvs);
            driver.scene.end_frame([pvs])?;
        }
    }
    Ok(finding)
}
