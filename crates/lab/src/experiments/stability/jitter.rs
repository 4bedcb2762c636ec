//! A camera that trembles before a world that stands still.

use glam::Quat;

use super::case::{Case, Dice, placed, plain};
use super::run::Finding;
use super::walks::Walk;
use crate::experiments::{Lab, LabError};
use casca_scenes::generated::SceneKind;
use casca_scenes::world::Camera;

/// Metres and radians; the first is calm.
pub(super) const AMPLITUDES: [f32; 7] = [0.0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1];
/// Places of each scene from which it is seen.
const PLACES: usize = 4;
/// The scenes.
pub(super) const SCENES: [SceneKind; 2] = [SceneKind::Spheres, SceneKind::Rooms];

/// Frames at each place.
pub(super) fn frames(lab: &Lab) -> usize {
    lab.pick(16, 3)
}

/// Each scene under each amplitude.
pub(super) fn cases(lab: &Lab) -> Result<Vec<Case>, LabError> {
    let mut cases = Vec::new();
    for kind in SCENES {
        let walk = Walk::new(kind, lab.seed, PLACES)?;
        for (i, amplitude) in AMPLITUDES.into_iter().enumerate() {
            // The same directions at every amplitude.
            let mut dice = Dice::new(lab.seed, 1);
            let bases = walk.cameras.iter().flat_map(|base| std::iter::repeat_n(base, frames(lab)));
            let cameras: Vec<Camera> = bases
                .map(|base| {
                    let (step, turn) = (dice.ball() * amplitude, dice.ball() * amplitude);
                    placed(base, base.eye + step, Quat::from_scaled_axis(turn))
                })
                .collect();
            let name = format!("{}, jitter of {} m and rad", kind.name(), plain(amplitude));
            let case = walk.still(name, cameras);
            cases.push(if i == 0 { case.calm() } else { case });
        }
    }
    Ok(cases)
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

/// The unrest of sets, `length` frames at each place, beyond that of the exact ones.
pub(super) fn unrest(sets: &[Vec<usize>], exact: &[Vec<usize>], length: usize, in_frustum: usize) -> Unrest {
    let (mut flips, mut flicker, mut pairs) = (0, 0, 0);
    let length = length.max(1);
    for (sets, exact) in sets.chunks(length).zip(exact.chunks(length)) {
        for (pair, truth) in sets.windows(2).zip(exact.windows(2)) {
            let ([a, b], [x, y]) = (pair, truth) else { continue };
            let gone = a.iter().filter(|&&o| b.binary_search(&o).is_err());
            let new = b.iter().filter(|&&o| a.binary_search(&o).is_err());
            flips += gone.chain(new).filter(|&&o| !differs(x, y, o)).count();
            pairs += 1;
        }
        for triple in sets.windows(3) {
            let [a, b, c] = triple else { continue };
            let back = |&&o: &&usize| b.binary_search(&o).is_err() && c.binary_search(&o).is_ok();
            flicker += a.iter().filter(back).count();
        }
    }
    let mean = (in_frustum as f64 / sets.len().max(1) as f64).max(1.0);
    Unrest { flips: 100.0 * flips as f64 / f64::from(pairs.max(1)) / mean, flicker }
}

/// The flicker of the exact sets themselves.
pub(super) fn exact_flicker(finding: &Finding, length: usize) -> usize {
    unrest(&finding.exact, &finding.exact, length, finding.in_frustum).flicker
}
