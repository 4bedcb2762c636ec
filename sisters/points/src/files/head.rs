//! Headers of LAS files, versions 1.0 to 1.4, and the records before their points. Where a header
//! contradicts the file, the file is right.

use std::io::{self, Read, SeekFrom};

use glam::DVec3;
use laz::{LazItemRecordBuilder, LazItemType, LazVlr};

use super::sink::{FileError, Sink, Source, guarded, plain};

/// Bytes of the longest header, that of version 1.4, and of the shortest.
const LONGEST: usize = 375;
const LEAST: usize = 227;
/// Bytes before the data of a record.
const RECORD: u64 = 54;
/// Bytes of a point and where its colour is, by the format.
const FORMATS: [(u16, Option<usize>); 11] = [
    (20, None),
    (28, None),
    (26, Some(20)),
    (34, Some(28)),
    (57, None),
    (63, Some(28)),
    (30, None),
    (36, Some(30)),
    (38, Some(30)),
    (59, None),
    (67, Some(30)),
];

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
}

/// The record of compressed points.
#[derive(Clone)]
pub(super) struct Packed {
    pub vlr: LazVlr,
    /// All points are one chunk, and no table follows them.
    pub is_one_chunk: bool,
}

/// The bytes of a header; zeros behind its end.
struct Bytes([u8; LONGEST]);

impl Bytes {
    fn at<const N: usize>(&self, at: usize) -> [u8; N] {
        std::array::from_fn(|i| self.0[at + i])
    }

    fn u16(&self, at: usize) -> u16 {
        u16::from_le_bytes(self.at(at))
    }

    fn u32(&self, at: usize) -> u32 {
        u32::from_le_bytes(self.at(at))
    }

    fn u64(&self, at: usize) -> u64 {
        u64::from_le_bytes(self.at(at))
    }

    /// Three numbers, one for each axis.
    fn axes(&self, at: usize) -> DVec3 {
        DVec3::from_array([0, 8, 16].map(|axis| f64::from_le_bytes(self.at(at + axis))))
    }

    /// The second number of the version.
    fn version(&self) -> usize {
        self.0[25].into()
    }
}

/// Reads the header of a file, whose source is then at the points.
pub(super) fn open<E: From<FileError>>(
    source: &mut impl Source,
    sink: &mut Sink<'_, E>,
) -> Result<Head, FileError> {
    read(source, sink).map_err(|e| sink.header("LAS", e))
}

fn read<E: From<FileError>>(source: &mut impl Source, sink: &mut Sink<'_, E>) -> Result<Head, String> {
    let length = source.seek(SeekFrom::End(0)).map_err(plain)?;
    source.rewind().map_err(plain)?;
    let mut bytes = Vec::new();
    source.by_ref().take(LONGEST as u64).read_to_end(&mut bytes).map_err(plain)?;
    if bytes.len() < LEAST {
        return Err(format!("it ends after {length} bytes; a header has at least {LEAST}"));
    }
    bytes.resize(LONGEST, 0);
    let mut bytes = Bytes(bytes.try_into().map_err(|_| "it is too long")?);
    let size = size(&mut bytes, length, sink);
    let (format, is_packed) = (bytes.0[104] & 0x3f, bytes.0[104] & 0xc0 != 0);
    let &(least, colour) = FORMATS
        .get(usize::from(format))
        .ok_or_else(|| format!("its points have the format {format}; 0 to 10 are read"))?;
    let count = count(&bytes, format, sink);
    let stated = u64::from(bytes.u32(96));
    let is_sound = (size..=length).contains(&stated);
    let mut records = Records { at: size, found: 0, packed: None };
    let end = if is_sound { stated } else { length };
    records.read(source, bytes.u32(100), is_packed, end).map_err(plain)?;
    let mut start = stated;
    if !is_sound {
        let needed = u64::from(bytes.u16(105).max(least)).saturating_mul(count);
        let room = length.checked_sub(records.at);
        if room.is_none_or(|room| if is_packed { stated > length } else { needed > room }) {
            return Err(format!("its points begin at byte {stated}, and it has {length} bytes"));
        }
        start = records.at;
        sink.warn(format_args!(
            "its points cannot begin at byte {stated}: {start}, behind the records, is taken"
        ));
    }
    let packed = match records.packed {
        Some(data) if is_packed => Some(packed(&data)?),
        None if is_packed => {
            return Err("its points are compressed, and the record that says how is missing".into());
        }
        _ => None,
    };
    let record = match &packed {
        Some(packed) => packed_record(&bytes, packed, sink)?,
        None => plain_record(&bytes, least.into(), count, length - start, sink),
    };
    let layout = Layout {
        record: record as usize,
        colour: colour.filter(|at| at + 6 <= record as usize),
        scale: scale(&bytes, sink),
        offset: offset(&bytes, sink),
    };
    let (count, end) = room(&bytes, (start, length), (record, count), packed.is_none(), sink);
    source.seek(SeekFrom::Start(start)).map_err(plain)?;
    Ok(Head { count, start, end, length, layout, packed })
}

/// The bytes of the header itself. Fields that it has no room for become zero.
fn size<E: From<FileError>>(bytes: &mut Bytes, length: u64, sink: &mut Sink<'_, E>) -> u64 {
    let version = bytes.version();
    let known = [LEAST, LEAST, LEAST, 235, LONGEST][version.min(4)];
    let said = usize::from(bytes.u16(94));
    let is_good = said >= LEAST && said as u64 <= length;
    let size = if is_good { said } else { known };
    if !is_good {
        sink.warn(format_args!(
            "its header cannot have {said} bytes: {known} are taken, as in version 1.{version}"
        ));
    }
    let used = size.min(known);
    bytes.0[used.min(LONGEST)..].fill(0);
    size as u64
}

/// The bytes of a compressed point: those of its parts.
fn packed_record<E: From<FileError>>(
    bytes: &Bytes,
    packed: &Packed,
    sink: &mut Sink<'_, E>,
) -> Result<u64, String> {
    let (said, own) = (u64::from(bytes.u16(105)), check_items(&packed.vlr)?);
    if own != said {
        sink.warn(format_args!("points have {said} bytes in its header, and {own} as they are compressed"));
    }
    Ok(own)
}

/// The bytes of a point that is not compressed; at least those of its format, if the file has room
/// for so many.
fn plain_record<E: From<FileError>>(
    bytes: &Bytes,
    least: u64,
    count: u64,
    room: u64,
    sink: &mut Sink<'_, E>,
) -> u64 {
    let said = u64::from(bytes.u16(105));
    if said >= least {
        return said;
    }
    let has_room = said < 12 || count.checked_mul(least).is_some_and(|all| all <= room);
    let taken = if has_room { least } else { said };
    sink.warn(format_args!(
        "points of its format have {least} bytes, in its header {said}: {taken} are taken"
    ));
    taken
}

/// The points that the header promises. Version 1.4 has two counts; formats of points from 6 on use
/// the second only.
fn count<E: From<FileError>>(bytes: &Bytes, format: u8, sink: &mut Sink<'_, E>) -> u64 {
    let (old, new) = (u64::from(bytes.u32(107)), bytes.u64(247));
    if old == 0 || new == 0 || old == new {
        return old.max(new);
    }
    let count = if format >= 6 { new } else { old };
    sink.warn(format_args!("its header promises {old} points, and {new}: {count} are taken"));
    count
}

/// How many points are read, and where they end at the latest: where something else begins, if
/// there is no room for all before the end of the file.
fn room<E: From<FileError>>(
    bytes: &Bytes,
    (start, length): (u64, u64),
    (record, mut count): (u64, u64),
    is_plain: bool,
    sink: &mut Sink<'_, E>,
) -> (u64, u64) {
    let others =
        [bytes.u64(227), bytes.u64(235)].into_iter().filter(|other| (start + 1..length).contains(other));
    let next = others.min().unwrap_or(length);
    let room = (next - start) / record;
    if is_plain && count < room && (next - start) % record == 0 {
        let taken = if count == 0 { room } else { count };
        sink.warn(format_args!(
            "its header promises {count} points, and it has room for {room}: {taken} are read"
        ));
        count = taken;
    }
    (count, if record.saturating_mul(count) > length - start { next } else { length })
}

/// The steps of coordinates. In the place of one that is none comes that of another axis, or 1: the
/// cloud then has the shape that it should have.
fn scale<E: From<FileError>>(bytes: &Bytes, sink: &mut Sink<'_, E>) -> DVec3 {
    let mut scale = bytes.axes(131);
    let is_good = |step: &f64| step.is_finite() && *step != 0.0;
    let other = scale.to_array().into_iter().find(is_good).unwrap_or(1.0);
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        if !is_good(&scale[axis]) {
            sink.warn(format_args!("the scale of {name} cannot be {}: {other} is taken", scale[axis]));
            scale[axis] = other;
        }
    }
    scale
}

fn offset<E: From<FileError>>(bytes: &Bytes, sink: &mut Sink<'_, E>) -> DVec3 {
    let mut offset = bytes.axes(155);
    if !offset.is_finite() {
        sink.warn(format_args!(
            "the offset of its points cannot be {offset}: 0 is taken where it is not finite"
        ));
        offset = DVec3::select(offset.is_finite_mask(), offset, DVec3::ZERO);
    }
    offset
}

/// The record of compressed points.
fn packed(data: &[u8]) -> Result<Packed, String> {
    let vlr = guarded(|| LazVlr::from_buffer(data))?;
    Ok(Packed { vlr, is_one_chunk: data.starts_with(&[1, 0]) })
}

/// The records between the header and the points.
struct Records {
    /// Where the next one begins.
    at: u64,
    found: u32,
    packed: Option<Vec<u8>>,
}

impl Records {
    /// Reads those before a byte. Only that of compressed points is kept; it is also sought behind
    /// the number of records that the header promises.
    fn read(&mut self, source: &mut impl Source, promised: u32, is_packed: bool, end: u64) -> io::Result<()> {
        while self.found < promised || is_packed && self.packed.is_none() {
            let mut head = [0; RECORD as usize];
            if self.at + RECORD > end {
                break;
            }
            source.seek(SeekFrom::Start(self.at))?;
            source.read_exact(&mut head)?;
            let size = u16::from_le_bytes([head[20], head[21]]);
            let next = self.at + RECORD + u64::from(size);
            if next > end {
                break;
            }
            let id = LazVlr::RECORD_ID.to_le_bytes();
            let is_packing = head[2..18].starts_with(b"laszip encoded") && head[18..20] == id;
            if is_packing && self.packed.is_none() {
                let mut data = vec![0; size.into()];
                source.read_exact(&mut data)?;
                self.packed = Some(data);
            }
            (self.at, self.found) = (next, self.found + 1);
        }
        Ok(())
    }
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

/// Checks the parts of compressed points, as the decoder takes memory for each. Gives the bytes of
/// a point.
fn check_items(vlr: &LazVlr) -> Result<u64, String> {
    let items = vlr.items();
    let size: u64 = items.iter().map(|item| u64::from(item.size())).sum();
    for item in items {
        let own = LazItemRecordBuilder::new().add_item(item.item_type()).build();
        if own.iter().any(|own| own.size() != item.size()) {
            let (kind, size) = (item.item_type(), item.size());
            return Err(format!("compressed points have {kind:?} of {size} bytes a point"));
        }
    }
    let is_place = |kind: LazItemType| matches!(kind, LazItemType::Point10 | LazItemType::Point14);
    if !items.first().is_some_and(|item| is_place(item.item_type())) {
        return Err(format!("compressed points have {size} bytes a point, and do not begin with a place"));
    }
    let is_bytes = |kind: LazItemType| matches!(kind, LazItemType::Byte(_) | LazItemType::Byte14(_));
    let extra: u64 =
        items.iter().filter(|item| is_bytes(item.item_type())).map(|item| u64::from(item.size())).sum();
    if extra > MOST_EXTRA_BYTES {
        return Err(format!(
            "compressed points have {extra} extra bytes; at most {MOST_EXTRA_BYTES} are read"
        ));
    }
    let kinds = || items.iter().map(|item| u16::from(item.item_type()));
    match kinds().enumerate().find(|&(i, kind)| kinds().take(i).any(|other| other == kind)) {
        Some((_, kind)) => Err(format!("compressed points have the item {kind} twice")),
        None => Ok(size),
    }
}
