//! The light that passes through a cone: by samples of the opacity pyramid, slab by slab of its
//! cells, or by exact rays.

use glam::{DVec3, Vec3};

use crate::error::{Error, finite3};
use crate::numeric::soft::{ALONG, CUT, DARK, FULLY, SLAB_LEVEL};
use crate::soft::grid::SoftGrid;
use crate::soft::rays::{check_rays, in_cone};
use crate::soft::walk::{Segment, inside};

/// A cone in world units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    /// Its apex.
    pub apex: Vec3,
    /// The direction of its axis, of any length.
    pub direction: Vec3,
    /// The tangent of the angle between its axis and its side: 0.001 to 10.
    pub tan: f32,
    /// How far it is followed along its axis, in world units; not negative. May be infinite.
    pub reach: f32,
}

/// How a cone is followed through the cells.
///
/// Only rays converge: the more of them, the nearer they come to the share of light that the cells
/// let pass. Errors beside a path tracer on 128 cells, over the mean of its picture, and times over
/// those of slabs (`docs/light/report/light-shadows.csv` of the repository):
///
/// | march | soft shadow of a thin block | ambient occlusion in the Cornell box |
/// |---|---|---|
/// | 64 rays, the default | 0.11, time 3.9 | 0.12, time 1.6 |
/// | slabs | 0.29, time 1 | 0.15, time 1 |
/// | samples, [`March::OLD`] | 0.35, time 0.7 | 0.26, time 0.4 |
/// | samples, corrected | 0.35, time 1.0 | 0.44, time 0.5 |
///
/// 16 rays take a quarter of the time of 64. On 64 cells they err by 0.18 and 0.16, where 64 rays
/// err by 0.15 and 0.14. Beside 4096 rays in the same 128 cells, ambient occlusion errs by 0.048
/// with slabs, 0.057 with 16 rays, 0.019 with 64 and 0.007 with 256, on the mean (the example
/// `soft_costs`).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum March {
    /// An approximation that does not converge. Marches once per axis, slab by slab, at the pyramid
    /// level whose cells are about as wide as the cone's radius. The opacity of a slab is
    /// interpolated across the axis but not along it, so that no wall along the axes leaks, however
    /// thin, and none is too near to be seen. Walls askew to the axes leak, as by samples, where a
    /// slab holds a part of them only: `docs/soft-walls.csv` of the repository has figures. Slabs
    /// that are covered in part, one after the other, count once: foliage hides only as much as its
    /// densest slab. The cell in which the reach ends hides in proportion to the part of it before
    /// that end.
    Slabs,
    /// Samples on the axis of the cone, interpolated between cells and levels: the rule of
    /// Villegas 2016. Thin walls leak, by 13% at steps of 0.5, and walls nearer than `start +
    /// first` are missed.
    Samples {
        /// Step in units of the cone's diameter, 0.01 to 4. The old rule takes 0.5.
        step: f32,
        /// Distance from the apex in cells at which the cone begins, with no width: 0 to 16. It is
        /// a part of the reach. The old rule takes 2.
        start: f32,
        /// Distance of the first sample from there, in cells: 0.25 to 16. The old rule takes 2.
        first: f32,
        /// Whether the opacity of a sample is that of a step's length, and not of a cell's.
        corrected: bool,
    },
    /// Exact rays, evenly in the cone: 1 to 4096; a single one is its axis. Errs by their number,
    /// and by the cells that shapes touch but do not fill.
    Rays(u32),
}

impl Default for March {
    /// 64 rays.
    fn default() -> Self {
        Self::Rays(64)
    }
}

impl March {
    /// The rule of Villegas 2016 and of its program, for comparison.
    pub const OLD: Self = Self::Samples { step: 0.5, start: 2.0, first: 2.0, corrected: false };

    pub(super) fn check(&self) -> Result<(), Error> {
        match *self {
            Self::Slabs => Ok(()),
            Self::Rays(rays) => check_rays(rays),
            Self::Samples { step, start, first, .. } => {
                between("the step of a cone", step, 0.01, 4.0)?;
                between("the start of a cone", start, 0.0, 16.0)?;
                between("the first sample of a cone", first, 0.25, 16.0)
            }
        }
    }
}

/// What a cone found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConeAnswer {
    /// The share of light that passes, 0 to 1. An estimate.
    pub transmittance: f32,
    /// Samples, slabs or rays that it took.
    pub steps: u32,
}

/// Refuses numbers outside of a range.
pub(super) fn between(what: &'static str, value: f32, min: f32, max: f32) -> Result<(), Error> {
    if (min..=max).contains(&value) {
        return Ok(());
    }
    Err(Error::Setting { what, value: value.into(), min: min.into(), max: max.into() })
}

/// A slab of cells: the level, the place along the axis, and the channel, which says the axis and
/// the way along it.
type Slab = (usize, i32, usize);

/// A cone in units of cells, from the corner of the grid.
#[derive(Debug, Clone, Copy)]
pub(super) struct CellCone {
    pub(super) apex: DVec3,
    /// Of length 1.
    pub(super) direction: DVec3,
    pub(super) tan: f64,
    pub(super) reach: f64,
}

impl CellCone {
    /// The level whose cells are as wide as the cone's radius, at a distance.
    fn level(&self, t: f64) -> f64 {
        (self.tan * t).log2().max(0.0)
    }
}

impl SoftGrid {
    /// How much light passes through a cone. An estimate.
    ///
    /// Costs a number of steps that grows with the logarithm of the reach, for wide cones; rays
    /// cost a [`SoftGrid::first_hit`] each. A point on a surface lies in an occupied cell: offset
    /// the apex by two cells along the normal.
    ///
    /// # Errors
    /// Refuses numbers that are not finite (but for the reach) or out of their range, and a
    /// direction of length 0.
    pub fn cone(&self, cone: &Cone, march: &March) -> Result<ConeAnswer, Error> {
        finite3("the apex of the cone", cone.apex)?;
        finite3("the direction of the cone", cone.direction)?;
        between("the tangent of the cone", cone.tan, 0.001, 10.0)?;
        between("the reach of the cone", cone.reach, 0.0, f32::INFINITY)?;
        march.check()?;
        let what = "the direction of the cone";
        let direction = cone.direction.as_dvec3().try_normalize().ok_or(Error::NoDirection { what })?;
        let cone = CellCone {
            apex: self.to_cells(cone.apex.as_dvec3()),
            direction,
            tan: cone.tan.into(),
            reach: f64::from(cone.reach) / self.grid().cell_size(),
        };
        let (transmittance, steps) = self.march(&cone, march);
        Ok(ConeAnswer { transmittance: transmittance as f32, steps })
    }

    /// A point in units of cells, from the corner of the grid.
    pub(super) fn to_cells(&self, point: DVec3) -> DVec3 {
        (point - self.grid().min()) / self.grid().cell_size()
    }

    /// [`SoftGrid::cone`] for a cone that was checked. Gives the transmittance and the number of
    /// steps.
    pub(super) fn march(&self, cone: &CellCone, march: &March) -> (f64, u32) {
        // Nothing is beyond the grid.
        let dims = self.grid().dims().as_dvec3();
        let farthest = cone.apex.distance(dims * 0.5) + dims.length();
        let within = |cone: CellCone| CellCone { reach: cone.reach.min(farthest), ..cone };
        match *march {
            March::Slabs => {
                let all = [0, 1, 2].map(|axis| self.march_slabs(&within(*cone), axis));
                all.into_iter().fold((1.0, 0), |(passes, n), (one, more)| (passes * one, n + more))
            }
            March::Samples { step, start, first, corrected } => {
                let start = f64::from(start);
                let apex = cone.apex + cone.direction * start;
                let rest = CellCone { apex, reach: (cone.reach - start).max(0.0), ..*cone };
                self.march_samples(&within(rest), step.into(), first.into(), corrected)
            }
            March::Rays(rays) => {
                let (min, cell) = (self.grid().min(), self.grid().cell_size());
                let (from, length) = (min + cone.apex * cell, within(*cone).reach * cell);
                let passes = |d: &DVec3| {
                    let to = from + *d * length;
                    self.walk(&Segment { from, to, skips_first: false, until: None }).is_none()
                };
                let cosine = 1.0 / cone.tan.hypot(1.0);
                let open = in_cone(cone.direction, cosine, rays).filter(passes).count();
                (open as f64 / f64::from(rays), rays)
            }
        }
    }

    /// Samples on the axis (Villegas 2016, section 1.7.4.4): each lies a share of the cone's
    /// diameter behind the last.
    fn march_samples(&self, cone: &CellCone, step: f64, first: f64, corrected: bool) -> (f64, u32) {
        let d = cone.direction;
        let faces = [0, 1, 2].map(|axis| face_along(axis, d[axis]));
        let top = self.pyramid().top();
        let Some((entry, exit)) = self.in_grid(cone) else { return (1.0, 0) };
        let (mut passes, mut t, mut steps) = (1.0, first.max(entry), 0);
        while passes > DARK && t <= exit {
            let p = cone.apex + d * t;
            let fine = cone.level(t);
            let level = fine.min(top as f64);
            let low = level as usize;
            let mut opacity = self.pyramid().smooth(low, p, faces);
            if level > low as f64 {
                opacity = opacity.lerp(self.pyramid().smooth(low + 1, p, faces), level - low as f64);
            }
            let mut alpha = opacity.dot(d * d).min(1.0);
            let length = 2.0 * cone.tan * t * step;
            if corrected {
                alpha = 1.0 - (1.0 - alpha).powf(length / fine.exp2());
            }
            passes *= 1.0 - alpha;
            t += length;
            steps += 1;
        }
        (passes, steps)
    }

    /// Where the axis of a cone enters the grid and where it leaves it or ends, if it meets it.
    fn in_grid(&self, cone: &CellCone) -> Option<(f64, f64)> {
        let dims = self.grid().dims().as_dvec3();
        let (entry, exit) = inside(cone.apex, cone.direction * cone.reach, DVec3::ZERO, dims)?;
        Some((entry * cone.reach, exit * cone.reach))
    }

    /// The light that passes all slabs of cells along an axis, where cells are as opaque as they
    /// are along that axis.
    ///
    /// A slab hides only what it covers beyond the slab before: solids go on from one to the next.
    /// A ray at an angle to the axes passes more slabs in all than one along an axis, so that each
    /// counts as the power of the direction's share along its axis: cells that are as opaque from
    /// all sides are so along every direction.
    fn march_slabs(&self, cone: &CellCone, axis: usize) -> (f64, u32) {
        let d = cone.direction[axis];
        let Some((mut t, end)) = self.in_grid(cone).filter(|_| d.abs() > ALONG) else { return (1.0, 0) };
        let (up, face) = (d > 0.0, face_along(axis, d));
        let at = cone.apex[axis] + d * t;
        let first = if up { at.floor() } else { at.ceil() - 1.0 } as i32;
        let (mut slab, mut level) = (first.clamp(0, self.grid().dims()[axis] - 1), 0);
        let (mut passes, mut before, mut steps) = (1.0, 0.0, 0);
        while passes > DARK && t < end && (0..self.pyramid().dims(level)[axis]).contains(&slab) {
            let wanted = (cone.level(t) + SLAB_LEVEL).min(self.pyramid().top() as f64) as usize;
            while level < wanted && (slab & 1 == 0) == up {
                (level, slab) = (level + 1, slab >> 1);
            }
            let leaves = self.leaves(cone, (level, slab, face));
            let (opacity, pieces) = self.slab_opacity(cone, (level, slab, face), (t, leaves.min(end)));
            let (share, more) = self.share_before(cone, (level, slab, face), (t, end));
            let covered = if opacity * share > FULLY { 1.0 } else { opacity * share };
            if covered > before {
                passes *= ((1.0 - covered) / (1.0 - before)).max(0.0).powf(d.abs());
            }
            before = covered;
            (t, slab, steps) = (leaves.max(t), if up { slab + 1 } else { slab - 1 }, steps + pieces + more);
        }
        (passes, steps)
    }

    /// The distance at which the axis of a cone leaves a slab, or the grid in it.
    fn leaves(&self, cone: &CellCone, (level, slab, face): Slab) -> f64 {
        let axis = face / 2;
        let plane = if face & 1 == 0 { (slab + 1) << level } else { slab << level };
        (f64::from(plane.min(self.grid().dims()[axis])) - cone.apex[axis]) / cone.direction[axis]
    }

    /// The share of the opacity of a slab, entered at `t`, that lies before the end of the march: 1
    /// unless the end cuts the slab off.
    ///
    /// A thin wall is wholly before the end or wholly behind it, so that the slabs of the levels
    /// below decide. A single cell counts by its length.
    fn share_before(&self, cone: &CellCone, slab: Slab, (t, end): (f64, f64)) -> (f64, u32) {
        let (level, at, face) = slab;
        let along = cone.direction[face / 2].abs();
        let cut_off = |leaves: f64| (leaves - end) * along > CUT;
        let leaves = self.leaves(cone, slab);
        if !cut_off(leaves) {
            return (1.0, 0);
        }
        let by_length = (end - t) / (leaves - t);
        let Some(below) = level.checked_sub(1) else { return (by_length, 0) };
        let [near, far] = [face & 1, 1 - (face & 1)].map(|upper| (below, 2 * at + upper as i32, face));
        let middle = self.leaves(cone, near);
        let (first, a) = self.slab_opacity(cone, near, (t, middle));
        let (second, b) = self.slab_opacity(cone, far, (middle, leaves));
        let second = (1.0 - first) * second;
        let (before, c) = if cut_off(middle) {
            let (share, pieces) = self.share_before(cone, near, (t, end));
            (first * share, pieces)
        } else {
            let (share, pieces) = self.share_before(cone, far, (middle, end));
            (first + second * share, pieces)
        };
        let all = first + second;
        (if all > 0.0 { before / all } else { by_length }, a + b + c)
    }

    /// The mean opacity of a slab from `t` to `end` on the axis of a cone.
    fn slab_opacity(
        &self,
        cone: &CellCone,
        (level, slab, face): Slab,
        (mut t, end): (f64, f64),
    ) -> (f64, u32) {
        let size = (1u64 << level) as f64;
        let (whole, mut sum, mut pieces) = ((end - t).max(f64::MIN_POSITIVE), 0.0, 0);
        loop {
            // A ray along the slab meets many cells of it.
            let next = (t + size.max(cone.tan * t) * std::f64::consts::SQRT_2).min(end);
            let p = cone.apex + cone.direction * ((t + next) * 0.5);
            sum += self.pyramid().smooth_across(level, slab, p, face) * (next - t);
            pieces += 1;
            if next >= end {
                return ((sum / whole).clamp(0.0, 1.0), pieces);
            }
            t = next;
        }
    }
}

/// The channel for rays that travel up or down an axis.
fn face_along(axis: usize, d: f64) -> usize {
    2 * axis + usize::from(d < 0.0)
}
