//! Results of the cell method are valid for every eye of the cell, whatever bounds the view: random
//! scenes and frusta against rays from other eyes of the same cell. The rays share no code with the
//! library.

use casca_scenes::world::BOX_TRIANGLES;

use crate::common::*;

/// Solids are grown or shrunk by this much where a ray would be in doubt: coordinates up to 20 in
/// single precision are off by 1e-6.
const DOUBT: f64 = 1e-4;
/// Points looked at are inside all half-spaces by this much.
const INSIDE: f64 = 1e-4;

fn direction(random: &mut Random) -> Vec3 {
    let axis = Vec3::AXES[random.below(3)] * if random.unit() < 0.5 { 1.0 } else { -1.0 };
    // Along the axes, whole layers of cells lie at the border of narrow frusta.
    let tilt = if random.unit() < 0.5 { 0.02 } else { 1.0 };
    (axis + random.place(-1.0, 1.0, 1.0) * tilt).normalize_or(axis)
}

/// A box turned by a rotation, or a ball.
#[derive(Debug, Clone, Copy)]
enum Solid {
    Ball(DVec3, f64),
    Box(DVec3, DVec3, DQuat),
}

impl Solid {
    fn grown(self, by: f64) -> Self {
        match self {
            Self::Ball(c, r) => Self::Ball(c, r + by),
            Self::Box(c, half, turn) => Self::Box(c, half + by, turn),
        }
    }

    fn holds(self, p: DVec3) -> bool {
        match self {
            Self::Ball(c, r) => r > 0.0 && p.distance(c) <= r,
            Self::Box(c, half, turn) => (turn.inverse() * (p - c)).abs().cmple(half).all(),
        }
    }

    /// Where a segment that starts outside enters, as a share of its length.
    fn entered(self, from: DVec3, to: DVec3) -> Option<f64> {
        let t = match self {
            Self::Ball(c, r) => {
                let (d, o) = (to - from, from - c);
                let (a, b) = (d.length_squared(), o.dot(d));
                let root = b * b - a * (o.length_squared() - r * r);
                (root >= 0.0).then(|| (-b - root.sqrt()) / a)?
            }
            Self::Box(c, half, turn) => {
                let (o, e) = (turn.inverse() * (from - c), turn.inverse() * (to - c));
                let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
                for i in 0..3 {
                    let d = e[i] - o[i];
                    if d == 0.0 {
                        if o[i].abs() > half[i] {
                            return None;
                        }
                        continue;
                    }
                    let (a, b) = ((-half[i] - o[i]) / d, (half[i] - o[i]) / d);
                    (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
                }
                (enter <= leave).then_some(enter)?
            }
        };
        (0.0..=1.0).contains(&t).then_some(t)
    }

    /// A point of it, on its surface or near its middle.
    fn some_point(self, random: &mut Random) -> DVec3 {
        let way = random.place(-1.0, 1.0, 1.0).as_dvec3();
        match self {
            Self::Ball(c, r) => c + way.normalize_or_zero() * (r - DOUBT).max(0.0),
            Self::Box(c, half, turn) => {
                let mut at = way;
                let axis = random.below(3);
                at[axis] = at[axis].signum();
                c + turn * (at * (half - DOUBT).max(DVec3::ZERO))
            }
        }
    }
}

struct Item {
    id: ObjectId,
    solid: Solid,
    occludes: bool,
}

/// The twelve triangles of a turned box, counter-clockwise from outside.
fn mesh_of(b: &Obb) -> Arc<TriMesh> {
    let sign = |i: usize, bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
    let corner = |i| b.center + b.rotation * (b.half * Vec3::new(sign(i, 0), sign(i, 1), sign(i, 2)));
    mesh((0..8).map(corner).collect(), BOX_TRIANGLES.to_vec())
}

struct World {
    scene: Scene,
    items: Vec<Item>,
}

impl World {
    fn new(random: &mut Random) -> Self {
        let mut world = Self { scene: empty(), items: Vec::new() };
        for _ in 0..4 + random.below(8) {
            let min = random.place(0.0, 14.0, 1.0).floor();
            let mut size = (random.place(1.0, 3.0, 1.0) + 0.5).floor();
            if random.unit() < 0.5 {
                size[random.below(3)] += 5.0;
            }
            let b = Aabb::new(min, min + size);
            let solid = Solid::Box(
                ((b.min + b.max) * 0.5).as_dvec3(),
                ((b.max - b.min) * 0.5).as_dvec3(),
                DQuat::IDENTITY,
            );
            let fixed = random.unit() < 0.8;
            let desc = if fixed { ObjectDesc::fixed(b) } else { ObjectDesc::dynamic(b).max_speed(1.0) };
            world.insert(desc.occluder(b), solid, true);
        }
        for _ in 0..random.below(4) {
            let s = Sphere::new(random.place(2.0, 14.0, 1.0), random.between(1.5, 3.0));
            world.insert(
                ObjectDesc::fixed(s).occluder(s),
                Solid::Ball(s.center.as_dvec3(), s.radius.into()),
                true,
            );
        }
        for i in 0..random.below(4) {
            let turn = Quat::from_axis_angle(
                random.place(-1.0, 1.0, 1.0).normalize_or(Vec3::Y),
                random.between(0.0, 3.0),
            );
            let b = Obb::new(random.place(2.0, 14.0, 1.0), random.place(1.2, 3.0, 1.0), turn);
            let solid = Solid::Box(b.center.as_dvec3(), b.half.as_dvec3(), turn.as_dquat().normalize());
            let desc = if i % 2 == 0 {
                ObjectDesc::fixed(b).occluder(b)
            } else {
                ObjectDesc::fixed(mesh_of(&b)).occluder(mesh_of(&b))
            };
            world.insert(desc, solid, true);
        }
        for i in 0..200 {
            let s = Sphere::new(random.place(0.0, 16.0, 1.0), random.between(0.01, 0.2));
            let desc = if i % 3 == 0 {
                ObjectDesc::dynamic(s).max_speed(random.between(0.0, 4.0))
            } else {
                ObjectDesc::fixed(s)
            };
            world.insert(desc, Solid::Ball(s.center.as_dvec3(), s.radius.into()), false);
        }
        world
    }

    fn insert(&mut self, desc: ObjectDesc, solid: Solid, occludes: bool) {
        let id = self.scene.insert(desc).unwrap();
        self.items.push(Item { id, solid, occludes });
    }

    /// Whether the point may lie in an occluder.
    fn in_occluder(&self, p: DVec3) -> bool {
        self.items.iter().any(|i| i.occludes && i.solid.grown(DOUBT).holds(p))
    }

    /// Whether nothing hides `to` from `from`, beyond doubt. Solids around `from` hide nothing.
    fn sees(&self, from: DVec3, to: DVec3, own: usize) -> bool {
        self.items.iter().enumerate().all(|(i, item)| {
            if !item.occludes || item.solid.grown(-DOUBT).holds(from) {
                return true;
            }
            if i == own {
                return item.solid.entered(from, to).is_none_or(|t| t > 1.0 - 1e-6)
                    || item.solid.grown(-3.0 * DOUBT).entered(from, to).is_none();
            }
            let wide = item.solid.grown(DOUBT);
            !wide.holds(from) && wide.entered(from, to).is_none()
        })
    }

    /// A left-out object that `eye` sees at a point inside all half-spaces. Where `cut`, rays start
    /// where they enter those.
    fn missed(
        &self,
        pvs: &Pvs,
        eye: DVec3,
        planes: &[DVec4],
        cut: bool,
        random: &mut Random,
    ) -> Option<String> {
        for (i, item) in self.items.iter().enumerate() {
            if pvs.contains(item.id) {
                continue;
            }
            for _ in 0..4 {
                let p = item.solid.some_point(random);
                if planes.iter().any(|h| h.dot(p.extend(1.0)) < INSIDE) {
                    continue;
                }
                let enters = |h: &DVec4| {
                    let (a, b) = (h.dot(eye.extend(1.0)), h.dot(p.extend(1.0)));
                    if a < 0.0 { a / (a - b) } else { 0.0 }
                };
                let start = if cut { planes.iter().map(enters).fold(0.0, f64::max) } else { 0.0 };
                if self.sees(eye + (p - eye) * start, p, i) {
                    return Some(format!("{:?} at {p} from {eye}", item.solid));
                }
            }
        }
        None
    }
}

fn unit(plane: DVec4) -> DVec4 {
    plane / plane.truncate().length()
}

/// The half-spaces of a matrix with depth 0 to 1.
fn half_spaces(m: Mat4) -> Vec<DVec4> {
    let m: DMat4 = m.as_dmat4();
    let [x, y, z, w] = [m.row(0), m.row(1), m.row(2), m.row(3)];
    [w + x, w - x, w + y, w - y, z, w - z].map(unit).to_vec()
}

fn plane_of(h: DVec4) -> Plane {
    Plane { normal: h.truncate().as_vec3(), offset: h.w as f32 }
}

fn spaces_of(planes: &[Plane]) -> Vec<DVec4> {
    planes.iter().map(|p| unit(p.normal.as_dvec3().extend(f64::from(p.offset)))).collect()
}

/// A view from `eye`, and its half-spaces.
fn some_view(random: &mut Random, eye: Vec3, forward: Vec3, fov: f32) -> (View, Vec<DVec4>) {
    let (aspect, near) = (random.between(0.5, 2.0), random.between(0.01, 0.6));
    let m = lens(eye, forward, [fov, aspect, near, 60.0]);
    let spaces = half_spaces(m);
    match random.below(5) {
        0 => (View::perspective(eye, m).unwrap(), spaces),
        1 => (View::from_view_projection(m).unwrap(), spaces),
        kind => {
            let mut planes: Vec<Plane> = spaces[..4].iter().map(|&h| plane_of(h)).collect();
            if kind == 3 {
                // Not through the eye: it lies inside, or outside.
                let way = random.between(-0.3, 2.0);
                planes[random.below(4)].offset += way;
                planes[random.below(4)].offset += 0.5;
            }
            if kind == 4 {
                let d = -forward.dot(eye) - random.between(0.0, 3.0);
                planes.push(Plane { normal: forward, offset: d });
            }
            (View::from_planes(eye, &planes).unwrap(), spaces_of(&planes))
        }
    }
}

/// Eyes all over a cell of edge 1: corners, faces, close to the corners, the middle, and elsewhere.
fn eyes_of(cell: IVec3, random: &mut Random) -> Vec<DVec3> {
    let mut eyes = Vec::new();
    for i in 0..27 {
        let place = IVec3::new(i % 3, i / 3 % 3, i / 9);
        eyes.push(cell.as_dvec3() + place.as_dvec3() * 0.5);
        let inwards = (DVec3::ONE - place.as_dvec3()) * f64::from(random.between(0.0, 0.02));
        eyes.push(cell.as_dvec3() + place.as_dvec3() * 0.5 + inwards);
        eyes.push(cell.as_dvec3() + random.place(0.0, 1.0, 1.0).as_dvec3());
    }
    eyes
}

fn cell_query() -> Query {
    query_by(Method::cell())
}

#[test]
fn bounded_results_are_valid_for_every_eye_of_the_cell() {
    let mut random = Random(11);
    let (mut valid, mut left_out, mut kept, mut refused) = (0, 0, 0, 0);
    for _ in 0..120 {
        let mut world = World::new(&mut random);
        let mut query = cell_query();
        // What hides from two eyes goes into volumes, and moves in there.
        for frame in 0..2 {
            world.scene.begin_frame(f64::from(frame) * 0.1).unwrap();
            query.run(&world.scene, &around(random.place(0.0, 16.0, 1.0)));
            world.scene.end_frame([query.pvs()]).unwrap();
        }
        for i in 0..world.items.len() {
            let Item { id, solid: Solid::Ball(c, r), occludes: false } = world.items[i] else { continue };
            if world.scene.tbv(id).unwrap().is_some() {
                let moved = Sphere::new(c.as_vec3() + random.place(-0.8, 0.8, 1.0), r as f32);
                world.scene.update(id, moved, None).unwrap();
                world.items[i].solid = Solid::Ball(moved.center.as_dvec3(), r);
            }
        }
        for _ in 0..8 {
            let beyond = if random.unit() < 0.15 { 4.0 } else { 0.0 };
            let eye = random.place(-beyond, 16.0 + beyond, 1.0);
            let forward = direction(&mut random);
            let fov = if random.unit() < 0.7 { random.between(0.02, 0.4) } else { random.between(0.4, 1.6) };
            let (view, planes) = some_view(&mut random, eye, forward, fov);
            let pvs = query.run(&world.scene, &view).clone();
            let Some(cell) = pvs.view_cell() else { continue };
            valid += 1;
            let inside = |i: &&Item| match i.solid {
                Solid::Ball(c, _) => planes.iter().all(|h| h.dot(c.extend(1.0)) > 0.0),
                _ => false,
            };
            left_out += world.items.iter().filter(inside).filter(|i| !pvs.contains(i.id)).count();
            for v in eyes_of(cell, &mut random) {
                if !world.in_occluder(v) {
                    let missed = world.missed(&pvs, v, &planes, false, &mut random);
                    assert!(missed.is_none(), "{missed:?} is seen from the cell of {view:?}");
                }
            }
            for v in eyes_of(cell, &mut random).into_iter().step_by(3).map(|v| v.as_vec3()) {
                let near = random.between(0.01, 1.5);
                let ahead = eye + forward * random.between(0.0, 1.0);
                let v = if random.unit() < 0.3 { ahead } else { v };
                let (next, spaces) = if random.unit() < 0.5 {
                    let m = lens(v, forward, [fov * random.between(0.1, 1.0), 1.0, near, 60.0]);
                    (View::perspective(v, m).unwrap(), half_spaces(m))
                } else {
                    let mut all: Vec<Plane> = planes.iter().map(|&h| plane_of(h)).collect();
                    all.push(Plane { normal: forward, offset: -forward.dot(v) - near });
                    (View::from_planes(v, &all).unwrap(), spaces_of(&all))
                };
                if pvs.is_valid_for(&world.scene, &next) {
                    kept += 1;
                    let missed = world.missed(&pvs, v.as_dvec3(), &spaces, true, &mut random);
                    assert!(missed.is_none(), "{missed:?} is seen by {next:?}, not by {view:?}");
                } else {
                    refused += 1;
                }
            }
        }
    }
    println!("{valid} results that leave out {left_out} small balls; {kept} kept, {refused} refused");
    // On the lattice, balls lie on the faces of blocks and come out of them.
    assert!(valid > 400 && left_out > 200 && kept > 300 && refused > 300);
}

/// A block in the way of a narrow frustum, and a ball behind it.
fn behind_a_block() -> (Scene, ObjectId, Vec<Plane>) {
    let mut scene = empty();
    scene.solid(Aabb::new(Vec3::new(6.0, 6.0, 5.0), Vec3::new(7.0, 7.0, 6.0)));
    let ball = scene.fixed(Sphere::new(Vec3::new(6.5, 7.03, 9.6), 0.02));
    // From (6.5, 6.5, 2.5) along z, up to slopes of 0.02 across and 0.05 to 0.08 along y.
    let spaces = [(1.0, 0.0, 0.02), (-1.0, 0.0, 0.02), (0.0, 1.0, -0.05), (0.0, -1.0, 0.08)];
    let eye = Vec3::new(6.5, 6.5, 2.5);
    let planes = spaces.map(|(x, y, z)| {
        let normal = Vec3::new(x, y, z);
        Plane { normal, offset: -normal.dot(eye) }
    });
    (scene, ball, planes.to_vec())
}

#[test]
fn an_eye_beside_the_first_sees_past_what_bounds_its_frustum() {
    let (scene, ball, planes) = behind_a_block();
    let mut query = cell_query();
    let eye = Vec3::new(6.5, 6.5, 2.5);
    let pvs = query.run(&scene, &View::from_planes(eye, &planes).unwrap()).clone();
    // At the block's back, z = 6, the line from here to the ball is at y = 7.014.
    let high = Vec3::new(6.5, 6.999, 2.5);
    assert!(Query::new().run(&scene, &around(high)).contains(ball));
    assert!(pvs.contains(ball) && pvs.view_cell() == Some(IVec3::new(6, 6, 2)));

    // From an eye further ahead, what lies in these half-spaces lies in those.
    let narrower = |eye: Vec3| {
        let spaces = [(1.0, 0.0, 0.01), (-1.0, 0.0, 0.01), (0.0, 1.0, -0.06), (0.0, -1.0, 0.07)];
        let plane = |(x, y, z)| {
            let normal = Vec3::new(x, y, z);
            Plane { normal, offset: -normal.dot(eye) }
        };
        View::from_planes(eye, &spaces.map(plane)).unwrap()
    };
    assert!(pvs.is_valid_for(&scene, &narrower(eye + Vec3::new(0.0, 0.026, 0.4))));
    assert!(!pvs.is_valid_for(&scene, &narrower(eye + Vec3::new(0.0, 0.039, 0.6))), "another cell");
    assert!(!pvs.is_valid_for(&scene, &narrower(eye + Vec3::new(0.0, 0.1, 0.4))), "it sees more");
    // Its half-spaces cut off the block's front from this eye, which sees through it.
    assert!(!pvs.is_valid_for(&scene, &View::from_planes(high, &planes).unwrap()));
}

#[test]
fn an_eye_that_may_lie_in_an_occluder_sees_through_it() {
    let mut scene = empty();
    let wall = Aabb::new(Vec3::new(4.0, 0.0, 0.0), Vec3::new(8.0, 16.0, 16.0));
    scene.solid(wall);
    let ball = scene.fixed(Sphere::new(Vec3::new(12.0, 9.0, 9.0), 3.0));
    // A matrix leaves open where the eye is, by more than it is before the wall.
    let eye = Vec3::new(3.999_985, 8.9, 9.1);
    let m = lens(eye, Vec3::X, [0.03, 1.0, 1e-6, 60.0]);
    let mut query = cell_query();
    let exact = query.run(&scene, &View::perspective(eye, m).unwrap());
    assert!(!exact.contains(ball) && !exact.stats().eye_in_occluder);
    let found = query.run(&scene, &View::from_view_projection(m).unwrap());
    assert!(found.contains(ball) && found.stats().eye_in_occluder);
}
