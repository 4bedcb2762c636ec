//! A camera that trembles before a world that stands still.

use glam::Quat;

use super::case::{Case, Dice, placed};
use super::run::Finding;
use super::walks::Walk;
use crate::lab::{Lab, LabError};
use crate::scenes::SceneKind;
use crate::world::Camera;

/// Metres and radians; the first is calm.
pub(super) const AMPLITUDES: [f32; 7] = [0.0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1];
/// The scenes.
pub(super) const SCENES: [SceneKind; 2] = [SceneKind::Spheres, SceneKind::Rooms];

/// Each scene under each amplitude.
pub(super) fn cases(lab: &Lab) -> Result<Vec<Case>, LabError> {
    let mut cases = Vec::new();
    for kind in SCENES {
        let walk = Walk::new(kind, lab.seed, 1)?;
        let Some(base) = walk.cameras.first().copied() else { continue };
        for (i, amplitude) in AMPLITUDES.into_iter().enumerate() {
            // The same directions at every amplitude.
            let mut dice = Dice::new(lab.seed, 1);
            let tremble = |_| -> Camera {
                let (step, turn) = (dice.ball() * amplitude, dice.ball() * amplitude);
                placed(&base, base.eye + step, Quat::from_scaled_axis(turn))
            };
            let cameras: Vec<Camera> = (0..lab.pick(20, 6)).map(tremble).collect();
            let name = format!("{}, jitter of {} m and rad", kind.name(), plain(amplitude));
            let case = walk.still(name, cameras);
            cases.push(if i == 0 { case.calm() } else { case });
        }
    }
    Ok(cases)
}

fn plain(v: f32) -> String {
    if v == 0.0 { "0".to_owned() } else { format!("{v:.0e}") }
}

/// How unsteady the sets of some frames are.
pub(super) struct Unrest {
    /// Objects that come or go from one frame to the next although their visibility does not
    /// change, in percent of those in the frustum.
    pub(super) flips: f64,
    /// Times an object was found, then not, then found again, in three frames on end.
    pub(super) flicker: usize,
}

fn differs(a: &[usize], b: &[usize], object: usize) -> bool {
    a.binary_search(&object).is_ok() != b.binary_search(&object).is_ok()
}

/// The unrest of a sequence of sets, beyond that of the exact ones.
pub(super) fn unrest(sets: &[Vec<usize>], exact: &[Vec<usize>], in_frustum: usize) -> Unrest {
    let (mut flips, mut flicker) = (0, 0);
    for (pair, truth) in sets.windows(2).zip(exact.windows(2)) {
        let [a, b] = pair else { continue };
        let [x, y] = truth else { continue };
        let gone = a.iter().filter(|&&o| b.binary_search(&o).is_err());
        let new = b.iter().filter(|&&o| a.binary_search(&o).is_err());
        flips += gone.chain(new).filter(|&&o| !differs(x, y, o)).count();
    }
    for triple in sets.windows(3) {
        let [a, b, c] = triple else { continue };
        flicker += a.iter().filter(|&&o| b.binary_search(&o).is_err() && c.binary_search(&o).is_ok()).count();
    }
    // A mean over the pairs of frames, relative to the mean number in the frustum.
    let pairs = sets.len().saturating_sub(1).max(1) as f64;
    let mean = (in_frustum as f64 / sets.len().max(1) as f64).max(1.0);
    Unrest { flips: 100.0 * flips as f64 / pairs / mean, flicker }
}

/// Of the exact sets themselves.
pub(super) fn exact_unrest(finding: &Finding) -> Unrest {
    let never = vec![Vec::new(); finding.exact.len()];
    unrest(&finding.exact, &never, finding.in_frustum)
}
