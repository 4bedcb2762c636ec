//! Exact sums and products of floating-point numbers (Shewchuk 1997, "Adaptive precision
//! floating-point arithmetic").
//!
//! Used where the filters of the predicates give no sign. Every coordinate is a multiple of 2^-149
//! and less than 2^130, so that the polynomials of degree 6 that are computed here neither overflow
//! nor lose digits.

use glam::DVec2;
use smallvec::SmallVec;

/// An exact number: the sum of its terms, which do not overlap, the least first, none of them zero.
#[derive(Debug, Clone)]
pub(crate) struct Expansion(SmallVec<[f64; 8]>);

impl Expansion {
    /// The difference of two numbers.
    pub(crate) fn difference(a: f64, b: f64) -> Self {
        let mut difference = Self(SmallVec::new());
        difference.add(a);
        difference.add(-b);
        difference
    }

    /// Adds a number (Shewchuk's Grow-Expansion, without zeros).
    fn add(&mut self, mut number: f64) {
        let mut kept = 0;
        for i in 0..self.0.len() {
            let (sum, rest) = two_sum(number, self.0[i]);
            number = sum;
            if rest != 0.0 {
                self.0[kept] = rest;
                kept += 1;
            }
        }
        self.0.truncate(kept);
        if number != 0.0 {
            self.0.push(number);
        }
    }

    pub(crate) fn times(&self, other: &Self) -> Self {
        let mut product = Self(SmallVec::new());
        for &a in &self.0 {
            for &b in &other.0 {
                let high = a * b;
                product.add(a.mul_add(b, -high));
                product.add(high);
            }
        }
        product
    }

    pub(crate) fn minus(mut self, other: &Self) -> Self {
        other.0.iter().for_each(|term| self.add(-term));
        self
    }

    /// A number of the same sign, and zero if this is.
    pub(crate) fn sign(&self) -> f64 {
        self.0.last().copied().unwrap_or(0.0)
    }
}

/// The rounded sum of two numbers, and the error of rounding (Knuth's Two-Sum).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// An exact vector.
pub(crate) type Exact2 = [Expansion; 2];

/// The vector from one point to another.
pub(crate) fn between(from: DVec2, to: DVec2) -> Exact2 {
    [Expansion::difference(to.x, from.x), Expansion::difference(to.y, from.y)]
}

/// The area of the parallelogram of two vectors: positive if the second lies counterclockwise of
/// the first.
pub(crate) fn cross(a: &Exact2, b: &Exact2) -> Expansion {
    a[0].times(&b[1]).minus(&a[1].times(&b[0]))
}

/// `a * s - b * t`.
pub(crate) fn combined(a: &Exact2, s: &Expansion, b: &Exact2, t: &Expansion) -> Exact2 {
    [0, 1].map(|axis| a[axis].times(s).minus(&b[axis].times(t)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_that_rounding_would_lose_are_exact() {
        let (one, tiny) = (Expansion::difference(1.0, 0.0), Expansion::difference(2f64.powi(-149), 0.0));
        let huge = Expansion::difference(2f64.powi(129), 0.0);
        // (huge + tiny)(huge - tiny) - huge huge + tiny tiny = 0
        let zero = Expansion::difference(0.0, 0.0);
        let sum = huge.clone().minus(&zero.clone().minus(&tiny));
        let product = sum.times(&huge.clone().minus(&tiny));
        let rest = product.minus(&huge.times(&huge));
        assert!(rest.sign() < 0.0);
        assert_eq!(rest.minus(&zero.clone().minus(&tiny.times(&tiny))).sign(), 0.0);
        // The sixth power of the least coordinate is still a number.
        let sixth = (0..5).fold(tiny.clone(), |power, _| power.times(&tiny));
        assert_eq!(sixth.sign(), 2f64.powi(-894));
        let sixth = (0..5).fold(huge.clone(), |power, _| power.times(&huge)).minus(&one);
        assert!(sixth.sign().is_finite() && sixth.0.len() == 2);
    }
}
