//! Small valid files of each format, for tests of damaged ones and for the fuzz target `readers`.

// Each test and the fuzz target use a part of it.
#![allow(dead_code)]

use casca_lines::sets::files::Format;

/// All formats.
pub const FORMATS: [Format; 5] = [Format::Text, Format::Obj, Format::Ply, Format::Tck, Format::Trk];

const TEXT: &str = "2\n3 1\n0 0 0\n1 0 0\n1 4 0.5\n7 7 7\n";
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

fn tck() -> Vec<u8> {
    let mut bytes = b"mrtrix tracks\ndatatype: Float32LE\nfile: . 67\ncount: 2\nEND\n".to_vec();
    bytes.resize(67, 0);
    let (nan, end) = ([f32::NAN; 3], [f32::INFINITY; 3]);
    bytes.extend(floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]));
    bytes.extend(floats(&nan));
    bytes.extend(floats(&[7.0, 7.0, 7.0]));
    bytes.extend(floats(&nan));
    bytes.extend(floats(&end));
    bytes
}

fn trk() -> Vec<u8> {
    let mut bytes = vec![0; 1000];
    bytes[..5].copy_from_slice(b"TRACK");
    // One scalar a vertex, one property a line, two lines.
    bytes[36] = 1;
    bytes[238] = 1;
    bytes[988] = 2;
    bytes[996..].copy_from_slice(&1000_i32.to_le_bytes());
    for count in [3, 1] {
        bytes.extend(i32::to_le_bytes(count));
        bytes.extend(floats(&vec![0.5; 4 * count as usize + 1]));
    }
    bytes
}

/// Files with their formats.
pub fn all() -> Vec<(Format, Vec<u8>)> {
    vec![
        (Format::Text, TEXT.into()),
        (Format::Obj, OBJ.into()),
        (Format::Ply, PLY.into()),
        (Format::Ply, binary_ply()),
        (Format::Tck, tck()),
        (Format::Trk, trk()),
    ]
}
