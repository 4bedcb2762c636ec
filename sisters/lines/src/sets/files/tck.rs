//! MRtrix tracks: tractograms, lines through the white matter of brains from diffusion imaging.
//! <https://mrtrix.readthedocs.io/en/latest/getting_started/image_data.html#tracks-file-format-tck>

use glam::Vec3;

use super::bytes::{Bytes, Kind};
use super::error::{FileError, broken};
use super::words::Scan;
use crate::sets::LineSet;

/// The header: where the numbers start, their bytes, and whether the highest is first.
struct Header {
    offset: usize,
    kind: Kind,
    big: bool,
}

/// The lines of a TCK file: a text header with `datatype` and `file: . OFFSET`, triples of floats,
/// NaN after each line, infinity at the end.
pub(super) fn read(bytes: &[u8]) -> Result<LineSet, FileError> {
    let Header { offset, kind, big } = header(bytes)?;
    let mut file = Bytes { bytes, at: offset, big };
    let (mut lines, mut line) = (LineSet::default(), Vec::new());
    loop {
        let place = file.at;
        if (1..3 * kind.size()).contains(&file.left()) || file.left() == 0 && place > offset {
            let why = "the file ends without three infinite numbers, the mark of its end";
            return Err(broken("byte", place, why));
        }
        let mut next = || file.number(kind);
        let point = [next()?, next()?, next()?];
        // Marks fill all three coordinates; a vertex that lacks one is damaged.
        match point {
            _ if point.iter().all(|x| x.is_finite()) => line.push(Vec3::from(point.map(|x| x as f32))),
            mark if mark.iter().all(|x| x.is_nan()) => lines.push(line.drain(..))?,
            mark if line.is_empty() && mark.iter().all(|x| x.is_infinite()) => return Ok(lines),
            _ => {
                let point = Vec3::from(point.map(|x| x as f32));
                return Err(broken("byte", place, format!("vertex {point} of a line is not finite")));
            }
        }
    }
}

fn header(bytes: &[u8]) -> Result<Header, FileError> {
    // The place after the last line that is known.
    let (mut offset, mut order, mut known) = (None, None, 0);
    let mut text = Scan::new(bytes, "line");
    loop {
        let start = text.at;
        let line = text.line();
        let line = String::from_utf8_lossy(&line[..line.len().min(200)]);
        if start == 0 && line.trim() != "mrtrix tracks" {
            let scalars = line.trim() == "mrtrix track scalars";
            let more = if scalars { "; this one has the scalars of another file" } else { "" };
            return Err(broken("byte", 0, format!("a TCK file starts with \"mrtrix tracks\"{more}")));
        }
        if start == bytes.len() {
            let why = "the header does not end: a line END must stand before the numbers";
            return Err(text.fail_at(known, why));
        }
        match line.split_once(':').map(|(k, v)| (k.trim(), v.trim())) {
            Some(("file", v)) => {
                let named = v.strip_prefix('.').and_then(|v| v.trim().parse::<usize>().ok());
                offset = named.map(|offset| (offset, start));
                known = text.at;
            }
            Some(("datatype", name)) => {
                order = Some(match name.to_ascii_lowercase().as_str() {
                    "float32le" => (Kind::Float(4), false),
                    "float32be" => (Kind::Float(4), true),
                    "float64le" => (Kind::Float(8), false),
                    "float64be" => (Kind::Float(8), true),
                    _ => {
                        let read = "Float32LE, Float32BE, Float64LE and Float64BE are read";
                        return Err(text.fail_at(start, format!("data of {name}: only {read}")));
                    }
                });
                known = text.at;
            }
            None if line.trim() == "END" => {
                let lacks = |what: &str| text.fail_at(start, format!("the header lacks {what}"));
                let (offset, at) = offset.ok_or_else(|| lacks("\"file: . OFFSET\""))?;
                let (kind, big) = order.ok_or_else(|| lacks("a datatype"))?;
                let ended = start + "END".len();
                if offset < ended {
                    let why = format!("\"file: . {offset}\" names a byte of the header, which has {ended}");
                    return Err(text.fail_at(at, why));
                }
                return Ok(Header { offset, kind, big });
            }
            _ => {}
        }
    }
}
