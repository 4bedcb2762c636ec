//! Numbers, matrices and colours of files.

use glam::{DAffine3, DMat3, DVec3};

use super::*;

const LINE: [[f32; 3]; 3] = [[1.0, 2.0, 3.0], [40.0, 5.0, 6.0], [7.5, 80.0, 90.0]];

/// The places of [`LINE`] in the scanner, from the voxels that the orders name.
fn in_scanner(matrix: [[f32; 4]; 4], order: &[u8; 3]) -> Vec<Vec3> {
    let file = formats::trk(&[LINE.to_vec()], false, Some((matrix, order)));
    read(&file, Format::Trk).unwrap().points().to_vec()
}

#[test]
fn tracks_are_moved_to_the_scanner_by_matrix_voxel_size_and_order() {
    // Nearly RAS, sheared and turned by a little.
    let rows = [[2.0, 0.1, 0.0, -50.0], [-0.1, 2.0, 0.2, 9.0], [0.0, -0.1, 3.0, 4.0], [0.0, 0.0, 0.0, 1.0]];
    let row = |i: usize| DVec3::from([rows[i][0], rows[i][1], rows[i][2]].map(f64::from));
    let shift = DVec3::new(-50.0, 9.0, 4.0);
    let matrix = DAffine3::from_mat3_translation(DMat3::from_cols(row(0), row(1), row(2)).transpose(), shift);
    // Half a voxel from its corner lies its middle, the place of whole numbers.
    let voxel = |p: [f32; 3]| [p[0] / 2.0 - 0.5, p[1] / 2.0 - 0.5, p[2] / 3.0 - 0.5].map(f64::from);
    type Order = fn([f64; 3]) -> [f64; 3];
    let orders: [(&[u8; 3], Order); 4] = [
        (b"RAS", |v| v),
        (b"LPS", |[x, y, z]| [49.0 - x, 59.0 - y, z]),
        (b"LAI", |[x, y, z]| [49.0 - x, y, 69.0 - z]),
        // The first axis of the image runs towards the feet.
        (b"IRA", |[x, y, z]| [y, z, 49.0 - x]),
    ];
    for (order, voxels) in orders {
        for (got, from) in in_scanner(rows, order).iter().zip(LINE) {
            let wanted = matrix.transform_point3(voxels(voxel(from)).into());
            assert!(got.as_dvec3().distance(wanted) < 1e-4, "{order:?}: {got} is not {wanted}");
        }
    }
    // The same axes backwards in matrix and order: no swap.
    let back = rows.map(|r| [-r[0], r[1], r[2], r[3]]);
    assert_eq!(in_scanner(back, b"LAS")[0].y, (matrix.matrix3 * DVec3::new(0.0, 0.5, 0.5) + shift).y as f32);
    for (at, bytes, said) in [
        (948, &b"RRS"[..], "three axes"),
        (12, &[0; 4], "voxel sizes"),
        (440, &[0; 12], "singular"),
        (440, &[255; 4], "not finite"),
    ] {
        let mut file = formats::trk(&[LINE.to_vec()], false, Some((rows, b"RAS")));
        file[at..at + bytes.len()].copy_from_slice(bytes);
        let why = read(&file, Format::Trk).unwrap_err().to_string();
        assert!(why.contains(&format!("byte {at}")) && why.contains(said), "{why}");
    }
}

#[test]
fn columns_of_one_name_are_read() {
    let mut file = formats::trk(&[vec![]], false, None);
    // Three values of a line: two by one name.
    file[238] = 3;
    file[240..248].copy_from_slice(b"uv\x002\0\0\0\0");
    file.extend([0; 8]);
    let lines = read(&file, Format::Trk).unwrap();
    let names: Vec<&str> = lines.attributes().scalars.iter().map(|s| &*s.name).collect();
    assert_eq!(names, ["fa", "uv.0", "uv.1", "property 2"]);
}

#[test]
fn lines_of_vtk_share_points_and_colours_of_lines_go_to_their_vertices() {
    let file = "# vtk DataFile Version 4.0\n\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\n\
        LINES 2 7\n3 0 1 2\n2 2 0\nPOINT_DATA 3\nVECTORS v%20w float\n1 2 3 4 5 6 7 8 9\n\
        CELL_DATA 2\nCOLOR_SCALARS tint 3\n1 0 0 0 0.2 1\n";
    let lines = read(file.as_bytes(), Format::Vtk).unwrap();
    let attributes = lines.attributes();
    assert_eq!(lines.points(), [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Y, Vec3::ZERO]);
    assert_eq!((&*attributes.scalars[1].name, attributes.scalars.len()), ("v w.1", 3));
    assert_eq!(attributes.scalars[1].values, [2.0, 5.0, 8.0, 8.0, 2.0]);
    let (red, blue) = ([255, 0, 0], [0, 51, 255]);
    assert_eq!(attributes.colours.as_deref().unwrap(), [red, red, red, blue, blue]);
    let wrong = file.replace("POINT_DATA 3", "POINT_DATA 2");
    assert!(read(wrong.as_bytes(), Format::Vtk).is_err());
}

#[test]
fn what_is_not_read_is_said_in_words() {
    for (format, text, said) in [
        (Format::Tck, "tracks", "byte 0: a TCK file starts"),
        (Format::Tck, "mrtrix tracks\ndatatype: Bit\n", "line 2: data of Bit"),
        (Format::Tck, "mrtrix track scalars\n", "the scalars of another file"),
        (Format::Vtk, "<VTKFile", "one of XML must be saved as legacy VTK"),
        (
            Format::Vtk,
            "# vtk DataFile Version 3.0\n\nASCII\nDATASET UNSTRUCTURED_GRID",
            "only POLYDATA is read",
        ),
        (
            Format::Vtk,
            "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 1 string\n",
            "type \"string\" are not read",
        ),
        (
            Format::Vtk,
            "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOLYGONS 1 4\n3 0 0 0\n",
            "1 polygons and no lines: only lines are read",
        ),
        (
            Format::Vtk,
            "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 1 int\n1 2 3 LINES 1 2\n1 1\n",
            "a line names point 1 of 1",
        ),
        (
            Format::Vtk,
            "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nCURVES 1 2\n",
            "\"CURVES\" is not read",
        ),
    ] {
        let why = read(text.as_bytes(), format).unwrap_err().to_string();
        assert!(why.contains(said), "{text}: {why}");
    }
}
