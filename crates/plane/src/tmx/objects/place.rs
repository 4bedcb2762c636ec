//! Objects of maps in scenes.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, Vec2};

use super::object::{TmxObject, TmxRole};
use super::shape::TmxShape;
use crate::error::{Error, finite2, not_negative};
use crate::geometry::{ConvexPolygon, DISC_SIDES, Disc, Polyline, Rect, Segment, Shape};
use crate::id::ObjectId;
use crate::object::ObjectDesc;
use crate::scene::Scene;

/// An object of a map in a scene: see [`TmxObject::insert`].
#[derive(Debug, Clone, PartialEq)]
pub struct TmxPlaced {
    /// The parts, with the occluders that they have while the object hides.
    parts: Vec<(ObjectId, Option<Shape>)>,
}

impl TmxPlaced {
    /// Its objects in the scene: more than one for a polygon that is not convex.
    pub fn ids(&self) -> impl Iterator<Item = ObjectId> {
        self.parts.iter().map(|(id, _)| *id)
    }

    /// Closes or opens a door: all its parts hide, or none does. Walls are opened in the same way;
    /// objects that hide nothing do not change. Costs as [`Scene::set_occluder`] for each part.
    ///
    /// # Errors
    /// [`Error::UnknownObject`] if a part was removed or belongs to another scene. Nothing changes
    /// then.
    pub fn set_closed(&self, scene: &mut Scene, closed: bool) -> Result<(), Error> {
        self.parts.iter().try_for_each(|(id, _)| scene.bounds(*id).map(drop))?;
        for (id, occluder) in self.parts.iter().filter(|(_, occluder)| occluder.is_some()) {
            if scene.occluder(*id)?.is_some() != closed {
                scene.set_occluder(*id, occluder.clone().filter(|_| closed))?;
            }
        }
        Ok(())
    }
}

impl TmxObject {
    /// Adds the object to a scene as fixed ones: walls and closed doors with occluders. Its
    /// [`id`](Self::id) is their [`Scene::user_data`]. The tile `(0, 0)` of the map, as the editor
    /// counts, has its least corner at `origin`; `tile_size` is the side of a tile in world units.
    ///
    /// Points are discs of radius 0. Polygons become convex parts ([`ConvexPolygon::split`]); those
    /// that cannot be split become rings of walls, which hide from
    /// [`Method::Point`](crate::Method::Point) only, as polylines do. Ellipses hide as polygons of
    /// [`DISC_SIDES`] sides that lie inside, and are seen as polygons around them, both up to the
    /// rounding of coordinates. Costs as [`Scene::insert`] for each part, and the square of the
    /// corners of a polygon.
    ///
    /// # Errors
    /// An origin that is not finite, a size that is not finite or is negative, and those of
    /// [`Scene::insert`]. Nothing is added then.
    pub fn insert(&self, scene: &mut Scene, origin: Vec2, tile_size: f32) -> Result<TmxPlaced, Error> {
        let mut placed = TmxPlaced { parts: Vec::new() };
        for (bounds, occluder) in self.parts(origin, tile_size)? {
            let mut desc = ObjectDesc::fixed(bounds).user_data(self.id.into());
            if let Some(occluder) = &occluder {
                desc = desc.occluder(occluder.clone());
            }
            match scene.insert(desc) {
                Ok(id) => placed.parts.push((id, occluder)),
                Err(error) => {
                    placed.ids().try_for_each(|id| scene.remove(id))?;
                    return Err(error);
                }
            }
        }
        Ok(placed)
    }

    /// The shapes that [`Self::insert`] adds, with the occluders of walls and closed doors.
    ///
    /// # Errors
    /// As [`Self::insert`]; coordinates of discs and rectangles are not looked at.
    pub fn parts(&self, origin: Vec2, tile_size: f32) -> Result<Vec<(Shape, Option<Shape>)>, Error> {
        finite2("the origin of the map", origin)?;
        not_negative("the size of a tile", tile_size)?;
        let at = |p: Vec2| (origin.as_dvec2() + p.as_dvec2() * f64::from(tile_size)).as_vec2();
        let hides = self.role != TmxRole::Plain;
        let both = |shape: Shape| (shape.clone(), hides.then_some(shape));
        Ok(match &self.shape {
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
}

/// A polygon in an ellipse and one around it; a wall if rounding leaves no area.
fn ellipse(center: Vec2, axes: [DVec2; 2]) -> Result<[Shape; 2], Error> {
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
