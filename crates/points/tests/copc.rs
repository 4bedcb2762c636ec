//! Cloud-optimized files (COPC 1.0) are read as the LAZ files that they are: all points of all
//! levels of detail, from chunks of different sizes.

use std::io::{Cursor, Write};

use casca_points::PointCloud;
use casca_points::files::{FileError, read_source};
use glam::DVec3;
use laz::{LasZipCompressor, LazItemRecordBuilder, LazVlrBuilder};

/// Bytes of a header of LAS 1.4 and of a point of format 7, and of the record of COPC.
const HEADER: usize = 375;
const POINT: usize = 36;
const INFO: usize = 160;

/// Where points lie, exactly in the scale of the file.
fn place(i: usize) -> DVec3 {
    DVec3::new((i % 7) as f64 * 0.5, (i % 11) as f64 * 0.25, (i % 5) as f64)
}

fn colour(i: usize) -> [u8; 3] {
    [i as u8, 255 - i as u8, 9]
}

/// A file of LAS 1.4 without compression, by the crate `las`.
fn plain(count: usize) -> Vec<u8> {
    let mut builder = las::Builder::from((1, 4));
    builder.point_format = las::point::Format::new(7).unwrap();
    let transform = las::Transform { scale: 1e-3, offset: 0.0 };
    builder.transforms = las::Vector { x: transform, y: transform, z: transform };
    let mut writer = las::Writer::new(Cursor::new(Vec::new()), builder.into_header().unwrap()).unwrap();
    for i in 0..count {
        let (p, [red, green, blue]) = (place(i), colour(i).map(|c| u16::from(c) * 257));
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

/// A file whose nodes have so many points: a root, and children of it, each a chunk of its own.
fn copc(nodes: &[usize]) -> Vec<u8> {
    let count = nodes.iter().sum();
    let plain = plain(count);
    let items = LazItemRecordBuilder::default_for_point_format_id(7, 0).unwrap();
    let vlr = LazVlrBuilder::new(items).with_variable_chunk_size().build();
    let mut laszip = Vec::new();
    vlr.write_to(&mut laszip).unwrap();
    let mut file = plain[..HEADER].to_vec();
    file.extend(record("copc", 1, &(INFO as u16).to_le_bytes()));
    let info = file.len();
    file.resize(info + INFO, 0);
    file.extend(record("laszip encoded", 22204, &(laszip.len() as u16).to_le_bytes()));
    file.extend(laszip);
    let points = file.len() as u32;
    file[96..100].copy_from_slice(&points.to_le_bytes());
    file[100..104].copy_from_slice(&2_u32.to_le_bytes());
    file[104] = 0x80 | 7;
    let mut out = Cursor::new(file);
    out.set_position(points.into());
    let mut packer = LasZipCompressor::new(out, vlr).unwrap();
    let mut entries = Vec::new();
    let mut start = u64::from(points) + 8;
    let mut left = &plain[plain.len() - count * POINT..];
    for (i, &node) in nodes.iter().enumerate() {
        packer.compress_many(&left[..node * POINT]).unwrap();
        packer.finish_current_chunk().unwrap();
        left = &left[node * POINT..];
        let end = packer.get().position();
        // Level, x, y and z: the root, or one of its children.
        let key = if i == 0 { [0; 4] } else { [1, i as i32 & 1, i as i32 >> 1 & 1, i as i32 >> 2 & 1] };
        entries.extend(key.map(i32::to_le_bytes).concat());
        entries.extend(start.to_le_bytes());
        entries.extend([(end - start) as i32, node as i32].map(i32::to_le_bytes).concat());
        start = end;
    }
    packer.done().unwrap();
    let mut file = packer.into_inner().into_inner();
    let pages = file.len() as u64;
    file[235..243].copy_from_slice(&pages.to_le_bytes());
    file[243..247].copy_from_slice(&1_u32.to_le_bytes());
    file.write_all(&record("copc", 1000, &(entries.len() as u64).to_le_bytes())).unwrap();
    let first = file.len() as u64;
    // The middle and half side of the cube, the spacing of the root, and the page of the hierarchy.
    let cube = [2.0, 2.0, 2.0, 2.5, 0.5].map(f64::to_le_bytes).concat();
    file[info..info + 40].copy_from_slice(&cube);
    let page = [first, entries.len() as u64].map(u64::to_le_bytes).concat();
    file[info + 40..info + 56].copy_from_slice(&page);
    file.extend(entries);
    file
}

fn parse(bytes: Vec<u8>) -> Result<PointCloud, FileError> {
    let mut all = PointCloud::default();
    read_source(Cursor::new(bytes), "test.copc.laz".into(), usize::MAX, |cloud| {
        all = cloud;
        Ok::<_, FileError>(())
    })?;
    Ok(all)
}

#[test]
fn all_points_of_all_nodes_are_read() {
    for nodes in [&[9][..], &[50, 1, 200, 3], &[1000, 70_000, 5]] {
        let cloud = parse(copc(nodes)).unwrap();
        assert_eq!(cloud.len(), nodes.iter().sum::<usize>());
        for (i, p) in cloud.world_positions().enumerate() {
            assert!(p.distance(place(i)) < 1e-9, "{i}: {p}");
        }
        assert!(cloud.colours.iter().enumerate().all(|(i, &c)| c == colour(i)));
    }
}

#[test]
fn a_file_that_was_cut_is_refused() {
    let whole = copc(&[50, 1, 200]);
    let points = u32::from_le_bytes(std::array::from_fn(|i| whole[96 + i])) as usize;
    for end in [200, HEADER + 20, points - 1, points + 4, points + 60] {
        let said = parse(whole[..end].to_vec()).unwrap_err().to_string();
        assert!(said.contains("test.copc.laz"), "{end}: {said}");
    }
}
