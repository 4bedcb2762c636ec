//! The Pareto front of speed and accuracy.

/// What one setting costs and gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cost {
    /// Milliseconds of a frame.
    pub(super) ms: f64,
    /// Objects found visible over objects that are.
    pub(super) ratio: f64,
    /// Whether it lost nothing visible.
    pub(super) safe: bool,
}

/// Which settings are on the front: they lost nothing, and no other one that lost nothing is as
/// good in one respect and better in the other.
pub(super) fn front(costs: &[Cost]) -> Vec<bool> {
    let beats = |a: &Cost, b: &Cost| {
        a.safe && a.ms <= b.ms && a.ratio <= b.ratio && (a.ms < b.ms || a.ratio < b.ratio)
    };
    costs.iter().map(|c| c.safe && !costs.iter().any(|o| beats(o, c))).collect()
}

/// How far a setting is from the front: the least share by which it would have to improve in time
/// or in accuracy for no setting that lost nothing to be better in both. 0 is on the front.
pub(super) fn distance(of: &Cost, costs: &[Cost]) -> f64 {
    let worse = |o: &Cost| (of.ms / o.ms).min(of.ratio / o.ratio) - 1.0;
    costs.iter().filter(|o| o.safe).map(worse).filter(|d| d.is_finite()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cost(ms: f64, ratio: f64, safe: bool) -> Cost {
        Cost { ms, ratio, safe }
    }

    #[test]
    fn the_front_holds_what_nothing_safe_beats() {
        let all = [
            cost(1.0, 2.0, true),
            cost(2.0, 1.5, true),
            cost(2.0, 1.6, true),
            cost(0.5, 1.0, false),
            cost(4.0, 1.5, true),
        ];
        assert_eq!(front(&all), [true, true, false, false, false]);
        assert_eq!(distance(&all[0], &all), 0.0);
        assert!((distance(&all[2], &all) - 0.0).abs() < 1e-12, "as fast as the best");
        // Twice as slow at the same accuracy: no faster, so accuracy would have to improve from
        // 1.5.
        assert!((distance(&all[4], &all)).abs() < 1e-12);
        let worse = cost(2.2, 1.8, true);
        assert!((distance(&worse, &all) - 0.1).abs() < 1e-12);
    }
}
