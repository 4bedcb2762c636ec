//! Objects that are drawn over the tiles: places, walls of any shape, and doors.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

use glam::{DMat2, DVec2, Vec2};

use super::above::Above;
use super::error::{FARTHEST, TmxError, shortened};
use super::names::{Role, Rule, Says};
use super::parts::Space;
use super::tileset::properties;
use super::xml::{Element, Xml};
use crate::error::Error;
use crate::geometry::{ConvexPolygon, DISC_SIDES, Disc, Polyline, Rect, Segment, Shape};
use crate::numeric::ROUND;
use crate::object::ObjectDesc;

/// An object of a map: see [`TmxMap::objects`](super::TmxMap::objects).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct TmxObject {
    /// Its number in the map; 0 if the file gives none.
    pub id: u32,
    /// Its name, often empty.
    pub name: String,
    /// Its class, or type as some versions of the editor say.
    pub class: String,
    /// The name of its layer.
    pub layer: Arc<str>,
    /// Whether it hides others.
    pub role: Role,
    /// A shape that holds it, in tiles: the disc of radius 0 of a place, the convex hull of a
    /// polygon, the polygon around an ellipse that is no circle.
    pub bounds: Shape,
    /// What hides, of walls and of doors while they are closed: the polygon of 32 sides in an
    /// ellipse; the ring of the sides of polygons that are not convex or cross themselves.
    pub occluder: Option<Shape>,
}

impl TmxObject {
    /// The object for a scene in which a tile is a world unit wide, closed if it is a door: it is
    /// opened by [`Scene::set_occluder`](crate::Scene::set_occluder). Its user data is its number.
    pub fn desc(&self) -> ObjectDesc {
        let desc = ObjectDesc::new(self.bounds.clone()).user_data(self.id.into());
        match &self.occluder {
            Some(occluder) => desc.occluder(occluder.clone()),
            None => desc,
        }
    }
}

/// What all objects of a layer share.
pub(super) struct ObjectLayer<'l> {
    pub space: &'l Space,
    pub rule: &'l Rule,
    pub name: Arc<str>,
    pub above: Above,
}

/// The form of an object in the file.
enum Form {
    /// No element: a rectangle.
    Box,
    Ellipse,
    Point,
    Polygon(Vec<DVec2>),
    Polyline(Vec<DVec2>),
    Text,
}

impl ObjectLayer<'_> {
    /// Reads the objects of a layer, from behind its start. Texts are passed over, as are pictures
    /// and what is made of templates.
    pub fn read(
        &self,
        xml: &mut Xml<'_>,
        objects: &mut Vec<TmxObject>,
        warnings: &mut Vec<String>,
    ) -> Result<(), TmxError> {
        let mut passed = 0;
        let layer = shortened(&self.name);
        while let Some(child) = xml.child()? {
            let is_object = child.local_name().as_ref() == b"object";
            let is_passed =
                xml.attribute(&child, "template")?.is_some() || xml.attribute(&child, "gid")?.is_some();
            if !is_object || is_passed {
                passed += u64::from(is_object);
                xml.skip(&child)?;
                continue;
            }
            let id = xml.attribute(&child, "id")?.and_then(|id| id.trim().parse().ok()).unwrap_or(0);
            match self.object(xml, &child, id)? {
                Ok(object) => {
                    if object
                        .as_ref()
                        .is_some_and(|object| object.role != Role::Plain && object.occluder.is_none())
                    {
                        let why =
                            format!("the object {id} of the layer {layer:?} has no size, and hides nothing");
                        warnings.push(why);
                    }
                    objects.extend(object);
                }
                Err(why) => {
                    let why = format!("the object {id} of the layer {layer:?} is left out: {why}");
                    warnings.push(why);
                }
            }
        }
        if passed > 0 {
            warnings.push(format!(
                "the layer {layer:?} has {passed} objects with pictures or of templates: these are not read, and \
                 hide nothing"
            ));
        }
        Ok(())
    }

    /// Reads an object, from behind its start to behind its end: `None` for a text, or why it is
    /// left out. Errors of the file are around that.
    fn object(
        &self,
        xml: &mut Xml<'_>,
        element: &Element<'_>,
        id: u32,
    ) -> Result<Result<Option<TmxObject>, String>, TmxError> {
        let name = xml.attribute(element, "name")?.unwrap_or_default().into_owned();
        // Version 1.9 of the editor says `class`, those before and after it `type`.
        let kind = xml.attribute(element, "type")?.filter(|kind| !kind.is_empty());
        let class = kind.or(xml.attribute(element, "class")?).unwrap_or_default().into_owned();
        let (mut numbers, mut wrong) = ([0.0; 5], None);
        for (number, attribute) in numbers.iter_mut().zip(["x", "y", "width", "height", "rotation"]) {
            let Some(text) = xml.attribute(element, attribute)? else { continue };
            let is_size = attribute == "width" || attribute == "height";
            match finite(&text).filter(|v| !is_size || *v >= 0.0) {
                Some(v) => *number = v,
                None => wrong = wrong.or(Some(no_number(attribute, &text))),
            }
        }
        let (mut form, mut says) = (Ok(Form::Box), Says::default());
        while let Some(child) = xml.child()? {
            match child.local_name().as_ref() {
                b"properties" => {
                    says = properties(xml, self.rule)?;
                    continue;
                }
                b"ellipse" => form = Ok(Form::Ellipse),
                b"point" => form = Ok(Form::Point),
                b"polygon" => form = points(xml, &child)?.map(Form::Polygon),
                b"polyline" => form = points(xml, &child)?.map(Form::Polyline),
                b"text" => form = Ok(Form::Text),
                other => {
                    let name = shortened(&String::from_utf8_lossy(other));
                    form = Err(format!("the shape {name} is not known"));
                }
            }
            xml.skip(&child)?;
        }
        let shapes = match (form, wrong) {
            (Ok(Form::Text), _) => return Ok(Ok(None)),
            (_, Some(why)) => Err(why),
            (form, None) => form.and_then(|form| self.shapes(&form, numbers)),
        };
        let says = says.or(self.rule.role(&class).into());
        let role = says.role().or(self.above.role).unwrap_or_default();
        Ok(shapes.map(|[bounds, occluder]| {
            let is_point = matches!(&bounds, Shape::Disc(disc) if disc.radius == 0.0);
            let occluder = (role != Role::Plain && !is_point).then_some(occluder);
            Some(TmxObject { id, name, class, layer: self.name.clone(), role, bounds, occluder })
        }))
    }

    /// The shape around an object, and that in it.
    fn shapes(&self, form: &Form, [x, y, width, height, rotation]: [f64; 5]) -> Result<[Shape; 2], String> {
        let screen = self.space.screen();
        let at = screen * DVec2::new(x, y) + DVec2::from_array(self.above.shift);
        let (turn, size) = (turn(rotation) * screen, DVec2::new(width, height));
        // Also false for what is not a number.
        let near = |p: DVec2| p.abs().cmple(DVec2::splat(FARTHEST as f64)).all();
        let place = |p: DVec2| match DVec2::from_array(self.space.tiles((at + turn * p).to_array())) {
            p if near(p) => Ok(p.as_vec2()),
            p => Err(format!("{} and {} tiles are too far away", p.x, p.y)),
        };
        let places = |all: &[DVec2]| all.iter().map(|&p| place(p)).collect::<Result<Vec<Vec2>, String>>();
        let few = |points: &[DVec2]| format!("{} points make no such shape", points.len());
        let both = |shape: Shape| [shape.clone(), shape];
        let shapes = match form {
            Form::Point | Form::Text => Ok(both(Disc::new(place(DVec2::ZERO)?, 0.0).into())),
            // Old versions of the editor have no other points.
            Form::Box | Form::Ellipse if size == DVec2::ZERO => {
                Ok(both(Disc::new(place(DVec2::ZERO)?, 0.0).into()))
            }
            Form::Box => rectangle(places(&[DVec2::ZERO, DVec2::X * size.x, size, DVec2::Y * size.y])?),
            Form::Ellipse => {
                let center = size / 2.0;
                let axes = [DVec2::X * size.x / 2.0, DVec2::Y * size.y / 2.0];
                let [a, b] = axes.map(|axis| DVec2::from_array(self.space.tiles((turn * axis).to_array())));
                let ends = places(&[center, DVec2::ZERO, size])?;
                let (long, short) = (a.length().max(b.length()), a.length().min(b.length()));
                if size.min_element() == 0.0 {
                    Ok(both(Segment::new(ends[1], ends[2]).into()))
                } else if long - short <= ROUND * long && a.dot(b).abs() <= ROUND * long * long {
                    Ok(both(Disc::new(ends[0], long as f32).into()))
                } else {
                    ellipse(ends[0], [a, b]).map(|[inner, outer]| [outer, inner])
                }
            }
            Form::Polygon(points) if points.len() < 3 => return Err(few(points)),
            Form::Polyline(points) if points.len() < 2 => return Err(few(points)),
            Form::Polygon(points) => polygon(places(points)?),
            Form::Polyline(points) => Polyline::new(&places(points)?).map(|line| both(line.into())),
        };
        shapes.map_err(|why| why.to_string())
    }
}

/// How an object is turned on the screen about its place, by an angle in degrees.
fn turn(rotation: f64) -> DMat2 {
    let quarters = rotation.rem_euclid(360.0) / 90.0;
    let (mut sin, mut cos) = (quarters * FRAC_PI_2).sin_cos();
    if quarters.fract() == 0.0 {
        // Right angles keep rectangles along the axes.
        (sin, cos) = (sin.round(), cos.round());
    }
    // Clockwise, for y goes down.
    DMat2::from_cols(DVec2::new(cos, sin), DVec2::new(-sin, cos))
}

/// The shapes of a rectangle by its corners.
fn rectangle(corners: Vec<Vec2>) -> Result<[Shape; 2], Error> {
    let [a, b, c, d] = corners[..] else { return polygon(corners) };
    let along = |a: Vec2, b: Vec2, c: Vec2, d: Vec2| a.y == b.y && b.x == c.x && c.y == d.y && d.x == a.x;
    if along(a, b, c, d) || along(b, c, d, a) {
        let rect = Shape::from(Rect::new(a.min(c), a.max(c)));
        return Ok([rect.clone(), rect]);
    }
    polygon(corners)
}

/// The shapes of a polygon: itself if it is convex, or else its hull and the ring of its sides.
fn polygon(mut points: Vec<Vec2>) -> Result<[Shape; 2], Error> {
    let hull = ConvexPolygon::new(&points);
    if let Ok(hull) = &hull
        && goes_round(hull.corners(), &points)
    {
        return Ok([hull.clone().into(), hull.clone().into()]);
    }
    points.extend(points.first().copied());
    let ring = Shape::from(Polyline::new(&points)?);
    Ok([hull.map_or_else(|_| ring.clone(), Shape::from), ring])
}

/// Whether points are these corners in their order, in either direction, from any of them on.
fn goes_round(corners: &[Vec2], points: &[Vec2]) -> bool {
    let count = points.len();
    let Some(first) = points.iter().position(|p| *p == corners[0]) else { return false };
    let forth = || (0..count).all(|i| points[(first + i) % count] == corners[i]);
    let back = || (0..count).all(|i| points[(first + count - i) % count] == corners[i]);
    count == corners.len() && (forth() || back())
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

/// Pairs of numbers: `x,y x,y`.
fn points(xml: &Xml<'_>, element: &Element<'_>) -> Result<Result<Vec<DVec2>, String>, TmxError> {
    let text = xml.attribute(element, "points")?.unwrap_or_default();
    let point = |pair: &str| {
        let (x, y) = pair.split_once(',')?;
        Some(DVec2::new(finite(x)?, finite(y)?))
    };
    let pairs = text.split_ascii_whitespace();
    Ok(pairs.map(|pair| point(pair).ok_or_else(|| no_number("points", pair))).collect())
}

fn finite(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|v: &f64| v.is_finite())
}

fn no_number(attribute: &str, value: &str) -> String {
    format!("{attribute}=\"{}\" is no number that is read", shortened(value))
}
