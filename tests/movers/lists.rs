//! Small moving objects, which are listed by zones and mostly reported by a comparison: a query finds
//! the same objects as in a new scene with all objects at their present places.

use casca::internals::SceneInternals;

use crate::common::*;

const SIZE: Vec3 = Vec3::new(40.0, 38.0, 44.0);
const COUNT: usize = 300;
const FRAMES: usize = 60;

fn new_scene() -> Scene {
    let mut scene = empty();
    for (min, max) in [((18.0, 0.0, 4.0), (20.0, 30.0, 40.0)), ((6.0, 8.0, 20.0), (18.0, 12.0, 21.5))] {
        scene.solid(Aabb::new(min.into(), max.into()));
    }
    // Boxes of opaque cells are found.
    scene.begin_frame(0.0).unwrap();
    scene
}

/// How an object is described and moved.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Ball,
    Block,
    /// A box that is placed by a transform.
    Placed,
    /// A triangle under a transform.
    Leaf,
}

struct Mover {
    id: Option<ObjectId>,
    kind: Kind,
    center: Vec3,
    half: f32,
}

impl Mover {
    fn transform(&self) -> Affine3A {
        Affine3A::from_translation(self.center)
    }

    fn bounds(&self) -> Bounds {
        match self.kind {
            Kind::Ball => Sphere::new(self.center, self.half).into(),
            _ => Aabb::from_center(self.center, Vec3::splat(self.half)).into(),
        }
    }

    fn desc(&self, leaf: &Arc<TriMesh>) -> ObjectDesc {
        match self.kind {
            Kind::Ball | Kind::Block => ObjectDesc::dynamic(self.bounds()),
            Kind::Placed => ObjectDesc::dynamic(Aabb::from_center(Vec3::ZERO, Vec3::splat(self.half)))
                .placed(self.transform()),
            Kind::Leaf => ObjectDesc::dynamic(Instance::new(leaf.clone(), self.transform()).unwrap()),
        }
    }

    fn is_placed(&self) -> bool {
        matches!(self.kind, Kind::Placed | Kind::Leaf)
    }
}

fn movers(dice: &mut Random) -> Vec<Mover> {
    let kinds = [Kind::Ball, Kind::Block, Kind::Placed, Kind::Leaf];
    (0..COUNT)
        .map(|i| Mover {
            id: None,
            kind: kinds[i % 4],
            center: dice.place(0.0, 1.0, 0.125) * SIZE,
            half: if i % 16 == 0 { 4.5 } else { 0.05 + dice.unit() },
        })
        .collect()
}

fn view(dice: &mut Random) -> View {
    let (eye, at) = (dice.place(0.0, 1.0, 0.125) * SIZE, dice.place(0.0, 1.0, 0.125) * SIZE);
    let matrix = directx::perspective(1.1, 1.4, 0.05, 90.0)
        * look_to_mat4(eye, (at - eye).normalize_or(Vec3::X), Vec3::new(0.1, 1.0, 0.05).normalize());
    View::perspective(eye, matrix).unwrap()
}

/// Moves all objects: most by a step, some to anywhere, some beyond the grid.
fn step(movers: &mut [Mover], dice: &mut Random) {
    for mover in movers {
        let way = dice.place(0.0, 1.0, 0.125) - 0.5;
        mover.center = match dice.unit() {
            d if d < 0.02 => dice.place(0.0, 1.0, 0.125) * SIZE * 1.2 - SIZE * 0.1,
            d if d < 0.3 => mover.center + way * 6.0,
            d if d < 0.35 => mover.center.round(),
            _ => mover.center + way * 0.3,
        };
    }
}

/// Plays `FRAMES` frames; `act` may change the scene after the reports of a frame.
fn play(seed: u64, method: Method, mut act: impl FnMut(usize, &mut Scene, &mut Query)) -> (usize, usize) {
    let mut dice = Random(seed);
    let leaf = mesh(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    let mut movers = movers(&mut dice);
    let mut scene = new_scene();
    for mover in &mut movers {
        mover.id = Some(scene.insert(mover.desc(&leaf)).unwrap());
    }
    let (mut query, mut found, mut extra) = (query_by(method), 0, 0);
    for frame in 0..FRAMES {
        scene.begin_frame(frame as f64 / 60.0).unwrap();
        step(&mut movers, &mut dice);
        let id = |mover: &Mover| mover.id.unwrap();
        let plain = movers.iter().filter(|m| !m.is_placed()).map(|m| (id(m), m.bounds()));
        let placed = movers.iter().filter(|m| m.is_placed()).map(|m| (id(m), m.transform()));
        scene.update_many(plain).unwrap();
        scene.set_transforms(placed).unwrap();
        act(frame, &mut scene, &mut query);
        let mut afresh = new_scene();
        let ids: Vec<_> = movers.iter().map(|m| afresh.insert(m.desc(&leaf)).unwrap()).collect();
        let view = view(&mut dice);
        let pvs = query.run(&scene, &view);
        let mut other = query_by(method);
        let expected = other.run(&afresh, &view);
        for (mover, new) in movers.iter().zip(ids) {
            let (here, there) = (pvs.contains(id(mover)), expected.contains(new));
            assert!(here || !there, "frame {frame}: an object at {} is lost", mover.center);
            found += usize::from(there);
            extra += usize::from(here && !there);
        }
    }
    (found, extra)
}

#[test]
fn after_any_way_a_query_finds_what_it_finds_afresh() {
    for seed in [1, 2, 3] {
        let (found, extra) = play(seed, Method::point(), |_, _, _| ());
        assert!(found > 20 * FRAMES && extra * 200 <= found, "{found} {extra}");
    }
}

#[test]
fn objects_listed_by_zones_are_found_by_cell_from_whenever_they_are_asked_for() {
    let (found, extra) = play(4, Method::cell(), |_, _, _| ());
    assert!(found > 20 * FRAMES && extra == 0, "{extra}");
    // Listed by zones for half of the frames.
    let listed = |frame: usize, scene: &mut Scene, _: &mut Query| {
        if frame == FRAMES / 2 {
            Query::with_method(Method::cell()).unwrap().run(scene, &around(SIZE * 0.3));
        }
    };
    let (found, extra) = play(5, Method::point(), listed);
    assert!(found > 20 * FRAMES && extra * 200 <= found, "{found} {extra}");
}

#[test]
fn clones_and_other_origins_keep_their_own_lists() {
    let act = |frame: usize, scene: &mut Scene, _: &mut Query| {
        if frame % 7 == 3 {
            // The clone goes on, and what happens to the original does not matter.
            let clone = scene.clone();
            scene.clear();
            *scene = clone;
        }
        if frame % 9 == 4 {
            let by = Vec3::new(8.0, -16.0, 3.5);
            scene.set_origin(by.as_dvec3()).unwrap();
            scene.set_origin(DVec3::ZERO).unwrap();
        }
    };
    let (found, extra) = play(6, Method::point(), act);
    assert!(found > 20 * FRAMES && extra * 100 <= found, "{found} {extra}");
}

#[test]
fn an_object_that_grows_inside_its_bricks_is_found_in_all_of_its_cells() {
    let mut scene = empty();
    let ball = Sphere::new(Vec3::splat(12.0), 0.3);
    let id = scene.insert(ObjectDesc::dynamic(ball)).unwrap();
    // It touches each cell of a brick now.
    scene.update(id, Aabb::new(Vec3::splat(8.0), Vec3::splat(15.9)), None).unwrap();
    let mut query = query_by(Method::cell());
    assert!(query.run(&scene, &around(Vec3::splat(20.5))).contains(id));
    scene.update(id, Sphere::new(Vec3::new(4.0, 20.0, 12.0), 0.3), None).unwrap();
    assert!(query.run(&scene, &around(Vec3::splat(20.5))).contains(id));
    scene.remove(id).unwrap();
    assert_eq!(scene.id_matrix().entries(), 0);
}

#[test]
fn the_same_report_again_keeps_results() {
    let mut scene = new_scene();
    // Corners in the middle of a brick, on a lower side and on an upper side of one.
    let boxes = [9.5, 8.0, 14.5].map(|x| Aabb::new(Vec3::new(x, 3.0, 3.0), Vec3::new(x + 1.5, 4.0, 4.0)));
    let ids = boxes.map(|b| scene.insert(ObjectDesc::dynamic(b)).unwrap());
    let view = around(Vec3::splat(2.5));
    let mut query = Query::new();
    query.run(&scene, &view);
    for _ in 0..2 {
        scene.update_many(ids.into_iter().zip(boxes)).unwrap();
        assert!(query.pvs().is_valid_for(&scene, &view));
    }
    scene.update(ids[0], Aabb { max: boxes[0].max + 0.01, ..boxes[0] }, None).unwrap();
    assert!(!query.pvs().is_valid_for(&scene, &view));
}

#[test]
fn an_object_that_gets_an_occluder_in_its_volume_is_told_with_it_from_then_on() {
    let mut scene = new_scene();
    let block = |x: f32| Aabb::from_center(Vec3::new(x, 30.0, 30.0), Vec3::splat(0.4));
    let id = scene.insert(ObjectDesc::dynamic(block(8.0))).unwrap();
    let mut query = Query::new();
    scene.begin_frame(0.1).unwrap();
    look(&mut scene, &mut query, &around(Vec3::new(30.5, 4.5, 4.5)));
    assert!(scene.tbv(id).unwrap().is_some(), "the wall hides it");
    scene.update(id, block(8.1), None).unwrap();
    scene.set_occluder(id, Some(block(8.1).into())).unwrap();
    assert_eq!(scene.update(id, block(8.2), None), Err(Error::OccluderMissing(id)));
    scene.update(id, block(8.2), Some(block(8.2).into())).unwrap();
    scene.set_occluder(id, None).unwrap();
    scene.update(id, block(8.3), None).unwrap();
    assert_eq!(scene.bounds(id).unwrap().aabb(), block(8.3));
}

#[test]
fn views_show_movers_on_their_layers_only() {
    let mut scene = new_scene();
    let ball = |x: f32| Sphere::new(Vec3::new(x, 3.0, 3.0), 0.2);
    let silent = ObjectDesc::dynamic(ball(8.0)).max_speed(1.0).reported_on_expiry();
    let ids = [ObjectDesc::dynamic(ball(8.0)), silent].map(|desc| scene.insert(desc.layers(0b10)).unwrap());
    // Some bricks away: near the eye all objects are looked at.
    let eye = around(Vec3::splat(2.5));
    for (layers, x) in [(0b10, 30.0), (0b01, 30.1), (u64::MAX, 28.2), (0b10, 28.3)] {
        for id in ids {
            scene.set_layers(id, layers).unwrap();
            scene.update(id, ball(x), None).unwrap();
        }
        for method in [Method::point(), Method::cell(), Method::Frustum] {
            for view in [0, 0b01, 0b10, u64::MAX] {
                let mut query = query_by(method);
                let pvs = query.run(&scene, &eye.clone().with_layers(view));
                let shown = ids.map(|id| pvs.contains(id));
                assert_eq!(shown, [layers & view != 0; 2], "{method:?} {layers:b} {view:b} {x}");
            }
        }
    }
}

#[test]
fn moves_that_are_refused_change_nothing_and_stop_no_others() {
    let mut scene = new_scene();
    let ball = |x: f32, r: f32| Sphere::new(Vec3::new(x, 5.0, 5.0), r);
    let ids: Vec<_> =
        (0..6).map(|i| scene.insert(ObjectDesc::dynamic(ball(i as f32 + 2.0, 0.2))).unwrap()).collect();
    let foreign = new_scene().insert(ObjectDesc::dynamic(ball(3.0, 0.2))).unwrap();
    scene.remove(ids[4]).unwrap();
    let refused = [
        (ids[0], ball(f32::NAN, 0.2).into()),
        (ids[1], ball(3.1, -1e-9).into()),
        (ids[2], Bounds::from(Aabb::new(Vec3::splat(5.0), Vec3::splat(4.9)))),
        (foreign, ball(3.1, 0.2).into()),
        (ids[4], ball(6.1, 0.2).into()),
    ];
    for (id, bounds) in refused {
        let moves = [(id, bounds), (ids[5], ball(7.5, 0.2).into())];
        scene.update(ids[5], ball(7.0, 0.2), None).unwrap();
        let (who, why) = scene.update_many(moves).unwrap_err();
        assert_eq!(who, id);
        assert!(matches!(
            why,
            Error::NotFinite { .. }
                | Error::Negative { .. }
                | Error::InvertedBox { .. }
                | Error::UnknownObject(_)
        ));
        assert_eq!(scene.bounds(ids[5]).unwrap().aabb(), Bounds::from(ball(7.5, 0.2)).aabb());
    }
    assert_eq!(scene.set_transforms([(ids[0], Affine3A::IDENTITY)]), Err((ids[0], Error::NotPlaced(ids[0]))));
    for (i, &id) in ids.iter().enumerate().take(3) {
        assert_eq!(scene.bounds(id).unwrap().aabb(), Bounds::from(ball(i as f32 + 2.0, 0.2)).aabb());
    }
}

#[test]
fn a_mover_whose_report_is_overdue_is_in_the_set_once_wherever_it_was() {
    for far in [false, true] {
        let mut scene = new_scene();
        let ball = |x: f32, y: f32| Sphere::new(Vec3::new(x, y, 22.0), 0.3);
        let eye = around(Vec3::new(10.0, 35.0, 22.0));
        // In the eye's zone, and in another.
        let at = if far { 38.0 } else { 10.5 };
        let silent = ObjectDesc::dynamic(ball(at, 35.0)).max_speed(1.0).reported_on_expiry();
        let (id, mut query) = (scene.insert(silent).unwrap(), Query::new());
        let mut times = |scene: &Scene| query.run(scene, &eye).visible().iter().filter(|&&o| o == id).count();
        assert_eq!(times(&scene), 1);
        // A frame without its report, after one without a result: it may be anywhere.
        assert_eq!(scene.begin_frame(1.0).unwrap(), [id]);
        assert_eq!(times(&scene), 1, "{far}");
        scene.update(id, ball(at + 0.1, 35.0), None).unwrap();
        assert_eq!(times(&scene), 1);
        // Behind the wall.
        scene.update(id, ball(30.0, 10.0), None).unwrap();
        assert_eq!(times(&scene), 0);
        assert_eq!(scene.begin_frame(2.0).unwrap(), [id]);
        assert_eq!(times(&scene), 1, "its old place is hidden");
    }
}

#[test]
fn in_an_open_zone_the_overdue_are_in_the_set_once_too() {
    let mut scene = empty();
    let ball = |i: u8| Sphere::new(Vec3::new(80.0, 12.5, 10.0 + f32::from(i)), 0.2);
    let insert = |i| {
        let desc = ObjectDesc::dynamic(ball(i)).max_speed(1.0);
        scene.insert(if i % 2 == 0 { desc.reported_on_expiry() } else { desc }).unwrap()
    };
    let mut ids: Vec<_> = (0..8).map(insert).collect();
    scene.begin_frame(1.0).unwrap();
    ids.sort_unstable();
    assert_eq!(sorted(Query::new().run(&scene, &around(Vec3::splat(4.5)))), ids);
}
