//! Eyes given with a matrix: the matrix's own is taken however it was computed, another is refused,
//! and what lies between them loses nothing that is visible.

use glam::DMat3;
use glam::camera::{lh, rh};

use crate::common::worlds::cuts_box;
use crate::common::*;

/// Projections of every kind, for one lens.
fn lenses(random: &mut Random) -> Vec<(&'static str, Mat4)> {
    let fov = (random.power(-2.0, 2.2528).min(179.0) as f32).to_radians();
    let (near, aspect) = (random.power(-3.0, 1.0) as f32, random.within(0.5, 2.0) as f32);
    let far = near * random.power(1.0, 6.0) as f32;
    let (l, r) = (random.within(-2.0, 0.5) as f32 * near, random.within(0.6, 2.0) as f32 * near);
    let jitter = Mat4::from_translation(Vec3::new(random.next() as f32, random.next() as f32, 0.0) * 1e-3);
    vec![
        ("rh", rh::proj::directx::perspective(fov, aspect, near, far)),
        ("lh", lh::proj::directx::perspective(fov, aspect, near, far)),
        ("reversed", rh::proj::directx::perspective(fov, aspect, far, near)),
        ("rh infinite", rh::proj::directx::perspective_infinite(fov, aspect, near)),
        ("lh infinite", lh::proj::directx::perspective_infinite(fov, aspect, near)),
        ("rh infinite reversed", rh::proj::directx::perspective_infinite_reverse(fov, aspect, near)),
        ("lh infinite reversed", lh::proj::directx::perspective_infinite_reverse(fov, aspect, near)),
        ("vulkan", rh::proj::vulkan::perspective(fov, aspect, near, far)),
        ("rh opengl", rh::proj::opengl::perspective(fov, aspect, near, far)),
        ("lh opengl", lh::proj::opengl::perspective(fov, aspect, near, far)),
        ("off centre", rh::proj::directx::frustum(l, r, l * 0.3, r * 1.7, near, far)),
        ("jittered", jitter * rh::proj::directx::perspective(fov, aspect, near, far)),
        (
            "mirrored",
            Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0))
                * rh::proj::directx::perspective(fov, aspect, near, far),
        ),
    ]
}

/// View matrices, as programs compute them, with the eye that they know.
fn rigs(random: &mut Random) -> Vec<(&'static str, Vec3, Mat4, DMat4)> {
    let eye = (random.direction() * random.power(-3.0, 7.0)).as_vec3();
    let forward = random.direction().as_vec3().normalize();
    let up = forward.any_orthonormal_vector();
    let turn = Quat::from_euler(
        EulerRot::XYZ,
        random.within(-3.0, 3.0) as f32,
        random.within(-3.0, 3.0) as f32,
        random.within(-3.0, 3.0) as f32,
    );
    let exact = |turn: DQuat, eye: Vec3| DMat4::from_quat(turn) * DMat4::from_translation(-eye.as_dvec3());
    let plain = exact(turn.as_dquat().normalize(), eye);
    let rotation = Mat4::from_quat(turn);
    let mut rigs = vec![
        ("look_to", eye, rh::view::look_to_mat4(eye, forward, up), plain),
        ("look_to lh", eye, lh::view::look_to_mat4(eye, forward, up), plain),
        ("inverse", eye, Mat4::from_rotation_translation(turn, eye).inverse(), plain),
        ("product", eye, rotation * Mat4::from_translation(-eye), plain),
    ];
    // The world scaled or sheared below the camera.
    for (name, below) in [
        (
            "scaled",
            Mat4::from_scale(Vec3::new(random.power(-2.0, 2.0) as f32, 1.0, random.power(-1.0, 1.0) as f32)),
        ),
        (
            "sheared",
            Mat4::from_cols_array(&[
                1.0, 0.5, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.7, -0.3, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
            ]),
        ),
    ] {
        let own = below.as_dmat4().inverse().transform_point3(eye.as_dvec3()).as_vec3();
        rigs.push((name, own, rh::view::look_to_mat4(eye, forward, up) * below, plain * below.as_dmat4()));
    }
    // Around a target: the eye may come near the origin, which the products do not.
    let (target, radius) = ((random.direction() * 100.0).as_vec3(), random.within(20.0, 120.0) as f32);
    let back = Vec3::new(0.0, 0.0, radius);
    let own = target + turn.inverse() * back;
    let orbit = Mat4::from_translation(-back) * rotation * Mat4::from_translation(-target);
    rigs.push(("orbit", own, orbit, exact(turn.as_dquat().normalize(), own)));
    rigs
}

#[test]
fn the_eye_of_a_matrix_is_never_refused() {
    let mut random = Random(21);
    let mut asked = 0;
    for _ in 0..1500 {
        let lenses = lenses(&mut random);
        for (rig, eye, view, exact) in rigs(&mut random) {
            for &(lens, p) in &lenses {
                let rounded = (p.as_dmat4() * exact).as_mat4();
                for (how, m) in [("single", p * view), ("rounded", rounded)] {
                    if how == "rounded" && matches!(rig, "scaled" | "sheared") && eye.length() > 1e6 {
                        continue;
                    }
                    asked += 1;
                    let made = View::perspective(eye, m);
                    assert!(made.is_ok(), "{rig} {lens} {how}: {} for {m}", made.unwrap_err());
                }
            }
        }
        // The other grouping: the projection times the rotation first.
        let eye = (random.direction() * random.power(-3.0, 7.0)).as_vec3();
        let turn =
            Mat4::from_axis_angle(random.direction().as_vec3().normalize(), random.within(-3.0, 3.0) as f32);
        for &(lens, p) in &lenses {
            let m = (p * turn) * Mat4::from_translation(-eye);
            let made = View::perspective(eye, m);
            assert!(made.is_ok(), "grouped {lens}: {}", made.unwrap_err());
        }
    }
    assert!(asked > 100_000);
}

#[test]
fn another_eye_is_refused_with_its_distance() {
    let mut random = Random(22);
    for _ in 0..300 {
        let eye = random.direction() * random.power(-2.0, 5.0);
        let p = rh::proj::directx::perspective(1.5, 1.5, 0.1, 200.0);
        let m = p * rh::view::look_to_mat4(
            eye.as_vec3(),
            random.direction().as_vec3().normalize(),
            Vec3::new(0.1, 0.9, 0.2),
        );
        let step = 2e-5 * (eye.length() + 200.0);
        let other = (eye + random.direction() * step * random.within(1.0, 50.0)).as_vec3();
        let Err(error) = View::perspective(other, m) else { panic!("{other} for {eye}") };
        let Error::EyeMismatch { given, found, off, allowed } = error else { panic!("{error}") };
        assert_eq!(given, other.as_dvec3());
        assert!((found - eye).length() <= 1e-5 * (eye.length() + 1.0), "{found} {eye}");
        let apart = (other.as_dvec3() - eye).length();
        assert!(allowed < off && off <= 1.01 * apart && off >= 0.5 * apart, "{off} {allowed} {apart}");
        assert!(error.to_string().contains("world units"), "{error}");
    }
}

/// The point that a matrix takes to x = y = w = 0.
fn eye_of(m: Mat4) -> DVec3 {
    let rows = [0, 1, 3].map(|i| m.as_dmat4().row(i));
    let a = DMat3::from_cols(rows[0].truncate(), rows[1].truncate(), rows[2].truncate()).transpose();
    a.inverse() * -DVec3::new(rows[0].w, rows[1].w, rows[2].w)
}

#[test]
fn eyes_apart_by_what_is_accepted_lose_nothing() {
    let mut random = Random(23);
    let (mut clear, mut hidden) = (0, 0);
    for reach in [1e3, 1e4, 1e5] {
        for round in 0..120 {
            let eye = (random.direction() * reach).as_vec3();
            let at = eye.as_dvec3();
            // In every third round as much as single precision explains, else up to half as much
            // again.
            let most = 2.0 * 2f64.powi(-20) * at.length();
            let apart = DVec3::Y * most * if round % 3 == 0 { random.within(0.0, 0.9) } else { 1.5 };
            let apart = if round % 2 == 0 { apart } else { -apart };
            let view = DMat4::from_quat(DQuat::from_rotation_y(0.5 * std::f64::consts::PI))
                * DMat4::from_translation(-(at + apart));
            let p = rh::proj::directx::perspective(1.2, 1.0, 0.1, 60.0);
            let m = (p.as_dmat4() * view).as_mat4();
            let given = View::perspective(eye, m).unwrap();
            let own = eye_of(m);
            let edge = (at.y + random.within(-1.0, 1.0)) as f32;
            let wall = if round % 2 == 0 { (eye.y - 20.0, edge) } else { (edge, eye.y + 20.0) };
            let wall = Aabb::new(
                Vec3::new(eye.x + 10.0, wall.0, eye.z - 20.0),
                Vec3::new(eye.x + 11.0, wall.1, eye.z + 20.0),
            );
            let mut scene = Scene::new(2.0).unwrap();
            scene.solid(wall);
            let mut aimed = Vec::new();
            for i in 0..24 {
                // Points behind the edge, and at the sides of the view, as this eye or that sees
                // them.
                let from = if i % 2 == 0 { own } else { at };
                let sharp = if i % 3 == 0 {
                    f64::from(edge)
                } else {
                    from.y + 10.0 * 0.684 * if i % 4 < 2 { 1.0 } else { -1.0 }
                };
                let through = DVec3::new(
                    at.x + 10.5,
                    sharp + random.within(-1.0, 1.0) * most,
                    at.z + random.within(-3.0, 3.0),
                );
                let p = (from + (through - from) * random.within(1.5, 3.0)).as_vec3();
                let q = p.as_dvec3();
                let clip = m.as_dmat4() * q.extend(1.0);
                let in_view =
                    clip.x.abs() <= clip.w && clip.y.abs() <= clip.w && clip.z >= 0.0 && clip.z <= clip.w;
                let id = scene.fixed(Sphere::new(p, 0.0));
                // Beyond what rounding explains, neither eye is the true one for sure.
                let seen = !cuts_box(&wall, at, q) || round % 3 != 0 && !cuts_box(&wall, own, q);
                aimed.push((id, p, in_view && seen));
            }
            let mut query = Query::new();
            let pvs = query.run(&scene, &given);
            for (id, p, seen) in aimed {
                clear += usize::from(seen);
                hidden += usize::from(!pvs.contains(id));
                assert!(!seen || pvs.contains(id), "{p} is lost from {eye}, matrix {own}");
            }
        }
    }
    assert!(clear > 2000 && hidden > 500, "{clear} {hidden}");
}

#[test]
fn perspectives_far_from_the_origin_have_an_eye() {
    for reach in [1e5f32, 1e7, 1e9, 1e12] {
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            let eye = axis * reach;
            let up = axis.any_orthonormal_vector();
            for forward in [axis, -axis] {
                for p in [
                    rh::proj::directx::perspective_infinite_reverse(1.0, 1.5, 0.1),
                    rh::proj::directx::perspective(1.0, 1.5, 0.1, 100.0),
                ] {
                    let m = p * rh::view::look_to_mat4(eye, forward, up);
                    let view = View::from_view_projection(m).unwrap();
                    assert!(
                        view.eye()
                            .is_some_and(|at| (at - eye.as_dvec3()).length() <= 1e-5 * f64::from(reach))
                    );
                    assert!(View::perspective(eye, m).is_ok());
                }
            }
        }
    }
    for turn in [Quat::IDENTITY, Quat::from_rotation_x(0.7)] {
        let p = rh::proj::directx::orthographic(-1e4, 1e4, -1e-2, 1e-2, 0.1, 1e5);
        let v = Mat4::from_rotation_translation(turn, Vec3::splat(1e6)).inverse();
        assert!(View::from_view_projection(p * v).unwrap().eye().is_none());
        assert!(matches!(View::perspective(Vec3::splat(1e6), p * v), Err(Error::Matrix(_))));
    }
}
