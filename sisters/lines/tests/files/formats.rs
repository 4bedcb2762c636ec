//! Writers of files, by the descriptions of their formats alone. Vertex number n of a file has
//! the value n / 2 with the name "fa", line number n the value 10 n with the name "bundle".

/// The vertices of each line.
pub type Lines = [Vec<[f32; 3]>];

fn vertices(lines: &Lines) -> Vec<[f32; 3]> {
    lines.concat()
}

fn of_vertices(lines: &Lines) -> Vec<f32> {
    (0..vertices(lines).len()).map(|n| n as f32 / 2.0).collect()
}

fn of_lines(lines: &Lines) -> Vec<f32> {
    (0..lines.len()).map(|n| n as f32 * 10.0).collect()
}

/// MRtrix tracks.
pub fn tck(lines: &Lines, double: bool, big: bool) -> Vec<u8> {
    let kind = format!("Float{}{}", if double { 64 } else { 32 }, if big { "BE" } else { "LE" });
    let mut bytes = format!("mrtrix tracks\ncount: 9\ndatatype: {kind}\nfile: . 67\nEND\n").into_bytes();
    bytes.resize(67, 0);
    let mut put = |value: f32| {
        let wide =
            if double { f64::from(value).to_le_bytes().to_vec() } else { value.to_le_bytes().to_vec() };
        if big { bytes.extend(wide.iter().rev()) } else { bytes.extend(wide) }
    };
    for line in lines {
        line.iter().flatten().for_each(|c| put(*c));
        [f32::NAN; 3].into_iter().for_each(&mut put);
    }
    [f32::INFINITY; 3].into_iter().for_each(&mut put);
    bytes
}

/// TrackVis tracks of an image of 50 x 60 x 70 voxels of 2 x 2 x 3 mm, with a matrix and an order
/// of voxels if they are given.
pub fn trk(lines: &Lines, big: bool, matrix: Option<([[f32; 4]; 4], &[u8; 3])>) -> Vec<u8> {
    let mut head = vec![0; 1000];
    let mut put = |at: usize, number: &[u8]| {
        let number: Vec<u8> = if big { number.iter().rev().copied().collect() } else { number.to_vec() };
        head[at..at + number.len()].copy_from_slice(&number);
    };
    for (i, size) in [50_i16, 60, 70].into_iter().enumerate() {
        put(6 + 2 * i, &size.to_le_bytes());
    }
    for (i, size) in [2.0_f32, 2.0, 3.0].into_iter().enumerate() {
        put(12 + 4 * i, &size.to_le_bytes());
    }
    put(36, &1_i16.to_le_bytes());
    put(238, &1_i16.to_le_bytes());
    put(988, &(lines.len() as i32).to_le_bytes());
    put(992, &2_i32.to_le_bytes());
    put(996, &1000_i32.to_le_bytes());
    for (i, value) in matrix.iter().flat_map(|m| m.0).flatten().enumerate() {
        put(440 + 4 * i, &value.to_le_bytes());
    }
    head[..5].copy_from_slice(b"TRACK");
    head[38..40].copy_from_slice(b"fa");
    head[240..246].copy_from_slice(b"bundle");
    if let Some((_, order)) = matrix {
        head[948..951].copy_from_slice(order);
    }
    let (values, mut number) = (of_vertices(lines), 0);
    let mut word = |bytes: [u8; 4]| {
        head.extend(if big { bytes.iter().rev().copied().collect() } else { bytes.to_vec() })
    };
    for (line, own) in lines.iter().zip(of_lines(lines)) {
        word((line.len() as i32).to_le_bytes());
        for point in line {
            point.iter().for_each(|c| word(c.to_le_bytes()));
            word(f32::to_le_bytes(values[number]));
            number += 1;
        }
        word(own.to_le_bytes());
    }
    head
}

/// VTK's legacy files: of version 5.1 or before, with words or bytes. A vertex cell stands before
/// the lines, with a value of its own.
pub fn vtk(lines: &Lines, ascii: bool, new: bool) -> Vec<u8> {
    let kind = if ascii { "ASCII" } else { "BINARY" };
    let version = if new { "5.1" } else { "3.0" };
    let mut file =
        format!("# vtk DataFile Version {version}\ntitle\n{kind}\nDATASET POLYDATA\n").into_bytes();
    let floats = |file: &mut Vec<u8>, all: &[f32]| match ascii {
        true => file.extend(all.iter().flat_map(|v| format!("{v} ").into_bytes()).chain(*b"\n")),
        false => file.extend(all.iter().flat_map(|v| v.to_be_bytes()).chain(*b"\n")),
    };
    let whole = |file: &mut Vec<u8>, all: &[i32], wide: bool| match (ascii, wide) {
        (true, _) => file.extend(all.iter().flat_map(|v| format!("{v} ").into_bytes()).chain(*b"\n")),
        (_, true) => file.extend(all.iter().flat_map(|v| i64::from(*v).to_be_bytes()).chain(*b"\n")),
        (_, false) => file.extend(all.iter().flat_map(|v| v.to_be_bytes()).chain(*b"\n")),
    };
    let points = vertices(lines);
    file.extend(format!("POINTS {} float\n", points.len()).into_bytes());
    floats(&mut file, points.as_flattened());
    // Old files have the counts among the numbers of points.
    let mut cells = |name: &str, ranges: &[std::ops::Range<i32>]| {
        let list: Vec<i32> = ranges.iter().cloned().flatten().collect();
        if new {
            file.extend(
                format!("{name} {} {}\nOFFSETS vtktypeint64\n", ranges.len() + 1, list.len()).into_bytes(),
            );
            let ends = ranges.iter().map(|r| r.end);
            whole(&mut file, &std::iter::once(0).chain(ends).collect::<Vec<_>>(), true);
            file.extend(b"CONNECTIVITY vtktypeint64\n");
            whole(&mut file, &list, true);
        } else {
            file.extend(format!("{name} {} {}\n", ranges.len(), list.len() + ranges.len()).into_bytes());
            let all = ranges.iter().flat_map(|r| std::iter::once(r.len() as i32).chain(r.clone()));
            whole(&mut file, &all.collect::<Vec<_>>(), false);
        }
    };
    let mut next = 0;
    let mut range = |l: &Vec<_>| {
        next += l.len() as i32;
        next - l.len() as i32..next
    };
    let ranges: Vec<_> = lines.iter().map(&mut range).collect();
    cells("VERTICES", std::slice::from_ref(&(0..1)));
    cells("LINES", &ranges);
    file.extend(
        format!("POINT_DATA {}\nSCALARS fa float 1\nLOOKUP_TABLE default\n", points.len()).into_bytes(),
    );
    floats(&mut file, &of_vertices(lines));
    file.extend(b"METADATA\nINFORMATION 0\n\n");
    file.extend(format!("CELL_DATA {}\nFIELD FieldData 1\nbundle 1 {0} int\n", lines.len() + 1).into_bytes());
    let values = std::iter::once(7.0).chain(of_lines(lines)).map(|v| v as i32);
    whole(&mut file, &values.collect::<Vec<_>>(), false);
    file
}
