//! Buffers from far too coarse to finer than the screen.

use super::case::Case;
use super::walks::Walk;
use crate::experiments::{Lab, LabError};
use casca_scenes::generated::SceneKind;

/// The scenes.
pub(super) const SCENES: [SceneKind; 2] = [SceneKind::Spheres, SceneKind::City];

/// Pixels across; the usual one first, as the calm case.
pub(super) fn resolutions(lab: &Lab) -> Vec<usize> {
    lab.pick(vec![256, 8, 16, 32, 64, 128, 512, 1024, 2048], vec![256, 8, 64, 512])
}

/// Each scene at each resolution.
pub(super) fn cases(lab: &Lab) -> Result<Vec<Case>, LabError> {
    let mut cases = Vec::new();
    for kind in SCENES {
        let walk = Walk::new(kind, lab.seed, lab.pick(6, 2))?;
        for (i, n) in resolutions(lab).into_iter().enumerate() {
            let mut case = walk.case(format!("{}, {n} pixels", kind.name()));
            case.resolution = Some(n);
            cases.push(if i == 0 { case.calm() } else { case });
        }
    }
    Ok(cases)
}
