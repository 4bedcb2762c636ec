//! What the experiments of this section share.

use casca::Method;

use super::measure::{Row, Walks, measure};
use crate::experiments::{Effort, Lab, LabError, grouped};
use casca_scenes::world::World;

/// The lab, and how far the sizes go: a full run has a million objects and ten million triangles.
pub(super) struct Bench<'a> {
    pub(super) lab: &'a Lab<'a>,
    pub(super) effort: Effort,
}

impl Bench<'_> {
    /// The sizes of a smoke run, of a short run, and those that a full run adds.
    pub(super) fn sizes<const A: usize, const B: usize, const C: usize>(
        &self,
        quick: [usize; A],
        short: [usize; B],
        more: [usize; C],
    ) -> Vec<usize> {
        match self.effort {
            Effort::Quick => quick.to_vec(),
            Effort::Short => short.to_vec(),
            Effort::Full => short.into_iter().chain(more).collect(),
        }
    }

    /// Views and runs.
    pub(super) fn walks(&self) -> Walks {
        match self.effort {
            Effort::Quick => Walks { views: 2, repeats: 1 },
            Effort::Short => Walks { views: 20, repeats: 2 },
            Effort::Full => Walks { views: 100, repeats: 3 },
        }
    }

    /// Measures the worlds of several sizes; the sizes are what the rows are about.
    pub(super) fn series(
        &self,
        name: &str,
        sizes: &[usize],
        build: impl Fn(usize) -> World,
    ) -> Result<Vec<Row>, LabError> {
        let mut rows = Vec::new();
        for &size in sizes {
            (self.lab.progress)(&format!("{name}: {}", grouped(size)));
            rows.push(measure(&build(size), size as f64, Method::point(), self.walks())?);
        }
        Ok(rows)
    }
}
