//! Entwine Point Tiles (entwine.io, version 1): a folder with `ept.json`, the numbers of points of
//! nodes in `ept-hierarchy`, and a LAZ file for each node in `ept-data`.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use glam::DVec3;
use serde_json::Value;

use super::guarded::plain;
use super::levels::{Key, Octree};
use super::sink::{FileError, Sink, Source};
use super::text::skip_mark;
use super::{head, lidar};

/// Reads the tiles that are wanted, level by level. `source` is `ept.json`, and `folder` the one
/// that it lies in.
pub(super) fn read<E: From<FileError>>(
    source: impl Source,
    folder: &Path,
    sink: &mut Sink<'_, E>,
) -> Result<(), E> {
    let octree = description(source, sink).map_err(|e| sink.header("EPT", e))?;
    let name = sink.name.clone();
    let mut colours = None;
    for (key, count) in hierarchy(folder, &octree)? {
        let tile = folder.join("ept-data").join(format!("{key}.laz"));
        sink.name = tile.display().to_string();
        let opened = open(&tile).and_then(|mut source| Ok((head::open(&mut source, sink)?, source)));
        let (head, source) = match opened {
            Ok(opened) => opened,
            Err(why) => {
                sink.lose(why, count);
                continue;
            }
        };
        let has = head.layout.colour.is_some();
        if *colours.get_or_insert(has) != has {
            return Err(sink
                .header("LAS", "of this tile only, or of all but this, points have colours")
                .into());
        }
        lidar::read_all(source, &head, sink)?;
    }
    sink.name = name;
    Ok(())
}

fn open(path: &Path) -> Result<BufReader<File>, FileError> {
    let io = |source| FileError::Io { name: path.display().to_string(), source };
    File::open(path).map(|file| BufReader::with_capacity(1 << 18, file)).map_err(io)
}

fn description<E: From<FileError>>(mut source: impl Source, sink: &Sink<'_, E>) -> Result<Octree, String> {
    skip_mark(&mut source).map_err(plain)?;
    let ept: Value = serde_json::from_reader(source).map_err(plain)?;
    match (ept["version"].as_str(), ept["dataType"].as_str()) {
        (Some(version), _) if !version.starts_with("1.") => {
            return Err(format!("its version is {version:?}; 1 is read"));
        }
        (_, Some("laszip")) => {}
        (_, Some(other)) => return Err(format!("its tiles are {other:?}; only \"laszip\" is read")),
        (_, None) => return Err("it has no \"dataType\"".into()),
    }
    let bound = |i: usize| ept["bounds"][i].as_f64();
    let corner = |i: usize| Some(DVec3::new(bound(i)?, bound(i + 1)?, bound(i + 2)?));
    let (low, high) = corner(0).zip(corner(3)).ok_or("its \"bounds\" are not six numbers")?;
    let side = (high - low).max_element();
    // Points along a side of a node.
    let spacing = side / ept["span"].as_f64().unwrap_or(f64::NAN);
    let dimensions = ept["schema"].as_array().map_or(&[][..], Vec::as_slice);
    let step = |name: &str| {
        let dimension = dimensions.iter().find(|dimension| dimension["name"] == name);
        dimension.and_then(|dimension| dimension["scale"].as_f64()).unwrap_or(0.0)
    };
    let steps = DVec3::new(step("X"), step("Y"), step("Z"));
    Octree::new((low, side), spacing, steps, sink.wanted())
}

/// The nodes that are wanted, and their points. Each file of the hierarchy is read once at most.
fn hierarchy(folder: &Path, octree: &Octree) -> Result<BTreeMap<Key, u64>, FileError> {
    let (mut files, mut read) = (vec![Key::ROOT], BTreeSet::new());
    let mut nodes = BTreeMap::new();
    while let Some(root) = files.pop() {
        if !read.insert(root) {
            continue;
        }
        let path = folder.join("ept-hierarchy").join(format!("{root}.json"));
        let broken = |cause| FileError::Header { name: path.display().to_string(), format: "EPT", cause };
        let mut page = open(&path)?;
        skip_mark(&mut page).map_err(|e| broken(plain(e)))?;
        let page: Value = serde_json::from_reader(page).map_err(|e| broken(plain(e)))?;
        let Value::Object(page) = page else { return Err(broken("it is no object".into())) };
        for (name, count) in &page {
            let key = parse(name).ok_or_else(|| broken(format!("no node is called {name:?}")))?;
            match count.as_i64() {
                _ if !octree.wants(key) => {}
                Some(0) => {}
                Some(-1) => files.push(key),
                Some(count @ 1..) => drop(nodes.insert(key, count as u64)),
                _ => return Err(broken(format!("the node {key} has {count} points"))),
            }
        }
    }
    Ok(nodes)
}

/// A node by its name: level-x-y-z.
fn parse(name: &str) -> Option<Key> {
    let mut numbers = name.split('-').map(|word| word.parse::<u32>().ok().map(i64::from));
    let key = Key::new([numbers.next()??, numbers.next()??, numbers.next()??, numbers.next()??]);
    key.filter(|_| numbers.next().is_none())
}
