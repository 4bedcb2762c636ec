//! Headers of LAS files, versions 1.0 to 1.4, and the records before their points. Where a header
//! contradicts the file, the file is right.

use super::sink::{Source, guarded, plain};
use glam::DVec3;
use laz::{LazItemRecordBuilder, LazItemType, LazVlr};
use std::io::{self, Read, SeekFrom};
use std::ops::Range;

/// Bytes of the longest header, that of version 1.4, and of the shortest.
const LONGEST: usize = 375;
const LEAST: usize = 227;
/// Bytes before the data of a record.
const RECORD: u64 = 54;
/// Bytes of a point by the format, and where its colour is; 0 if it has none.
const SIZES: [u64; 11] = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67];
const COLOURS: [usize; 11] = [0, 0, 20, 28, 0, 28, 0, 30, 30, 0, 30];

/// What is known of a file before its points.
pub(super) struct Head {
    /// Points, as the header says.
    pub count: u64,
    /// Where they begin, where they end at the latest, and where the file ends.
    pub start: u64,
    pub end: u64,
    pub length: u64,
    pub layout: Layout,
    /// How points are compressed.
    pub packed: Option<Packed>,
    /// The faults of the header, and how they were mended.
    pub warnings: Vec<String>,
}

/// The record of compressed points.
#[derive(Clone)]
pub(super) struct Packed {
    pub vlr: LazVlr,
    /// All points are one chunk, and no table follows them.
    pub is_one_chunk: bool,
}

/// A header of a file of `length` bytes.
struct Header {
    /// Zeros behind its end.
    bytes: Vec<u8>,
    length: u64,
    warnings: Vec<String>,
}

/// Reads the header of a file, whose source is then at the points.
pub(super) fn read(source: &mut impl Source) -> Result<Head, String> {
    let length = source.seek(SeekFrom::End(0)).map_err(plain)?;
    source.rewind().map_err(plain)?;
    let mut bytes = Vec::new();
    source.by_ref().take(LONGEST as u64).read_to_end(&mut bytes).map_err(plain)?;
    if bytes.len() < LEAST {
        return Err(format!("it ends after {length} bytes; a header has at least {LEAST}"));
    }
    bytes.resize(LONGEST, 0);
    let mut header = Header { bytes, length, warnings: Vec::new() };
    let size = header.size();
    let (format, is_packed) = (usize::from(header.bytes[104] & 0x3f), header.bytes[104] & 0xc0 != 0);
    let least =
        *SIZES.get(format).ok_or_else(|| format!("its points have the format {format}; 0 to 10 are read"))?;
    let count = header.count(format);
    let (stated, said) = (header.number(96, 4), header.number(105, 2));
    let is_sound = (size..=length).contains(&stated);
    let end = if is_sound { stated } else { length };
    let (behind, data) = records(source, size..end, header.number(100, 4), is_packed).map_err(plain)?;
    let start = if is_sound { stated } else { behind };
    if !is_sound {
        let needed = said.max(least).saturating_mul(count);
        let room = length.checked_sub(start);
        if room.is_none_or(|room| if is_packed { stated > length } else { needed > room }) {
            return Err(format!("its points begin at byte {stated}, and it has {length} bytes"));
        }
        header
            .warn(format!("its points cannot begin at byte {stated}: {start}, behind the records, is taken"));
    }
    if is_packed && data.is_none() {
        return Err("its points are compressed, and the record that says how is missing".into());
    }
    let packed = data.map(|data| {
        let vlr = guarded(|| LazVlr::from_buffer(&data))?;
        Ok::<_, String>(Packed { vlr, is_one_chunk: data.starts_with(&[1, 0]) })
    });
    let packed = packed.transpose()?;
    let record = match &packed {
        Some(packed) => check_items(&packed.vlr)?,
        // At least the bytes of the format, if the file has room for so many.
        None if said < 12 || count.checked_mul(least).is_some_and(|all| all <= length - start) => {
            said.max(least)
        }
        None => said,
    };
    if packed.is_some() && record != said {
        header.warn(format!("points have {said} bytes in its header, and {record} as they are compressed"));
    } else if packed.is_none() && said < least {
        header.warn(format!("its format has {least} bytes a point, its header {said}: {record} are taken"));
    }
    let (count, end) = header.room(start, record, count, packed.is_none());
    let record = record as usize;
    let colour = Some(COLOURS[format]).filter(|&at| at > 0 && at + 6 <= record);
    let layout = Layout { record, colour, scale: header.scale(), offset: header.offset() };
    source.seek(SeekFrom::Start(start)).map_err(plain)?;
    Ok(Head { count, start, end, length, layout, packed, warnings: header.warnings })
}

impl Header {
    fn warn(&mut self, what: String) {
        self.warnings.push(what);
    }

    /// A whole number of so many bytes.
    fn number(&self, at: usize, bytes: usize) -> u64 {
        self.bytes[at..at + bytes].iter().rev().fold(0, |number, &byte| number << 8 | u64::from(byte))
    }

    /// Three numbers, one for each axis.
    fn axes(&self, at: usize) -> DVec3 {
        DVec3::from_array([0, 8, 16].map(|axis| f64::from_bits(self.number(at + axis, 8))))
    }

    /// The bytes of the header itself. Fields that it has no room for become zero.
    fn size(&mut self) -> u64 {
        let version = self.bytes[25];
        let known = [LEAST, LEAST, LEAST, 235, LONGEST][usize::from(version.min(4))];
        let mut size = self.number(94, 2);
        if !(LEAST as u64..=self.length).contains(&size) {
            self.warn(format!(
                "its header cannot have {size} bytes: {known} are taken, as in version 1.{version}"
            ));
            size = known as u64;
        }
        self.bytes[known.min(size as usize)..].fill(0);
        size
    }

    /// The points that the header promises. Version 1.4 has two counts; formats of points from 6 on
    /// use the second only.
    fn count(&mut self, format: usize) -> u64 {
        let (old, new) = (self.number(107, 4), self.number(247, 8));
        if old == 0 || new == 0 || old == new {
            return old.max(new);
        }
        let count = if format >= 6 { new } else { old };
        self.warn(format!("its header promises {old} points, and {new}: {count} are taken"));
        count
    }

    /// How many points are read, and where they end at the latest: where something else begins, if
    /// there is no room for all before the end of the file.
    fn room(&mut self, start: u64, record: u64, mut count: u64, is_plain: bool) -> (u64, u64) {
        let length = self.length;
        let others = [227, 235].map(|at| self.number(at, 8));
        let next = others.into_iter().filter(|other| (start + 1..length).contains(other));
        let next = next.min().unwrap_or(length);
        let room = (next - start) / record;
        if is_plain && count < room && (next - start).is_multiple_of(record) {
            let taken = if count == 0 { room } else { count };
            self.warn(format!("it promises {count} points, and it has room for {room}: {taken} are read"));
            count = taken;
        }
        (count, if record.saturating_mul(count) > length - start { next } else { length })
    }

    /// The steps of coordinates. In the place of one that is none comes that of another axis, or 1:
    /// the cloud then has the shape that it should have.
    fn scale(&mut self) -> DVec3 {
        let mut scale = self.axes(131);
        let is_good = |step: &f64| step.is_finite() && *step != 0.0;
        let other = scale.to_array().into_iter().find(is_good).unwrap_or(1.0);
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            if !is_good(&scale[axis]) {
                self.warn(format!("the scale of {name} cannot be {}: {other} is taken", scale[axis]));
                scale[axis] = other;
            }
        }
        scale
    }

    fn offset(&mut self) -> DVec3 {
        let offset = self.axes(155);
        if !offset.is_finite() {
            self.warn(format!("the offset of its points is {offset}: 0 is taken where it is not finite"));
        }
        DVec3::select(offset.is_finite_mask(), offset, DVec3::ZERO)
    }
}

/// Reads the records in some bytes: where they end, and that of compressed points, which is sought
/// also behind the number of records that the header promises.
fn records(
    source: &mut impl Source,
    mut bytes: Range<u64>,
    promised: u64,
    is_packed: bool,
) -> io::Result<(u64, Option<Vec<u8>>)> {
    let (mut found, mut packed) = (0, None);
    while (found < promised || is_packed && packed.is_none()) && bytes.start + RECORD <= bytes.end {
        let mut head = [0; RECORD as usize];
        source.seek(SeekFrom::Start(bytes.start))?;
        source.read_exact(&mut head)?;
        let size = u16::from_le_bytes([head[20], head[21]]);
        let next = bytes.start + RECORD + u64::from(size);
        if next > bytes.end {
            break;
        }
        let is_packing =
            head[2..18].starts_with(b"laszip encoded") && head[18..20] == LazVlr::RECORD_ID.to_le_bytes();
        if is_packed && is_packing && packed.is_none() {
            let mut data = vec![0; size.into()];
            source.read_exact(&mut data)?;
            packed = Some(data);
        }
        (bytes.start, found) = (next, found + 1);
    }
    Ok((bytes.start, packed))
}

/// Where the parts of a point lie in its record, which begins with three whole numbers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    /// Bytes of a point, at least 12.
    pub record: usize,
    /// Where the colour is: three numbers of 16 bits.
    pub colour: Option<usize>,
    /// What makes a place of the numbers.
    pub scale: DVec3,
    pub offset: DVec3,
}

/// Bytes of a point behind those of its format, in LAZ: each takes 10 kB in the decoder.
const MOST_EXTRA_BYTES: u64 = 4096;

/// Checks the parts of compressed points, as the decoder takes memory for each. Gives the bytes of a point.
fn check_items(vlr: &LazVlr) -> Result<u64, String> {
    let (mut size, mut extra, mut kinds) = (0, 0, Vec::new());
    for item in vlr.items() {
        let (kind, bytes) = (item.item_type(), u64::from(item.size()));
        let own = LazItemRecordBuilder::new().add_item(kind).build();
        if own.iter().any(|own| own.size() != item.size()) {
            return Err(format!("compressed points have {kind:?} of {bytes} bytes a point"));
        }
        if kinds.contains(&u16::from(kind)) {
            return Err(format!("compressed points have the item {} twice", u16::from(kind)));
        }
        kinds.push(kind.into());
        size += bytes;
        if matches!(kind, LazItemType::Byte(_) | LazItemType::Byte14(_)) {
            extra += bytes;
        }
    }
    if extra > MOST_EXTRA_BYTES {
        return Err(format!(
            "compressed points have {extra} extra bytes; at most {MOST_EXTRA_BYTES} are read"
        ));
    }
    let first = vlr.items().first().map(|item| item.item_type());
    match first {
        Some(LazItemType::Point10 | LazItemType::Point14) => Ok(size),
        _ => Err(format!("compressed points have {size} bytes a point, and do not begin with a place")),
    }
}
