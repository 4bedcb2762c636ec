//! Numbers from bytes.

use glam::Vec3;

use super::error::{FileError, broken};

/// The bytes of a number, and whether it is a float or has a sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Float(usize),
    Signed(usize),
    Unsigned(usize),
}

impl Kind {
    /// By a name of PLY or VTK in lower case. VTK writes its `vtkIdType` with 32 bits.
    pub(super) fn named(name: &str) -> Option<Self> {
        Some(match name {
            "float" | "float32" => Self::Float(4),
            "double" | "float64" => Self::Float(8),
            "char" | "signed_char" | "int8" => Self::Signed(1),
            "short" | "int16" => Self::Signed(2),
            "int" | "int32" | "vtkidtype" => Self::Signed(4),
            "long" | "int64" | "vtktypeint64" => Self::Signed(8),
            "uchar" | "unsigned_char" | "uint8" => Self::Unsigned(1),
            "ushort" | "unsigned_short" | "uint16" => Self::Unsigned(2),
            "uint" | "unsigned_int" | "uint32" => Self::Unsigned(4),
            "unsigned_long" | "uint64" | "vtktypeuint64" => Self::Unsigned(8),
            _ => return None,
        })
    }

    /// The number of bytes.
    pub(super) fn size(self) -> usize {
        let (Self::Float(size) | Self::Signed(size) | Self::Unsigned(size)) = self;
        size
    }
}

/// The bytes of a file, from a place on.
pub(super) struct Bytes<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) at: usize,
    /// Whether numbers start with their highest byte.
    pub(super) big: bool,
}

impl<'a> Bytes<'a> {
    pub(super) fn take(&mut self, count: usize) -> Result<&'a [u8], FileError> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let Some(taken) = rest.get(..count) else {
            return Err(self.ended(count, "bytes"));
        };
        self.at += count;
        Ok(taken)
    }

    pub(super) fn array<const N: usize>(&mut self) -> Result<[u8; N], FileError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        if self.big {
            array.reverse();
        }
        Ok(array)
    }

    pub(super) fn f32(&mut self) -> Result<f32, FileError> {
        self.array().map(f32::from_le_bytes)
    }

    pub(super) fn i32(&mut self) -> Result<i32, FileError> {
        self.array().map(i32::from_le_bytes)
    }

    /// A number of 1, 2, 4 or 8 bytes; floats have 4 or 8.
    pub(super) fn number(&mut self, kind: Kind) -> Result<f64, FileError> {
        Ok(match kind {
            Kind::Float(4) => f64::from(self.f32()?),
            Kind::Float(_) => f64::from_le_bytes(self.array()?),
            Kind::Signed(1) => f64::from(i8::from_le_bytes(self.array()?)),
            Kind::Signed(2) => f64::from(i16::from_le_bytes(self.array()?)),
            Kind::Signed(4) => f64::from(self.i32()?),
            Kind::Signed(_) => i64::from_le_bytes(self.array()?) as f64,
            Kind::Unsigned(1) => f64::from(u8::from_le_bytes(self.array()?)),
            Kind::Unsigned(2) => f64::from(u16::from_le_bytes(self.array()?)),
            Kind::Unsigned(4) => f64::from(u32::from_le_bytes(self.array()?)),
            Kind::Unsigned(_) => u64::from_le_bytes(self.array()?) as f64,
        })
    }

    /// Numbers of a kind, as single precision has them.
    pub(super) fn floats(&mut self, kind: Kind, count: usize) -> Result<Vec<f32>, FileError> {
        self.has(kind, count)?;
        (0..count).map(|_| Ok(self.number(kind)? as f32)).collect()
    }

    /// Whole numbers of a kind, none below 0 or above 2^32 - 1.
    pub(super) fn indices(&mut self, kind: Kind, count: usize) -> Result<Vec<u32>, FileError> {
        self.has(kind, count)?;
        let next = |_| {
            let place = self.at;
            let number = self.number(kind)?;
            let fail = || broken("byte", place, format!("{number} cannot be the number of something"));
            whole(number).ok_or_else(fail)
        };
        (0..count).map(next).collect()
    }

    fn has(&self, kind: Kind, count: usize) -> Result<(), FileError> {
        match count.checked_mul(kind.size()).is_some_and(|bytes| bytes <= self.left()) {
            true => Ok(()),
            false => Err(self.ended(count, "numbers")),
        }
    }

    /// The file lacks some of what should come next, or even what comes before it.
    fn ended(&self, count: usize, what: &str) -> FileError {
        match self.bytes.len() {
            long if long < self.at => broken("byte", long, format!("the file ends before byte {}", self.at)),
            _ => broken("byte", self.at, format!("the file ends within the next {count} {what}")),
        }
    }

    pub(super) fn point(&mut self) -> Result<Vec3, FileError> {
        Ok(Vec3::new(self.f32()?, self.f32()?, self.f32()?))
    }

    pub(super) fn left(&self) -> usize {
        self.bytes.len().saturating_sub(self.at)
    }
}

/// A number as a whole one of 32 bits without a sign, if it is one.
pub(super) fn whole(number: f64) -> Option<u32> {
    let whole = number as u32;
    (f64::from(whole) == number).then_some(whole)
}

/// The file behind a byte-order mark, which some editors put before text: a first `v` of OBJ would
/// be another word with it. No binary format begins so.
pub(super) fn unmarked(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}
