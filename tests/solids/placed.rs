//! Objects placed by a transform: their shapes against points, and their moves in a scene.

use casca::internals::{SceneInternals, Shape, ShapeInternals};
use casca_scenes::world::Mesh;

use crate::common::*;

/// Boxes, turned boxes and polytopes around the origin and beside it; thin ones too.
fn solid() -> impl Strategy<Value = Occluder> {
    let middle = || vector(-3.0..3.0);
    let half = || prop::array::uniform3(prop_oneof![0.01..0.05f32, 0.5..3.0f32]).prop_map(Vec3::from_array);
    prop_oneof![
        (middle(), half()).prop_map(|(c, h)| Aabb::from_center(c, h).into()),
        (middle(), half(), rotation()).prop_map(|(c, h, r)| Obb::new(c, h, r).into()),
        prop::collection::vec(vector(-2.0..2.0), 8..16)
            .prop_filter_map("a solid", |points| Convex::from_points(&points).ok())
            .prop_map(|solid| Arc::new(solid).into()),
    ]
}

/// What engines make: rotation, scale and translation, mirrored or not; and products of those,
/// which shear.
fn transform() -> impl Strategy<Value = Affine3A> {
    let scale = || prop_oneof![vector(0.2..4.0), (0.2..4.0f32).prop_map(Vec3::splat), vector(-2.0..-0.5)];
    let place = || prop_oneof![vector(-20.0..20.0), vector(-20_000.0..20_000.0)];
    let simple = || {
        let parts = (scale(), rotation(), place());
        parts.prop_map(|(s, r, t)| Affine3A::from_scale_rotation_translation(s, r, t))
    };
    let parent = (scale(), rotation()).prop_map(|(s, r)| {
        Affine3A::from_mat3_translation(Mat3::from_diagonal(s) * Mat3::from_quat(r), Vec3::ZERO)
    });
    prop_oneof![simple(), (simple(), parent).prop_map(|(own, parent)| parent * own)]
}

fn exact(t: Affine3A) -> DAffine3 {
    let m = Mat3::from(t.matrix3).as_dmat3();
    DAffine3::from_mat3_translation(m, Vec3::from(t.translation).as_dvec3())
}

/// Bounds and occluder of an object after it was placed.
fn placed(desc: ObjectDesc, t: Affine3A) -> (Bounds, Option<Occluder>) {
    let mut scene = empty();
    let id = scene.insert(desc.placed(t)).unwrap();
    (scene.bounds(id).unwrap().clone(), scene.occluder(id).unwrap().cloned())
}

/// Points of the box around a shape, from shares of its sides.
fn points(shape: &dyn Shape, shares: &[Vec3]) -> Vec<DVec3> {
    let (min, max) = shape.bounds();
    shares.iter().map(|s| min + (max - min) * s.as_dvec3()).collect()
}

fn as_bounds(solid: &Occluder) -> Bounds {
    match solid {
        Occluder::Box(b) => (*b).into(),
        Occluder::Oriented(b) => (**b).into(),
        Occluder::Sphere(s) => (*s).into(),
        solid => {
            let (min, max) = solid.shape().bounds();
            Aabb::new(min.as_vec3() - 1e-3, max.as_vec3() + 1e-3).into()
        }
    }
}

/// Points of the bounds, transformed in single precision, lie in the bounds as placed; points of
/// the occluder as placed lie in the occluder.
fn check(solid: &Occluder, t: Affine3A, shares: &[Vec3]) -> usize {
    let local = as_bounds(solid);
    let (bounds, occluder) = placed(ObjectDesc::fixed(local.clone()).occluder(solid.clone()), t);
    let (low, high) = bounds.shape().bounds();
    for p in points(local.shape(), shares).into_iter().map(|p| p.as_vec3()) {
        let at = t.transform_point3(p).as_dvec3();
        if local.shape().contains_box(p.as_dvec3(), p.as_dvec3()) {
            assert!(bounds.shape().contains_box(at, at), "{local:?} {t:?} {bounds:?} {p}");
            assert!(at.cmpge(low).all() && at.cmple(high).all());
        }
    }
    let Some(occluder) = occluder else { return 0 };
    let back = exact(t).inverse();
    let inside =
        points(occluder.shape(), shares).into_iter().filter(|&p| occluder.shape().contains_box(p, p));
    let mut found = 0;
    for p in inside {
        found += 1;
        let own = back.transform_point3(p);
        assert!(solid.shape().contains_point(own), "{solid:?} {t:?} {occluder:?} {p} {own}");
    }
    found
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn bounds_grow_and_occluders_shrink(
        solid in solid(),
        t in transform(),
        shares in prop::collection::vec(vector(0.0..1.0), 100),
    ) {
        let mut shares = shares;
        shares.extend((0..8).map(|i| UVec3::new(i & 1, i >> 1 & 1, i >> 2).as_vec3()));
        check(&solid, t, &shares);
    }

    #[test]
    fn spheres_stay_spheres(
        sphere in (vector(-3.0..3.0), 0.5..3.0f32).prop_map(|(c, r)| Sphere::new(c, r)),
        (scale, turn, to) in (0.5..9.0f32, rotation(), vector(-3e4..3e4)),
        shares in prop::collection::vec(prop::array::uniform3(0.0..1.0f32).prop_map(Vec3::from), 100),
    ) {
        let t = Affine3A::from_scale_rotation_translation(Vec3::splat(scale), turn, to);
        prop_assert!(check(&sphere.into(), t, &shares) > 10);
        let (bounds, occluder) = placed(ObjectDesc::fixed(sphere).occluder(sphere), t);
        let (Bounds::Sphere(outer), Some(Occluder::Sphere(inner))) = (bounds, occluder) else { panic!() };
        let radius = sphere.radius * scale;
        prop_assert!(inner.radius < radius && radius < outer.radius);
        prop_assert!(outer.radius - inner.radius < 1e-4 * radius + 1e-5 * to.abs().max_element());
    }
}

#[test]
fn little_is_lost_near_the_origin() {
    let wall = Aabb::new(Vec3::new(-5.0, 0.0, -0.1), Vec3::new(5.0, 3.0, 0.1));
    let t = Affine3A::from_rotation_translation(Quat::from_rotation_y(0.7), Vec3::new(40.0, 0.0, 9.0));
    let (bounds, occluder) = placed(ObjectDesc::fixed(wall).occluder(wall), t);
    let (Bounds::Oriented(outer), Some(Occluder::Oriented(inner))) = (bounds, occluder) else { panic!() };
    let lost = outer.half - inner.half;
    assert!(lost.min_element() > 0.0 && lost.max_element() < 1e-3, "{lost}");
    // Sheared, it hides as a convex solid that is nearly as large.
    let shear = Affine3A::from_scale(Vec3::new(1.0, 1.0, 2.0)) * t;
    let (bounds, occluder) = placed(ObjectDesc::fixed(wall).occluder(wall), shear);
    let Some(Occluder::Convex(solid)) = occluder else { panic!() };
    assert!(matches!(bounds, Bounds::Box(_)) && solid.faces() == 6);
    let middle = exact(shear).transform_point3(DVec3::new(0.0, 1.5, 0.0));
    let end = exact(shear).transform_point3(DVec3::new(4.9, 2.9, 0.09));
    assert!([middle, end].into_iter().all(|p| solid.contains_box(p, p)));
    // So far away that single precision does not resolve it, it hides nothing.
    let far = Affine3A::from_translation(Vec3::splat(1e6));
    assert!(placed(ObjectDesc::fixed(wall).occluder(wall), far).1.is_none());
    let flat = Affine3A::from_scale(Vec3::new(1.0, 1.0, 0.0));
    assert!(placed(ObjectDesc::fixed(wall).occluder(wall), flat).1.is_none());
}

#[test]
fn one_call_moves_bounds_and_occluder() {
    for method in [Method::point(), Method::cell()] {
        let mut scene = empty();
        let leaf = Aabb::new(Vec3::new(0.0, 0.0, -1.5), Vec3::new(28.0, 30.0, 1.5));
        let at = |angle: f32| {
            let hinge = Vec3::new(2.0, 1.0, 16.0);
            Affine3A::from_rotation_translation(Quat::from_rotation_y(angle), hinge)
        };
        let door = scene.insert(ObjectDesc::dynamic(leaf).occluder(leaf).placed(at(0.0))).unwrap();
        let ball = scene.fixed(Sphere::new(Vec3::new(16.0, 16.0, 28.0), 0.5));
        let view = around(Vec3::new(16.5, 16.5, 4.5));
        let mut query = query_by(method);
        let mut sees = |scene: &Scene| query.run(scene, &view).contains(ball);
        assert!(!sees(&scene), "{method:?}: the door is closed");
        let opaque = scene.dynamic_opacity().count();
        scene.set_transform(door, at(-1.4)).unwrap();
        assert!(sees(&scene), "{method:?}: the door is open");
        assert_eq!(scene.transform(door), Ok(Some(at(-1.4))));
        scene.set_transform(door, at(0.0)).unwrap();
        assert!(!sees(&scene) && scene.dynamic_opacity().count() == opaque);
        scene.translate(door, Vec3::Z * 13.5).unwrap();
        assert!(sees(&scene), "{method:?}: the ball is before it");
        let back = Affine3A::from_translation(Vec3::new(2.0, 1.0, 16.0));
        scene.set_transform(door, back).unwrap();
        assert!(!sees(&scene));
        assert_eq!(scene.clone().transform(door), Ok(Some(back)));
    }
}

#[test]
fn instances_move_without_being_described_anew() {
    let corners = vec![Vec3::ZERO, Vec3::X * 4.0, Vec3::Y * 4.0];
    let mesh = mesh(corners, vec![[0, 1, 2]]);
    let at = |x: f32| Affine3A::from_translation(Vec3::splat(x));
    let instance = |x: f32| Instance::new(mesh.clone(), at(x)).unwrap();
    let mut scene = empty();
    let both = scene.insert(ObjectDesc::dynamic(instance(3.0)).occluder(instance(3.0))).unwrap();
    let bare = scene.fixed(instance(3.0));
    let local = scene.insert(ObjectDesc::fixed(mesh.clone()).occluder(mesh.clone()).placed(at(3.0))).unwrap();
    for id in [both, bare, local] {
        assert_eq!(scene.transform(id), Ok(Some(at(3.0))));
        scene.set_transform(id, at(9.0)).unwrap();
        assert_eq!(scene.transform(id), Ok(Some(at(9.0))));
        assert!(matches!(scene.bounds(id).unwrap(), Bounds::Instance(i) if *i == instance(9.0)));
        let occluder = scene.occluder(id).unwrap();
        assert!(occluder.is_none_or(|o| matches!(o, Occluder::Instance(i) if *i == instance(9.0))));
        assert_eq!(occluder.is_none(), id == bare);
    }
    let shapes = scene.memory().shapes;
    assert!((mesh.memory_bytes()..2 * mesh.memory_bytes() + 4096).contains(&shapes), "the mesh counts once");
    let apart = ObjectDesc::fixed(instance(3.0)).occluder(instance(3.001));
    let apart = scene.insert(apart).unwrap();
    assert_eq!(scene.transform(apart), Ok(None));
    assert_eq!(scene.set_transform(apart, at(9.0)), Err(Error::NotPlaced(apart)));
}

/// Meshes in several pieces do not touch all bricks of their box, though these be a row.
#[test]
fn a_piece_that_enters_a_brick_between_others_is_found() {
    let mut scene = empty();
    // The eye sees the second row of bricks between two walls, and no others.
    for (from, to) in [(0.0, 12.0), (14.0, 32.0)] {
        scene.solid(Aabb::new(Vec3::new(from, 0.0, 16.0), Vec3::new(to, 32.0, 18.0)));
    }
    // Only bricks of many objects are asked whether they are hidden as a whole.
    for i in 0..40 {
        let x = if i % 2 == 0 { 3.0 } else { 20.0 };
        let at = Vec3::new(x, 1.0 + (i / 8) as f32, 1.0 + (i % 8 / 2) as f32);
        scene.fixed(Sphere::new(at, 0.2));
    }
    let mesh = |middle: f32| {
        let corner = |x: f32| [Vec3::new(x, 4.0, 4.0), Vec3::new(x, 4.4, 4.0), Vec3::new(x, 4.2, 4.3)];
        let positions = [1.5, middle, 18.5].into_iter().flat_map(corner).collect();
        Arc::new(TriMesh::bounds_only(positions, vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]]).unwrap())
    };
    let id = scene.insert(ObjectDesc::dynamic(mesh(7.0))).unwrap();
    let view = around(Vec3::new(13.0, 4.0, 31.0));
    scene.update(id, mesh(13.0), None).unwrap();
    assert!(Query::new().run(&scene, &view).contains(id));
}

#[test]
fn refusals_name_the_reason_and_move_nothing() {
    let mut scene = empty();
    let ball = Sphere::new(Vec3::ONE, 0.5);
    let to = Affine3A::from_translation(Vec3::splat(8.0));
    let id = scene.insert(ObjectDesc::dynamic(ball).occluder(ball).placed(to)).unwrap();
    let stretched = to * Affine3A::from_scale(Vec3::new(1.0, 1.1, 1.0));
    let nan = Affine3A::from_translation(Vec3::NAN);
    let far = Affine3A::from_scale(Vec3::splat(f32::MAX));
    assert!(matches!(scene.set_transform(id, stretched), Err(Error::SphereScale { .. })));
    assert!(matches!(scene.set_transform(id, nan), Err(Error::NotFinite { .. })));
    assert!(matches!(scene.set_transform(id, far), Err(Error::NotFinite { .. })));
    assert_eq!(scene.transform(id), Ok(Some(to)));
    let world = scene.insert(ObjectDesc::dynamic(ball)).unwrap();
    assert_eq!(scene.set_transform(world, to), Err(Error::NotPlaced(world)));
    assert_eq!(scene.transform(world), Ok(None));
    let mesh = TriMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]).unwrap();
    let instance = Instance::new(Arc::new(mesh), to).unwrap();
    let twice = scene.insert(ObjectDesc::fixed(instance).placed(to));
    assert!(matches!(twice, Err(Error::PlacedTwice { .. })));
    assert!(matches!(
        scene.insert(ObjectDesc::fixed(ball).placed(stretched)),
        Err(Error::SphereScale { .. })
    ));
    // Shapes in world space take the place of those that were placed.
    scene.update(id, ball, Some(ball.into())).unwrap();
    assert_eq!(scene.set_transform(id, to), Err(Error::NotPlaced(id)));
    scene.remove(id).unwrap();
    assert_eq!(scene.set_transform(id, to), Err(Error::UnknownObject(id)));
    assert_eq!(scene.transform(id), Err(Error::UnknownObject(id)));
}

/// A box of triangles that hide from their front, and a ball behind it: as placed, does it hide the
/// ball from outside, and does an eye inside see out?
#[test]
fn fronts_of_solids_hide_under_unequal_scales_but_not_mirrored() {
    let Mesh { positions, triangles, .. } = Mesh::cuboid(Vec3::splat(-0.5), Vec3::splat(0.5));
    let how = MeshOptions::default().facing(Facing::Front);
    let go_on = &mut |_: f32| std::ops::ControlFlow::Continue(());
    let cube = Arc::new(TriMesh::prepare(positions, triangles, &how, go_on).unwrap());
    let sees = |scale: Vec3, eye: Vec3| {
        let mut scene = empty();
        let turned = Affine3A::from_rotation_y(0.2) * Affine3A::from_scale(scale);
        let place = Affine3A::from_translation(Vec3::splat(16.0)) * turned;
        let bounds = Aabb::new(Vec3::splat(-0.5), Vec3::splat(0.5));
        scene.insert(ObjectDesc::fixed(bounds).occluder(cube.clone()).placed(place)).unwrap();
        let ball = scene.fixed(Sphere::new(Vec3::new(24.0, 16.0, 16.0), 0.5));
        Query::new().run(&scene, &around(eye)).contains(ball)
    };
    let (outside, inside) = (Vec3::new(8.0, 16.0, 16.0), Vec3::splat(16.1));
    for scale in [Vec3::splat(10.0), Vec3::new(2.0, 10.0, 14.0)] {
        assert!(!sees(scale, outside), "{scale} hides");
        assert!(sees(scale, inside), "{scale}: only backs are before the eye");
        let mirror = scale * Vec3::new(-1.0, 1.0, 1.0);
        assert!(sees(mirror, inside) && sees(mirror, outside), "{mirror} hides nothing");
    }
}

/// A wide sheet whose front looks to greater x, 2 m from the eye, and a ball behind it.
#[test]
fn a_wide_sheet_hides_from_its_front_also_from_near() {
    let at = |y: f32, z: f32| Vec3::new(16.0, y, z);
    let corners = vec![at(2.0, 2.0), at(30.0, 2.0), at(30.0, 30.0), at(2.0, 30.0)];
    let how = MeshOptions::default().facing(Facing::Front);
    let go_on = &mut |_: f32| std::ops::ControlFlow::Continue(());
    let sheet = Arc::new(TriMesh::prepare(corners, vec![[0, 1, 2], [0, 2, 3]], &how, go_on).unwrap());
    let sees = |eye: f32, ball: f32| {
        let mut scene = empty();
        scene.solid(sheet.clone());
        let ball = scene.fixed(Sphere::new(Vec3::new(ball, 16.0, 16.0), 0.5));
        let eye = Vec3::new(eye, 16.0, 16.0);
        Query::new().run(&scene, &around(eye)).contains(ball)
    };
    for near in [0.5, 2.0, 9.0] {
        assert!(!sees(16.0 + near, 10.0), "from {near} m before it");
        assert!(sees(16.0 - near, 22.0), "from {near} m behind it");
    }
}
