//! Objects that reach a little or far out of the level that a grid was made for, on any side: none
//! that an eye sees is lost, by segments cut by the shapes themselves, and they cost as any others.

use crate::common::worlds::{SIZE, Solid, World};
use crate::common::*;

/// A box that sticks out of one side of the grid by a distance.
fn overhanging(side: usize, middle: Vec3, half: Vec3, by: f32) -> Aabb {
    let (axis, mut b) = (side / 2, Aabb::from_center(middle, half));
    if side.is_multiple_of(2) {
        (b.min[axis], b.max[axis]) = (-by, half[axis]);
    } else {
        (b.min[axis], b.max[axis]) = (SIZE - half[axis], SIZE + by);
    }
    b
}

fn target() -> impl Strategy<Value = Aabb> {
    let by = prop_oneof![1e-6f32..1e-3, 1e-3f32..0.99, Just(0.99f32), 0.99f32..6.0];
    (0usize..6, vector(1.0..31.0), vector(0.0..1.5), by)
        .prop_map(|(side, middle, half, by)| overhanging(side, middle, half, by))
}

/// Walls through the whole grid, and boxes of all sizes; some reach out of the grid, too.
fn wall() -> impl Strategy<Value = Solid> {
    let whole = (0usize..3, 3u8..28, 2u8..5, prop_oneof![Just(0.0f32), 0.0..2.0f32]).prop_map(
        |(axis, at, thick, by)| {
            let (mut min, mut max) = (Vec3::splat(-by), Vec3::splat(SIZE + by));
            (min[axis], max[axis]) = (f32::from(at), f32::from(at + thick));
            Aabb::new(min, max)
        },
    );
    let any = (vector(0.0..32.0), vector(0.0..9.0)).prop_map(|(p, half)| Aabb::from_center(p, half));
    prop_oneof![2 => whole, 1 => any].prop_map(Solid::Box)
}

/// Eyes inside the grid, beside its border, and outside.
fn eye() -> impl Strategy<Value = Vec3> {
    let near = (vector(0.5..31.5), 0usize..6, -0.5f32..1.5).prop_map(|(mut p, side, off)| {
        p[side / 2] = if side.is_multiple_of(2) { off } else { SIZE - off };
        p
    });
    prop_oneof![2 => vector(0.5..31.5), 2 => near, 1 => vector(-12.0..44.0)]
}

fn methods() -> [Method; 5] {
    let coherent = Method::Point(PointOptions::new().coherent(true));
    [Method::point(), Method::Point(PointOptions::fast()), coherent, Method::cell(), Method::Frustum]
}

proptest! {
    #![proptest_config(cases(192))]

    #[test]
    fn no_object_that_reaches_out_of_the_grid_is_lost(
        walls in prop::collection::vec(wall(), 1..5),
        targets in prop::collection::vec(target(), 24),
        eyes in prop::collection::vec(eye(), 3),
    ) {
        let world = World::new(&walls, &targets);
        let mut queries = methods().map(query_by);
        let mut kept = KeptQuery::with_options(KeptOptions::new().reach(0.5)).unwrap();
        for &eye in &eyes {
            let view = around(eye);
            let seen = |eye: Vec3| world.seen(eye.as_dvec3(), &[]);
            for query in &mut queries {
                let pvs = query.run(&world.scene, &view);
                let lost = seen(eye).into_iter().find(|id| !pvs.contains(*id));
                prop_assert_eq!(lost, None, "{:?} from {}", query.method(), eye);
            }
            let pvs = kept.run(&world.scene, &view);
            prop_assert!(seen(eye).iter().all(|id| pvs.contains(*id)), "kept, from {eye}");
            let reach = queries[0].run(&world.scene, &view.clone().with_reach(0.4).unwrap());
            for step in Vec3::AXES.map(|axis| axis * 0.39) {
                let lost = seen(eye + step).into_iter().find(|id| !reach.contains(*id));
                prop_assert_eq!(lost, None, "from {}, {} beside it", eye, step);
            }
        }
    }

    #[test]
    fn no_moving_object_that_reaches_out_of_the_grid_is_lost(
        walls in prop::collection::vec(wall(), 1..4),
        targets in prop::collection::vec(target(), 16),
        eye in eye(),
        steps in prop::collection::vec(vector(-0.7..0.7), 6),
    ) {
        for method in methods() {
            let mut world = World::with(&walls, &targets, ObjectDesc::dynamic);
            let mut query = query_by(method);
            for (frame, step) in steps.iter().enumerate() {
                world.scene.begin_frame(frame as f64 / 60.0).unwrap();
                // In three frames they move, then they stand still.
                for (k, (id, target)) in world.targets.iter_mut().enumerate().filter(|_| frame % 2 == 0) {
                    let Solid::Box(b) = target else { continue };
                    let step = if k % 2 == 0 { *step } else { *step * 0.01 };
                    *b = Aabb::new(b.min + step, b.max + step);
                    world.scene.update(*id, *b, None).unwrap();
                }
                let pvs = query.run(&world.scene, &around(eye));
                let lost = world.seen(eye.as_dvec3(), &[]).into_iter().find(|id| !pvs.contains(*id));
                prop_assert_eq!(lost, None, "{:?} from {} in frame {}", query.method(), eye, frame);
                world.scene.end_frame([query.pvs()]).unwrap();
            }
            for (id, _) in &world.targets {
                world.scene.remove(*id).unwrap();
            }
            prop_assert_eq!(query.run(&world.scene, &around(eye)).len() <= walls.len(), true);
        }
    }
}

/// A wall across the grid, and boxes that stand behind it, below the floor of the grid by a
/// distance.
fn street(below: f32) -> (Scene, Vec<ObjectId>) {
    let mut scene = empty();
    scene.solid(Aabb::new(Vec3::new(0.0, 0.0, 60.0), Vec3::new(128.0, 16.0, 62.0)));
    let corner = |i: u32| Vec3::new(1.0 + (i % 50) as f32 * 2.5, 0.0, 64.0 + (i / 50) as f32);
    let boxes = (0..2500).map(|i| Aabb::new(corner(i) - Vec3::Y * below, corner(i) + 0.5));
    let ids = boxes.map(|b| scene.insert(ObjectDesc::dynamic(b)).unwrap()).collect();
    (scene, ids)
}

#[test]
fn what_is_far_away_costs_only_itself() {
    let eye = around(Vec3::new(64.3, 2.3, 20.3));
    let (mut scene, ids) = street(0.0);
    let mut query = Query::new();
    let before = query.run(&scene, &eye).clone();
    // A tower of a kilometre, a plain of ten, and a ball almost at the end of all cells.
    let places = (1..100).flat_map(|i| [Vec3::Y * i as f32 * 10.0, Vec3::new(i as f32, 0.0, -1.0) * 100.0]);
    let far: Vec<ObjectId> = places.map(|at| scene.fixed(Sphere::new(at - 50.0, 0.4))).collect();
    let last = scene.fixed(Sphere::new(Vec3::new(1e6, 2.0, 20.0), 3.0));
    let after = query.run(&scene, &eye);
    assert!(after.contains(last) && far.iter().all(|&id| after.contains(id)), "nothing hides them");
    assert!(ids.iter().all(|&id| after.contains(id) == before.contains(id)));
    let (own, all, new) = (before.stats(), after.stats(), far.len() as u32 + 1);
    assert!(
        all.shells - own.shells <= 2 * new && all.bricks_visited - own.bricks_visited <= 8 * u64::from(new)
    );
    assert!(all.objects_tested - own.objects_tested <= new, "{own:?} {all:?}");
}

#[test]
fn movers_that_reach_out_of_the_grid_a_little_get_volumes() {
    let (mut scene, ids) = street(1e-4);
    let eye = around(Vec3::new(64.3, 2.3, 20.3));
    let mut query = Query::new();
    for frame in 0..10 {
        scene.begin_frame(f64::from(frame) * 0.02).unwrap();
        look(&mut scene, &mut query, &eye);
    }
    let hidden = ids.iter().filter(|id| scene.tbv(**id).unwrap().is_some()).count();
    assert!(hidden > 2400, "{hidden} of 2500 are in volumes");
    assert!(query.run(&scene, &eye).stats().objects_tested < 100);
}
