//! PLY (Turk 1994, "The PLY polygon file format"): vertices with `edge` elements, or elements with
//! lists of vertex indices.

use std::collections::HashMap;

use glam::Vec3;

use super::bytes::{Bytes, Kind, whole};
use super::error::{FileError, Lines, Lists, broken, refused};
use super::words::{Scan, words};

struct Property {
    name: String,
    /// The kind of a list's length, if it is one.
    list: Option<Kind>,
    kind: Kind,
}

struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

/// What a number of an edge or a list of indices stands for, in errors.
const VERTEX: &str = "the number of a vertex";

/// The numbers of the body, as text or bytes.
enum Body<'a> {
    Text(Scan<'a>),
    Binary(Bytes<'a>),
}

impl Body<'_> {
    fn number(&mut self, kind: Kind) -> Result<f64, FileError> {
        match self {
            Self::Text(text) => text.real("a number"),
            Self::Binary(file) => file.number(kind),
        }
    }

    /// A number that must be whole and fit into 32 bits without a sign.
    fn whole(&mut self, kind: Kind, what: &str) -> Result<u32, FileError> {
        let number = self.number(kind)?;
        self.is_whole(number, what)
    }

    fn is_whole(&self, number: f64, what: &str) -> Result<u32, FileError> {
        whole(number).ok_or_else(|| self.fail(format!("{number} cannot be {what}")))
    }

    fn fail(&self, why: String) -> FileError {
        match self {
            Self::Text(text) => text.fail(why),
            Self::Binary(file) => broken("byte", file.at, why),
        }
    }
}

/// The lines of a PLY file. Edges that follow each other make one line.
pub(super) fn read(bytes: &[u8]) -> Lines {
    let (points, lines) = lists(bytes, &["edge", "line", "polyline"])?;
    let point = |i: &u32| {
        let found = points.get(*i as usize).copied();
        found.ok_or_else(|| refused(format!("a line names vertex {i} of {}", points.len())))
    };
    lines.iter().map(|line| line.iter().map(point).collect()).collect()
}

/// The vertices of a PLY file, and their numbers in each element with one of these names; these may
/// not be there.
pub(super) fn lists(bytes: &[u8], wanted: &[&str]) -> Lists {
    let (elements, mut body) = header(bytes)?;
    let mut points: Vec<Vec3> = Vec::new();
    let mut lines: Vec<Vec<u32>> = Vec::new();
    for element in &elements {
        if element.properties.is_empty() && element.count > 0 {
            return Err(body.fail(format!("the element {} has no properties", element.name)));
        }
        for _ in 0..element.count {
            let (mut named, mut list) = (HashMap::new(), None);
            for property in &element.properties {
                let Some(length) = property.list else {
                    named.insert(property.name.as_str(), body.number(property.kind)?);
                    continue;
                };
                let length = body.whole(length, "the length of a list")?;
                if ["vertex_indices", "vertex_index"].contains(&property.name.as_str()) {
                    let mut next = || body.whole(property.kind, VERTEX);
                    list = Some((0..length).map(|_| next()).collect::<Result<Vec<u32>, FileError>>()?);
                } else {
                    (0..length).try_for_each(|_| body.number(property.kind).map(drop))?;
                }
            }
            let get = |name: &str| named.get(name).copied();
            match (element.name.as_str(), get("vertex1"), get("vertex2")) {
                ("vertex", ..) => {
                    let coordinate = |n| get(n).ok_or_else(|| body.fail(format!("vertices have no {n}")));
                    points.push(Vec3::from(
                        [coordinate("x")?, coordinate("y")?, coordinate("z")?].map(|c| c as f32),
                    ));
                }
                (name, a, b) if wanted.contains(&name) => match (list, a.zip(b)) {
                    (Some(list), _) => lines.push(list),
                    (None, Some((a, b))) => {
                        let [a, b] = [body.is_whole(a, VERTEX)?, body.is_whole(b, VERTEX)?];
                        match lines.last_mut() {
                            Some(line) if line.last() == Some(&a) => line.push(b),
                            _ => lines.push(vec![a, b]),
                        }
                    }
                    (None, None) => {
                        return Err(body.fail(format!(
                            "the element {name} has neither a list vertex_indices nor vertex1 and vertex2"
                        )));
                    }
                },
                _ => {}
            }
        }
    }
    Ok((points, lines))
}

fn header(bytes: &[u8]) -> Result<(Vec<Element>, Body<'_>), FileError> {
    let mut text = Scan::new(bytes, "line");
    let (mut elements, mut binary): (Vec<Element>, _) = (Vec::new(), None);
    loop {
        let start = text.at;
        let words = words(text.line());
        let fail = |why: &str| text.fail_at(start, why);
        if start == bytes.len() {
            return Err(fail("the header does not end: a line end_header must stand before the numbers"));
        }
        let mut property = |name: &str, list: Option<&str>, kind: &str| -> Result<(), FileError> {
            let (kind, length) = (Kind::named(kind), list.map(Kind::named));
            let (Some(kind), false) = (kind, length == Some(None)) else {
                return Err(fail("a property of unknown type"));
            };
            let Some(element) = elements.last_mut() else {
                return Err(fail("a property before the first element"));
            };
            element.properties.push(Property { name: name.to_owned(), list: length.flatten(), kind });
            Ok(())
        };
        match words[..] {
            ["ply"] if start == 0 => {}
            _ if start == 0 => return Err(fail("a PLY file starts with \"ply\"")),
            ["format", "ascii", _] => binary = Some(None),
            ["format", "binary_little_endian", _] => binary = Some(Some(false)),
            ["format", "binary_big_endian", _] => binary = Some(Some(true)),
            ["element", name, count] => match count.parse() {
                Ok(count) => elements.push(Element { name: name.to_owned(), count, properties: Vec::new() }),
                Err(_) => return Err(fail("an element without a number of them")),
            },
            ["property", "list", length, of, name] => property(name, Some(length), of)?,
            ["property", of, name] => property(name, None, of)?,
            ["end_header"] => break,
            ["comment" | "obj_info", ..] | [] => {}
            _ => return Err(fail("a statement that PLY does not have")),
        }
    }
    let body = match binary {
        None => return Err(text.fail_at(text.at - 1, "the header has no format")),
        Some(None) => Body::Text(text),
        Some(Some(big)) => Body::Binary(Bytes { bytes, at: text.at, big }),
    };
    Ok((elements, body))
}
