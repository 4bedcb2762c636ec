//! E57, by the crate of that name. Sizes in a file are checked before it reserves memory for them.

use super::sink::{Attributes, FileError, Sample, Sink, Source, guarded, plain, unit_to_byte};
use e57::{CartesianCoordinate, E57Reader, PointCloud, RecordDataType};
use glam::DVec3;
use std::io::SeekFrom;

/// Attributes of a point, at most: the standard has 20, and extensions add some.
const MOST_ATTRIBUTES: usize = 64;
/// Bits of a point, at least: an attribute without bits costs 16 bytes of memory a point, a point 150.
const LEAST_BITS: u64 = 8;
/// Declarations of namespaces, and attributes of an element, at most: the parser of XML compares
/// each with all others.
const MOST_NAMES: usize = 256;

/// Reads all scans of a file, each moved by its pose.
pub(super) fn read<E: From<FileError>>(mut source: impl Source, sink: &mut Sink<'_, E>) -> Result<(), E> {
    let length = guarded(|| check_xml(&mut source)).map_err(|e| sink.header("E57", e))?;
    let mut reader = guarded(|| E57Reader::new(source)).map_err(|e| sink.header("E57", e))?;
    let scans = reader.pointclouds();
    let has = Attributes { colours: scans.iter().any(PointCloud::has_color), ..Attributes::default() };
    let mut room = u128::from(length);
    for (number, scan) in scans.iter().enumerate() {
        let opened = check_scan(scan, &mut room).and_then(|()| guarded(|| reader.pointcloud_simple(scan)));
        let mut points = match opened {
            Ok(points) => points,
            Err(cause) => {
                sink.lose(sink.point(format!("scan {number}"), cause), scan.records);
                continue;
            }
        };
        for index in 0.. {
            let point = match guarded(|| points.next().transpose()) {
                Ok(Some(point)) => point,
                Ok(None) => break,
                Err(cause) => {
                    let place = format!("scan {number}, point {index} of {}", scan.records);
                    sink.lose(sink.point(place, cause), scan.records.saturating_sub(index));
                    break;
                }
            };
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

/// Checks the XML: its length, which stands at byte 32, and how many names there are to compare.
/// Gives the length of the file.
fn check_xml(source: &mut impl Source) -> Result<u64, String> {
    let length = source.seek(SeekFrom::End(0)).map_err(plain)?;
    let mut bytes = [0; 8];
    source.seek(SeekFrom::Start(32)).map_err(plain)?;
    source.read_exact(&mut bytes).map_err(plain)?;
    let xml = u64::from_le_bytes(bytes);
    if xml > length {
        return Err(format!("it promises {xml} bytes of XML, and has {length} bytes in all"));
    }
    let xml = E57Reader::raw_xml(&mut *source).map_err(plain)?;
    let spaces = xml.windows(5).filter(|w| w == b"xmlns").count();
    // No value of an attribute holds a `<`. Texts are counted too, but those of marked sections are not.
    let is_text = |part: &[u8]| part.starts_with(b"![CDATA[") || part.starts_with(b"!--");
    let parts = xml.split(|&b| b == b'<').filter(|part| !is_text(part));
    let attributes = parts.map(|part| part.iter().filter(|&&b| b == b'=').count()).max().unwrap_or(0);
    if spaces.max(attributes) > MOST_NAMES {
        return Err(format!("its XML has more than {MOST_NAMES} namespaces, or attributes of an element"));
    }
    source.rewind().map_err(plain)?;
    Ok(length)
}

/// Checks the points of a scan, and that they fit into what other scans leave of the file.
fn check_scan(scan: &PointCloud, room: &mut u128) -> Result<(), String> {
    let attributes = scan.prototype.len();
    if attributes > MOST_ATTRIBUTES {
        return Err(format!("its points have {attributes} attributes; at most {MOST_ATTRIBUTES} are read"));
    }
    let bits: u64 = scan.prototype.iter().map(|record| bits(&record.data_type)).sum();
    if bits < LEAST_BITS && scan.records > 0 {
        return Err(format!("a point has {bits} bits; at least {LEAST_BITS} are read"));
    }
    let needed = u128::from(scan.records) * u128::from(bits) / 8;
    if needed > *room {
        return Err(format!("its points take {needed} bytes, and the file has room for {room}"));
    }
    *room -= needed;
    Ok(())
}

/// The bits of an attribute in the file: as many as its range of integers needs.
fn bits(kind: &RecordDataType) -> u64 {
    match *kind {
        RecordDataType::Single { .. } => 32,
        RecordDataType::Double { .. } => 64,
        RecordDataType::ScaledInteger { min, max, .. } | RecordDataType::Integer { min, max } => {
            (i128::from(max) - i128::from(min)).checked_ilog2().map_or(0, |log| u64::from(log) + 1)
        }
    }
}
