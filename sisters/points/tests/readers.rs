//! Files of all formats, written by hand and by other libraries; and as people have them: cut short,
//! with headers that contradict the points. What can be read is read, with a warning that is right.

use casca_points::PointCloud;
use casca_points::files::{Attributes, FileError, PlyWriter, Report, read, read_source};
use files::{ASCII, e57, helix, las, las_with_colours, number, packed, ply, with};
use glam::{DVec3, Vec3};
use std::io::Cursor;

mod files;

fn reported(bytes: &[u8]) -> Result<(PointCloud, Report), String> {
    let mut all = PointCloud::default();
    let each = |chunk: PointCloud| {
        all = chunk;
        Ok::<_, FileError>(())
    };
    let report = read_source(Cursor::new(bytes.to_vec()), "test".into(), usize::MAX, each);
    all.check().unwrap();
    report.map(|report| (all, report)).map_err(|e| e.to_string())
}

fn parse(bytes: &[u8]) -> Result<(PointCloud, Vec<String>), String> {
    reported(bytes).map(|(cloud, report)| (cloud, report.warnings))
}

/// What a file says of itself: why it is refused, or the last warning.
fn cause(bytes: &[u8]) -> String {
    parse(bytes).map_or_else(|error| error, |(_, mut warnings)| warnings.pop().unwrap_or_default())
}

/// The points of a file that is read with one warning, which says this.
#[track_caller]
fn warned(bytes: &[u8], warning: &str) -> PointCloud {
    let (cloud, said) = parse(bytes).unwrap();
    assert!(matches!(&said[..], [said] if said.contains(warning)), "{said:?} / {warning}");
    assert!(!said[0].contains("fill whole buffer"));
    cloud
}

/// The points of a file that is read without a warning.
#[track_caller]
fn sound(bytes: &[u8]) -> PointCloud {
    let (cloud, warnings) = parse(bytes).unwrap();
    assert_eq!(warnings, Vec::<String>::new());
    cloud
}

/// A sound file and its points.
struct Sound {
    file: Vec<u8>,
    cloud: PointCloud,
}

impl Sound {
    #[track_caller]
    fn new(file: Vec<u8>) -> Self {
        let cloud = sound(&file);
        Self { file, cloud }
    }

    /// That its first so many points are read from another file, with these warnings.
    #[track_caller]
    fn first(&self, points: usize, file: &[u8], expected: &[&str]) {
        let (cloud, warnings) = parse(file).unwrap();
        assert_eq!((cloud.len(), warnings.len()), (points, expected.len()), "{warnings:?}");
        assert!(cloud.world_positions().eq(self.cloud.world_positions().take(points)), "other places");
        assert!(self.cloud.colours.starts_with(&cloud.colours));
        for (said, part) in warnings.iter().zip(expected) {
            assert!(said.starts_with("test") && said.contains(part), "{said} / {part}");
        }
    }

    /// That all points are read where some bytes are others, with these warnings.
    #[track_caller]
    fn all(&self, changes: &[(usize, &[u8])], expected: &[&str]) {
        self.first(self.cloud.len(), &with(&self.file, changes), expected);
    }
}

/// Files of 40 points: plain, and compressed one by one and in layers.
fn three() -> [Sound; 3] {
    [(2, false), (2, true), (7, true)].map(|(format, packed)| Sound::new(las(40, format, 3, packed)))
}

#[test]
fn counts_that_do_not_fit_are_told() {
    let [plain, packed, _] = three();
    // The two counts of version 1.4; without the second a file is as older ones are.
    let counts = |n: u32| with(&plain.file, &[(247, &[0; 8]), (107, &n.to_le_bytes())]);
    let said = "test, after point 40 of 90: the file ends here; 50 of 90 points could not be read";
    plain.first(40, &counts(90), &[said]);
    plain.first(40, &counts(0), &["promises 0 points, and it has room for 40: 40 are read"]);
    plain.first(30, &counts(30), &["promises 30 points, and it has room for 40: 30 are read"]);
    plain.all(&[(247, &[41])], &["promises 40 points, and 41: 40 are taken"]);
    let (cloud, warnings) = parse(&with(&packed.file, &[(247, &[0; 8]), (107, &[90])])).unwrap();
    assert!(cloud.len() >= 40 && warnings.len() == 1 && warnings[0].contains(" of 90"), "{warnings:?}");
    // What follows the points is none of them.
    let mut file = with(&counts(90), &[(235, &(plain.file.len() as u64).to_le_bytes()), (247, &[90])]);
    file.extend([7; 500]);
    plain.first(40, &file, &["after point 40 of 90"]);
}

#[test]
fn headers_that_contradict_the_file_are_told() {
    for sound in three() {
        let is_plain = sound.file[104] < 0x80;
        // The number of records before the points does not matter.
        sound.all(&[(100, &[9, 0, 0, 0])], &[]);
        sound.all(&[(100, &[0; 4])], &[]);
        sound.all(&[(94, &[0; 2])], &["cannot have 0 bytes: 375 are taken, as in version 1.4"]);
        sound.all(&[(96, &[7, 0, 0, 0])], &["its points cannot begin at byte 7"]);
        let end: (usize, &[u8]) = (96, &(sound.file.len() as u32 + 1).to_le_bytes());
        match is_plain {
            true => sound.all(&[end], &["its points cannot begin at byte"]),
            false => assert!(cause(&with(&sound.file, &[end])).contains("its points begin at byte")),
        }
        // Bytes behind those of the format are known from the length only.
        let said = if is_plain { "26 are taken" } else { "as they are compressed" };
        for size in [[0, 0], [19, 0]] {
            match is_plain {
                true => assert!(parse(&with(&sound.file, &[(105, &size)])).unwrap().1[0].contains(said)),
                false => sound.all(&[(105, &size)], &[said]),
            }
        }
    }
    let plain = Sound::new(las(40, 2, 0, false));
    for size in [0, 19, 25] {
        plain.all(&[(105, &[size, 0])], &["26 are taken"]);
    }
}

#[test]
fn versions_and_flags_that_contradict_the_points_are_no_reason_to_refuse() {
    for (format, packed) in [(0, false), (1, true), (2, false), (3, true), (5, false)] {
        let sound = Sound::new(las(40, format, 0, packed));
        for minor in 0..4 {
            // Standard times, made returns, a reference system of WKT.
            sound.all(&[(6, &[0x1f, 0]), (25, &[minor])], &[]);
        }
    }
}

#[test]
fn scales_that_are_none_keep_the_shape() {
    for sound in three() {
        for bad in [0.0, f64::NAN, f64::INFINITY] {
            let bad = bad.to_le_bytes();
            sound.all(&[(139, &bad)], &["the scale of y cannot be"]);
            let changes: [(usize, &[u8]); 4] = [(131, &bad), (139, &bad), (147, &bad), (155, &[0; 8])];
            let (cloud, warnings) = parse(&with(&sound.file, &changes)).unwrap();
            let size = |cloud: &PointCloud| {
                let all = || cloud.positions.iter().copied();
                (all().fold(Vec3::MIN, Vec3::max) - all().fold(Vec3::MAX, Vec3::min)).as_dvec3()
            };
            assert_eq!(warnings.len(), 3);
            assert!((size(&cloud) * 1e-3).distance(size(&sound.cloud)) < 0.01, "{}", size(&cloud));
        }
        sound.all(&[(163, &f64::NAN.to_le_bytes())], &["the offset of its points"]);
    }
}

#[test]
fn files_that_are_cut_are_read_as_far_as_they_go() {
    for format in [2, 3, 7] {
        let plain = las(500, format, 0, false);
        let packed = packed(&plain, format, Some(64), &[]);
        for file in [plain, packed] {
            let (sound, mut last) = (Sound::new(file), 0);
            let start = number(&sound.file, 96);
            for part in 1..20 {
                let cut = &sound.file[..start + (sound.file.len() - start) * part / 20];
                let Ok((cloud, warnings)) = parse(cut) else {
                    assert!(last == 0 && cause(cut).contains("after point 0 of 500"), "{}", cause(cut));
                    continue;
                };
                let read = cloud.len();
                let said = format!("after point {read} of 500: ");
                let rest = format!("; {} of 500 points could not be read", 500 - read);
                sound.first(read, cut, &[&*said][..usize::from(read < 500)]);
                assert!(read >= last && warnings.iter().all(|said| said.ends_with(&rest)), "{warnings:?}");
                last = read;
            }
            assert!(last > 300, "format {format}: {last}");
        }
    }
}

#[test]
fn chunks_of_different_sizes_are_read_as_in_copc_files() {
    let plain = las(500, 7, 0, false);
    for sizes in [&[70, 1, 50, 200][..], &[500], &[]] {
        assert_eq!(sound(&packed(&plain, 7, None, sizes)), sound(&plain), "{sizes:?}");
    }
}

#[test]
fn chunks_behind_one_that_is_broken_are_read() {
    // Layers say their lengths, so that damage is found.
    let sound = Sound::new(packed(&las(500, 7, 0, false), 7, Some(64), &[]));
    let number = |at: usize| number(&sound.file, at);
    let lengths = (0..sound.file.len() - 4).filter(|&at| at > number(96) && number(at) == 64);
    let second = lengths.filter(|at| (number(at + 4)..number(at + 4) + 200).contains(&number(at + 4))).nth(1);
    let file = with(&sound.file, &[(second.unwrap() + 4, &[0xff; 4])]);
    let (cloud, warnings) = parse(&file).unwrap();
    assert_eq!(cloud.len(), 500 - 64, "{warnings:?}");
    let expected = sound.cloud.world_positions().take(64).chain(sound.cloud.world_positions().skip(128));
    assert!(cloud.world_positions().eq(expected));
    let [said] = &warnings[..] else { panic!("{warnings:?}") };
    assert!(said.contains("after point 64 of 500") && said.contains("64 of 500 points could not"), "{said}");
}

#[test]
fn scans_are_read_up_to_a_page_that_is_broken() {
    let sound = Sound::new(e57(9000, true, None));
    let file = with(&sound.file, &[(150 * 1024 + 7, &[0x55; 8])]);
    let (cloud, warnings) = parse(&file).unwrap();
    let read = cloud.len();
    let place = format!("test, scan 0, point {read} of 9000: ");
    sound.first(read, &file, &[&place]);
    let rest = format!("; {} of 9000 points could not be read", 9000 - read);
    assert!(read > 500 && warnings[0].starts_with(&place) && warnings[0].ends_with(&rest), "{warnings:?}");
}

#[test]
fn an_ascii_file_is_read_as_its_header_says() {
    let (cloud, report) = reported(ASCII.as_bytes()).unwrap();
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
    assert_eq!((cloud.positions, cloud.origin), (vec![Vec3::new(-7.0, 0.5, 9.25)], DVec3::ZERO));
    assert_eq!(cloud.colours, [[128, 3, 4]]);
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

/// That points are where others are that were moved.
fn assert_near(cloud: &PointCloud, others: &PointCloud, moved: DVec3, most: f64) {
    assert_eq!(cloud.len(), others.len());
    let both = cloud.world_positions().zip(others.world_positions());
    let worst = both.map(|(a, b)| a.distance(b + moved)).fold(0.0, f64::max);
    assert!(worst < most, "{worst}");
}

#[test]
fn scans_are_read_to_their_resolution() {
    let expected = helix(300);
    // Half a step of each format, and its rounding. Colours of 8 bits and of 16 are the same.
    const STEPS: [f64; 2] = [6e-4, 5e-5];
    let kinds = [1, 256, 257].into_iter().flat_map(|scale| [(false, scale), (true, scale)]);
    let las = kinds.map(|(packed, scale)| (las_with_colours(300, 2, 0, packed, scale), 0.0, STEPS[0]));
    for (bytes, moved, resolution) in las.chain([(e57(300, true, Some(1.0)), 1.0, STEPS[1])]) {
        let (cloud, _) = parse(&bytes).unwrap();
        assert_near(&cloud, &expected, DVec3::X * moved, resolution * 3_f64.sqrt());
        assert!(cloud.colours == expected.colours || moved > 0.0 && cloud.colours.is_empty());
    }
}

#[test]
fn chunks_of_any_size_hold_the_same_points() {
    for bytes in [ply(&helix(50)), las(50, 2, 0, true), e57(50, true, None)] {
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
    expect(b"", "neither a PLY");
    expect(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "neither a PLY");
    expect(ASCII.replace("5000001", "five").as_bytes(), "line 22, vertex 1 of 3");
    expect(ASCII.replace("element vertex", "element point").as_bytes(), "no element vertex");
    expect(ASCII.replace("double z", "double w").as_bytes(), "vertex has no x, y and z");
    expect(&ASCII.as_bytes()[..ASCII.find("1 5 nan").unwrap()], "the file ends here");
    expect(ASCII.replace("vertex 3", "vertex 99999999999999").as_bytes(), "of 99999999999999");
    let whole = ply(&helix(9));
    expect(&whole[..whole.len() - 1], "vertex 8 of 9");
    expect(&las(9, 2, 0, false)[..400], "after point 0 of 9: the file ends here");
    expect(&las(9, 2, 0, true)[..500], "after point 0 of 9: the file ends here");
    expect(&las(9, 2, 0, false)[..100], "it ends after 100 bytes; a header has at least 227");
    assert!(matches!(read("/no/such/file".as_ref()), Err(FileError::Io { .. })));
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
    [" \t\n", "\r\n", "\r", "\n\n"].iter().for_each(|end| same(plain.replace('\n', end).as_bytes()));
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
fn gaussian_splats_have_the_colours_that_they_have_to_all_sides() {
    let splats = [XYZ, "property float f_dc_2\nproperty float f_dc_0\nproperty float f_dc_1\n"].concat();
    let points = "1 2 3 -1.7724539 0 1.7724539\n1 2 4 9 0.3544908 -9\n1 2 5 nan 0 0\n";
    let colours = sound(text_ply(&splats, points).as_bytes()).colours;
    assert_eq!(
        colours,
        [[128, 255, 0], [153, 0, 255], [128, 128, 0]],
        "black at -sqrt(pi), white at sqrt(pi)"
    );
}

#[test]
fn a_line_that_is_wrong_is_left_out_with_a_warning() {
    let plain = text_ply(XYZ, "-1 0 0\n0 1 0\n1 0 2.5\n");
    let wrong = plain.replace("0 1 0", "0 one 0");
    let two = warned(wrong.as_bytes(), "line 9, vertex 1 of 3: y is no number: one");
    assert_eq!(two.positions, [Vec3::NEG_X, Vec3::new(1.0, 0.0, 2.5)]);
    let said = cause(plain.replace("0 1 0", "0 1").as_bytes());
    assert_eq!(said, "test, line 9, vertex 1 of 3: z is missing; 1 of 3 points could not be read");
    assert!(cause(plain.replace("0 1 0", "\n \t\n0 one 0").as_bytes()).contains("line 11, vertex 1 of 3"));
    let strange = plain.replacen("element", "vendor stuff\nelement", 1);
    assert_eq!(warned(strange.as_bytes(), "line 3 is none of a PLY header: vendor stuff").len(), 3);
    let short = plain.replace("vertex 3", "vertex 5");
    assert_eq!(warned(short.as_bytes(), "vertex 3 of 5: the file ends here; 2 of 5").len(), 3);
    assert!(cause(plain.replace("0 1 0", &"x".repeat(30_000)).as_bytes()).len() < 200);
    // Points without a place are none that could not be read.
    let words = "1 nan 0\n1 -nan(ind) 0\n1 1.#QNAN 0\n1 inf 0\n1 -1.#INF 0\n1 2 3\n";
    let (cloud, report) = reported(text_ply(XYZ, words).as_bytes()).unwrap();
    assert_eq!((cloud.len(), report.skipped, report.warnings.len()), (1, 5, 0));
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
        // Bounds that are wrong.
        let bounds = [-234_935_841.0, -235_434_519.0, 8e8, 8e8, f64::NAN, 1e300_f64].map(f64::to_le_bytes);
        let file = with(&las(200, 2, 0, compressed), &[(179, bounds.as_flattened())]);
        assert_near(&sound(&file), &helix(200), DVec3::ZERO, 2e-3);
    }
}
