//! Worlds far from the origin.

use glam::{Quat, Vec3};

use super::case::{Case, Shot, placed, plain};
use super::walks::{Walk, shifted};
use crate::experiments::{Lab, LabError};
use casca_scenes::generated::SceneKind;

/// Metres along each axis.
const OFFSETS: [f32; 7] = [0.0, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7];

/// Each scene at each offset. What is tested is the geometry as rounded to single precision.
pub(super) fn cases(lab: &Lab) -> Result<Vec<Case>, LabError> {
    let mut cases = Vec::new();
    for kind in [SceneKind::Spheres, SceneKind::Rooms] {
        let walk = Walk::new(kind, lab.seed, lab.pick(6, 2))?;
        for (i, offset) in OFFSETS.into_iter().enumerate() {
            if kind == SceneKind::Rooms && ![0, 4, 6].contains(&i) {
                continue;
            }
            let by = Vec3::splat(offset);
            let case = walk.case(format!("{}, {} m from the origin", kind.name(), plain(offset)));
            let shots = case.shots.into_iter().map(|s| Shot {
                camera: placed(&s.camera, s.camera.eye + by, Quat::IDENTITY),
                moves: s.moves.iter().map(|(i, shape)| (*i, shifted(shape, by))).collect(),
                time: s.time,
            });
            let mut case = Case { shots: shots.collect(), ..case };
            for object in &mut case.objects {
                object.shape = shifted(&object.shape, by);
            }
            case.grid.min += by;
            cases.push(if i == 0 { case.calm() } else { case });
        }
    }
    Ok(cases)
}
