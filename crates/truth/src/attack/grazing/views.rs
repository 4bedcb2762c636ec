//! Views of one place, and views that stand for many: with a reach, a turn, both; a view cell.
//! Views of parallel rays.

use casca::{CellOptions, Method, PointOptions, Query, View};
use glam::{DQuat, DVec3, Vec3};

use super::super::dice::{Dice, direction, turned, way};
use super::super::views::{Depth, Limits, Roams, TrueView, look, look_upright, outermost};
use super::rims::Start;
use super::stage::{Place, Stage, Witness};
use super::walls::SHAPES;
use crate::numeric::attack::{AS_TURNED, WITHIN_TURN};

const OBJECTS: u32 = 400;
/// Cameras in one cell.
const CAMERAS: u8 = 5;
/// Points that are asked for beside the objects.
const POINTS: u32 = 4000;

/// A camera, as the library takes it and as it is.
pub struct Camera {
    pub view: View,
    pub truth: TrueView,
    pub eye: DVec3,
    pub forward: Vec3,
}

/// What bounds a camera: nothing, or the sides of a picture.
pub fn limits(stage: &mut Stage, around: bool) -> Limits {
    let unit = stage.unit;
    let dice = &mut stage.dice;
    if around {
        return Limits::Around;
    }
    Limits::Camera {
        fov: dice.pick(&[1.0, 1.0, 1.5, 0.4, 2.2]),
        aspect: dice.between(0.7, 1.8),
        near: unit * dice.pick(&[0.01, 0.1]),
        far: unit * 1000.0,
        mirrored: dice.once_in(4),
        depth: dice.pick(&[Depth::Usual, Depth::Reversed, Depth::Infinite, Depth::Gl]),
        exact: !dice.once_in(5),
    }
}

/// A camera; `None` if its matrix is too coarse for where it is.
pub fn camera(eye: Vec3, forward: Vec3, up: Vec3, limits: &Limits, mask: u64) -> Option<Camera> {
    let (view, truth) = look_upright(eye, forward, up, limits).ok()?;
    let eye = truth.eye?;
    Some(Camera { view: view.with_layers(mask), truth, eye, forward })
}

/// Point queries of all kinds, and their names.
pub fn presets(dice: &mut Dice) -> Vec<(&'static str, Query)> {
    let degrees = dice.pick(&[0.25, 0.5, 1.0, 90.0 / 128.0, 90.0 / 256.0, 3.0]);
    let odd = PointOptions::new()
        .pixel_degrees(degrees)
        .refine_depth(dice.pick(&[6, 0, 12, 16]))
        .refine_squares(dice.pick(&[256, 16, 2048]))
        .min_pixels(dice.pick(&[128, 0, 300]));
    let all =
        [("fast", PointOptions::fast()), ("balanced", PointOptions::balanced()), ("other options", odd)];
    let tight = dice.once_in(4).then_some(("tight", PointOptions::tight()));
    all.into_iter()
        .chain(tight)
        .filter_map(|(name, options)| Some((name, Query::with_method(Method::Point(options)).ok()?)))
        .collect()
}

/// Plays a scene with views of one place.
pub fn play(mut stage: Stage, around: bool) -> Stage {
    let eye = stage.eye();
    let forward = direction(&mut stage.dice);
    let limits = limits(&mut stage, around);
    let mask = stage.mask();
    let up = forward.any_orthonormal_vector();
    let Some(base) = camera(eye, forward, up, &limits, mask) else { return stage };
    let walls = 8 + stage.dice.below(24);
    (0..walls).for_each(|_| stage.wall(|d| around || d.dot(forward) > 0.2, false));
    let reach = f64::from((stage.unit * 10f32.powf(stage.dice.between(-4.0, -0.4))).next_up());
    let angle = 10f64.powf(-3.0 + 2.6 * stage.dice.real());
    for number in 0..OBJECTS + POINTS {
        aim(&mut stage, &base, number, reach, angle, around);
    }
    let room = Roams::Box(way(&mut stage.dice).abs().as_vec3() * reach as f32);
    for number in 0..if around { (OBJECTS + POINTS) / 5 } else { 0 } {
        let truth = room.camera(&base.truth, &mut stage.dice);
        let start = Start::Eye(truth.eye.unwrap_or(base.eye));
        stage.aim(start, Place::Room, number < OBJECTS / 5, |_| true);
    }
    stage.insert_targets();
    let mut presets = presets(&mut stage.dice);
    let first = |w: &Witness| w.place == Place::View(0);
    for (name, query) in &mut presets {
        let pvs = query.run(&stage.scene, &base.view).clone();
        stage.check(name, mask, first, &pvs);
        stage.ask("sight", mask, first, query);
    }
    presets
        .extend([Method::cell(), Method::Frustum].map(|m| ("", Query::with_method(m).unwrap_or_default())));
    let ball = |reach: f64, turn: f64| Roams::Ball { reach: reach as f32, turn: turn as f32 };
    let opened: [(&str, Roams, &[Place]); 3] = [
        ("reach", ball(reach, 0.0), &[Place::Reach]),
        if around { ("view cell", room, &[Place::Room]) } else { ("turn", ball(0.0, angle), &[Place::Turn]) },
        ("reach and turn", ball(reach, angle), &[Place::Reach, Place::Turn, Place::Both]),
    ];
    for (name, roams, places) in opened {
        let Ok(view) = roams.open(base.view.clone()) else { continue };
        let view = view.with_layers(mask);
        let places = |w: &Witness| w.place == Place::View(0) || places.contains(&w.place);
        for (_, query) in &mut presets {
            let pvs = query.run(&stage.scene, &view).clone();
            stage.check(name, mask, places, &pvs);
            stage.ask("reach, sight", mask, places, query);
        }
    }
    stage
}

/// Aims at one object, or later at one point, from one of the eyes and by one of the cameras that
/// views stand for.
fn aim(stage: &mut Stage, base: &Camera, number: u32, reach: f64, angle: f64, around: bool) {
    let object = number < OBJECTS;
    let place = match number % 5 {
        0 | 1 => Place::View(0),
        2 => Place::Reach,
        _ if around => Place::Reach,
        3 => Place::Turn,
        _ => Place::Both,
    };
    let goes = matches!(place, Place::Reach | Place::Both);
    let turns = matches!(place, Place::Turn | Place::Both);
    let angle = f64::from(angle as f32) * WITHIN_TURN;
    if !around && number.is_multiple_of(7) {
        aside(stage, base, place, (if goes { reach } else { 0.0 }, if turns { angle } else { 0.0 }), object);
        return;
    }
    let mut at = base.eye;
    let mut past = None;
    if goes {
        // Mostly to where an eye sees most past an edge.
        let found = if stage.dice.once_in(4) { None } else { stage.outermost(base.eye, reach) };
        (at, past) = match found {
            Some((at, past)) => (at, Some(past)),
            None => (outermost(base.eye, way(&mut stage.dice), reach), None),
        };
    }
    let turn = if turns { turned(&mut stage.dice, angle) } else { DQuat::IDENTITY };
    let truth = base.truth.at(at, turn);
    let seen = |p: DVec3| around || truth.sight(p).is_some();
    let start = Start::Eye(at);
    if let Some(past) = past
        && stage.aim_past(start, place, past, object, &seen)
    {
        return;
    }
    stage.aim(start, place, object, seen);
}

/// Aims at an object closely inside a side or a corner of a camera's picture, which went and turned
/// as far out as it may.
fn aside(stage: &mut Stage, base: &Camera, place: Place, (reach, angle): (f64, f64), object: bool) {
    let dice = &mut stage.dice;
    let sides: Vec<DVec3> = base.truth.sides().collect();
    let side = sides[dice.below(sides.len() as u32) as usize];
    let next = sides[dice.below(sides.len() as u32) as usize];
    let ahead = base.forward.as_dvec3().normalize();
    let along = side.cross(next).normalize_or_zero();
    let along = along * along.dot(ahead).signum();
    // A corner, or the middle of the side.
    let inwards = (ahead - side * side.dot(ahead)).normalize();
    let border = if along.length() > 0.5 { along } else { inwards };
    // The view is opened by tilting the side until it keeps off its corners; the normal of that:
    let sine = angle.sin() / inwards.dot(border);
    let normal = side * (1.0 - sine * sine).max(0.0).sqrt() + inwards * sine.min(1.0);
    let out = (border - normal * normal.dot(border)).normalize_or(border);
    let turn = DQuat::from_rotation_arc(border, out);
    let turn = if angle > 0.0 { turn } else { DQuat::IDENTITY };
    let gap = 10f64.powf(-7.0 + 5.0 * dice.real());
    let inner = (turn * (border + (ahead - border) * gap)).normalize();
    let at = outermost(base.eye, -normal, reach);
    let truth = base.truth.at(at, turn);
    let seen = |p: DVec3| truth.sight(p).is_some();
    let far = f64::from(stage.unit) * 10f64.powf(0.5 + stage.dice.real());
    let point = super::stage::rounded(at + inner * far, normal);
    // A corner where the side cannot be tilted so far is farther away.
    let turned = 2.0 * turn.xyz().length().atan2(turn.w.abs());
    if turned <= angle * AS_TURNED && seen(point) {
        stage.aim_at(Start::Eye(at), place, (point, normal, SHAPES.len() - 1), object, &seen);
    }
}

/// Plays a scene with an orthographic view.
pub fn play_parallel(mut stage: Stage) -> Stage {
    let (eye, forward, mask) = (stage.eye(), direction(&mut stage.dice), stage.mask());
    let dice = &mut stage.dice;
    let limits = Limits::Parallel {
        half: stage.unit * dice.between(4.0, 20.0),
        aspect: dice.between(0.7, 1.6),
        near: stage.unit * -60.0,
        far: stage.unit * 60.0,
        mirrored: dice.once_in(4),
        depth: dice.pick(&[Depth::Usual, Depth::Reversed]),
        told: true,
    };
    let walls = 8 + dice.below(24);
    let Ok((view, truth)) = look(eye, forward, &limits) else { return stage };
    let view = view.with_layers(mask);
    (0..walls).for_each(|_| stage.wall(|_| true, false));
    let start = Start::Before(truth.direction(), f64::from(stage.unit) * 500.0);
    for number in 0..OBJECTS + POINTS {
        stage.aim(start, Place::View(0), number < OBJECTS, |p| truth.sight(p).is_some());
    }
    stage.insert_targets();
    for (_, query) in &mut presets(&mut stage.dice) {
        let pvs = query.run(&stage.scene, &view).clone();
        stage.check("parallel", mask, |_| true, &pvs);
        stage.ask("parallel, sight", mask, |_| true, query);
    }
    stage
}

/// Plays a scene with queries of [`Method::Cell`], all round and of narrow cameras: eyes at the
/// corners of a view cell.
pub fn play_cells(mut stage: Stage) -> Stage {
    let (eye, mask) = (stage.eye(), stage.mask());
    let walls = 6 + stage.dice.below(14);
    (0..walls).for_each(|_| stage.wall(|_| true, true));
    let mut cameras = Vec::new();
    for number in 0..=CAMERAS {
        let forward = direction(&mut stage.dice);
        let mut limits = limits(&mut stage, number == 0);
        if let Limits::Camera { fov, .. } = &mut limits {
            *fov = stage.dice.pick(&[0.05, 0.1, 0.3]);
        }
        let Some(camera) = camera(eye, forward, forward.any_orthonormal_vector(), &limits, mask) else {
            return stage;
        };
        if number > 0 {
            stage.wall(|d| d.dot(forward) > 0.98, true);
        }
        cameras.push(camera);
    }
    let grid = stage.scene.grid();
    let cell = grid.cell_of(eye.as_dvec3());
    let (min, max) = grid.cell_bounds(cell);
    for number in 0..1500 * cameras.len() {
        let dice = &mut stage.dice;
        let mut at = DVec3::from_array(std::array::from_fn(|i| {
            // The upper border belongs to the next cell.
            if dice.once_in(2) { min[i] } else { max[i].next_down() }
        }));
        match number % 8 {
            0 => at = eye.as_dvec3(),
            1 => at = (min + max) * 0.5 + way(dice) * (max - min).min_element() * 0.499,
            _ => {}
        }
        // A set is that of the eyes in no occluder.
        let outside = stage.walls.iter().all(|w| !w.wall.solid.may_hold(at));
        if outside && stage.scene.grid().cell_of(at) == cell {
            let of = number % cameras.len();
            let truth = cameras[of].truth.from(at);
            stage.aim(Start::Eye(at), Place::Cell(of as u8), true, |p| truth.sight(p).is_some());
        }
    }
    stage.insert_targets();
    for resolution in [256, 64, 1024] {
        let method = Method::Cell(CellOptions::new().mask_resolution(resolution));
        let Ok(mut query) = Query::with_method(method) else { continue };
        for (of, camera) in cameras.iter().enumerate() {
            let pvs = query.run(&stage.scene, &camera.view).clone();
            let way = if of == 0 { "cell" } else { "cell of a camera" };
            // The eye of a matrix may round into the cell beside: then the set is for it alone.
            let of_cell = pvs.view_cell().is_none_or(|own| own == cell);
            let is_served = |w: &Witness| of_cell || w.start == Start::Eye(eye.as_dvec3());
            let place = |w: &Witness| of == 0 || w.place == Place::Cell(of as u8);
            stage.check(way, mask, |w| is_served(w) && place(w), &pvs);
        }
    }
    stage
}
