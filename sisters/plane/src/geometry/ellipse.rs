//! Ellipses as polygons.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, Vec2};

use super::{ConvexPolygon, DISC_SIDES, Segment, Shape};
use crate::error::Error;

/// A polygon in an ellipse and one around it; a wall if rounding leaves no area.
pub(crate) fn ellipse(center: Vec2, axes: [DVec2; 2]) -> Result<[Shape; 2], Error> {
    let polygon = |scale: f64| {
        let corners: [Vec2; DISC_SIDES] = std::array::from_fn(|i| {
            let (sin, cos) = (TAU * i as f64 / DISC_SIDES as f64).sin_cos();
            (center.as_dvec2() + (axes[0] * cos + axes[1] * sin) * scale).as_vec2()
        });
        ConvexPolygon::new(&corners)
    };
    // Sides around a circle touch it in their middles.
    let polygons = polygon(1.0).and_then(|inner| Ok([inner, polygon(1.0 / (PI / DISC_SIDES as f64).cos())?]));
    match polygons {
        Err(Error::FlatPolygon { .. }) => {
            let long = if axes[0].length() > axes[1].length() { axes[0] } else { axes[1] };
            let [a, b] = [-long, long].map(|to| (center.as_dvec2() + to).as_vec2());
            Ok([Segment::new(a, b).into(), Segment::new(a, b).into()])
        }
        polygons => polygons.map(|both| both.map(Shape::from)),
    }
}
