//! Properties of objects.

use std::collections::BTreeMap;

use super::fault::{TmxFault, shortened};
use crate::editor::truth;
use crate::tmx::TmxError;
use crate::tmx::xml::{Element, Xml};

/// Classes in each other, at most: values are read and dropped by functions that call themselves.
const DEEPEST: u32 = 16;

/// The value of a property.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum TmxValue {
    /// `bool`.
    Bool(bool),
    /// `int`.
    Int(i64),
    /// `float`: a finite number.
    Float(f64),
    /// `string`, and what has no value of its type.
    String(String),
    /// `color`: red, green, blue and opacity, each from 0 to 255; `None` if none was chosen.
    Color(Option<[u8; 4]>),
    /// `file`: a path as the map has it.
    File(String),
    /// `object`: the number of another object; 0 for none.
    Object(u32),
    /// `class`: only the members that differ from those of the class are in the file.
    Class {
        /// The name of the class.
        class: String,
        /// The members by their names.
        members: BTreeMap<String, TmxValue>,
    },
}

impl TmxValue {
    /// The name of its type.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Bool(_) => "bool",
            Self::Int(_) => "int",
            Self::Float(_) => "float",
            Self::String(_) => "string",
            Self::Color(_) => "color",
            Self::File(_) => "file",
            Self::Object(_) => "object",
            Self::Class { .. } => "class",
        }
    }
}

/// Reads a list of properties, from behind its start. Of properties that come twice the last
/// counts.
pub(super) fn read(
    xml: &mut Xml<'_>,
    into: &mut BTreeMap<String, TmxValue>,
    depth: u32,
    faults: &mut Vec<TmxFault>,
) -> Result<(), TmxError> {
    while let Some(child) = xml.child()? {
        if child.local_name().as_ref() != b"property" {
            xml.skip(&child)?;
            continue;
        }
        let name = xml.required(&child, "name")?.into_owned();
        let kind = xml.attribute(&child, "type")?.unwrap_or("string".into()).into_owned();
        let value = match kind == "class" {
            true => class(xml, &child, &name, depth, faults)?,
            false => plain(xml, &child, &name, &kind, faults)?,
        };
        into.insert(name, value);
    }
    Ok(())
}

/// Adds the properties that an object does not have from its template, and the members that a
/// class lacks. Calls itself as deep as reading does.
pub(super) fn complete(own: &mut BTreeMap<String, TmxValue>, template: &BTreeMap<String, TmxValue>) {
    for (name, value) in template {
        match (own.get_mut(name), value) {
            (None, _) => _ = own.insert(name.clone(), value.clone()),
            (Some(TmxValue::Class { members, .. }), TmxValue::Class { members: others, .. }) => {
                complete(members, others);
            }
            _ => {}
        }
    }
}

fn class(
    xml: &mut Xml<'_>,
    property: &Element<'_>,
    name: &str,
    depth: u32,
    faults: &mut Vec<TmxFault>,
) -> Result<TmxValue, TmxError> {
    let class = xml.attribute(property, "propertytype")?.unwrap_or_default().into_owned();
    let mut members = BTreeMap::new();
    if depth == DEEPEST {
        faults.push(TmxFault::Deep(shortened(name)));
        xml.skip(property)?;
        return Ok(TmxValue::Class { class, members });
    }
    while let Some(child) = xml.child()? {
        match child.local_name().as_ref() {
            b"properties" => read(xml, &mut members, depth + 1, faults)?,
            _ => xml.skip(&child)?,
        }
    }
    Ok(TmxValue::Class { class, members })
}

fn plain(
    xml: &mut Xml<'_>,
    property: &Element<'_>,
    name: &str,
    kind: &str,
    faults: &mut Vec<TmxFault>,
) -> Result<TmxValue, TmxError> {
    // Texts of several lines are in the element.
    let text = match xml.attribute(property, "value")? {
        Some(value) => {
            xml.skip(property)?;
            value.into_owned()
        }
        None if kind == "string" => xml.text()?.into_owned(),
        None => {
            xml.skip(property)?;
            String::new()
        }
    };
    let value = match kind {
        "string" => return Ok(TmxValue::String(text)),
        "file" => return Ok(TmxValue::File(text)),
        "bool" => truth(&text).map(TmxValue::Bool),
        "int" => text.trim().parse().ok().map(TmxValue::Int),
        "float" => text.trim().parse().ok().filter(|v: &f64| v.is_finite()).map(TmxValue::Float),
        "object" => text.trim().parse().ok().map(TmxValue::Object),
        "color" => color(&text).map(TmxValue::Color),
        _ => None,
    };
    Ok(value.unwrap_or_else(|| {
        faults.push(TmxFault::PropertyValue { property: shortened(name), kind: shortened(kind) });
        TmxValue::String(text)
    }))
}

/// `#AARRGGBB` or `#RRGGBB`; nothing if no colour was chosen.
fn color(text: &str) -> Option<Option<[u8; 4]>> {
    if text.is_empty() {
        return Some(None);
    }
    let digits = text.strip_prefix('#').filter(|digits| digits.bytes().all(|b| b.is_ascii_hexdigit()))?;
    let number = u32::from_str_radix(digits, 16).ok()?;
    let number = match digits.len() {
        8 => number,
        6 => number | 0xff00_0000,
        _ => return None,
    };
    let [a, r, g, b] = number.to_be_bytes();
    Some(Some([r, g, b, a]))
}
