//! The sets of the laboratory's walks, pinned: a change of the code that ought not to change any set must leave
//! `tests/pinned.csv` as it is. One that ought to, writes it anew:
//!
//! `CASCA_PIN=write cargo test --test pinned`
//!
//! The scenes are made with sines of the platform's own, so that only one platform is pinned.
#![cfg(all(target_os = "linux", target_arch = "x86_64"))]

use std::fmt::Write;
use std::sync::Arc;

use casca::{Instance, Method, ObjectDesc, ObjectId, Pvs, Query, Scene, Sphere, TriMesh};
use casca_scenes::drive::{Driver, view_of};
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::world::FRAME_SECONDS;
use glam::camera::rh::{proj::directx::perspective, view::look_at_mat4};
use glam::{Affine3A, Vec3};

const METHODS: [(&str, Method); 3] =
    [("Point", Method::point()), ("Cell", Method::cell()), ("Frustum", Method::Frustum)];

/// Frames of a walk, and every how many of them is pinned.
const FRAMES: usize = 60;
const STEP: usize = 5;

fn queries() -> [Query; 3] {
    METHODS.map(|(_, method)| Query::with_method(method).unwrap())
}

/// FNV-1a of the objects in their order and of the revealed ones.
fn hash(pvs: &Pvs) -> u64 {
    let ids = pvs.visible().iter().chain(pvs.revealed());
    ids.flat_map(|id| (id.index() as u32).to_le_bytes())
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

/// Asks all methods in one frame, ends it, and writes a row for each.
fn pin(
    rows: &mut String,
    scene: &str,
    frame: usize,
    view: &casca::View,
    queries: &mut [Query],
    at: &mut Scene,
) {
    for (query, (method, _)) in queries.iter_mut().zip(METHODS) {
        let pvs = query.run(at, view);
        writeln!(rows, "{scene},{frame},{method},{},{:016x}", pvs.len(), hash(pvs)).unwrap();
    }
    at.end_frame(queries.iter().map(Query::pvs)).unwrap();
}

fn walk(rows: &mut String, kind: SceneKind) {
    let scale = if kind == SceneKind::Crowd { 0.1 } else { 1.0 };
    let mut world = build(kind, &SceneOptions { seed: 5, frames: FRAMES, scale, ..Default::default() });
    let mut driver = Driver::new(&world, world.grid.cell, |_| ()).unwrap();
    let mut queries = queries();
    for frame in (0..world.frames).step_by(STEP) {
        let moved = world.set_frame(frame);
        driver.scene.begin_frame(frame as f64 * FRAME_SECONDS).unwrap();
        driver.update(&world.objects, &moved).unwrap();
        let view = view_of(&world.camera(frame, 16.0 / 9.0)).unwrap();
        pin(rows, kind.name(), frame, &view, &mut queries, &mut driver.scene);
    }
}

/// A ball of triangles with a radius of 1: rings from pole to pole.
fn ball(rings: u32) -> Arc<TriMesh> {
    let around = 2 * rings;
    let corner = |ring: u32, i: u32| {
        let (a, b) = (
            std::f32::consts::PI / rings as f32 * ring as f32,
            std::f32::consts::PI / rings as f32 * i as f32,
        );
        Vec3::new(a.sin() * b.cos(), a.cos(), a.sin() * b.sin())
    };
    let corners: Vec<Vec3> = (0..=rings).flat_map(|r| (0..around).map(move |i| corner(r, i))).collect();
    let at = |r: u32, i: u32| r * around + i % around;
    let quads = (0..rings)
        .flat_map(|r| (0..around).map(move |i| [at(r, i), at(r, i + 1), at(r + 1, i + 1), at(r + 1, i)]));
    let triangles = quads.flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    Arc::new(TriMesh::new(corners, triangles).unwrap())
}

/// Walls of panels that meet in T-junctions, balls that turn about them, and small things everywhere: all meshes.
fn meshes(rows: &mut String) {
    let mut scene = Scene::new(0.5).unwrap();
    for i in 0..24u32 {
        let (along, row) = ((i % 6) as f32 * 6.0 + 2.0, (i / 6) as f32 * 9.0 + 6.0);
        let at = |u: f32, y: f32| Vec3::new(along + u, y, row);
        // The lower panel has one corner more on its upper edge than the two above it together.
        let corners = [
            (0.0, 0.0),
            (5.0, 0.0),
            (5.0, 4.0),
            (2.0, 4.0),
            (0.0, 4.0),
            (2.5, 4.0),
            (0.0, 9.0),
            (2.5, 9.0),
            (5.0, 9.0),
        ];
        let corners = corners.map(|(u, y)| at(u, y)).to_vec();
        let triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [4, 5, 7], [4, 7, 6], [5, 2, 8], [5, 8, 7]];
        let panel = Arc::new(TriMesh::new(corners, triangles).unwrap());
        scene.insert(ObjectDesc::fixed(panel.clone()).occluder(panel)).unwrap();
    }
    let (shape, turning) = (ball(8), |i: usize, time: f32| {
        let a = i as f32 + time;
        let middle = Vec3::new(20.0 + 15.0 * a.cos(), 3.0 + (i % 3) as f32, 20.0 + 15.0 * a.sin());
        Affine3A::from_translation(middle) * Affine3A::from_scale(Vec3::new(1.0, 0.7, 1.3))
    });
    let instance = |i, time| Instance::new(shape.clone(), turning(i, time)).unwrap();
    let movers: Vec<ObjectId> = (0..20)
        .map(|i| {
            scene
                .insert(ObjectDesc::dynamic(instance(i, 0.0)).occluder(instance(i, 0.0)).max_speed(40.0))
                .unwrap()
        })
        .collect();
    for i in 0..600u32 {
        let at =
            Vec3::new((i * 37 % 389) as f32 * 0.1, (i * 53 % 97) as f32 * 0.1, (i * 71 % 383) as f32 * 0.1);
        scene.insert(ObjectDesc::fixed(Sphere::new(at + 0.5, 0.2))).unwrap();
    }
    let mut queries = queries();
    for frame in (0..FRAMES).step_by(STEP) {
        let time = frame as f32 * 0.05;
        scene.begin_frame(f64::from(time)).unwrap();
        for (i, &id) in movers.iter().enumerate() {
            let now = instance(i, time);
            scene.update(id, now.clone(), Some(now.into())).unwrap();
        }
        let eye = Vec3::new(20.0 + 12.0 * (time * 0.7).sin(), 1.7, 3.0 + 9.0 * time);
        let matrix =
            perspective(1.1, 1.6, 0.05, 200.0) * look_at_mat4(eye, Vec3::new(20.0, 4.0, 20.0), Vec3::Y);
        let view = casca::View::perspective(eye, matrix).unwrap();
        pin(rows, "meshes", frame, &view, &mut queries, &mut scene);
    }
}

#[test]
fn the_walks_find_the_sets_that_they_found() {
    let mut rows = String::from("scene,frame,method,visible,hash\n");
    SceneKind::SOLIDS.into_iter().for_each(|kind| walk(&mut rows, kind));
    meshes(&mut rows);
    if std::env::var("CASCA_PIN").is_ok_and(|v| v == "write") {
        std::fs::write("tests/pinned.csv", &rows).unwrap();
        return;
    }
    let pinned = include_str!("pinned.csv");
    let changed: Vec<(&str, &str)> = pinned.lines().zip(rows.lines()).filter(|(a, b)| a != b).collect();
    assert!(
        changed.is_empty(),
        "{} of {} sets changed, the first from {:?} to {:?}",
        changed.len(),
        rows.lines().count(),
        changed[0].0,
        changed[0].1
    );
    assert_eq!(pinned.lines().count(), rows.lines().count());
}
