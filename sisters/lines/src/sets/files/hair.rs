//! Cem Yuksel's HAIR format, version 1.0. <https://www.cemyuksel.com/research/hairmodels/>

use super::bytes::{Bytes, Kind};
use super::error::{FileError, broken};
use crate::sets::LineSet;
use crate::sets::attributes::{Attributes, Of, Scalars};

/// The bytes of the header.
const HEADER: usize = 128;
/// Where its numbers start: strands, points, flags, segments of a strand.
const STRANDS: usize = 4;
/// Which arrays follow.
const SEGMENTS: u32 = 1;
const POINTS: u32 = 2;
const THICKNESS: u32 = 4;
const TRANSPARENCY: u32 = 8;
const COLOURS: u32 = 16;

/// The strands of a HAIR file, with thickness and transparency as numbers of vertices, and colours,
/// where the file has them for each vertex.
pub(super) fn read(bytes: &[u8]) -> Result<LineSet, FileError> {
    if bytes.get(..4) != Some(b"HAIR") {
        return Err(broken("byte", 0, "a HAIR file starts with \"HAIR\""));
    }
    let four = Kind::Unsigned(4);
    let head = Bytes { bytes, at: STRANDS, big: false }.indices(four, 4)?;
    let (strands, points, flags, usual) = (head[0] as usize, head[1] as usize, head[2], head[3] as usize);
    if flags & 0xff == 0 && flags.swap_bytes() & POINTS != 0 {
        let why = "the numbers start with their highest byte: a HAIR file has the lowest first";
        return Err(broken("byte", STRANDS, why));
    }
    if flags & POINTS == 0 {
        return Err(broken("byte", STRANDS + 8, "the file has no array of points"));
    }
    let mut file = Bytes { bytes, at: HEADER, big: false };
    let has = |flag: u32| flags & flag != 0;
    let own = if has(SEGMENTS) { Some(file.indices(Kind::Unsigned(2), strands)?) } else { None };
    let segments = |strand: usize| own.as_ref().map_or(usual, |all| all[strand] as usize);
    let float = Kind::Float(4);
    let places = file.floats(float, points.saturating_mul(3))?;
    let mut places = places.as_chunks::<3>().0.iter().map(|p| (*p).into());
    let mut left = points;
    let mut lines = LineSet::default();
    for strand in 0..strands {
        let vertices = segments(strand).saturating_add(1);
        if vertices > left {
            let why = format!("strand {strand} has {vertices} vertices, {left} are left");
            return Err(broken("byte", HEADER, why));
        }
        left -= vertices;
        lines.push(places.by_ref().take(vertices))?;
    }
    if left > 0 {
        return Err(broken("byte", HEADER, format!("{left} points belong to no strand")));
    }
    let mut attributes = Attributes::default();
    for (flag, name) in [(THICKNESS, "thickness"), (TRANSPARENCY, "transparency")] {
        if has(flag) {
            let values = file.floats(float, points)?;
            attributes.scalars.push(Scalars { name: name.to_owned(), of: Of::Vertices, values });
        }
    }
    if has(COLOURS) {
        let all = file.floats(float, points.saturating_mul(3))?;
        let byte = |c: f32| (c.clamp(0.0, 1.0) * 255.0).round() as u8;
        attributes.colours = Some(all.as_chunks::<3>().0.iter().map(|c| c.map(byte)).collect());
    }
    Ok(lines.with_attributes(attributes)?)
}
