//! What the cell method proves hidden, the point method finds hidden too, but for what
//! `Method::Point` says.

use casca_scenes::drive::view_of;
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::measure::Settled;

use crate::common::*;

/// The view of an eye that is known, and that of the matrix alone.
fn views(eye: Vec3, near: f32) -> [View; 2] {
    let m = lens(eye, Vec3::Z, [1.2, 1.5, near, 60.0]);
    [View::perspective(eye, m).unwrap(), View::from_view_projection(m).unwrap()]
}

/// Both methods hide the object, and neither finds the eye in an occluder.
fn both_hide(scene: &Scene, view: &View, id: ObjectId) {
    for method in [Method::cell(), Method::point()] {
        let mut query = query_by(method);
        let pvs = query.run(scene, view);
        assert!(!pvs.contains(id) && !pvs.stats().eye_in_occluder, "{method:?} {view:?}");
    }
}

#[test]
fn the_named_options_find_ever_fewer_objects() {
    let named = [PointOptions::fast(), PointOptions::balanced(), PointOptions::tight()];
    for kind in [
        SceneKind::Spheres,
        SceneKind::City,
        SceneKind::Forest,
        SceneKind::Leaves,
        SceneKind::Rocks,
        SceneKind::Harbour,
    ] {
        let mut world = build(kind, &SceneOptions { frames: 6, ..SceneOptions::default() });
        world.set_frame(0);
        let settled = Settled::new(&world, Method::default()).unwrap();
        let found = named.map(|options| {
            let mut query = query_by(Method::Point(options));
            settled.views.iter().map(|view| query.run(&settled.driver.scene, view).len()).sum::<usize>()
        });
        assert!(found[0] > found[1] && found[1] > found[2], "{kind:?}: {found:?}");
    }
}

#[test]
fn solids_beside_the_eye_are_not_cut_because_their_box_is() {
    // A ball and a turned box whose corner boxes hold the eye and what the near plane cuts away.
    let turned = Obb::new(Vec3::new(8.0, 8.0, 8.0), Vec3::new(4.0, 4.0, 3.0), Quat::from_rotation_y(0.785));
    let round = Sphere::new(Vec3::splat(8.0), 4.5);
    for is_round in [false, true] {
        let mut scene = empty();
        let desc = if is_round {
            ObjectDesc::fixed(round).occluder(round)
        } else {
            ObjectDesc::fixed(turned).occluder(turned)
        };
        scene.insert(desc).unwrap();
        let hidden = scene.fixed(Sphere::new(Vec3::new(8.0, 8.0, 14.5), 0.2));
        scene.begin_frame(0.0).unwrap();
        let eye = if is_round { Vec3::new(6.5, 6.5, 3.7) } else { Vec3::new(8.2, 8.1, 2.9) };
        views(eye, 0.05).iter().for_each(|view| both_hide(&scene, view, hidden));
    }
}

/// On these scenes there is no exception where the eye is known, and hardly any where the
/// matrix alone tells it: solids are shrunk by what it leaves open, which opens seams.
#[test]
fn the_point_method_keeps_nothing_that_the_cell_method_hides() {
    let (mut cell, mut point) = (query_by(Method::cell()), query_by(Method::point()));
    for kind in SceneKind::SOLIDS {
        let mut world = build(kind, &SceneOptions::default());
        let mut driver = driver(&world);
        let (mut sizes, mut loose) = ((0, 0), [0, 0]);
        for frame in (0..150).step_by(15) {
            go_to(&mut driver, &mut world, frame);
            let camera = world.camera(frame, 16.0 / 9.0);
            let exact = view_of(&camera).unwrap();
            let matrix = View::from_view_projection(camera.view_projection()).unwrap();
            for (view, loose) in [matrix, exact].iter().zip(&mut loose) {
                let hidden = cell.run(&driver.scene, view);
                let kept = point.run(&driver.scene, view);
                *loose += kept.visible().iter().filter(|&&id| !hidden.contains(id)).count();
                sizes = (sizes.0 + hidden.len(), sizes.1 + kept.len());
            }
            driver.scene.end_frame([point.pvs()]).unwrap();
        }
        println!("{:<8} cell {}, point {}, only point {loose:?}", kind.name(), sizes.0, sizes.1);
        assert!(loose[1] == 0 && 100 * loose[0] < sizes.1 && sizes.1 < sizes.0, "{kind:?} {loose:?}");
    }
}
