//! Eyes where rounding and special cases lurk: on planes of the grid, at its border, beyond it and
//! in solids.

use glam::{BVec3, Quat, Vec3};

use super::case::{Case, placed};
use super::walks::Walk;
use crate::experiments::{Lab, LabError};
use casca_scenes::generated::SceneKind;
use casca_scenes::world::{Camera, Shape};

/// Points a camera at a place.
fn aimed(base: &Camera, eye: Vec3, at: Vec3) -> Camera {
    let look = Camera::look_at(eye, at, 60.0, 1.0, 0.1, 1.0);
    Camera { eye, view: look.view, projection: base.projection }
}

/// Eyes moved to the nearest planes between cells along the axes chosen.
fn on_planes(cameras: &[Camera], axes: BVec3, nudge: f32) -> Vec<Camera> {
    let place = |c: &Camera| {
        let eye = Vec3::select(axes, c.eye.round() + nudge, c.eye);
        placed(c, eye, Quat::IDENTITY)
    };
    cameras.iter().map(place).collect()
}

/// All cases.
pub(super) fn cases(lab: &Lab) -> Result<Vec<Case>, LabError> {
    let frames = lab.pick(8, 2);
    let mut cases = around_spheres(lab, frames)?;
    cases.extend(among_buildings(lab, frames)?);
    Ok(cases)
}

/// Eyes in and around the hall of spheres.
fn around_spheres(lab: &Lab, frames: usize) -> Result<Vec<Case>, LabError> {
    let spheres = Walk::new(SceneKind::Spheres, lab.seed, frames)?;
    let axes = [
        ("eye on faces of cells", BVec3::new(true, false, false)),
        ("eye on edges of cells", BVec3::new(true, false, true)),
        ("eye on corners of cells", BVec3::TRUE),
    ];
    let mut cases = vec![spheres.still("spheres, eye inside cells", spheres.cameras.clone())];
    for (name, axes) in axes {
        cases.push(spheres.still(format!("spheres, {name}"), on_planes(&spheres.cameras, axes, 0.0)));
    }
    let beside = on_planes(&spheres.cameras, BVec3::TRUE, 1e-5);
    cases.push(spheres.still("spheres, eye 1e-5 m beside corners of cells", beside));

    // The grid spans 100 x 60 x 100 m from the origin.
    let middle = Vec3::new(50.0, 30.0, 50.0);
    let around = |place: &dyn Fn(Vec3) -> Vec3| -> Vec<Camera> {
        let Some(base) = spheres.cameras.first() else { return Vec::new() };
        let direction = |i: usize| {
            let a = i as f32 / frames as f32 * std::f32::consts::TAU + 0.3;
            Vec3::new(a.cos(), 0.3 * (2.0 * a).sin(), a.sin())
        };
        (0..frames).map(|i| place(direction(i))).map(|eye| aimed(base, eye, middle)).collect()
    };
    // The point of the border in a direction.
    let border = |d: Vec3| {
        let reach = (middle / d.abs().max(Vec3::splat(1e-3))).min_element();
        let p = middle + d * reach;
        // Exactly on the plane that was hit.
        Vec3::select((p - p.round()).abs().cmplt(Vec3::splat(1e-3)), p.round(), p)
    };
    cases.push(spheres.still("spheres, eye on the border of the grid", around(&border)));
    let corner = |d: Vec3| Vec3::select(d.cmplt(Vec3::ZERO), Vec3::ZERO, middle * 2.0);
    cases.push(spheres.still("spheres, eye on corners of the grid", around(&corner)));
    for metres in [1.0, 100.0, 1e4f32] {
        let outside = |d: Vec3| border(d) + d.normalize_or_zero() * metres;
        let mut cameras = around(&outside);
        if metres > 1000.0 {
            // From so far away a narrow view with a far plane beyond the scene.
            for c in &mut cameras {
                let narrow = Camera::look_at(c.eye, middle, 0.6, super::case::ASPECT, 1.0, 2e4);
                c.projection = narrow.projection;
            }
        }
        cases.push(spheres.still(format!("spheres, eye {metres} m outside the grid"), cameras));
    }
    Ok(cases)
}

/// Eyes in the streets of the city, in its buildings and on their walls.
fn among_buildings(lab: &Lab, frames: usize) -> Result<Vec<Case>, LabError> {
    let city = Walk::new(SceneKind::City, lab.seed, frames)?;
    let mut cases = vec![city.still("city, eye in the streets", city.cameras.clone())];
    let buildings: Vec<(Vec3, Vec3)> = city
        .objects
        .iter()
        .filter(|o| o.name == "building")
        .filter_map(|o| match o.shape {
            Shape::Box { min, max } => Some((min, max)),
            _ => None,
        })
        .collect();
    let Some(base) = city.cameras.first().copied() else { return Ok(cases) };
    let every = (buildings.len() / frames.max(1)).max(1);
    let of_buildings = |place: &dyn Fn(Vec3, Vec3) -> (Vec3, Vec3)| -> Vec<Camera> {
        let chosen = buildings.iter().step_by(every).take(frames);
        chosen.map(|&(lo, hi)| place(lo, hi)).map(|(eye, at)| aimed(&base, eye, at)).collect()
    };
    let inside = |lo: Vec3, hi: Vec3| ((lo + hi) * 0.5, Vec3::new(100.0, 2.0, 100.0));
    cases.push(city.still("city, eye inside opaque cells", of_buildings(&inside)));
    // On the wall towards lesser x, looking away from it, along it and into it.
    for (name, gap, to) in [
        ("on a wall, looking away", 0.0, Vec3::new(-20.0, -1.0, 3.0)),
        ("on a wall, looking along it", 0.0, Vec3::new(0.0, -0.5, 20.0)),
        ("on a wall, looking into it", 0.0, Vec3::new(20.0, -0.5, 3.0)),
        ("0.05 m before a wall that the near plane cuts", 0.05, Vec3::new(20.0, -0.5, 3.0)),
    ] {
        let at_wall = |lo: Vec3, hi: Vec3| {
            let eye = Vec3::new(lo.x - gap, lo.y + 1.7, (lo.z + hi.z) * 0.5);
            (eye, eye + to)
        };
        cases.push(city.still(format!("city, eye {name}"), of_buildings(&at_wall)));
    }
    Ok(cases)
}
