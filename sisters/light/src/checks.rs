//! Checks of what goes in.

use std::ops::RangeInclusive;

use glam::Vec3;

use crate::error::LightError;
use crate::numeric::BRIGHTEST;

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

/// Refuses vectors that are no direction.
pub(crate) fn way(what: &'static str, index: usize, v: Vec3) -> Result<(), LightError> {
    let is_one = v.as_dvec3().try_normalize().is_some() && v.is_finite();
    if is_one { Ok(()) } else { Err(LightError::Direction { what, index, value: v.to_array() }) }
}
