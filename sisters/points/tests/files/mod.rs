//! Small valid files of each format, for tests of damaged ones and for the fuzz target `readers`.

// Each test and the fuzz target use a part of it.
#![allow(dead_code)]

use casca_points::PointCloud;
use casca_points::bricks::{BuildOptions, Builder};
use casca_points::files::PlyWriter;
use glam::{DVec3, Vec3};
use std::io::Cursor;

pub const ASCII: &str = "ply\nformat ascii 1.0\ncomment by hand\nelement camera 1\nproperty float view\nelement vertex 3\n\
    property list uchar int ring\nproperty double x\nproperty float nx\nproperty double y\nproperty float ny\nproperty double z\n\
    property float nz\nproperty float red\nproperty float green\nproperty float blue\nelement face 1\n\
    property list uchar int vertex_index\nend_header\n45\n2 7 8 5000000.25 0 -3 0 1 2 1 0.5 0\n0 5000001 0 -4 3 1 0 1 1 1\n\
    1 5 nan 0 0 0 0 0 0 0 0\n3 0 1 2\n";

/// Where the points of LAS files are counted from, in x.
const FAR: f64 = 4_500_000.0;

/// Points on a helix far from zero, with colours, normals and radii.
pub fn helix(count: usize) -> PointCloud {
    let turn = |i: usize| Vec3::new((i as f32).cos(), (i as f32).sin(), 0.0);
    PointCloud {
        origin: DVec3::new(4_500_480.0, -1024.0, 0.0),
        positions: (0..count).map(|i| turn(i) * 20.0 + Vec3::Z * i as f32).collect(),
        colours: (0..count).map(|i| [i as u8, 255 - i as u8, 7]).collect(),
        normals: (0..count).map(|i| turn(2 * i).normalize_or_zero()).collect(),
        radii: (0..count).map(|i| 0.1 + i as f32).collect(),
    }
}

pub fn ply(cloud: &PointCloud) -> Vec<u8> {
    let mut bytes = Vec::new();
    PlyWriter::write_all(&mut bytes, cloud).expect("a list takes all bytes");
    bytes
}

/// Binary, with lists before and among the coordinates.
fn ply_with_lists(little: bool) -> Vec<u8> {
    let order = if little { "little" } else { "big" };
    let mut bytes = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement face 1\nproperty list uint double weights\nelement vertex 2\n\
         property double x\nproperty list ushort int near\nproperty float y\nproperty float z\nend_header\n"
    )
    .into_bytes();
    let mut put = |le: &[u8]| if little { bytes.extend(le) } else { bytes.extend(le.iter().rev()) };
    put(&1_u32.to_le_bytes());
    put(&0.5_f64.to_le_bytes());
    for i in 0..2_u16 {
        put(&f64::from(i).to_le_bytes());
        put(&i.to_le_bytes());
        (0..i).for_each(|_| put(&7_i32.to_le_bytes()));
        put(&1.0_f32.to_le_bytes());
        put(&2.0_f32.to_le_bytes());
    }
    bytes
}

/// The helix in a format of points, written by the crate `las`. From format 6 on, compressed points
/// lie in layers.
pub fn las(count: usize, format: u8, extra_bytes: u16, compressed: bool) -> Vec<u8> {
    las_with_colours(count, format, extra_bytes, compressed, 257)
}

/// With the bytes of colours multiplied by `scale`.
pub fn las_with_colours(count: usize, format: u8, extra_bytes: u16, compressed: bool, scale: u16) -> Vec<u8> {
    let mut point_format = las::point::Format::new(format).expect("a known format");
    point_format.is_compressed = compressed;
    point_format.extra_bytes = extra_bytes;
    let cloud = helix(count);
    let points = cloud.world_positions().zip(&cloud.colours).enumerate().map(|(i, (p, c))| {
        let [red, green, blue] = c.map(|c| u16::from(c) * scale);
        las::Point {
            x: p.x,
            y: p.y,
            z: p.z,
            color: point_format.has_color.then_some(las::Color { red, green, blue }),
            nir: point_format.has_nir.then_some(i as u16),
            gps_time: point_format.has_gps_time.then_some(i as f64),
            waveform: point_format.has_waveform.then(Default::default),
            extra_bytes: vec![i as u8; extra_bytes.into()],
            ..Default::default()
        }
    });
    las_with(point_format, points)
}

/// Compressed points of a format that are all the same.
pub fn las_of_one(count: usize, format: u8) -> Vec<u8> {
    let mut point_format = las::point::Format::new(format).expect("a known format");
    point_format.is_compressed = true;
    let point = las::Point {
        x: FAR,
        color: point_format.has_color.then(Default::default),
        gps_time: point_format.has_gps_time.then_some(0.0),
        ..Default::default()
    };
    las_with(point_format, std::iter::repeat_n(point, count))
}

/// Points, written by the crate `las`.
fn las_with(format: las::point::Format, points: impl Iterator<Item = las::Point>) -> Vec<u8> {
    let mut builder = las::Builder::from((1, 4));
    builder.point_format = format;
    let transform = |offset| las::Transform { scale: 1e-3, offset };
    builder.transforms = las::Vector { x: transform(FAR), y: transform(0.0), z: transform(0.0) };
    let header = builder.into_header().expect("a plain header");
    let mut writer = las::Writer::new(Cursor::new(Vec::new()), header).expect("a list takes all bytes");
    points.for_each(|point| writer.write_point(point).expect("a list takes all bytes"));
    writer.close().expect("a list takes all bytes");
    writer.into_inner().expect("a closed writer").into_inner()
}

/// A number of 32 bits in a file.
pub fn number(file: &[u8], at: usize) -> usize {
    u32::from_le_bytes(std::array::from_fn(|i| file[at + i])) as usize
}

/// A file with other bytes in some places.
pub fn with(file: &[u8], changes: &[(usize, &[u8])]) -> Vec<u8> {
    let mut file = file.to_vec();
    changes.iter().for_each(|&(at, bytes)| file[at..at + bytes.len()].copy_from_slice(bytes));
    file
}

/// Points of a file that is not compressed, compressed in chunks of `fixed` points; or else in
/// chunks of these numbers of points and one of the others, as COPC files are.
pub fn packed(plain: &[u8], format: u8, fixed: Option<u32>, chunks: &[usize]) -> Vec<u8> {
    let items = laz::LazItemRecordBuilder::default_for_point_format_id(format, 0).expect("a known format");
    let builder = laz::LazVlrBuilder::new(items);
    let vlr = match fixed {
        Some(points) => builder.with_fixed_chunk_size(points).build(),
        None => builder.with_variable_chunk_size().build(),
    };
    let mut record = Vec::new();
    vlr.write_to(&mut record).expect("a list takes all bytes");
    let (id, length) = (22204_u16.to_le_bytes(), (record.len() as u16).to_le_bytes());
    let (head, mut left) = plain.split_at(number(plain, 96));
    let file = [head, &[0, 0], b"laszip encoded\0\0", &id, &length, &[0; 32], &record].concat();
    let (start, records) = (file.len() as u32, number(plain, 100) as u32 + 1);
    let mut out = Cursor::new(with(
        &file,
        &[(96, &start.to_le_bytes()), (100, &records.to_le_bytes()), (104, &[format | 0x80])],
    ));
    out.set_position(start.into());
    let size = vlr.items_size() as usize;
    let mut packer = laz::LasZipCompressor::new(out, vlr).expect("a known record");
    for chunk in chunks {
        let (now, rest) = left.split_at(chunk * size);
        packer.compress_many(now).expect("a list takes all bytes");
        packer.finish_current_chunk().expect("a list takes all bytes");
        left = rest;
    }
    packer.compress_many(left).expect("a list takes all bytes");
    packer.done().expect("a list takes all bytes");
    packer.into_inner().into_inner()
}

/// The helix, written by the crate `e57`: coordinates in doubles or in few bits, an attribute of no
/// bits, and a pose that moves it along x.
pub fn e57(count: usize, doubles: bool, pose: Option<f64>) -> Vec<u8> {
    use e57::{Record, RecordDataType, RecordName, RecordValue, Transform, Translation};
    let mut bytes = Cursor::new(Vec::new());
    let mut file = e57::E57Writer::new(&mut bytes, "file").expect("a list takes all bytes");
    let scaled = RecordDataType::ScaledInteger { min: -1000, max: 9_999_999, scale: 1.0, offset: 0.0 };
    let data_type = if doubles { RecordDataType::F64 } else { scaled };
    let value = |c: f64| if doubles { RecordValue::Double(c) } else { RecordValue::ScaledInteger(c as i64) };
    let names = [RecordName::CartesianX, RecordName::CartesianY, RecordName::CartesianZ];
    let places = names.into_iter().map(|name| Record { name, data_type: data_type.clone() });
    let constant = RecordDataType::Integer { min: 7, max: 7 };
    let row = Record { name: RecordName::RowIndex, data_type: constant };
    let mut scan = file.add_pointcloud("scan", places.chain([row]).collect()).expect("a plain scan");
    let pose = pose.map(|x| Translation { x, y: 0.0, z: 0.0 });
    scan.set_transform(pose.map(|translation| Transform { translation, ..Default::default() }));
    for p in helix(count).world_positions() {
        let mut values = p.to_array().map(value).to_vec();
        values.push(RecordValue::Integer(7));
        scan.add_point(values).expect("a list takes all bytes");
    }
    scan.finalize().expect("a list takes all bytes");
    file.finalize().expect("a list takes all bytes");
    drop(file);
    bytes.into_inner()
}

/// A file of bricks.
pub fn bricks(count: usize) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("bricks");
    let options = BuildOptions { most_points: 50, ..BuildOptions::default() };
    let mut builder = Builder::create(&path, options).expect("a file");
    builder.push(&helix(count)).expect("finite points");
    builder.finish(|_, _| ()).expect("a file");
    std::fs::read(&path).expect("a file")
}

/// Files of all formats but bricks.
pub fn all() -> Vec<Vec<u8>> {
    vec![
        ASCII.into(),
        ply(&helix(40)),
        ply_with_lists(true),
        ply_with_lists(false),
        las(40, 2, 0, false),
        las(40, 2, 5, true),
        las(40, 5, 0, true),
        las(40, 7, 3, false),
        las(40, 7, 3, true),
        las(40, 10, 0, true),
        packed(&las(40, 3, 0, false), 3, Some(16), &[]),
        packed(&las(40, 7, 0, false), 7, Some(16), &[]),
        packed(&las(40, 7, 0, false), 7, None, &[9, 1, 20]),
        e57(40, true, None),
        e57(40, false, None),
    ]
}

/// Sets the checksums of the pages of an E57 file right; leaves others as they are.
pub fn mend(file: &mut Vec<u8>) {
    const PAGE: usize = 1024;
    if !file.starts_with(b"ASTM-E57") {
        return;
    }
    file.resize(file.len().next_multiple_of(PAGE), 0);
    for page in file.chunks_exact_mut(PAGE) {
        let (data, sum) = page.split_at_mut(PAGE - 4);
        // CRC-32C (Castagnoli et al. 1993).
        let step = |c: u32, _| c >> 1 ^ (0x82f6_3b78 & 0_u32.wrapping_sub(c & 1));
        let crc = data.iter().fold(u32::MAX, |c, &byte| (0..8).fold(c ^ u32::from(byte), step));
        sum.copy_from_slice(&(!crc).to_be_bytes());
    }
}
