//! Figures of many values, and how they are written.

/// A number with commas between its thousands.
pub(crate) fn grouped(n: usize) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

/// The median of some values, which are sorted; 0 of none.
pub fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// The value that 99 of 100 of some values do not exceed; sorts them. 0 of none.
pub fn p99(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    let rank = (values.len() * 99).div_ceil(100);
    rank.checked_sub(1).map_or(0.0, |i| values[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hundredth_of_the_values_may_exceed_the_percentile() {
        let mut values: Vec<f64> = (1..=200).rev().map(f64::from).collect();
        assert_eq!((p99(&mut values), median(&mut values)), (198.0, 101.0));
        assert_eq!((p99(&mut [3.0, 1.0]), p99(&mut [])), (3.0, 0.0));
    }

    #[test]
    fn thousands_are_grouped() {
        assert_eq!(
            [0, 999, 1000, 67_792, 1_000_000].map(grouped),
            ["0", "999", "1,000", "67,792", "1,000,000"]
        );
    }
}
