//! A grid of bits along the view: a column of 128 or 256 slices behind each pixel.
//!
//! Eisemann and Décoret 2008, "Single-pass GPU solid voxelization for real-time applications", for
//! solids; for lines with the depth spans of Benevides 2015, section 3.2. Each column also holds
//! the length of the lines in each group of 16 slices. The bits say where in depth lines are, the
//! lengths say how much of them: so sums over a column depend neither on its width nor on the
//! number of slices, and many lines in one slice count as many. (Groß and Gumhold 2021 keep line
//! densities in isotropic voxels to the same end.)
//!
//! Columns keep every layer, so they also answer whether anything lies before a depth. Lines fill a
//! fraction of a pixel: a column that is set by lines never hides objects behind it. Columns of
//! solids are sampled at the pixel's centre: not conservative.

mod slices;
mod solid;
#[cfg(test)]
mod tests;
mod walk;

use std::ops::Range;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

pub use slices::Slices;
pub(crate) use slices::mask;
use slices::{MOST_GROUPS, slice_of};
pub use solid::SolidError;
pub(crate) use walk::{Part, walk};

use crate::sets::{LineSet, Segment};
use crate::view::View;

/// The side of a tile in pixels. Tiles without any bit take no memory but an index.
const TILE: u32 = 8;
/// The pixels of a tile.
const TILE_PIXELS: usize = (TILE * TILE) as usize;
/// The index of a tile without bits.
const EMPTY: u32 = u32::MAX;

/// Which slices of a column a line sets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SpanRule {
    /// All from the depth where it enters the column to the depth where it leaves it.
    #[default]
    Span,
    /// The one in the middle, as plain rasterisation does: steep lines lose most of their bits. To
    /// show the difference.
    Middle,
}

/// Set slices and all slices of a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Count {
    /// Slices that are set.
    pub on: u32,
    /// All slices of the range that lie between the nearest and the farthest depth.
    pub total: u32,
}

/// A grid of bits along a view.
#[derive(Debug, Clone, PartialEq)]
pub struct SlabGrid {
    view: View,
    slices: Slices,
    /// For each tile its number among those with bits, or [`EMPTY`].
    tiles: Vec<u32>,
    words: Vec<u128>,
    /// For each column the length of the lines in each of its groups of slices.
    lengths: Vec<f32>,
}

/// Indices of primitives by the row of tiles that they touch.
fn bins(view: &View, rows: &[Option<Range<u32>>]) -> Vec<Vec<u32>> {
    let mut bins = vec![Vec::new(); view.size()[1].div_ceil(TILE) as usize];
    for (i, rows) in rows.iter().enumerate() {
        let Some(rows) = rows else { continue };
        bins[(rows.start / TILE) as usize..=((rows.end - 1) / TILE) as usize]
            .iter_mut()
            .for_each(|b| b.push(i as u32));
    }
    bins
}

/// A set of lines in a view: its vertices in eye space, and its segments by the rows of tiles that
/// they cross. Work that goes row by row over them gives the same result for any number of threads.
pub(crate) struct Placed {
    pub(crate) points: Vec<DVec3>,
    pub(crate) segments: Vec<Segment>,
    bins: Vec<Vec<u32>>,
}

impl Placed {
    pub(crate) fn new(lines: &LineSet, view: &View) -> Self {
        let points: Vec<DVec3> = lines.points().par_iter().map(|&p| view.to_eye(p)).collect();
        let segments: Vec<Segment> = lines.segments().collect();
        let height = view.size()[1];
        let rows = |s: &Segment| {
            let [a, b] = [points[s.a as usize], points[s.b as usize]];
            let part = walk::clip(view, [a, b], &(0..height))?;
            let row = |t: f64| {
                let p = view.project(a + (b - a) * t);
                ((p.y / p.z) as i64).clamp(0, i64::from(height) - 1) as u32
            };
            let (from, to) = (row(part.from), row(part.to));
            // A row more on both sides: rounding may put the ends of the parts of a segment there.
            Some(from.min(to).saturating_sub(1)..(from.max(to) + 2).min(height))
        };
        let rows: Vec<Option<Range<u32>>> = segments.par_iter().map(rows).collect();
        let bins = bins(view, &rows);
        Self { points, segments, bins }
    }

    pub(crate) fn ends(&self, segment: &Segment) -> [DVec3; 2] {
        [self.points[segment.a as usize], self.points[segment.b as usize]]
    }

    /// For each row of tiles, in order and in parallel: the rows of pixels and the segments in
    /// them.
    pub(crate) fn bands<T: Send>(
        &self,
        view: &View,
        work: impl Fn(Range<u32>, &mut dyn Iterator<Item = Segment>) -> T + Sync,
    ) -> Vec<T> {
        let height = view.size()[1];
        let band = |(i, bin): (usize, &Vec<u32>)| {
            let top = i as u32 * TILE;
            let mut segments = bin.iter().map(|&s| self.segments[s as usize]);
            work(top..(top + TILE).min(height), &mut segments)
        };
        self.bins.par_iter().enumerate().map(band).collect()
    }
}

/// One row of tiles, while it is filled.
struct Band {
    slices: Slices,
    tiles: Vec<u32>,
    words: Vec<u128>,
    lengths: Vec<f32>,
}

impl Band {
    fn new(view: &View, slices: Slices) -> Self {
        let tiles = vec![EMPTY; view.size()[0].div_ceil(TILE) as usize];
        Self { slices, tiles, words: Vec::new(), lengths: Vec::new() }
    }

    /// The words and the lengths of a column.
    fn column(&mut self, x: u32, y: u32) -> (&mut [u128], &mut [f32]) {
        let (words, groups) = (self.slices.words(), self.slices.groups());
        let tile = &mut self.tiles[(x / TILE) as usize];
        if *tile == EMPTY {
            let tiles = self.words.len() / (TILE_PIXELS * words);
            *tile = tiles as u32;
            self.words.resize((tiles + 1) * TILE_PIXELS * words, 0);
            self.lengths.resize((tiles + 1) * TILE_PIXELS * groups, 0.0);
        }
        let at = *tile as usize * TILE_PIXELS + ((y % TILE) * TILE + x % TILE) as usize;
        (&mut self.words[at * words..][..words], &mut self.lengths[at * groups..][..groups])
    }
}

impl SlabGrid {
    /// The columns that lines cross, with the slices and the length of the lines in each.
    ///
    /// Time: proportional to the vertices and to the columns that lines cross. Memory: 48 bytes a
    /// pixel with 128 slices, 96 with 256, in tiles of 8 x 8 pixels that lines cross, and 4 bytes a
    /// tile; while it is made, as much again, about 60 bytes a vertex, and 4 bytes for each row of
    /// tiles that a segment crosses.
    pub fn of_lines(lines: &LineSet, view: &View, slices: Slices, rule: SpanRule) -> Self {
        let placed = Placed::new(lines, view);
        let bands = placed.bands(view, |rows, segments| {
            let mut band = Band::new(view, slices);
            for segment in segments {
                let [a, b] = placed.ends(&segment);
                let long = a.distance(b);
                walk(view, [a, b], &rows, |x, y, part| {
                    let depth = |t: f64| -(a.z + (b.z - a.z) * t);
                    let mut ends = [depth(part.from), depth(part.to)];
                    ends.sort_by(f64::total_cmp);
                    if rule == SpanRule::Middle {
                        ends = [(ends[0] + ends[1]) / 2.0; 2];
                    }
                    let [first, last] = ends.map(|d| slice_of(view, slices, d));
                    let (words, lengths) = band.column(x, y);
                    words.iter_mut().zip(0..).for_each(|(w, i)| *w |= mask(first, last, i));
                    slices::spread(view, slices, ends, long * (part.to - part.from), lengths);
                });
            }
            band
        });
        Self::joined(view, slices, bands)
    }

    /// The slices whose middle lies inside closed triangle meshes: where the ray through the
    /// pixel's centre has crossed an odd number of triangles. Meshes with holes give odd columns,
    /// but no error. Columns have no length.
    ///
    /// Time: proportional to the pixels in the bounding rectangles of the triangles.
    ///
    /// # Errors
    /// If a triangle names a vertex that is not there, or a vertex is not finite.
    pub fn of_solid(
        vertices: &[Vec3],
        triangles: &[[u32; 3]],
        view: &View,
        slices: Slices,
    ) -> Result<Self, SolidError> {
        let (placed, rows) = solid::place(vertices, triangles, view)?;
        let bins = bins(view, &rows);
        let height = view.size()[1];
        let fill = |(i, bin): (usize, &Vec<u32>)| {
            let mut band = Band::new(view, slices);
            let rows = i as u32 * TILE..((i as u32 + 1) * TILE).min(height);
            for &triangle in bin {
                let corners = triangles[triangle as usize].map(|v| placed[v as usize]);
                solid::crossings(view, corners, &rows, |x, y, depth| {
                    if let Some(last) = solid::slices_before(view, slices, depth) {
                        let (words, _) = band.column(x, y);
                        words.iter_mut().zip(0..).for_each(|(w, i)| *w ^= mask(0, last, i));
                    }
                });
            }
            band
        };
        let bands = bins.par_iter().enumerate().map(fill).collect();
        Ok(Self::joined(view, slices, bands))
    }

    fn joined(view: &View, slices: Slices, bands: Vec<Band>) -> Self {
        let mut grid =
            Self { view: *view, slices, tiles: Vec::new(), words: Vec::new(), lengths: Vec::new() };
        for band in bands {
            let base = grid.tiles() as u32;
            grid.tiles.extend(band.tiles.iter().map(|&t| if t == EMPTY { EMPTY } else { t + base }));
            grid.words.extend(band.words);
            grid.lengths.extend(band.lengths);
        }
        grid
    }

    /// The view that the columns belong to.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// The number of slices.
    pub fn slices(&self) -> Slices {
        self.slices
    }

    /// The tiles of 8 x 8 pixels that have memory.
    pub fn tiles(&self) -> usize {
        self.words.len() / (TILE_PIXELS * self.slices.words())
    }

    /// Where a column is in the arrays.
    fn place(&self, x: u32, y: u32) -> Option<usize> {
        let [width, height] = self.view.size();
        if x >= width || y >= height {
            return None;
        }
        let tile = self.tiles[((y / TILE) * width.div_ceil(TILE) + x / TILE) as usize];
        (tile != EMPTY).then(|| tile as usize * TILE_PIXELS + ((y % TILE) * TILE + x % TILE) as usize)
    }

    /// The words of a column; bit 0 of the first is the nearest slice. The second is 0 if there are
    /// 128 slices; both are 0 outside of the picture.
    pub fn column(&self, x: u32, y: u32) -> [u128; 2] {
        let Some(at) = self.place(x, y) else { return [0; 2] };
        match self.slices {
            Slices::S128 => [self.words[at], 0],
            Slices::S256 => [self.words[2 * at], self.words[2 * at + 1]],
        }
    }

    /// The length of the lines in each group of [`GROUP`](crate::numeric::GROUP) slices of a
    /// column, in units of the scene; no group has any outside of the picture.
    pub fn lengths(&self, x: u32, y: u32) -> &[f32] {
        static NONE: [f32; MOST_GROUPS] = [0.0; MOST_GROUPS];
        let groups = self.slices.groups();
        self.place(x, y).map_or(&NONE[..groups], |at| &self.lengths[at * groups..][..groups])
    }

    /// The length of the lines in a column, in units of the scene; 0 outside of the picture.
    pub fn length(&self, x: u32, y: u32) -> f32 {
        self.lengths(x, y).iter().sum()
    }

    /// The slice of a depth, clamped to those that there are.
    pub fn slice(&self, depth: f64) -> u32 {
        slice_of(&self.view, self.slices, depth)
    }

    /// The depth of the middle of a slice.
    pub fn slice_depth(&self, slice: u32) -> f64 {
        let [near, far] = self.view.depths();
        near + (far - near) * (f64::from(slice) + 0.5) / f64::from(self.slices.count())
    }

    /// The first and last slice of a range of depths; `None` if it lies outside of the view's
    /// depths, or is empty or not a number.
    pub fn slices_in(&self, [from, to]: [f64; 2]) -> Option<[u32; 2]> {
        let [near, far] = self.view.depths();
        (from <= to && from <= far && to >= near).then(|| [self.slice(from), self.slice(to)])
    }

    /// Set slices and all slices of a column in a range of depths; slices that the range touches
    /// count.
    pub fn count(&self, x: u32, y: u32, depths: [f64; 2]) -> Count {
        let Some([first, last]) = self.slices_in(depths) else { return Count::default() };
        let column = self.column(x, y);
        let on = |i: u32| (column[i as usize] & mask(first, last, i)).count_ones();
        Count { on: on(0) + on(1), total: last - first + 1 }
    }

    /// Whether a slice of a column that lies wholly before a depth is set.
    pub fn any_in_front(&self, x: u32, y: u32, depth: f64) -> bool {
        let [near, far] = self.view.depths();
        let column = self.column(x, y);
        if depth.is_nan() || depth > far {
            return !depth.is_nan() && column != [0; 2];
        }
        let end = if depth < near { 0 } else { self.slice(depth) };
        end > 0 && (0..2).any(|i| column[i as usize] & mask(0, end - 1, i) != 0)
    }

    /// The share of the slices that are set, of the columns in a rectangle (its first and its end
    /// column, its first and its end row) and a range of depths; 0 of none. Time: proportional to
    /// the columns.
    pub fn fill_fraction(&self, columns: Range<u32>, rows: Range<u32>, depths: [f64; 2]) -> f64 {
        let [width, height] = self.view.size();
        let (mut on, mut total) = (0u64, 0u64);
        for y in rows.start..rows.end.min(height) {
            for x in columns.start..columns.end.min(width) {
                let count = self.count(x, y, depths);
                on += u64::from(count.on);
                total += u64::from(count.total);
            }
        }
        if total == 0 { 0.0 } else { on as f64 / total as f64 }
    }
}
