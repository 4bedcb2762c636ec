//! Values of JSON, and the elements of XML that they stand for.

use std::borrow::Cow;
use std::collections::BTreeMap;

use serde_json::value::RawValue;

use crate::MapError;

/// Values in each other, at most: each level is read once more. The editor makes about ten.
const DEEPEST: usize = 100;

/// A value of a file.
pub struct Json<'a> {
    /// Its text in the file.
    pub at: &'a str,
    value: Value<'a>,
}

enum Value<'a> {
    /// A text, a number, 1 or 0 for true and false, or what a list has that is none of objects.
    Plain(Cow<'a, str>),
    List(Vec<Json<'a>>),
    Object(Vec<(String, Json<'a>)>),
}

impl<'a> Json<'a> {
    pub fn read(text: &'a str, file: &str) -> Result<Self, MapError> {
        let raw = serde_json::from_str(text).map_err(|why| (why.line() as u32, reason(why)));
        let read =
            raw.and_then(|raw: &RawValue| Self::of(raw.get(), 0).map_err(|(at, why)| (line(text, at), why)));
        read.map_err(|(line, why)| {
            MapError::damaged(file, line, format!("it is no JSON that is read: {why}"))
        })
    }

    /// A value, or the place and the reason why it is none.
    fn of(at: &'a str, depth: usize) -> Result<Self, (&'a str, String)> {
        if depth > DEEPEST {
            return Err((at, format!("values are nested deeper than {DEEPEST}")));
        }
        let wrong = |why| (at, reason(why));
        let inner = |raw: &'a RawValue| Self::of(raw.get(), depth + 1);
        let value = match at.as_bytes() {
            [b'{', ..] => {
                let all: BTreeMap<String, &'a RawValue> = serde_json::from_str(at).map_err(wrong)?;
                let old = all.keys().find(|key| ["tileproperties", "propertytypes"].contains(&&***key));
                if let Some(old) = old {
                    let why = format!("{old} is of editors before version 1.2: save it by a newer one");
                    return Err((at, why));
                }
                let all = all.into_iter().map(|(key, raw)| Ok((key, inner(raw)?)));
                Value::Object(all.collect::<Result<_, _>>()?)
            }
            [b'[', items @ ..] if items.trim_ascii_start().starts_with(b"{") => {
                let all: Vec<&'a RawValue> = serde_json::from_str(at).map_err(wrong)?;
                Value::List(all.into_iter().map(inner).collect::<Result<_, _>>()?)
            }
            [b'[', ..] => Value::Plain(at[1..at.len() - 1].into()),
            [b'"', ..] if !at.contains('\\') => Value::Plain(at[1..at.len() - 1].into()),
            [b'"', ..] => Value::Plain(serde_json::from_str::<String>(at).map_err(wrong)?.into()),
            b"true" => Value::Plain("1".into()),
            b"false" => Value::Plain("0".into()),
            _ => Value::Plain(at.into()),
        };
        Ok(Self { at, value })
    }

    /// A plain value in it; that of what is not there, and of `null`, is none.
    pub fn get(&self, key: &str) -> Option<&str> {
        let Value::Object(entries) = &self.value else { return None };
        let (_, found) = entries.iter().find(|(other, _)| other == key)?;
        let Value::Plain(text) = &found.value else { return None };
        (found.at != "null").then_some(text)
    }

    /// The elements of XML that stand for what is in it, with their names.
    pub fn children(&self) -> Vec<(&str, &Self)> {
        let entries = match &self.value {
            Value::Plain(_) => return Vec::new(),
            Value::List(items) => return items.iter().map(|item| ("", item)).collect(),
            Value::Object(entries) => entries,
        };
        let mut children = Vec::new();
        for (key, value) in entries {
            // In XML, the tiles and the chunks of a layer are in an element of their own.
            let (whole, items) = match &**key {
                "data" => (Some((&**key, self)), None),
                "chunks" => (Some(("data", self)), Some("chunk")),
                "ellipse" | "point" | "capsule" if value.at != "true" => continue,
                "properties" | "objectgroup" | "polygon" | "polyline" | "text" | "ellipse" | "point"
                | "capsule" => (Some((&**key, value)), None),
                "layers" | "objects" | "tiles" | "tilesets" => (None, key.strip_suffix('s')),
                _ => continue,
            };
            children.extend(whole);
            if let (Some(name), Value::List(list)) = (items, &value.value) {
                children.extend(list.iter().map(|item| match item.get("type").filter(|_| name == "layer") {
                    Some(kind @ ("objectgroup" | "group" | "imagelayer")) => (kind, item),
                    _ => (name, item),
                }));
            }
        }
        children
    }
}

/// A reason without its line, which is one of a part of the file.
fn reason(why: serde_json::Error) -> String {
    why.to_string().split(" at line ").next().unwrap_or_default().to_owned()
}

/// The line in which a part of a text begins, from 1.
pub fn line(text: &str, part: &str) -> u32 {
    let before = (part.as_ptr() as usize).saturating_sub(text.as_ptr() as usize);
    let before = text.as_bytes().get(..before).unwrap_or_default();
    1 + before.iter().filter(|byte| **byte == b'\n').count() as u32
}
