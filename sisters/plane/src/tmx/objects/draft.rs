//! Objects as their elements have them.

use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

use glam::{DMat2, DVec2};

use super::fault::{TmxFault, shortened};
use super::properties::{self, TmxValue};
use super::shape::Outline;
use crate::tmx::TmxError;
use crate::tmx::xml::{Element, Xml};

/// A value, or what is amiss with the object instead. Errors of the file are around it.
pub(super) type Checked<T> = Result<Result<T, TmxFault>, TmxError>;

/// The part of an object that its element says.
#[derive(Debug, Clone)]
pub(super) struct Draft {
    /// Empty where it says nothing, as the class is.
    pub name: String,
    pub class: Arc<str>,
    pub visible: Option<bool>,
    /// The path of its template.
    pub template: Option<String>,
    /// In pixels.
    pub at: DVec2,
    pub size: [Option<f64>; 2],
    /// In degrees.
    pub rotation: Option<f64>,
    /// The tile of an object with a picture.
    pub tile: Option<u32>,
    /// The last one, if there are several.
    pub form: Option<Form>,
    pub properties: BTreeMap<String, TmxValue>,
    /// Faults of its properties.
    pub faults: Vec<TmxFault>,
}

/// The element that says which form an object has.
#[derive(Debug, Clone)]
pub(super) enum Form {
    Text,
    Outline(Rc<Outline>),
}

impl Draft {
    /// Reads an object, from behind its start to behind its end.
    pub fn read(xml: &mut Xml<'_>, element: &Element<'_>) -> Checked<Self> {
        let name = xml.attribute(element, "name")?.unwrap_or_default().into_owned();
        // Version 1.9 of the editor says `class`, those before and after it `type`.
        let kind = xml.attribute(element, "type")?.filter(|kind| !kind.is_empty());
        let class = kind.or(xml.attribute(element, "class")?).unwrap_or_default().into();
        let visible = xml.attribute(element, "visible")?.map(|visible| visible != "0");
        let template = xml.attribute(element, "template")?.map(|path| path.into_owned());
        let (numbers, tile) = (numbers(xml, element)?, tile(xml, element)?);
        let (mut properties, mut faults) = (BTreeMap::new(), Vec::new());
        let form = contents(xml, &mut properties, &mut faults)?;
        let ([x, y, width, height, rotation], tile, form) = match (numbers, tile, form) {
            (Ok(numbers), Ok(tile), Ok(form)) => (numbers, tile, form),
            // Nothing is amiss with texts, for they are passed over.
            (_, _, Ok(Some(Form::Text))) => ([None; 5], None, Some(Form::Text)),
            (Err(why), _, _) | (_, Err(why), _) | (_, _, Err(why)) => return Ok(Err(why)),
        };
        let at = DVec2::new(x.unwrap_or(0.0), y.unwrap_or(0.0));
        let size = [width, height];
        Ok(Ok(Self { name, class, visible, template, at, size, rotation, tile, form, properties, faults }))
    }

    /// How it is turned on the screen about its place.
    pub fn turn(&self) -> DMat2 {
        let angle = self.rotation.unwrap_or(0.0).rem_euclid(360.0);
        // Right angles keep rectangles along the axes.
        let (sin, cos) = match angle {
            0.0 => (0.0, 1.0),
            90.0 => (1.0, 0.0),
            180.0 => (0.0, -1.0),
            270.0 => (-1.0, 0.0),
            _ => angle.to_radians().sin_cos(),
        };
        // Clockwise, for y goes down.
        DMat2::from_cols(DVec2::new(cos, sin), DVec2::new(-sin, cos))
    }

    /// Takes over the parts that it does not say from its template, as the editor does: its place
    /// is its own, and its size, if it has both lengths.
    pub fn complete(&mut self, template: &Self) {
        if self.name.is_empty() {
            self.name.clone_from(&template.name);
        }
        if self.class.is_empty() {
            self.class = template.class.clone();
        }
        if !self.size.iter().all(|length| length.is_some_and(|v| v > 0.0)) {
            self.size = template.size;
        }
        self.visible = self.visible.or(template.visible);
        self.rotation = self.rotation.or(template.rotation);
        self.form = self.form.take().or_else(|| template.form.clone());
        properties::complete(&mut self.properties, &template.properties);
        self.faults.extend(template.faults.iter().cloned());
    }
}

/// The elements in an object, from behind its start: its properties and its form.
fn contents(
    xml: &mut Xml<'_>,
    into: &mut BTreeMap<String, TmxValue>,
    faults: &mut Vec<TmxFault>,
) -> Checked<Option<Form>> {
    let mut form = Ok(None);
    while let Some(child) = xml.child()? {
        let outline = |outline| Some(Form::Outline(Rc::new(outline)));
        match child.local_name().as_ref() {
            b"properties" => {
                properties::read(xml, into, 0, faults)?;
                continue;
            }
            b"ellipse" => form = Ok(outline(Outline::Ellipse)),
            b"point" => form = Ok(outline(Outline::Point)),
            b"polygon" => form = points(xml, &child)?.map(|points| outline(Outline::Polygon(points))),
            b"polyline" => form = points(xml, &child)?.map(|points| outline(Outline::Polyline(points))),
            b"text" => form = Ok(Some(Form::Text)),
            other => form = Err(TmxFault::UnknownShape(shortened(&String::from_utf8_lossy(other)))),
        }
        xml.skip(&child)?;
    }
    Ok(form)
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

/// The place, the size and the rotation of an object.
fn numbers(xml: &Xml<'_>, element: &Element<'_>) -> Checked<[Option<f64>; 5]> {
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
    Ok(Ok(found))
}

/// The tile of an object with a picture.
fn tile(xml: &Xml<'_>, element: &Element<'_>) -> Checked<Option<u32>> {
    let Some(text) = xml.attribute(element, "gid")? else { return Ok(Ok(None)) };
    let wrong = |_| TmxFault::Number { attribute: "gid", value: shortened(&text) };
    Ok(text.trim().parse().map(Some).map_err(wrong))
}
