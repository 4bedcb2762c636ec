//! PLY (Turk 1994), read in all encodings, and written in little-endian binary.

use std::io::{self, BufRead, Write};

use glam::{DVec3, Vec3};

use super::ply_header::{self, Element, Encoding, Field, Kind};
use super::sink::{Attributes, FileError, Sample, Sink, Source, plain, unit_to_byte};
use super::text::{Lines, number};
use crate::PointCloud;

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
    let mut elements = header.elements[..=vertex].iter().filter(|element| !element.properties.is_empty());
    if header.encoding == Encoding::Text {
        return elements.try_for_each(|element| texts(&mut lines, element, sink));
    }
    let mut source = lines.into_inner();
    elements.try_for_each(|element| binary(&mut source, element, header.encoding == Encoding::Big, sink))
}

/// What the points of an element have.
fn attributes(element: &Element) -> Attributes {
    Attributes {
        colours: element.has(Field::Colour(0)),
        normals: element.has(Field::Normal(0)),
        radii: element.has(Field::Radius),
    }
}

/// Reads an element of lines. Those that do not follow the header are left out.
fn texts<E: From<FileError>>(
    lines: &mut Lines<impl Source>,
    element: &Element,
    sink: &mut Sink<'_, E>,
) -> Result<(), E> {
    let (is_vertex, has) = (element.name == "vertex", attributes(element));
    for index in 0..element.count {
        let line = lines.next().map_err(|e| sink.io(e))?.map(|line| of_line(line, element));
        let place = || format!("line {}, {} {index} of {}", lines.number, element.name, element.count);
        match line {
            None if is_vertex => {
                sink.lose(sink.point(place(), "the file ends here"), element.count - index);
                break;
            }
            None => break,
            Some(Err(cause)) if is_vertex => sink.lose(sink.point(place(), cause), 1),
            Some(Ok(sample)) if is_vertex => sink.push(sample, has)?,
            Some(_) => {}
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

/// Reads an element of bytes.
fn binary<E: From<FileError>>(
    source: &mut impl Source,
    element: &Element,
    big: bool,
    sink: &mut Sink<'_, E>,
) -> Result<(), E> {
    let (is_vertex, has) = (element.name == "vertex", attributes(element));
    for index in 0..element.count {
        match of_bytes(source, element, big) {
            Ok(sample) if is_vertex => sink.push(sample, has)?,
            Ok(_) => {}
            Err(_) if !is_vertex => break,
            Err(error) => {
                let byte = source.stream_position().unwrap_or(0);
                let place = format!("byte {byte}, {} {index} of {}", element.name, element.count);
                sink.lose(sink.point(place, plain(error)), element.count - index);
                break;
            }
        }
    }
    Ok(())
}

fn of_bytes(source: &mut impl BufRead, element: &Element, big: bool) -> io::Result<Sample> {
    let mut next = |kind: Kind| {
        let mut bytes = [0; 8];
        let part = &mut bytes[..kind.size()];
        source.read_exact(part)?;
        if big {
            part.reverse();
        }
        io::Result::Ok(kind.number(u64::from_le_bytes(bytes)))
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
            Kind::F32 | Kind::F64 => unit_to_byte(value),
            Kind::U16 => (value / 257.0).round() as u8,
            _ => value as u8,
        };
        match field {
            Field::Position(axis) => self.position[axis] = value,
            Field::Colour(channel) => self.colour[channel] = colour(),
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
        let lacks = self.has.colours && cloud.colours.is_empty()
            || self.has.normals && cloud.normals.is_empty()
            || self.has.radii && cloud.radii.is_empty();
        if lacks && !cloud.is_empty() {
            return Err(io::Error::other("the points lack an attribute that the PLY header names"));
        }
        let left = self.left.checked_sub(cloud.len() as u64);
        self.left = left.ok_or_else(|| io::Error::other("more points than the PLY header says"))?;
        for (i, position) in cloud.positions.iter().enumerate() {
            if self.doubles {
                let position = cloud.origin + position.as_dvec3();
                position.to_array().iter().try_for_each(|v| self.out.write_all(&v.to_le_bytes()))?;
            } else {
                self.floats((cloud.origin.as_vec3() + *position).as_ref())?;
            }
            if self.has.colours {
                self.out.write_all(&cloud.colours[i])?;
            }
            if self.has.normals {
                let normal: Vec3 = cloud.normals[i];
                self.floats(normal.as_ref())?;
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
