//! Answers beside the truth: the two kinds of errors, counted apart.

use bitvec::slice::BitSlice;

/// How an answer differs from the truth.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Confusion {
    /// Truly visible points.
    pub visible: usize,
    /// Points found visible.
    pub found: usize,
    /// Points found visible that are hidden.
    pub false_visible: usize,
    /// Points found hidden that are visible.
    pub false_hidden: usize,
}

impl Confusion {
    /// Counts over points with known truth and answer; as many of both.
    pub fn of(truth: &BitSlice, found: &BitSlice) -> Self {
        let mut counts = Self::default();
        for (truth, found) in truth.iter().by_vals().zip(found.iter().by_vals()) {
            counts.visible += usize::from(truth);
            counts.found += usize::from(found);
            counts.false_visible += usize::from(found && !truth);
            counts.false_hidden += usize::from(truth && !found);
        }
        counts
    }

    /// The thesis' single number, in percent: half of all errors over the truly visible points. Not
    /// finite if there are none.
    pub fn error(&self) -> f64 {
        self.percent(self.false_visible + self.false_hidden) / 2.0
    }

    /// A count in percent of the truly visible points.
    pub fn percent(&self, count: usize) -> f64 {
        100.0 * count as f64 / self.visible as f64
    }

    /// Truly visible, found, false visible, false hidden and the error in percent, as cells of a
    /// table.
    pub fn cells(&self) -> [String; 5] {
        let [visible, found, fv, fh] =
            [self.visible, self.found, self.false_visible, self.false_hidden].map(|n| n.to_string());
        [visible, found, fv, fh, format!("{:.2}", self.error())]
    }
}

/// The heads of [`Confusion::cells`].
pub const COLUMNS: [&str; 5] = ["truly visible", "found visible", "false visible", "false hidden", "E, %"];

#[cfg(test)]
mod tests {
    use super::*;
    use bitvec::prelude::{Lsb0, bits};

    #[test]
    fn the_two_kinds_of_errors_are_counted_apart() {
        let truth = bits![1, 1, 1, 1, 0, 0, 0];
        let found = bits![1, 0, 0, 1, 1, 0, 0];
        let counts = Confusion::of(truth, found);
        assert_eq!(counts, Confusion { visible: 4, found: 3, false_visible: 1, false_hidden: 2 });
        assert_eq!((counts.error(), counts.percent(counts.false_hidden)), (37.5, 50.0));
        assert_eq!(counts.cells(), ["4", "3", "1", "2", "37.50"]);
        assert!(Confusion::of(bits![0], bits![1]).error().is_infinite());
    }
}
