//! Files of laser scans: LAS and LAZ (crate `las`), E57 (crate `e57`).

use std::io::{self, SeekFrom};
use std::panic::{self, AssertUnwindSafe};

use e57::{CartesianCoordinate, E57Reader};
use glam::DVec3;
use las::Reader;

use super::sink::{Attributes, FileError, Sample, Sink, Source, unit_to_byte};
use crate::numeric;

/// Points that are decoded at once.
const BATCH: u64 = 1 << 16;

pub(super) fn read_las<E: From<FileError>>(mut source: impl Source, sink: &mut Sink<'_, E>) -> Result<(), E> {
    check_chunks(&mut source).map_err(|e| sink.header("LAS", e))?;
    let mut reader = guarded(|| Reader::new(source)).map_err(|e| sink.header("LAS", e))?;
    let header = reader.header();
    let (bounds, count) = (header.bounds(), header.number_of_points());
    let low = DVec3::new(bounds.min.x, bounds.min.y, bounds.min.z);
    let middle = low.midpoint(DVec3::new(bounds.max.x, bounds.max.y, bounds.max.z));
    sink.origin = middle.is_finite().then(|| numeric::origin_near(middle));
    let mut read = 0;
    // The bits below a colour's byte, known from the first batch that is not black.
    let mut shift = None;
    while read < count {
        let place = || format!("after point {read} of {count}");
        let batch =
            guarded(|| reader.read_points(BATCH.min(count - read))).map_err(|e| sink.point(place(), e))?;
        if batch.is_empty() {
            return Err(sink.point(place(), "the file ends here").into());
        }
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

/// The result of a library. A panic in it, as `laz` has on some broken files, becomes an error: nothing of the library is used after it.
fn guarded<T, E: ToString>(call: impl FnOnce() -> Result<T, E>) -> Result<T, String> {
    let result = panic::catch_unwind(AssertUnwindSafe(call));
    match result {
        Ok(result) => result.map_err(|e| e.to_string()),
        Err(_) => Err("the decoder panicked".into()),
    }
}

/// Checks the number of compressed chunks, which `laz` allocates memory for: each is some bytes of the file.
///
/// The places are those of the LAS specification: the offset of the points at byte 96, the format, whose upper bits mark compression,
/// at byte 104. Compressed points begin with the offset of the table of chunks, or -1 and the file ends with it.
fn check_chunks(source: &mut impl Source) -> io::Result<()> {
    let length = source.seek(SeekFrom::End(0))?;
    let mut read = |from: SeekFrom| {
        let mut bytes = [0; 8];
        source.seek(from)?;
        source.read_exact(&mut bytes).map(|()| u64::from_le_bytes(bytes))
    };
    let points = read(SeekFrom::Start(96))? & 0xffff_ffff;
    if read(SeekFrom::Start(104))? & 0xc0 != 0 {
        let mut table = read(SeekFrom::Start(points))?;
        if table as i64 <= points as i64 {
            table = read(SeekFrom::End(-8))?;
        }
        // A table beyond the end is no table: the crate does without, or says so.
        let chunks = read(SeekFrom::Start(table)).map_or(0, |version_and_count| version_and_count >> 32);
        if chunks > length {
            return Err(io::Error::other(format!("{chunks} chunks in {length} bytes")));
        }
    }
    source.rewind()
}

/// Reads all scans of a file, each moved by its pose.
pub(super) fn read_e57<E: From<FileError>>(source: impl Source, sink: &mut Sink<'_, E>) -> Result<(), E> {
    let mut reader = guarded(|| E57Reader::new(source)).map_err(|e| sink.header("E57", e))?;
    let scans = reader.pointclouds();
    let has = Attributes { colours: scans.iter().any(e57::PointCloud::has_color), ..Attributes::default() };
    for (number, scan) in scans.iter().enumerate() {
        let mut points = guarded(|| reader.pointcloud_simple(scan)).map_err(|e| sink.header("E57", e))?;
        for index in 0.. {
            let point = guarded(|| points.next().transpose());
            let place = || format!("scan {number}, point {index} of {}", scan.records);
            let Some(point) = point.map_err(|e| sink.point(place(), e))? else { break };
            let position = match point.cartesian {
                CartesianCoordinate::Valid { x, y, z } => DVec3::new(x, y, z),
                _ => DVec3::NAN,
            };
            let colour = point
                .color
                .map_or(Sample::NONE.colour, |c| [c.red, c.green, c.blue].map(|v| unit_to_byte(v.into())));
            sink.push(Sample { position, colour, ..Sample::NONE }, has)?;
        }
    }
    Ok(())
}
