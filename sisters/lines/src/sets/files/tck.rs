//! MRtrix tracks: tractograms, lines through the white matter of brains from diffusion imaging.
//! <https://mrtrix.readthedocs.io/en/latest/getting_started/image_data.html#tracks-file-format-tck>

use glam::Vec3;

use super::bytes::{Bytes, Kind};
use super::error::{FileError, broken};
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
    let (mut offset, mut order, mut at) = (None, None, 0);
    for (i, line) in bytes.split(|b| *b == b'\n').enumerate() {
        let line = String::from_utf8_lossy(line.get(..line.len().min(200)).unwrap_or_default());
        if i == 0 && line.trim() != "mrtrix tracks" {
            let scalars = line.trim() == "mrtrix track scalars";
            let more = if scalars { "; this one has the scalars of another file" } else { "" };
            return Err(broken("byte", 0, format!("a TCK file starts with \"mrtrix tracks\"{more}")));
        }
        match line.split_once(':').map(|(k, v)| (k.trim(), v.trim())) {
            Some(("file", v)) => offset = v.strip_prefix('.').and_then(|v| v.trim().parse::<usize>().ok()),
            Some(("datatype", "Float32LE")) => order = Some((Kind::Float(4), false)),
            Some(("datatype", "Float32BE")) => order = Some((Kind::Float(4), true)),
            Some(("datatype", "Float64LE")) => order = Some((Kind::Float(8), false)),
            Some(("datatype", "Float64BE")) => order = Some((Kind::Float(8), true)),
            Some(("datatype", other)) => {
                let read = "Float32LE, Float32BE, Float64LE and Float64BE are read";
                return Err(broken("line", i + 1, format!("data of {other}: only {read}")));
            }
            None if line.trim() == "END" => break,
            _ => {}
        }
        at += 1;
    }
    let offset = offset.ok_or_else(|| broken("line", at, "the header lacks \"file: . OFFSET\""))?;
    let (kind, big) = order.ok_or_else(|| broken("line", at, "the header lacks a datatype"))?;
    Ok(Header { offset, kind, big })
}
