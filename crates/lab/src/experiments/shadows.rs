//! Shadow casters: how many objects a shadow map has to draw.

use casca::{Light, Method, Query, View};
use glam::{Mat4, Vec3, camera};

use super::walker::Walker;
use super::{Lab, LabError, Place, Section, Table, median, places};
use casca_scenes::drive::view_of;
use casca_scenes::generated::SceneKind;
use casca_scenes::measure::timed;

/// Where the sun's light goes.
const SUN: Vec3 = Vec3::new(0.4, -1.0, 0.3);

/// The orthographic view along the sun's light that holds a region: what a shadow map over it would
/// cull to.
fn over(min: Vec3, max: Vec3) -> Result<View, casca::Error> {
    let (middle, reach) = ((min + max) * 0.5, (max - min).length() * 0.5);
    let view = camera::rh::view::look_to_mat4(middle - SUN.normalize() * reach, SUN, Vec3::Z);
    let r = reach.max(f32::MIN_POSITIVE);
    let projection: Mat4 = camera::rh::proj::directx::orthographic(-r, r, -r, r, 0.0, 2.0 * r);
    View::orthographic(SUN, projection * view)
}

/// Objects that a shadow map has to draw on every scene, and what finding them costs.
///
/// # Errors
/// If a scene cannot be read or is refused.
pub fn shadows(lab: &Lab) -> Result<Section, LabError> {
    let mut section = Section::new("Shadow casters");
    let mut table = Table::new(
        "shadows",
        &[
            "scene",
            "objects",
            "PVS of the camera",
            "visible from the sun",
            "casters",
            "query of the camera, ms",
            "query of the casters, ms",
        ],
    );
    let frames = lab.pick(20, 2);
    let mut totals = Vec::new();
    for place in places(lab) {
        if lab.quick && !matches!(place, Place::Built(SceneKind::City)) {
            continue;
        }
        let world = place.open(lab)?;
        (lab.progress)(&world.name);
        let mut walker = Walker::new(world)?;
        let (mut eye, mut sun) = (Query::with_method(Method::point())?, Query::with_method(Method::point())?);
        let mut all = Query::with_method(Method::point())?;
        let mut casters = Vec::new();
        let (mut eye_ms, mut sun_ms) = (Vec::new(), Vec::new());
        let (mut seen, mut lit, mut cast) = (0, 0, 0);
        let hint = walker.world.grid;
        let over = over(hint.min, hint.max)?;
        let done = walker.walk::<LabError>(frames, |walker, _, frame| {
            let scene = &walker.driver(0).scene;
            let view = view_of(&frame.camera)?;
            let (found, time) = timed(|| eye.run(scene, &view).len());
            eye_ms.push(time.as_secs_f64() * 1e3);
            seen += found;
            let (found, time) =
                timed(|| sun.shadow_casters(scene, &eye, &Light::directional(SUN), &mut casters));
            found?;
            sun_ms.push(time.as_secs_f64() * 1e3);
            cast += casters.len();
            lit += all.run(scene, &over).len();
            Ok(())
        })?;
        let mean = |n: usize| format!("{:.0}", n as f64 / done.max(1) as f64);
        totals.push((lit as f64, cast as f64));
        table.row([
            walker.world.name.clone(),
            walker.world.objects.len().to_string(),
            mean(seen),
            mean(lit),
            mean(cast),
            format!("{:.3}", median(&mut eye_ms)),
            format!("{:.3}", median(&mut sun_ms)),
        ]);
    }
    let share = |part: f64, whole: f64| if whole > 0.0 { part / whole * 100.0 } else { 100.0 };
    let shares = totals.iter().map(|(lit, cast)| share(*cast, *lit));
    let (least, most) = shares.fold((f64::INFINITY, 0.0f64), |(lo, hi), s| (lo.min(s), hi.max(s)));
    section.text(format!(
        "`Query::shadow_casters` finds the objects that may cast a shadow onto anything in the camera's PVS \
         and view, without those that stand in the shadow of others. A shadow map with these alone shows the \
         same visible shadows (`tests/shadows` compares that with exact rays). **It needs {least:.0}% to \
         {most:.0}% of the objects that the sun sees of the whole scene**, which a shadow map has to draw \
         without knowing the camera. The sun's light goes along ({}, {}, {}); means and medians over \
         {frames} frames of each walk.",
        SUN.x, SUN.y, SUN.z
    ));
    section.rows("All scenes as CSV", table);
    Ok(section)
}
