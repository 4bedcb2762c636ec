//! LAS and LAZ, by the crates `las` and `laz`. Sizes in a file are checked before these reserve
//! memory for them.

use std::io::{self, BufRead, Seek, SeekFrom};
use std::panic::resume_unwind;
use std::thread;

use glam::DVec3;
use las::{Builder, Header, PointData, Vlr, raw};
use laz::LasZipDecompressor;

use super::copc;
use super::guarded::guarded;
use super::layers::{Layers, STACK};
use super::levels::{Levels, Selection};
use super::records::{check_items, decoded, hand_out, room, wanted};
use super::sink::{FileError, Sink, Source};
use crate::numeric;

/// The least record of a point.
const LEAST_RECORD: u64 = 20;

pub(super) fn read<E: From<FileError>>(mut source: impl Source, sink: &mut Sink<'_, E>) -> Result<(), E> {
    let header = open(&mut source, sink)?;
    if sink.wanted != Selection::default() {
        match header.vlrs().iter().find(|vlr| vlr.is_copc_info()) {
            Some(info) => return copc::read(source, &header, &info.data, sink),
            None if sink.wanted.levels != Levels::All => return Err(sink.no_levels("LAS").into()),
            None => {}
        }
    }
    read_all(source, &header, sink)
}

/// The header of a file, whose source is then at the points.
pub(super) fn open<E>(source: &mut impl Source, sink: &mut Sink<'_, E>) -> Result<Header, FileError>
where
    E: From<FileError>,
{
    let header = guarded(|| header(source)).map_err(|e| sink.header("LAS", e))?;
    let bounds = header.bounds();
    let low = DVec3::new(bounds.min.x, bounds.min.y, bounds.min.z);
    let middle = low.midpoint(DVec3::new(bounds.max.x, bounds.max.y, bounds.max.z));
    sink.origin = sink.origin.or_else(|| middle.is_finite().then(|| numeric::origin_near(middle)));
    Ok(header)
}

/// Reads all points, in their order.
pub(super) fn read_all<E: From<FileError>>(
    source: impl Source,
    header: &Header,
    sink: &mut Sink<'_, E>,
) -> Result<(), E> {
    let count = header.number_of_points();
    let mut points = guarded(|| Points::new(source, header)).map_err(|e| sink.header("LAS", e))?;
    let mut read = 0;
    while read < count {
        let batch = guarded(|| points.next(count - read, header));
        let batch = batch.map_err(|e| sink.point(format!("after point {read} of {count}"), e))?;
        read += batch.len() as u64;
        hand_out(&batch, sink)?;
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
        let first_info = vlr.is_copc_info() && !builder.vlrs.iter().any(Vlr::is_copc_info);
        if las::laz::is_laszip_vlr(&vlr) || first_info {
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
        let mut bytes = room(left, header);
        match self {
            Self::Plain(source) => source.read_exact(&mut bytes),
            Self::Packed(decoder) => unpack(decoder, &mut bytes),
        }
        .map_err(|e| e.to_string())?;
        decoded(bytes, header)
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
