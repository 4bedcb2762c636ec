//! Objects that are drawn over the tiles: places, walls of any form, and doors.

use std::borrow::Cow;
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use glam::{DMat2, DVec2, Vec2};

use super::TmxError;
use super::parts::Space;
use super::tileset::{Alignment, Opaque, Tilesets, properties};
use super::xml::{Element, Xml};
use crate::editor::{FARTHEST, Inventory, Role, Rule, Says};
use crate::error::Error;
use crate::geometry::ellipse::ellipse;
use crate::geometry::{ConvexPolygon, Disc, Polyline, Rect, Segment, Shape};
use crate::numeric::ROUND;
use crate::object::ObjectDesc;

/// Letters of a file that a reason shows.
const MOST_LETTERS: usize = 40;

/// An object of a map: see [`TmxMap::objects`](super::TmxMap::objects).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct TmxObject {
    /// Its number in the map; 0 if the file gives none.
    pub id: u32,
    /// Its name, often empty.
    pub name: String,
    /// Its class, or type as some versions of the editor say; that of its tile if it has none.
    pub class: Arc<str>,
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

/// What is amiss with an object.
type Why = Cow<'static, str>;

/// What all objects of a layer share.
pub(super) struct ObjectLayer<'l> {
    pub space: &'l Space,
    pub tilesets: &'l Tilesets,
    pub rule: &'l Rule,
    pub name: Arc<str>,
    /// Its shift in pixels, that of its groups included.
    pub shift: [f64; 2],
    /// The role that it gives to its objects, if it gives one.
    pub role: Option<Role>,
}

/// An object as its element has it.
struct Draft {
    name: String,
    /// Empty where it says nothing.
    class: Arc<str>,
    /// In pixels.
    at: DVec2,
    size: [Option<f64>; 2],
    /// In degrees.
    rotation: f64,
    /// The tile of an object with a picture.
    tile: Option<u32>,
    form: Form,
    says: Says,
}

/// The form of an object in the file.
#[derive(Debug, PartialEq)]
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
    /// Reads the objects of a layer, from behind its start, and gives how many are made of
    /// templates: these are passed over, as texts are. `fault` is told the id of an object and what
    /// is amiss with it.
    pub fn read(
        &self,
        xml: &mut Xml<'_>,
        objects: &mut Vec<TmxObject>,
        names: &mut Inventory,
        fault: &mut dyn FnMut(u32, Why),
    ) -> Result<u64, TmxError> {
        let mut templates = 0;
        while let Some(child) = xml.child()? {
            if child.local_name().as_ref() != b"object" {
                xml.skip(&child)?;
                continue;
            }
            if xml.attribute(&child, "template")?.is_some() {
                templates += 1;
                xml.skip(&child)?;
                continue;
            }
            let id = xml.attribute(&child, "id")?.and_then(|id| id.trim().parse().ok()).unwrap_or(0);
            let mut faults = Vec::new();
            let draft = Draft::read(xml, &child, self.rule, names, &mut faults)?;
            match draft.and_then(|draft| self.object(draft, id, &mut faults)) {
                Ok(object) => objects.extend(object),
                Err(why) => faults.push(why),
            }
            faults.into_iter().for_each(|why| fault(id, why));
        }
        Ok(templates)
    }

    /// The object of an element. `None` for a text.
    fn object(&self, draft: Draft, id: u32, faults: &mut Vec<Why>) -> Result<Option<TmxObject>, Why> {
        if draft.form == Form::Text {
            return Ok(None);
        }
        let tile = match draft.tile {
            Some(id) => Some(
                self.tilesets.find(id).ok_or_else(|| left_out(format!("no tileset has its tile {id}")))?,
            ),
            None => None,
        };
        let [bounds, occluder] = self.shapes(&draft, tile)?;
        let class_counts = draft.class.is_empty();
        let of_tile = tile.map(|(set, number)| set.says(number, class_counts)).unwrap_or_default();
        let says = draft.says.or(self.rule.role(&draft.class).into()).or(of_tile);
        let role = says.role().or(self.role).unwrap_or_default();
        let is_point = matches!(&bounds, Shape::Disc(disc) if disc.radius == 0.0);
        if is_point && (draft.form != Form::Point || role != Role::Plain) {
            faults.push("it has no size, and hides nothing".into());
        }
        let class = Some(draft.class).filter(|_| !class_counts);
        let class = class.or_else(|| tile.and_then(|(set, number)| set.class(number)));
        Ok(Some(TmxObject {
            id,
            name: draft.name,
            class: class.unwrap_or_default(),
            layer: self.name.clone(),
            role,
            bounds,
            occluder: (role != Role::Plain && !is_point).then_some(occluder),
        }))
    }

    /// The shape around an object, and that in it.
    fn shapes(&self, draft: &Draft, tile: Option<(&Opaque, u32)>) -> Result<[Shape; 2], Why> {
        let [mut turn, screen] = [draft.turn(), self.space.screen()];
        let at = screen * draft.at + DVec2::from_array(self.shift);
        let [width, height] = draft.size;
        let (mut least, mut size) = (DVec2::ZERO, DVec2::new(width.unwrap_or(0.0), height.unwrap_or(0.0)));
        match tile {
            // Pictures lie along the screen, also in isometric maps.
            Some((set, number)) => {
                let (alignment, own) = set.picture(number);
                size = DVec2::new(width.unwrap_or(own[0]), height.unwrap_or(own[1]));
                let Alignment(share) = alignment.unwrap_or(match self.space.isometric {
                    true => Alignment::BOTTOM,
                    false => Alignment::BOTTOM_LEFT,
                });
                least = -DVec2::from_array(share) * size;
            }
            None => turn *= screen,
        }
        // Also false for what is not a number.
        let near = |p: DVec2| p.abs().cmple(DVec2::splat(FARTHEST as f64)).all();
        let place = |p: DVec2| match DVec2::from_array(self.space.tiles((at + turn * p).to_array())) {
            p if near(p) => Ok(p.as_vec2()),
            p => Err(left_out(format!("{} and {} tiles are too far away", p.x, p.y))),
        };
        let places = |all: &[DVec2]| all.iter().map(|&p| place(p)).collect::<Result<Vec<Vec2>, Why>>();
        let few = |points: &[DVec2]| left_out(format!("{} points make no such shape", points.len()));
        let both = |shape: Shape| [shape.clone(), shape];
        let shapes = match &draft.form {
            Form::Point | Form::Text => Ok(both(Disc::new(place(DVec2::ZERO)?, 0.0).into())),
            // Old versions of the editor have no other points.
            Form::Box | Form::Ellipse if size == DVec2::ZERO => {
                Ok(both(Disc::new(place(least)?, 0.0).into()))
            }
            Form::Box => {
                let corners = [DVec2::ZERO, DVec2::X * size.x, size, DVec2::Y * size.y];
                rectangle(places(&corners.map(|corner| least + corner))?)
            }
            Form::Ellipse => {
                let center = least + size / 2.0;
                let axes = [DVec2::X * size.x / 2.0, DVec2::Y * size.y / 2.0];
                let [a, b] = axes.map(|axis| DVec2::from_array(self.space.tiles((turn * axis).to_array())));
                let ends = places(&[center, center - axes[0] - axes[1], center + axes[0] + axes[1]])?;
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
        shapes.map_err(|why| left_out(why.to_string()))
    }
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

impl Draft {
    /// Reads an object, from behind its start to behind its end. Errors of the file are around what
    /// is amiss with the object.
    fn read(
        xml: &mut Xml<'_>,
        element: &Element<'_>,
        rule: &Rule,
        names: &mut Inventory,
        faults: &mut Vec<Why>,
    ) -> Result<Result<Self, Why>, TmxError> {
        let name = xml.attribute(element, "name")?.unwrap_or_default().into_owned();
        // Version 1.9 of the editor says `class`, those before and after it `type`.
        let kind = xml.attribute(element, "type")?.filter(|kind| !kind.is_empty());
        let class: Arc<str> = kind.or(xml.attribute(element, "class")?).unwrap_or_default().into();
        names.add_name(&class);
        let mut wrong = None;
        let mut numbers = [None; 5];
        for (number, attribute) in numbers.iter_mut().zip(["x", "y", "width", "height", "rotation"]) {
            let Some(text) = xml.attribute(element, attribute)? else { continue };
            let is_size = attribute == "width" || attribute == "height";
            *number = finite(&text).filter(|v| !is_size || *v >= 0.0);
            if number.is_none() {
                wrong = wrong.or(Some(no_number(attribute, &text)));
            }
        }
        let gid = xml.attribute(element, "gid")?;
        let tile = gid.as_ref().and_then(|text| text.trim().parse().ok());
        if let (Some(text), None) = (&gid, tile) {
            wrong = wrong.or(Some(no_number("gid", text)));
        }
        let (mut form, mut says) = (Ok(Form::Box), Says::default());
        while let Some(child) = xml.child()? {
            match child.local_name().as_ref() {
                b"properties" => {
                    let neither = |name: String, kind: String| {
                        let (name, kind) = (shortened(&name), shortened(&kind));
                        faults.push(
                            format!("its property {name}, of the type {kind}, is neither true nor false")
                                .into(),
                        );
                    };
                    says = properties(xml, rule, names, neither)?;
                    continue;
                }
                b"ellipse" => form = Ok(Form::Ellipse),
                b"point" => form = Ok(Form::Point),
                b"polygon" => form = points(xml, &child)?.map(Form::Polygon),
                b"polyline" => form = points(xml, &child)?.map(Form::Polyline),
                b"text" => form = Ok(Form::Text),
                other => {
                    let name = shortened(&String::from_utf8_lossy(other));
                    form = Err(left_out(format!("the shape {name} is not known")));
                }
            }
            xml.skip(&child)?;
        }
        // Nothing is amiss with texts, for they are passed over.
        let form = match (form, wrong) {
            (Ok(Form::Text), _) => Form::Text,
            (Ok(form), None) => form,
            (_, Some(why)) | (Err(why), None) => return Ok(Err(why)),
        };
        let [x, y, width, height, rotation] = numbers;
        let at = DVec2::new(x.unwrap_or(0.0), y.unwrap_or(0.0));
        let (size, rotation) = ([width, height], rotation.unwrap_or(0.0));
        Ok(Ok(Self { name, class, at, size, rotation, tile, form, says }))
    }

    /// How it is turned on the screen about its place.
    fn turn(&self) -> DMat2 {
        let angle = self.rotation.rem_euclid(360.0);
        let quarters = angle / 90.0;
        let (mut sin, mut cos) = (quarters * FRAC_PI_2).sin_cos();
        if quarters.fract() == 0.0 {
            // Right angles keep rectangles along the axes.
            (sin, cos) = (sin.round(), cos.round());
        }
        // Clockwise, for y goes down.
        DMat2::from_cols(DVec2::new(cos, sin), DVec2::new(-sin, cos))
    }
}

/// Pairs of numbers: `x,y x,y`.
fn points(xml: &Xml<'_>, element: &Element<'_>) -> Result<Result<Vec<DVec2>, Why>, TmxError> {
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

fn no_number(attribute: &str, value: &str) -> Why {
    left_out(format!("{attribute}=\"{}\" is no number that is read", shortened(value)))
}

fn left_out(why: String) -> Why {
    format!("{why}: it is left out").into()
}

fn shortened(text: &str) -> String {
    text.chars().take(MOST_LETTERS).collect()
}
