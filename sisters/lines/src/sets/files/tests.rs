use std::fmt::Write;

use casca_truth::cases;
use glam::Vec3;
use proptest::prelude::*;

use super::*;
use crate::sets::attributes::Of;

#[path = "../../../tests/files/formats.rs"]
mod formats;
mod people;
mod tractograms;

/// Files of lines in all formats, and whether they have the numbers of [`formats`].
fn all_written(lines: &[Vec<Vec3>]) -> Vec<(Format, Vec<u8>, bool)> {
    let plain = [Format::Obj, Format::Ply].map(|f| (f, written(lines, f), false));
    let lines: Vec<Vec<[f32; 3]>> = lines.iter().map(|l| l.iter().map(Vec3::to_array).collect()).collect();
    let mut all = plain.to_vec();
    for (a, b) in [(false, false), (false, true), (true, false), (true, true)] {
        all.push((Format::Tck, formats::tck(&lines, a, b), false));
        all.push((Format::Trk, formats::trk(&lines, a, None), true));
        all.push((Format::Vtk, formats::vtk(&lines, a, b), true));
    }
    all
}

/// A file of lines in a format.
fn written(lines: &[Vec<Vec3>], format: Format) -> Vec<u8> {
    let coordinates = |p: &Vec3| format!("{} {} {}", p.x, p.y, p.z);
    let points: Vec<Vec3> = lines.concat();
    let mut text = String::new();
    match format {
        Format::Obj => {
            text += "# hair\no strand\n";
            for line in lines {
                line.iter().for_each(|p| text += &format!("v {}\n", coordinates(p)));
                let numbers: Vec<String> =
                    (0..line.len()).map(|i| format!("{}", i as i64 - line.len() as i64)).collect();
                text += &format!("l {}\n", numbers.join(" "));
            }
        }
        Format::Ply => {
            let head = "property float x\nproperty float y\nproperty float z\nelement polyline";
            let _ = write!(
                text,
                "ply\nformat ascii 1.0\nelement vertex {}\n{head} {}\n",
                points.len(),
                lines.len()
            );
            text += "property list int uint vertex_indices\nend_header\n";
            points.iter().for_each(|p| text += &format!("{}\n", coordinates(p)));
            let mut next = 0..;
            for line in lines {
                let numbers: Vec<String> = next.by_ref().take(line.len()).map(|i| i.to_string()).collect();
                text += &format!("{} {}\n", line.len(), numbers.join(" "));
            }
        }
        _ => unreachable!("the others have writers of their own"),
    }
    text.into_bytes()
}

fn some_lines() -> impl Strategy<Value = Vec<Vec<Vec3>>> {
    let number = (-1_000_000i32..1_000_000).prop_map(|n| n as f32 / 512.0);
    let point = (number.clone(), number.clone(), number).prop_map(|(x, y, z)| Vec3::new(x, y, z));
    proptest::collection::vec(proptest::collection::vec(point, 1..6), 0..5)
}

proptest! {
    #![proptest_config(cases(64))]

    #[test]
    fn lines_are_read_as_they_were_written(lines in some_lines()) {
        let wanted = LineSet::new(lines.clone()).unwrap();
        let halves: Vec<f32> = (0..wanted.points().len()).map(|n| n as f32 / 2.0).collect();
        let tens: Vec<f32> = (0..wanted.len()).map(|n| n as f32 * 10.0).collect();
        for (format, file, numbers) in all_written(&lines) {
            let read = read(&file, format).unwrap();
            prop_assert_eq!(read.points(), wanted.points(), "{:?}", format);
            prop_assert!(read.segments().eq(wanted.segments()) && read.len() == wanted.len());
            if numbers {
                let [fa, bundle] = &read.attributes().scalars[..] else { panic!("{format:?}: two numbers") };
                prop_assert_eq!((&*fa.name, fa.of, &fa.values), ("fa", Of::Vertices, &halves));
                prop_assert_eq!((&*bundle.name, bundle.of, &bundle.values), ("bundle", Of::Lines, &tens));
            }
        }
    }

}

#[test]
fn text_with_a_byte_order_mark_is_read() {
    let lines = [vec![Vec3::X, Vec3::Y], vec![Vec3::Z, Vec3::ONE, Vec3::ZERO]];
    let mut text = all_written(&lines);
    // The first word of this file counts.
    text.push((
        Format::Obj,
        b"v 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 1\nv 0 0 0\nl 1 2\nl 3 4 5\n".to_vec(),
        false,
    ));
    let kinds = [Format::Obj, Format::Ply, Format::Vtk];
    for (format, file, _) in text.into_iter().filter(|(format, ..)| kinds.contains(format)) {
        let marked = [b"\xef\xbb\xbf", &*file].concat();
        let (marked, plain) = (read(&marked, format).unwrap(), read(&file, format).unwrap());
        assert_eq!((marked.len(), &marked), (2, &plain), "{format:?}");
    }
}

#[test]
fn errors_name_place_and_cause() {
    let fail = |bytes: &[u8], format| read(bytes, format).unwrap_err().to_string();
    for (format, text, said) in [
        (Format::Obj, "v 0 0 0\nv 0 x 0\n", "line 2: \"x\" is not a coordinate"),
        (Format::Obj, "v 1 nan 1\nl 1", "vertex 0 of line 0 is not finite"),
        (Format::Obj, "v 1 2\n", "line 1: a vertex of less than 3 numbers"),
        (Format::Obj, "v 1 2 3\n\nl 1 2", "line 3: there is no vertex 2"),
        (Format::Ply, "plx\n", "line 1: a PLY file starts with \"ply\""),
        (Format::Ply, "ply\nend_header\n", "line 2: the header has no format"),
        (
            Format::Ply,
            "ply\nformat ascii 1.0\nelement vertex 99999999999\nend_header\n",
            "line 5: the element vertex has no properties",
        ),
        (
            Format::Ply,
            "ply\nformat binary_little_endian 1.0\nelement edge 1\nproperty list uint int v\nend_header\n\u{7f}\u{7f}\u{7f}\u{7f}",
            "the file ends",
        ),
        (Format::Trk, "TRACK", "byte 5: the file ends before byte 996"),
    ] {
        let why = fail(text.as_bytes(), format);
        assert!(why.contains(said), "{text}: {why}");
    }
    let ply = |list: &str, row: &str| {
        let vertices = "element vertex 2\nproperty float x\nproperty float y\nproperty float z";
        format!(
            "ply\nformat ascii 1.0\n{vertices}\nelement line 1\n{list}\nend_header\n0 0 0\n1 1 1\n{row}\n"
        )
    };
    let (pair, list) =
        ("property float vertex1\nproperty float vertex2", "property list float double vertex_index");
    for (head, row, said) in [
        (pair, "0 -1", "line 13: -1 cannot be the number of a vertex"),
        (pair, "nan 1", "line 13: NaN cannot be"),
        (pair, "0 2", "a line names vertex 2 of 2"),
        (list, "2 0 1.7", "line 12: 1.7 cannot be the number of a vertex"),
        (list, "1 4294967296", "line 12: 4294967296 cannot be"),
        (list, "-2 0 1", "line 12: -2 cannot be the length of a list"),
        (
            "property list int int near",
            "1 0",
            "the element line has neither a list vertex_indices nor vertex1",
        ),
        ("property float vertex1", "1", "the element line has neither"),
    ] {
        let why = fail(ply(head, row).as_bytes(), Format::Ply);
        assert!(why.contains(said), "{row}: {why}");
    }
    let two = format!("{list}\nproperty list int int near");
    let lines = read(ply(&two, "2 1 0 3 0 0 0").as_bytes(), Format::Ply).unwrap();
    assert_eq!(lines, LineSet::new([[Vec3::ONE, Vec3::ZERO]]).unwrap(), "only the list of that name counts");
    let mut long = formats::trk(&[vec![[1.0; 3]]], false, None);
    long[1000..1004].copy_from_slice(&i32::MAX.to_le_bytes());
    assert!(
        fail(&long, Format::Trk).contains("byte 1000: a line of 2147483647 vertices is longer than the file")
    );
    for (damaged, said) in [
        (Vec3::new(1.0, f32::NAN, 2.0), "vertex [1, NaN, 2] of a line"),
        (Vec3::new(f32::NAN, f32::INFINITY, f32::NAN), "byte 79: vertex [NaN, inf, NaN]"),
        (Vec3::INFINITY, "byte 79: vertex [inf, inf, inf]"),
    ] {
        let why =
            fail(&formats::tck(&[vec![[1.0; 3], damaged.to_array(), [0.0; 3]]], false, false), Format::Tck);
        assert!(why.contains(said), "{why}");
    }
    let path = std::env::temp_dir().join(format!("casca-lines-files-{}.obj", std::process::id()));
    for (text, said) in [("v x 1 1", "line 1: \"x\" is not"), ("v 1 nan 1\nl 1", "vertex 0 of line 0 is not")]
    {
        std::fs::write(&path, text).unwrap();
        let why = open(&path).unwrap_err().to_string();
        assert!(why.starts_with(&format!("{}: {said}", path.display())), "{why}");
    }
    std::fs::remove_file(&path).unwrap();
    assert!(matches!(open(Path::new("nothing.obj")), Err(FileError::Io { .. })));
    assert!(open(Path::new("hair.doc")).unwrap_err().to_string().contains(".tck, .trk or .vtk"));
}

#[test]
fn edges_that_follow_each_other_make_one_line_in_both_byte_orders() {
    let points = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE];
    let edges = [[0, 1], [1, 2], [3, 0]];
    for big in [false, true] {
        let order = if big { "big" } else { "little" };
        let mut bytes = format!(
            "ply\nformat binary_{order}_endian 1.0\ncomment c\nelement vertex 4\nproperty double x\nproperty float y\n\
             property float z\nproperty uchar red\nelement edge 3\nproperty ushort vertex1\nproperty int vertex2\nend_header\n"
        )
        .into_bytes();
        let mut put = |le: &[u8]| if big { bytes.extend(le.iter().rev()) } else { bytes.extend(le) };
        for p in points {
            put(&f64::from(p.x).to_le_bytes());
            [p.y, p.z].iter().for_each(|c| put(&c.to_le_bytes()));
            put(&[7]);
        }
        for [a, b] in edges {
            put(&(a as u16).to_le_bytes());
            put(&i32::to_le_bytes(b));
        }
        let lines = read(&bytes, Format::Ply).unwrap();
        let wanted = [vec![Vec3::X, Vec3::Y, Vec3::Z], vec![Vec3::ONE, Vec3::X]];
        assert_eq!(lines, LineSet::new(wanted).unwrap());
    }
}
