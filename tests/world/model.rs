//! A model of a world: boxes at places in double precision, and what an eye sees of them. It shares
//! no code with the library.

use crate::common::worlds::cuts;
use crate::common::*;

/// A box around a place.
#[derive(Debug, Clone, Copy)]
pub struct Solid {
    pub place: DVec3,
    /// Relative to the place.
    pub min: DVec3,
    pub max: DVec3,
    pub hides: bool,
    /// A mesh hides by its surface: also from an eye inside.
    pub mesh: bool,
}

/// Occluders count as larger by this, so that rounding decides nothing here: places of up to 1e9
/// are known to 1e-7.
const DOUBT: f64 = 1e-6;

/// An eye is surely in a box if it is this deep in it: coordinates of up to 192 m are known to
/// 1.5e-5 in single precision, and occluders are rounded inwards.
const DEEP: f64 = 1e-4;

impl Solid {
    /// The box relative to the eye.
    pub fn seen_from(&self, eye: DVec3) -> (DVec3, DVec3) {
        let at = self.place - eye;
        (at + self.min, at + self.max)
    }
}

/// Of these boxes, those of which the eye surely sees one of 27 points, or one of some random ones.
/// A box that surely contains the eye hides nothing, if it is no mesh; one whose face the eye may
/// lie on hides everything.
pub fn seen(solids: &[Solid], eye: DVec3, random: &mut Random) -> Vec<bool> {
    let boxes: Vec<_> = solids.iter().map(|solid| solid.seen_from(eye)).collect();
    let holds_eye = |(min, max): &(DVec3, DVec3)| {
        min.cmplt(DVec3::splat(-DEEP)).all() && max.cmpgt(DVec3::splat(DEEP)).all()
    };
    let hides = |i: &usize| solids[*i].hides && (solids[*i].mesh || !holds_eye(&boxes[*i]));
    let wide = |(min, max): (DVec3, DVec3)| (min - DOUBT, max + DOUBT);
    let hiding: Vec<usize> = (0..solids.len()).filter(hides).collect();
    (0..solids.len())
        .map(|i| {
            let (min, max) = boxes[i];
            let free = |p: DVec3| !hiding.iter().any(|&o| o != i && cuts(wide(boxes[o]), DVec3::ZERO, p));
            let grid = (0..27).map(|n| DVec3::new((n % 3) as f64, (n / 3 % 3) as f64, (n / 9) as f64) * 0.5);
            let more: Vec<DVec3> = (0..8).map(|_| random.point(0.0, 1.0)).collect();
            // What hides a point of its far side hides its near one: its own box need not be asked.
            grid.chain(more).any(|share| free(min + (max - min) * share))
        })
        .collect()
}
