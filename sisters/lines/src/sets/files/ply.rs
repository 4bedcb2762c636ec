//! PLY (Turk 1994, "The PLY polygon file format"): vertices with `edge` elements, or elements with
//! lists of vertex indices.

use std::collections::HashMap;

use glam::Vec3;

use super::bytes::{Bytes, Kind, are_words, whole};
use super::error::{FileError, Lines, Lists, broken, refused};
use super::words::{Words, line_end, parse, words};

/// The kind of number with a name.
fn kind_named(name: &str) -> Option<Kind> {
    Some(match name {
        "float" | "float32" => Kind::Float(4),
        "double" | "float64" => Kind::Float(8),
        "char" | "int8" => Kind::Signed(1),
        "short" | "int16" => Kind::Signed(2),
        "int" | "int32" => Kind::Signed(4),
        "uchar" | "uint8" => Kind::Unsigned(1),
        "ushort" | "uint16" => Kind::Unsigned(2),
        "uint" | "uint32" => Kind::Unsigned(4),
        _ => return None,
    })
}

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
    Text(Words<'a>),
    Binary(Bytes<'a>),
}

impl Body<'_> {
    fn number(&mut self, kind: Kind) -> Result<f64, FileError> {
        match self {
            Self::Text(words) => words.real("a number"),
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
            Self::Text(words) => broken("line", words.line, why),
            Self::Binary(file) => broken("byte", file.at, why),
        }
    }
}

/// The lines of a PLY file. Edges that follow each other make one line.
pub(super) fn read(bytes: &[u8]) -> Lines {
    let (points, lines) = lists(bytes, &["edge", "line", "polyline"])?;
    let point = |i: &u32| {
        let found = points.get(*i as usize).copied();
        let swapped = (i.swap_bytes() as usize) < points.len() && *i > 0;
        let more = if swapped { ": perhaps the header names the wrong order of bytes" } else { "" };
        found.ok_or_else(|| refused(format!("a line names vertex {i} of {}{more}", points.len())))
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
    let (mut elements, mut at, mut number): (Vec<Element>, _, _) = (Vec::new(), 0, 0);
    let (mut binary, line_end) = (None, line_end(bytes));
    loop {
        let rest = &bytes[at..];
        let Some(end) = rest.iter().position(|b| *b == line_end) else {
            let why = "the header does not end: a line end_header must stand before the numbers";
            return Err(broken("line", number + 1, why));
        };
        (at, number) = (at + end + 1, number + 1);
        let words = words(&rest[..end]);
        let fail = |why: &str| broken("line", number, why);
        let kind = |name: &str| kind_named(name).ok_or_else(|| fail("a property of unknown type"));
        let mut property = |p: Property| -> Result<(), FileError> {
            let element = elements.last_mut().ok_or_else(|| fail("a property before the first element"))?;
            element.properties.push(p);
            Ok(())
        };
        match words[..] {
            ["ply"] if number == 1 => {}
            _ if number == 1 => return Err(fail("a PLY file starts with \"ply\"")),
            ["format", "ascii", _] => binary = Some(None),
            ["format", "binary_little_endian", _] => binary = Some(Some(false)),
            ["format", "binary_big_endian", _] => binary = Some(Some(true)),
            ["element", name, count] => elements.push(Element {
                name: name.to_owned(),
                count: parse(count, "a number of elements", number)?,
                properties: Vec::new(),
            }),
            ["property", "list", length, of, name] => {
                property(Property { name: name.to_owned(), list: Some(kind(length)?), kind: kind(of)? })?;
            }
            ["property", of, name] => {
                property(Property { name: name.to_owned(), list: None, kind: kind(of)? })?
            }
            ["end_header"] => break,
            ["comment" | "obj_info", ..] | [] => {}
            _ => return Err(fail("a statement that PLY does not have")),
        }
    }
    let body = match binary.ok_or_else(|| broken("line", number, "the header has no format"))? {
        None => Body::Text(Words::new(&bytes[at..], number + 1)),
        Some(_) if are_words(&bytes[at..]) => {
            let why =
                "the numbers are text, but the header says that they are binary: its format must be ascii";
            return Err(broken("line", number + 1, why));
        }
        Some(big) => Body::Binary(Bytes { bytes, at, big }),
    };
    Ok((elements, body))
}
