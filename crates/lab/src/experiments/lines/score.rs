//! How well estimates agree with the truth.

/// Agreement of two lists of values.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Score {
    /// The correlation of the values.
    pub pearson: f64,
    /// The correlation of their ranks.
    pub spearman: f64,
    /// The root of the mean square of the differences.
    pub rmse: f64,
}

impl Score {
    /// Compares estimates with the truth.
    pub fn of(estimates: &[f64], truth: &[f64]) -> Self {
        Self {
            pearson: pearson(estimates, truth),
            spearman: pearson(&ranks(estimates), &ranks(truth)),
            rmse: rmse(estimates, truth),
        }
    }
}

/// The root of the mean square of the differences; 0 of none.
pub fn rmse(a: &[f64], b: &[f64]) -> f64 {
    let squares: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (squares / a.len().max(1) as f64).sqrt()
}

/// The mean; 0 of none.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// The correlation coefficient; 0 if one of the lists is constant.
fn pearson(a: &[f64], b: &[f64]) -> f64 {
    let (ma, mb) = (mean(a), mean(b));
    let sum = |f: &dyn Fn(f64, f64) -> f64| a.iter().zip(b).map(|(a, b)| f(a - ma, b - mb)).sum::<f64>();
    let spread = (sum(&|a, _| a * a) * sum(&|_, b| b * b)).sqrt();
    if spread > 0.0 { sum(&|a, b| a * b) / spread } else { 0.0 }
}

/// Ranks; equal values share the mean of theirs.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0.0; values.len()];
    let mut from = 0;
    for run in order.chunk_by(|&a, &b| values[a] == values[b]) {
        let rank = from as f64 + (run.len() - 1) as f64 / 2.0;
        run.iter().for_each(|&i| ranks[i] = rank);
        from += run.len();
    }
    ranks
}

/// The parameter, on a fine scale of equal ratios within a range, whose estimates are nearest to
/// the truth.
pub fn fit(raw: &[f64], truth: &[f64], [from, to]: [f64; 2], estimate: impl Fn(f64, f64) -> f64) -> f64 {
    const STEPS: usize = 240;
    let parameter = |i: usize| from * (to / from).powf(i as f64 / STEPS as f64);
    let error = |p: f64| rmse(&raw.iter().map(|&x| estimate(p, x)).collect::<Vec<_>>(), truth);
    let errors = (0..=STEPS).map(|i| (parameter(i), error(parameter(i))));
    errors.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(from, |best| best.0)
}

/// Offset and slope of the straight line nearest to some points, and the share of the variance that
/// it explains.
pub fn straight_line(points: &[(f64, f64)]) -> (f64, f64, f64) {
    let (x, y): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
    let (mx, my) = (mean(&x), mean(&y));
    let above: f64 = points.iter().map(|(x, y)| (x - mx) * (y - my)).sum();
    let below: f64 = x.iter().map(|x| (x - mx).powi(2)).sum();
    let slope = if below > 0.0 { above / below } else { 0.0 };
    (my - slope * mx, slope, pearson(&x, &y).powi(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scores_are_those_of_known_lists() {
        let truth = [1.0, 2.0, 3.0, 4.0];
        let score = Score::of(&[1.0, 4.0, 9.0, 16.0], &truth);
        assert!((score.pearson - 0.984_374).abs() < 1e-5 && (score.spearman - 1.0).abs() < 1e-12);
        assert_eq!(score.rmse, (184.0f64 / 4.0).sqrt());
        assert_eq!(ranks(&[3.0, 1.0, 3.0]), [1.5, 0.0, 1.5]);
        assert_eq!(Score::of(&[2.0; 4], &truth).pearson, 0.0);
        let factor = fit(&[0.1, 0.2, 0.9], &[0.3, 0.6, 1.0], [0.1, 100.0], |f, x| (f * x).min(1.0));
        assert!((factor - 3.0).abs() < 0.05, "{factor}");
        let (offset, slope, share) = straight_line(&[(0.0, 1.0), (1.0, 3.0), (2.0, 5.0)]);
        assert_eq!((offset, slope), (1.0, 2.0));
        assert!((share - 1.0).abs() < 1e-12);
    }
}
