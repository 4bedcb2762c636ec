//! Meshes: what preparing and streaming them costs. For queries, see
//! `casca-lab report --only tradeoff`.

use std::sync::Arc;

use casca::{Aabb, GridSpec, ObjectDesc, Scene, TriMesh};
use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use glam::{UVec3, Vec3};

/// A wavy sheet of 2 n^2 triangles.
fn sheet(n: u32, corner: Vec3, size: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let at = |i: u32, j: u32| {
        let (x, z) = (i as f32 / n as f32 * size, j as f32 / n as f32 * size);
        let y = (x * 0.9).sin() * (z * 0.7).cos() * 0.6 + (x * 7.0).sin() * 0.02;
        corner + Vec3::new(x, y, z)
    };
    let positions = (0..=n).flat_map(|j| (0..=n).map(move |i| at(i, j))).collect();
    let quad = |i: u32, j: u32| {
        let a = j * (n + 1) + i;
        let (b, c, d) = (a + 1, a + n + 1, a + n + 2);
        [[a, c, b], [b, c, d]]
    };
    (positions, (0..n).flat_map(|j| (0..n).flat_map(move |i| quad(i, j))).collect())
}

/// A wall of panels that share their corners.
fn panels(across: u32) -> Vec<Arc<TriMesh>> {
    let panel = |i: u32, j: u32| {
        let (x, y) = (i as f32 * 0.5, j as f32 * 0.5);
        let corners = [(x, y), (x + 0.5, y), (x + 0.5, y + 0.5), (x, y + 0.5)];
        let positions = corners.map(|(x, y)| Vec3::new(x, y, 20.0)).to_vec();
        Arc::new(TriMesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]).expect("a panel is a mesh"))
    };
    (0..across).flat_map(|j| (0..across).map(move |i| panel(i, j))).collect()
}

fn meshes(c: &mut Criterion) {
    let mut group = c.benchmark_group("mesh");
    group.sample_size(10);
    let (positions, triangles) = sheet(388, Vec3::ZERO, 40.0);
    group.bench_function(format!("prepare {} triangles", triangles.len()), |b| {
        b.iter_batched(
            || (positions.clone(), triangles.clone()),
            |(p, t)| TriMesh::new(p, t).expect("a sheet is a mesh"),
            BatchSize::PerIteration,
        );
    });
    group.bench_function(format!("prepare {} triangles as bounds only", triangles.len()), |b| {
        b.iter_batched(
            || (positions.clone(), triangles.clone()),
            |(p, t)| TriMesh::bounds_only(p, t).expect("a sheet is a mesh"),
            BatchSize::PerIteration,
        );
    });

    // Each triangle reaches through most of the grid.
    let corner = |i: u32| Vec3::new((i * 37 % 101) as f32, (i * 53 % 97) as f32, (i * 29 % 103) as f32);
    let slanted: Vec<[u32; 3]> = (0..40).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let slanted = TriMesh::new((0..120).map(corner).collect(), slanted).expect("triangles are a mesh");
    let slanted = Arc::new(slanted);
    let spec = GridSpec { min: Vec3::ZERO, cell: 0.75, dims: UVec3::splat(140) };
    let mut scene = Scene::new(&spec).expect("the grid is sound");
    group.bench_function("insert and remove 40 large triangles", |b| {
        b.iter(|| {
            let desc = ObjectDesc::fixed(slanted.clone()).occluder(slanted.clone());
            let id = scene.insert(desc).expect("the mesh is sound");
            scene.remove(id).expect("it is there");
        });
    });

    let wall = panels(100);
    let region = Aabb::new(Vec3::ZERO, Vec3::new(50.0, 50.0, 50.0));
    let spec = GridSpec::fit(region, 20_000).expect("the region is sound");
    let mut scene = Scene::new(&spec).expect("the grid is sound");
    // Another 10,000 stay where they are.
    for mesh in panels(100) {
        let moved = mesh.positions().iter().map(|p| *p + Vec3::Z * 15.0).collect();
        let mesh = Arc::new(TriMesh::new(moved, mesh.triangles().to_vec()).expect("a panel is a mesh"));
        scene.insert(ObjectDesc::fixed(mesh.clone()).occluder(mesh)).expect("the panel is sound");
    }
    group.bench_function("insert and remove 10,000 static meshes", |b| {
        b.iter(|| {
            let ids: Vec<_> = wall
                .iter()
                .map(|mesh| scene.insert(ObjectDesc::fixed(mesh.clone()).occluder(mesh.clone())))
                .collect();
            scene.begin_frame(0.0).expect("the time is finite");
            for id in ids {
                scene.remove(id.expect("the panel is sound")).expect("it is there");
            }
            scene.begin_frame(0.0).expect("the time is finite");
        });
    });
    group.finish();
}

criterion_group!(benches, meshes);
criterion_main!(benches);
