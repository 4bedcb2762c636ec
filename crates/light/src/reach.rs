//! Which bricks a picture can read: the culler's part.
//!
//! - *Seen* bricks have voxels, and a point of their box may be seen from the camera
//!   (`casca::Sight`, which never says no in doubt). All surfaces in the picture lie in them, but
//!   for those that leave the grid: bricks beside these count as seen, unasked.
//! - *Gathered* bricks are within the reach of a cone that starts in a seen one: these may be read
//!   by the cones of the picture. "Within" counts everything that moves a reading away from its
//!   cone: where cones start, and the filter of the widest texel.
//! - *Lit* bricks are within the reach of a cone that starts in a gathered one: those are read by
//!   the second bounce into gathered bricks.
//!
//! Light is brought up to date in these only. What is left out stays marked until a later picture
//! can read it. So the pixels are the same, bit by bit, as with all bricks up to date. Opacity is
//! always up to date everywhere: shadows come from anywhere.

use glam::{UVec3, Vec3};

use crate::data::Light;
use crate::numeric::{PUSH_OFF, TINY};
use crate::volume::{BRICK, LEVELS, Volume};

/// A mask of bricks by number.
pub type Mask = Vec<bool>;

/// The bricks that count for a picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reach {
    /// May be read by a cone of the picture.
    pub gathered: Mask,
    /// May be read by the second bounce into a gathered brick.
    pub lit: Mask,
}

/// How far from its start's brick a cone reads, in bricks: `reach` in cells, `slope` of the widest
/// cone.
pub fn bricks_read(reach: f32, slope: f32) -> u32 {
    let widest = (slope * reach).clamp(1.0, (1 << LEVELS) as f32);
    // Two levels are mixed; of the coarser one, a texel counts up to one and a half edges away.
    let filter = 1.5 * (widest.ceil() as u32).next_power_of_two().min(1 << LEVELS) as f32;
    // Pixels lie in their brick but for rounding: a cell more.
    let cells = reach + PUSH_OFF * 3.0_f32.sqrt() + filter + 1.0;
    (cells / BRICK as f32).ceil().min(1e6) as u32
}

/// Marks the bricks that cones may start in or first read from a triangle (in cells) that leaves
/// the grid: those of its box, moved into the grid. Cones start off the surface, and first read
/// half a step (in texels of a cell) further; a cell more covers rounding.
pub fn beside(volume: &Volume, [a, b, c]: [Vec3; 3], step: f32, mask: &mut [bool]) {
    let (low, high, dims) = (a.min(b).min(c), a.max(b).max(c), volume.dims.as_vec3());
    let away = PUSH_OFF * 3.0_f32.sqrt() + 0.5 * step + 1.0;
    let is_near = high.cmpge(Vec3::splat(-away)).all() && low.cmple(dims + away).all();
    if !is_near || (low.cmpge(Vec3::ZERO).all() && high.cmple(dims).all()) {
        return;
    }
    let [first, last] = [low, high].map(|p| (p / BRICK as f32).as_uvec3().min(volume.bricks() - 1));
    for z in first.z..=last.z {
        for y in first.y..=last.y {
            (first.x..=last.x).for_each(|x| mask[volume.number(UVec3::new(x, y, z)) as usize] = true);
        }
    }
}

impl Reach {
    /// Every brick.
    pub fn all(volume: &Volume) -> Self {
        let all = vec![true; volume.brick_count()];
        Self { gathered: all.clone(), lit: all }
    }

    /// The bricks around seen ones, where cones read up to so many bricks away.
    pub fn around(volume: &Volume, seen: Mask, away: u32, bounces: bool) -> Self {
        let gathered = grown(seen, volume.bricks(), away);
        let lit = if bounces { grown(gathered.clone(), volume.bricks(), away) } else { gathered.clone() };
        Self { gathered, lit }
    }
}

/// Whether a shadow ray from a voxel of a brick to a light may pass one of the bricks `changed`:
/// else the direct light in the brick stays as it is. The rays fill a body that narrows from the
/// brick to the light; it is tested axis by axis, so that the answer is never no in doubt. O(lights
/// x changed).
pub fn shadows_change(volume: &Volume, lights: &[Light], changed: &[u32], brick: u32) -> bool {
    let centre = |number| (volume.brick(number).as_vec3() + 0.5) * BRICK as f32;
    let from: Vec3 = centre(brick);
    // How far rays start from the centre of their brick, along an axis.
    let start = 0.5 * BRICK as f32 + PUSH_OFF * 3.0_f32.sqrt();
    // Half a brick, and a cell for all rounding.
    let half = 0.5 * BRICK as f32 + 1.0;
    lights.iter().filter_map(|light| light.place(from)).any(|light| {
        let way = light - from;
        changed.iter().any(|&other| {
            let off = from - centre(other);
            // The shares of the way at which all axes overlap: |off + share way| <= half + (1 -
            // share) start.
            let (mut low, mut high) = (0.0_f32, 1.0_f32);
            for axis in 0..3 {
                for sign in [1.0, -1.0] {
                    let (rate, room) = (sign * way[axis] + start, half + start - sign * off[axis]);
                    if rate > TINY {
                        high = high.min(room / rate);
                    } else if rate < -TINY {
                        low = low.max(room / rate);
                    } else if room < -1.0 {
                        return false;
                    }
                }
            }
            low <= high
        })
    })
}

/// All bricks that are at most `away` from one of the mask along each axis. O(bricks).
pub fn grown(mut mask: Mask, bricks: UVec3, away: u32) -> Mask {
    let strides = [1, bricks.x, bricks.x * bricks.y];
    for axis in 0..3 {
        let (length, stride) = (bricks[axis] as usize, strides[axis] as usize);
        for first in (0..mask.len()).filter(|i| i / stride % length == 0) {
            let line: Vec<bool> = (0..length).map(|i| mask[first + i * stride]).collect();
            // How far the nearest one is, from both sides.
            let (mut before, mut after) = (usize::MAX, usize::MAX);
            for i in 0..length {
                before = if line[i] { 0 } else { before.saturating_add(1) };
                mask[first + i * stride] |= before <= away as usize;
                let j = length - 1 - i;
                after = if line[j] { 0 } else { after.saturating_add(1) };
                mask[first + j * stride] |= after <= away as usize;
            }
        }
    }
    mask
}
