//! PLY (Turk 1994), read in all encodings, and written in little-endian binary.

use super::ply_header::{self, Element, Encoding, Field, Kind};
use super::sink::{Attributes, FileError, Sample, Sink, Source, plain, unit_to_byte};
use super::text::{Lines, number};
use crate::PointCloud;
use glam::DVec3;
use std::io::{self, BufRead, Write};

/// The spherical harmonic that is the same to all sides (1 / sqrt(4 pi)): splats hold its factor.
const SPLAT: f64 = 0.282_094_791_773_878_14;

/// Reads the element `vertex`, and all before it.
pub(super) fn read<E: From<FileError>>(source: impl Source, sink: &mut Sink<'_, E>) -> Result<(), E> {
    let mut lines = Lines::new(source).map_err(|e| sink.io(e))?;
    let header = ply_header::read(&mut lines).map_err(|e| sink.header("PLY", e))?;
    header.strange.iter().for_each(|line| sink.warn(line));
    let vertex = header.elements.iter().position(|element| element.name == "vertex");
    let vertex = vertex.ok_or_else(|| sink.header("PLY", "there is no element vertex"))?;
    if !(0..3).all(|axis| header.elements[vertex].has(Field::Position(axis))) {
        return Err(sink.header("PLY", "the element vertex has no x, y and z").into());
    }
    // Elements without properties take no bytes.
    let elements = header.elements[..=vertex].iter().filter(|element| !element.properties.is_empty());
    if header.encoding == Encoding::Text {
        for element in elements {
            points(element, sink, || {
                let (cause, is_last) = match lines.next() {
                    Ok(Some(line)) => match of_line(line, element) {
                        Ok(sample) => return Ok(sample),
                        Err(cause) => (cause, false),
                    },
                    Ok(None) => ("the file ends here".into(), true),
                    Err(error) => (plain(error), true),
                };
                Err((format!("line {}", lines.number), cause, is_last))
            })?;
        }
        return Ok(());
    }
    let mut source = lines.into_inner();
    for element in elements {
        points(element, sink, || {
            of_bytes(&mut source, element, header.encoding == Encoding::Big).map_err(|error| {
                (format!("byte {}", source.stream_position().unwrap_or(0)), plain(error), true)
            })
        })?;
    }
    Ok(())
}

/// Hands out the points of an element, if it is that of points. In the place of one that cannot be
/// read, `next` gives where and why, and whether it is the last.
fn points<E: From<FileError>>(
    element: &Element,
    sink: &mut Sink<'_, E>,
    mut next: impl FnMut() -> Result<Sample, (String, String, bool)>,
) -> Result<(), E> {
    let has = Attributes {
        colours: element.has(Field::Colour(0)) || element.has(Field::Splat(0)),
        normals: element.has(Field::Normal(0)),
        radii: element.has(Field::Radius),
    };
    let is_vertex = element.name == "vertex";
    for index in 0..element.count {
        match next() {
            Ok(sample) if is_vertex => sink.push(sample, has)?,
            Ok(_) => {}
            Err((place, cause, is_last)) => {
                if is_vertex {
                    let place = format!("{place}, vertex {index} of {}", element.count);
                    sink.lose(sink.point(place, cause), if is_last { element.count - index } else { 1 });
                }
                if is_last {
                    break;
                }
            }
        }
    }
    Ok(())
}

fn of_line(line: &str, element: &Element) -> Result<Sample, String> {
    let mut words = line.split_ascii_whitespace();
    let mut next = |name: &str| {
        let word = words.next().ok_or_else(|| format!("{name} is missing"))?;
        number(word).ok_or_else(|| format!("{name} is no number: {word:.40}"))
    };
    let mut sample = Sample::NONE;
    for property in &element.properties {
        let value = next(&property.name)?;
        if property.list.is_some() {
            // The loop ends with the line, whatever the count says.
            (0..value as u64).try_for_each(|_| next(&property.name).map(drop))?;
        } else {
            sample.set(property.field, property.kind, value);
        }
    }
    Ok(sample)
}

fn of_bytes(source: &mut impl BufRead, element: &Element, big: bool) -> io::Result<Sample> {
    let mut next = |kind: Kind| {
        let mut bytes = [0; 8];
        let (Kind::Signed(size) | Kind::Unsigned(size) | Kind::Float(size)) = kind;
        source.read_exact(&mut bytes[..size])?;
        if big {
            bytes[..size].reverse();
        }
        let word = u64::from_le_bytes(bytes);
        io::Result::Ok(match kind {
            Kind::Signed(_) => ((word << (64 - 8 * size)) as i64 >> (64 - 8 * size)) as f64,
            Kind::Unsigned(_) => word as f64,
            Kind::Float(4) => f32::from_bits(word as u32).into(),
            Kind::Float(_) => f64::from_bits(word),
        })
    };
    let mut sample = Sample::NONE;
    for property in &element.properties {
        match property.list {
            // The loop ends with the file, whatever the count says.
            Some(count) => (0..next(count)? as u64).try_for_each(|_| next(property.kind).map(drop))?,
            None => sample.set(property.field, property.kind, next(property.kind)?),
        }
    }
    Ok(sample)
}

impl Sample {
    fn set(&mut self, field: Field, kind: Kind, value: f64) {
        let colour = || match kind {
            Kind::Float(_) => unit_to_byte(value),
            Kind::Unsigned(2) => (value / 257.0).round() as u8,
            _ => value as u8,
        };
        match field {
            Field::Position(axis) => self.position[axis] = value,
            Field::Colour(channel) => self.colour[channel] = colour(),
            Field::Splat(channel) => self.colour[channel] = unit_to_byte(0.5 + SPLAT * value),
            Field::Normal(axis) => self.normal[axis] = value as f32,
            Field::Radius => self.radius = value as f32,
            Field::Other => {}
        }
    }
}

/// Writes points to a PLY file, little-endian, in chunks. Positions are doubles with their origin
/// added, or, where the origin of a cloud in [`PlyWriter::write_all`] is zero, floats.
pub struct PlyWriter<W: Write> {
    out: W,
    has: Attributes,
    doubles: bool,
    left: u64,
}

impl<W: Write> PlyWriter<W> {
    /// Writes the header for `count` points. The output should be buffered.
    ///
    /// # Errors
    /// Those of the output.
    pub fn new(mut out: W, count: u64, has: Attributes, doubles: bool) -> io::Result<Self> {
        let mut head = format!("ply\nformat binary_little_endian 1.0\nelement vertex {count}\n");
        let mut properties = |kind: &str, names: &[&str]| {
            names.iter().for_each(|name| head += &format!("property {kind} {name}\n"));
        };
        properties(if doubles { "double" } else { "float" }, &["x", "y", "z"]);
        properties("uchar", if has.colours { &["red", "green", "blue"] } else { &[] });
        properties("float", if has.normals { &["nx", "ny", "nz"] } else { &[] });
        properties("float", if has.radii { &["radius"] } else { &[] });
        out.write_all((head + "end_header\n").as_bytes())?;
        Ok(Self { out, has, doubles, left: count })
    }

    /// Writes all points of a cloud as a file of their own.
    ///
    /// # Errors
    /// Those of the output; attributes that only some points have.
    pub fn write_all(out: W, cloud: &PointCloud) -> io::Result<()> {
        let has = Attributes {
            colours: !cloud.colours.is_empty(),
            normals: !cloud.normals.is_empty(),
            radii: !cloud.radii.is_empty(),
        };
        let mut writer = Self::new(out, cloud.len() as u64, has, cloud.origin != DVec3::ZERO)?;
        writer.push(cloud)?;
        writer.finish()
    }

    /// Writes some of the points. Attributes that the header does not name are left out.
    ///
    /// # Errors
    /// Those of the output; attributes that the cloud lacks or only some points have; more points
    /// than the header says.
    pub fn push(&mut self, cloud: &PointCloud) -> io::Result<()> {
        cloud.check().map_err(io::Error::other)?;
        let none = [cloud.colours.is_empty(), cloud.normals.is_empty(), cloud.radii.is_empty()];
        let named = [self.has.colours, self.has.normals, self.has.radii];
        if !cloud.is_empty() && named.into_iter().zip(none).any(|(named, none)| named && none) {
            return Err(io::Error::other("the points lack an attribute that the PLY header names"));
        }
        let left = self.left.checked_sub(cloud.len() as u64);
        self.left = left.ok_or_else(|| io::Error::other("more points than the PLY header says"))?;
        for (i, position) in cloud.positions.iter().enumerate() {
            if self.doubles {
                let position = cloud.origin + position.as_dvec3();
                position.to_array().iter().try_for_each(|v| self.out.write_all(&v.to_le_bytes()))?;
            } else {
                self.floats(&(cloud.origin.as_vec3() + *position).to_array())?;
            }
            if self.has.colours {
                self.out.write_all(&cloud.colours[i])?;
            }
            if self.has.normals {
                self.floats(&cloud.normals[i].to_array())?;
            }
            if self.has.radii {
                self.floats(&[cloud.radii[i]])?;
            }
        }
        Ok(())
    }

    /// Ends the file.
    ///
    /// # Errors
    /// Those of the output; fewer points than the header says.
    pub fn finish(mut self) -> io::Result<()> {
        if self.left > 0 {
            return Err(io::Error::other(format!("{} points fewer than the PLY header says", self.left)));
        }
        self.out.flush()
    }

    fn floats(&mut self, values: &[f32]) -> io::Result<()> {
        values.iter().try_for_each(|v| self.out.write_all(&v.to_le_bytes()))
    }
}
