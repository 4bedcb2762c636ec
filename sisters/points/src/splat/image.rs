//! Depth images, their filters, and the limits of depth that points are tested against.

use super::options::{Bias, Filter};
use crate::numeric::SUBPIXELS;
use rayon::prelude::*;

/// The depth of the nearest square in each pixel.
pub(super) struct DepthImage {
    pub(super) width: usize,
    /// Row by row, from above; infinity where there is no square.
    pub(super) depths: Vec<f32>,
}

impl DepthImage {
    pub(super) fn filtered(self, filter: Filter) -> Self {
        if filter == Filter::None {
            return self;
        }
        // The largest is infinity if any pixel is without points.
        let mut pooled = self.pooled(|a, b| if a > b { a } else { b });
        let least = (filter == Filter::Min).then(|| self.pooled(|a, b| if a < b { a } else { b }));
        pooled.par_iter_mut().enumerate().for_each(|(i, depth)| {
            *depth = match &least {
                _ if *depth == f32::INFINITY => self.depths[i],
                Some(least) => least[i],
                None => *depth,
            };
        });
        Self { width: self.width, depths: pooled }
    }

    /// One value for the 3x3 pixels around each, fewer at the borders.
    fn pooled(&self, both: impl Fn(f32, f32) -> f32 + Sync) -> Vec<f32> {
        let (width, last) = (self.width, self.depths.len() / self.width - 1);
        let row = |y: usize| &self.depths[y * width..][..width];
        let mut pooled = vec![0.0; self.depths.len()];
        pooled.par_chunks_mut(width).enumerate().for_each_init(
            || vec![0.0; width],
            |column, (y, pooled)| {
                let rows = [row(y.saturating_sub(1)), row(y), row((y + 1).min(last))];
                for (x, column) in column.iter_mut().enumerate() {
                    *column = both(both(rows[0][x], rows[1][x]), rows[2][x]);
                }
                pooled.copy_from_slice(column);
                let left = pooled.iter_mut().skip(1).zip(&*column);
                left.for_each(|(pooled, left)| *pooled = both(*pooled, *left));
                let right = pooled.iter_mut().zip(&column[1..]);
                right.for_each(|(pooled, right)| *pooled = both(*pooled, *right));
            },
        );
        pooled
    }

    /// For limits of depth: the least inverse depth of a visible point in a pixel of a surface that
    /// slants, whose squares have this half side beyond the first pixel in 1/256 of one.
    ///
    /// Inverse depths of a plane are linear in the picture. Squares raise those of each pixel by the largest
    /// of its surface within half a square: by as much as a plane rises over that on both axes together. The
    /// pixels that are compared are a square apart, so that they have different points.
    pub(super) fn slanted(&self, x: i32, y: i32, half: i32) -> f32 {
        let step = 2 * half / SUBPIXELS as i32 + 1;
        let inverse = |x: i32, y: i32| {
            let (x, y) = (usize::try_from(x).ok()?, usize::try_from(y).ok()?);
            let row = self.depths.chunks(self.width).nth(y)?;
            row.get(x).map(|depth| 1.0 / depth)
        };
        let own = inverse(x, y).unwrap_or(0.0);
        let rise = |before: Option<f32>, after: Option<f32>| match (before, after) {
            (Some(before), Some(after)) if (own > before) != (after > own) => 0.0,
            (Some(before), Some(after)) => (own - before).abs().min((after - own).abs()),
            (one, other) => one.or(other).map_or(0.0, |one| (one - own).abs()),
        };
        let across = rise(inverse(x - step, y), inverse(x + step, y));
        let along = rise(inverse(x, y - step), inverse(x, y + step));
        let pixel = SUBPIXELS as i32;
        own - (half + pixel / 2) as f32 / (step * pixel) as f32 * (across + along)
    }

    /// The largest depth of a visible point in each pixel.
    pub(super) fn limits(&self, bias: Bias, far: f32) -> Self {
        let limit = |depth: f32| match bias {
            Bias::World(length) => depth + length,
            // Window depths are linear in 1 / depth, 1 at the far plane. Behind no square there is no limit.
            Bias::Window(part) if depth < f32::INFINITY => 1.0 / ((1.0 - part) / depth + part / far),
            Bias::Window(_) => depth,
        };
        // A bias of 0 must not hide a point from itself by rounding.
        let depths = self.depths.par_iter().map(|&depth| limit(depth).max(depth)).collect();
        Self { width: self.width, depths }
    }
}
