//! The C face answers as the Rust calls that it stands for: sets of all methods, kept queries,
//! casters of shadows, boxes in sight, the plane.

// Some of the functions are safe to call, and go through the same macro.
#![allow(unused_unsafe)]

#[macro_use]
mod common;

use casca::glam::{Mat4, Vec3, Vec4};
use casca::{Aabb, KeptOptions, KeptQuery, Light, Method, ObjectDesc, Query, Scene, View};
use casca_c::*;

/// Corners of boxes, as a seed gives them: a small town.
fn boxes() -> Vec<Aabb> {
    let mut seed = 11u32;
    let mut next = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 / (1 << 24) as f32
    };
    let one = |_| {
        let (x, z) = (60.0 * next(), 60.0 * next());
        let size = Vec3::new(0.4 + 4.0 * next(), 0.5 + 9.0 * next(), 0.4 + 4.0 * next());
        let min = Vec3::new(x, 0.0, z);
        Aabb::new(min, min + size)
    };
    (0..500).map(one).collect()
}

/// The same objects on both sides, numbered by their user data.
struct Both {
    c: casca_scene,
    rust: Scene,
}

impl Both {
    fn new() -> Self {
        let mut grid = init!(casca_grid);
        (grid.max, grid.cell) = ([64.0, 16.0, 64.0], 1.0);
        let mut c = casca_scene { handle: 0 };
        ok!(casca_scene_create(&grid, &mut c));
        let mut rust = Scene::new(1.0).unwrap();
        for (number, b) in (0..).zip(boxes()) {
            let mut object = init!(casca_object);
            object.bounds.kind = CASCA_SHAPE_BOX;
            (object.bounds.min, object.bounds.max) = (b.min.to_array(), b.max.to_array());
            (object.occluder, object.user_data) = (object.bounds, number);
            let mut id = 0;
            ok!(casca_scene_add(c, &object, &mut id));
            rust.insert(ObjectDesc::fixed(b).occluder(b).user_data(number)).unwrap();
        }
        Self { c, rust }
    }

    /// The numbers of the objects that a query of C found last.
    fn found(&self, query: casca_query) -> Vec<u64> {
        let (mut ids, mut numbers, mut count) = (vec![0; 500], vec![0; 500], 0);
        ok!(casca_query_get_visible(query, ids.as_mut_ptr(), ids.len(), &mut count));
        ok!(casca_scene_get_user_data(self.c, ids.as_ptr(), count, numbers.as_mut_ptr()));
        numbers.truncate(count);
        numbers
    }

    fn numbers(&self, ids: impl Iterator<Item = casca::ObjectId>) -> Vec<u64> {
        ids.map(|id| self.rust.user_data(id).unwrap()).collect()
    }
}

fn query(method: u32, flags: u32) -> casca_query {
    let mut options = init!(casca_query_options);
    (options.method, options.flags, options.reach) = (method, flags, 0.5);
    let mut made = casca_query { handle: 0 };
    ok!(casca_query_create(&options, &mut made));
    made
}

/// A camera of both sides that walks.
fn camera(step: usize) -> (casca_view, View) {
    let eye = Vec3::new(30.0 + 0.07 * step as f32, 2.5, 40.0);
    let projection = Mat4::from_cols(Vec4::X * 0.974, Vec4::Y * 1.732, -Vec4::W, Vec4::Z * 0.1);
    let matrix = projection * Mat4::from_translation(-eye);
    let mut view = init!(casca_view);
    (view.eye, view.matrix) = (eye.to_array(), matrix.to_cols_array());
    (view, View::perspective(eye, matrix).unwrap())
}

#[test]
fn sets_are_the_same() {
    let both = Both::new();
    for (method, rust) in [
        (CASCA_METHOD_POINT, Method::point()),
        (CASCA_METHOD_CELL, Method::cell()),
        (CASCA_METHOD_FRUSTUM, Method::Frustum),
    ] {
        let (c, mut rust) = (query(method, 0), Query::with_method(rust).unwrap());
        for step in 0..10 {
            let (view, of_rust) = camera(7 * step);
            ok!(casca_query_run(c, both.c, &view, std::ptr::null_mut()));
            let expected = both.numbers(rust.run(&both.rust, &of_rust).iter());
            assert!(!expected.is_empty());
            assert_eq!(both.found(c), expected, "method {method}, step {step}");
        }
    }
}

#[test]
fn kept_queries_are_the_same() {
    let both = Both::new();
    let c = query(CASCA_METHOD_POINT, CASCA_KEPT);
    let mut rust = KeptQuery::with_options(KeptOptions::new().reach(0.5)).unwrap();
    for step in 0..40 {
        let (view, of_rust) = camera(step);
        ok!(casca_query_run(c, both.c, &view, std::ptr::null_mut()));
        assert_eq!(both.found(c), both.numbers(rust.run(&both.rust, &of_rust).iter()), "{step}");
    }
    let mut stats = init!(casca_stats);
    ok!(casca_query_get_stats(c, &mut stats));
    assert_eq!(stats.refreshes, rust.refreshes());
    assert!((1..30).contains(&stats.refreshes), "{}", stats.refreshes);
}

#[test]
fn casters_and_places_in_sight_are_the_same() {
    let both = Both::new();
    let (view, of_rust) = camera(3);
    let (c, c_light) = (query(CASCA_METHOD_POINT, 0), query(CASCA_METHOD_POINT, 0));
    let (mut rust, mut light) = (Query::new(), Query::new());
    ok!(casca_query_run(c, both.c, &view, std::ptr::null_mut()));
    rust.run(&both.rust, &of_rust);
    let mut sun = init!(casca_light);
    sun.direction = [0.3, -1.0, 0.2];
    let mut lamp = init!(casca_light);
    (lamp.kind, lamp.position, lamp.range) = (CASCA_LIGHT_POINT, [31.0, 6.0, 33.0], 20.0);
    let mut spot = init!(casca_light);
    (spot.kind, spot.view) = (CASCA_LIGHT_SPOT, &raw const view);
    for (told, known) in [
        (sun, Light::directional(sun.direction.into())),
        (lamp, Light::point(lamp.position.into(), 20.0)),
        (spot, Light::spot(of_rust)),
    ] {
        let mut count = 0;
        ok!(casca_query_shadow_casters(c_light, both.c, c, &told, &mut count));
        let mut expected = Vec::new();
        light.shadow_casters(&both.rust, &rust, &known, &mut expected).unwrap();
        assert!(!expected.is_empty() && expected.len() == count);
        assert_eq!(both.found(c_light), both.numbers(expected.into_iter()));
    }
    let places: Vec<[f32; 6]> = boxes()
        .iter()
        .map(|b| {
            let [x, y, z] = (b.min + Vec3::new(-0.2, 0.3, -0.2)).to_array();
            [x, y, z, x + 0.1, y + 0.1, z + 0.1]
        })
        .collect();
    let mut answers = vec![9; places.len()];
    ok!(casca_query_may_see_boxes(c, both.c, places.as_ptr().cast(), places.len(), answers.as_mut_ptr()));
    let sight = rust.sight(&both.rust).unwrap();
    let asked = |p: &[f32; 6]| Aabb::new(Vec3::from_slice(p), Vec3::from_slice(&p[3..]));
    let expected: Vec<u8> = places.iter().map(|p| sight.may_see_box(&asked(p)).into()).collect();
    assert_eq!(answers, expected);
    assert!(expected.contains(&0) && expected.contains(&1));
}

/// Between the near plane, 10 away, and where depth is 0 if it runs from -1 to 1.
#[test]
fn depth_runs_as_the_flags_say() {
    use casca::glam::camera::rh::proj::{directx, opengl};

    let mut grid = init!(casca_grid);
    (grid.min, grid.max, grid.cell) = ([-50.0; 3], [50.0; 3], 2.0);
    let mut scene = casca_scene { handle: 0 };
    ok!(casca_scene_create(&grid, &mut scene));
    let add = |z: f32| {
        let mut object = init!(casca_object);
        (object.bounds.kind, object.bounds.radius, object.bounds.center) =
            (CASCA_SHAPE_SPHERE, 0.1, [0.0, 0.0, z]);
        let mut id = 0;
        ok!(casca_scene_add(scene, &object, &mut id));
        id
    };
    let (near, middle, before) = (add(-12.0), add(-40.0), add(-8.0));
    let query = query(CASCA_METHOD_POINT, 0);
    for (kind, flags, matrix) in [
        (CASCA_VIEW_PERSPECTIVE, 0, directx::perspective(1.0, 1.0, 10.0, 100.0)),
        (CASCA_VIEW_MATRIX, 0, directx::perspective(1.0, 1.0, 10.0, 100.0)),
        (CASCA_VIEW_ORTHOGRAPHIC, 0, directx::orthographic(-5.0, 5.0, -5.0, 5.0, 10.0, 100.0)),
        (CASCA_VIEW_PERSPECTIVE, CASCA_DEPTH_MINUS_ONE, opengl::perspective(1.0, 1.0, 10.0, 100.0)),
        (CASCA_VIEW_MATRIX, CASCA_DEPTH_MINUS_ONE, opengl::perspective(1.0, 1.0, 10.0, 100.0)),
        (
            CASCA_VIEW_ORTHOGRAPHIC,
            CASCA_DEPTH_MINUS_ONE,
            opengl::orthographic(-5.0, 5.0, -5.0, 5.0, 10.0, 100.0),
        ),
    ] {
        let mut view = init!(casca_view);
        (view.kind, view.flags, view.forward) = (kind, flags, [0.0, 0.0, -1.0]);
        for row_major in [0, CASCA_ROW_MAJOR] {
            let stored = if row_major == 0 { matrix } else { matrix.transpose() };
            (view.flags, view.matrix) = (flags | row_major, stored.to_cols_array());
            ok!(casca_query_run(query, scene, &view, std::ptr::null_mut()));
            for (id, is_inside) in [(near, true), (middle, true), (before, false)] {
                let mut answer = false;
                ok!(casca_query_contains(query, scene, id, &mut answer));
                assert_eq!(answer, is_inside, "kind {kind}, flags {:#x}", view.flags);
            }
        }
    }
}
