//! Objects of maps in scenes.

use glam::{DVec2, Vec2};

use super::object::TmxObject;
use super::shape::TmxShape;
use crate::editor::{Placed, Role};
use crate::error::{Error, finite2, not_negative};
use crate::geometry::ellipse::ellipse;
use crate::geometry::{ConvexPolygon, Disc, Polyline, Rect, Shape};
use crate::scene::Scene;

impl TmxObject {
    /// Adds the object to a scene as fixed ones: walls and closed doors with occluders. Its
    /// [`id`](Self::id) is their [`Scene::user_data`]. The tile `(0, 0)` of the map, as the editor
    /// counts, has its least corner at `origin`; `tile_size` is the side of a tile in world units.
    ///
    /// Points are discs of radius 0. Polygons become convex parts ([`ConvexPolygon::split`]); those
    /// that cannot be split become rings of walls, which hide from
    /// [`Method::Point`](crate::Method::Point) only, as polylines do. Ellipses hide as polygons of
    /// [`DISC_SIDES`](crate::DISC_SIDES) sides that lie inside, and are seen as polygons around
    /// them, both up to the rounding of coordinates. Costs as [`Scene::insert`] for each part, and
    /// the square of the corners of a polygon.
    ///
    /// # Errors
    /// An origin that is not finite, a size that is not finite or is negative, and those of
    /// [`Scene::insert`]. Nothing is added then.
    pub fn insert(&self, scene: &mut Scene, origin: Vec2, tile_size: f32) -> Result<Placed, Error> {
        Placed::insert(scene, self.parts(origin, tile_size)?, self.id.into())
    }

    /// The shapes that [`Self::insert`] adds, with the occluders of walls and closed doors.
    ///
    /// # Errors
    /// As [`Self::insert`]; coordinates of discs and rectangles are not looked at.
    pub fn parts(&self, origin: Vec2, tile_size: f32) -> Result<Vec<(Shape, Option<Shape>)>, Error> {
        parts(&self.shape, self.role != Role::Plain, (origin, DVec2::ZERO), tile_size)
    }
}

/// The parts of a shape in a scene, with their occluders if it hides. Its coordinates count from
/// `place`, in tiles.
pub(in crate::tmx) fn parts(
    shape: &TmxShape,
    hides: bool,
    (origin, place): (Vec2, DVec2),
    tile_size: f32,
) -> Result<Vec<(Shape, Option<Shape>)>, Error> {
    finite2("the origin of the map", origin)?;
    not_negative("the size of a tile", tile_size)?;
    let at = |p: Vec2| (origin.as_dvec2() + (place + p.as_dvec2()) * f64::from(tile_size)).as_vec2();
    let both = |shape: Shape| (shape.clone(), hides.then_some(shape));
    Ok(match shape {
        TmxShape::Point(p) => vec![(Disc::new(at(*p), 0.0).into(), None)],
        TmxShape::Rect(rect) => vec![both(Rect::new(at(rect.min), at(rect.max)).into())],
        TmxShape::Disc(disc) => vec![both(Disc::new(at(disc.center), disc.radius * tile_size).into())],
        TmxShape::Ellipse { center, axes } => {
            let axes = axes.map(|axis| axis.as_dvec2() * f64::from(tile_size));
            let [inner, outer] = ellipse(at(*center), axes)?;
            vec![(outer, hides.then_some(inner))]
        }
        TmxShape::Polyline(points) => {
            let points: Vec<Vec2> = points.iter().map(|&p| at(p)).collect();
            vec![both(Polyline::new(&points)?.into())]
        }
        TmxShape::Polygon(corners) => {
            let mut corners: Vec<Vec2> = corners.iter().map(|&p| at(p)).collect();
            match ConvexPolygon::split(&corners) {
                Ok(parts) => parts.into_iter().map(|part| both(part.into())).collect(),
                Err(_) => {
                    corners.extend(corners.first().copied());
                    vec![both(Polyline::new(&corners)?.into())]
                }
            }
        }
    })
}
