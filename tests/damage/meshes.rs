//! Small files of prepared meshes, for tests of damaged ones and for the fuzz targets `readers` and
//! `mesh_file`.

use std::ops::ControlFlow;

use casca::{Facing, MeshOptions, TriMesh};
use glam::Vec3;

/// Bytes before the contents of a file, and after them.
pub const HEADER: usize = 20;
pub const CHECKSUM: usize = 8;

/// A square, a cube with parts, and a bowl with open sides, prepared in several ways.
pub fn all() -> Vec<Vec<u8>> {
    let square = vec![Vec3::ZERO, Vec3::X * 6.0, Vec3::new(6.0, 6.0, 0.0), Vec3::Y * 6.0];
    let cube = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 5.0 + 1.0;
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces: Vec<_> = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    let cube: Vec<Vec3> = (0..8).map(cube).collect();
    let bowl = |i: u32| {
        let (x, z) = ((i % 5) as f32 - 2.0, (i / 5) as f32 - 2.0);
        Vec3::new(x, 0.15 * (x * x + z * z), z)
    };
    let bowl: Vec<Vec3> = (0..25).map(bowl).collect();
    let bent = (0..16).map(|i| i / 4 * 5 + i % 4).flat_map(|v| [[v, v + 5, v + 1], [v + 1, v + 5, v + 6]]);
    let bent: Vec<_> = bent.collect();
    let (plain, mut front, mut bounds) =
        (MeshOptions::default(), MeshOptions::default(), MeshOptions::default());
    (front.facing, front.tolerance, bounds.occludes) = (Facing::Front, Some(0.2), false);
    let all = [
        (square, vec![[0, 1, 2], [0, 2, 3]], plain),
        (bowl.clone(), bent.clone(), plain),
        (bowl.clone(), bent.clone(), bounds),
        (bowl, bent, front),
        (cube.clone(), faces.clone(), plain),
        (cube, faces[3..].to_vec(), front),
    ];
    let file = |(positions, triangles, how): (Vec<Vec3>, Vec<[u32; 3]>, MeshOptions)| {
        let go = &mut |_| ControlFlow::Continue(());
        let mesh = TriMesh::prepare(positions, triangles, &how, go).expect("a plain mesh");
        let mut bytes = Vec::new();
        mesh.write(&mut bytes).expect("a list takes all bytes");
        bytes
    };
    all.into_iter().map(file).collect()
}

/// Sets length and checksum right.
pub fn mend(file: &mut [u8]) {
    if file.len() < HEADER + CHECKSUM {
        return;
    }
    let end = file.len() - CHECKSUM;
    file[HEADER - 8..HEADER].copy_from_slice(&((end - HEADER) as u64).to_le_bytes());
    let fold = |h: u64, b: &u8| (h ^ u64::from(*b)).wrapping_mul(0x100_0000_01b3);
    let checksum = file[..end].iter().fold(0xcbf2_9ce4_8422_2325, fold);
    file[end..].copy_from_slice(&checksum.to_le_bytes());
}
