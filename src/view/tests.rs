//! Views against points, and against each other.

use glam::camera::rh::{proj::directx, view::look_to_mat4};
use glam::{DMat3, DVec3, Mat4, Vec3};

use crate::error::Error;
use crate::geometry::plane::HalfSpace;
use crate::geometry::{Block, Plane};
use crate::random::Random;
use crate::view::{Origin, View};

fn camera(eye: Vec3, p: Mat4) -> Mat4 {
    p * look_to_mat4(eye, Vec3::new(0.3, -0.2, -1.0).normalize(), Vec3::Y)
}

#[test]
fn finds_the_eye_of_every_perspective() {
    for eye in [Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0), Vec3::new(-500.0, 80.0, 1e5)] {
        for p in [
            directx::perspective(1.0, 1.5, 0.1, 100.0),
            directx::perspective_infinite(2.5, 0.7, 0.1),
            directx::perspective_infinite_reverse(0.03, 1.0, 0.1),
        ] {
            let view = View::from_view_projection(camera(eye, p)).unwrap();
            let Origin::Eye { at, error } = view.origin else { panic!() };
            let off = (at - eye.as_dvec3()).abs().max_element();
            assert!(off <= error + 1e-12, "{eye} {off} {error}");
            assert!(error <= 2e-4 * f64::from(eye.length()) + 1e-12, "{eye} {error}");
        }
    }
}

#[test]
fn planes_bound_the_clip_volume() {
    let eye = Vec3::new(4.0, 5.0, 6.0);
    for (p, planes) in [
        (directx::perspective(1.0, 1.5, 0.1, 100.0), 6),
        (directx::perspective(1.0, 1.5, 100.0, 0.1), 6),
        (directx::perspective_infinite(1.0, 1.5, 0.1), 5),
        (directx::perspective_infinite_reverse(1.0, 1.5, 0.1), 5),
        (directx::orthographic(-3.0, 4.0, -2.0, 5.0, 0.1, 50.0), 6),
    ] {
        let m = camera(eye, p);
        let view = View::from_view_projection(m).unwrap();
        assert_eq!(view.planes.len(), planes);
        let mut random = Random::new(3);
        let mut next = || random.within(-60.0, 60.0);
        for _ in 0..2000 {
            let q = eye.as_dvec3() + DVec3::new(next(), next(), next());
            let c = m.as_dmat4() * q.extend(1.0);
            let clip = c.x.abs() <= c.w && c.y.abs() <= c.w && c.z >= 0.0 && c.z <= c.w;
            let inside = view.planes.iter().all(|h| h.distance(q) >= 0.0);
            assert!(inside || !clip, "{q}");
            let barely = view.planes.iter().all(|h| h.distance(q) >= 1e-4);
            assert!(clip || !barely, "{q}");
        }
    }
}

#[test]
fn orthographic_rays_run_away_from_the_camera() {
    let m = camera(Vec3::ONE, directx::orthographic(-3.0, 4.0, -2.0, 5.0, 0.1, 50.0));
    let View { origin: Origin::Direction(d), .. } = View::from_view_projection(m).unwrap() else { panic!() };
    assert!((d - DVec3::new(0.3, -0.2, -1.0).normalize()).length() < 1e-6);
    assert!(matches!(View::perspective(Vec3::ONE, m), Err(Error::Matrix(_))));
}

#[test]
fn refuses_what_is_no_camera() {
    for m in [Mat4::ZERO, Mat4::NAN, Mat4::from_scale(Vec3::new(1.0, 0.0, 1.0))] {
        assert!(View::from_view_projection(m).is_err(), "{m}");
    }
    assert!(View::omnidirectional(Vec3::INFINITY).is_err());
    let flat = Plane { normal: Vec3::ZERO, offset: 1.0 };
    assert_eq!(View::from_planes(Vec3::ZERO, &[flat]), Err(Error::Plane(0)));
    let up = Plane { normal: Vec3::Y, offset: 1.0 };
    assert!(View::from_planes(Vec3::ZERO, &[up; 33]).is_err());
}

#[test]
fn a_narrower_view_is_held_and_a_turned_one_is_not() {
    let view = |fov: f32, near: f32, dir: Vec3| {
        let m = directx::perspective(fov, 1.5, near, 100.0) * look_to_mat4(Vec3::ZERO, dir, Vec3::Y);
        View::perspective(Vec3::ZERO, m).unwrap()
    };
    let (wide, narrow) = (view(1.2, 0.1, Vec3::NEG_Z), view(0.8, 0.2, Vec3::new(0.1, 0.0, -1.0).normalize()));
    let (min, max) = (DVec3::splat(-50.0), DVec3::splat(50.0));
    assert!(wide.contains(&wide, min, max) && wide.contains(&narrow, min, max));
    assert!(!narrow.contains(&wide, min, max));
    assert!(!wide.contains(&view(0.8, 0.2, Vec3::X), min, max));
    let around = View::omnidirectional(Vec3::ZERO).unwrap();
    assert!(around.contains(&wide, min, max) && !wide.contains(&around, min, max));
}

/// Three planes so nearly parallel that their normals span no volume worth the name still meet in a
/// corner.
#[test]
fn corners_of_nearly_parallel_planes_count() {
    let (min, max) = (DVec3::splat(-1.0), DVec3::ONE);
    for tilt in [1e-1f32, 1e-3, 1e-5, 1e-7, 1e-9] {
        // A tent: y <= tilt (1 - ...) on three sides.
        let side = |x: f32, z: f32| Plane { normal: Vec3::new(-x * tilt, -1.0, -z * tilt), offset: tilt };
        let tent = [side(1.0, 0.5), side(-1.0, 0.5), side(0.0, -1.0)];
        let tent = View::from_planes(Vec3::new(0.0, -0.9, 0.0), &tent).unwrap();
        let below = |h: f32| {
            let plane = Plane { normal: Vec3::NEG_Y, offset: h * tilt };
            View::from_planes(Vec3::new(0.0, -0.9, 0.0), &[plane]).unwrap()
        };
        let top = DVec3::new(0.0, 0.99 * f64::from(tilt), 0.0);
        assert!(tent.planes.iter().all(|p| p.distance(top) > 0.0));
        assert!(!below(0.9).contains(&tent, min, max), "{tilt}");
        assert!(below(1.1).contains(&tent, min, max) || tilt < 1e-8, "{tilt}");
        // As a near plane that cuts off the eye: the part that it cuts away reaches as far.
        let planes = tent.planes.iter().copied().chain([HalfSpace { normal: DVec3::NEG_Y, offset: -3.0 }]);
        let cut = View { planes: planes.collect(), cutting: 1 << 3, ..tent.clone() };
        let (region, block) = cut.cut_regions(min, max).next().unwrap();
        assert!(block.contains_point(top), "{tilt}");
        assert!(region.may_see_block(&Block { min: top, max: top }));
    }
}

/// All points that narrow and wide views see lie in the block around the view, and in views that
/// contain it.
#[test]
fn regions_hold_what_is_in_all_of_their_planes() {
    let mut random = Random::new(7);
    let mut next = || random.within(-1.0, 1.0);
    let mut held = 0;
    for round in 0..200 {
        let fov = [0.01f32, 0.1, 5.0, 170.0][round % 4].to_radians();
        let eye = Vec3::new(next() as f32, next() as f32, next() as f32) * 10f32.powi(round as i32 % 5);
        let dir = Vec3::new(next() as f32, next() as f32, -1.0).normalize();
        let view = |fov: f32| {
            let m = directx::perspective(fov, 1.5, 0.1, 1e3) * look_to_mat4(eye, dir, Vec3::Y);
            View::perspective(eye, m).unwrap()
        };
        let (own, wider) = (view(fov), view((fov * 1.02).min(3.1)));
        let (min, max) = (eye.as_dvec3() - 300.0, eye.as_dvec3() + 300.0);
        let corners = own.corners(min, max);
        let holds = wider.contains(&own, min, max);
        held += usize::from(holds);
        let (lo, hi) =
            corners.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |b, c| (b.0.min(*c), b.1.max(*c)));
        for _ in 0..300 {
            let across = DVec3::new(next(), next(), 0.0) * (f64::from(fov) * 0.5).tan().min(5.0);
            let d = DMat3::from_mat4(look_to_mat4(Vec3::ZERO, dir, Vec3::Y).as_dmat4()).transpose()
                * (across - DVec3::Z);
            let p = eye.as_dvec3() + d * (next().abs() * 280.0);
            let inside = p.cmpge(min).all() && p.cmple(max).all();
            if inside && own.planes.iter().all(|h| h.distance(p) >= 0.0) {
                assert!(lo.cmple(p).all() && p.cmple(hi).all(), "{p}");
                assert!(!holds || wider.planes.iter().all(|h| h.distance(p) >= 0.0), "{p}");
            }
        }
    }
    assert!(held > 20, "{held}");
}

/// An infinite far plane cuts off nothing, through however many products the matrix went.
#[test]
fn what_rounding_leaves_of_an_infinite_far_plane_cuts_off_nothing() {
    let flip = Mat4::from_cols_array(&[1., 0., 0., 0., 0., 1., 0., 0., 0., 0., -1., 0., 0., 0., 1., 1.]);
    let squeeze = Mat4::from_cols_array(&[1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 0.7, 0., 0., 0., 0.3, 1.]);
    let mut random = Random::new(9);
    let mut next = || random.within(-1.0, 1.0);
    for round in 0..600 {
        let eye = Vec3::new(next() as f32, next() as f32, next() as f32) * 10f32.powi(round % 6);
        let dir = Vec3::new(next() as f32, next() as f32, next() as f32 - 1.5).normalize();
        let world = Mat4::from_rotation_z(next() as f32) * Mat4::from_rotation_x(next() as f32);
        let p = directx::perspective_infinite(1.0, 1.5, 0.1);
        let p = [p, flip * p, squeeze * p, flip * (squeeze * p)][round as usize % 4];
        let own = world.as_dmat4().inverse().transform_point3(eye.as_dvec3());
        let m = p * look_to_mat4(eye, dir, Vec3::Y) * world;
        let view = View::from_view_projection(m).unwrap();
        let ahead = world.as_dmat4().inverse().transform_vector3(dir.as_dvec3());
        for far in [1.0, 1e2, 1e3, 1e4, 1e5] {
            let q = own + ahead * (far + 3e-6 * own.length());
            assert!(view.planes.iter().all(|h| h.distance(q) >= -1e-4 * far), "{round} {eye} {far}");
        }
    }
}
