//! Views of cameras that may go some way and turn by some angle. That their sets have all that any of
//! these cameras sees is what `tests/attack` tries.

use std::f32::consts::PI;

use crate::common::worlds::{SIZE, World, camera};
use crate::common::*;

/// A camera of a test: field of view, aspect, near and far distance.
#[derive(Debug, Clone, Copy)]
struct Lens {
    fov: f32,
    aspect: f32,
    near: f32,
    far: f32,
}

impl Lens {
    fn matrix(&self, eye: Vec3, rotation: Quat) -> Mat4 {
        let (forward, up) = (rotation * Vec3::NEG_Z, rotation * Vec3::Y);
        directx::perspective(self.fov, self.aspect, self.near, self.far) * look_to_mat4(eye, forward, up)
    }

    fn view(&self, eye: Vec3, rotation: Quat) -> View {
        View::perspective(eye, self.matrix(eye, rotation)).unwrap()
    }
}

/// A camera that looks along x from this eye.
const EYE: Vec3 = Vec3::new(4.0, 16.0, 16.0);
const LENS: Lens = Lens { fov: 1.0, aspect: 1.5, near: 0.1, far: 60.0 };

fn ahead() -> Quat {
    Quat::from_rotation_y(-PI / 2.0)
}

#[test]
fn a_result_holds_for_all_cameras_that_turn_so_far() {
    let wall = Aabb::new(Vec3::new(15.0, 2.0, 2.0), Vec3::new(17.0, 30.0, 30.0));
    let world = World::new(&[wall], &[Sphere::new(Vec3::new(24.0, 16.0, 16.0), 1.0)]);
    let wide = LENS.view(EYE, ahead()).with_reach(0.2).unwrap().with_turn(0.1).unwrap();
    let mut query = Query::new();
    let pvs = query.run(&world.scene, &wide);
    assert!(!pvs.contains(world.targets[0]), "the wall hides it");
    for axis in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE.normalize()] {
        for (angle, step, holds) in
            [(0.0, 0.0, true), (0.09, 0.0, true), (-0.09, 0.19, true), (0.09, 0.25, false), (0.4, 0.0, false)]
        {
            let turned = Quat::from_axis_angle(axis, angle) * ahead();
            let view = LENS.view(EYE + Vec3::Y * step, turned);
            assert_eq!(pvs.is_valid_for(&world.scene, &view), holds, "{axis} {angle} {step}");
        }
    }
    let zoomed = Lens { fov: 1.05, ..LENS };
    assert!(
        pvs.is_valid_for(&world.scene, &zoomed.view(EYE, ahead())),
        "wider than the view, not than the opened one"
    );
}

/// The near plane of the turned camera may cut an occluder that it does not cut before: that one
/// hides nothing.
#[test]
fn occluders_before_the_near_plane_of_a_turned_camera_hide_nothing() {
    // 1.05 before the eye: beyond the near plane, but not where the corners of the near rectangle
    // turn to.
    let wall = Aabb::new(EYE + Vec3::new(1.05, -9.0, -9.0), EYE + Vec3::new(2.0, 9.0, 9.0));
    let world = World::new(&[wall], &[Sphere::new(EYE + Vec3::X * 9.0, 1.0)]);
    let view = Lens { near: 1.0, ..LENS }.view(EYE, ahead());
    let mut query = Query::new();
    for (angle, seen) in [(0.0, false), (0.3, true)] {
        let pvs = query.run(&world.scene, &view.clone().with_turn(angle).unwrap());
        assert_eq!(pvs.contains(world.targets[0]), seen, "{angle}");
    }
}

/// The radius of targets that show where a view ends: a hundredth of the angle by which it is
/// turned, seen from so far.
const SPECK: f32 = 1e-3;

#[test]
fn an_opened_view_is_little_larger_than_the_turns_of_the_camera() {
    let view = LENS.view(EYE, ahead());
    let sees = |view: &View, d: Vec3| {
        let world = World::new(&[], &[Sphere::new(EYE + d * 10.0, SPECK)]);
        query_by(Method::Frustum).run(&world.scene, view).contains(world.targets[0])
    };
    let half_wide = (0.5f32.tan() * LENS.aspect).atan();
    let ray = |angle: f32| Quat::from_rotation_y(-angle) * Vec3::X;
    for angle in [0.02f32, 0.1, 0.3] {
        let opened = view.clone().with_turn(angle).unwrap();
        assert!(sees(&opened, ray(half_wide + angle * 0.99)) && !sees(&view, ray(half_wide + angle * 0.99)));
        // The side's edge is 2 atan(tan(0.5) cos(half_wide)) long.
        let extent = (0.5f32.tan() * half_wide.cos()).atan();
        let tilt = (angle.sin() / extent.cos()).asin();
        assert!(!sees(&opened, ray(half_wide + tilt + 2e-3)), "{angle}");
    }
}

#[test]
fn turns_and_reaches_replace_each_other() {
    let view = LENS.view(EYE, ahead()).with_layers(5);
    let both = view.clone().with_reach(0.5).unwrap().with_turn(0.2).unwrap();
    assert_eq!(view.clone().with_turn(0.2).unwrap().with_reach(0.5).unwrap(), both);
    assert_eq!(both.clone().with_turn(0.7).unwrap().with_turn(0.2).unwrap(), both);
    assert_eq!(both.clone().with_turn(0.0).unwrap(), view.clone().with_reach(0.5).unwrap());
    assert_eq!(view.clone().with_turn(0.0).unwrap(), view);
    assert!((both.turn() - 0.2).abs() < 1e-6 && both.reach() == 0.5 && both.layers() == 5);
    assert_eq!(both.with_layers(2).with_turn(0.0).unwrap().layers(), 2);
    for bad in [f32::NAN, f32::INFINITY, -0.1] {
        assert!(view.clone().with_turn(bad).is_err(), "{bad}");
    }
    let sun = directx::orthographic(-9.0, 9.0, -9.0, 9.0, 0.1, 50.0) * look_to_mat4(EYE, Vec3::X, Vec3::Y);
    let sun = View::orthographic(Vec3::X, sun).unwrap();
    assert_eq!(sun.clone().with_turn(0.1), Err(Error::ParallelTurn));
    assert_eq!(sun.clone().with_turn(0.0), Ok(sun));
}

#[test]
fn views_of_planes_turn_about_those_through_the_eye() {
    let world =
        World::new(&[], &[Sphere::new(Vec3::splat(SIZE - 1.0), 0.1), Sphere::new(Vec3::splat(1.0), 0.1)]);
    let eye = Vec3::splat(SIZE * 0.5);
    let mut query = Query::new();
    let mut seen = |planes: &[Plane], angle: f32| {
        let view = View::from_planes(eye, planes).unwrap().with_turn(angle).unwrap();
        let pvs = query.run(&world.scene, &view);
        [0, 1].map(|i| pvs.contains(world.targets[i]))
    };
    // A camera along z sees neither corner, one that turns by a right angle both.
    let planes = camera(eye, 2, 0.5);
    assert_eq!(seen(&planes, 0.0), [false, false]);
    assert_eq!(seen(&planes, 0.5), [true, false]);
    assert_eq!(seen(&planes, 1.6), [true, true]);
    // Fewer planes than a pyramid has: all round.
    assert_eq!(seen(&planes[1..3], 0.01), [true, true]);
    assert_eq!(seen(&[], 0.01), [true, true]);
}
