//! The direction mask of one side: which directions from the viewer's cell are blocked.
//!
//! In space a mask has pixels (the 3D twin has one). In the plane the directions of a side are
//! numbers, `lateral / depth` from -1 to 1, and the mask is exact: closed intervals between
//! fractions of whole numbers.

use std::cmp::Ordering;

/// Below this number of intervals, none is ever dropped.
const FEW: usize = 256;

/// A direction of a side: a lattice line over a depth, both in cells.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slope {
    pub(super) line: i32,
    /// At least 1.
    pub(super) depth: i32,
}

impl Slope {
    pub(super) fn new(line: i32, depth: i32) -> Self {
        Self { line, depth }
    }

    fn cmp(self, other: Self) -> Ordering {
        let product = |a: i32, b: i32| i64::from(a) * i64::from(b);
        product(self.line, other.depth).cmp(&product(other.line, self.depth))
    }

    /// The last lattice line of shell `m` that is not beyond this direction.
    fn floor_at(self, m: i32) -> i32 {
        (i64::from(self.line) * i64::from(m)).div_euclid(i64::from(self.depth)) as i32
    }

    /// The first lattice line of shell `m` that is not before this direction.
    fn ceil_at(self, m: i32) -> i32 {
        -Self::new(-self.line, self.depth).floor_at(m)
    }

    fn value(self) -> f64 {
        f64::from(self.line) / f64::from(self.depth)
    }
}

/// The directions from `lo` to `hi`, both included.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    pub(super) lo: Slope,
    pub(super) hi: Slope,
}

impl Span {
    pub(super) fn width(&self) -> f64 {
        self.hi.value() - self.lo.value()
    }
}

/// The blocked directions of one side, as disjoint intervals in ascending order.
#[derive(Debug, Clone, Default)]
pub(super) struct DirectionMask {
    spans: Vec<Span>,
    merged: Vec<Span>,
}

impl DirectionMask {
    pub(super) fn clear(&mut self) {
        self.spans.clear();
    }

    /// Calls `hidden` with the first and last lattice line of each run of shell `m` whose centres
    /// lie in blocked directions. Intervals narrower than `narrowest` count for nothing.
    pub(super) fn hidden(&self, m: i32, narrowest: f64, mut hidden: impl FnMut(i32, i32)) {
        for span in self.spans.iter().filter(|span| narrowest <= 0.0 || span.width() >= narrowest) {
            let (first, last) = (span.lo.ceil_at(m), span.hi.floor_at(m));
            if first <= last {
                hidden(first, last);
            }
        }
    }

    /// Adds the directions that shell `m` blocks, and sorts `new` for that. Costs the intervals of
    /// both.
    pub(super) fn add(&mut self, new: &mut [Span], m: i32) {
        if new.is_empty() {
            return;
        }
        new.sort_unstable_by(|a, b| a.lo.cmp(b.lo));
        self.merged.clear();
        let (mut old, mut new) = (self.spans.iter().peekable(), new.iter().peekable());
        while let Some(&next) = match (old.peek(), new.peek()) {
            (Some(a), Some(b)) if a.lo.cmp(b.lo).is_gt() => new.next(),
            (Some(_), _) => old.next(),
            (None, _) => new.next(),
        } {
            match self.merged.last_mut() {
                Some(last) if next.lo.cmp(last.hi).is_le() => {
                    if next.hi.cmp(last.hi).is_gt() {
                        last.hi = next.hi;
                    }
                }
                _ => self.merged.push(next),
            }
        }
        std::mem::swap(&mut self.spans, &mut self.merged);
        self.limit(m);
    }

    /// Drops the narrowest intervals where there are more than a shell of so many cells is worth: a
    /// walk must not cost more than the cells of the grid. All directions are 2 wide, so at most 4m
    /// disjoint intervals are as wide as 1/2m.
    fn limit(&mut self, m: i32) {
        if self.spans.len() > FEW + 4 * m as usize {
            self.spans.retain(|span| span.width() >= 0.5 / f64::from(m));
        }
    }

    /// The number of intervals.
    #[cfg(test)]
    fn len(&self) -> usize {
        self.spans.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn span(lo: (i32, i32), hi: (i32, i32)) -> Span {
        Span { lo: Slope::new(lo.0, lo.1), hi: Slope::new(hi.0, hi.1) }
    }

    fn runs(mask: &DirectionMask, m: i32, narrowest: f64) -> Vec<(i32, i32)> {
        let mut runs = Vec::new();
        mask.hidden(m, narrowest, |a, b| runs.push((a, b)));
        runs
    }

    #[test]
    fn intervals_that_meet_become_one() {
        let mut mask = DirectionMask::default();
        mask.add(&mut [span((1, 2), (3, 4)), span((-1, 3), (-1, 3))], 4);
        // One ends in an equal fraction, one lies inside, one apart.
        mask.add(&mut [span((5, 6), (1, 1)), span((2, 8), (2, 4)), span((3, 5), (2, 3))], 8);
        assert_eq!(mask.len(), 3);
        assert_eq!(runs(&mask, 12, 0.0), [(-4, -4), (3, 9), (10, 12)]);
        assert_eq!(runs(&mask, 7, 0.0), [(2, 5), (6, 7)]);
        assert_eq!(runs(&mask, 12, 0.2), [(3, 9)]);
    }

    #[test]
    fn lines_are_rounded_into_the_interval() {
        for depth in 1..9 {
            for line in -depth..=depth {
                for m in 1..20 {
                    let slope = Slope::new(line, depth);
                    let (floor, ceil) = (slope.floor_at(m), slope.ceil_at(m));
                    assert!(floor * depth <= line * m && line * m < (floor + 1) * depth);
                    assert!(ceil * depth >= line * m && line * m > (ceil - 1) * depth);
                }
            }
        }
    }

    #[test]
    fn a_crowd_of_intervals_loses_the_narrowest() {
        let mut mask = DirectionMask::default();
        let mut new: Vec<_> = (1..2000).map(|i| span((i, 5003), (i, 5003))).collect();
        new.push(span((-1, 2), (0, 1)));
        mask.add(&mut new, 10);
        assert_eq!(runs(&mask, 10, 0.0), [(-5, 0)]);
    }
}
