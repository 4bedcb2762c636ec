//! Views with a reach: meshes hide only what no eye within the reach sees.

use casca_scenes::world::Camera;

use crate::common::*;
use crate::forms::{self, Recipe, places};
use crate::rays::Eye;
use crate::{
    Frame, SIZE, Solid, Tested, Thing, World, blocker_of, eye_at, eye_of, frame, look, lost, options, solid,
    targets, view_of, world,
};

/// An eye moved by a step, without turning.
fn moved(eye: &Eye, step: Vec3) -> Eye {
    let camera =
        |c: &Camera| Camera { eye: c.eye + step, view: c.view * Mat4::from_translation(-step), ..*c };
    match eye {
        Eye::Around(at) => Eye::Around(*at + step),
        Eye::Camera(c) => Eye::Camera(camera(c)),
        Eye::Parallel(c, forward) => Eye::Parallel(camera(c), *forward),
    }
}

/// Steps in and on a ball.
fn steps(reach: f64, count: usize, seed: u64) -> Vec<Vec3> {
    let mut random = Random(seed);
    let mut step = |i: usize| {
        let d = random.vector(-1.0, 1.0);
        let d = if i.is_multiple_of(4) { d.clamp_length_max(1.0) } else { d.normalize_or(DVec3::Y) };
        (d * reach * 0.999).as_vec3()
    };
    (0..count).map(&mut step).collect()
}

/// Small boxes behind the edges, holes and triangles that eyes on a ball see.
fn add_targets(world: &mut World, at: Vec3, steps: &[Vec3], frame: Frame, count: usize, seed: u64) {
    for (step, i) in steps.iter().zip(0..) {
        for (min, max) in targets(at + *step, &world.things, &world.made, frame, count, seed ^ i) {
            let id = world.scene.fixed(Aabb::new(min, max));
            world.things.push(Thing { id, tested: Tested::Box(min, max), blocker: None });
        }
    }
}

/// What eyes beside that of a view see of a world is in its set.
fn are_served(
    world: &World,
    (method, view): (Method, View),
    steps: &[Vec3],
    eye: impl Fn(Vec3) -> Eye,
    (count, seed): (usize, u64),
) -> Result<(), TestCaseError> {
    let mut query = query_by(method);
    let pvs = query.run(&world.scene, &view);
    for (step, i) in steps.iter().zip(0..) {
        let eye = eye(*step);
        let lost = lost(&world.things, &eye, |id| !pvs.contains(id), count, seed ^ i);
        prop_assert!(lost.is_none(), "{lost:?} from {eye:?}, {view:?}");
    }
    Ok(())
}

fn reach() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.01), 0.0..0.3f64, 0.0..1.0f64, 0.0..3.0f64]
}

/// Where the eyes of a view are.
#[derive(Debug, Clone)]
enum Room {
    Ball(f64),
    /// Half of the edges of a view cell, from which one looks all round.
    Cell(DVec3),
}

fn room() -> impl Strategy<Value = Room> {
    let half = prop::array::uniform3(prop_oneof![Just(0.0), 0.0..0.3f64, 0.0..1.0f64]);
    prop_oneof![reach().prop_map(Room::Ball), half.prop_map(|half| Room::Cell(half.into()))]
}

proptest! {
    #![proptest_config(cases(320))]

    #[test]
    fn meshes_hide_from_all_eyes_of_a_view(
        solids in prop::collection::vec(solid(), 1..7),
        look in look(),
        room in room(),
        frame in frame(),
        methods in options(),
        seed in any::<u64>(),
    ) {
        let mut world = world(&solids, frame, 16);
        let at = eye_at(&look.stand, &world.things, solids.len(), frame);
        let (eye, view, steps) = match room {
            Room::Ball(reach) => {
                let (eye, reach) = (eye_of(&look, at, frame), reach * frame.scale);
                let view = view_of(&eye).and_then(|view| view.with_reach(reach as f32));
                (eye, view, steps(reach, 12, seed))
            }
            Room::Cell(half) => {
                let half = (half * frame.scale).as_vec3();
                let cell = Aabb::new(at - half, at + half);
                let mut random = Random(seed);
                let mut eye = |_| (at + half * random.vector(-1.5, 1.5).as_vec3()).clamp(cell.min, cell.max);
                let steps = (0..12).map(|i| eye(i) - at).collect();
                (Eye::Around(at), View::of_cell(cell), steps)
            }
        };
        add_targets(&mut world, at, &steps, frame, 12, seed);
        // Far from the origin a matrix may be no camera any more.
        if let Ok(view) = view {
            are_served(&world, (methods[0], view), &steps, |step| moved(&eye, step), (12, seed))?;
        }
    }
}

proptest! {
    #![proptest_config(cases(320))]

    #[test]
    fn spikes_beside_the_eye_hide_what_no_eye_sees(seed in any::<u64>(), reach in 0.0..0.9f64) {
        let mut random = Random(seed);
        let (foot, wide, lean) = (random.direction(), random.within(0.02, 0.4), random.vector(-1.0, 1.0));
        let tip = foot + (foot.any_orthonormal_vector() + lean) * random.within(2.0, 12.0);
        let mut corner = || (foot + random.vector(-wide, wide)).as_vec3();
        let corners = vec![corner(), corner(), corner(), tip.as_vec3()];
        let spike = mesh(corners, vec![[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]);
        let (mut scene, blocker) = (empty(), blocker_of(&spike, None, false));
        let tested = Tested::Triangles(blocker.triangles.clone());
        let mut things = vec![Thing { id: scene.solid(spike), tested, blocker: Some(blocker) }];
        for _ in 0..100 {
            let at = (random.direction() * random.within(2.0, 40.0)).as_vec3();
            things.push(Thing { id: scene.fixed(Aabb::new(at, at)), tested: Tested::Box(at, at), blocker: None });
        }
        let world = World { scene, things, meshes: Vec::new(), made: Vec::new() };
        let view = around(Vec3::ZERO).with_reach(reach as f32).unwrap();
        are_served(&world, (Method::point(), view), &steps(reach, 20, seed), Eye::Around, (1, seed))?;
    }

    #[test]
    fn sheets_drawn_in_many_batches_lose_nothing(
        n in 6..24u32, rough in any::<u64>(), share in 0.0..0.3f64, angle in 0.0..80.0f32,
        size in 3.0..8.0f64, axis in prop::array::uniform3(-1.0..1.0f64), turn in 0.0..6.0f64,
        degrees in prop_oneof![0.5..4.0f32, 0.5..11.0f32], eye in places(0.0..16.0), seed in any::<u64>(),
        cells in prop_oneof![Just(64u32), Just(128)], reach in prop_oneof![Just(0.0), reach()],
        least in prop_oneof![3 => Just(0.0), 1 => Just(0.05)],
        form in prop_oneof![2 => Just(0), 1 => Just(1), 1 => Just(2)],
    ) {
        let form = [forms::Form::Terrain(n), forms::Form::Curved(n), forms::Form::Ball(n % 4)][form];
        let recipe = Recipe { form, center: [8.0; 3], size: [size; 3], axis, angle: turn,
            damage: vec![forms::Damage::Holes(share)], seed: rough };
        let frame = Frame { scale: 1.0, offset: 0.0 };
        let solids = vec![Solid { recipe, how: (Some(0.0), Some(least), Some(angle), false), boxed: false, occludes: true, moves: None }];
        let mut world = world(&solids, frame, cells);
        let at = Vec3::from_array(eye.map(|v| v as f32));
        let steps = steps(reach, 12, seed);
        add_targets(&mut world, at, &steps, frame, 24, seed);
        let options = PointOptions::default().pixel_degrees(degrees).min_pixels(0);
        let view = around(at).with_reach(reach as f32).unwrap();
        let method = Method::Point(options);
        are_served(&world, (method, view), &steps, |step| Eye::Around(at + step), (6, seed))?;
    }
}

const EYE: Vec3 = Vec3::new(16.0, 16.0, 6.0);

/// A scene around [`EYE`].
struct Stage {
    scene: Scene,
    query: Query,
}

impl Stage {
    fn new() -> Self {
        Self { scene: empty(), query: Query::new() }
    }

    fn wall(&mut self, positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) {
        self.scene.solid(mesh(positions, triangles));
    }

    /// A wall of rectangles across z, each with its own corners: two of x, two of y.
    fn rectangles(&mut self, z: f32, all: &[[f32; 4]]) {
        let corners = |&[x0, x1, y0, y1]: &[f32; 4]| [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
        let positions = all.iter().flat_map(corners).map(|[x, y]| Vec3::new(x, y, z)).collect();
        let triangles =
            (0..all.len() as u32).map(|i| 4 * i).flat_map(|i| [[i, i + 1, i + 2], [i, i + 2, i + 3]]);
        self.wall(positions, triangles.collect());
    }

    fn ball(&mut self, at: Vec3) -> ObjectId {
        self.scene.fixed(Sphere::new(at, 0.05))
    }

    fn sees(&mut self, id: ObjectId, reach: f32) -> bool {
        let view = around(EYE).with_reach(reach).unwrap();
        self.query.run(&self.scene, &view).contains(id)
    }
}

/// Rectangles of a wall from 2 to 30 around a square hole.
fn around_hole(half: f32) -> [[f32; 4]; 8] {
    let (a, b) = (16.0 - half, 16.0 + half);
    // Corners meet corners.
    let (low, middle, high) = ([2.0, a], [a, b], [b, 30.0]);
    let at = |x: [f32; 2], y: [f32; 2]| [x[0], x[1], y[0], y[1]];
    [
        at(low, low),
        at(middle, low),
        at(high, low),
        at(low, middle),
        at(high, middle),
        at(low, high),
        at(middle, high),
        at(high, high),
    ]
}

#[test]
fn one_sees_past_the_rim_of_a_hole_as_wide_as_the_reach() {
    let mut room = Stage::new();
    room.rectangles(16.0, &around_hole(0.5));
    let beside = [17.2, 19.4].map(|x| room.ball(Vec3::new(x, 16.0, 24.0)));
    assert_eq!(beside.map(|id| room.sees(id, 0.0)), [false, false]);
    assert_eq!(beside.map(|id| room.sees(id, 0.5)), [true, false], "the rest of the wall hides as before");
}

#[test]
fn a_sheet_nearer_than_the_reach_hides_nothing() {
    for (z, tilt) in [(6.3, 0.0), (6.45, 0.2), (5.7, 0.0)] {
        let mut room = Stage::new();
        let corner = |x: f32, y: f32| Vec3::new(x, y, z + tilt * (x - 16.0));
        room.wall(
            vec![corner(2.0, 2.0), corner(30.0, 2.0), corner(30.0, 30.0), corner(2.0, 30.0)],
            vec![[0, 1, 2], [0, 2, 3]],
        );
        let behind = [20.0, 1.0].map(|z| room.ball(Vec3::new(16.0, 16.0, z)));
        assert_eq!(behind.map(|id| room.sees(id, 0.5)), [true, true], "{z}");
        assert!(behind.iter().any(|&id| !room.sees(id, 0.01)), "{z}: a smaller reach ends before the sheet");
    }
}

#[test]
fn a_sheet_beside_a_view_cell_hides_if_its_rim_is_far() {
    for (z, tilt, hides) in [(6.6, 0.0, true), (6.8, 0.05, true), (6.4, 0.0, false), (6.6, 0.3, false)] {
        let mut room = Stage::new();
        let corner = |x: f32, y: f32| Vec3::new(x, y, z + tilt * (x - 16.0));
        room.wall(
            vec![corner(2.0, 2.0), corner(30.0, 2.0), corner(30.0, 30.0), corner(2.0, 30.0)],
            vec![[0, 1, 2], [0, 2, 3]],
        );
        let behind = room.ball(Vec3::new(16.0, 16.0, 12.0));
        let view = View::of_cell(Aabb::new(EYE - 0.5, EYE + 0.5)).unwrap();
        assert_eq!(!room.query.run(&room.scene, &view).contains(behind), hides, "{z} {tilt}");
        assert!(room.sees(behind, 0.87), "{z} {tilt}: a ball around it meets the sheet, or nearly");
    }
    // A rim that is near opens all of it.
    let mut room = Stage::new();
    room.rectangles(6.6, &[[15.0, 30.0, 2.0, 30.0]]);
    let behind = room.ball(Vec3::new(22.0, 16.0, 8.0));
    let view = View::of_cell(Aabb::new(EYE - 0.5, EYE + 0.5)).unwrap();
    assert!(room.query.run(&room.scene, &view).contains(behind));
}

#[test]
fn walls_that_share_an_edge_hide_what_is_behind_it() {
    // The edge is nearer than the far ends of the walls, or farther away.
    for edge in [12.0, 20.0] {
        for objects in [1, 2] {
            let mut room = Stage::new();
            let [a, b, c] = [(4.0, 16.0), (16.0, edge), (28.0, 16.0)];
            let column = |(x, z): (f32, f32)| [Vec3::new(x, 2.0, z), Vec3::new(x, 30.0, z)];
            if objects == 1 {
                let all = [a, b, c].map(column).concat();
                room.wall(all, vec![[0, 2, 3], [0, 3, 1], [2, 4, 5], [2, 5, 3]]);
            } else {
                for pair in [[a, b], [b, c]] {
                    room.wall(pair.map(column).concat(), vec![[0, 2, 3], [0, 3, 1]]);
                }
            }
            let behind = [14.5, 16.0, 17.5].map(|x| room.ball(Vec3::new(x, 16.0, 26.0)));
            assert_eq!(behind.map(|id| room.sees(id, 0.4)), [false; 3], "{edge} {objects}");
            // An eye that goes by one unit sees it past the outer rim.
            let beside = room.ball(Vec3::new(29.65, 16.0, 17.5));
            assert!(room.sees(beside, 1.0), "{edge} {objects}");
        }
    }
}

#[test]
fn a_crack_without_width_opens_nothing() {
    let mut room = Stage::new();
    room.rectangles(16.0, &[[2.0, 16.1, 2.0, 30.0], [16.1, 30.0, 2.0, 30.0]]);
    let behind = [15.9, 16.1, 16.3, 16.7].map(|x| room.ball(Vec3::new(x, 16.0, 20.0)));
    assert_eq!(behind.map(|id| room.sees(id, 0.5)), [false; 4]);
}

#[test]
fn a_narrow_strip_along_a_rim_moves_the_rim_by_its_width_only() {
    // The strip is bent, so that it is a patch of its own.
    for bend in [0.0, 0.04, -0.04] {
        let mut room = Stage::new();
        let column = |x: f32, z: f32| [Vec3::new(x, 2.0, z), Vec3::new(x, 30.0, z)];
        let all = [column(2.0, 16.0), column(18.0, 16.0), column(18.05, 16.0 + bend)].concat();
        room.wall(all, vec![[0, 2, 3], [0, 3, 1], [2, 4, 5], [2, 5, 3]]);
        // From an eye that goes by half a unit to the right, the rim hides less.
        let at = |x: f32, reach: f32| EYE.x + reach + (x - EYE.x - reach) / 10.0 * 18.0;
        let seen = room.ball(Vec3::new(at(18.05, 0.5) + 0.1, 16.0, 24.0));
        let past = [-0.5, 0.5].map(|by| room.ball(Vec3::new(at(18.05, by), 16.0, 24.0)));
        let hidden = room.ball(Vec3::new(at(16.8, 0.0), 16.0, 24.0));
        assert!(room.sees(seen, 0.5) && past.iter().all(|&id| room.sees(id, 0.5)), "{bend}");
        assert!(!room.sees(hidden, 0.5), "{bend}");
    }
}

#[test]
fn panels_of_many_objects_hide_as_one_wall() {
    let options = PointOptions::default().pixel_degrees(1.0).min_pixels(0);
    let count = |gap: f32, reach: f32, instances: bool| {
        let mut room = Stage { query: query_by(Method::Point(options)), ..Stage::new() };
        for i in 0..196u8 {
            let (x, y) = (2.0 + 2.0 * f32::from(i % 14), 2.0 + 2.0 * f32::from(i / 14));
            let mesh = crate::walls::panel(x, y, 16.0, 2.0, 0.5 * gap);
            if instances {
                room.scene.solid(Instance::new(mesh, Affine3A::IDENTITY).unwrap());
            } else {
                room.scene.solid(mesh);
            }
        }
        let row: Vec<ObjectId> =
            (0..40u8).map(|i| room.ball(Vec3::new(12.0 + 0.2 * f32::from(i), 15.1, 20.0))).collect();
        let view = around(EYE).with_reach(reach).unwrap();
        let pvs = room.query.run(&room.scene, &view);
        row.iter().filter(|&&id| pvs.contains(id)).count()
    };
    for reach in [0.0, 0.01, 0.3, 1.0] {
        assert_eq!(count(0.0, reach, false), 0, "{reach}");
    }
    assert!(count(0.05, 0.3, false) > 10 && count(0.05, 0.3, true) > 10);
}

#[test]
fn sets_grow_with_the_reach() {
    const REACHES: [f32; 6] = [0.0, 0.01, 0.1, 0.3, 1.0, 3.0];
    let mut query = Query::new();
    for (boxes, rounds, solids, balls) in [(true, 40, 40, 100), (false, 12, 24, 80)] {
        let (mut random, mut sizes) = (Random(7), [0; REACHES.len()]);
        for _ in 0..rounds {
            let mut room = Stage::new();
            for i in 0..solids {
                let (center, size) = (random.vector(0.0, 2.0 * SIZE), random.vector(1.0, 4.0));
                if boxes {
                    room.scene.solid(Aabb::from_center(center.as_vec3(), size.as_vec3()));
                    continue;
                }
                let (points, triangles) = if i % 2 == 0 { forms::cuboid() } else { forms::ball(2) };
                room.wall(points.iter().map(|p| (*p * size + center).as_vec3()).collect(), triangles);
            }
            for _ in 0..balls {
                room.ball(random.vector(0.0, 2.0 * SIZE).as_vec3());
            }
            let view = around(random.vector(0.0, 2.0 * SIZE).as_vec3());
            let plain = query.run(&room.scene, &view).visible().to_vec();
            for (reach, size) in REACHES.iter().zip(&mut sizes) {
                let pvs = query.run(&room.scene, &view.clone().with_reach(*reach).unwrap());
                assert!(*reach > 0.0 || pvs.visible() == plain, "without a reach nothing changes");
                *size += pvs.len();
            }
        }
        assert!(sizes.is_sorted() && sizes[5] > sizes[0] * 3 / 2, "{boxes}: {sizes:?}");
    }
}
