//! Files as people have them: cut short, with headers that contradict the points. What can be read
//! is read, with a warning that is right.

use std::io::Cursor;

use casca_points::PointCloud;
use casca_points::files::{FileError, read_source};

mod files;

fn parse(bytes: &[u8]) -> Result<(PointCloud, Vec<String>), String> {
    let mut all = PointCloud::default();
    let each = |chunk: PointCloud| {
        all = chunk;
        Ok::<_, FileError>(())
    };
    let report = read_source(Cursor::new(bytes.to_vec()), "test".into(), usize::MAX, each);
    report.map(|report| (all, report.warnings)).map_err(|e| e.to_string())
}

/// That the first so many points of a sound file are read, with these warnings.
#[track_caller]
fn read_with(bytes: &[u8], whole: &PointCloud, points: usize, expected: &[&str]) {
    let (cloud, warnings) = parse(bytes).unwrap();
    assert_eq!(cloud.len(), points, "{warnings:?}");
    assert!(cloud.world_positions().eq(whole.world_positions().take(points)), "other places");
    assert!(whole.colours.starts_with(&cloud.colours));
    assert_eq!(warnings.len(), expected.len(), "{warnings:?}");
    for (said, part) in warnings.iter().zip(expected) {
        assert!(said.starts_with("test") && said.contains(part), "{said} / {part}");
    }
}

/// A sound file, its points, and what changes its bytes.
struct Sound {
    file: Vec<u8>,
    cloud: PointCloud,
}

impl Sound {
    #[track_caller]
    fn new(file: Vec<u8>) -> Self {
        let (cloud, warnings) = parse(&file).unwrap();
        assert_eq!(warnings, Vec::<String>::new());
        Self { file, cloud }
    }

    fn with(&self, changes: &[(usize, &[u8])]) -> Vec<u8> {
        let mut file = self.file.clone();
        changes.iter().for_each(|&(at, bytes)| file[at..at + bytes.len()].copy_from_slice(bytes));
        file
    }

    /// All points are read, with these warnings.
    #[track_caller]
    fn all(&self, changes: &[(usize, &[u8])], expected: &[&str]) {
        read_with(&self.with(changes), &self.cloud, self.cloud.len(), expected);
    }
}

/// Files of 40 points: plain, and compressed one by one and in layers.
fn sound() -> [Sound; 3] {
    [(2, false), (2, true), (7, true)].map(|(format, packed)| Sound::new(files::las(40, format, 3, packed)))
}

#[test]
fn counts_that_do_not_fit_are_told() {
    let [plain, packed, _] = sound();
    // The two counts of version 1.4; without the second a file is as older ones are.
    let none: (usize, &[u8]) = (247, &[0; 8]);
    let counts = |n: u32| n.to_le_bytes();
    read_with(
        &plain.with(&[none, (107, &counts(90))]),
        &plain.cloud,
        40,
        &["test, after point 40 of 90: the file ends here; 50 of 90 points could not be read"],
    );
    plain.all(&[none, (107, &counts(0))], &["promises 0 points, and it has room for 40: 40 are read"]);
    let fewer = plain.with(&[none, (107, &counts(30))]);
    read_with(&fewer, &plain.cloud, 30, &["promises 30 points, and it has room for 40: 30 are read"]);
    plain.all(&[(247, &counts(41))], &["promises 40 points, and 41: 40 are taken"]);
    let (cloud, warnings) = parse(&packed.with(&[none, (107, &counts(90))])).unwrap();
    assert!(cloud.len() >= 40 && warnings.len() == 1 && warnings[0].contains(" of 90"), "{warnings:?}");
    // What follows the points is none of them.
    let mut file = plain.with(&[
        (107, &counts(90)),
        (235, &(plain.file.len() as u64).to_le_bytes()),
        (247, &counts(90)),
    ]);
    file.extend([7; 500]);
    read_with(&file, &plain.cloud, 40, &["after point 40 of 90"]);
}

#[test]
fn headers_that_contradict_the_file_are_told() {
    for sound in sound() {
        let is_plain = sound.file[104] < 0x80;
        let records: u32 = if is_plain { 0 } else { 1 };
        let more = format!("promises 9 records before its points, and has {records}");
        sound.all(&[(100, &9_u32.to_le_bytes())], &[&more]);
        sound.all(&[(100, &0_u32.to_le_bytes())], &[]);
        sound.all(&[(94, &0_u16.to_le_bytes())], &["cannot have 0 bytes: 375 are taken, as in version 1.4"]);
        sound.all(&[(96, &7_u32.to_le_bytes())], &["its points cannot begin at byte 7"]);
        let end = (sound.file.len() as u32 + 1).to_le_bytes();
        match is_plain {
            true => sound.all(&[(96, &end)], &["its points cannot begin at byte"]),
            false => {
                assert!(parse(&sound.with(&[(96, &end)])).unwrap_err().contains("its points begin at byte"))
            }
        }
        let size = [sound.file[105], sound.file[106]];
        let said = format!("{} are taken", u16::from_le_bytes(size) - if is_plain { 3 } else { 0 });
        for size in [[0, 0], [19, 0]] {
            match is_plain {
                // Bytes behind those of the format are known from the length only.
                true => assert!(parse(&sound.with(&[(105, &size)])).unwrap().1[0].contains(&said)),
                false => sound.all(&[(105, &size)], &["as they are compressed"]),
            }
        }
    }
    let plain = Sound::new(files::las(40, 2, 0, false));
    for size in [0_u16, 19, 25] {
        plain.all(&[(105, &size.to_le_bytes())], &["26 are taken"]);
    }
}

#[test]
fn versions_and_flags_that_contradict_the_points_are_no_reason_to_refuse() {
    for (format, packed) in [(0, false), (1, true), (2, false), (3, true), (5, false)] {
        let sound = Sound::new(files::las(40, format, 0, packed));
        for minor in 0..4 {
            // Standard times, made returns, a reference system of WKT.
            let said = format!("its flags 0x1f are not those of version 1.{minor}");
            sound.all(&[(6, &[0x1f, 0]), (25, &[minor])], &[&said]);
            sound.all(&[(6, &[u8::from(minor > 1), 0]), (25, &[minor])], &[]);
        }
    }
}

#[test]
fn scales_that_are_none_keep_the_shape() {
    for sound in sound() {
        for bad in [0.0, f64::NAN, f64::INFINITY] {
            let bad = bad.to_le_bytes();
            sound.all(&[(139, &bad)], &["the scale of y cannot be"]);
            let file = sound.with(&[(131, &bad), (139, &bad), (147, &bad), (155, &[0; 8])]);
            let (cloud, warnings) = parse(&file).unwrap();
            let size = |cloud: &PointCloud| {
                let (low, high) = (cloud.positions.iter().copied())
                    .fold((glam::Vec3::INFINITY, glam::Vec3::NEG_INFINITY), |(low, high), p| {
                        (low.min(p), high.max(p))
                    });
                (high - low).as_dvec3()
            };
            // Also that the bounds are others.
            assert_eq!(warnings.len(), 4);
            assert!((size(&cloud) * 1e-3).distance(size(&sound.cloud)) < 0.01, "{}", size(&cloud));
        }
        let file = sound.with(&[(163, &f64::NAN.to_le_bytes())]);
        read_with(&file, &sound.cloud, 40, &["the offset of its points"]);
    }
}

#[test]
fn files_that_are_cut_are_read_as_far_as_they_go() {
    for format in [2, 3, 7] {
        let plain = files::las(500, format, 0, false);
        let packed = files::packed(&plain, format, 64);
        for file in [plain, packed] {
            let sound = Sound::new(file);
            let start = u32::from_le_bytes(std::array::from_fn(|i| sound.file[96 + i])) as usize;
            let mut last = 0;
            for part in 1..20 {
                let end = start + (sound.file.len() - start) * part / 20;
                match parse(&sound.file[..end]) {
                    Ok((cloud, warnings)) => {
                        let read = cloud.len();
                        let said = format!("after point {read} of 500: ");
                        let rest = format!("; {} of 500 points could not be read", 500 - read);
                        let all = read == 500;
                        let (expected, none) = ([&*said], []);
                        read_with(
                            &sound.file[..end],
                            &sound.cloud,
                            read,
                            if all { &none } else { &expected },
                        );
                        assert!(read >= last && (all || warnings[0].ends_with(&rest)), "{warnings:?}");
                        last = read;
                    }
                    Err(said) => assert!(last == 0 && said.contains("after point 0 of 500"), "{said}"),
                }
            }
            assert!(last > 300, "format {format}: {last}");
        }
    }
}

#[test]
fn chunks_behind_one_that_is_broken_are_read() {
    // Layers say their lengths, so that damage is found.
    let sound = Sound::new(files::packed(&files::las(500, 7, 0, false), 7, 64));
    let number = |at: usize| u32::from_le_bytes(std::array::from_fn(|i| sound.file[at + i])) as usize;
    let lengths = (0..sound.file.len() - 4).filter(|&at| at > number(96) && number(at) == 64);
    let second = lengths.filter(|at| (number(at + 4)..number(at + 4) + 200).contains(&number(at + 4))).nth(1);
    let file = sound.with(&[(second.unwrap() + 4, &[0xff; 4])]);
    let (cloud, warnings) = parse(&file).unwrap();
    assert_eq!(cloud.len(), 500 - 64, "{warnings:?}");
    let expected = sound.cloud.world_positions().take(64).chain(sound.cloud.world_positions().skip(128));
    assert!(cloud.world_positions().eq(expected));
    let [said] = &warnings[..] else { panic!("{warnings:?}") };
    assert!(said.contains("after point 64 of 500") && said.contains("64 of 500 points could not"), "{said}");
}

#[test]
fn scans_are_read_up_to_a_page_that_is_broken() {
    let sound = Sound::new(files::e57(9000, true));
    let file = sound.with(&[(150 * 1024 + 7, &[0x55; 8])]);
    let (cloud, warnings) = parse(&file).unwrap();
    assert!(cloud.world_positions().eq(sound.cloud.world_positions().take(cloud.len())) && cloud.len() > 500);
    let [said] = &warnings[..] else { panic!("{warnings:?}") };
    let rest = format!("; {} of 9000 points could not be read", 9000 - cloud.len());
    let place = format!("test, scan 0, point {} of 9000: ", cloud.len());
    assert!(said.starts_with(&place) && said.ends_with(&rest), "{said}");
}
