//! Headers of PLY files, as programs write them: words in any case, blanks anywhere, comments in
//! any encoding.

use super::sink::plain;
use super::text::Lines;
use std::io::BufRead;

/// How the elements are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    Little,
    Big,
}

/// The type of a number, and its bytes in a binary file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Signed(usize),
    Unsigned(usize),
    Float(usize),
}

/// What a property says of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Field {
    Position(usize),
    Colour(usize),
    Splat(usize),
    Normal(usize),
    Radius,
    Other,
}

#[derive(Debug, Clone)]
pub(super) struct Property {
    pub name: String,
    pub field: Field,
    /// The type of the number of entries, if it is a list.
    pub list: Option<Kind>,
    pub kind: Kind,
}

#[derive(Debug, Clone)]
pub(super) struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
}

impl Element {
    /// Whether a property other than a list is this one.
    pub fn has(&self, field: Field) -> bool {
        self.properties.iter().any(|property| property.field == field)
    }
}

#[derive(Debug, Clone)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Lines that are none of a header, and were passed over.
    pub strange: Vec<String>,
}

/// Reads the lines up to `end_header`.
pub(super) fn read(lines: &mut Lines<impl BufRead>) -> Result<Header, String> {
    let (mut encoding, mut elements, mut strange) = (None, Vec::<Element>::new(), Vec::new());
    loop {
        let line = lines.next().map_err(plain)?.map(str::to_owned);
        let line =
            line.ok_or_else(|| format!("the file ends in line {} without end_header", lines.number))?;
        let number = lines.number;
        let told = || format!("line {number} is none of a PLY header: {line:.60}");
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let word = |i: usize| words.get(i).map_or_else(String::new, |word| word.to_ascii_lowercase());
        match &*word(0) {
            "ply" if number == 1 => {}
            "comment" | "obj_info" => {}
            "end_header" => break,
            "format" => match &*word(1) {
                "ascii" => encoding = Some(Encoding::Text),
                "binary_little_endian" => encoding = Some(Encoding::Little),
                "binary_big_endian" => encoding = Some(Encoding::Big),
                _ => return Err(told()),
            },
            "element" => {
                let count = words.get(2).and_then(|count| count.parse().ok()).ok_or_else(told)?;
                elements.push(Element { name: word(1), count, properties: Vec::new() });
            }
            "property" => {
                let element = elements.last_mut().ok_or_else(told)?;
                element.properties.push(property(&words).ok_or_else(told)?);
            }
            _ => strange.push(told()),
        }
    }
    let encoding = encoding.ok_or("it has no line \"format\"")?;
    Ok(Header { encoding, elements, strange })
}

/// `property TYPE NAME` or `property list TYPE TYPE NAME`.
fn property(words: &[&str]) -> Option<Property> {
    let (list, rest) = match *words {
        [_, word, count, ref rest @ ..] if word.eq_ignore_ascii_case("list") => (Some(kind(count)?), rest),
        [_, ref rest @ ..] => (None, rest),
        [] => return None,
    };
    let kind = kind(rest.first()?)?;
    let name = rest.get(1)?.to_ascii_lowercase();
    let field = match &*name {
        _ if list.is_some() => Field::Other,
        "x" | "y" | "z" => Field::Position(usize::from(name.as_bytes()[0] - b'x')),
        "red" | "r" | "diffuse_red" => Field::Colour(0),
        "green" | "g" | "diffuse_green" => Field::Colour(1),
        "blue" | "b" | "diffuse_blue" => Field::Colour(2),
        "f_dc_0" | "f_dc_1" | "f_dc_2" => Field::Splat(usize::from(name.as_bytes()[5] - b'0')),
        "nx" | "ny" | "nz" => Field::Normal(usize::from(name.as_bytes()[1] - b'x')),
        "radius" => Field::Radius,
        _ => Field::Other,
    };
    Some(Property { name, field, list, kind })
}

fn kind(word: &str) -> Option<Kind> {
    Some(match &*word.to_ascii_lowercase() {
        "char" | "int8" => Kind::Signed(1),
        "uchar" | "uint8" => Kind::Unsigned(1),
        "short" | "int16" => Kind::Signed(2),
        "ushort" | "uint16" => Kind::Unsigned(2),
        "int" | "int32" => Kind::Signed(4),
        "uint" | "uint32" => Kind::Unsigned(4),
        "int64" => Kind::Signed(8),
        "uint64" => Kind::Unsigned(8),
        "float" | "float32" => Kind::Float(4),
        "double" | "float64" => Kind::Float(8),
        _ => return None,
    })
}
