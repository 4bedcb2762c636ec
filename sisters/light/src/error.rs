//! Why there is no light.

use std::ops::RangeInclusive;

use glam::Vec3;

use crate::numeric::{BRIGHTEST, MOST_RAYS, MOST_REFERENCES, MOST_STORED};

/// Why a scene cannot be lit, or a question cannot be answered.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LightError {
    /// A box that is empty, or not finite.
    #[error("the grid's box from {min:?} to {max:?} is empty, or not finite")]
    Box {
        /// Its least corner, in metres.
        min: [f32; 3],
        /// Its greatest corner, in metres.
        max: [f32; 3],
    },
    /// Cells of a window that are too fine, or not by a power of two.
    #[error(
        "cells of window {index} are {finer} times finer than those around it: possible are powers of two, {most} times at most"
    )]
    Finer {
        /// The window.
        index: usize,
        /// How many times finer.
        finer: u32,
        /// The most there: 1 if the cells around are as fine as can be.
        most: u32,
    },
    /// A material, texture or object that the scene does not have.
    #[error("{of} names {what} {number}; there are {count}")]
    Missing {
        /// What names it.
        of: String,
        /// What it is.
        what: &'static str,
        /// Its number, which starts at 0.
        number: usize,
        /// How many there are.
        count: usize,
    },
    /// A texture without texels, or with more or fewer than its sides say.
    #[error("a texture of {width} x {height} has {texels} texels")]
    Texels {
        /// Its texels in a row.
        width: u32,
        /// Its rows.
        height: u32,
        /// How many came.
        texels: usize,
    },
    /// A number that is not finite or not in its range.
    #[error("{what} {index}: {value} is not within {low} and {high}")]
    Value {
        /// What it belongs to.
        what: &'static str,
        /// Its index among its kind; 0 for what there is one of.
        index: usize,
        /// The number.
        value: f32,
        /// The least.
        low: f32,
        /// The greatest.
        high: f32,
    },
    /// A direction without length, or not finite.
    #[error("{what} {index}: {value:?} is no direction")]
    Direction {
        /// What it belongs to.
        what: &'static str,
        /// Its index among its kind.
        index: usize,
        /// The vector.
        value: [f32; 3],
    },
    /// The surfaces touch too many cells.
    #[error("the triangles touch cells more than {MOST_REFERENCES} times; fewer cells take less")]
    TooManyReferences,
    /// Too many rays would be stored.
    #[error("{rays} rays would be stored, but {MOST_STORED} can be; fewer rays or cells take less")]
    TooManyRays {
        /// How many.
        rays: usize,
    },
}

/// Refuses vectors with a component out of a range.
pub(crate) fn numbers(
    what: &'static str,
    index: usize,
    v: Vec3,
    range: RangeInclusive<f32>,
) -> Result<(), LightError> {
    let (low, high) = (*range.start(), *range.end());
    let wrong = v.to_array().into_iter().find(|c| !range.contains(c));
    wrong.map_or(Ok(()), |value| Err(LightError::Value { what, index, value, low, high }))
}

/// Refuses light that is negative, too bright or not finite.
pub(crate) fn bright(what: &'static str, index: usize, v: Vec3) -> Result<(), LightError> {
    numbers(what, index, v, 0.0..=BRIGHTEST)
}

/// Refuses numbers of rays that no state or question sends.
pub(crate) fn some_rays(what: &'static str, rays: u32) -> Result<(), LightError> {
    numbers(what, 0, Vec3::splat(rays as f32), 1.0..=MOST_RAYS as f32)
}

/// Refuses vectors that are no direction.
pub(crate) fn way(what: &'static str, index: usize, v: Vec3) -> Result<(), LightError> {
    let is_one = v.as_dvec3().try_normalize().is_some() && v.is_finite();
    if is_one { Ok(()) } else { Err(LightError::Direction { what, index, value: v.to_array() }) }
}
