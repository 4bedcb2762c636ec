//! Both bounds of visible fractions against rays to the shapes themselves.

use std::sync::Arc;

use casca::soft::{Layer, SoftGrid, VisibleFraction};
use casca::{Aabb, GridSpec, Sphere, TriMesh};
use glam::{DAffine3, DVec3, UVec3, Vec3};

use crate::Dice;

/// Rays of an answer, and of the truth.
const RAYS: u32 = 1024;
const TRUE_RAYS: u32 = 2048;

/// The noise of so many rays: more than three deviations of the truth's, and as much again for the
/// answer's, which fill the cone evenly.
const NOISE: f32 = 0.05;

/// The six faces of a box as twelve triangles.
fn box_mesh(shape: &Aabb) -> TriMesh {
    let corner = |i: usize| Vec3::from_array([0, 1, 2].map(|a| [shape.min, shape.max][i >> a & 1][a]));
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh::bounds_only((0..8).map(corner).collect(), faces).unwrap()
}

/// A scene of boxes, balls and meshes, some of them turned, and the grids that hold it.
struct Things {
    boxes: Vec<(Aabb, DAffine3)>,
    balls: Vec<Sphere>,
}

impl Things {
    fn new(dice: &mut Dice) -> Self {
        let mut boxes = Vec::new();
        for i in 0..24 {
            let (at, half) = (dice.point(0.0, 32.0), dice.point(0.3, 4.0));
            let turn = glam::DQuat::from_axis_angle(
                dice.point(-1.0, 1.0).as_dvec3().normalize_or(DVec3::X),
                if i % 3 == 0 { 0.7 } else { 0.0 },
            );
            boxes.push((
                Aabb::from_center(Vec3::ZERO, half),
                DAffine3::from_rotation_translation(turn, at.as_dvec3()),
            ));
        }
        let balls = (0..12).map(|_| Sphere::new(dice.point(0.0, 32.0), 0.3 + 3.0 * dice.next())).collect();
        Self { boxes, balls }
    }

    /// The boxes that are not turned go in as boxes and as meshes, the others as instances.
    fn grid(&self, cell: f32) -> SoftGrid {
        let dims = UVec3::splat((32.0 / cell) as u32);
        let mut grid = SoftGrid::new(&GridSpec { min: Vec3::ZERO, cell, dims }).unwrap();
        for (i, (shape, placed)) in self.boxes.iter().enumerate() {
            let at = placed.translation.as_vec3();
            let there = Aabb::new(shape.min + at, shape.max + at);
            let layer = if i % 2 == 0 { Layer::Fixed } else { Layer::Moving };
            match i % 3 {
                0 => {
                    let mesh = Arc::new(box_mesh(shape));
                    let instance = casca::Instance::new(mesh, placed.as_affine3a()).unwrap();
                    grid.insert(instance, layer).unwrap()
                }
                1 => grid.insert(Arc::new(box_mesh(&there)), layer).unwrap(),
                _ => grid.insert(there, layer).unwrap(),
            };
        }
        for ball in &self.balls {
            grid.insert(*ball, Layer::Fixed).unwrap();
        }
        grid.rebuild();
        grid
    }

    /// Whether a segment meets anything.
    fn meets(&self, from: DVec3, to: DVec3) -> bool {
        let in_box = |(shape, placed): &(Aabb, DAffine3)| {
            let back = placed.inverse();
            let (from, to) = (back.transform_point3(from), back.transform_point3(to));
            let (min, max) = (shape.min.as_dvec3(), shape.max.as_dvec3());
            let (a, b) = ((min - from) / (to - from), (max - from) / (to - from));
            a.min(b).max_element().max(0.0) <= a.max(b).min_element().min(1.0)
        };
        let in_ball = |ball: &Sphere| {
            let (center, way) = (ball.center.as_dvec3(), to - from);
            let t = ((center - from).dot(way) / way.length_squared()).clamp(0.0, 1.0);
            (from + way * t).distance(center) <= f64::from(ball.radius)
        };
        self.boxes.iter().any(in_box) || self.balls.iter().any(in_ball)
    }

    /// How far a point is from everything.
    fn distance(&self, point: Vec3) -> f32 {
        let to_box = |(shape, placed): &(Aabb, DAffine3)| {
            let p = placed.inverse().transform_point3(point.as_dvec3()).as_vec3();
            p.clamp(shape.min, shape.max).distance(p)
        };
        let to_ball = |ball: &Sphere| ball.center.distance(point) - ball.radius;
        self.boxes.iter().map(to_box).chain(self.balls.iter().map(to_ball)).fold(f32::INFINITY, f32::min)
    }

    /// The share of a ball that an eye sees: random points of the disc that the eye sees of it.
    fn seen(&self, eye: Vec3, ball: &Sphere, dice: &mut Dice) -> f32 {
        let (eye, center, radius) = (eye.as_dvec3(), ball.center.as_dvec3(), f64::from(ball.radius));
        let way = center - eye;
        let (right, up) = (way / way.length()).any_orthonormal_pair();
        let least = (1.0 - radius * radius / way.length_squared()).sqrt();
        let open = (0..TRUE_RAYS).filter(|_| {
            let (cosine, turn) = (
                1.0 - (1.0 - least) * f64::from(dice.next()),
                std::f64::consts::TAU * f64::from(dice.next()),
            );
            let aside = (right * turn.cos() + up * turn.sin()) * (1.0 - cosine * cosine).sqrt();
            let direction = way / way.length() * cosine + aside;
            let middle = way.dot(direction);
            let half = (radius * radius - way.length_squared() + middle * middle).max(0.0).sqrt();
            !self.meets(eye, eye + direction * (middle - half))
        });
        open.count() as f32 / TRUE_RAYS as f32
    }
}

#[test]
fn the_truth_lies_between_the_bounds() {
    let (mut partial, mut errors) = (0, [[0.0f32; 2]; 3]);
    for seed in 0..6 {
        let mut dice = Dice(seed);
        let things = Things::new(&mut dice);
        let grids = [2.0, 1.0, 0.5].map(|cell| things.grid(cell));
        let mut pairs = 0;
        while pairs < 20 {
            let (eye, ball) = (dice.point(1.0, 31.0), Sphere::new(dice.point(2.0, 30.0), 0.8));
            // Nothing in the cells of the eye and of the ball, which hide nothing.
            let free = things.distance(eye) > 3.5 && things.distance(ball.center) > 5.0;
            if !free || eye.distance(ball.center) < 14.0 {
                continue;
            }
            let truth = things.seen(eye, &ball, &mut dice);
            pairs += 1;
            partial += u32::from(truth > 0.1 && truth < 0.9);
            for (grid, error) in grids.iter().zip(&mut errors) {
                let seen = grid.visible_fraction(eye, ball, RAYS).unwrap();
                let VisibleFraction { least, most } = seen;
                assert!((0.0..=most).contains(&least) && most <= 1.0, "{seen:?}");
                assert!(least <= truth + NOISE && most >= truth - NOISE, "{seen:?} {truth} {eye} {ball:?}");
                assert!((seen.middle() - truth).abs() <= (most - least) * 0.5 + NOISE);
                *error = [error[0] + truth - least, error[1] + most - truth];
            }
        }
    }
    assert!(partial > 10, "{partial}");
    println!("sums of errors by cells of 2, 1 and 0.5: {errors:?}");
    // Both bounds come nearer with finer cells, and neither is idle.
    for bound in [0, 1] {
        assert!(errors[0][bound] > errors[1][bound] && errors[1][bound] > errors[2][bound], "{errors:?}");
    }
}

#[test]
fn small_things_behind_an_edge_may_be_seen_and_sheets_leave_a_doubt() {
    let mut grid = crate::soft(UVec3::splat(32));
    let (eye, ball) = (Vec3::new(16.2, 16.2, 2.5), Sphere::new(Vec3::new(16.6, 16.4, 28.5), 0.2));
    // A wall touches the cells on the way, but ends before the way.
    let wall = Aabb::new(Vec3::new(0.0, 0.0, 14.0), Vec3::new(16.1, 32.0, 18.0));
    let id = grid.insert(wall, Layer::Fixed).unwrap();
    grid.rebuild();
    let seen = |grid: &SoftGrid| grid.visible_fraction(eye, ball, 64).unwrap();
    assert_eq!(seen(&grid), VisibleFraction { least: 0.0, most: 1.0 });
    assert_eq!(seen(&grid).middle(), 0.5);
    // It fills the cells on the way.
    grid.update(id, Aabb::new(wall.min, Vec3::new(17.0, 32.0, 18.0))).unwrap();
    grid.rebuild();
    assert_eq!(seen(&grid), VisibleFraction { least: 0.0, most: 0.0 });
    // A closed mesh fills them, too, one without its lid does not.
    let mesh = box_mesh(&Aabb::new(wall.min, Vec3::new(18.5, 32.0, 18.0)));
    let open = TriMesh::bounds_only(mesh.positions().to_vec(), mesh.triangles()[2..].to_vec()).unwrap();
    for (mesh, most) in [(mesh, 0.0), (open, 1.0)] {
        grid.update(id, Arc::new(mesh)).unwrap();
        grid.rebuild();
        assert_eq!(seen(&grid), VisibleFraction { least: 0.0, most });
    }
    // What goes leaves the cells of another.
    let other = grid.insert(Aabb::new(Vec3::splat(13.0), Vec3::splat(20.0)), Layer::Moving).unwrap();
    grid.remove(id).unwrap();
    grid.rebuild();
    assert_eq!(seen(&grid), VisibleFraction { least: 0.0, most: 0.0 });
    grid.remove(other).unwrap();
    grid.rebuild();
    assert_eq!(seen(&grid), VisibleFraction { least: 1.0, most: 1.0 });
}
