//! Objects and solids at and beyond the border of the grid.

use casca_plane::{ConvexPolygon, Disc, GridSpec, Method, ObjectDesc, Query, Scene, Segment, View};
use glam::{UVec2, Vec2};

fn grid(min: f32) -> GridSpec {
    GridSpec { min: Vec2::splat(min), cell: 1.0, dims: UVec2::splat(32) }
}

/// Volumes have no cells beyond the grid, so an object that leaves the grid leaves its volume.
#[test]
fn a_hidden_object_that_leaves_the_grid_is_seen() {
    for on_expiry in [false, true] {
        let mut scene = Scene::new(&grid(0.0)).unwrap();
        let wall = Segment::new(Vec2::new(20.0, 24.0), Vec2::new(31.9, 24.0));
        scene.insert(ObjectDesc::fixed(wall).occluder(wall)).unwrap();
        let desc = ObjectDesc::dynamic(Disc::new(Vec2::new(30.0, 16.0), 0.3)).max_speed(3.0);
        let desc = if on_expiry { desc.reported_on_expiry() } else { desc };
        let id = scene.insert(desc).unwrap();
        let mut query = Query::new();
        scene.begin_frame(0.0).unwrap();
        let near = View::all_round(Vec2::new(4.5, 16.5)).unwrap();
        query.run(&scene, &near.with_range(5.0).unwrap());
        assert_eq!(scene.end_frame([query.pvs()]).unwrap().hidden, 1);
        scene.begin_frame(0.1).unwrap();
        scene.update(id, Disc::new(Vec2::new(32.5, 16.5), 0.3), None).unwrap();
        for (method, eye) in [(Method::Cell, Vec2::new(4.5, 16.5)), (Method::Point, Vec2::new(31.5, 30.5))] {
            let mut query = Query::with_method(method).unwrap();
            let pvs = query.run(&scene, &View::all_round(eye).unwrap());
            assert!(pvs.contains(id), "{method:?} {on_expiry}");
        }
    }
}

/// Its sides pass the grid far from its corners, where a side in double precision is a wide strip.
#[test]
fn cells_beside_a_huge_solid_stay_free() {
    for size in [1e12, 1e16, 1e20] {
        let corners = [Vec2::splat(-size), Vec2::splat(size), Vec2::new(-size, size)];
        let half = ConvexPolygon::new(&corners).unwrap();
        let mut scene = Scene::new(&grid(-16.0)).unwrap();
        scene.insert(ObjectDesc::fixed(half.clone()).occluder(half)).unwrap();
        let id = scene.insert(ObjectDesc::fixed(Disc::new(Vec2::new(-6.5, -12.5), 0.2))).unwrap();
        let mut query = Query::with_method(Method::Cell).unwrap();
        let pvs = query.run(&scene, &View::all_round(Vec2::new(3.5, -12.5)).unwrap());
        assert!(pvs.contains(id), "{size}");
    }
}
