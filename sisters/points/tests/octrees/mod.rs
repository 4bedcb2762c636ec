//! A writer of small COPC files (COPC 1.0), and the points in their nodes.

// Each test uses a part of it.
#![allow(dead_code)]

use std::io::Cursor;

use glam::DVec3;
use laz::{LasZipCompressor, LazItemRecordBuilder, LazVlrBuilder};

/// Bytes of a header of LAS 1.4 and of a point of format 7, and of the record of COPC.
pub const HEADER: usize = 375;
const POINT: usize = 36;
const INFO: usize = 160;
/// Where the record of COPC begins.
pub const INFO_AT: usize = HEADER + 54;

/// The low corner of the cube in each axis, its side, and the spacing of level 0.
pub const LOW: f64 = -0.5;
pub const SIDE: f64 = 8.0;
pub const SPACING: f64 = 0.5;

/// The level, x, y and z of a node, and its number of points.
pub type Node = ([i32; 4], usize);

/// A root with children and grandchildren; one of them is empty, and not all have a parent's
/// number.
pub const TREE: [Node; 7] = [
    ([0, 0, 0, 0], 50),
    ([1, 1, 0, 0], 1),
    ([1, 0, 0, 0], 200),
    ([1, 0, 1, 1], 0),
    ([2, 0, 1, 1], 30),
    ([2, 1, 2, 3], 3),
    ([2, 3, 0, 1], 7),
];

/// Where the points of a node lie, exactly in the scale of the file.
pub fn place(([level, x, y, z], _): Node, i: usize) -> DVec3 {
    let part = DVec3::new((i % 7) as f64 / 8.0, (i % 11) as f64 / 16.0, (i % 5) as f64 / 8.0);
    (DVec3::from([x, y, z].map(f64::from)) + part) * SIDE / f64::from(1 << level) + LOW
}

pub fn colour(i: usize) -> [u8; 3] {
    [i as u8, 255 - i as u8, 9]
}

/// The points of nodes, node by node.
pub fn points(nodes: &[Node]) -> impl Iterator<Item = (DVec3, [u8; 3])> {
    nodes.iter().flat_map(|&node| (0..node.1).map(move |i| (place(node, i), colour(i))))
}

/// A file of LAS 1.4, by the crate `las`.
pub fn las(nodes: &[Node], compressed: bool) -> Vec<u8> {
    let mut builder = las::Builder::from((1, 4));
    builder.point_format = las::point::Format::new(7).unwrap();
    builder.point_format.is_compressed = compressed;
    let transform = las::Transform { scale: 1e-3, offset: 0.0 };
    builder.transforms = las::Vector { x: transform, y: transform, z: transform };
    let mut writer = las::Writer::new(Cursor::new(Vec::new()), builder.into_header().unwrap()).unwrap();
    for (p, colour) in points(nodes) {
        let [red, green, blue] = colour.map(|c| u16::from(c) * 257);
        let color = Some(las::Color { red, green, blue });
        let point = las::Point { x: p.x, y: p.y, z: p.z, color, gps_time: Some(0.0), ..Default::default() };
        writer.write_point(point).unwrap();
    }
    writer.close().unwrap();
    writer.into_inner().unwrap().into_inner()
}

/// The head of a record: of a length in two bytes, or of eight behind the points.
fn record(user: &str, id: u16, length: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0; 2];
    bytes.extend(user.as_bytes());
    bytes.resize(18, 0);
    bytes.extend(id.to_le_bytes());
    bytes.extend(length);
    bytes.resize(bytes.len() + 32, 0);
    bytes
}

/// An entry of a page of the hierarchy.
pub fn entry(key: [i32; 4], start: u64, bytes: i32, points: i32) -> Vec<u8> {
    let mut entry = key.map(i32::to_le_bytes).concat();
    entry.extend(start.to_le_bytes());
    entry.extend([bytes, points].map(i32::to_le_bytes).concat());
    entry
}

/// A file of nodes, each a chunk of its own. Its hierarchy is one page, or the child at 1-0-0-0 and
/// what lies below are in a page of their own.
pub fn copc(nodes: &[Node], pages: bool) -> Vec<u8> {
    let plain = las(nodes, false);
    let items = LazItemRecordBuilder::default_for_point_format_id(7, 0).unwrap();
    let vlr = LazVlrBuilder::new(items).with_variable_chunk_size().build();
    let mut laszip = Vec::new();
    vlr.write_to(&mut laszip).unwrap();
    let mut file = plain[..HEADER].to_vec();
    file.extend(record("copc", 1, &(INFO as u16).to_le_bytes()));
    file.resize(INFO_AT + INFO, 0);
    file.extend(record("laszip encoded", 22204, &(laszip.len() as u16).to_le_bytes()));
    file.extend(laszip);
    let start = file.len() as u32;
    file[96..100].copy_from_slice(&start.to_le_bytes());
    file[100..104].copy_from_slice(&2_u32.to_le_bytes());
    file[104] = 0x80 | 7;
    let mut out = Cursor::new(file);
    out.set_position(start.into());
    let mut packer = LasZipCompressor::new(out, vlr).unwrap();
    let (mut root, mut child) = (Vec::new(), Vec::new());
    let mut start = u64::from(start) + 8;
    let mut left = &plain[plain.len() - nodes.iter().map(|n| n.1).sum::<usize>() * POINT..];
    for &(key, count) in nodes {
        let mut end = start;
        if count > 0 {
            packer.compress_many(&left[..count * POINT]).unwrap();
            packer.finish_current_chunk().unwrap();
            left = &left[count * POINT..];
            end = packer.get().position();
        }
        let [level, x, y, z] = key;
        let below = pages && level > 0 && [x, y, z].iter().all(|i| i >> (level - 1) == 0);
        let page = if below { &mut child } else { &mut root };
        page.extend(entry(key, start, (end - start) as i32, count as i32));
        start = end;
    }
    packer.done().unwrap();
    let mut file = packer.into_inner().into_inner();
    let evlr = file.len() as u64;
    let first = evlr + 60;
    if !child.is_empty() {
        let start = first + root.len() as u64 + 32;
        root.extend(entry([1, 0, 0, 0], start, child.len() as i32, -1));
    }
    file[235..243].copy_from_slice(&evlr.to_le_bytes());
    file[243..247].copy_from_slice(&1_u32.to_le_bytes());
    file.extend(record("copc", 1000, &((root.len() + child.len()) as u64).to_le_bytes()));
    assert_eq!(file.len() as u64, first);
    let middle = LOW + SIDE / 2.0;
    let cube = [middle, middle, middle, SIDE / 2.0, SPACING].map(f64::to_le_bytes).concat();
    file[INFO_AT..INFO_AT + 40].copy_from_slice(&cube);
    let page = [first, root.len() as u64].map(u64::to_le_bytes).concat();
    file[INFO_AT + 40..INFO_AT + 56].copy_from_slice(&page);
    file.extend(root);
    file.extend(child);
    file
}
