//! Segments of lines in the cells of a regular grid of the world, for rays (Fujimoto, Tanaka and
//! Iwata 1986, "ARTS: Accelerated ray-tracing system").
//!
//! The grid belongs to the lines, not to a view: it is made anew when lines move, and serves all
//! cameras. A cell names each segment that comes nearer to it than a margin, so that a ray finds
//! the segments beside it in the cells that it crosses itself.

#[cfg(test)]
mod tests;

use std::sync::atomic::{AtomicU32, Ordering};

use glam::{DVec3, UVec3, Vec3};
use rayon::prelude::*;

use crate::directions::coded;
use crate::numeric::{CELL_IN_MARGINS, CELL_ROUNDING, LENGTH_IN_CELLS, MOST_IN_ROW, SEGMENTS_IN_CELL};
use crate::sets::LineSet;

/// Instead of a direction: no segment of the line is there. It is the code of none.
pub const NONE: u32 = 0x8000_8000;

/// Segments in the cells of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Cells {
    ends: Vec<[Vec3; 2]>,
    neighbours: Vec<[u32; 2]>,
    lines: Vec<u32>,
    margin: f32,
    origin: Vec3,
    side: f32,
    dims: UVec3,
    /// Where the list of each cell starts in `lists`; one more for the end of the last.
    starts: Vec<u32>,
    lists: Vec<u32>,
}

impl Cells {
    /// The segments of lines; cells name what comes nearer than `margin`, in units of the scene.
    /// Dots and other segments without length are left out. A margin that is negative or not a
    /// number counts as 0.
    ///
    /// Time: n log n for n segments. Memory: 36 bytes a segment, 4 bytes for each cell that names
    /// it, about 10, and 4 bytes a cell, of which there are 2 a segment; while it is made, 40 bytes
    /// a segment and 4 bytes a cell more.
    pub fn new(lines: &LineSet, margin: f32) -> Self {
        let margin = if margin > 0.0 && margin.is_finite() { margin } else { 0.0 };
        let (ends, neighbours, numbers) = segments(lines);
        let (origin, side, dims) = shape(&ends, lines.bounds(), f64::from(margin));
        let (starts, lists) = (Vec::new(), Vec::new());
        let mut grid = Self { ends, neighbours, lines: numbers, margin, origin, side, dims, starts, lists };
        grid.order();
        grid.fill();
        grid
    }

    /// Puts segments that lie near each other next to each other: rays read them so.
    fn order(&mut self) {
        let cell = |[a, b]: &[Vec3; 2]| {
            let middle = (self.place(*a) + self.place(*b)) / 2.0;
            self.number(middle.clamp(DVec3::ZERO, self.dims.as_dvec3() - 1.0).as_uvec3())
        };
        let mut keyed: Vec<[u32; 2]> =
            self.ends.par_iter().map(cell).zip(0..self.ends.len() as u32).map(<[u32; 2]>::from).collect();
        keyed.par_sort_unstable();
        self.ends = keyed.iter().map(|[_, old]| self.ends[*old as usize]).collect();
        self.neighbours = keyed.iter().map(|[_, old]| self.neighbours[*old as usize]).collect();
        self.lines = keyed.iter().map(|[_, old]| self.lines[*old as usize]).collect();
    }

    /// Counting sort: how many segments each cell names, then which.
    fn fill(&mut self) {
        let count = self.dims.as_u64vec3().element_product() as usize;
        let names: Vec<AtomicU32> = (0..=count).map(|_| AtomicU32::new(0)).collect();
        self.ends.par_iter().for_each(|e| {
            self.for_cells(*e, |cell| {
                names[cell as usize + 1].fetch_add(1, Ordering::Relaxed);
            });
        });
        let mut starts: Vec<u32> = names.into_iter().map(AtomicU32::into_inner).collect();
        for i in 0..count {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut lists = vec![0; starts[count] as usize];
        for (segment, ends) in self.ends.iter().enumerate() {
            self.for_cells(*ends, |cell| {
                lists[next[cell as usize] as usize] = segment as u32;
                next[cell as usize] += 1;
            });
        }
        (self.starts, self.lists) = (starts, lists);
    }

    /// A point in cells from the least corner.
    fn place(&self, p: Vec3) -> DVec3 {
        (p.as_dvec3() - self.origin.as_dvec3()) / f64::from(self.side)
    }

    /// The number of a cell in [`Self::starts`].
    fn number(&self, at: UVec3) -> u32 {
        (at.z * self.dims.y + at.y) * self.dims.x + at.x
    }

    /// Visits the cells that a segment comes near, each once: layer by layer along its longest
    /// direction, the cells around its part there.
    fn for_cells(&self, ends: [Vec3; 2], mut visit: impl FnMut(u32)) {
        let [a, b] = ends.map(|p| self.place(p));
        let way = (b - a).abs();
        let axis = if way.x >= way.y && way.x >= way.z { 0 } else { 1 + usize::from(way.z > way.y) };
        let (a, b) = if a[axis] <= b[axis] { (a, b) } else { (b, a) };
        // A little more, so that rounding of rays in single precision loses nothing.
        let margin = f64::from(self.margin) / f64::from(self.side) + f64::from(CELL_ROUNDING);
        let last = self.dims.as_dvec3() - 1.0;
        let cell = |value: f64, axis: usize| value.clamp(0.0, last[axis]) as u32;
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        let at = |t: f64| {
            if b[axis] > a[axis] { ((t - a[axis]) / (b[axis] - a[axis])).clamp(0.0, 1.0) } else { 0.5 }
        };
        for layer in cell(a[axis] - margin, axis)..=cell(b[axis] + margin, axis) {
            let (low, high) = (f64::from(layer) - margin, f64::from(layer) + 1.0 + margin);
            let [from, to] = if b[axis] > a[axis] { [at(low), at(high)] } else { [0.0, 1.0] };
            let [p, q] = [from, to].map(|t| a + (b - a) * t);
            let (least, most) = (p.min(q) - margin, p.max(q) + margin);
            for i in cell(least[u], u)..=cell(most[u], u) {
                for j in cell(least[v], v)..=cell(most[v], v) {
                    let mut at = UVec3::ZERO;
                    (at[axis], at[u], at[v]) = (layer, i, j);
                    // From the part's box to the cell: those at its edges and corners are farther.
                    let low = at.as_dvec3();
                    let gap = (p.min(q) - low - 1.0).max(low - p.max(q)).max(DVec3::ZERO);
                    if gap.length_squared() <= margin * margin {
                        visit(self.number(at));
                    }
                }
            }
        }
    }

    /// The greatest distance at which a cell names a segment, in units of the scene.
    pub fn margin(&self) -> f32 {
        self.margin
    }

    /// The least corner of the grid.
    pub fn origin(&self) -> Vec3 {
        self.origin
    }

    /// The side of a cell, in units of the scene, greater than 0.
    pub fn side(&self) -> f32 {
        self.side
    }

    /// The cells in each direction.
    pub fn dims(&self) -> UVec3 {
        self.dims
    }

    /// Where the list of each cell starts in [`Self::lists`], x first, then y, then z; and the end
    /// of the last.
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// The numbers of the segments that cells name.
    pub fn lists(&self) -> &[u32] {
        &self.lists
    }

    /// The ends of the segments, in an order in which neighbours lie near each other.
    pub fn ends(&self) -> &[[Vec3; 2]] {
        &self.ends
    }

    /// The directions in which the line of each segment leads on from its two ends, as codes of
    /// [`crate::directions`]; [`NONE`] where the line ends.
    pub fn neighbours(&self) -> &[[u32; 2]] {
        &self.neighbours
    }

    /// The number of the line of each segment.
    pub fn lines(&self) -> &[u32] {
        &self.lines
    }

    /// The segments that a cell names.
    pub(crate) fn named(&self, cell: UVec3) -> &[u32] {
        let at = self.number(cell) as usize;
        &self.lists[self.starts[at] as usize..self.starts[at + 1] as usize]
    }
}

/// All segments of lines that have a length, the directions of their neighbours, and their lines.
fn segments(lines: &LineSet) -> (Vec<[Vec3; 2]>, Vec<[u32; 2]>, Vec<u32>) {
    let (mut ends, mut neighbours): (Vec<[Vec3; 2]>, Vec<[u32; 2]>) = (Vec::new(), Vec::new());
    let mut numbers = Vec::new();
    // An eighth: sums of the huge coordinates do not overflow.
    let way = |[a, b]: [Vec3; 2]| coded(b * 0.125 - a * 0.125);
    for (number, line) in lines.iter().enumerate() {
        let first = ends.len();
        for pair in line.windows(2).filter(|pair| pair[0] != pair[1]) {
            let now = [pair[0], pair[1]];
            let mut before = NONE;
            if let (Some(&[c, d]), Some([_, after])) = (ends[first..].last(), neighbours.last_mut()) {
                (before, *after) = (way([d, c]), way(now));
            }
            ends.push(now);
            neighbours.push([before, NONE]);
            numbers.push(number as u32);
        }
    }
    (ends, neighbours, numbers)
}

/// The least corner, the side of a cell and the cells in each direction.
fn shape(segments: &[[Vec3; 2]], [min, max]: [Vec3; 2], margin: f64) -> (Vec3, f32, UVec3) {
    // Rays beside the outermost lines cross cells, too.
    let low = min.as_dvec3() - margin;
    let size = max.as_dvec3() + margin - low;
    let extent = size.max_element();
    if extent < f64::from(f32::MIN_POSITIVE) {
        return (min, 1.0, UVec3::ONE);
    }
    let count = segments.len().max(1) as f64;
    let long = |[a, b]: &[Vec3; 2]| (b.as_dvec3() - a.as_dvec3()).abs().element_sum();
    let lengths: f64 = segments.iter().map(long).sum();
    // A flat set has some thickness, so that cells are not too small.
    let shares = (size / extent).max(DVec3::splat(1.0 / MOST_IN_ROW));
    let even = extent * (shares.element_product() * SEGMENTS_IN_CELL / count).cbrt();
    let crossed = lengths / (count * LENGTH_IN_CELLS);
    let side = even.max(CELL_IN_MARGINS * margin).max(crossed).max(extent / MOST_IN_ROW) as f32;
    let dims = (size / f64::from(side)).floor() + 1.0;
    (low.as_vec3(), side, dims.as_uvec3())
}
