//! Moving objects: a scene with temporal bounding volumes must find what a scene
//! without history finds, but for objects that rays prove to be hidden: a volume that
//! is wholly hidden may hide cells that the masks by themselves do not.

use casca::internals::SceneInternals;

use crate::common::worlds::cuts_box;
use crate::common::*;

const SIZE: f32 = 24.0;

/// More than the planes of a matrix are moved outwards for its rounding, in these scenes.
const WIDENED: f64 = 1e-4;

#[derive(Debug, Clone)]
enum Step {
    /// Moves object `who` (of those alive) by an offset, or to a place.
    Walk(usize, Vec3),
    Jump(usize, Vec3),
    Resize(usize, f32),
    Remove(usize),
    Insert(Vec3, f32, bool),
    AddWall(Vec3, Vec3),
    RemoveWall(usize),
    /// Ends the frame: time passes and these eyes look in these directions.
    Frame(f64, Vec<(Vec3, Vec3)>),
}

fn place() -> impl Strategy<Value = Vec3> {
    // Mostly in the grid, sometimes outside, sometimes on cell faces.
    let near = points(0.0..SIZE, 1.0);
    let faces = prop::array::uniform3(0..24u8).prop_map(|p| Vec3::from_array(p.map(f32::from)));
    let far = points(-2.0 * SIZE..3.0 * SIZE, 1.0);
    prop_oneof![8 => near, 1 => faces, 1 => far]
}

fn step() -> impl Strategy<Value = Step> {
    let offset = points(-0.6..0.6, 0.3);
    prop_oneof![
        12 => (any::<usize>(), offset).prop_map(|(w, o)| Step::Walk(w, o)),
        2 => (any::<usize>(), place()).prop_map(|(w, p)| Step::Jump(w, p)),
        1 => (any::<usize>(), 0.05..2.0f32).prop_map(|(w, r)| Step::Resize(w, r)),
        1 => any::<usize>().prop_map(Step::Remove),
        2 => (place(), 0.05..2.0f32, any::<bool>()).prop_map(|(p, r, b)| Step::Insert(p, r, b)),
        1 => (place(), points(0.0..9.0, 1.0)).prop_map(|(p, s)| Step::AddWall(p, s)),
        1 => any::<usize>().prop_map(Step::RemoveWall),
        8 => (0.0..0.5f64, prop::collection::vec((place(), direction()), 1..3)).prop_map(|(t, v)| Step::Frame(t, v)),
    ]
}

/// What the application knows of a moving object.
#[derive(Debug, Clone)]
struct Mover {
    id: ObjectId,
    center: Vec3,
    radius: f32,
    boxy: bool,
}

impl Mover {
    fn bounds(&self) -> Bounds {
        if self.boxy {
            Aabb::from_center(self.center, Vec3::splat(self.radius)).into()
        } else {
            Sphere::new(self.center, self.radius).into()
        }
    }
}

/// Indices of the movers that a scene without history finds visible.
fn found_afresh(movers: &[Mover], walls: &[(ObjectId, Aabb)], view: &View) -> BTreeSet<usize> {
    let mut scene = empty();
    for (_, wall) in walls {
        scene.solid(*wall);
    }
    let ids: Vec<_> = movers.iter().map(|m| scene.insert(ObjectDesc::dynamic(m.bounds())).unwrap()).collect();
    let mut query = Query::new();
    let pvs = query.run(&scene, view);
    ids.iter().enumerate().filter(|(_, id)| pvs.contains(**id)).map(|(i, _)| i).collect()
}

/// The camera of all tests: its field of view and aspect, and the distances of its planes.
const LENS: [f32; 4] = [1.2, 1.3, 0.05, 60.0];

fn view_of(eye: Vec3, direction: Vec3) -> View {
    looking(eye, direction, LENS)
}

/// A point of an object inside the clip volume with no wall before it, among a
/// thousand or so.
fn seen_point(eye: Vec3, clip: &Mat4, mover: &Mover, walls: &[(ObjectId, Aabb)]) -> Option<DVec3> {
    let (eye, clip) = (eye.as_dvec3(), clip.as_dmat4());
    (0..11 * 11 * 11).find_map(|i| {
        let t = DVec3::new(f64::from(i % 11), f64::from(i / 11 % 11), f64::from(i / 121)) / 5.0 - 1.0;
        let offset = if mover.boxy { t } else { t.normalize_or_zero() * t.abs().max_element() };
        let p = mover.center.as_dvec3() + offset * f64::from(mover.radius) * 0.999_999;
        let c = clip * p.extend(1.0);
        let inside = c.x.abs() <= c.w && c.y.abs() <= c.w && c.z >= 0.0 && c.z <= c.w;
        (inside && !walls.iter().any(|(_, wall)| cuts_box(wall, eye, p))).then_some(p)
    })
}

fn play(steps: Vec<Step>) -> Result<(), TestCaseError> {
    let mut scene = empty();
    let mut queries = [Query::new(), Query::new()];
    let (mut movers, mut walls): (Vec<Mover>, Vec<(ObjectId, Aabb)>) = (Vec::new(), Vec::new());
    let mut now = 0.0;
    for i in 0..12 {
        let center = Vec3::new((i % 4) as f32 * 6.0 + 2.0, 12.0, (i / 4) as f32 * 8.0 + 3.0);
        let mover = Mover {
            id: scene.insert(ObjectDesc::dynamic(Sphere::new(center, 0.5)).max_speed(2.0)).unwrap(),
            center,
            radius: 0.5,
            boxy: false,
        };
        movers.push(mover);
    }
    for x in [7.0, 15.0] {
        let wall = Aabb::new(Vec3::new(x, 0.0, 0.0), Vec3::new(x + 2.0, 20.0, SIZE));
        walls.push((scene.solid(wall), wall));
    }
    for step in steps {
        match step {
            Step::Walk(..) | Step::Jump(..) | Step::Resize(..) if movers.is_empty() => {}
            Step::Walk(who, by) => {
                let n = movers.len();
                let m = &mut movers[who % n];
                m.center += by;
                scene.update(m.id, m.bounds(), None).unwrap();
            }
            Step::Jump(who, to) => {
                let n = movers.len();
                let m = &mut movers[who % n];
                m.center = to;
                scene.update(m.id, m.bounds(), None).unwrap();
            }
            Step::Resize(who, radius) => {
                let n = movers.len();
                let m = &mut movers[who % n];
                m.radius = radius;
                scene.update(m.id, m.bounds(), None).unwrap();
            }
            Step::Remove(who) => {
                if !movers.is_empty() {
                    let m = movers.swap_remove(who % movers.len());
                    scene.remove(m.id).unwrap();
                    prop_assert!(scene.remove(m.id).is_err() && scene.bounds(m.id).is_err());
                }
            }
            Step::Insert(center, radius, boxy) => {
                let mut m = Mover { id: walls.first().map_or(movers[0].id, |w| w.0), center, radius, boxy };
                m.id = scene.insert(ObjectDesc::dynamic(m.bounds())).unwrap();
                movers.push(m);
            }
            Step::AddWall(at, size) => {
                let wall = Aabb::new(at, at + size);
                walls.push((scene.solid(wall), wall));
            }
            Step::RemoveWall(which) => {
                if walls.len() > 1 {
                    let (id, _) = walls.swap_remove(which % walls.len());
                    scene.remove(id).unwrap();
                }
            }
            Step::Frame(dt, eyes) => {
                now += dt;
                prop_assert!(scene.begin_frame(now).unwrap().is_empty());
                for ((eye, direction), query) in eyes.iter().zip(&mut queries) {
                    let view = view_of(*eye, *direction);
                    let pvs = query.run(&scene, &view);
                    let expect = found_afresh(&movers, &walls, &view);
                    let found: BTreeSet<usize> =
                        (0..movers.len()).filter(|&i| pvs.contains(movers[i].id)).collect();
                    prop_assert!(found.is_subset(&expect), "{found:?} beyond {expect:?} from {eye}");
                    for &i in expect.difference(&found) {
                        let seen = seen_point(*eye, &lens(*eye, *direction, LENS), &movers[i], &walls);
                        prop_assert!(seen.is_none(), "{:?} is seen at {seen:?} from {eye}", movers[i]);
                    }
                    prop_assert!(pvs.is_valid_for(&scene, &view));
                }
                scene.end_frame(queries.iter().take(eyes.len()).map(Query::pvs)).unwrap();
            }
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(128))]

    #[test]
    fn volumes_change_nothing_that_is_seen(steps in prop::collection::vec(step(), 1..120)) {
        play(steps)?;
    }

    #[test]
    fn unreported_objects_are_found_where_they_are(
        walks in prop::collection::vec((0.2..3.0f32, direction()), 1..12),
        views in prop::collection::vec((place(), direction()), 4..40),
        dt in 0.02..0.4f64,
    ) {
        let mut scene = empty();
        let wall = Aabb::new(Vec3::new(10.0, 0.0, 0.0), Vec3::new(12.0, SIZE, SIZE));
        let walls = [(scene.solid(wall), wall)];
        let mut movers: Vec<Mover> = walks.iter().enumerate().map(|(i, (speed, _))| {
            let (center, radius) = (Vec3::new(6.0 + i as f32, 12.0, 12.0), 0.4);
            let desc = ObjectDesc::dynamic(Sphere::new(center, radius)).max_speed(*speed).reported_on_expiry();
            Mover { id: scene.insert(desc).unwrap(), center, radius, boxy: false }
        }).collect();
        let mut query = Query::new();
        let mut reported = 0;
        for (frame, (eye, direction)) in views.iter().enumerate() {
            let now = frame as f64 * dt;
            for (m, (speed, way)) in movers.iter_mut().zip(&walks) {
                // Straight ahead at the promised speed, and back again.
                let sign = if frame / 16 % 2 == 0 { 1.0 } else { -1.0 };
                if frame > 0 {
                    m.center += *way * (speed * dt as f32 * 0.999 * sign);
                }
            }
            let due = scene.begin_frame(now).unwrap();
            // The first half of what is due is reported; what was seen always is.
            for (i, m) in movers.iter().enumerate() {
                let owed = due.iter().position(|&id| id == m.id);
                if query.pvs().contains(m.id) || frame == 0 || owed.is_some_and(|at| at % 2 == 0 || i % 3 != 0) {
                    scene.update(m.id, m.bounds(), None).unwrap();
                    reported += 1;
                }
            }
            let view = view_of(*eye, *direction);
            query.run(&scene, &view);
            for i in found_afresh(&movers, &walls, &view) {
                let seen = seen_point(*eye, &lens(*eye, *direction, LENS), &movers[i], &walls);
                let lost = seen.filter(|_| !query.pvs().contains(movers[i].id));
                prop_assert!(lost.is_none(), "frame {frame}: {:?} is seen at {lost:?}", movers[i]);
            }
            scene.end_frame([query.pvs()]).unwrap();
        }
        prop_assert!(reported > 0);
    }

    #[test]
    fn the_frustum_holds_what_meets_it(
        objects in prop::collection::vec((place(), 0.01..3.0f32, any::<bool>()), 1..60),
        eye in place(), direction in direction(),
    ) {
        let mut scene = empty();
        let movers: Vec<Mover> = objects.iter().map(|&(center, radius, boxy)| {
            let mut m = Mover { id: scene.fixed(Sphere::new(center, radius)), center, radius, boxy };
            scene.remove(m.id).unwrap();
            m.id = scene.fixed(m.bounds());
            m
        }).collect();
        let mut query = query_by(Method::Frustum);
        let pvs = query.run(&scene, &view_of(eye, direction));
        // Brute force on the clip volume: points of each object against it, and its planes one by
        // one.
        let clip = lens(eye, direction, LENS).as_dmat4();
        for m in &movers {
            let (c, r) = (m.center.as_dvec3(), f64::from(m.radius));
            let mut touches = false;
            let (mut sides, mut points) = ([0; 6], 0);
            for i in 0..7 * 7 * 7 {
                let t = DVec3::new(f64::from(i % 7), f64::from(i / 7 % 7), f64::from(i / 49)) / 3.0 - 1.0;
                let offset = if m.boxy { t } else { t.normalize_or_zero() };
                let q = clip * (c + offset * r).extend(1.0);
                let out = [q.w + q.x, q.w - q.x, q.w + q.y, q.w - q.y, q.z, q.w - q.z];
                touches |= out.iter().all(|&d| d >= 1e-9);
                points += 1;
                sides.iter_mut().zip(out).for_each(|(n, d)| *n += i32::from(d < -WIDENED));
            }
            let found = pvs.contains(m.id);
            prop_assert!(found || !touches, "{m:?}");
            let holds_eye = (eye - m.center).abs().max_element() <= m.radius;
            if m.boxy && sides.contains(&points) && !holds_eye {
                prop_assert!(!found, "all corners of {m:?} are outside one plane");
            }
        }
    }
}

#[test]
fn hidden_objects_leave_no_trace_in_the_cells() {
    let mut scene = empty();
    scene.solid(Aabb::new(Vec3::new(10.0, 0.0, 0.0), Vec3::new(12.0, SIZE, SIZE)));
    let before = scene.id_matrix().entries();
    let ids: Vec<_> = (0..50)
        .map(|i| {
            let at = Vec3::new(18.0, 2.0 + (i % 7) as f32 * 3.0, 2.0 + (i / 7) as f32 * 2.5);
            scene.insert(ObjectDesc::dynamic(Sphere::new(at, 0.4)).max_speed(1.0)).unwrap()
        })
        .collect();
    let mut query = Query::new();
    let view = around(Vec3::new(2.5, 12.5, 12.5));
    for _ in 0..3 {
        look(&mut scene, &mut query, &view);
    }
    assert_eq!(query.pvs().len(), 1);
    assert_eq!((scene.id_matrix().entries(), scene.tbv_matrix().volumes()), (before, 50));
    ids.iter().for_each(|&id| scene.remove(id).unwrap());
    assert_eq!((scene.len(), scene.tbv_matrix().volumes()), (1, 0));
}

#[test]
fn overlapping_solids_leave_no_opaque_cells_behind() {
    // Corners of cells lie on these spheres but for the last digits.
    let spheres = [
        (Vec3::new(17.0, 11.0, 5.0), 22.0),
        (Vec3::new(14.625, 7.446_777, 22.0), 22.0),
        (Vec3::new(24.0, 7.446_777, 22.0), 10.505_371),
        (Vec3::new(17.0, 11.0, 5.0), 22.0),
        (Vec3::new(1.515_072_8e-13, 11.0, 5.0), 22.0),
        (Vec3::new(24.0, 16.0, 22.0), 10.505_371),
    ];
    for first in 0..spheres.len() {
        let mut scene = empty();
        let mut ids: Vec<ObjectId> = Vec::new();
        for (center, radius) in spheres {
            let ball = Sphere::new(center, radius);
            ids.push(scene.insert(ObjectDesc::dynamic(ball).occluder(ball)).unwrap());
        }
        assert!(scene.dynamic_opacity().count() > 1000);
        ids.rotate_left(first);
        ids.into_iter().for_each(|id| scene.remove(id).unwrap());
        assert_eq!(scene.dynamic_opacity().count(), 0);
    }
}
