//! Shadow casters: rays of a light that graze occluders, and what stands in their way.

use casca::{Aabb, KeptQuery, Light, Method, ObjectId, PointOptions, Query, View};
use glam::{DVec3, Vec3};

use super::super::dice::direction;
use super::super::solid::Answer;
use super::rims::Start;
use super::stage::Stage;
use super::views::{camera, limits};
use crate::numeric::attack::{CASTER_ROOM, IN_RANGE};

/// A ray of a light to a point that is on a receiver, and the point where a caster meets it.
struct Ray {
    receiver: usize,
    caster: usize,
    lit: DVec3,
    met: DVec3,
    shape: usize,
}

/// Plays a scene with a camera and a light.
pub fn play(mut stage: Stage) -> Stage {
    let around = stage.dice.once_in(2);
    let limits = limits(&mut stage, around);
    let (eye, forward) = (stage.eye(), direction(&mut stage.dice));
    let up = forward.any_orthonormal_vector();
    let Some(camera) = camera(eye, forward, up, &limits, u64::MAX) else { return stage };
    let walls = 6 + stage.dice.below(12);
    (0..walls).for_each(|_| stage.wall(|_| true, false));
    let (unit, middle) = (stage.unit, stage.middle);
    let along = direction(&mut stage.dice);
    let at = middle + direction(&mut stage.dice) * unit * stage.dice.between(2.0, 20.0);
    // A light lights nothing out of its range. Parallel rays start before all occluders only to
    // places that are not far.
    let (light, start, middle, range) = match stage.dice.below(3) {
        0 => {
            let start = Start::Before(along.as_dvec3().normalize(), f64::from(unit) * 500.0);
            (Light::directional(along), start, middle, unit * 200.0)
        }
        1 => {
            let range = unit * stage.dice.pick(&[f32::INFINITY, 200.0]);
            (Light::point(at, range), Start::Eye(at.as_dvec3()), at, range)
        }
        _ => {
            let Ok(view) = View::omnidirectional(at) else { return stage };
            (Light::spot(view), Start::Eye(at.as_dvec3()), at, f32::INFINITY)
        }
    };
    let lit = |p: DVec3| p.distance(middle.as_dvec3()) < f64::from(range) * IN_RANGE;
    let rays: Vec<Ray> = (0..500)
        .filter_map(|number| {
            let from = if number % 3 == 0 { Start::Eye(camera.eye) } else { start };
            ray(&mut stage, &from, &start, |p| lit(p) && camera.truth.sight(p).is_some())
        })
        .collect();
    stage.insert_targets();
    let presets = [PointOptions::fast(), PointOptions::balanced()].map(Method::Point);
    let cameras = presets.map(|m| Query::with_method(m).unwrap_or_default());
    let lights = [presets[0], presets[1], Method::cell(), Method::Frustum];
    let mut casters = Vec::new();
    for mut query in cameras {
        query.run(&stage.scene, &camera.view);
        for method in lights {
            let Ok(mut sun) = Query::with_method(method) else { continue };
            if sun.shadow_casters(&stage.scene, &query, &light, &mut casters).is_ok() {
                judge(&mut stage, "casters", &camera.eye, &rays, &start, &casters);
            }
        }
    }
    let mut kept = KeptQuery::new();
    kept.run(&stage.scene, &camera.view);
    if Query::new().shadow_casters(&stage.scene, &kept, &light, &mut casters).is_ok() {
        judge(&mut stage, "casters of a kept query", &camera.eye, &rays, &start, &casters);
    }
    stage
}

/// A lit point closely past an occluder, as seen from the light or from the camera, with a caster
/// on the ray.
fn ray(stage: &mut Stage, from: &Start, light: &Start, inside: impl Fn(DVec3) -> bool) -> Option<Ray> {
    let (near, out, shape) = stage.graze(from)?;
    let lit = stage.behind(from, near, out);
    if !inside(lit) {
        return None;
    }
    let toward = light.toward(lit);
    // The lit point itself is geometry.
    let receiver = stage.target(Aabb::new(lit.as_vec3(), lit.as_vec3()).into());
    let share = match stage.dice.below(3) {
        0 => 10f64.powf(-5.0 * stage.dice.real()),
        _ => stage.dice.real(),
    };
    let met = lit - toward * share.min(0.999);
    // A box of a few units in the last place around the point where the ray meets it.
    let corner = |next: fn(f32) -> f32| Vec3::from_array(met.as_vec3().to_array().map(next));
    let caster = stage.target(Aabb::new(corner(f32::next_down), corner(f32::next_up)).into());
    Some(Ray { receiver, caster, lit, met, shape })
}

fn judge(
    stage: &mut Stage,
    way: &'static str,
    eye: &DVec3,
    rays: &[Ray],
    light: &Start,
    casters: &[ObjectId],
) {
    let found: std::collections::BTreeSet<ObjectId> = casters.iter().copied().collect();
    for Ray { receiver, caster, lit, met, shape } in rays {
        let from = *lit - light.toward(*lit);
        let seen = stage.free(*eye, *lit, u64::MAX);
        let first = stage.free(from, *met, u64::MAX);
        let answer = seen.max(first);
        let ids = (stage.targets[*receiver].id, stage.targets[*caster].id);
        let (Some(_), Some(id)) = ids else { continue };
        // Another small object may be the first on the ray.
        let held = found.contains(&id) || (answer == Answer::Free && blocked(stage, *caster, from, *met));
        let text = || format!("a caster at {met} before {lit} lit from {from}, seen from {eye}");
        stage.count(way, *shape, answer, held, text);
    }
}

/// Whether the box of another small object may meet a segment.
fn blocked(stage: &Stage, but: usize, from: DVec3, to: DVec3) -> bool {
    let d = to - from;
    stage.targets.iter().enumerate().any(|(i, target)| {
        let casca::Bounds::Box(b) = &target.bounds else { return i != but };
        let (min, max) = (b.min.as_dvec3(), b.max.as_dvec3());
        let room = CASTER_ROOM * (1.0 + from.abs().max_element() + to.abs().max_element());
        let (mut near, mut far) = (0f64, 1f64);
        for axis in 0..3 {
            let ends = [(min[axis] - room - from[axis]) / d[axis], (max[axis] + room - from[axis]) / d[axis]];
            near = near.max(ends[0].min(ends[1]));
            far = far.min(ends[0].max(ends[1]));
        }
        i != but && near <= far
    })
}
