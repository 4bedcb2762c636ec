//! Reads prepared meshes from arbitrary bytes, and from written ones that were changed and got a right
//! checksum again: they are refused, or can be used. Meshes prepared from arbitrary
//! triangles are read as they were written.
#![no_main]

use std::ops::ControlFlow;
use std::sync::{Arc, OnceLock};

use arbitrary::Arbitrary;
use casca::{
    Facing, GridSpec, Instance, MeshOptions, Method, ObjectDesc, Plane, PointOptions, Query, Scene, Sphere,
    TriMesh, View,
};
use glam::{Affine3A, Mat3, UVec3, Vec3};
use libfuzzer_sys::fuzz_target;

/// Bytes before the contents of a file, and after them.
const HEADER: usize = 20;
const CHECKSUM: usize = 8;

/// A number as it may stand in a file.
#[derive(Debug, Arbitrary)]
enum Value {
    Byte(u8),
    Short(u16),
    Word(u32),
    Long(u64),
    Near(i16),
    NearDouble(i16),
    Single(f32),
    Double(f64),
    Copy { from: u32, length: u8 },
}

#[derive(Debug, Arbitrary)]
enum Edit {
    Put { at: u32, value: Value },
    Insert { at: u32, bytes: Vec<u8> },
    Remove { at: u32, length: u8 },
}

#[derive(Debug, Arbitrary)]
enum Input {
    Bytes(Vec<u8>),
    /// Contents with a right header and checksum.
    Contents(Vec<u8>),
    Changed {
        which: u8,
        edits: Vec<Edit>,
    },
    Prepared {
        positions: Vec<[i8; 3]>,
        any: Vec<[f32; 3]>,
        triangles: Vec<[u8; 3]>,
        tolerance: f32,
        front: bool,
    },
}

#[derive(Debug, Arbitrary)]
struct Play {
    input: Input,
    placed: [i8; 12],
    eyes: [[i8; 3]; 3],
    plane: ([i8; 3], i8),
}

fn near(v: [i8; 3]) -> Vec3 {
    Vec3::from_array(v.map(|c| f32::from(c) / 4.0))
}

fn bytes(mesh: &TriMesh) -> Vec<u8> {
    let mut bytes = Vec::new();
    mesh.write(&mut bytes).expect("a list takes all bytes");
    bytes
}

/// Files to change: small meshes, moved to the middle of the grid.
fn originals() -> &'static [Vec<u8>] {
    static FILES: OnceLock<Vec<Vec<u8>>> = OnceLock::new();
    FILES.get_or_init(|| {
        let square = vec![Vec3::ZERO, Vec3::X * 6.0, Vec3::new(6.0, 6.0, 0.0), Vec3::Y * 6.0];
        let cube = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 5.0 + 1.0;
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let faces: Vec<[u32; 3]> =
            quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
        let cube: Vec<Vec3> = (0..8).map(cube).collect();
        // A bowl: bent patches, chains of edges, and open sides.
        let bowl = |x: u32, z: u32| {
            let (x, z) = (x as f32 - 4.0, z as f32 - 4.0);
            Vec3::new(x, 0.15 * (x * x + z * z), z)
        };
        let bowl: Vec<Vec3> = (0..81).map(|i| bowl(i % 9, i / 9)).collect();
        let bent =
            (0..64).map(|i| i / 8 * 9 + i % 8).flat_map(|v| [[v, v + 9, v + 1], [v + 1, v + 9, v + 10]]);
        let bent: Vec<[u32; 3]> = bent.collect();
        let mut front = MeshOptions::default();
        front.facing = Facing::Front;
        front.tolerance = Some(0.2);
        let plain = MeshOptions::default();
        let mut bounds = MeshOptions::default();
        bounds.occludes = false;
        let all = [
            (square, vec![[0, 1, 2], [0, 2, 3]], plain),
            (cube.clone(), faces.clone(), plain),
            (cube, faces[3..].to_vec(), front),
            (bowl.clone(), bent.clone(), plain),
            (bowl.clone(), bent.clone(), bounds),
            (bowl, bent, front),
        ];
        let prepare = |(p, t, how)| {
            bytes(&TriMesh::prepare(p, t, &how, &mut |_| ControlFlow::Continue(())).expect("a plain mesh"))
        };
        all.into_iter().map(prepare).collect()
    })
}

/// Contents as a file.
fn file(contents: &[u8]) -> Vec<u8> {
    let mut file = originals()[0][..HEADER - 8].to_vec();
    file.extend((contents.len() as u64).to_le_bytes());
    file.extend(contents);
    let fold = |h: u64, b: &u8| (h ^ u64::from(*b)).wrapping_mul(0x100_0000_01b3);
    let checksum = file.iter().fold(0xcbf2_9ce4_8422_2325, fold);
    file.extend(checksum.to_le_bytes());
    file
}

fn change(contents: &mut Vec<u8>, edit: &Edit) {
    let length = contents.len().max(1);
    let within = |at: u32| at as usize % length;
    match *edit {
        Edit::Put { at, ref value } => {
            let at = within(at);
            let new = match *value {
                Value::Byte(v) => vec![v],
                Value::Short(v) => v.to_le_bytes().to_vec(),
                Value::Word(v) => v.to_le_bytes().to_vec(),
                Value::Long(v) => v.to_le_bytes().to_vec(),
                Value::Near(v) => (f32::from(v) / 1024.0).to_le_bytes().to_vec(),
                Value::NearDouble(v) => (f64::from(v) / 1024.0).to_le_bytes().to_vec(),
                Value::Single(v) => v.to_le_bytes().to_vec(),
                Value::Double(v) => v.to_le_bytes().to_vec(),
                Value::Copy { from, length } => {
                    contents.iter().skip(within(from)).take(length.into()).copied().collect()
                }
            };
            contents.iter_mut().skip(at).zip(new).for_each(|(to, from)| *to = from);
        }
        Edit::Insert { at, ref bytes } => {
            let at = within(at).min(contents.len());
            contents.splice(at..at, bytes.iter().copied());
        }
        Edit::Remove { at, length } => {
            let at = within(at).min(contents.len());
            contents.drain(at..contents.len().min(at + usize::from(length)));
        }
    }
}

/// Does with a mesh what can be done with one.
fn use_it(mesh: TriMesh, play: &Play) {
    let mesh = Arc::new(mesh);
    let spec = GridSpec { min: Vec3::splat(-8.0), cell: 1.0, dims: UVec3::splat(16) };
    let mut scene = Scene::new(&spec).expect("a plain grid");
    let occludes = mesh.occludes();
    let fixed = || {
        let desc = ObjectDesc::fixed(mesh.clone());
        if occludes { desc.occluder(mesh.clone()) } else { desc }
    };
    let mut ids = vec![scene.insert(fixed()).expect("a mesh that was taken")];
    // Its seams are then those of two objects.
    ids.push(scene.insert(fixed()).expect("a mesh that was taken"));
    let [a, b, c, d] = [0, 3, 6, 9].map(|i| near([play.placed[i], play.placed[i + 1], play.placed[i + 2]]));
    let placed = Affine3A::from_mat3_translation(Mat3::from_cols(a, b, c), d);
    for transform in [Affine3A::from_rotation_y(0.4), placed] {
        if let Ok(instance) = Instance::new(mesh.clone(), transform) {
            let desc = ObjectDesc::dynamic(instance.clone()).occluder(instance);
            let inserted = scene.insert(desc);
            assert!(occludes || inserted == Err(casca::Error::BoundsOnly));
            ids.extend(inserted);
        }
    }
    for i in 0..27 {
        let center = Vec3::new((i % 3) as f32, (i / 3 % 3) as f32, (i / 9) as f32) * 5.0 - 5.0;
        ids.push(scene.insert(ObjectDesc::fixed(Sphere::new(center, 0.3))).expect("a plain sphere"));
    }
    let mut query = Query::new();
    let normal = near(play.plane.0);
    let planes = [Plane { normal, offset: f32::from(play.plane.1) }];
    for (round, &eye) in play.eyes.iter().enumerate() {
        for method in [Method::Point(PointOptions::default().pixel_degrees(1.0)), Method::cell()] {
            query.set_method(method).expect("plain options");
            let planes = if round == 0 { &[][..] } else { &planes[..] };
            if let Ok(view) = View::from_planes(near(eye), planes) {
                query.run(&scene, &view);
            }
        }
        for &id in &ids {
            scene.translate(id, near(eye) * 0.25).ok();
        }
        scene.remove(ids.remove(0)).expect("a living object");
    }
}

fuzz_target!(|play: Play| {
    let file = match &play.input {
        Input::Bytes(bytes) => bytes.clone(),
        Input::Contents(contents) => file(contents),
        Input::Changed { which, edits } => {
            let all = originals();
            let whole = &all[usize::from(*which) % all.len()];
            let mut contents = whole[HEADER..whole.len() - CHECKSUM].to_vec();
            edits.iter().take(16).for_each(|edit| change(&mut contents, edit));
            file(&contents)
        }
        Input::Prepared { positions, any, triangles, tolerance, front } => {
            let mut how = MeshOptions::default();
            how.tolerance = (*tolerance >= 0.0).then_some(*tolerance);
            how.facing = if *front { Facing::Front } else { Facing::Both };
            let positions: Vec<Vec3> =
                positions.iter().map(|&p| near(p)).chain(any.iter().map(|&p| Vec3::from_array(p))).collect();
            let count = positions.len().max(1) as u32;
            let triangles: Vec<[u32; 3]> =
                triangles.iter().map(|t| t.map(|v| u32::from(v) % count)).collect();
            let Ok(mesh) = TriMesh::prepare(positions, triangles, &how, &mut |_| ControlFlow::Continue(()))
            else {
                return;
            };
            let file = bytes(&mesh);
            let loaded = TriMesh::read(&mut file.as_slice()).expect("a mesh that was written");
            assert_eq!(loaded.is_closed(), mesh.is_closed());
            assert_eq!(loaded.aabb(), mesh.aabb());
            file
        }
    };
    let mut rest = file.as_slice();
    match TriMesh::read(&mut rest) {
        Ok(mesh) => {
            // What was taken is written as it was read.
            assert!(file.starts_with(&bytes(&mesh)) && bytes(&mesh).len() + rest.len() == file.len());
            use_it(mesh, &play);
        }
        Err(e) => drop(e.to_string()),
    }
});
