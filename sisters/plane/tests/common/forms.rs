//! Random shapes, for the library and for the oracle.

use casca_plane::{ConvexPolygon, Disc, Polyline, Rect, Segment, Shape};
use glam::Vec2;
use proptest::prelude::*;

use crate::oracle::{Form, Point, number};

fn points(points: &[Vec2]) -> Vec<Point> {
    points.iter().map(|&p| Point::of(p)).collect()
}

/// A shape as the oracle looks for it.
pub fn target(shape: &Shape) -> Form {
    match shape {
        Shape::Disc(disc) => Form::Disc(Point::of(disc.center), number(disc.radius.into())),
        _ => occluder(shape),
    }
}

/// A shape as it blocks.
pub fn occluder(shape: &Shape) -> Form {
    match shape {
        // As documented: by the polygon inside.
        Shape::Disc(disc) => Form::Solid(points(&disc.polygon())),
        Shape::Rect(rect) if rect.min.cmplt(rect.max).all() => Form::Solid(points(&rect.corners())),
        Shape::Rect(rect) => Form::Chain(points(&[rect.min, rect.max])),
        Shape::Polygon(polygon) => Form::Solid(points(polygon.corners())),
        Shape::Segment(s) => Form::Chain(points(&[s.a, s.b])),
        Shape::Polyline(line) => Form::Chain(points(line.points())),
        _ => unreachable!("all shapes are listed"),
    }
}

/// A shape with corners from a strategy of points.
pub fn shape(point: impl Strategy<Value = Vec2> + Clone + 'static, discs: bool) -> BoxedStrategy<Shape> {
    let pair = (point.clone(), point.clone());
    let segment = pair.clone().prop_map(|(a, b)| Segment::new(a, b).into());
    let rect = pair.clone().prop_map(|(a, b)| Rect::new(a.min(b), a.max(b)).into());
    let some = proptest::collection::vec(point.clone(), 3..6);
    let polygon = some.clone().prop_filter_map("flat", |p| ConvexPolygon::new(&p).ok().map(Shape::from));
    let chain = some.prop_map(|p| Polyline::new(&p).expect("3 points at least").into());
    let disc = pair.prop_map(|(a, b)| Disc::new(a, (b - a).length() / 2.0).into());
    if discs {
        prop_oneof![3 => segment, 2 => rect, 1 => polygon, 1 => chain, 2 => disc].boxed()
    } else {
        prop_oneof![4 => segment, 2 => rect, 1 => polygon, 1 => chain].boxed()
    }
}
