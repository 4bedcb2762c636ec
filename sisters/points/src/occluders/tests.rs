//! Walls hide, and what is no wall hides nothing.

use casca::{Aabb, GridSpec, Query, Scene, View};
use glam::{Mat3, Vec3, vec3};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use tempfile::TempDir;

use super::*;
use crate::bricks::{BuildOptions, Builder};
use crate::samples::{cases, coordinate};
use crate::{Camera, PointCloud};

/// Random points of rectangles with noise, one in each square of side `spacing`.
struct Scan {
    points: Vec<Vec3>,
    random: Pcg64Mcg,
    spacing: f32,
    noise: f32,
}

impl Scan {
    fn new(spacing: f32, noise: f32) -> Self {
        Self { points: Vec::new(), random: Pcg64Mcg::seed_from_u64(7), spacing, noise }
    }

    fn rectangle(&mut self, corner: Vec3, u: Vec3, v: Vec3, kept: impl Fn(Vec3) -> bool) {
        let count = (u.cross(v).length() / (self.spacing * self.spacing)) as usize;
        for _ in 0..count {
            let p = corner + u * self.random.random::<f32>() + v * self.random.random::<f32>();
            let mut jitter = || (0..12).map(|_| self.random.random::<f32>()).sum::<f32>() - 6.0;
            let jitter = vec3(jitter(), jitter(), jitter()) * self.noise;
            if kept(p) {
                self.points.push(p + jitter);
            }
        }
    }

    /// A wall of 10 x 6 at z = 0 as far as points are kept.
    fn wall(mut self, kept: impl Fn(Vec3) -> bool) -> Self {
        self.rectangle(vec3(-5.0, -3.0, 0.0), Vec3::X * 10.0, Vec3::Y * 6.0, kept);
        self
    }

    fn bricks(&self, turn: Mat3) -> (TempDir, Bricks) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bricks");
        let options = BuildOptions { most_points: 500, ..BuildOptions::default() };
        let mut builder = Builder::create(&path, options).unwrap();
        let positions = self.points.iter().map(|&p| turn * p).collect();
        builder.push(&PointCloud { positions, ..PointCloud::default() }).unwrap();
        builder.finish(|_, _| ()).unwrap();
        let bricks = Bricks::open(&path).unwrap();
        (folder, bricks)
    }

    fn occluders(&self, options: &OccluderOptions) -> Occluders {
        Occluders::estimate(&self.bricks(Mat3::IDENTITY).1, options).unwrap()
    }
}

/// Whether some box crosses the segment, all of them turned back.
fn hides(found: &Occluders, turn: Mat3, from: Vec3, to: Vec3) -> bool {
    found.boxes.iter().any(|b| {
        let back = Mat3::from_quat(b.rotation).transpose();
        let [from, to] = [from, to].map(|p| back * (turn * p - b.center));
        let inverse = (to - from).recip();
        let (a, c) = ((-b.half - from) * inverse, (b.half - from) * inverse);
        a.min(c).max_element().max(0.0) < a.max(c).min_element().min(1.0)
    })
}

fn window(p: Vec3) -> bool {
    p.x.abs() < 0.6 && p.y.abs() < 0.6
}

#[test]
fn a_wall_hides_and_its_window_stays_open() {
    for (noise, turn) in [(0.0, 0.0), (0.0, 0.5), (0.05, 0.0), (0.05, 0.7)] {
        let turn = Mat3::from_axis_angle(vec3(1.0, 2.0, 0.4).normalize(), turn);
        let (_folder, bricks) = Scan::new(0.1, noise).wall(|p| !window(p)).bricks(turn);
        let found = Occluders::estimate(&bricks, &OccluderOptions::default()).unwrap();
        let (mut hidden, mut solid) = (0, 0);
        for (i, j) in (-48..=48).flat_map(|i| (-28..=28).map(move |j| (i, j))) {
            let p = vec3(i as f32, j as f32, 0.0) / 10.0;
            let is_hidden = hides(&found, turn, p + Vec3::Z, p - Vec3::Z);
            if window(p) {
                assert!(!is_hidden, "noise {noise}: the window is closed at {p}");
            } else {
                solid += 1;
                hidden += usize::from(is_hidden);
            }
        }
        assert!(hidden * 10 > solid * 7, "noise {noise}: {hidden} of {solid}");
        assert!(found.boxes.len() < 60, "{}", found.boxes.len());
        assert!((0.05..0.3).contains(&found.resolution), "{}", found.resolution);
    }
}

#[test]
fn walls_whose_sides_look_like_one_to_bricks_have_no_holes() {
    let mut scan = Scan::new(0.1, 0.0);
    for z in [0.0, 0.22] {
        scan.rectangle(vec3(-9.0, -3.0, z), Vec3::X * 18.0, Vec3::Y * 6.0, |_| true);
    }
    let (_folder, bricks) = scan.bricks(Mat3::IDENTITY);
    let rough = bricks.usual_spacing(0.75);
    assert!(rough < 0.078, "bricks tell the spacing, {rough}");
    let found = Occluders::estimate(&bricks, &OccluderOptions::default()).unwrap();
    assert!((0.1..0.2).contains(&found.resolution), "{}", found.resolution);
    let places: Vec<Vec3> =
        (-85..85).flat_map(|i| (-25..25).map(move |j| vec3(i as f32, j as f32, 0.0) / 10.0)).collect();
    let hidden = places.iter().filter(|&&p| hides(&found, Mat3::IDENTITY, p + Vec3::Z, p - Vec3::Z)).count();
    assert!(hidden * 10 > places.len() * 9, "{hidden} of {}", places.len());
    let small = OccluderOptions { resolution: Some(1.25 * rough), ..OccluderOptions::default() };
    let (found, before) = (Occluders::estimate(&bricks, &small).unwrap(), hidden);
    let hidden = places.iter().filter(|&&p| hides(&found, Mat3::IDENTITY, p + Vec3::Z, p - Vec3::Z)).count();
    assert!(hidden * 10 < before * 9, "{hidden} with the spacing of bricks, {before} without");
}

#[test]
fn a_corner_of_walls_is_closed() {
    let mut scan = Scan::new(0.1, 0.005);
    let up = Vec3::Y * 6.0;
    scan.rectangle(Vec3::ZERO, Vec3::X * 8.0, up, |_| true);
    scan.rectangle(Vec3::ZERO, Vec3::Z * 8.0, up, |_| true);
    let found = scan.occluders(&OccluderOptions::default());
    // Rays that pass the corner at less than a spacing.
    for y in 8..52 {
        let p = vec3(0.05, y as f32 / 10.0, 0.05);
        assert!(hides(&found, Mat3::IDENTITY, p + vec3(1.0, 0.0, 1.0), p - vec3(1.0, 0.0, 1.0)), "{p}");
    }
}

#[test]
fn what_is_no_wall_hides_nothing() {
    let none = |name: &str, scan: Scan| {
        let found = scan.occluders(&OccluderOptions::default());
        assert!(found.boxes.is_empty(), "{name}: {} boxes of {}", found.boxes.len(), found.resolution);
    };
    let slat = |p: Vec3| (p.x / 0.45).rem_euclid(1.0) < 0.27;
    none("a fence", Scan::new(0.1, 0.0).wall(slat));
    let mut hedge = Scan::new(0.1, 0.0);
    for _ in 0..54_000 {
        let p = Vec3::from_array(std::array::from_fn(|_| hedge.random.random::<f32>()));
        hedge.points.push(3.0 * p);
    }
    none("a hedge", hedge);
    // A wall scanned a tenth as densely as the floor before it.
    let mut thin = Scan::new(0.1, 0.0);
    thin.rectangle(vec3(-20.0, -3.0, 0.0), Vec3::X * 40.0, Vec3::Z * 40.0, |_| true);
    let floor = thin.points.len();
    thin.spacing = 0.32;
    let thin = thin.wall(|_| true);
    assert!(thin.points.len() > floor + 400);
    let found = thin.occluders(&OccluderOptions::default());
    let through = |x: f32| hides(&found, Mat3::IDENTITY, vec3(x, 0.0, 1.0), vec3(x, 0.0, -1.0));
    assert!(!(-40..40).any(|x| through(x as f32 / 10.0)), "a wall of few points");
    // Noise of three spacings; a wall again in cells that are large beside it.
    let noisy = Scan::new(0.1, 0.3).wall(|_| true);
    let fine = OccluderOptions { resolution: Some(0.125), ..OccluderOptions::default() };
    assert!(noisy.occluders(&fine).boxes.is_empty(), "noise of three spacings");
    let mut few = Scan::new(1.0, 0.0);
    few.points = vec![Vec3::ZERO; 40];
    none("one place", few);
}

#[test]
fn a_wall_hides_the_room_behind_it_and_not_itself() {
    let mut scan = Scan::new(0.1, 0.02).wall(|_| true);
    let front = scan.points.len();
    scan.rectangle(vec3(-1.0, -1.0, -3.0), Vec3::X * 2.0, Vec3::Y * 2.0, |_| true);
    let (_folder, bricks) = scan.bricks(Mat3::IDENTITY);
    let found = Occluders::estimate(&bricks, &OccluderOptions::default()).unwrap();
    let objects = bricks.len() + found.boxes.len();
    let mut scene = Scene::new(&GridSpec::fit(bricks.bounds(), objects).unwrap()).unwrap();
    let ids = bricks.insert_grown(&mut scene, found.margin).unwrap();
    assert_eq!(found.insert_into(&mut scene).unwrap().len(), found.boxes.len());
    for z in [8.0, -8.0] {
        let eye = vec3(0.3, 0.2, z);
        let camera = Camera::look_at(eye, Vec3::ZERO, Vec3::Y, 1.4, (512, 512), 0.1, 100.0).unwrap();
        let view = View::perspective(eye, camera.view_projection()).unwrap();
        let mut query = Query::new();
        let pvs = query.run(&scene, &view);
        for (brick, id) in ids.iter().enumerate() {
            let Aabb { min, max } = Aabb::from_points(bricks.positions(brick as u32).unwrap()).unwrap();
            let is_wall = max.z > -1.0;
            let seen = pvs.contains(*id);
            assert!(!is_wall || seen, "the wall hides its brick {brick}, {min} to {max}, from {eye}");
            assert!(is_wall || seen == (z < 0.0), "brick {brick} of the room, {min} to {max}, from {eye}");
        }
    }
    assert!(front > 5000);
}

#[test]
fn options_are_kept_and_absurd_ones_are_harmless() {
    let scan = Scan::new(0.1, 0.0).wall(|p| !window(p));
    let all = scan.occluders(&OccluderOptions::default());
    let two = scan.occluders(&OccluderOptions { most: 2, ..OccluderOptions::default() });
    assert_eq!(two.boxes, all.boxes[..2]);
    assert_eq!(scan.occluders(&OccluderOptions::default()), all, "the same again");
    for resolution in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let options = OccluderOptions { resolution: Some(resolution), ..OccluderOptions::default() };
        assert_eq!(scan.occluders(&options), all);
    }
    for resolution in [f32::MIN_POSITIVE, 1e-5, 1e9, f32::MAX] {
        let options = OccluderOptions { resolution: Some(resolution), least_side: 0, ..Default::default() };
        let found = scan.occluders(&options);
        assert!(found.boxes.is_empty() && found.margin.is_finite(), "{resolution}");
    }
    assert!(Scan::new(1.0, 0.0).occluders(&OccluderOptions::default()).boxes.is_empty());
}

proptest! {
    #![proptest_config(cases(40))]

    #[test]
    fn any_points_have_occluders(
        points in prop::collection::vec(prop::array::uniform3(prop_oneof![
            4 => coordinate(1.0),
            1 => prop_oneof![-1e30_f32..1e30, Just(f32::MAX), Just(f32::MIN_POSITIVE)],
        ]), 0..60),
    ) {
        let mut scan = Scan::new(1.0, 0.0);
        scan.points = points.into_iter().map(Vec3::from).collect();
        let found = scan.occluders(&OccluderOptions { least_side: 0, ..OccluderOptions::default() });
        prop_assert!(found.boxes.iter().all(|b| b.center.is_finite() && b.half.is_finite()));
    }
}
