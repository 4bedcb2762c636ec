//! TRX tractograms: a ZIP of arrays. <https://github.com/tee-ar-ex/trx-spec>

use std::collections::BTreeMap;
use std::io::Cursor;

use glam::Vec3;
use half::f16;
use zip::ZipArchive;

use super::bytes::{Bytes, Kind, unmarked};
use super::error::{FileError, refused};
use super::unpack::Room;
use crate::sets::LineSet;
use crate::sets::attributes::{Attributes, Groups, NO_GROUP, Of, Scalars};

/// The greatest number of components that become numbers of their own: a tensor.
const MOST_COMPONENTS: usize = 9;

/// A file of the archive: its folder, its name, its numbers.
struct Entry {
    name: String,
    components: usize,
    kind: Number,
    bytes: Vec<u8>,
}

#[derive(Clone, Copy)]
enum Number {
    Half,
    Other(Kind),
}

impl Entry {
    /// By a name such as `positions.3.float16`, without a folder. None if it is not one of numbers.
    fn named(file: &str) -> Option<(String, usize, Number)> {
        let (rest, kind) = file.rsplit_once('.')?;
        let kind = match kind {
            "float16" => Number::Half,
            other => Number::Other(Kind::named(other)?),
        };
        let (name, components) = match rest.rsplit_once('.').map(|(name, n)| (name, n.parse::<u32>())) {
            Some((name, Ok(components))) => (name, components as usize),
            _ => (rest, 1),
        };
        Some((name.to_owned(), components, kind))
    }

    fn floats(&self) -> Result<Vec<f32>, FileError> {
        match self.kind {
            Number::Half => {
                let pairs = self.bytes.as_chunks::<2>().0.iter();
                Ok(pairs.map(|b| f16::from_le_bytes(*b).to_f32()).collect())
            }
            Number::Other(kind) => self.file().floats(kind, self.bytes.len() / kind.size()),
        }
    }

    fn indices(&self) -> Result<Vec<u32>, FileError> {
        match self.kind {
            Number::Half => Err(refused(format!("{} cannot be of float16", self.name))),
            Number::Other(kind) => {
                let all = self.file().indices(kind, self.bytes.len() / kind.size());
                all.map_err(|why| refused(format!("{} in the archive: {why}", self.name)))
            }
        }
    }

    fn file(&self) -> Bytes<'_> {
        Bytes { bytes: &self.bytes, at: 0, big: false }
    }

    /// A column for each component.
    fn scalars(&self, of: Of) -> Result<Vec<Scalars>, FileError> {
        let n = self.components;
        if !(1..=MOST_COMPONENTS).contains(&n) {
            return Ok(Vec::new());
        }
        let values = self.floats()?;
        let column = |c: usize| Scalars {
            name: if n == 1 { self.name.clone() } else { format!("{}.{c}", self.name) },
            of,
            values: values.iter().skip(c).step_by(n).copied().collect(),
        };
        Ok((0..n).map(column).collect())
    }
}

/// The archive's files, by folder, in the order of their names.
#[derive(Default)]
struct Archive {
    header: Option<serde_json::Value>,
    positions: Option<Entry>,
    offsets: Option<Entry>,
    of_vertices: Vec<Entry>,
    of_lines: Vec<Entry>,
    groups: Vec<Entry>,
}

impl Archive {
    fn new(bytes: &[u8]) -> Result<Self, FileError> {
        let broken = |why| refused(format!("the ZIP is broken: {why}"));
        let mut zip = ZipArchive::new(Cursor::new(bytes)).map_err(broken)?;
        let mut room = Room::of_file(bytes.len());
        let mut files = BTreeMap::new();
        for i in 0..zip.len() {
            let file = zip.by_index(i).map_err(broken)?;
            // Numbers in single precision stand beside the bytes that they come from.
            let size = usize::try_from(file.size()).unwrap_or(usize::MAX);
            room.take(size.saturating_mul(4))?;
            let name = file.name().map_err(broken)?.trim_start_matches('/').to_owned();
            let mut all = Vec::new();
            room.read(file, size, &mut all)?;
            files.insert(name, all);
        }
        let mut archive = Self::default();
        for (path, bytes) in files {
            archive.add(&path, bytes)?;
        }
        Ok(archive)
    }

    fn add(&mut self, path: &str, bytes: Vec<u8>) -> Result<(), FileError> {
        if path == "header.json" {
            let header = serde_json::from_slice(unmarked(&bytes));
            self.header = Some(header.map_err(|why| refused(format!("header.json is broken: {why}")))?);
            return Ok(());
        }
        let (folder, file) = path.split_once('/').unwrap_or(("", path));
        let Some((name, components, kind)) = Entry::named(file) else { return Ok(()) };
        let entry = Entry { name, components, kind, bytes };
        match (folder, entry.name.as_str()) {
            ("", "positions") => self.positions = Some(entry),
            ("", "offsets") => self.offsets = Some(entry),
            ("dpv", _) => self.of_vertices.push(entry),
            ("dps", _) => self.of_lines.push(entry),
            ("groups", _) => self.groups.push(entry),
            // Data of groups belong to no line.
            _ => {}
        }
        Ok(())
    }

    fn count(&self, field: &str) -> Result<usize, FileError> {
        let value = self.header.as_ref().and_then(|h| h.get(field)?.as_u64());
        let value = value.and_then(|v| usize::try_from(v).ok());
        value.ok_or_else(|| refused(format!("header.json has no {field}")))
    }
}

/// The lines of a TRX file, in millimetres of the scanner, with its data of vertices and lines. A
/// line that is in many groups counts for the first of them, by their names.
pub(super) fn read(bytes: &[u8]) -> Result<LineSet, FileError> {
    let archive = Archive::new(bytes)?;
    let (vertices, streamlines) = (archive.count("NB_VERTICES")?, archive.count("NB_STREAMLINES")?);
    let missing = |what: &str| refused(format!("the archive has no file {what}"));
    let positions = archive.positions.as_ref().ok_or_else(|| missing("positions.3"))?.floats()?;
    let offsets = archive.offsets.as_ref().ok_or_else(|| missing("offsets"))?.indices()?;
    let points = positions.as_chunks::<3>().0;
    if points.len() != vertices {
        return Err(refused(format!("{} vertices stand where {vertices} were promised", points.len())));
    }
    // The end of the last line may be left out.
    if offsets.len() != streamlines && offsets.len().checked_sub(1) != Some(streamlines) {
        return Err(refused(format!("{} offsets stand for {streamlines} lines", offsets.len())));
    }
    let mut lines = LineSet::default();
    for i in 0..streamlines {
        let (start, end) = (offsets[i] as usize, offsets.get(i + 1).map_or(vertices, |o| *o as usize));
        let ordered = start <= end && (i > 0 || start == 0) && (i + 1 < streamlines || end == vertices);
        let line = points.get(start..end).filter(|_| ordered);
        let line =
            line.ok_or_else(|| refused(format!("line {i} has vertices {start} to {end} of {vertices}")))?;
        lines.push(line.iter().map(|p| Vec3::from(*p)))?;
    }
    let mut attributes = Attributes::default();
    for (of, entries) in [(Of::Vertices, &archive.of_vertices), (Of::Lines, &archive.of_lines)] {
        for entry in entries {
            attributes.scalars.extend(entry.scalars(of)?);
        }
    }
    if !archive.groups.is_empty() {
        attributes.groups = Some(groups(&archive.groups, streamlines)?);
    }
    Ok(lines.with_attributes(attributes)?)
}

fn groups(entries: &[Entry], lines: usize) -> Result<Groups, FileError> {
    let mut of = vec![NO_GROUP; lines];
    for (number, entry) in (0..).zip(entries) {
        for line in entry.indices()? {
            let unknown = || refused(format!("the group {} has line {line} of {lines}", entry.name));
            let group = of.get_mut(line as usize).ok_or_else(unknown)?;
            *group = (*group).min(number);
        }
    }
    Ok(Groups { names: entries.iter().map(|e| e.name.clone()).collect(), of })
}
