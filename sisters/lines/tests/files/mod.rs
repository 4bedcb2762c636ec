//! Small valid files of each format, for tests of damaged ones and for the fuzz target `readers`.

// Each test and the fuzz target use a part of it.
#![allow(dead_code)]

use casca_lines::sets::files::Format;

mod formats;

/// All formats.
pub const FORMATS: [Format; 5] = [Format::Obj, Format::Ply, Format::Tck, Format::Trk, Format::Vtk];

const OBJ: &str = "# lines\nv 0 0 0\nv 1 0 0\nv 1 4 0.5\nvn 0 0 1\nl 1 2 3\nl -1 -2\n";
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement edge 2\n\
    property int vertex1\nproperty int vertex2\nelement polyline 1\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0\n1 0 0\n1 4 0.5\n0 1\n1 2\n3 2 1 0\n";

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn binary_ply() -> Vec<u8> {
    let mut bytes =
        PLY.split("0 0 0\n").next().unwrap_or(PLY).replace("ascii", "binary_little_endian").into_bytes();
    bytes.extend(floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 4.0, 0.5]));
    bytes.extend([0_i32, 1, 1, 2].iter().flat_map(|v| v.to_le_bytes()));
    bytes.push(3);
    bytes.extend([2_i32, 1, 0].iter().flat_map(|v| v.to_le_bytes()));
    bytes
}

/// Files with their formats.
pub fn all() -> Vec<(Format, Vec<u8>)> {
    let lines = [vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 4.0, 0.5]], vec![[7.0; 3]]];
    let matrix = [[-2.0, 0.1, 0.0, 9.0], [0.0, 2.0, 0.0, -5.0], [0.0, 0.2, 3.0, 1.0], [0.0, 0.0, 0.0, 1.0]];
    let mut all = vec![(Format::Obj, OBJ.into()), (Format::Ply, PLY.into())];
    all.push((Format::Ply, binary_ply()));
    for (a, b) in [(false, false), (false, true), (true, false), (true, true)] {
        all.push((Format::Tck, formats::tck(&lines, a, b)));
        all.push((Format::Trk, formats::trk(&lines, a, b.then_some((matrix, b"RPI")))));
        all.push((Format::Vtk, formats::vtk(&lines, a, b)));
    }
    all
}
