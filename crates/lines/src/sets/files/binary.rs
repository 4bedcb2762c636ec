//! Tractograms: lines through the white matter of brains, from diffusion imaging.

use super::bytes::Bytes;
use super::error::{FileError, Lines, broken};

/// MRtrix: a text header with `datatype` and `file: . OFFSET`, triples of floats, NaN after each
/// line, infinity at the end.
/// <https://mrtrix.readthedocs.io/en/latest/getting_started/image_data.html#tracks-file-format-tck>
pub(super) fn tck(bytes: &[u8]) -> Lines {
    let (mut offset, mut big, mut at) = (None, None, 0);
    for (i, line) in bytes.split(|b| *b == b'\n').enumerate() {
        let line = String::from_utf8_lossy(line.get(..line.len().min(200)).unwrap_or_default());
        if i == 0 && line.trim() != "mrtrix tracks" {
            return Err(broken("byte", 0, "a TCK file starts with \"mrtrix tracks\""));
        }
        match line.split_once(':').map(|(k, v)| (k.trim(), v.trim())) {
            Some(("file", v)) => offset = v.strip_prefix('.').and_then(|v| v.trim().parse::<usize>().ok()),
            Some(("datatype", "Float32LE")) => big = Some(false),
            Some(("datatype", "Float32BE")) => big = Some(true),
            Some(("datatype", other)) => {
                return Err(broken(
                    "line",
                    i + 1,
                    format!("data of {other}: only Float32LE and Float32BE are read"),
                ));
            }
            None if line.trim() == "END" => break,
            _ => {}
        }
        at += 1;
    }
    let offset = offset.ok_or_else(|| broken("line", at, "the header lacks \"file: . OFFSET\""))?;
    let big = big.ok_or_else(|| broken("line", at, "the header lacks a datatype"))?;
    let mut file = Bytes { bytes, at: offset, big };
    let (mut lines, mut line) = (Vec::new(), Vec::new());
    loop {
        let place = file.at;
        let point = file.point()?;
        // Marks fill all three coordinates; a vertex that lacks one is damaged.
        match point.to_array() {
            _ if point.is_finite() => line.push(point),
            mark if mark.iter().all(|x| x.is_nan()) => lines.push(std::mem::take(&mut line)),
            mark if line.is_empty() && mark.iter().all(|x| x.is_infinite()) => return Ok(lines),
            _ => return Err(broken("byte", place, format!("vertex {point} of a line is not finite"))),
        }
    }
}

/// TrackVis: a header of 1000 bytes, then for each line its number of vertices, and for each vertex
/// 3 + scalars floats; properties follow each line. <http://trackvis.org/docs/?subsect=fileformat>
pub(super) fn trk(bytes: &[u8]) -> Lines {
    const HEADER: usize = 1000;
    let field = |at: usize| Bytes { bytes, at, big: false };
    if bytes.get(..5) != Some(b"TRACK") {
        return Err(broken("byte", 0, "a TRK file starts with \"TRACK\""));
    }
    let big = match field(HEADER - 4).i32()? {
        1000 => false,
        size if size.swap_bytes() == 1000 => true,
        size => {
            return Err(broken("byte", HEADER - 4, format!("a header of {size} bytes: it must have 1000")));
        }
    };
    let short = |at: usize| -> Result<usize, FileError> {
        let value = i16::from_le_bytes(Bytes { big, ..field(at) }.array()?);
        usize::try_from(value).map_err(|_| broken("byte", at, format!("{value} values: less than none")))
    };
    let (scalars, properties) = (short(36)?, short(238)?);
    let promised = Bytes { big, ..field(988) }.i32()?;
    let mut file = Bytes { big, ..field(HEADER) };
    let mut lines = Vec::new();
    // A count of 0 means that it was not stored.
    while file.left() > 0 {
        let place = file.at;
        let count = file.i32()?;
        let size = usize::try_from(count).ok().and_then(|c| c.checked_mul((3 + scalars) * 4));
        if size.is_none_or(|s| s > file.left()) {
            return Err(broken("byte", place, format!("a line of {count} vertices is longer than the file")));
        }
        let mut line = Vec::with_capacity(count as usize);
        for _ in 0..count {
            line.push(file.point()?);
            file.take(4 * scalars)?;
        }
        file.take(4 * properties)?;
        lines.push(line);
    }
    match promised > 0 && promised as usize != lines.len() {
        true => Err(broken(
            "byte",
            988,
            format!("the header promises {promised} lines, the file has {}", lines.len()),
        )),
        false => Ok(lines),
    }
}
