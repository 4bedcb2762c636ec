//! Triangle meshes never hide what can be seen: random meshes and views against rays that
//! share no code with the library.

#[path = "../common/mod.rs"]
mod common;

mod forms;
mod magnified;
mod rays;
mod reach;
mod solids;
mod walls;
mod work;

use std::ops::ControlFlow;

use casca_scenes::world::Camera;
use glam::{Mat3A, Vec3A};

use crate::common::*;
use forms::{Made, Recipe, places, recipe};
use rays::{Blocker, Eye, Triangle, point_of};

const SIZE: f64 = 16.0;

/// Where the world of 16 units is, and how large.
#[derive(Debug, Clone, Copy)]
struct Frame {
    scale: f64,
    offset: f64,
}

impl Frame {
    fn place(self, p: DVec3) -> DVec3 {
        p * self.scale + self.offset
    }
}

fn frame() -> impl Strategy<Value = Frame> {
    let frames =
        [(1.0, 0.0), (1.0, 0.0), (1.0, 0.0), (1e-3, 0.0), (1e4, 0.0), (1.0, 1e5), (1e4, -1e5), (1e-3, 10.0)];
    prop::sample::select(frames.to_vec()).prop_map(|(scale, offset)| Frame { scale, offset })
}

#[derive(Debug, Clone)]
struct Solid {
    recipe: Recipe,
    /// Tolerance and least radius as shares of the size, angle, front only.
    how: (Option<f64>, Option<f64>, Option<f32>, bool),
    /// What it is tested by: its box, or its triangles.
    boxed: bool,
    occludes: bool,
    /// Transforms frame by frame, if it is an instance.
    moves: Option<(bool, Vec<Turn>)>,
}

/// A transform about the middle of the world: rotation, scales, shift.
#[derive(Debug, Clone)]
struct Turn {
    axis: [f32; 3],
    angle: f32,
    scales: [f32; 3],
    shift: [f32; 3],
}

impl Turn {
    fn affine(&self, frame: Frame) -> Affine3A {
        let axis = Vec3::from_array(self.axis).normalize_or(Vec3::Y);
        let m = Mat3A::from_quat(Quat::from_axis_angle(axis, self.angle))
            * Mat3A::from_diagonal(Vec3::from_array(self.scales));
        let middle = frame.place(DVec3::splat(SIZE * 0.5)).as_vec3();
        let shift = Vec3::from_array(self.shift) * frame.scale as f32;
        Affine3A { matrix3: m, translation: Vec3A::from(middle + shift) - m * Vec3A::from(middle) }
    }
}

fn turn() -> impl Strategy<Value = Turn> {
    let one = Just([1.0f32; 3]);
    let same = (0.3..2.0f32).prop_map(|s| [s; 3]);
    let any = prop::array::uniform3(0.2..2.0f32);
    let mirrored = prop::array::uniform3(prop_oneof![0.3..1.5f32, -1.5..-0.3f32]);
    let flat = (prop::array::uniform3(0.3..1.5f32), 0..3usize, prop_oneof![Just(0.0f32), Just(1e-7f32)])
        .prop_map(|(mut s, axis, v)| {
            s[axis] = v;
            s
        });
    let scales = prop_oneof![3 => one, 2 => same, 3 => any, 2 => mirrored, 1 => flat];
    let any = (prop::array::uniform3(-1.0..1.0f32), 0.0..6.3f32, scales, prop::array::uniform3(-3.0..3.0f32))
        .prop_map(|(axis, angle, scales, shift)| Turn { axis, angle, scales, shift });
    // Instances where their meshes are, too.
    prop_oneof![3 => any, 1 => Just(Turn { axis: [0.0; 3], angle: 0.0, scales: [1.0; 3], shift: [0.0; 3] })]
}

fn solid() -> impl Strategy<Value = Solid> {
    let tolerance = prop_oneof![3 => Just(None), 1 => Just(Some(0.0)), 2 => (0.0..0.1f64).prop_map(Some)];
    let least = prop_oneof![3 => Just(None), 2 => Just(Some(0.0)), 1 => (0.0..0.1f64).prop_map(Some)];
    let angle = prop_oneof![3 => Just(None), 1 => Just(Some(0.0f32)), 2 => (0.0..80.0f32).prop_map(Some)];
    let how = (tolerance, least, angle, prop::bool::weighted(0.25));
    let moves = prop::option::weighted(0.4, (any::<bool>(), prop::collection::vec(turn(), 3)));
    (recipe(), how, any::<bool>(), prop::bool::weighted(0.9), moves)
        .prop_map(|(recipe, how, boxed, occludes, moves)| Solid { recipe, how, boxed, occludes, moves })
}

/// Where the eye is.
#[derive(Debug, Clone)]
enum Stand {
    Anywhere([f64; 3]),
    /// At the middle of a solid's box.
    Within(usize),
    /// Of a solid's triangle: a corner, the middle of an edge, or the middle; raised by a share of
    /// the size.
    On(usize, usize, u8, f64),
}

#[derive(Debug, Clone)]
struct Look {
    stand: Stand,
    forward: [f32; 3],
    /// 0: around, 1: perspective, 2: orthographic.
    kind: u8,
    fov: f32,
    aspect: f32,
    near: f32,
}

fn look() -> impl Strategy<Value = Look> {
    let raised = prop_oneof![Just(0.0), 1e-5..1e-2f64, -1e-2..-1e-5f64];
    let stand = prop_oneof![
        4 => places(-4.0..20.0).prop_map(Stand::Anywhere),
        1 => any::<usize>().prop_map(Stand::Within),
        2 => (any::<usize>(), any::<usize>(), 0..3u8, raised).prop_map(|(i, t, w, r)| Stand::On(i, t, w, r)),
    ];
    let fov = prop_oneof![3 => 40.0..100.0f32, 1 => 2.0..10.0f32, 1 => 140.0..175.0f32];
    let kind = prop_oneof![2 => Just(0u8), 3 => Just(1), 1 => Just(2)];
    let near = prop_oneof![2 => 0.001..0.1f32, 2 => 0.1..4.0f32];
    (stand, prop::array::uniform3(-1.0..1.0f32), kind, fov, 0.5..2.0f32, near).prop_map(
        |(stand, forward, kind, fov, aspect, near)| Look { stand, forward, kind, fov, aspect, near },
    )
}

/// Options of both methods.
fn options() -> impl Strategy<Value = [Method; 2]> {
    let degrees = prop_oneof![1 => 0.1..0.4f32, 3 => 0.4..2.0f32];
    let squares = prop_oneof![Just(0u32), Just(16), Just(256), Just(4000)];
    let radius = prop_oneof![Just(0.0f32), Just(4.0), 0.5..8.0f32];
    (degrees, prop_oneof![Just(0u32), Just(128)], squares, 0..10u32, 6..9u32, any::<bool>(), radius).prop_map(
        |(degrees, least, squares, depth, mask, coherent, radius)| {
            let point = PointOptions::default().pixel_degrees(degrees).min_pixels(least);
            let point = point.refine_squares(squares).refine_depth(depth).coherent(coherent);
            let point = point.patch_radius(radius);
            [Method::Point(point), Method::Cell(CellOptions::default().mask_resolution(1 << mask))]
        },
    )
}

/// What an object is tested by.
enum Tested {
    Box(Vec3, Vec3),
    Triangles(Vec<Triangle>),
}

struct Thing {
    id: ObjectId,
    tested: Tested,
    blocker: Option<Blocker>,
}

fn prepared(made: &Made, solid: &Solid) -> Arc<TriMesh> {
    let how = &solid.how;
    let points =
        made.positions.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |b, &p| (b.0.min(p), b.1.max(p)));
    let size = f64::from((points.1 - points.0).length());
    let mut preparation = MeshOptions::default();
    preparation.tolerance = how.0.map(|v| (v * size) as f32);
    preparation.min_radius = how.1.map(|v| (v * size) as f32);
    preparation.max_angle = how.2;
    preparation.facing = if how.3 { Facing::Front } else { Facing::Both };
    preparation.occludes = solid.occludes;
    let mesh = TriMesh::prepare(made.positions.clone(), made.triangles.clone(), &preparation, &mut |_| {
        ControlFlow::Continue(())
    });
    Arc::new(mesh.unwrap())
}

fn triangles_of(mesh: &TriMesh, transform: Option<&Affine3A>) -> Vec<Triangle> {
    let place = |p: Vec3| match transform {
        Some(a) => {
            DAffine3 { matrix3: a.matrix3.as_dmat3(), translation: Vec3::from(a.translation).as_dvec3() }
                .transform_point3(p.as_dvec3())
        }
        None => p.as_dvec3(),
    };
    mesh.triangles().iter().map(|t| t.map(|v| place(mesh.positions()[v as usize]))).collect()
}

/// What hides of triangles under a transform: mirrors turn windings over, and what is flat has no
/// front.
fn blocker_of(mesh: &TriMesh, transform: Option<&Affine3A>, front: bool) -> Blocker {
    let mut triangles = triangles_of(mesh, transform);
    if let (Some(a), true) = (transform, front) {
        let sign = a.matrix3.as_dmat3().determinant();
        if sign.abs() < 1e-6 {
            triangles.clear();
        } else if sign < 0.0 {
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
    }
    Blocker { triangles, front }
}

/// Bounds and occluder as the scene takes them, and as rays do.
fn shapes(
    solid: &Solid,
    mesh: &Arc<TriMesh>,
    instance: Option<&Instance>,
) -> (Bounds, Option<Occluder>, Tested, Option<Blocker>) {
    let transform = instance.map(Instance::transform);
    let triangles = triangles_of(mesh, transform.as_ref());
    let (bounds, tested): (Bounds, Tested) = match (solid.boxed, instance) {
        (true, None) => (mesh.aabb().into(), Tested::Box(mesh.aabb().min, mesh.aabb().max)),
        (_, Some(i)) => (i.clone().into(), Tested::Triangles(triangles)),
        (false, None) => (mesh.clone().into(), Tested::Triangles(triangles)),
    };
    let occluder: Occluder = instance.map_or_else(|| mesh.clone().into(), |i| i.clone().into());
    let blocker = blocker_of(mesh, transform.as_ref(), solid.how.3);
    (bounds, solid.occludes.then_some(occluder), tested, solid.occludes.then_some(blocker))
}

fn bounds_of(t: &Tested) -> (DVec3, DVec3) {
    match t {
        Tested::Box(min, max) => (min.as_dvec3(), max.as_dvec3()),
        Tested::Triangles(all) => {
            let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            all.iter().flatten().fold(start, |b, &p| (b.0.min(p), b.1.max(p)))
        }
    }
}

fn eye_at(stand: &Stand, things: &[Thing], solids: usize, frame: Frame) -> Vec3 {
    match *stand {
        Stand::Anywhere(p) => frame.place(DVec3::from_array(p)).as_vec3(),
        Stand::Within(i) => {
            let (min, max) = bounds_of(&things[i % solids].tested);
            ((min + max) * 0.5).as_vec3()
        }
        Stand::On(i, t, what, raised) => {
            let thing = &things[i % solids];
            let (Some(all), false) = (thing.blocker.as_ref().map(|b| &b.triangles), solids == 0) else {
                return frame.place(DVec3::splat(SIZE * 0.5)).as_vec3();
            };
            if all.is_empty() {
                return frame.place(DVec3::splat(SIZE * 0.5)).as_vec3();
            }
            let [a, b, c] = all[t % all.len()];
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let p = [a, (a + b) * 0.5, (a + b + c) / 3.0][usize::from(what)];
            (p + normal * raised * frame.scale).as_vec3()
        }
    }
}

fn eye_of(look: &Look, at: Vec3, frame: Frame) -> Eye {
    let forward = Vec3::from_array(look.forward).normalize_or(Vec3::X);
    let up = if forward.y.abs() > 0.9 { Vec3::Z } else { Vec3::Y };
    let (scale, view) = (frame.scale as f32, look_to_mat4(at, forward, up));
    let (near, far) = (look.near * scale, 100.0 * scale);
    match look.kind {
        0 => Eye::Around(at),
        1 => Eye::Camera(Camera {
            eye: at,
            view,
            projection: directx::perspective(look.fov.to_radians(), look.aspect, near, far),
        }),
        _ => {
            let (w, h) = (look.fov * 0.1 * scale, look.fov * 0.1 * look.aspect * scale);
            Eye::Parallel(
                Camera { eye: at, view, projection: directx::orthographic(-w, w, -h, h, near, far) },
                forward,
            )
        }
    }
}

fn view_of(eye: &Eye) -> Result<View, casca::Error> {
    match eye {
        Eye::Around(at) => View::omnidirectional(*at),
        Eye::Camera(c) => View::perspective(c.eye, c.view_projection()),
        Eye::Parallel(c, forward) => View::orthographic(*forward, c.view_projection()),
    }
}

/// A point of an object left out that a ray surely reaches.
fn lost(
    things: &[Thing],
    eye: &Eye,
    left_out: impl Fn(ObjectId) -> bool,
    count: usize,
    seed: u64,
) -> Option<(usize, DVec3)> {
    let mut random = Random(seed);
    for (i, thing) in things.iter().enumerate().filter(|(_, t)| left_out(t.id)) {
        // What an object's own triangles cover, they show.
        let blockers: Vec<&Blocker> = things
            .iter()
            .enumerate()
            .filter(|&(j, _)| i != j)
            .filter_map(|(_, t)| t.blocker.as_ref())
            .collect();
        for _ in 0..count {
            let p = match &thing.tested {
                Tested::Box(min, max) => {
                    let corner = random.below(2) == 0;
                    let share = random.vector(0.0, 1.0);
                    let share = if corner { share.round() } else { share };
                    min.as_dvec3() + (max.as_dvec3() - min.as_dvec3()) * share
                }
                Tested::Triangles(all) => {
                    let which = random.below(all.len());
                    point_of(&all[which], &mut random)
                }
            };
            if eye.sees(p, &blockers) {
                return Some((i, p));
            }
        }
    }
    None
}

/// Small boxes: anywhere, and just behind edges, holes and triangles as seen from an eye.
fn targets(
    eye: Vec3,
    things: &[Thing],
    made: &[Made],
    frame: Frame,
    count: usize,
    seed: u64,
) -> Vec<(Vec3, Vec3)> {
    let mut random = Random(seed);
    let eye = eye.as_dvec3();
    let triangles: Vec<&Triangle> =
        things.iter().filter_map(|t| t.blocker.as_ref()).flat_map(|b| &b.triangles).collect();
    let holes: Vec<&Triangle> = made.iter().flat_map(|m| &m.holes).collect();
    let mut boxes = Vec::new();
    for i in 0..count {
        let half = frame.scale * 10f64.powf(random.within(-4.0, -0.3));
        let behind = match i % 4 {
            0 => None,
            1 if !holes.is_empty() => Some(holes[random.below(holes.len())]),
            _ if !triangles.is_empty() => Some(triangles[random.below(triangles.len())]),
            _ => None,
        };
        let middle = match behind {
            Some(t) => {
                let p = point_of(t, &mut random);
                let beside = frame.scale * 10f64.powf(random.within(-5.0, -1.0));
                eye + (p - eye) * random.within(1.001, 3.0) + random.vector(-1.0, 1.0) * beside
            }
            None => frame.place(random.point(0.0, SIZE)),
        };
        let (min, max) = ((middle - half).as_vec3(), (middle + half).as_vec3());
        if min.is_finite() && max.is_finite() && min.abs().max_element() < 1e7 {
            boxes.push((min, max));
        }
    }
    boxes
}

struct World {
    scene: Scene,
    things: Vec<Thing>,
    meshes: Vec<Arc<TriMesh>>,
    made: Vec<Made>,
}

fn world(solids: &[Solid], frame: Frame, cells: u32) -> World {
    let cell = (frame.scale * SIZE / f64::from(cells)) as f32;
    let mut scene = Scene::new(cell).unwrap();
    let made: Vec<Made> = solids.iter().map(|s| s.recipe.make(&|p| frame.place(p))).collect();
    let meshes: Vec<Arc<TriMesh>> = solids.iter().zip(&made).map(|(s, m)| prepared(m, s)).collect();
    let mut things = Vec::new();
    for (solid, mesh) in solids.iter().zip(&meshes) {
        let instance =
            solid.moves.as_ref().map(|m| Instance::new(mesh.clone(), m.1[0].affine(frame)).unwrap());
        let (bounds, occluder, tested, blocker) = shapes(solid, mesh, instance.as_ref());
        let desc = match &solid.moves {
            Some((true, _)) => ObjectDesc::dynamic(bounds),
            _ => ObjectDesc::fixed(bounds),
        };
        let desc = occluder.map_or(desc.clone(), |o| desc.occluder(o));
        things.push(Thing { id: scene.insert(desc).unwrap(), tested, blocker });
    }
    World { scene, things, meshes, made }
}

proptest! {
    #![proptest_config(cases(240))]

    #[test]
    fn meshes_lose_nothing(
        solids in prop::collection::vec(solid(), 1..7),
        looks in prop::collection::vec(look(), 1..4),
        frame in frame(),
        cells in prop_oneof![Just(16u32), Just(64)],
        methods in options(),
        seed in any::<u64>(),
    ) {
        let World { mut scene, mut things, meshes, made } = world(&solids, frame, cells);
        let eye = eye_at(&looks[0].stand, &things, solids.len(), frame);
        for (min, max) in targets(eye, &things, &made, frame, 60, seed) {
            let id = scene.fixed(Aabb::new(min, max));
            things.push(Thing { id, tested: Tested::Box(min, max), blocker: None });
        }
        let mut queries = methods.map(|method| (method, query_by(method)));
        for (number, look) in looks.iter().enumerate() {
            scene.begin_frame(number as f64 / 30.0).unwrap();
            if number > 0 {
                for (i, solid) in solids.iter().enumerate() {
                    let Some((_, turns)) = &solid.moves else { continue };
                    let instance = Instance::new(meshes[i].clone(), turns[number].affine(frame)).unwrap();
                    let (bounds, occluder, tested, blocker) = shapes(solid, &meshes[i], Some(&instance));
                    scene.update(things[i].id, bounds, occluder).unwrap();
                    (things[i].tested, things[i].blocker) = (tested, blocker);
                }
            }
            let at = eye_at(&look.stand, &things, solids.len(), frame);
            let eye = eye_of(look, at, frame);
            // Far from the origin a matrix may be no camera any more.
            let Ok(view) = view_of(&eye) else { continue };
            for (method, query) in &mut queries {
                let pvs = query.run(&scene, &view);
                let lost = lost(&things, &eye, |id| !pvs.contains(id), 40, seed ^ number as u64);
                prop_assert!(lost.is_none(), "{method:?}, frame {number}: {lost:?} from {eye:?}");
            }
            scene.end_frame([queries[0].1.pvs()]).unwrap();
        }
    }
}
