//! A straight line through measured points, and how well it fits.

/// A line through points by least squares.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    /// The value at 0.
    pub base: f64,
    /// The growth for each unit.
    pub slope: f64,
    /// The share of the values' variance that the line explains, 0 to 1; 1 where they do not vary.
    pub r2: f64,
}

/// The line nearest to points `(x, y)` in the sense of least squares; `None` for fewer than two
/// different `x` or values that are not finite.
pub fn fit(points: &[(f64, f64)]) -> Option<Fit> {
    let n = points.len() as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    let (xx, xy) = (mean(&|p| (p.0 - x).powi(2)), mean(&|p| (p.0 - x) * (p.1 - y)));
    let yy = mean(&|p| (p.1 - y).powi(2));
    if !(xx > 0.0 && xx.is_finite() && yy.is_finite()) {
        return None;
    }
    let slope = xy / xx;
    let r2 = if yy > 0.0 { slope * xy / yy } else { 1.0 };
    Some(Fit { base: y - slope * x, slope, r2 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_and_what_is_none_fits_badly() {
        let found = fit(&[(4.0, 11.0), (8.0, 19.0), (16.0, 35.0)]).unwrap();
        assert!((found.base - 3.0).abs() < 1e-12 && (found.slope - 2.0).abs() < 1e-12);
        assert!((found.r2 - 1.0).abs() < 1e-12);
        // A parabola around its lowest point: no line explains anything.
        let curve: Vec<_> = (-3..=3).map(|x| (f64::from(x), f64::from(x * x))).collect();
        assert!(fit(&curve).unwrap().r2 < 1e-12);
        assert_eq!(fit(&[(1.0, 2.0), (1.0, 3.0)]), None);
        assert_eq!(fit(&[]), None);
        assert_eq!(fit(&[(0.0, f64::NAN), (1.0, 1.0)]), None);
    }
}
