//! PLY (Turk 1994): headers and binary points are read by the crate `ply-rs-bw`; files are written
//! in little-endian binary.

use std::io::{self, BufRead, Read, Write};

use glam::{DVec3, Vec3};
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};

use super::sink::{Attributes, FileError, Sample, Sink, Source, unit_to_byte};
use crate::PointCloud;

/// The longest line of an ASCII file, in bytes: enough for a list of 100,000 numbers.
const LONGEST_LINE: u64 = 1 << 20;

impl PropertyAccess for Sample {
    fn new() -> Self {
        Self::NONE
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let Some(value) = number(&property) else { return PropertyAccessResult::Ignored };
        let colour = || match property {
            Property::Float(_) | Property::Double(_) => unit_to_byte(value),
            Property::UShort(_) => (value / 257.0).round() as u8,
            _ => value as u8,
        };
        match name {
            "x" => self.position.x = value,
            "y" => self.position.y = value,
            "z" => self.position.z = value,
            "red" | "r" | "diffuse_red" => self.colour[0] = colour(),
            "green" | "g" | "diffuse_green" => self.colour[1] = colour(),
            "blue" | "b" | "diffuse_blue" => self.colour[2] = colour(),
            "nx" => self.normal.x = value as f32,
            "ny" => self.normal.y = value as f32,
            "nz" => self.normal.z = value as f32,
            "radius" => self.radius = value as f32,
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

/// The value of a property that is no list.
fn number(property: &Property) -> Option<f64> {
    Some(match *property {
        Property::Char(v) => v.into(),
        Property::UChar(v) => v.into(),
        Property::Short(v) => v.into(),
        Property::UShort(v) => v.into(),
        Property::Int(v) => v.into(),
        Property::UInt(v) => v.into(),
        Property::Float(v) => v.into(),
        Property::Double(v) => v,
        _ => return None,
    })
}

/// Reads the element `vertex`, and all before it.
pub(super) fn read<E: From<FileError>>(source: impl Source, sink: &mut Sink<'_, E>) -> Result<(), E> {
    let parser = Parser::<Sample>::new();
    let mut reader = Reader::new(source);
    let header = parser.read_header(&mut reader).map_err(|e| sink.header("PLY", e))?;
    // It counts the line after the header as begun.
    let mut line = reader.line().saturating_sub(1);
    let mut source = reader.into_inner();
    for element in header.elements.values() {
        let has = |name: &str| element.properties.values().any(|p| p.name == name);
        let is_vertex = element.name == "vertex";
        if element.properties.is_empty() || is_vertex && !["x", "y", "z"].into_iter().all(has) {
            let lacks = if is_vertex { "x, y and z" } else { "properties" };
            return Err(sink.header("PLY", format!("the element {} has no {lacks}", element.name)).into());
        }
        let attributes = Attributes {
            colours: ["red", "r", "diffuse_red"].into_iter().any(has),
            normals: has("nx"),
            radii: has("radius"),
        };
        for index in 0..element.count {
            let sample = match header.encoding {
                Encoding::Ascii => ascii(&mut source, element, &mut line),
                Encoding::BinaryLittleEndian => {
                    parser.read_little_endian_element(&mut source, element).map_err(|e| e.to_string())
                }
                Encoding::BinaryBigEndian => {
                    parser.read_big_endian_element(&mut source, element).map_err(|e| e.to_string())
                }
            };
            let sample = sample.map_err(|cause| {
                let byte = source.stream_position().unwrap_or(0);
                let ascii = header.encoding == Encoding::Ascii;
                let at = if ascii { format!("line {line}") } else { format!("before byte {byte}") };
                sink.point(format!("{at}, {} {index} of {}", element.name, element.count), cause)
            })?;
            if is_vertex {
                sink.push(sample, attributes)?;
            }
        }
        if is_vertex {
            return Ok(());
        }
    }
    Err(sink.header("PLY", "there is no element vertex").into())
}

/// Reads the next line that is not empty. Not by the crate, as that refuses "nan", which scanners
/// write.
fn ascii(source: &mut impl BufRead, element: &ElementDef, at: &mut usize) -> Result<Sample, String> {
    let mut line = String::new();
    while line.trim().is_empty() {
        *at += 1;
        line.clear();
        match source.take(LONGEST_LINE).read_line(&mut line) {
            Ok(0) => return Err("the file ends here".into()),
            Ok(_) => {}
            Err(e) => return Err(e.to_string()),
        }
    }
    let mut words = line.split_ascii_whitespace();
    let mut next = |name: &str| {
        let word = words.next().ok_or_else(|| format!("{name} is missing"))?;
        word.parse::<f64>().map_err(|_| format!("{name} is no number: {word:.40}"))
    };
    let mut sample = Sample::NONE;
    for property in element.properties.values() {
        let value = next(&property.name)?;
        match &property.data_type {
            PropertyType::Scalar(kind) => sample.set_property(&property.name, typed(kind, value)),
            // The loop ends with the line, whatever the count says.
            PropertyType::List(..) => {
                (0..value as u64).try_for_each(|_| next(&property.name).map(drop))?;
                PropertyAccessResult::Ignored
            }
        };
    }
    Ok(sample)
}

/// A number of an ASCII file as the header declares it, with types only as far as colours depend on
/// them.
fn typed(kind: &ScalarType, value: f64) -> Property {
    match kind {
        ScalarType::UChar => Property::UChar(value as u8),
        ScalarType::UShort => Property::UShort(value as u16),
        ScalarType::Float | ScalarType::Double => Property::Double(value),
        ScalarType::Char | ScalarType::Short | ScalarType::Int | ScalarType::UInt => {
            Property::Int(value as i32)
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
