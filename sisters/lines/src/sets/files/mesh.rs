//! Triangle meshes from OBJ and PLY.

use std::path::Path;

use super::bytes::unmarked;
use super::error::{FileError, refused};
use super::{Format, ending, obj, of_file, ply};
use crate::mesh::Mesh;

/// The triangles of a file whose ending is .obj (`v` and `f`) or .ply (`vertex` and `face`);
/// polygons become fans. Normals, colours and materials are passed over.
///
/// # Errors
/// If the file cannot be read, has another ending, or breaks its format.
pub fn open_mesh(path: &Path) -> Result<Mesh, FileError> {
    let format = match &*ending(path) {
        "obj" => Format::Obj,
        "ply" => Format::Ply,
        _ => {
            let path = path.display();
            return Err(refused(format!("{path}: the ending of a mesh must be .obj or .ply")));
        }
    };
    of_file(path, |bytes| read_mesh(bytes, format))
}

/// The triangles in the bytes of a file of [`Format::Obj`] or [`Format::Ply`].
///
/// # Errors
/// If the format is another, the bytes break it, or a coordinate is not finite.
pub fn read_mesh(bytes: &[u8], format: Format) -> Result<Mesh, FileError> {
    let bytes = unmarked(bytes);
    let (positions, polygons) = match format {
        Format::Obj => obj::lists(bytes, "f")?,
        Format::Ply => ply::lists(bytes, &["face"])?,
        _ => return Err(refused(format!("{format:?} has no meshes"))),
    };
    if let Some(at) = positions.iter().position(|p| !p.is_finite()) {
        return Err(refused(format!("vertex {at} is not finite")));
    }
    for &vertex in polygons.iter().flatten() {
        if vertex as usize >= positions.len() {
            return Err(refused(format!("there is no vertex {vertex} of {}", positions.len())));
        }
    }
    Ok(Mesh::of_polygons(positions, polygons.iter().map(Vec::as_slice)))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    const SQUARE: [Vec3; 4] = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];

    #[test]
    fn polygons_of_obj_and_ply_become_triangles_beside_their_lines() {
        let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nl 1 2\nvn 0 0 1\nf 1/1/1 2//1 3 -1\n";
        // The mark must not hide the first vertex.
        let obj = &*format!("\u{feff}{obj}");
        let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
            element face 1\nproperty list uchar int vertex_indices\nelement edge 1\nproperty int vertex1\n\
            property int vertex2\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n0 1\n";
        for (text, format) in [(obj, Format::Obj), (ply, Format::Ply)] {
            let mesh = read_mesh(text.as_bytes(), format).unwrap();
            assert_eq!(
                (&mesh.positions[..], &mesh.triangles[..]),
                (&SQUARE[..], &[[0, 1, 2], [0, 2, 3]][..])
            );
            let lines = crate::sets::files::read(text.as_bytes(), format).unwrap();
            assert_eq!((lines.len(), lines.points()), (1, &SQUARE[..2]));
        }
    }

    #[test]
    fn wrong_numbers_and_formats_are_refused() {
        let ply = |face: &str| {
            let head = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
            format!("{head}element face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n{face}\n")
        };
        for (text, format, part) in [
            ("v 0 0 0\nf 1 2 3\n".to_owned(), Format::Obj, "line 2: there is no vertex 2"),
            ("v 0 0 nan\nf 1 1 1\n".to_owned(), Format::Obj, "vertex 0 is not finite"),
            (ply("3 0 0 1"), Format::Ply, "no vertex 1 of 1"),
            (ply("3 0 0"), Format::Ply, "ends"),
            (String::new(), Format::Tck, "no meshes"),
        ] {
            let why = read_mesh(text.as_bytes(), format).unwrap_err().to_string();
            assert!(why.contains(part), "{text}: {why}");
        }
        assert!(open_mesh(Path::new("x.stl")).unwrap_err().to_string().contains(".obj or .ply"));
        assert!(open_mesh(Path::new("no/such.obj")).unwrap_err().to_string().contains("no/such.obj"));
    }
}
