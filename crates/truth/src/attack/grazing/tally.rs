//! What was tried, and what was lost.

use std::collections::BTreeMap;
use std::fmt;

use super::super::solid::Answer;

/// Answers about points, of one way to ask and one shape.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Count {
    /// Points asked for, in each set that was found.
    pub tried: u64,
    /// Those that are seen for sure.
    pub seen: u64,
    /// Those of which the truth cannot be told.
    pub open: u64,
    /// Those that are seen, but of no object in the set.
    pub lost: u64,
    /// Those that are hidden, and of no object in the set: the rest is in the sets as neighbours of
    /// what is seen.
    pub culled: u64,
}

/// Answers, by the way to ask and by shape.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Tally {
    /// By the name of the way and that of the shape.
    pub counts: BTreeMap<(&'static str, &'static str), Count>,
    /// Scenes.
    pub scenes: u64,
}

impl Count {
    /// Notes an answer of the library beside the truth.
    pub(super) fn note(&mut self, truth: Answer, held: bool) {
        self.tried += 1;
        match truth {
            Answer::Cut => self.culled += u64::from(!held),
            Answer::Doubt => self.open += 1,
            Answer::Free => {
                self.seen += 1;
                self.lost += u64::from(!held);
            }
        }
    }

    /// Adds other counts.
    pub(super) fn add(&mut self, other: &Self) {
        self.tried += other.tried;
        self.seen += other.seen;
        self.open += other.open;
        self.lost += other.lost;
        self.culled += other.culled;
    }
}

impl Tally {
    /// The counts of one way and shape.
    pub fn of(&mut self, way: &'static str, shape: &'static str) -> &mut Count {
        self.counts.entry((way, shape)).or_default()
    }

    /// Adds the counts of other scenes.
    pub fn add(&mut self, other: &Self) {
        for (key, count) in &other.counts {
            self.counts.entry(*key).or_default().add(count);
        }
        self.scenes += other.scenes;
    }

    /// All ways and shapes together.
    pub fn total(&self) -> Count {
        self.sum(|_| true)
    }

    /// All shapes of one way.
    pub fn way(&self, way: &str) -> Count {
        self.sum(|key| key.0 == way)
    }

    /// All ways of one shape.
    pub fn shape(&self, shape: &str) -> Count {
        self.sum(|key| key.1 == shape)
    }

    fn sum(&self, which: impl Fn(&(&str, &str)) -> bool) -> Count {
        let mut sum = Count::default();
        self.counts.iter().filter(|(key, _)| which(key)).for_each(|(_, count)| sum.add(count));
        sum
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "{:<28}{:>14}{:>14}{:>12}{:>14}{:>8}", "", "points", "seen", "open", "culled", "lost")?;
        let mut row = |name: &str, c: Count| {
            writeln!(f, "{name:<28}{:>14}{:>14}{:>12}{:>14}{:>8}", c.tried, c.seen, c.open, c.culled, c.lost)
        };
        let mut names: Vec<&str> = self.counts.keys().map(|key| key.0).collect();
        names.dedup();
        names.into_iter().try_for_each(|way| row(way, self.way(way)))?;
        let mut names: Vec<&str> = self.counts.keys().map(|key| key.1).collect();
        names.sort_unstable();
        names.dedup();
        names.into_iter().try_for_each(|shape| row(shape, self.shape(shape)))?;
        row("all", self.total())
    }
}
