//! Questions to the last run of a query. That nothing that a segment reaches is denied is what
//! `tests/attack` tries.

use crate::common::worlds::cuts_box;
use crate::common::*;

fn scene(occluders: &[Aabb]) -> Scene {
    let mut scene = empty();
    occluders.iter().for_each(|&b| _ = scene.solid(b));
    scene
}

/// A wall across the grid, and an eye before it.
fn wall() -> (Aabb, Vec3) {
    (Aabb::new(Vec3::new(1.0, 1.0, 15.0), Vec3::new(31.0, 31.0, 17.0)), Vec3::new(16.0, 16.0, 10.0))
}

#[test]
fn a_wall_hides_nearly_all_behind_it() {
    let (wall, eye) = wall();
    let scene = scene(&[wall]);
    let mut query = Query::new();
    query.run(&scene, &around(eye));
    let sight = query.sight(&scene).unwrap();
    let mut hidden = 0;
    for i in 0..1000 {
        let p =
            Vec3::new(1.0 + 3.0 * (i % 10) as f32, 1.0 + 3.0 * (i / 10 % 10) as f32, 18.0 + (i / 100) as f32);
        let behind = cuts_box(&wall, eye.as_dvec3(), p.as_dvec3());
        assert!(behind || sight.may_see_point(p));
        hidden += u32::from(behind && !sight.may_see_point(p));
        let (block, ball) = (Aabb::from_center(p, Vec3::splat(1.5)), Sphere::new(p, 1.5));
        assert!(
            sight.may_see_box(&block) || !sight.may_see_bounds(&ball.into()),
            "{p}: it is in a hidden box"
        );
    }
    assert!(hidden > 900, "{hidden}");
    assert!(!sight.may_see_bounds(&Sphere::new(Vec3::new(16.0, 16.0, 22.0), 3.0).into()));
}

#[test]
fn doubt_means_visible() {
    let (wall, eye) = wall();
    let mut scene = scene(&[wall]);
    let behind = Vec3::new(16.0, 16.0, 24.0);
    assert!(Query::new().sight(&scene).is_none(), "there was no run");
    for method in [Method::Frustum, Method::cell()] {
        let mut query = query_by(method);
        query.run(&scene, &around(eye));
        let sight = query.sight(&scene).unwrap();
        assert!(!sight.has_occlusion() && sight.may_see_point(behind), "{method:?}");
    }
    let mut query = Query::new();
    query.run(&scene, &around(eye));
    let sight = query.sight(&scene).unwrap();
    assert!(!sight.may_see_point(behind));
    for bad in [Vec3::NAN, Vec3::INFINITY, Vec3::new(16.0, f32::NAN, 24.0)] {
        assert!(sight.may_see_point(bad) && sight.may_see_box(&Aabb::new(behind, bad)));
    }
    let inverted = Aabb { min: behind + 1.0, max: behind };
    assert!(sight.may_see_box(&inverted) && sight.may_see_bounds(&inverted.into()), "it is inverted");
    for bad in [Sphere::new(Vec3::NAN, 1.0), Sphere::new(behind, f32::NAN), Sphere::new(behind, -1.0)] {
        assert!(sight.may_see_bounds(&bad.into()), "{bad:?}");
    }
    // What moved may have opened the view.
    scene.fixed(Sphere::new(eye + 3.0, 1.0));
    let sight = query.sight(&scene).unwrap();
    assert!(!sight.has_occlusion() && sight.may_see_point(behind));
}

/// Boxes beyond the objects and the grid of a scene, seen along parallel rays.
#[test]
fn parallel_rays_beyond_the_scene_are_free() {
    let scene = empty();
    let look = look_to_mat4(Vec3::new(16.0, 16.0, -20.0), Vec3::Z, Vec3::Y);
    let matrix = directx::orthographic(-100.0, 100.0, -100.0, 100.0, 0.1, 80.0) * look;
    let mut query = Query::new();
    query.run(&scene, &View::orthographic(Vec3::Z, matrix).unwrap());
    let sight = query.sight(&scene).unwrap();
    for x in [16.0, 40.0, 44.5, 60.0, -50.0] {
        let at = Vec3::new(x, 16.0, 16.0);
        assert!(sight.may_see_point(at) && sight.may_see_bounds(&Sphere::new(at, 1.0).into()), "{x}");
    }
}
