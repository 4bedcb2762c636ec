//! Solids that touch the eye: the directions into them are blocked at once.

use glam::DVec2;

use crate::geometry::{Shape, orient};
use crate::point::arcs::{Arcs, Circle, between};

/// The directions from an eye on the border of a solid into it; nothing for discs, which hide
/// nothing from eyes that may be inside.
pub(crate) fn into(shape: &Shape, circle: &Circle) -> Arcs {
    match shape {
        Shape::Rect(rect) if rect.min.cmplt(rect.max).all() => {
            into_ring(&rect.corners().map(|p| p.as_dvec2()), circle)
        }
        Shape::Polygon(polygon) => {
            let corners: Vec<DVec2> = polygon.corners().iter().map(|p| p.as_dvec2()).collect();
            into_ring(&corners, circle)
        }
        _ => Arcs::new(),
    }
}

/// As [`into`], for a convex ring that runs counterclockwise.
fn into_ring(corners: &[DVec2], circle: &Circle) -> Arcs {
    let (eye, count) = (circle.eye, corners.len());
    for i in 0..count {
        let (before, at, after) = (corners[(i + count - 1) % count], corners[i], corners[(i + 1) % count]);
        if at == eye {
            return between(circle, after, before).collect();
        }
        let on_side = orient(at, after, eye) == 0.0 && (eye - at).dot(after - eye) > 0.0;
        if on_side {
            return between(circle, after, at).collect();
        }
    }
    Arcs::new()
}
