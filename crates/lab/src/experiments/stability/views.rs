//! Fields of view, planes and pictures at their limits.

use glam::camera::rh::proj::directx::{perspective, perspective_infinite_reverse};
use glam::{Mat4, Quat};

use super::case::{ASPECT, Case, Shot, placed, through};
use super::walks::Walk;
use crate::experiments::{Lab, LabError};
use casca_scenes::generated::SceneKind;

/// All cases.
pub(super) fn cases(lab: &Lab) -> Result<Vec<Case>, LabError> {
    let mut cases = Vec::new();
    for kind in [SceneKind::Spheres, SceneKind::City] {
        let walk = Walk::new(kind, lab.seed, lab.pick(6, 2))?;
        let scene = kind.name();
        let mut add = |name: &str, projection: Mat4, turn: Quat| {
            let case = walk.case(format!("{scene}, {name}"));
            let shots = case.shots.into_iter();
            let shots = shots
                .map(|s| Shot { camera: placed(&through(&s.camera, projection), s.camera.eye, turn), ..s });
            cases.push(Case { shots: shots.collect(), ..case });
        };
        let of = |degrees: f32, aspect: f32, near: f32, far: f32| {
            perspective(degrees.to_radians(), aspect, near, far)
        };
        add("60 degrees high", of(60.0, ASPECT, 0.1, 400.0), Quat::IDENTITY);
        for degrees in [179.0, 150.0, 5.0, 1.0, 0.1] {
            let unit = if degrees == 1.0 { "degree" } else { "degrees" };
            add(&format!("{degrees} {unit} high"), of(degrees, ASPECT, 0.1, 400.0), Quat::IDENTITY);
        }
        if kind == SceneKind::Spheres {
            add("10 times as wide as high", of(20.0, 10.0, 0.1, 400.0), Quat::IDENTITY);
            add("10 times as high as wide", of(120.0, 0.1, 0.1, 400.0), Quat::IDENTITY);
            add("planes at 1e-4 and 1e6 m", of(60.0, ASPECT, 1e-4, 1e6), Quat::IDENTITY);
            add("near plane at 5 m", of(60.0, ASPECT, 5.0, 400.0), Quat::IDENTITY);
            let reversed = perspective_infinite_reverse(60f32.to_radians(), ASPECT, 0.1);
            add("reversed depth without a far plane", reversed, Quat::IDENTITY);
            add(
                "turned about all axes",
                of(60.0, ASPECT, 0.1, 400.0),
                Quat::from_xyzw(0.4, 0.3, 0.5, 0.7).normalize(),
            );
        }
        let first = cases.len() - if kind == SceneKind::Spheres { 12 } else { 6 };
        if let Some(case) = cases.get_mut(first) {
            case.calm = true;
        }
    }
    Ok(cases)
}
