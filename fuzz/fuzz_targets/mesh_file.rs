//! Reads prepared meshes from arbitrary bytes, and from written ones that were changed and got a right
//! checksum again: they are refused, or can be used. Meshes prepared from arbitrary
//! triangles are read as they were written.
#![no_main]

use std::ops::ControlFlow;
use std::sync::{Arc, LazyLock};

use arbitrary::Arbitrary;
use casca::{
    Facing, Instance, MeshOptions, Method, ObjectDesc, Plane, PointOptions, Query, Scene, Sphere, TriMesh,
    View,
};
use glam::{Affine3A, Mat3, Vec3};
use libfuzzer_sys::fuzz_target;

#[path = "../../tests/damage/mod.rs"]
mod damage;
#[path = "../../tests/damage/meshes.rs"]
mod meshes;

/// Files to change: small meshes.
static FILES: LazyLock<Vec<Vec<u8>>> = LazyLock::new(meshes::all);

/// Puts a number near those of meshes into a file, in single or double precision.
#[derive(Debug, Arbitrary)]
struct Put {
    at: u32,
    value: i16,
    double: bool,
}

impl Put {
    fn into(&self, file: &mut [u8]) {
        let value = f64::from(self.value) / 1024.0;
        let bytes =
            if self.double { value.to_le_bytes().to_vec() } else { (value as f32).to_le_bytes().to_vec() };
        let at = self.at as usize % file.len().max(1);
        file.iter_mut().skip(at).zip(bytes).for_each(|(to, from)| *to = from);
    }
}

#[derive(Debug, Arbitrary)]
enum Input {
    Bytes(Vec<u8>),
    /// Contents with a right header and checksum.
    Contents(Vec<u8>),
    Changed {
        which: u8,
        puts: Vec<Put>,
        /// The numbers that choose damages, and zeros behind them.
        damages: Option<Vec<u8>>,
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

/// Does with a mesh what can be done with one.
fn use_it(mesh: TriMesh, play: &Play) {
    let mesh = Arc::new(mesh);
    let mut scene = Scene::new(1.0).expect("a plain grid");
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
        Input::Contents(contents) => {
            let mut file = [&FILES[0][..meshes::HEADER], contents, &[0; meshes::CHECKSUM]].concat();
            meshes::mend(&mut file);
            file
        }
        Input::Changed { which, puts, damages } => {
            let mut file = FILES[usize::from(*which) % FILES.len()].clone();
            puts.iter().take(16).for_each(|put| put.into(&mut file[meshes::HEADER..]));
            if let Some(damages) = damages {
                let mut bytes = damages.iter();
                let mut next =
                    || (0..3).fold(0, |n, _| n << 8 | u64::from(bytes.next().copied().unwrap_or(0)));
                file = damage::damaged(&file, &FILES, &mut next);
            }
            meshes::mend(&mut file);
            file
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
