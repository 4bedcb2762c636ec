//! Bricks hold the points, files that are broken give errors, and hidden bricks cost nothing.

use super::file::LEVELS;
use super::*;
use crate::samples::sphere;
use crate::{Camera, PointCloud};
use casca::{Aabb, ObjectDesc, Query, Scene, View};
use glam::{DVec3, Vec3};
use std::fs;
use std::path::PathBuf;
use std::sync::Arc;
use tempfile::TempDir;

/// Points on a sphere of radius 10, a fifth of them doubled, and 50 times the same one far away.
fn cloud(count: usize) -> PointCloud {
    let mut positions: Vec<Vec3> = sphere(count).into_iter().map(|p| (p * 10.0).as_vec3()).collect();
    positions.extend_from_within(..count / 5);
    positions.extend([Vec3::new(300.0, -20.0, 7.0); 50]);
    let colours = (0..positions.len()).map(|i| [i as u8, (i >> 8) as u8, (i >> 16) as u8]).collect();
    PointCloud { origin: DVec3::new(2048.0, 0.0, 0.0), positions, colours, ..PointCloud::default() }
}

/// Builds bricks in a directory of their own, from chunks of a size.
fn build(cloud: &PointCloud, chunk: usize, options: BuildOptions) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bricks");
    let mut builder = Builder::create(&path, options).unwrap();
    for (positions, colours) in cloud.positions.chunks(chunk).zip(cloud.colours.chunks(chunk)) {
        let (origin, positions, colours) = (cloud.origin, positions.to_vec(), colours.to_vec());
        builder.push(&PointCloud { origin, positions, colours, ..PointCloud::default() }).unwrap();
    }
    let mut last = (0, 0);
    builder.finish(|done, all| last = (done, all)).unwrap();
    assert_eq!(last, (2 * cloud.len() as u64, 2 * cloud.len() as u64), "progress ends at the end");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "scratch files are removed");
    (folder, path)
}

fn options(most_points: u32) -> BuildOptions {
    BuildOptions { most_points, ..BuildOptions::default() }
}

fn want(brick: u32, points: u32) -> Want {
    Want { brick, points }
}

/// All points of a brick, as the file has them.
fn points(bricks: &Bricks, brick: u32) -> Vec<(Vec3, [u8; 3])> {
    let all = bricks.read(brick, 0..bricks.available(want(brick, u32::MAX))).unwrap();
    all.iter().map(|p| (p.position, p.colour)).collect()
}

#[test]
fn bricks_hold_every_point_once() {
    let cloud = cloud(3000);
    let (_folder, path) = build(&cloud, 1000, options(200));
    let bricks = Bricks::open(&path).unwrap();
    assert_eq!((bricks.points(), bricks.origin()), (3650, cloud.origin));
    assert!(bricks.len() < 80, "{} bricks", bricks.len());
    let key = |(p, c): (Vec3, [u8; 3])| (p.to_array().map(f32::to_bits), c);
    let mut found: Vec<_> = (0..bricks.len() as u32).flat_map(|b| points(&bricks, b)).map(key).collect();
    let mut expected: Vec<_> = cloud.positions.iter().copied().zip(cloud.colours).map(key).collect();
    found.sort_unstable();
    expected.sort_unstable();
    assert!(found == expected);
    let bounds: Vec<Aabb> = bricks.index.iter().map(|brick| brick.bounds).collect();
    let apart = |a: &Aabb, b: &Aabb| a.max.cmplt(b.min).any() || b.max.cmplt(a.min).any();
    for (i, a) in bounds.iter().enumerate() {
        assert!(bounds[..i].iter().all(|b| apart(a, b)), "brick {i} overlaps another");
    }
}

#[test]
fn bricks_that_are_cut_to_make_room_grow_again() {
    let cloud = cloud(3000);
    let (_folder, path) = build(&cloud, 1000, options(200));
    let bricks = Arc::new(Bricks::open(&path).unwrap());
    let number = |c: [u8; 3]| usize::from(c[0]) | usize::from(c[1]) << 8 | usize::from(c[2]) << 16;
    let check = |loader: &Loader, wants: &[Want]| {
        loader.want(wants);
        loader.settle();
        assert!(loader.take_error().is_none());
        let found = loader.gather(wants);
        let places = found.colours.iter().map(|&c| cloud.positions[number(c)]);
        assert!(found.check().is_ok() && found.positions.iter().copied().eq(places));
        found.len()
    };
    let all = |most: u32| (0..bricks.len() as u32).map(|brick| want(brick, most)).collect::<Vec<_>>();
    let loader = Loader::new(bricks.clone(), 1 << 20).unwrap();
    // In two steps, so that parts of bricks are joined; then less.
    let counts = [7, u32::MAX, 3].map(|most| check(&loader, &all(most)));
    assert!(counts[1] == cloud.len() && counts[0] > counts[2], "{counts:?}");
    let mut large = (0..bricks.len() as u32).filter(|&b| bricks.available(want(b, u32::MAX)) > 100);
    let [a, b] = [(); 2].map(|()| large.next().unwrap());
    let tight = Loader::new(bricks.clone(), 16 * 210).unwrap();
    for wants in [vec![want(a, 100)], vec![want(b, 200), want(a, 5)], vec![want(a, 100)]] {
        assert!(check(&tight, &wants) >= 100);
    }
}

#[test]
fn the_size_of_chunks_and_the_memory_do_not_matter() {
    let cloud = cloud(80_000);
    let small = BuildOptions { memory: 0, ..options(5000) };
    let [(_a, a), (_b, b)] = [build(&cloud, 1 << 20, options(5000)), build(&cloud, 777, small)];
    assert!(fs::read(a).unwrap() == fs::read(b).unwrap());
}

#[test]
fn every_level_of_detail_is_spread_over_its_brick() {
    let cloud = cloud(4000);
    let (_folder, path) = build(&cloud, 4000, options(1500));
    let bricks = Bricks::open(&path).unwrap();
    for brick in 0..bricks.len() as u32 {
        let (all, entry) = (points(&bricks, brick), &bricks.index[brick as usize]);
        for level in 0..LEVELS - 1 {
            let first = &all[..entry.counts[level] as usize];
            let cell = entry.edge() as f32 / f32::from(1_u16 << level);
            let nearest = |p: Vec3| first.iter().map(|(q, _)| p.distance(*q)).fold(f32::MAX, f32::min);
            let gap = all.iter().map(|(p, _)| nearest(*p)).fold(0.0, f32::max);
            assert!(gap <= 1.001 * cell * 3_f32.sqrt(), "brick {brick} level {level}: {gap} of {cell}");
            // One point a cell: no more than cells that a surface crosses.
            assert!(first.len() <= 6 << (2 * level), "brick {brick} level {level}: {}", first.len());
        }
    }
    // The sphere has 4 pi 100 / 4000 square units a point, whole or in part.
    let largest = (0..bricks.len() as u32).max_by_key(|&b| points(&bricks, b).len()).unwrap();
    for part in [1, 4, 16] {
        let count = points(&bricks, largest).len() as u32 / part;
        let (spacing, truth) = (bricks.spacing(largest, count), (0.314 / 1.2 * part as f32).sqrt());
        assert!((0.5..2.0).contains(&(spacing / truth)), "{spacing} {truth}");
    }
}

/// A file of two bricks of 400 points 5 and 20 units before the eye, the scene with or without a
/// wall between, and the camera.
fn two_bricks(wall: bool) -> (TempDir, Arc<Bricks>, Scene, Camera) {
    let ball = |z: f32| sphere(400).into_iter().map(move |p| p.as_vec3() + Vec3::Z * z);
    let positions: Vec<Vec3> = ball(-5.0).chain(ball(-20.0)).collect();
    let cloud = PointCloud { colours: vec![[9; 3]; positions.len()], positions, ..PointCloud::default() };
    let (folder, path) = build(&cloud, 100, options(400));
    let bricks = Arc::new(Bricks::open(&path).unwrap());
    let mut scene = Scene::new(1.0).unwrap();
    bricks.insert_into(&mut scene).unwrap();
    if wall {
        let wall = Aabb::new(Vec3::new(-30.0, -30.0, -14.0), Vec3::new(30.0, 30.0, -12.0));
        scene.insert(ObjectDesc::fixed(wall).occluder(wall).user_data(u64::MAX)).unwrap();
    }
    let camera = Camera::look_at(Vec3::ZERO, -Vec3::Z, Vec3::Y, 1.0, (64, 64), 0.1, 100.0).unwrap();
    (folder, bricks, scene, camera)
}

fn wants(bricks: &Bricks, scene: &Scene, camera: &Camera) -> Vec<Want> {
    let view = View::perspective(camera.eye(), camera.view_projection()).unwrap();
    let mut query = Query::new();
    let visible = query.run(scene, &view).iter().map(|id| scene.user_data(id).unwrap() as u32);
    bricks.wants(visible, camera, 0.01)
}

#[test]
fn a_brick_behind_a_wall_is_neither_wanted_nor_loaded() {
    for (wall, expected) in [(false, 800), (true, 400)] {
        let (_folder, bricks, scene, camera) = two_bricks(wall);
        let wants = wants(&bricks, &scene, &camera);
        let loader = Loader::new(bricks, 1 << 20).unwrap();
        loader.want(&wants);
        loader.settle();
        let cloud = loader.gather(&wants);
        assert_eq!((loader.loaded(), cloud.len()), (expected, expected));
        assert!(cloud.check().is_ok() && cloud.radii.iter().all(|&r| r > 0.03 && r < 0.6));
        assert_eq!(cloud.positions.iter().any(|p| p.z < -15.0), !wall);
    }
}

#[test]
fn a_picture_needs_fewer_points_of_far_bricks() {
    let (_folder, bricks, scene, camera) = two_bricks(false);
    let count = |pixels| bricks.wants([1, 77], &camera, pixels).iter().map(|want| want.points).sum::<u32>();
    let counts = [0.0, 4.0, 1.0, 1e9, f32::NAN].map(count);
    assert!(matches!(counts, [400, few, more, 1, 1] if 1 < few && few < more), "{counts:?}");
    assert_eq!(wants(&bricks, &scene, &camera).len(), 2);
}

#[test]
fn the_budget_holds_the_nearest_and_the_latest() {
    let (_folder, bricks, ..) = two_bricks(false);
    let loader = Loader::new(bricks, 16 * 500).unwrap();
    let loaded = |list: &[Want]| {
        loader.want(list);
        loader.settle();
        assert!(loader.loaded() <= 500);
        [0, 1].map(|brick| loader.gather(&[want(brick, 400)]).len())
    };
    assert_eq!(loaded(&[want(1, 300), want(0, 201), want(99, 5)]), [0, 300], "the second does not fit");
    assert_eq!(loaded(&[want(1, 100), want(0, 200)]), [200, 300], "all stays while there is room");
    assert_eq!(loaded(&[want(0, 400), want(1, 100)]), [400, 100], "more than is wanted is dropped");
    assert_eq!(loaded(&[want(1, 200)]), [0, 200], "the one that is not wanted is dropped");
    assert_eq!(loaded(&[]), [0, 200]);
    // Of a brick that is wanted twice the larger count is loaded.
    assert_eq!(loaded(&[want(1, 100), want(0, 300), want(0, 100)]), [300, 200]);
    assert_eq!(loaded(&[want(0, 1), want(0, 400), want(1, 100)]), [400, 100]);
}

#[test]
fn a_brick_that_cannot_be_read_is_an_error() {
    let (_folder, path) = build(&cloud(100), 100, options(1000));
    let bricks = Arc::new(Bricks::open(&path).unwrap());
    fs::OpenOptions::new().write(true).open(&path).unwrap().set_len(300).unwrap();
    let loader = Loader::new(bricks, 1 << 20).unwrap();
    loader.want(&[want(0, 120)]);
    loader.settle();
    assert!(matches!(loader.take_error(), Some(BrickError::Io { .. })));
    assert_eq!((loader.loaded(), loader.take_error().is_none()), (0, true));
}

#[test]
fn points_without_a_place_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let mut builder = Builder::create(&folder.path().join("a"), BuildOptions::default()).unwrap();
    let bad = PointCloud { positions: vec![Vec3::ONE, Vec3::NAN], ..PointCloud::default() };
    assert!(matches!(builder.push(&bad), Err(BrickError::NotFinite { index: 1 })));
    let none = Builder::create(&folder.path().join("none"), BuildOptions::default()).unwrap();
    none.finish(|_, _| ()).unwrap();
    assert!(Bricks::open(&folder.path().join("none")).unwrap().is_empty());
}
