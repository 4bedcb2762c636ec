//! Point and spot lights on small scenes.

use crate::common::*;
use crate::scenes::{ahead, solid};

const LAMP: Vec3 = Vec3::new(32.0, 10.0, 36.0);

fn casters(scene: &Scene, light: &Light) -> Vec<ObjectId> {
    let mut camera = Query::new();
    camera.run(scene, &ahead());
    let [point, cell, frustum] = [Method::point(), Method::cell(), Method::Frustum].map(|method| {
        let mut out = Vec::new();
        query_by(method).shadow_casters(scene, &camera, light, &mut out).unwrap();
        out
    });
    // The others only miss that some casters stand in the shadow of others.
    assert!(
        point.iter().all(|id| cell.contains(id) && frustum.contains(id)),
        "{point:?} {cell:?} {frustum:?}"
    );
    point
}

fn bulb(range: f32) -> Light {
    Light::point(LAMP, range)
}

/// The camera of a shadow map that looks straight down from the lamp.
fn downwards(near: f32) -> Mat4 {
    directx::perspective(0.5, 1.0, near, 60.0) * look_to_mat4(LAMP, Vec3::NEG_Y, Vec3::Z)
}

fn ball(scene: &mut Scene, at: [f32; 3], radius: f32) -> ObjectId {
    let ball = Sphere::new(at.into(), radius);
    scene.solid(ball)
}

#[test]
fn a_lamp_has_the_casters_between_it_and_what_is_seen() {
    let mut scene = empty();
    let ground = solid(&mut scene, [0.0, 0.0, 0.0], [64.0, 1.0, 64.0]);
    let below = ball(&mut scene, [32.0, 8.0, 36.0], 0.5);
    let above = ball(&mut scene, [32.0, 12.0, 36.0], 0.5);
    // Its shadow falls behind the camera.
    let behind = ball(&mut scene, [32.0, 5.0, 52.0], 0.5);
    // Their shadows fall far from the lamp: before the camera, and far beside its view.
    let far = ball(&mut scene, [32.0, 4.0, 26.0], 0.5);
    let beside = ball(&mut scene, [48.0, 6.0, 36.0], 0.5);
    let shaded = ball(&mut scene, [32.0, 5.0, 36.0], 0.3);
    for range in [60.0, f32::INFINITY] {
        let found = casters(&scene, &bulb(range));
        for (id, expected) in [
            (ground, true),
            (below, true),
            (above, false),
            (behind, false),
            (far, true),
            (beside, false),
            (shaded, false),
        ] {
            assert_eq!(found.contains(&id), expected, "{id} of {found:?}, range {range}");
        }
    }
    let found = casters(&scene, &bulb(10.0));
    assert!(found.contains(&ground) && found.contains(&below) && !found.contains(&far), "{found:?}");
    // The ground is out of reach, and so its shadows are.
    assert!(!casters(&scene, &bulb(8.0)).contains(&ground));
    assert!(casters(&scene, &bulb(0.0)).is_empty());
}

#[test]
fn a_spot_light_has_the_casters_inside_its_view() {
    let mut scene = empty();
    let ground = solid(&mut scene, [0.0, 0.0, 0.0], [64.0, 1.0, 64.0]);
    let below = ball(&mut scene, [32.0, 6.0, 36.0], 0.4);
    let beside = ball(&mut scene, [36.0, 6.0, 36.0], 0.4);
    for (near, lit) in [(0.1, true), (6.0, false)] {
        for view in [View::perspective(LAMP, downwards(near)), View::from_view_projection(downwards(near))] {
            let found = casters(&scene, &Light::spot(view.unwrap()));
            assert!(found.contains(&ground) && !found.contains(&beside), "{found:?}");
            assert_eq!(found.contains(&below), lit, "before the near plane of the shadow map: {near}");
        }
    }
    let flat = |far| {
        let matrix = directx::orthographic(-2.0, 2.0, -2.0, 2.0, 0.0, far);
        matrix * look_to_mat4(LAMP, Vec3::NEG_Y, Vec3::Z)
    };
    // Of the last it is not known at which end its rays start.
    for view in [View::orthographic(Vec3::NEG_Y, flat(20.0)), View::from_view_projection(flat(20.0))] {
        let found = casters(&scene, &Light::spot(view.unwrap()));
        assert!(found.contains(&ground) && found.contains(&below) && !found.contains(&beside), "{found:?}");
    }
    let found = casters(&scene, &Light::spot(View::orthographic(Vec3::NEG_Y, flat(3.0)).unwrap()));
    assert!(found.is_empty(), "it ends above all that is seen: {found:?}");
}

#[test]
fn a_lamp_shines_out_of_the_occluder_around_it() {
    let mut scene = empty();
    let ground = solid(&mut scene, [0.0, 0.0, 0.0], [64.0, 1.0, 64.0]);
    let shade = ball(&mut scene, LAMP.to_array(), 0.5);
    let below = ball(&mut scene, [32.0, 6.0, 36.0], 0.4);
    let found = casters(&scene, &bulb(60.0));
    assert!([ground, shade, below].iter().all(|id| found.contains(id)), "{found:?}");
}

#[test]
fn lights_that_make_no_sense_are_refused() {
    let mut scene = empty();
    solid(&mut scene, [0.0, 0.0, 0.0], [64.0, 1.0, 64.0]);
    let (mut camera, mut lamp, mut out) = (Query::new(), Query::new(), Vec::new());
    assert_eq!(lamp.shadow_casters(&scene, &camera, &bulb(1.0), &mut out), Err(Error::ForeignPvs));
    camera.run(&scene, &ahead());
    for range in [-1.0, f32::NAN, f32::NEG_INFINITY] {
        let refused = lamp.shadow_casters(&scene, &camera, &bulb(range), &mut out).unwrap_err();
        assert!(refused.to_string().contains("range of the light"), "{refused}");
    }
    for position in [Vec3::NAN, Vec3::X * f32::INFINITY] {
        let light = Light::point(position, 1.0);
        let refused = lamp.shadow_casters(&scene, &camera, &light, &mut out).unwrap_err();
        assert!(refused.to_string().contains("position of the light"), "{refused}");
    }
    // Far away, it is taken.
    for far in [1e6, 1e20, f32::MAX] {
        let light = Light::point(Vec3::Y * far, f32::MAX);
        lamp.shadow_casters(&scene, &camera, &light, &mut out).unwrap();
        assert_eq!(out, camera.pvs().visible(), "{far}");
    }
}
