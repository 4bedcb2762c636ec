//! Files as people have them: other line ends and encodings, numbers that are none, headers that do
//! not fit, and what is said of those that cannot be read.

use super::*;

const LINE: [[f32; 3]; 3] = [[1.0, 2.0, 3.0], [40.0, 5.0, 6.0], [7.5, 80.0, 90.0]];

fn lines() -> [Vec<[f32; 3]>; 2] {
    [LINE.to_vec(), vec![[9.0; 3], [2.0; 3]]]
}

fn said(bytes: &[u8], format: Format) -> String {
    read(bytes, format).unwrap_err().to_string()
}

/// Bytes with a text in them replaced once.
fn changed(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    let at = bytes.windows(from.len()).position(|w| w == from.as_bytes()).unwrap();
    [&bytes[..at], to.as_bytes(), &bytes[at + from.len()..]].concat()
}

#[test]
fn headers_of_tracks_must_end_and_name_what_follows() {
    // No END, and numbers right behind the header.
    let without =
        b"mrtrix tracks\ncount: 0\ndatatype: Float32LE\nfile: . 67\n\0\x7f\xc0\0\0\x7f\xc0\0\0\x7f\xc0\0";
    assert!(said(without, Format::Tck).starts_with("line 5: the header does not end: a line END must stand"));
    let whole = formats::tck(&lines(), false, false);
    assert!(said(&changed(&whole, "END", "BND"), Format::Tck).contains("a line END must stand"));
    assert!(said(b"mrtrix tracks\n", Format::Tck).contains("line 1: the header does not end"));
    assert!(said(b"mrtrix tracks\nEND\n", Format::Tck).contains("lacks \"file: . OFFSET\""));
    let early = changed(&whole, "file: . 67", "file: . 20");
    assert_eq!(said(&early, Format::Tck), "line 4: \"file: . 20\" names a byte of the header, which has 57");
    let other = changed(&whole, "Float32LE", "float32le");
    assert_eq!(read(&other, Format::Tck).unwrap(), read(&whole, Format::Tck).unwrap());
    let words = [&whole[..67], b"1 2 3\n4 5 6\nnan nan nan\n".as_slice()].concat();
    let parts = [whole.len() - 1, whole.len() - 12, whole.len() - 17, 79].map(|cut| &whole[..cut]);
    for file in parts.into_iter().chain([&*changed(&whole, "Float32LE", "Float32BE"), &words]) {
        assert!(said(file, Format::Tck).contains("without three infinite numbers"));
    }
}

#[test]
fn lines_may_end_with_carriage_returns_and_blanks() {
    let vec = |l: &Vec<[f32; 3]>| l.iter().map(|p| Vec3::from(*p)).collect::<Vec<_>>();
    let points: Vec<Vec<Vec3>> = lines().iter().map(vec).collect();
    let wanted = LineSet::new(points.clone()).unwrap();
    let ascii = |end: &str, bytes: &[u8]| str::from_utf8(bytes).unwrap().replace('\n', end).into_bytes();
    for end in ["\r", "\r\n", " \n", "\t \r\n", " \r"] {
        for format in [Format::Obj, Format::Ply] {
            let found = read(&ascii(end, &written(&points, format)), format).unwrap();
            assert_eq!(found.points(), wanted.points(), "{format:?} {end:?}");
            assert!(found.segments().eq(wanted.segments()), "{format:?} {end:?}");
        }
        for new in [false, true] {
            let found = read(&ascii(end, &formats::vtk(&lines(), true, new)), Format::Vtk).unwrap();
            assert_eq!((found.points(), found.attributes().scalars.len()), (wanted.points(), 2), "{end:?}");
        }
    }
    // Before binary numbers, of which the first byte is a line feed.
    let first = f32::from_le_bytes([b'\n', 0, 0, 0x40]);
    let head = "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\n\
        property float z\nelement edge 1\nproperty uchar vertex1\nproperty uchar vertex2\nend_header\n";
    let body = [first, 1.0, 2.0, 3.0, 4.0, 5.0].map(f32::to_le_bytes).concat();
    for end in ["\n", "\r\n", "\r"] {
        let file = [head.replace('\n', end).as_bytes(), &body, &[0, 1]].concat();
        assert_eq!(read(&file, Format::Ply).unwrap().points()[0], Vec3::new(first, 1.0, 2.0), "{end:?}");
        let head = "# vtk DataFile Version 3.0\ntitle\nBINARY\nDATASET POLYDATA\nPOINTS 2 float\n"
            .replace('\n', end);
        let body =
            [f32::from_be_bytes([b'\n', 0, 0, 0]), 1.0, 2.0, 3.0, 4.0, 5.0].map(f32::to_be_bytes).concat();
        let cells = [2i32, 0, 1].map(i32::to_be_bytes).concat();
        let file = [head.as_bytes(), &body, format!("{end}LINES 1 3{end}").as_bytes(), &cells].concat();
        assert_eq!(read(&file, Format::Vtk).unwrap().points()[1], Vec3::new(3.0, 4.0, 5.0), "{end:?}");
        let tracks = formats::tck(&lines(), false, false);
        let (head, body) = tracks.split_at(67);
        let head = str::from_utf8(head).unwrap().trim_end_matches('\0').replace('\n', end) + "\0\0\0\0\0\0";
        let file =
            [changed(head.as_bytes(), ". 67", &format!(". {:02}", head.len())), body.to_vec()].concat();
        assert_eq!(read(&file, Format::Tck).unwrap().points(), wanted.points(), "{end:?}");
    }
    assert!(said(b"v 1 2 3\rv 1 2\r", Format::Obj).starts_with("line 2: "));
}

#[test]
fn numbers_that_are_none_are_read_as_programs_write_them() {
    let spellings = ["nan", "-NaN", "-nan(ind)", "nan(0x8000)", "1.#QNAN", "-1.#IND00", "1.#SNAN"];
    for word in spellings {
        let vtk = format!(
            "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n0 0 0 1 1 1\nLINES 1 3\n2 0 1\n\
             POINT_DATA 2\nSCALARS a float 1\nLOOKUP_TABLE default\n{word} 2\n"
        );
        let values = read(vtk.as_bytes(), Format::Vtk).unwrap().attributes().scalars[0].values.clone();
        assert!(values[0].is_nan() && values[1] == 2.0, "{word}");
        let ply = format!(
            "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n\
             property float nx\nelement edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n\
             0 0 0 {word}\n1 1 1 {word}\n0 1\n"
        );
        assert_eq!(read(ply.as_bytes(), Format::Ply).unwrap().len(), 1, "{word}");
        // A vertex that no line has may be none.
        let obj = format!("v {word} 0 0\nv 0 0 0\nv 1 0 0\nl 2 3\n");
        assert_eq!(read(obj.as_bytes(), Format::Obj).unwrap().points().len(), 2, "{word}");
        let obj = format!("v {word} 0 0\nv 0 0 0\nl 1 2\n");
        assert_eq!(said(obj.as_bytes(), Format::Obj), "vertex 0 of line 0 is not finite");
    }
    let infinite = "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n-1.#INF 0 0\nLINES 1 2\n1 0\n";
    assert_eq!(said(infinite.as_bytes(), Format::Vtk), "vertex 0 of line 0 is not finite");
    assert!(said(b"v 0,5 1,5 2\n", Format::Obj).contains("\"0,5\" is not a coordinate"));
}

#[test]
fn letters_of_other_encodings_stand_in_comments_titles_and_names() {
    let latin = |text: &str| text.chars().map(|c| c as u8).collect::<Vec<u8>>();
    let ply = "ply\nformat ascii 1.0\ncomment S\u{e4}ge \ncomment \nelement vertex 2  \nproperty float x\nproperty float y\n\
        property float z\nelement edge 1\nproperty int vertex1\nproperty int vertex2\nend_header \n0 0 0\n1 1 1\n0 1\n";
    assert_eq!(read(&latin(ply), Format::Ply).unwrap().len(), 1);
    let long = ply.replace("comment \n", &format!("comment {}\n", "x".repeat(3000)));
    assert_eq!(read(&latin(&long), Format::Ply).unwrap().len(), 1, "a comment may be long");
    assert_eq!(
        read(&latin("# S\u{e4}ge\no \u{fc}\nv 0 0 0\nv 1 0 0\nl 1 2\n"), Format::Obj).unwrap().len(),
        1
    );
    let vtk = String::from_utf8(formats::vtk(&lines(), true, false)).unwrap();
    assert_eq!(read(&latin(&vtk.replace("title", "S\u{e4}ge")), Format::Vtk).unwrap().len(), 2);
    let tck = formats::tck(&lines(), false, false);
    let tck = [latin("mrtrix tracks\nname: \u{e4}\n"), changed(&tck[14..], ". 67", ". 75")].concat();
    assert_eq!(read(&tck, Format::Tck).unwrap().len(), 2);
}

#[test]
fn text_and_other_orders_of_bytes_where_binary_numbers_should_be_are_refused() {
    let vtk = String::from_utf8(formats::vtk(&lines(), true, false)).unwrap();
    said(vtk.replace("ASCII", "BINARY").as_bytes(), Format::Vtk);
    let vtk = formats::vtk(&lines(), false, false);
    assert!(said(&changed(&vtk, "BINARY", "ASCII"), Format::Vtk).contains("is not a number"));
    // Points in the wrong order, too, but only counts can tell.
    let mut turned = vtk.clone();
    let at = vtk.windows(10).position(|w| w == b"LINES 2 7\n").unwrap() + 10;
    turned[at..at + 28].as_chunks_mut::<4>().0.iter_mut().for_each(|number| number.reverse());
    assert!(said(&turned, Format::Vtk).contains("is longer than the list"));
    let head = |order: &str| {
        format!(
            "ply\nformat {order} 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n\
             element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n"
        )
    };
    let numbers = [0.5f32, 1.0, 2.0, 3.0, 4.0, 5.0].map(f32::to_le_bytes).concat();
    let body = [numbers, [0i32, 1].map(i32::to_le_bytes).concat()].concat();
    let file = |order: &str| [head(order).into_bytes(), body.clone()].concat();
    assert!(read(&file("binary_little_endian"), Format::Ply).is_ok());
    assert!(said(&file("binary_big_endian"), Format::Ply).contains("a line names vertex"));
    assert!(said(&file("ascii"), Format::Ply).contains("is not a number"));
    let words = [head("binary_little_endian").as_bytes(), b"0.5 1 2\n3 4 5\n0 1\n"].concat();
    said(&words, Format::Ply);
    let unended = head("ascii").replace("end_header\n", "0 0 0\n");
    assert!(said(unended.as_bytes(), Format::Ply).contains("statement that PLY does not have"));
    assert!(said(b"ply\nformat ascii 1.0\n", Format::Ply).contains("a line end_header must stand"));
    let trk = formats::trk(&lines(), false, None);
    assert!(said(&trk[..trk.len() - 5], Format::Trk).contains("cut short"));
}
