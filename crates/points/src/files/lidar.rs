//! LAS and LAZ, by the crates `las` and `laz`. Sizes in a file are checked before these reserve
//! memory for them.

use std::io::{self, BufRead, Seek, SeekFrom};
use std::panic::resume_unwind;
use std::thread;

use glam::DVec3;
use las::{Builder, Header, PointData, PointDataBuilder, Vlr, raw};
use laz::{DecompressionSelection, LasZipDecompressor, LazItemRecordBuilder, LazItemType, LazVlr};

use super::guarded::guarded;
use super::layers::{Layers, STACK};
use super::sink::{Attributes, FileError, Sample, Sink, Source};
use crate::numeric;

/// Points that are decoded at once.
const BATCH: u64 = 1 << 16;
/// Bytes of points that are decoded at once, at most: records may have 64 KiB.
const BATCH_BYTES: u64 = 1 << 22;
/// Bytes of a point behind those of its format, in LAZ: each takes 10 kB in the decoder.
const MOST_EXTRA_BYTES: u64 = 4096;
/// The least record of a point.
const LEAST_RECORD: u64 = 20;

pub(super) fn read<E: From<FileError>>(mut source: impl Source, sink: &mut Sink<'_, E>) -> Result<(), E> {
    let header = guarded(|| header(&mut source)).map_err(|e| sink.header("LAS", e))?;
    let mut points = guarded(|| Points::new(source, &header)).map_err(|e| sink.header("LAS", e))?;
    let (bounds, count) = (header.bounds(), header.number_of_points());
    let low = DVec3::new(bounds.min.x, bounds.min.y, bounds.min.z);
    let middle = low.midpoint(DVec3::new(bounds.max.x, bounds.max.y, bounds.max.z));
    sink.origin = middle.is_finite().then(|| numeric::origin_near(middle));
    let mut read = 0;
    // The bits below a colour's byte, known from the first batch that is not black.
    let mut shift = None;
    while read < count {
        let batch = guarded(|| points.next(count - read, &header));
        let batch = batch.map_err(|e| sink.point(format!("after point {read} of {count}"), e))?;
        read += batch.len() as u64;
        if shift.is_none() {
            let channels = batch.rgb().into_iter().flatten().flat_map(|(r, g, b)| [r, g, b]);
            shift = channels.max().filter(|&most| most > 0).map(|most| if most > 255 { 8 } else { 0 });
        }
        // The standard demands 16 bits a channel, but some programs write 8.
        let byte = |c: u16| (c >> shift.unwrap_or(8)).min(255) as u8;
        let mut colours = batch.rgb().map(|all| all.map(|(r, g, b)| [r, g, b].map(byte)));
        let has = Attributes { colours: colours.is_some(), ..Attributes::default() };
        for ((x, y), z) in batch.x().zip(batch.y()).zip(batch.z()) {
            let colour = colours.as_mut().and_then(Iterator::next).unwrap_or(Sample::NONE.colour);
            sink.push(Sample { position: DVec3::new(x, y, z), colour, ..Sample::NONE }, has)?;
        }
    }
    Ok(())
}

/// The header and the records before the points; the source is then at the points.
///
/// Not by [`Header::new`]: that reads the records behind the points too, and believes their
/// lengths.
fn header(source: &mut impl Source) -> Result<Header, String> {
    let raw = raw::Header::read_from(&mut *source).map_err(|e| e.to_string())?;
    let points = u64::from(raw.offset_to_point_data);
    let large = raw.large_file.map_or(0, |l| l.number_of_point_records);
    let count = large.max(raw.number_of_point_records.into());
    let end = count.checked_mul(raw.point_data_record_length.into()).and_then(|n| n.checked_add(points));
    if end.is_none_or(|end| end > i64::MAX as u64) {
        return Err(format!("it promises {count} points"));
    }
    let records = raw.number_of_variable_length_records;
    let mut builder = Builder::new(raw).map_err(|e| e.to_string())?;
    for _ in 0..records {
        let vlr = raw::Vlr::read_from(&mut *source, false).map(Vlr::new).map_err(|e| e.to_string())?;
        if las::laz::is_laszip_vlr(&vlr) {
            builder.vlrs.push(vlr);
        }
    }
    if source.stream_position().map_err(|e| e.to_string())? > points {
        return Err(format!("the points begin at byte {points}, within the header"));
    }
    source.seek(SeekFrom::Start(points)).map_err(|e| e.to_string())?;
    builder.into_header().map_err(|e| e.to_string())
}

/// The points of a file, in their order.
enum Points<S: Source> {
    Plain(S),
    Packed(Box<LasZipDecompressor<'static, Layers<S>>>),
}

impl<S: Source> Points<S> {
    /// From the first point on, where the source must be.
    fn new(mut source: S, header: &Header) -> Result<Self, String> {
        if !header.point_format().is_compressed {
            return Ok(Self::Plain(source));
        }
        let vlr = header.laz_vlr().map_err(|e| e.to_string())?;
        let record = u64::from(header.point_format().len());
        check_items(&vlr, record)?;
        let length = check_chunks(&mut source).map_err(|e| e.to_string())?;
        let source = Layers::new(source, &vlr, length);
        let mut decoder = LasZipDecompressor::selective(source, vlr, wanted()).map_err(|e| e.to_string())?;
        decoder.get_mut().begin().map_err(|e| e.to_string())?;
        Ok(Self::Packed(Box::new(decoder)))
    }

    /// The next points, at least one of the `left`.
    fn next(&mut self, left: u64, header: &Header) -> Result<PointData, String> {
        let record = u64::from(header.point_format().len());
        let count = left.min(BATCH).min((BATCH_BYTES / record.max(1)).max(1));
        let mut bytes = vec![0; (count * record) as usize];
        match self {
            Self::Plain(source) => source.read_exact(&mut bytes),
            Self::Packed(decoder) => unpack(decoder, &mut bytes),
        }
        .map_err(|e| e.to_string())?;
        PointDataBuilder::new().for_header(header).build_from_bytes(bytes).map_err(|e| e.to_string())
    }
}

/// Decodes points, on a stack that is deep enough.
fn unpack<S: Source>(
    decoder: &mut LasZipDecompressor<'static, Layers<S>>,
    into: &mut [u8],
) -> io::Result<()> {
    let decode = || {
        decoder.get_mut().watch();
        decoder.decompress_many(into)
    };
    thread::scope(|scope| {
        let decoding = thread::Builder::new().stack_size(STACK).spawn_scoped(scope, decode)?;
        decoding.join().unwrap_or_else(|panic| resume_unwind(panic))
    })
}

/// The layers that are decoded, where points lie in layers. On times the decoder would recurse as
/// often as a file says, and overflow the stack.
fn wanted() -> DecompressionSelection {
    DecompressionSelection::base().decompress_z().decompress_rgb()
}

/// Checks that the parts of compressed points make up a record: the decoder takes memory for each
/// part.
fn check_items(vlr: &LazVlr, record: u64) -> Result<(), String> {
    let items = vlr.items();
    let size: u64 = items.iter().map(|item| u64::from(item.size())).sum();
    if items.is_empty() || size != record {
        return Err(format!("compressed points have {size} bytes a point, the header says {record}"));
    }
    for item in items {
        let own = LazItemRecordBuilder::new().add_item(item.item_type()).build();
        if own.iter().any(|own| own.size() != item.size()) {
            return Err(format!("compressed points have {:?} of {} bytes", item.item_type(), item.size()));
        }
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
        None => Ok(()),
    }
}

/// Checks the number of compressed chunks, which `laz` reserves memory for: each has at least a
/// point. Gives the length of the file.
///
/// Compressed points begin with the offset of the table of chunks, or -1 and the file ends with it.
fn check_chunks(source: &mut (impl BufRead + Seek)) -> io::Result<u64> {
    let points = source.stream_position()?;
    let length = source.seek(SeekFrom::End(0))?;
    let mut read = |from: SeekFrom| {
        let mut bytes = [0; 8];
        source.seek(from)?;
        source.read_exact(&mut bytes).map(|()| u64::from_le_bytes(bytes))
    };
    let mut table = read(SeekFrom::Start(points))?;
    if table as i64 <= points as i64 {
        table = read(SeekFrom::End(-8))?;
    }
    // A table beyond the end is no table: the crate does without, or says so.
    let chunks = read(SeekFrom::Start(table)).map_or(0, |version_and_count| version_and_count >> 32);
    if chunks > length / LEAST_RECORD {
        return Err(io::Error::other(format!("{chunks} chunks in {length} bytes")));
    }
    source.seek(SeekFrom::Start(points))?;
    Ok(length)
}
