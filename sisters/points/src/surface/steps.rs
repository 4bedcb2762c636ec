//! Noise in steps. Scanners and depth cameras round ranges, so that neighbours lie exactly on planes, one step
//! apart, and discs of one would hide points of the next. Steps lie beside each other, and the two sides of a
//! plate one above the other.

use super::plane::Input;
use crate::spacing::quantile;
use glam::Vec3A;
use rayon::prelude::*;

// Chosen on the scenes that the example `accuracy` calls tuned and on two real clouds. Of two values the
// first is for estimated normals, the second for given ones, which tell the two sides of a plate.
/// The least cosine between the normals of steps.
const TURN: f32 = 0.9;
/// How far from a plane the points of steps are at most, in spacings.
const FAR: [f32; 2] = [3.0, 1.0];
/// How far apart, in spacings, the middles of two steps are at least: at the border of two half planes 2.5,
/// between the sides of plates mostly less than 0.7.
const APART: [f32; 2] = [1.2, 0.0];
/// Fewer points are no step.
const FEWEST: f32 = 4.0;
/// Steps show where points are as far apart as they are high, and not where these are denser. There they count
/// as this many times the height that this part of all places does not exceed: scenes without steps have some
/// at 1 to 5 of 100 places.
const DENSE: f32 = 2.0;
const USUAL: f32 = 0.95;

/// How high the steps around each place are. `within` is how far from its plane its own points are.
pub(super) fn heights(input: &Input, normals: &[Vec3A], within: impl Fn(usize) -> f32 + Sync) -> Vec<f32> {
    let all = (0..normals.len()).into_par_iter();
    let mut heights: Vec<f32> = all.map(|i| height(input, normals, i, within(i))).collect();
    let usual = DENSE * quantile(heights.clone(), USUAL);
    let dense = heights.iter_mut().zip(&input.spacing).filter(|(_, spacing)| **spacing < usual);
    dense.for_each(|(height, _)| *height = height.max(usual));
    heights
}

/// How far the points of the next step above or below a place are from its plane; 0 if there is none.
fn height(input: &Input, normals: &[Vec3A], i: usize, within: f32) -> f32 {
    let (normal, given) = (normals[i], input.given(i));
    let [far, apart] = [FAR, APART].map(|length| length[usize::from(given)] * input.spacing[i]);
    // The numbers of points on the plane, with the place itself, above and below, and the sums of
    // their places and heights.
    let (mut counts, mut sums, mut heights) = ([1.0, 0.0, 0.0], [Vec3A::ZERO; 3], [0.0; 3]);
    for (j, v) in input.near(i) {
        let other = normals[j as usize];
        let cosine = other.dot(normal);
        // The middle of both normals leaves bends out, which are no steps.
        let height = v.dot(normal + other * cosine.signum()) / 2.0;
        let alike = cosine > TURN || -cosine > TURN && !(given && input.given(j as usize));
        if alike && height.abs() < far {
            let side = if height.abs() <= within { 0 } else { 1 + usize::from(height < 0.0) };
            counts[side] += 1.0;
            sums[side] += v;
            heights[side] += height.abs();
        }
    }
    let own = sums[0] / counts[0];
    let of = |side: usize| {
        let away = (sums[side] / counts[side] - own).reject_from_normalized(normal);
        let is_step = counts[side] >= FEWEST && away.length() > apart;
        if is_step { heights[side] / counts[side] } else { 0.0 }
    };
    of(1).max(of(2))
}
