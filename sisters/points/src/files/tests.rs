//! Round trips, files written by hand and by other libraries, and broken ones.

use std::io::Cursor;

use proptest::prelude::*;

use super::*;
use crate::samples::cases;
use glam::{DVec3, Vec3};

const ASCII: &str = "ply\nformat ascii 1.0\ncomment by hand\nelement camera 1\nproperty float view\nelement vertex 3\n\
    property list uchar int ring\nproperty double x\nproperty float nx\nproperty double y\nproperty float ny\nproperty double z\n\
    property float nz\nproperty float red\nproperty float green\nproperty float blue\nelement face 1\n\
    property list uchar int vertex_index\nend_header\n45\n2 7 8 5000000.25 0 -3 0 1 2 1 0.5 0\n0 5000001 0 -4 3 1 0 1 1 1\n\
    1 5 nan 0 0 0 0 0 0 0 0\n3 0 1 2\n";

const SURFELS: &str = "2\n1 2 3 1 0 0 1 0 0 0.3\n\n3 2 1 0 1 0 0 1 0 0.3\n";

fn parse(bytes: &[u8]) -> Result<(PointCloud, Report), FileError> {
    let mut all = PointCloud::default();
    let report = read_source::<FileError>(Cursor::new(bytes.to_vec()), "test".into(), usize::MAX, |chunk| {
        all = chunk;
        Ok(())
    })?;
    all.check().unwrap();
    Ok((all, report))
}

/// What a file says of itself: why it is refused, or the last warning.
fn cause(bytes: &[u8]) -> String {
    match parse(bytes) {
        Ok((_, report)) => report.warnings.last().cloned().unwrap_or_default(),
        Err(error) => error.to_string(),
    }
}

/// The points of a file that is read with one warning, which says this.
#[track_caller]
fn read_with(bytes: &[u8], warning: &str) -> PointCloud {
    let (cloud, report) = parse(bytes).unwrap();
    let said = &report.warnings[..];
    assert!(matches!(said, [said] if said.contains(warning)), "{said:?} / {warning}");
    assert!(!said[0].contains("fill whole buffer"));
    cloud
}

/// The points of a file that is read without a warning.
#[track_caller]
fn sound(bytes: &[u8]) -> PointCloud {
    let (cloud, report) = parse(bytes).unwrap();
    assert_eq!(report.warnings, Vec::<String>::new());
    cloud
}

/// `count` points on a helix far from zero, with colours, normals and radii.
fn helix(count: usize) -> PointCloud {
    let turn = |i: usize| Vec3::new((i as f32).cos(), (i as f32).sin(), 0.0);
    PointCloud {
        origin: DVec3::new(4_500_480.0, -1024.0, 0.0),
        positions: (0..count).map(|i| turn(i) * 20.0 + Vec3::Z * i as f32).collect(),
        colours: (0..count).map(|i| [i as u8, 255 - i as u8, 7]).collect(),
        normals: (0..count).map(|i| turn(2 * i).normalize_or_zero()).collect(),
        radii: (0..count).map(|i| 0.1 + i as f32).collect(),
        ..PointCloud::default()
    }
}

fn ply(cloud: &PointCloud) -> Vec<u8> {
    let mut bytes = Vec::new();
    PlyWriter::write_all(&mut bytes, cloud).unwrap();
    bytes
}

/// The helix with colours in 16 bits, written by the crate `las`.
fn las(count: usize, compressed: bool) -> Vec<u8> {
    las_with_colours(count, compressed, 257)
}

/// With the bytes of colours multiplied by `scale`.
fn las_with_colours(count: usize, compressed: bool, scale: u16) -> Vec<u8> {
    let cloud = helix(count);
    let mut builder = las::Builder::from((1, 4));
    builder.point_format = las::point::Format::new(2).unwrap();
    builder.point_format.is_compressed = compressed;
    let transform = |offset| las::Transform { scale: 1e-3, offset };
    builder.transforms = las::Vector { x: transform(4_500_000.0), y: transform(0.0), z: transform(0.0) };
    let mut writer = las::Writer::new(Cursor::new(Vec::new()), builder.into_header().unwrap()).unwrap();
    for (p, c) in cloud.world_positions().zip(&cloud.colours) {
        let [red, green, blue] = c.map(|c| u16::from(c) * scale);
        let color = Some(las::Color { red, green, blue });
        writer.write_point(las::Point { x: p.x, y: p.y, z: p.z, color, ..Default::default() }).unwrap();
    }
    writer.close().unwrap();
    writer.into_inner().unwrap().into_inner()
}

/// The helix in doubles, moved by a pose of 1 unit along x, written by the crate `e57`.
fn e57(count: usize) -> Vec<u8> {
    e57_of(count, &[(Some(1.0), false)])
}

/// The helix once for each scan: with a pose that moves it along x, and with the rows of a scanner.
fn e57_of(count: usize, scans: &[(Option<f64>, bool)]) -> Vec<u8> {
    use e57::{Record, RecordDataType, RecordName, RecordValue, Transform, Translation};
    let mut bytes = Cursor::new(Vec::new());
    let mut file = e57::E57Writer::new(&mut bytes, "file").unwrap();
    for (i, &(pose, rows)) in scans.iter().enumerate() {
        let mut prototype = vec![Record::CARTESIAN_X_F64, Record::CARTESIAN_Y_F64, Record::CARTESIAN_Z_F64];
        let data_type = RecordDataType::Integer { min: 0, max: 255 };
        let index = |name| Record { name, data_type: data_type.clone() };
        if rows {
            prototype.extend([index(RecordName::RowIndex), index(RecordName::ColumnIndex)]);
        }
        let mut scan = file.add_pointcloud(&format!("scan {i}"), prototype).unwrap();
        let pose = pose.map(|x| Translation { x, y: 0.0, z: 0.0 });
        scan.set_transform(pose.map(|translation| Transform { translation, ..Default::default() }));
        for p in helix(count).world_positions() {
            let mut values = p.to_array().map(RecordValue::Double).to_vec();
            values.extend([RecordValue::Integer(3), RecordValue::Integer(4)].into_iter().filter(|_| rows));
            scan.add_point(values).unwrap();
        }
        scan.finalize().unwrap();
    }
    file.finalize().unwrap();
    drop(file);
    bytes.into_inner()
}

#[test]
fn an_ascii_file_is_read_as_its_header_says() {
    let (cloud, report) = parse(ASCII.as_bytes()).unwrap();
    assert_eq!((report.skipped, report.warnings.len()), (1, 0), "a point has no number for its y");
    let places: Vec<DVec3> = cloud.world_positions().collect();
    assert_eq!(places, [DVec3::new(5_000_000.25, -3.0, 1.0), DVec3::new(5_000_001.0, -4.0, 1.0)]);
    assert_eq!(cloud.normals, [Vec3::Z, Vec3::Y]);
    assert_eq!(cloud.colours, [[255, 128, 0], [255, 255, 255]]);
    assert!(cloud.radii.is_empty());
}

#[test]
fn big_endian_files_are_read() {
    let mut bytes =
        b"ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty short x\nproperty double y\n\
        property float z\nproperty ushort red\nproperty uchar green\nproperty uchar blue\nend_header\n"
            .to_vec();
    bytes.extend((-7_i16).to_be_bytes());
    bytes.extend(0.5_f64.to_be_bytes());
    bytes.extend(9.25_f32.to_be_bytes());
    bytes.extend([0x80, 0x80, 3, 4]);
    let (cloud, _) = parse(&bytes).unwrap();
    assert_eq!(
        (cloud.positions, cloud.colours, cloud.origin),
        (vec![Vec3::new(-7.0, 0.5, 9.25)], vec![[128, 3, 4]], DVec3::ZERO)
    );
}

#[test]
fn clouds_come_back_from_ply() {
    let near = PointCloud { origin: DVec3::ZERO, normals: Vec::new(), ..helix(20) };
    for cloud in [helix(200), near] {
        let (back, _) = parse(&ply(&cloud)).unwrap();
        assert!(back == cloud, "{:?} {:?}", back.positions[0], cloud.positions[0]);
    }
    let short = PlyWriter::new(Vec::new(), 3, Attributes::default(), false).unwrap();
    assert!(short.finish().unwrap_err().to_string().contains("3 points fewer"));
}

#[test]
fn surfels_are_read() {
    let (cloud, _) = parse(SURFELS.as_bytes()).unwrap();
    assert_eq!(cloud.positions, [Vec3::new(1.0, 2.0, 3.0), Vec3::new(3.0, 2.0, 1.0)]);
    assert_eq!((cloud.colours[1], cloud.normals[1], cloud.radii[1]), ([0, 255, 0], Vec3::Y, 0.3));
}

#[test]
fn scans_are_read_to_their_resolution() {
    let expected = helix(300);
    let scans = [(las(300, false), 0.0, 6e-4), (las(300, true), 0.0, 6e-4), (e57(300), 1.0, 5e-5)];
    for (bytes, moved, resolution) in scans {
        let (cloud, _) = parse(&bytes).unwrap();
        assert_eq!(cloud.len(), 300);
        let moved = DVec3::X * moved;
        let errors =
            cloud.world_positions().zip(expected.world_positions()).map(|(a, b)| a.distance(b + moved));
        let worst = errors.fold(0.0, f64::max);
        assert!(worst < resolution * 3_f64.sqrt(), "{worst}");
        assert!(cloud.colours.is_empty() || cloud.colours == expected.colours);
    }
}

#[test]
fn points_of_scans_have_the_places_of_their_scanners() {
    // Without a pose, with one, and with one that does not move, without and with rows.
    let scans = [(None, false), (Some(1.0), false), (Some(0.0), false), (Some(0.0), true), (None, true)];
    let expected = [None, Some(DVec3::X), None, Some(DVec3::ZERO), Some(DVec3::ZERO)];
    let bytes = e57_of(5, &scans);
    for most in [1, 7, usize::MAX] {
        let mut index = 0;
        let each = |chunk: PointCloud| {
            assert_eq!(chunk.check(), Ok(()));
            assert!(chunk.scanners.len() <= chunk.len().min(2), "others' scanners");
            for i in 0..chunk.len() {
                assert_eq!(chunk.scanner(i), expected[index / 5], "point {index} in chunks of {most}");
                index += 1;
            }
            Ok::<_, FileError>(())
        };
        read_source(Cursor::new(bytes.clone()), "test".into(), most, each).unwrap();
        assert_eq!(index, 25);
    }
}

#[test]
fn colours_of_8_and_of_16_bits_are_the_same() {
    for compressed in [false, true] {
        for scale in [1, 256, 257] {
            let (cloud, _) = parse(&las_with_colours(300, compressed, scale)).unwrap();
            assert_eq!(cloud.colours, helix(300).colours, "times {scale}");
        }
    }
}

#[test]
fn chunks_of_any_size_hold_the_same_points() {
    for bytes in [ply(&helix(50)), las(50, true), e57(50)] {
        let (whole, _) = parse(&bytes).unwrap();
        for most in [0, 1, 7, 50, 51] {
            let mut positions = Vec::new();
            let each = |chunk: PointCloud| {
                assert!(chunk.len() <= most.max(1) && chunk.origin == whole.origin);
                positions.extend(chunk.positions);
                Ok::<_, FileError>(())
            };
            read_source(Cursor::new(bytes.clone()), "test".into(), most, each).unwrap();
            assert_eq!(positions, whole.positions);
        }
    }
}

#[test]
fn errors_name_the_place_and_the_cause() {
    let expect = |bytes: &[u8], part: &str| {
        let said = cause(bytes);
        assert!(said.starts_with("test") && said.contains(part) && said.len() < 500, "{said} / {part}");
    };
    expect(b"", "it is empty");
    expect(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "no number of surfels");
    expect(&SURFELS.as_bytes()[..25], "test, line 4: the file ends after 1 of 2 surfels");
    expect(SURFELS.replace("3 2 1", "3 2 a").as_bytes(), "line 4: a surfel is ten numbers");
    expect(ASCII.replace("5000001", "five").as_bytes(), "line 22, vertex 1 of 3");
    expect(ASCII.replace("element vertex", "element point").as_bytes(), "no element vertex");
    expect(ASCII.replace("double z", "double w").as_bytes(), "vertex has no x, y and z");
    expect(&ASCII.as_bytes()[..ASCII.find("1 5 nan").unwrap()], "the file ends here");
    expect(ASCII.replace("vertex 3", "vertex 99999999999999").as_bytes(), "of 99999999999999");
    let whole = ply(&helix(9));
    expect(&whole[..whole.len() - 1], "vertex 8 of 9");
    expect(&las(9, false)[..400], "after point 0 of 9: the file ends here");
    expect(&las(9, true)[..500], "after point 0 of 9: the file ends here");
    expect(&las(9, false)[..100], "it ends after 100 bytes; a header has at least 227");
    assert!(matches!(read(Path::new("/no/such/file")), Err(FileError::Io { .. })));
}

/// A text PLY file of one kind of points: its properties, and the lines of the points.
fn text_ply(properties: &str, points: &str) -> String {
    let count = points.lines().count();
    format!("ply\nformat ascii 1.0\nelement vertex {count}\n{properties}end_header\n{points}")
}

const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";

#[test]
fn headers_of_ply_are_read_as_programs_write_them() {
    let plain = text_ply(XYZ, "-1 0 0\n0 1 0\n1 0 2.5\n");
    let expected = sound(plain.as_bytes());
    let same = |bytes: &[u8]| assert!(sound(bytes) == expected, "{}", String::from_utf8_lossy(bytes));
    same(plain.replacen("ply\n", "ply \n", 1).as_bytes());
    same(plain.replace('\n', " \t\n").as_bytes());
    same(plain.replace('\n', "\r\n").as_bytes());
    same(plain.replace('\n', "\r").as_bytes());
    same(plain.replace('\n', "\n\n").as_bytes());
    same(format!("\u{feff}{plain}").as_bytes());
    same(plain.replacen("ply", "PLY", 1).replace("property float", "Property FLOAT").as_bytes());
    same(plain.replace("property float x", "property float32 X").replace("vertex", "Vertex").as_bytes());
    same(plain.replace("format ascii 1.0", "format ascii 1.1\nobj_info made by hand").as_bytes());
    same(plain.replace("element vertex", "element face 0\nelement vertex").as_bytes());
    same((plain.clone() + "3 0 1 2\nand more\n").as_bytes());
    same(plain.replace("2.5", "2,5").as_bytes());
    same(plain.replace("-1 0 0", "-1, 0, 0").as_bytes());
    // Latin-1.
    let mut bytes = plain.replacen("element", "comment M@nchen\nelement", 1).into_bytes();
    let at = bytes.iter().position(|&byte| byte == b'@').unwrap();
    bytes[at] = 0xfc;
    same(&bytes);
    // Binary points behind a header whose lines end in each way; their first byte is a line feed.
    for end in ["\n", "\r\n", "\r", " \n"] {
        let head = text_ply(XYZ, "1").replace("ascii", "binary_little_endian").replace("r\n1", "r\n");
        let mut bytes = head.replace('\n', end).into_bytes();
        [f32::from_bits(0x3f80_000a), 2.0, 3.0].iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        assert_eq!(sound(&bytes).positions, [Vec3::new(f32::from_bits(0x3f80_000a), 2.0, 3.0)], "{end:?}");
    }
}

#[test]
fn a_line_that_is_wrong_is_left_out_with_a_warning() {
    let plain = text_ply(XYZ, "-1 0 0\n0 1 0\n1 0 2.5\n");
    let two =
        read_with(plain.replace("0 1 0", "0 one 0").as_bytes(), "line 9, vertex 1 of 3: y is no number: one");
    assert_eq!(two.positions, [Vec3::NEG_X, Vec3::new(1.0, 0.0, 2.5)]);
    let said = cause(plain.replace("0 1 0", "0 1").as_bytes());
    assert_eq!(said, "test, line 9, vertex 1 of 3: z is missing; 1 of 3 points could not be read");
    let strange = plain.replacen("element", "vendor stuff\nelement", 1);
    assert_eq!(read_with(strange.as_bytes(), "line 3 is none of a PLY header: vendor stuff").len(), 3);
    let short = plain.replace("vertex 3", "vertex 5");
    assert_eq!(read_with(short.as_bytes(), "vertex 3 of 5: the file ends here; 2 of 5").len(), 3);
    let huge = plain.replace("0 1 0", &"x".repeat(30_000));
    assert!(cause(huge.as_bytes()).len() < 200);
    // Points without a place are none that could not be read.
    let words = "1 nan 0\n1 -nan(ind) 0\n1 1.#QNAN 0\n1 inf 0\n1 -1.#INF 0\n1 2 3\n";
    let (cloud, report) = parse(text_ply(XYZ, words).as_bytes()).unwrap();
    assert_eq!((cloud.len(), report.skipped, report.warnings.len()), (1, 5, 0));
    let surfels = format!("{}1 2\n", SURFELS.replace("3 2 1", "3 2,5 -nan(ind)"));
    let (cloud, report) = parse(format!("\u{feff}{surfels}").replace('\n', "\r").as_bytes()).unwrap();
    assert_eq!((cloud.len(), report.skipped, report.warnings.len()), (1, 1, 1));
    assert!(report.warnings[0].contains("line 5 and those behind it follow the 2 surfels"));
}

#[test]
fn the_origin_is_near_the_points() {
    // Points of a survey behind one that is wrong.
    let far = |i: usize| format!("{} 5400000.5 {i}\n", 400_000.25 + i as f64);
    let points = "0 0 0\n".to_owned() + &(0..2000).map(far).collect::<String>();
    let cloud = sound(text_ply(&XYZ.replace("float", "double"), &points).as_bytes());
    let last = cloud.world_positions().last().unwrap();
    assert!(last.distance(DVec3::new(401_999.25, 5_400_000.5, 1999.0)) < 1e-4, "{last}");
    for compressed in [false, true] {
        let mut bytes = las(200, compressed);
        for (i, bound) in [-234_935_841.0, -235_434_519.0, 8e8, 8e8, f64::NAN, 1e300_f64].iter().enumerate() {
            bytes[179 + 8 * i..187 + 8 * i].copy_from_slice(&bound.to_le_bytes());
        }
        let moved = |cloud: PointCloud| cloud.world_positions().collect::<Vec<_>>();
        let expected = moved(helix(200));
        let found = moved(read_with(&bytes, "its header says that points lie from"));
        let worst = found.iter().zip(&expected).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        assert!(worst < 2e-3, "{worst}");
    }
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn no_bytes_cause_a_panic(
        kind in 0..7_usize,
        cut in prop::option::of(0..4000_usize),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..8),
        mut noise in prop::collection::vec(any::<u8>(), 0..300),
    ) {
        static FILES: std::sync::LazyLock<[Vec<u8>; 6]> = std::sync::LazyLock::new(|| {
            [ASCII.into(), ply(&helix(40)), SURFELS.into(), las(40, false), las(40, true), e57(40)]
        });
        let bytes = match FILES.get(kind) {
            Some(file) => {
                let mut file = file[..cut.unwrap_or(usize::MAX).min(file.len())].to_vec();
                for (index, value) in changes.iter().filter(|_| cut != Some(0)) {
                    *index.get_mut(&mut file) = *value;
                }
                file
            }
            None => {
                noise.splice(0..0, *[b"ply\n", b"LASF", b"ASTM", b"9\n\n\n"][noise.len() % 4]);
                noise
            }
        };
        let _ = parse(&bytes);
    }
}
