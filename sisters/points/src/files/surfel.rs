//! The text format of Adams' Surfel Viewer: the number of surfels, then `x y z r g b nx ny nz
//! radius` on a line for each.

use glam::DVec3;

use super::sink::{Attributes, FileError, Sample, Sink, Source, unit_to_byte};
use super::text::{Lines, number};

const NO_COUNT: &str = "it begins with no number of surfels; PLY, LAS, LAZ and E57 files are read, too";

pub(super) fn read<E: From<FileError>>(source: impl Source, sink: &mut Sink<'_, E>) -> Result<(), E> {
    let all = Attributes { colours: true, normals: true, radii: true };
    let mut lines = Lines::new(source).map_err(|e| sink.io(e))?;
    let first = lines.next().map_err(|e| sink.io(e))?.ok_or_else(|| sink.header("surfel", "it is empty"))?;
    let count = number(first).filter(|count| *count >= 0.0 && count.fract() == 0.0);
    let count = count.ok_or_else(|| sink.header("surfel", NO_COUNT))? as u64;
    for read in 0..count {
        let line = lines.next().map_err(|e| sink.io(e))?.map(parse);
        let place = format!("line {}", lines.number);
        match line {
            Some(Some(sample)) => sink.push(sample, all)?,
            Some(None) => {
                sink.lose(sink.point(place, "a surfel is ten numbers: x y z r g b nx ny nz radius"), 1);
            }
            None => {
                let cause = format!("the file ends after {read} of {count} surfels");
                sink.lose(sink.point(place, cause), count - read);
                return Ok(());
            }
        }
    }
    if lines.next().map_err(|e| sink.io(e))?.is_some() {
        let place = lines.number;
        sink.warn(format_args!(
            "line {place} and those behind it follow the {count} surfels, and are not read"
        ));
    }
    Ok(())
}

/// The surfel of a line.
fn parse(line: &str) -> Option<Sample> {
    let mut words = line.split_ascii_whitespace();
    let mut fields = [0.0; 10];
    for field in &mut fields {
        *field = number(words.next()?)?;
    }
    let [x, y, z, r, g, b, nx, ny, nz, radius] = fields;
    Some(Sample {
        position: DVec3::new(x, y, z),
        colour: [r, g, b].map(unit_to_byte),
        normal: DVec3::new(nx, ny, nz).as_vec3(),
        radius: radius as f32,
        scanner: None,
    })
}
