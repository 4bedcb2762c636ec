//! Frames of random scenes: no query leaves out an object that a ray reaches.

use casca_plane::{Disc, Fusion, GridSpec, Method, ObjectDesc, Query, Rect, Scene, View};
use glam::{DVec2, UVec2, Vec2};
use proptest::prelude::*;

use crate::cases::cases;
use crate::scenes::{Kind, Random, World};

/// A viewer, with its query.
struct Viewer {
    query: Query,
    eye: Vec2,
}

impl Viewer {
    fn new(random: &mut Random, size: f32) -> Self {
        let method = if random.below(4) == 0 { Method::Point } else { Method::Cell };
        let mut query = Query::with_method(method).unwrap();
        let fusion =
            [Fusion::Masks, Fusion::Masks, Fusion::Straight, Fusion::LShaped][random.below(4) as usize];
        query.set_cell_options(query.cell_options().fusion(fusion)).unwrap();
        Self { query, eye: random.point(0.0, size) }
    }

    fn walk(&mut self, random: &mut Random, size: f32) {
        self.eye = match random.below(12) {
            0 => random.point(-3.0, size + 3.0),
            _ => self.eye + (random.point(0.0, 1.0) - 0.5),
        };
    }

    fn view(&self, random: &mut Random) -> (View, Vec2, f32) {
        let direction = Vec2::from_angle(random.between(0.0, 6.25));
        let half_angle = [std::f32::consts::PI, 0.4, 1.0, 2.0][random.below(4) as usize];
        (View::sector(self.eye, direction, half_angle).unwrap(), direction, half_angle)
    }
}

/// What a run of frames did.
#[derive(Debug, Default)]
struct Tally {
    hidden: usize,
    revealed: usize,
    expired: usize,
    left_out: usize,
    proven: usize,
}

/// Plays some frames and compares each set with rays.
fn play(seed: u64, frames: u32) -> Result<Tally, TestCaseError> {
    let mut random = Random(seed);
    let mut world = World::new(&mut random);
    let mut viewers: Vec<Viewer> =
        (0..1 + random.below(2)).map(|_| Viewer::new(&mut random, world.size)).collect();
    let (mut tally, mut now) = (Tally::default(), 0.0);
    for frame in 0..frames {
        let seconds = random.between(0.02, 0.2);
        now += f64::from(seconds);
        let due = world.scene.begin_frame(now).unwrap();
        tally.expired += due.len();
        for at in 0..world.actors.len() {
            world.actors[at].walk(&mut random, seconds, world.size);
            let actor = &world.actors[at];
            let shown = viewers.iter().any(|viewer| viewer.query.pvs().contains(actor.id));
            let asked = match actor.kind {
                Kind::Fixed => false,
                Kind::Honest | Kind::Liar => true,
                // A report may come late.
                Kind::Silent => (due.contains(&actor.id) || shown) && random.below(8) != 0,
            };
            if asked {
                world.report(at);
            }
        }
        if frame % 5 == 4 {
            let at = random.below(world.actors.len() as u64) as usize;
            let gone = world.actors.swap_remove(at);
            world.scene.remove(gone.id).unwrap();
            let kind = [Kind::Fixed, Kind::Honest, Kind::Silent][random.below(3) as usize];
            world.insert(&mut random, kind, gone.half, gone.hides);
        }
        for viewer in &mut viewers {
            viewer.walk(&mut random, world.size);
            let (view, direction, half_angle) = viewer.view(&mut random);
            viewer.query.run(&world.scene, &view);
            compare(&world, viewer, direction, half_angle, &mut tally)?;
        }
        let report = world.scene.end_frame(viewers.iter().map(|viewer| viewer.query.pvs())).unwrap();
        (tally.hidden, tally.revealed) = (tally.hidden + report.hidden, tally.revealed + report.revealed);
    }
    Ok(tally)
}

/// Checks a set against rays from eyes for which it must hold.
fn compare(
    world: &World,
    viewer: &Viewer,
    direction: Vec2,
    half_angle: f32,
    tally: &mut Tally,
) -> Result<(), TestCaseError> {
    let (eye, pvs) = (viewer.eye.as_dvec2(), viewer.query.pvs());
    let whole = half_angle > 3.1;
    let in_view =
        |p: DVec2| whole || direction.as_dvec2().angle_to(p - eye).abs() < f64::from(half_angle) - 1e-3;
    let grid = world.scene.grid();
    let mut eyes = vec![eye];
    if viewer.query.method() == Method::Cell {
        let (lo, hi) = grid.cell_bounds(grid.cell_of(eye));
        eyes.extend((0..9).map(|i| lo + (hi - lo) * DVec2::new(f64::from(i % 3), f64::from(i / 3)) * 0.5));
    }
    // An eye in an occluder sees as if that were not there.
    eyes.retain(|&eye| !world.blocks(eye));
    for (at, actor) in world.actors.iter().enumerate() {
        let seen = eyes.iter().any(|&eye| world.sees(eye, at, in_view));
        tally.proven += usize::from(seen);
        tally.left_out += usize::from(!pvs.contains(actor.id));
        prop_assert!(
            !seen || pvs.contains(actor.id),
            "{:?} {:?} {:?}",
            actor.kind,
            actor.id,
            viewer.query.method()
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn no_object_that_a_ray_reaches_is_left_out(seed: u64) {
        play(seed, 40)?;
    }
}

#[test]
fn the_frames_hide_reveal_and_expire() {
    let mut all = Tally::default();
    for seed in 0..20 {
        let one = play(seed, 40).unwrap();
        all.hidden += one.hidden;
        all.revealed += one.revealed;
        all.expired += one.expired;
        all.left_out += one.left_out;
        all.proven += one.proven;
    }
    assert!(all.hidden > 200 && all.revealed > 100 && all.expired > 100, "{all:?}");
    assert!(all.left_out > 2000 && all.proven > 2000, "{all:?}");
}

/// A long wall in the middle of a level, and a guard behind it.
fn level() -> (Scene, Query, View) {
    let mut scene = Scene::new(&GridSpec { min: Vec2::ZERO, cell: 1.0, dims: UVec2::splat(64) }).unwrap();
    let wall = Rect::new(Vec2::new(30.0, 0.0), Vec2::new(33.0, 64.0));
    scene.insert(ObjectDesc::fixed(wall).occluder(wall)).unwrap();
    (scene, Query::with_method(Method::Cell).unwrap(), View::all_round(Vec2::new(10.5, 30.5)).unwrap())
}

#[test]
fn a_hidden_guard_costs_nothing_until_its_volume_is_left() {
    let (mut scene, mut query, view) = level();
    let at = |x: f32| Disc::new(Vec2::new(48.5 + x, 30.5), 0.4);
    let guard = scene.insert(ObjectDesc::dynamic(at(0.0)).max_speed(4.0)).unwrap();
    assert!(!query.run(&scene, &view).contains(guard));
    assert_eq!(scene.end_frame([query.pvs()]).unwrap().hidden, 1);
    let outline = scene.volume_outline(guard).unwrap();
    assert!(outline.len() > 8);
    for x in [0.3, -0.6, 1.2] {
        scene.update(guard, at(x), None).unwrap();
        query.run(&scene, &view);
        assert_eq!(query.pvs().stats().tbvs_revealed, 0);
        let report = scene.end_frame([query.pvs()]).unwrap();
        assert_eq!((report.drawn, report.revealed), (0, 0));
        assert_eq!(scene.volume_outline(guard).unwrap(), outline);
    }
    // Out of the volume, faster than promised: the next one is made to last longer.
    let before = scene.validity(guard).unwrap().unwrap();
    scene.update(guard, at(12.0), None).unwrap();
    assert!(scene.validity(guard).unwrap().unwrap() > before);
    assert_ne!(scene.volume_outline(guard).unwrap(), outline);
    // Before the wall: seen, shorter, and listed again.
    scene.update(guard, at(-30.0), None).unwrap();
    assert!(query.run(&scene, &view).contains(guard));
    assert_eq!(scene.end_frame([query.pvs()]).unwrap().revealed, 1);
    assert!(scene.volume_outline(guard).unwrap().is_empty());
    assert!(scene.validity(guard).unwrap().unwrap() < before * 1.25);
}

#[test]
fn a_silent_guard_is_due_when_it_could_have_left_and_visible_until_found() {
    let (mut scene, mut query, view) = level();
    let guard = Disc::new(Vec2::new(48.5, 30.5), 0.4);
    let guard_id = scene.insert(ObjectDesc::dynamic(guard).max_speed(2.0).reported_on_expiry()).unwrap();
    query.run(&scene, &view);
    scene.end_frame([query.pvs()]).unwrap();
    let mut due_at = Vec::new();
    for frame in 1..2000 {
        let now = f64::from(frame) / 60.0;
        let due = scene.begin_frame(now).unwrap();
        if due.contains(&guard_id) {
            // No report yet: visible, whatever the method.
            for method in [Method::Cell, Method::Point, Method::Sector] {
                assert!(Query::with_method(method).unwrap().run(&scene, &view).contains(guard_id));
            }
            due_at.push(frame);
            scene.update(guard_id, guard, None).unwrap();
        }
        assert!(!query.run(&scene, &view).contains(guard_id), "{frame}");
        scene.end_frame([query.pvs()]).unwrap();
    }
    // Each volume lasts longer than the one before, as far as radii allow: a dozen reports in half
    // a minute.
    assert!((5..20).contains(&due_at.len()), "{due_at:?}");
    let pauses: Vec<i32> = due_at.windows(2).map(|w| w[1] - w[0]).collect();
    assert!(pauses.is_sorted() && pauses[0] >= 30, "{pauses:?}");
    // A jump is only known from the report, which may put it anywhere.
    scene.update(guard_id, Disc::new(Vec2::new(20.5, 30.5), 0.4), None).unwrap();
    assert!(query.run(&scene, &view).contains(guard_id));
}

#[test]
fn a_viewer_in_a_volume_reveals_it() {
    let (mut scene, mut query, view) = level();
    let guard = Disc::new(Vec2::new(48.5, 30.5), 0.4);
    let guard_id = scene.insert(ObjectDesc::dynamic(guard).max_speed(9.0)).unwrap();
    query.run(&scene, &view);
    scene.end_frame([query.pvs()]).unwrap();
    // A block behind the guard hides the outline from an eye inside.
    let block = Rect::new(Vec2::new(50.0, 27.0), Vec2::new(52.0, 34.0));
    scene.insert(ObjectDesc::fixed(block).occluder(block)).unwrap();
    for method in [Method::Cell, Method::Point] {
        let mut query = Query::with_method(method).unwrap();
        let inside = View::sector(Vec2::new(45.5, 30.5), Vec2::X, 0.2).unwrap();
        assert!(query.run(&scene, &inside).contains(guard_id), "{method:?}");
    }
}

#[test]
fn a_silent_guard_is_in_its_volume_until_it_is_due() {
    let (mut scene, mut query, view) = level();
    for direction in [Vec2::X, Vec2::NEG_Y, Vec2::ONE.normalize()] {
        let at = |now: f64| Disc::new(Vec2::new(44.5, 30.5) + direction * (3.0 * now) as f32, 0.4);
        let desc = ObjectDesc::dynamic(at(0.0)).max_speed(3.0).reported_on_expiry();
        scene.begin_frame(0.0).unwrap();
        let guard = scene.insert(desc).unwrap();
        query.run(&scene, &view);
        scene.end_frame([query.pvs()]).unwrap();
        let outline = scene.volume_outline(guard).unwrap();
        // All cells whose centres are that far from the middle are in the circle; a point is at
        // most half a diagonal from a centre.
        let middle = (outline.iter().map(|c| c.as_dvec2()).sum::<DVec2>() / outline.len() as f64).round();
        let radius = outline.iter().map(|c| (c.as_dvec2() - middle).abs().max_element()).fold(0.0, f64::max);
        for frame in 1.. {
            let now = f64::from(frame) / 240.0;
            if scene.begin_frame(now).unwrap().contains(&guard) {
                break;
            }
            let Disc { center, radius: body } = at(now);
            let reach = center.as_dvec2().distance(middle + 0.5) + f64::from(body);
            assert!(
                reach + std::f64::consts::FRAC_1_SQRT_2 <= radius + 1e-9,
                "{direction} {now}: {reach} {radius}"
            );
        }
        scene.remove(guard).unwrap();
    }
}

#[test]
fn an_occluder_that_is_due_hides_nothing_until_it_is_found() {
    let spec = GridSpec { min: Vec2::ZERO, cell: 1.0, dims: UVec2::splat(40) };
    let mut scene = Scene::new(&spec).unwrap();
    let door = Rect::new(Vec2::new(12.0, 4.0), Vec2::new(14.0, 30.0));
    let desc = ObjectDesc::dynamic(door).occluder(door).max_speed(1.0).reported_on_expiry();
    let door_id = scene.insert(desc).unwrap();
    let behind = scene.insert(ObjectDesc::fixed(Disc::new(Vec2::new(20.5, 17.5), 0.4))).unwrap();
    let view = View::all_round(Vec2::new(6.5, 17.5)).unwrap();
    for method in [Method::Cell, Method::Point] {
        let mut query = Query::with_method(method).unwrap();
        scene.update(door_id, door, Some(door.into())).unwrap();
        assert!(!query.run(&scene, &view).contains(behind), "{method:?}");
        scene.end_frame([query.pvs()]).unwrap();
        scene.begin_frame(scene.now() + 1.0).unwrap();
        let pvs = query.run(&scene, &view);
        assert!(pvs.contains(behind) && pvs.contains(door_id), "{method:?}");
    }
}

#[test]
fn an_eye_in_a_rock_sees_past_it() {
    let spec = GridSpec { min: Vec2::ZERO, cell: 1.0, dims: UVec2::splat(40) };
    let mut scene = Scene::new(&spec).unwrap();
    let rock = Rect::new(Vec2::new(4.0, 4.0), Vec2::new(14.0, 30.0));
    scene.insert(ObjectDesc::fixed(rock).occluder(rock)).unwrap();
    let behind = scene.insert(ObjectDesc::fixed(Disc::new(Vec2::new(20.5, 17.5), 0.4))).unwrap();
    let mut query = Query::with_method(Method::Cell).unwrap();
    let run = |query: &mut Query, x: f32| {
        let pvs = query.run(&scene, &View::all_round(Vec2::new(x, 17.5)).unwrap());
        (pvs.contains(behind), pvs.stats().eye_in_occluder)
    };
    assert_eq!(run(&mut query, 4.25), (true, true));
    assert_eq!(run(&mut query, 2.25), (false, false));
    assert!(!query.seen_cells(&scene).unwrap().get(20, 17));
}
