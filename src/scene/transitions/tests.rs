//! Each row of the table of calls in `scene::home`, played.

use std::sync::Arc;

use glam::{IVec3, Vec3};

use super::*;
use crate::geometry::{Aabb, Plane, Sphere};
use crate::id::ObjectId;
use crate::mesh::TriMesh;
use crate::object::ObjectDesc;
use crate::query::Query;
use crate::scene::clock::WORTH_ASKING;
use crate::view::View;

/// Whether an object is listed or in a volume, and whether it is overdue there.
#[derive(Debug, Clone, Copy, PartialEq)]
enum HomeKind {
    Listed,
    Overdue,
    InVolume,
    Expired,
    Gone,
}
use HomeKind::{Expired, Gone, InVolume, Listed, Overdue};

/// Before the wall, with the eye; behind it; and outside the grid.
const BEFORE: f32 = 5.5;
const BEHIND: f32 = 20.0;
const OUTSIDE: f32 = 2e6;
/// Seconds in which the ball hardly moves.
const MOMENT: f64 = 1e-6;

/// A wall that parts the grid, and a ball.
struct WallAndBall {
    scene: Scene,
    ball: ObjectId,
    /// The volume of the ball when it was prepared.
    volume: Option<Tbv>,
}

fn ball(x: f32) -> Sphere {
    Sphere::new(Vec3::new(x, 16.5, 16.5), 0.5)
}

impl WallAndBall {
    fn new(x: f32, on_expiry: bool) -> Self {
        let mut scene = Scene::new(1.0).unwrap();
        let wall = Aabb::new(Vec3::new(8.0, 0.0, 0.0), Vec3::new(10.0, 32.0, 32.0));
        scene.insert(ObjectDesc::fixed(wall).occluder(wall)).unwrap();
        let desc = ObjectDesc::dynamic(ball(x));
        let desc = if on_expiry { desc.max_speed(1.0).reported_on_expiry() } else { desc };
        let ball = scene.insert(desc).unwrap();
        Self { scene, ball, volume: None }
    }

    /// A world whose ball is hidden.
    fn hidden(on_expiry: bool) -> Self {
        let mut world = Self::new(BEHIND, on_expiry).seen_from(2.5);
        world.volume = Some(world.hiding().tbv);
        world
    }

    fn begin(mut self, now: f64) -> Self {
        self.scene.begin_frame(now).unwrap();
        self
    }

    fn update(mut self, x: f32) -> Self {
        self.scene.update(self.ball, ball(x), None).unwrap();
        self
    }

    fn end(mut self, view: &View) -> Self {
        let mut query = Query::new();
        query.run(&self.scene, view);
        self.scene.end_frame([query.pvs()]).unwrap();
        self
    }

    /// Ends a frame with a view all around a point on the axis of the ball's motion.
    fn seen_from(self, x: f32) -> Self {
        self.end(&View::omnidirectional(Vec3::new(x, 16.5, 16.5)).unwrap())
    }

    /// Ends a frame with a view of the half-space beyond `x` only, which has no occluders before
    /// the ball.
    fn seen_beyond(self, x: f32) -> Self {
        let plane = Plane { normal: Vec3::X, offset: -x };
        self.end(&View::from_planes(Vec3::new(28.5, 16.5, 16.5), &[plane]).unwrap())
    }

    fn remove(mut self) -> Self {
        self.scene.remove(self.ball).unwrap();
        self
    }

    fn hiding(&self) -> Hidden {
        assert_eq!(self.kind(), InVolume);
        *self.scene.find(self.ball).unwrap().volume().unwrap()
    }

    fn kind(&self) -> HomeKind {
        let Ok(object) = self.scene.find(self.ball) else { return Gone };
        match (object.is_expired(), object.is_hidden(), self.scene.is_unlocated(self.ball.slot())) {
            (true, false, true) => Expired,
            (false, true, false) => InVolume,
            (false, false, true) => Overdue,
            (false, false, false) => Listed,
            other => panic!("{other:?}"),
        }
    }

    /// Whether the ball is in the volume that it had when it was prepared.
    fn keeps_its_volume(&self) -> bool {
        Some(self.hiding().tbv) == self.volume
    }
}

fn plain_listed() -> WallAndBall {
    WallAndBall::new(BEFORE, false)
}

fn listed() -> WallAndBall {
    WallAndBall::new(BEFORE, true)
}

fn overdue() -> WallAndBall {
    listed().begin(1.0)
}

fn hidden() -> WallAndBall {
    WallAndBall::hidden(true)
}

fn plain_hidden() -> WallAndBall {
    WallAndBall::hidden(false)
}

/// A world whose ball could leave its volume at once.
fn expired_soon() -> WallAndBall {
    let world = hidden();
    let wall = world.hiding().tbv.block.max.x as f32;
    world.update(wall - 0.55).begin(0.1)
}

/// A world in which the next frame after the first came late.
fn expired_late() -> WallAndBall {
    hidden().begin(100.0)
}

fn expired() -> WallAndBall {
    let frames = (1..=WORTH_ASKING).map(|frame| frame as f64 * MOMENT);
    frames.fold(hidden(), WallAndBall::begin).begin(100.0)
}

fn revealed() -> WallAndBall {
    hidden().begin(0.01).seen_from(28.5)
}

/// A world whose ball was reported nearer to the middle of its volume than before: its expiry is
/// put off.
fn put_off() -> WallAndBall {
    let world = hidden();
    let first = world.hiding().expires;
    let world = world.begin(0.5 * first).update(BEHIND - 0.001);
    let hiding = world.hiding();
    assert!(hiding.queued == first && hiding.expires > first);
    world.begin(first.next_up())
}

#[test]
fn every_call_changes_states_as_the_table_says() {
    /// Name, world before with the state of its ball, the call, and the state after it.
    type Row = (&'static str, fn() -> WallAndBall, HomeKind, fn(WallAndBall) -> WallAndBall, HomeKind);
    let table: [Row; 35] = [
        ("begin: no report yet", listed, Listed, |w| w.begin(1.0), Overdue),
        ("begin: reports when moved", plain_listed, Listed, |w| w.begin(1.0), Listed),
        ("begin: still no report", overdue, Overdue, |w| w.begin(2.0), Overdue),
        ("begin: not yet due", hidden, InVolume, |w| w.begin(0.01), InVolume),
        ("begin: put off", put_off, InVolume, |w| w, InVolume),
        ("begin: due", hidden, InVolume, |w| w.begin(100.0), Expired),
        ("begin: backwards", hidden, InVolume, |w| w.begin(-1.0), Expired),
        ("begin: never due", plain_hidden, InVolume, |w| w.begin(100.0), InVolume),
        ("begin: expired before", expired, Expired, |w| w.begin(200.0), Expired),
        ("begin: revealed before", revealed, Overdue, |w| w.begin(200.0), Overdue),
        ("update: overdue", overdue, Overdue, |w| w.update(BEFORE), Listed),
        ("update: listed", listed, Listed, |w| w.update(BEHIND), Listed),
        ("update: inside", hidden, InVolume, |w| w.update(BEHIND + 0.1), InVolume),
        ("update: outside", hidden, InVolume, |w| w.update(14.0), InVolume),
        ("end: outside", hidden, InVolume, |w| w.update(14.0).seen_from(2.5), InVolume),
        ("update: outside, reports when moved", plain_hidden, InVolume, |w| w.update(14.0), Listed),
        ("update: no volume fits", plain_hidden, InVolume, |w| w.update(OUTSIDE), Listed),
        ("update: expired, inside", expired, Expired, |w| w.update(BEHIND), InVolume),
        ("update: expired, outside", expired, Expired, |w| w.update(14.0), InVolume),
        ("end: expired, outside", expired, Expired, |w| w.update(14.0).seen_from(2.5), InVolume),
        ("update: expired, no volume fits", expired, Expired, |w| w.update(2.5), Listed),
        ("update: expired late, inside", expired_late, Expired, |w| w.update(BEHIND), InVolume),
        ("update: expired soon, inside", expired_soon, Expired, |w| w.update(BEHIND), Listed),
        (
            "update: expired soon, and unseen",
            expired_soon,
            Expired,
            |w| w.update(BEHIND).seen_from(2.5),
            Listed,
        ),
        ("update: revealed", revealed, Overdue, |w| w.update(BEHIND), Listed),
        ("end: unseen", || WallAndBall::new(BEHIND, true), Listed, |w| w.seen_from(2.5), InVolume),
        (
            "end: unseen, no volume fits",
            || WallAndBall::new(OUTSIDE, false),
            Listed,
            |w| w.seen_from(2.5),
            Listed,
        ),
        ("end: seen", listed, Listed, |w| w.seen_from(2.5), Listed),
        ("end: overdue", overdue, Overdue, |w| w.seen_from(28.5), Overdue),
        ("end: not revealed", hidden, InVolume, |w| w.seen_from(2.5), InVolume),
        ("end: revealed, on expiry", hidden, InVolume, |w| w.seen_from(28.5), Overdue),
        ("end: revealed, seen", plain_hidden, InVolume, |w| w.seen_from(28.5), Listed),
        ("end: revealed, unseen", plain_hidden, InVolume, |w| w.seen_beyond(21.2), InVolume),
        ("end: expired", expired, Expired, |w| w.seen_from(2.5), Expired),
        ("end: revealed before", revealed, Overdue, |w| w.seen_from(2.5), Overdue),
    ];
    for (name, prepare, from, act, to) in table {
        let world = prepare();
        assert_eq!(world.kind(), from, "{name}: before");
        let world = act(world);
        assert_eq!(world.kind(), to, "{name}: after");
    }
    for prepare in [listed, overdue, hidden, plain_hidden, expired, revealed] {
        assert_eq!(prepare().remove().kind(), Gone);
    }
}

#[test]
fn volumes_are_kept_while_they_serve() {
    assert!(put_off().keeps_its_volume());
    assert!(hidden().update(BEHIND + 0.1).keeps_its_volume());
    assert!(!hidden().update(14.0).seen_from(2.5).keeps_its_volume());
    assert!(expired().update(BEHIND).keeps_its_volume());
    assert!(!expired().update(14.0).seen_from(2.5).keeps_its_volume());
    assert!(!plain_hidden().seen_beyond(21.2).keeps_its_volume());
}

#[test]
fn nothing_is_left_of_a_removed_object() {
    for prepare in [plain_listed, listed, overdue, hidden, plain_hidden, expired, revealed] {
        let WallAndBall { scene, .. } = prepare().remove();
        assert_eq!((scene.id_matrix().entries(), scene.tbv_matrix().volumes()), (wall_entries(), 0));
        assert!(scene.listed_movers().is_empty() && scene.always().is_empty());
        assert!(!scene.any_overdue());
        assert_eq!(scene.opacity.overdue(), 0);
    }
}

/// Entries of I for the wall alone.
fn wall_entries() -> usize {
    WallAndBall::new(BEFORE, false).remove().scene.id_matrix().entries()
}

#[test]
fn an_expiry_is_void_once_its_slot_has_another_object() {
    let mut world = hidden().remove();
    let next = world.scene.insert(ObjectDesc::dynamic(ball(BEHIND))).unwrap();
    assert_eq!(next.index(), world.ball.index());
    world.ball = next;
    let mut world = world.seen_from(2.5);
    assert_eq!(world.kind(), InVolume);
    assert_eq!(world.scene.begin_frame(100.0).unwrap(), []);
    assert_eq!(world.kind(), InVolume);
}

#[test]
fn only_small_objects_rest_after_a_volume_that_did_not_last() {
    for (radius, last) in [(0.5, Listed), (4.0, InVolume)] {
        let ball = Sphere { radius, ..ball(BEHIND) };
        let desc = ObjectDesc::dynamic(ball).max_speed(1.0).reported_on_expiry();
        let mut world = WallAndBall::new(BEHIND, true).remove();
        world.ball = world.scene.insert(desc).unwrap();
        world = world.seen_from(2.5);
        assert_eq!(world.kind(), InVolume);
        world = world.begin(0.01).seen_from(28.5);
        assert_eq!(world.kind(), Overdue);
        world = world.begin(0.02);
        world.scene.update(world.ball, ball, None).unwrap();
        assert_eq!(world.seen_from(2.5).kind(), last, "{radius}");
    }
}

/// Boxes of triangles, one inside of the other.
fn boxes(count: u32, x: f32) -> Arc<TriMesh> {
    let corner = |i: u32, half: f32| {
        let side = |bit: u32| [-half, half][(i >> bit & 1) as usize];
        Vec3::new(x, 16.0, 16.0) + Vec3::new(side(0), side(1), side(2))
    };
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = |number: u32| {
        let of_face = move |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]].map(|t| t.map(|i| i + 8 * number));
        faces.into_iter().flat_map(of_face)
    };
    let positions = (0..count).flat_map(|number| (0..8).map(move |i| corner(i, 4.2 - 3.0 * number as f32)));
    Arc::new(TriMesh::new(positions.collect(), (0..count).flat_map(triangles).collect()).unwrap())
}

#[test]
fn an_occluder_without_numbers_leaves_no_opaque_cells() {
    for used_up in [false, true] {
        let mut scene = Scene::new(1.0).unwrap();
        let (one, two, far) = (boxes(1, 8.0), boxes(2, 8.0), boxes(2, 24.0));
        let id = scene.insert(ObjectDesc::dynamic(one.clone()).occluder(one)).unwrap();
        let opaque = |scene: &Scene, x| scene.is_opaque(IVec3::new(x, 12, 16), u64::MAX);
        assert!(opaque(&scene, 8));
        if used_up {
            scene.seams.use_up();
        }
        scene.update(id, two.clone(), Some(two.into())).unwrap();
        assert_eq!(opaque(&scene, 8), !used_up);
        scene.update(id, far.clone(), Some(far.into())).unwrap();
        assert_eq!((opaque(&scene, 8), opaque(&scene, 24)), (false, !used_up));
    }
}
