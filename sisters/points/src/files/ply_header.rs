//! Headers of PLY files, as programs write them: words in any case, blanks anywhere, comments in
//! any encoding.

use std::io::BufRead;

use super::sink::plain;
use super::text::Lines;

/// How the elements are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    Little,
    Big,
}

/// The type of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

/// What a property says of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Field {
    Position(usize),
    Colour(usize),
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
    let mut header = Header { encoding: Encoding::Text, elements: Vec::new(), strange: Vec::new() };
    let mut encoding = None;
    loop {
        let line = lines.next().map_err(plain)?.map(str::to_owned);
        let line =
            line.ok_or_else(|| format!("the file ends in line {} without end_header", lines.number))?;
        let number = lines.number;
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let word = |i: usize| words.get(i).map_or_else(String::new, |word| word.to_ascii_lowercase());
        match &*word(0) {
            "ply" if number == 1 => {}
            "comment" | "obj_info" => {}
            "end_header" => break,
            "format" => encoding = Some(format(&word(1)).ok_or_else(|| told(number, &line))?),
            "element" => {
                let count = words.get(2).and_then(|count| count.parse().ok());
                let count = count.ok_or_else(|| told(number, &line))?;
                header.elements.push(Element { name: word(1), count, properties: Vec::new() });
            }
            "property" => {
                let property = property(&words).ok_or_else(|| told(number, &line))?;
                let element = header.elements.last_mut();
                element.ok_or_else(|| told(number, &line))?.properties.push(property);
            }
            _ => header.strange.push(told(number, &line)),
        }
    }
    header.encoding = encoding.ok_or("it has no line \"format\"")?;
    Ok(header)
}

/// What is said of a line that is none of a header.
fn told(number: usize, line: &str) -> String {
    format!("line {number} is none of a PLY header: {line:.60}")
}

fn format(word: &str) -> Option<Encoding> {
    Some(match word {
        "ascii" => Encoding::Text,
        "binary_little_endian" => Encoding::Little,
        "binary_big_endian" => Encoding::Big,
        _ => return None,
    })
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
        "x" => Field::Position(0),
        "y" => Field::Position(1),
        "z" => Field::Position(2),
        "red" | "r" | "diffuse_red" => Field::Colour(0),
        "green" | "g" | "diffuse_green" => Field::Colour(1),
        "blue" | "b" | "diffuse_blue" => Field::Colour(2),
        "nx" => Field::Normal(0),
        "ny" => Field::Normal(1),
        "nz" => Field::Normal(2),
        "radius" => Field::Radius,
        _ => Field::Other,
    };
    Some(Property { name, field, list, kind })
}

fn kind(word: &str) -> Option<Kind> {
    Some(match &*word.to_ascii_lowercase() {
        "char" | "int8" => Kind::I8,
        "uchar" | "uint8" => Kind::U8,
        "short" | "int16" => Kind::I16,
        "ushort" | "uint16" => Kind::U16,
        "int" | "int32" => Kind::I32,
        "uint" | "uint32" => Kind::U32,
        "int64" => Kind::I64,
        "uint64" => Kind::U64,
        "float" | "float32" => Kind::F32,
        "double" | "float64" => Kind::F64,
        _ => return None,
    })
}

impl Kind {
    /// Bytes in a binary file.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// The number of these bits, the lower ones of a word.
    pub fn number(self, word: u64) -> f64 {
        match self {
            Self::I8 => f64::from(word as i8),
            Self::U8 => f64::from(word as u8),
            Self::I16 => f64::from(word as i16),
            Self::U16 => f64::from(word as u16),
            Self::I32 => f64::from(word as i32),
            Self::U32 => f64::from(word as u32),
            Self::I64 => word as i64 as f64,
            Self::U64 => word as f64,
            Self::F32 => f64::from(f32::from_bits(word as u32)),
            Self::F64 => f64::from_bits(word),
        }
    }
}
