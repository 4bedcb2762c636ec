//! The objects of a layer.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DMat2, DVec2};

use super::fault::{TmxFault, shortened};
use super::object::TmxObject;
use super::properties::{self, TmxValue};
use super::shape::{Frame, Outline, TmxShape};
use crate::editor::Role;
use crate::tmx::TmxError;
use crate::tmx::space::Space;
use crate::tmx::tileset::{Alignment, Tilesets};
use crate::tmx::xml::{Element, Xml};

/// What all objects of a layer share.
pub(in crate::tmx) struct ObjectLayer<'l> {
    pub space: &'l Space,
    pub tilesets: &'l Tilesets,
    pub name: Arc<str>,
    /// Its shift in pixels, that of its groups included.
    pub shift: [f64; 2],
    /// Whether it and its groups are switched on.
    pub visible: bool,
    /// The names of the properties that say that an object hides, and that it is a door.
    pub names: [&'l str; 2],
    /// Whether all its objects hide.
    pub walls: bool,
}

/// A value, or what is amiss with the object instead. Errors of the file are around it.
type Checked<T> = Result<Result<T, TmxFault>, TmxError>;

impl ObjectLayer<'_> {
    /// Reads the objects of a layer, from behind its start. `fault` is told the id of an object and
    /// what is amiss with it.
    pub fn read(
        &self,
        xml: &mut Xml<'_>,
        objects: &mut Vec<TmxObject>,
        fault: &mut dyn FnMut(u32, TmxFault),
    ) -> Result<(), TmxError> {
        let mut faults = Vec::new();
        while let Some(child) = xml.child()? {
            if child.local_name().as_ref() != b"object" {
                xml.skip(&child)?;
                continue;
            }
            let id = xml.attribute(&child, "id")?.and_then(|id| id.trim().parse().ok()).unwrap_or(0);
            match self.object(xml, &child, id, &mut faults)? {
                Ok(object) => objects.extend(object),
                Err(why) => faults.push(why),
            }
            faults.drain(..).for_each(|why| fault(id, why));
        }
        Ok(())
    }

    /// Reads an object, from behind its start to behind its end. `None` for a text.
    fn object(
        &self,
        xml: &mut Xml<'_>,
        element: &Element<'_>,
        id: u32,
        faults: &mut Vec<TmxFault>,
    ) -> Checked<Option<TmxObject>> {
        let name = xml.attribute(element, "name")?.unwrap_or_default().into_owned();
        // Version 1.9 of the editor says `class`, those before and after it `type`.
        let kind = xml.attribute(element, "type")?.filter(|kind| !kind.is_empty());
        let class = kind.or(xml.attribute(element, "class")?).unwrap_or_default();
        let template = xml.attribute(element, "template")?.map(|path| shortened(&path));
        let hidden = xml.attribute(element, "visible")?.is_some_and(|visible| visible == "0");
        let (numbers, tile) = (Numbers::read(xml, element)?, tile(xml, element)?);
        let mut properties = BTreeMap::new();
        let outline = contents(xml, &mut properties, faults)?;
        if let Some(template) = template {
            return Ok(Err(TmxFault::Template(template)));
        }
        let (numbers, tile, outline) = match (numbers, tile, outline) {
            (Ok(numbers), Ok(tile), Ok(Some(outline))) => (numbers, tile, outline),
            (_, _, Ok(None)) => return Ok(Ok(None)),
            (Err(why), _, _) | (_, Err(why), _) | (_, _, Err(why)) => return Ok(Err(why)),
        };
        let shape = match self.frame(&numbers, tile).and_then(|frame| frame.shape(&outline)) {
            Ok(shape) => shape,
            Err(why) => return Ok(Err(why)),
        };
        let mut object = TmxObject {
            id,
            name,
            class: self.class(&class, tile),
            layer: self.name.clone(),
            visible: self.visible && !hidden,
            tile,
            shape,
            role: Role::Plain,
            properties,
        };
        object.role = self.role(&object, faults);
        let is_point = matches!(object.shape, TmxShape::Point(_));
        if is_point && (object.role != Role::Plain || !matches!(outline, Outline::Point)) {
            faults.push(TmxFault::NoSize);
        }
        faults.extend(object.shape.fault());
        Ok(Ok(Some(object)))
    }

    fn class(&self, own: &str, tile: Option<u32>) -> Arc<str> {
        let of_tile = tile.filter(|_| own.is_empty()).and_then(|tile| self.tilesets.class(tile));
        of_tile.unwrap_or_else(|| own.into())
    }

    /// What the object says of itself, or else its tile, its class and its layer.
    fn role(&self, object: &TmxObject, faults: &mut Vec<TmxFault>) -> Role {
        let mut says = |which: usize| {
            let name = self.names[which];
            match object.properties.get(name) {
                Some(TmxValue::Bool(says)) => return Some(*says),
                Some(other) => {
                    let (property, kind) = (shortened(name), other.kind());
                    faults.push(TmxFault::PropertyType { property, kind });
                }
                None => {}
            }
            let of_tile = object.tile.is_some_and(|tile| self.tilesets.says(tile, which));
            (of_tile || &*object.class == name).then_some(true)
        };
        let (hides, door) = (says(0), says(1));
        match (door, hides) {
            (Some(true), _) => Role::Door,
            (_, Some(true)) => Role::Wall,
            (_, None) if self.walls => Role::Wall,
            _ => Role::Plain,
        }
    }

    /// Where the coordinates of an object lie.
    fn frame(&self, numbers: &Numbers, tile: Option<u32>) -> Result<Frame<'_>, TmxFault> {
        let screen = self.space.screen();
        let angle = numbers.rotation.rem_euclid(360.0);
        // Right angles keep rectangles along the axes.
        let (sin, cos) = match angle {
            0.0 => (0.0, 1.0),
            90.0 => (1.0, 0.0),
            180.0 => (0.0, -1.0),
            270.0 => (-1.0, 0.0),
            _ => angle.to_radians().sin_cos(),
        };
        // Clockwise, for y goes down.
        let turn = DMat2::from_cols(DVec2::new(cos, sin), DVec2::new(-sin, cos));
        let at = screen * numbers.at + DVec2::from_array(self.shift);
        let [width, height] = numbers.size;
        let Some(tile) = tile else {
            let size = DVec2::new(width.unwrap_or(0.0), height.unwrap_or(0.0));
            return Ok(Frame { space: self.space, at, turn: turn * screen, least: DVec2::ZERO, size });
        };
        let Some((alignment, own)) = self.tilesets.picture(tile) else {
            return Err(TmxFault::UnknownTile(tile));
        };
        let size = DVec2::new(width.unwrap_or(own[0]), height.unwrap_or(own[1]));
        let Alignment(share) = alignment.unwrap_or(match self.space.isometric {
            true => Alignment::BOTTOM,
            false => Alignment::BOTTOM_LEFT,
        });
        // Pictures lie along the screen, also in isometric maps.
        Ok(Frame { space: self.space, at, turn, least: -DVec2::from_array(share) * size, size })
    }
}

/// The elements in an object, from behind its start: its properties and its outline; `None` for a
/// text.
fn contents(
    xml: &mut Xml<'_>,
    into: &mut BTreeMap<String, TmxValue>,
    faults: &mut Vec<TmxFault>,
) -> Checked<Option<Outline>> {
    let mut outline = Ok(Some(Outline::Box));
    while let Some(child) = xml.child()? {
        match child.local_name().as_ref() {
            b"properties" => {
                properties::read(xml, into, 0, faults)?;
                continue;
            }
            b"ellipse" => outline = Ok(Some(Outline::Ellipse)),
            b"point" => outline = Ok(Some(Outline::Point)),
            b"polygon" => outline = points(xml, &child)?.map(|points| Some(Outline::Polygon(points))),
            b"polyline" => outline = points(xml, &child)?.map(|points| Some(Outline::Polyline(points))),
            b"text" => outline = Ok(None),
            other => outline = Err(TmxFault::UnknownShape(shortened(&String::from_utf8_lossy(other)))),
        }
        xml.skip(&child)?;
    }
    Ok(outline)
}

/// Pairs of numbers: `x,y x,y`.
fn points(xml: &Xml<'_>, element: &Element<'_>) -> Checked<Vec<DVec2>> {
    let text = xml.attribute(element, "points")?.unwrap_or_default();
    let point = |pair: &str| {
        let (x, y) = pair.split_once(',')?;
        Some(DVec2::new(finite(x)?, finite(y)?))
    };
    let wrong = |pair: &str| TmxFault::Number { attribute: "points", value: shortened(pair) };
    Ok(text.split_ascii_whitespace().map(|pair| point(pair).ok_or_else(|| wrong(pair))).collect())
}

fn finite(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|v: &f64| v.is_finite())
}

/// The numbers of an object, in pixels and degrees.
struct Numbers {
    at: DVec2,
    size: [Option<f64>; 2],
    rotation: f64,
}

impl Numbers {
    fn read(xml: &Xml<'_>, element: &Element<'_>) -> Checked<Self> {
        let mut found = [None; 5];
        let attributes = ["x", "y", "width", "height", "rotation"];
        for (number, attribute) in found.iter_mut().zip(attributes) {
            let Some(text) = xml.attribute(element, attribute)? else { continue };
            let is_size = attribute == "width" || attribute == "height";
            *number = finite(&text).filter(|v| !is_size || *v >= 0.0);
            if number.is_none() {
                return Ok(Err(TmxFault::Number { attribute, value: shortened(&text) }));
            }
        }
        let [x, y, width, height, rotation] = found;
        let at = DVec2::new(x.unwrap_or(0.0), y.unwrap_or(0.0));
        Ok(Ok(Self { at, size: [width, height], rotation: rotation.unwrap_or(0.0) }))
    }
}

/// The tile of an object with a picture.
fn tile(xml: &Xml<'_>, element: &Element<'_>) -> Checked<Option<u32>> {
    let Some(text) = xml.attribute(element, "gid")? else { return Ok(Ok(None)) };
    let wrong = |_| TmxFault::Number { attribute: "gid", value: shortened(&text) };
    Ok(text.trim().parse().map(Some).map_err(wrong))
}
