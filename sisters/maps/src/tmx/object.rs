//! Objects that are drawn over the tiles: places, walls of any shape, and doors.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

use casca_plane::{ConvexPolygon, DISC_SIDES, Disc, Error, ObjectDesc, Polyline, Rect, Segment, Shape};
use glam::{DMat2, DVec2, Vec2};

use super::element::{Element, finite};
use super::names::{Role, Rule};
use super::space::{FARTHEST, Layer, Space};

/// An ellipse is round if its axes differ by this share of their length, or as much from a right
/// angle: thousands of roundings of turns, and less than one to single precision.
const ROUND: f64 = 1e-9;

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
    /// A tile that hides and is no square; its corners are in tiles.
    pub(super) fn hexagon(corners: &[DVec2], layer: &Layer<'_>) -> Result<Self, String> {
        if corners.iter().any(|p| p.abs().max_element() > FARTHEST) {
            return Err("its tiles are too far away".into());
        }
        let corners: Vec<Vec2> = corners.iter().map(|p| p.as_vec2()).collect();
        let bounds = Shape::from(ConvexPolygon::new(&corners).map_err(|why| why.to_string())?);
        let (layer, role, occluder) = (layer.name.clone(), Role::Wall, Some(bounds.clone()));
        Ok(Self { id: 0, name: String::new(), class: String::new(), layer, role, bounds, occluder })
    }

    /// The object for a scene in which a tile is a world unit wide, closed if it is a door: it is
    /// opened by [`Scene::set_occluder`](casca_plane::Scene::set_occluder). Its user data is its number.
    pub fn desc(&self) -> ObjectDesc {
        let desc = ObjectDesc::new(self.bounds.clone()).user_data(self.id.into());
        match &self.occluder {
            Some(occluder) => desc.occluder(occluder.clone()),
            None => desc,
        }
    }
}

/// Reads the objects of a layer. Leaves out texts, pictures, and objects made of templates.
pub fn read(layer: &Layer<'_>, space: Space, rule: &Rule, all: &mut Vec<TmxObject>, said: &mut Vec<String>) {
    let name = layer.short_name();
    let mut passed = 0;
    for element in layer.element.all("object") {
        if element.attribute("template").or(element.attribute("gid")).is_some() {
            passed += 1;
            continue;
        }
        let id = element.attribute("id").and_then(|id| id.trim().parse().ok()).unwrap_or(0);
        let mut warn = |what: String| said.push(format!("the object {id} of the layer {name:?} {what}"));
        match shapes(element, space, layer.shift) {
            Ok(None) => {}
            Err(why) => warn(format!("is left out: {why}")),
            Ok(Some([bounds, occluder])) => {
                let class = element.class().to_owned();
                let says = rule.properties(element).or(rule.role(&class).into());
                let role = says.role().or(layer.role).unwrap_or_default();
                let is_point = matches!(&bounds, Shape::Disc(disc) if disc.radius == 0.0);
                if is_point && role != Role::Plain {
                    warn("has no size, and hides nothing".into());
                }
                let occluder = (role != Role::Plain && !is_point).then_some(occluder);
                let name = element.attribute("name").unwrap_or_default().to_owned();
                let layer = layer.name.clone();
                all.push(TmxObject { id, name, class, layer, role, bounds, occluder });
            }
        }
    }
    if passed > 0 {
        said.push(format!(
            "the layer {name:?} has {passed} objects with pictures or of templates: these are not read, and \
             hide nothing"
        ));
    }
}

/// The shape around an object, and that in it, in tiles; `None` for a text.
fn shapes(element: Element<'_>, space: Space, shift: DVec2) -> Result<Option<[Shape; 2]>, String> {
    let form = element.children().find(|child| child.name != "properties");
    let form_name = form.map_or("", |form| form.name);
    if form_name == "text" {
        return Ok(None);
    }
    let number = |name: &str, least: f64| {
        let text = element.attribute(name).unwrap_or("0");
        finite(text).filter(|v| *v >= least).ok_or_else(|| no_number(name, text))
    };
    let [x, y, rotation] = ["x", "y", "rotation"].map(|name| number(name, f64::MIN));
    let size = DVec2::new(number("width", 0.0)?, number("height", 0.0)?);
    let screen = space.screen();
    let (at, turn) = (screen * DVec2::new(x?, y?) + shift, turn(rotation?) * screen);
    let place = |p: DVec2| {
        let p = space.place(at + turn * p);
        // False also for what is not a number.
        let near = p.abs().cmple(DVec2::splat(FARTHEST)).all();
        if near { Ok(p.as_vec2()) } else { Err(format!("{} and {} tiles are too far away", p.x, p.y)) }
    };
    let places = |all: &[DVec2]| all.iter().map(|&p| place(p)).collect::<Result<Vec<Vec2>, String>>();
    // Pairs of numbers: `x,y x,y`.
    let points = || {
        let text = form.map(Element::points).unwrap_or_default();
        let point = |pair: &str| {
            let (x, y) = pair.split_once(',')?;
            Some(DVec2::new(finite(x)?, finite(y)?))
        };
        let pairs = text.split_ascii_whitespace();
        let points = pairs.map(|pair| point(pair).ok_or_else(|| no_number("points", pair)));
        places(&points.collect::<Result<Vec<DVec2>, String>>()?)
    };
    let both = |shape: Shape| [shape.clone(), shape];
    let shapes = match form_name {
        // Old versions of the editor have points without an element.
        "point" => Ok(both(Disc::new(place(DVec2::ZERO)?, 0.0).into())),
        "" | "ellipse" if size == DVec2::ZERO => Ok(both(Disc::new(place(DVec2::ZERO)?, 0.0).into())),
        "" => rectangle(places(&[DVec2::ZERO, DVec2::X * size.x, size, DVec2::Y * size.y])?),
        "ellipse" => {
            let [a, b] = [DVec2::X * size.x, DVec2::Y * size.y].map(|axis| space.tiles(turn * axis / 2.0));
            let ends = places(&[size / 2.0, DVec2::ZERO, size])?;
            let (long, short) = (a.length().max(b.length()), a.length().min(b.length()));
            if size.min_element() == 0.0 {
                Ok(both(Segment::new(ends[1], ends[2]).into()))
            } else if long - short <= ROUND * long && a.dot(b).abs() <= ROUND * long * long {
                Ok(both(Disc::new(ends[0], long as f32).into()))
            } else {
                ellipse(ends[0], [a, b]).map(|[inner, outer]| [outer, inner])
            }
        }
        "polygon" => match points()? {
            few if few.len() < 3 => return Err(format!("{} points make no polygon", few.len())),
            corners => polygon(corners),
        },
        "polyline" => Polyline::new(&points()?).map(|line| both(line.into())),
        other => return Err(format!("the shape {other:.40} is not known")),
    };
    shapes.map(Some).map_err(|why| why.to_string())
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

/// A polygon in an ellipse and one around it. Refuses ellipses of which rounding leaves no area.
fn ellipse(center: Vec2, axes: [DVec2; 2]) -> Result<[Shape; 2], Error> {
    let polygon = |scale: f64| {
        let corners: [Vec2; DISC_SIDES] = std::array::from_fn(|i| {
            let (sin, cos) = (TAU * i as f64 / DISC_SIDES as f64).sin_cos();
            (center.as_dvec2() + (axes[0] * cos + axes[1] * sin) * scale).as_vec2()
        });
        ConvexPolygon::new(&corners).map(Shape::from)
    };
    // Sides around a circle touch it in their middles.
    Ok([polygon(1.0)?, polygon(1.0 / (PI / DISC_SIDES as f64).cos())?])
}

fn no_number(attribute: &str, value: &str) -> String {
    format!("{attribute}=\"{value:.40}\" is no number that is read")
}
