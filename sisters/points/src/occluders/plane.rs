//! Planes fitted to points.

use glam::{DMat3, DVec3, Vec3};

/// The standard deviation of points from their plane, in cells, from which on they are no surface:
/// that of the two sides of a board two cells thick.
const MOST_DEVIATION: f64 = 1.0;
/// The least width of the points of a plane across their length, over their thickness: points along
/// a line have no plane.
const LEAST_WIDTH: f64 = 1.5;

/// Sums of points relative to a place near them.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Moments {
    pub count: u32,
    sum: Vec3,
    /// Of x², y², z², and of xy, yz, zx.
    squares: Vec3,
    products: Vec3,
}

impl Moments {
    pub fn add(&mut self, p: Vec3) {
        self.count = self.count.saturating_add(1);
        self.sum += p;
        self.squares += p * p;
        self.products += p * Vec3::new(p.y, p.z, p.x);
    }

    /// The sums about another place, for points relative to `middle`.
    pub fn about(&self, middle: DVec3) -> Spread {
        let count = f64::from(self.count);
        let mean = self.sum.as_dvec3() / count;
        let squares = self.squares.as_dvec3() - count * mean * mean;
        let products = self.products.as_dvec3() - count * mean * DVec3::new(mean.y, mean.z, mean.x);
        let matrix = DMat3::from_cols(
            DVec3::new(squares.x, products.x, products.z),
            DVec3::new(products.x, squares.y, products.y),
            DVec3::new(products.z, products.y, squares.z),
        );
        Spread { count, mean: middle + mean, scatter: matrix }
    }
}

/// Points by their number, mean, and the sum of the products of their differences from it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spread {
    count: f64,
    mean: DVec3,
    scatter: DMat3,
}

impl Spread {
    pub fn count(&self) -> f64 {
        self.count
    }

    /// About how far apart points of a flat part are. A rectangle that is filled evenly has an area
    /// of twelve times the root of the product of its two variances, a triangle of 10.4 times.
    pub fn spacing(&self) -> f64 {
        let (values, _) = eigen(self.scatter * (1.0 / self.count));
        (12.0 * (values[1] * values[2]).max(0.0).sqrt() / self.count).sqrt()
    }

    /// The same for points that were relative to a place, in cells.
    pub fn placed(&self, middle: DVec3, cell: f64) -> Self {
        Self { mean: middle + self.mean * cell, scatter: self.scatter * (cell * cell), ..*self }
    }

    /// Both sets of points together.
    pub fn with(&self, other: &Self) -> Self {
        let count = self.count + other.count;
        let between = other.mean - self.mean;
        let outer = DMat3::from_cols(between * between.x, between * between.y, between * between.z);
        Self {
            count,
            mean: self.mean + between * (other.count / count),
            scatter: self.scatter + other.scatter + outer * (self.count * other.count / count),
        }
    }
}

/// A plane through points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    pub mean: DVec3,
    pub normal: DVec3,
    /// The mean square of the distances of points from it.
    pub variance: f64,
}

impl Plane {
    /// The plane of points that lie near one.
    pub fn fit(spread: &Spread, cell: f64) -> Option<Self> {
        let (values, axes) = eigen(spread.scatter * (1.0 / spread.count));
        let most = MOST_DEVIATION * cell;
        let flat = values[0] <= most * most && values[1] > LEAST_WIDTH * LEAST_WIDTH * values[0].max(0.0);
        let plane = Self { mean: spread.mean, normal: axes[0], variance: values[0].max(0.0) };
        (flat && plane.mean.is_finite() && plane.normal.is_normalized()).then_some(plane)
    }

    /// The same for points that were relative to a place, in cells.
    pub fn placed(&self, middle: DVec3, cell: f64) -> Self {
        Self { mean: middle + self.mean * cell, variance: self.variance * cell * cell, ..*self }
    }

    pub fn distance(&self, p: DVec3) -> f64 {
        self.normal.dot(p - self.mean)
    }
}

/// Sweeps of rotations. Each squares the part of the matrix beside its diagonal, so that few reach
/// the rounding of a double.
const SWEEPS: usize = 8;

/// The eigenvalues of a symmetric matrix, the least first, and their unit vectors, by Jacobi's
/// rotations (Golub & Van Loan, *Matrix Computations*, 8.5).
fn eigen(mut m: DMat3) -> ([f64; 3], [DVec3; 3]) {
    let mut vectors = DMat3::IDENTITY;
    for (p, q) in [(0, 1), (0, 2), (1, 2)].into_iter().cycle().take(3 * SWEEPS) {
        let beside = m.col(p)[q];
        if beside == 0.0 {
            continue;
        }
        let turn = (m.col(q)[q] - m.col(p)[p]) / (2.0 * beside);
        let tangent = turn.signum() / (turn.abs() + turn.hypot(1.0));
        let cosine = tangent.hypot(1.0).recip();
        let sine = tangent * cosine;
        let mut rotation = DMat3::IDENTITY;
        rotation.col_mut(p)[p] = cosine;
        rotation.col_mut(q)[q] = cosine;
        rotation.col_mut(q)[p] = sine;
        rotation.col_mut(p)[q] = -sine;
        m = rotation.transpose() * m * rotation;
        vectors *= rotation;
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| m.col(a)[a].total_cmp(&m.col(b)[b]));
    (order.map(|i| m.col(i)[i]), order.map(|i| vectors.col(i)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_of_a_matrix_are_found() {
        let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 0.9);
        for values in [DVec3::new(1e-6, 2.0, 3.0), DVec3::new(0.0, 0.0, 1.0), DVec3::ONE] {
            let m = turn * DMat3::from_diagonal(values) * turn.transpose();
            let (found, axes) = eigen(m);
            for (value, axis) in found.into_iter().zip(axes) {
                assert!((m * axis - axis * value).length() < 1e-14, "{value} {axis}");
                assert!((axis.length() - 1.0).abs() < 1e-14);
            }
            assert!(found.is_sorted());
        }
    }

    #[test]
    fn parts_together_have_the_spread_of_the_whole() {
        let points: Vec<Vec3> = (0..40).map(|i| Vec3::new(i as f32, (i * i % 17) as f32, -3.0)).collect();
        let of = |points: &[Vec3]| {
            let mut moments = Moments::default();
            points.iter().for_each(|p| moments.add(*p));
            moments.about(DVec3::ZERO)
        };
        let (whole, parts) = (of(&points), of(&points[..7]).with(&of(&points[7..])));
        assert!((whole.mean - parts.mean).length() < 1e-9);
        assert!((whole.scatter - parts.scatter).to_cols_array().iter().all(|x| x.abs() < 1e-6));
    }
}
