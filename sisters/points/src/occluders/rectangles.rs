//! A mask covered by few, large rectangles.

use std::ops::Range;

/// The most rectangles of one mask: what is left then is small.
const MOST: usize = 64;
/// The fewest pixels that are not yet covered for which there is another rectangle.
const FEWEST: usize = 16;

/// A picture of one bit a pixel.
#[derive(Clone)]
pub(super) struct Mask {
    pub width: usize,
    pub height: usize,
    pub pixels: Vec<bool>,
}

/// A rectangle of pixels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Rectangle {
    pub x: Range<usize>,
    pub y: Range<usize>,
}

impl Mask {
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, height, pixels: vec![false; width * height] }
    }

    /// Pixels of which one within a step, also diagonally, is set.
    pub fn grown(&self) -> Self {
        self.spread(|a, b| a || b)
    }

    /// Pixels of which all within a step are set. Those beyond the rim count as not set.
    pub fn shrunk(&self) -> Self {
        self.spread(|a, b| a && b)
    }

    fn spread(&self, join: impl Fn(bool, bool) -> bool) -> Self {
        let Self { width, height, .. } = *self;
        let mut rows = Self::new(width, height);
        let mut result = Self::new(width, height);
        for y in 0..height {
            for x in 0..width {
                let at = |inside: bool, i: usize| if inside { self.pixels[i] } else { false };
                let i = y * width + x;
                let beside = join(at(x > 0, i.wrapping_sub(1)), at(x + 1 < width, i + 1));
                rows.pixels[i] = join(self.pixels[i], beside);
            }
        }
        for y in 0..height {
            for x in 0..width {
                let at = |inside: bool, i: usize| if inside { rows.pixels[i] } else { false };
                let i = y * width + x;
                let beside = join(at(y > 0, i.wrapping_sub(width)), at(y + 1 < height, i + width));
                result.pixels[i] = join(rows.pixels[i], beside);
            }
        }
        result
    }

    /// The number of set pixels in the square of `2 reach + 1` pixels around each.
    pub fn counts(&self, reach: usize) -> Vec<u32> {
        let Self { width, height, .. } = *self;
        // Sums over all pixels left of and above each corner.
        let mut sums = vec![0_u32; (width + 1) * (height + 1)];
        for y in 0..height {
            let mut row = 0;
            for x in 0..width {
                row += u32::from(self.pixels[y * width + x]);
                sums[(y + 1) * (width + 1) + x + 1] = sums[y * (width + 1) + x + 1] + row;
            }
        }
        let at = |x: usize, y: usize| sums[y * (width + 1) + x];
        let square = |i: usize| {
            let (x, y) = (i % width, i / width);
            let (left, top) = (x.saturating_sub(reach), y.saturating_sub(reach));
            let (right, bottom) = ((x + reach + 1).min(width), (y + reach + 1).min(height));
            at(right, bottom) + at(left, top) - at(left, bottom) - at(right, top)
        };
        (0..width * height).map(square).collect()
    }

    /// Pixels set in both, or in one of the masks, of one size.
    pub fn and(&self, other: &Self) -> Self {
        let pixels = self.pixels.iter().zip(&other.pixels).map(|(&a, &b)| a && b).collect();
        Self { pixels, ..*self }
    }

    pub fn or(&self, other: &Self) -> Self {
        let pixels = self.pixels.iter().zip(&other.pixels).map(|(&a, &b)| a || b).collect();
        Self { pixels, ..*self }
    }

    /// Rectangles of set pixels whose sides have `least` pixels at least. They overlap, so that no
    /// slit is between two of them: the largest that holds only pixels not yet covered, made as
    /// large as the mask allows. Each costs the pixels.
    pub fn rectangles(&self, least: usize) -> Vec<Rectangle> {
        let mut left = self.clone();
        let mut found = Vec::new();
        for _ in 0..MOST {
            let Some(largest) = left.largest() else { break };
            for y in largest.y.clone() {
                left.pixels[y * self.width..][largest.x.clone()].fill(false);
            }
            let whole = self.extended(largest);
            for y in whole.y.clone() {
                left.pixels[y * self.width..][whole.x.clone()].fill(false);
            }
            if whole.x.len().min(whole.y.len()) >= least {
                found.push(whole);
            }
        }
        found
    }

    /// The largest rectangle of set pixels, if it has enough: for each row, the heights of the
    /// columns of set pixels that end in it, and a stack of those that may still widen.
    fn largest(&self) -> Option<Rectangle> {
        // A last column is never set.
        let mut heights = vec![0; self.width + 1];
        let mut best: Option<Rectangle> = None;
        let mut most = FEWEST - 1;
        let mut stack: Vec<(usize, usize)> = Vec::new();
        for y in 0..self.height {
            for (x, height) in heights.iter_mut().enumerate() {
                let set = x < self.width && self.pixels[y * self.width + x];
                *height = if set { *height + 1 } else { 0 };
                let height = *height;
                let mut start = x;
                while let Some(&(from, tall)) = stack.last().filter(|&&(_, tall)| tall >= height) {
                    stack.pop();
                    if tall * (x - from) > most {
                        most = tall * (x - from);
                        best = Some(Rectangle { x: from..x, y: y + 1 - tall..y + 1 });
                    }
                    start = from;
                }
                if height > 0 {
                    stack.push((start, height));
                }
            }
            stack.clear();
        }
        best
    }

    /// The rectangle as large as set pixels allow: rows first, then columns.
    fn extended(&self, mut r: Rectangle) -> Rectangle {
        let row = |y: usize, x: &Range<usize>| self.pixels[y * self.width..][x.clone()].iter().all(|&p| p);
        let column = |x: usize, y: &Range<usize>| y.clone().all(|y| self.pixels[y * self.width + x]);
        while r.y.start > 0 && row(r.y.start - 1, &r.x) {
            r.y.start -= 1;
        }
        while r.y.end < self.height && row(r.y.end, &r.x) {
            r.y.end += 1;
        }
        while r.x.start > 0 && column(r.x.start - 1, &r.y) {
            r.x.start -= 1;
        }
        while r.x.end < self.width && column(r.x.end, &r.y) {
            r.x.end += 1;
        }
        r
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mask(rows: &[&str]) -> Mask {
        let pixels = rows.iter().flat_map(|row| row.chars().map(|c| c == '#')).collect();
        Mask { width: rows[0].len(), height: rows.len(), pixels }
    }

    #[test]
    fn a_wall_with_a_window_is_four_rectangles_that_overlap() {
        let mut wall = Mask { pixels: vec![true; 30 * 18], ..Mask::new(30, 18) };
        for (x, y) in (9..21).flat_map(|x| (6..12).map(move |y| (x, y))) {
            wall.pixels[y * 30 + x] = false;
        }
        let found = wall.rectangles(2);
        assert_eq!(found.len(), 4, "{found:?}");
        let covered = |x, y| found.iter().any(|r: &Rectangle| r.x.contains(&x) && r.y.contains(&y));
        for (x, y) in (0..30).flat_map(|x| (0..18).map(move |y| (x, y))) {
            assert_eq!(covered(x, y), wall.pixels[y * 30 + x], "{x} {y}");
        }
        let sum: usize = found.iter().map(|r| r.x.len() * r.y.len()).sum();
        assert_eq!(sum, 2 * 30 * 6 + 2 * 9 * 18, "the four share the corners");
    }

    #[test]
    fn growing_and_shrinking_close_single_pixels_and_keep_holes_of_three() {
        let wall = mask(&["########", "#.###...", "#####...", "#####...", "########"]);
        let closed = wall.grown().shrunk();
        assert!(closed.pixels[8 + 1]);
        assert!(!closed.pixels[2 * 8 + 6]);
        let wide: Mask = mask(&["####"; 4]);
        assert_eq!(wide.shrunk().pixels.iter().filter(|&&p| p).count(), 4);
    }

    #[test]
    fn counts_are_those_of_the_squares_around() {
        let wall = mask(&["##.#", ".#..", "####"]);
        let counts = wall.counts(1);
        assert_eq!(counts, [3, 3, 3, 1, 5, 6, 6, 3, 3, 4, 4, 2]);
    }
}
