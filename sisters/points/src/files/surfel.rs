//! The text format of Adams' Surfel Viewer: the number of surfels, then `x y z r g b nx ny nz
//! radius` on a line for each.

use std::io::{BufRead, ErrorKind, Read};

use glam::DVec3;

use super::sink::{Attributes, FileError, Sample, Sink, Source, unit_to_byte};

/// The longest line, in bytes: ten numbers.
const LONGEST_LINE: u64 = 1 << 12;

const NO_COUNT: &str = "it begins with no number of surfels, and is no PLY, LAS or E57 file";

pub(super) fn read<E: From<FileError>>(mut source: impl Source, sink: &mut Sink<'_, E>) -> Result<(), E> {
    let all = Attributes { colours: true, normals: true, radii: true };
    let (mut count, mut read) = (None, 0);
    let mut text = String::new();
    for line in 1.. {
        text.clear();
        let bytes = match (&mut source).take(LONGEST_LINE).read_line(&mut text) {
            // Not text: a file of another format.
            Err(e) if count.is_none() && e.kind() == ErrorKind::InvalidData => {
                return Err(sink.header("surfel", NO_COUNT).into());
            }
            bytes => bytes.map_err(|e| sink.io(e))?,
        };
        let ended = bytes == 0;
        let mut numbers = text.split_ascii_whitespace();
        match count {
            Some(count) if read == count => break,
            Some(count) if ended => {
                let cause = format!("the file ends after {read} of {count} surfels");
                return Err(sink.point(format!("line {line}"), cause).into());
            }
            _ if numbers.clone().next().is_none() && !ended => {}
            None => {
                count = Some(text.trim().parse::<u64>().map_err(|_| sink.header("surfel", NO_COUNT))?);
            }
            Some(_) => {
                let mut next = || numbers.next().and_then(|word| word.parse::<f64>().ok());
                let fields: [Option<f64>; 10] = std::array::from_fn(|_| next());
                let [
                    Some(x),
                    Some(y),
                    Some(z),
                    Some(r),
                    Some(g),
                    Some(b),
                    Some(nx),
                    Some(ny),
                    Some(nz),
                    Some(radius),
                ] = fields
                else {
                    let cause = "a surfel is ten numbers: x y z r g b nx ny nz radius";
                    return Err(sink.point(format!("line {line}"), cause).into());
                };
                let sample = Sample {
                    position: DVec3::new(x, y, z),
                    colour: [r, g, b].map(unit_to_byte),
                    normal: DVec3::new(nx, ny, nz).as_vec3(),
                    radius: radius as f32,
                    scanner: None,
                };
                sink.push(sample, all)?;
                read += 1;
            }
        }
    }
    Ok(())
}
