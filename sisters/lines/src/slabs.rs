//! A grid of bits along the view: a column of 128 slices behind each pixel.
//!
//! Eisemann and Décoret 2008, "Single-pass GPU solid voxelization for real-time applications", for
//! lines with the depth spans of Benevides 2015, section 3.2: a line sets all slices from the depth
//! where it enters a column to the depth where it leaves it.

#[cfg(test)]
mod tests;

use crate::sets::LineSet;
use crate::view::View;
use crate::walk::{Placed, walk};

/// The slices of a column.
pub const SLICES: u32 = 128;

/// A grid of bits along a view.
#[derive(Debug, Clone, PartialEq)]
pub struct SlabGrid {
    view: View,
    /// Row by row.
    columns: Vec<u128>,
}

impl SlabGrid {
    /// The columns that lines cross, with the slices of the lines in each.
    ///
    /// Time: proportional to the vertices and to the columns that lines cross. Memory: 16 bytes a
    /// pixel; while it is made, as much again, about 60 bytes a vertex, and 4 bytes for each eight
    /// rows that a segment crosses.
    pub fn of_lines(lines: &LineSet, view: &View) -> Self {
        let placed = Placed::new(lines, view);
        let width = view.size()[0] as usize;
        let bands = placed.bands(view, |rows, segments| {
            let mut band = vec![0; rows.len() * width];
            for segment in segments {
                let [a, b] = placed.ends(&segment);
                walk(view, [a, b], &rows, |x, y, part| {
                    let [from, to] = [part.from, part.to].map(|t| slice_of(view, -(a.z + (b.z - a.z) * t)));
                    band[(y - rows.start) as usize * width + x as usize] |= mask(from.min(to), from.max(to));
                });
            }
            band
        });
        Self { view: *view, columns: bands.concat() }
    }

    /// The view that the columns belong to.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// The slices of a column; bit 0 is the nearest one. None is set outside of the picture.
    pub fn column(&self, x: u32, y: u32) -> u128 {
        let [width, height] = self.view.size();
        if x < width && y < height { self.columns[y as usize * width as usize + x as usize] } else { 0 }
    }

    /// Set slices and all slices of a column in a range of depths; slices that the range touches
    /// count. None do outside of the view's depths.
    pub fn count(&self, x: u32, y: u32, [from, to]: [f64; 2]) -> [u32; 2] {
        let [near, far] = self.view.depths();
        let is_inside = from <= to && from <= far && to >= near;
        if !is_inside {
            return [0; 2];
        }
        let [first, last] = [from, to].map(|depth| slice_of(&self.view, depth));
        [(self.column(x, y) & mask(first, last)).count_ones(), last - first + 1]
    }
}

/// The slices `first` to `last`, both inclusive.
fn mask(first: u32, last: u32) -> u128 {
    (u128::MAX << first) & (u128::MAX >> (SLICES - 1 - last))
}

/// The slice of a depth, clamped to those that there are.
fn slice_of(view: &View, depth: f64) -> u32 {
    let [near, far] = view.depths();
    // Conversion saturates.
    (((depth - near) / (far - near) * f64::from(SLICES)) as u32).min(SLICES - 1)
}
