//! The cost of the border: the same work by the C face and by the Rust calls that it stands for, in
//! nanoseconds of the thread's own clock, with the sets of both compared.
//!
//! `cargo run --release -p casca-capi --example cost`

use std::hint::black_box;

use casca::{ObjectDesc, Query, Sphere};
use casca_c::*;
use casca_scenes::drive::{grid_for, view_of};
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::measure::ThreadTime;
use casca_scenes::world::{Object, Shape};

/// A struct of the header as CASCA_INIT makes it.
macro_rules! init {
    ($name:ident) => {{
        // SAFETY: all zeros are a value of each struct in the header.
        let mut value: $name = unsafe { std::mem::zeroed() };
        value.size = size_of::<$name>();
        value
    }};
}

/// The least of some runs, each of `n` calls, in nanoseconds a call.
fn measure(runs: usize, n: u32, mut call: impl FnMut(u32)) -> f64 {
    let one = |_| {
        let start = ThreadTime::now();
        (0..n).for_each(&mut call);
        start.elapsed().as_nanos() as f64 / f64::from(n)
    };
    (0..runs).map(one).fold(f64::INFINITY, f64::min)
}

fn row(name: &str, c: f64, rust: Option<f64>) {
    match rust {
        Some(rust) => println!("{name:<44} {c:>10.1} {rust:>10.1} {:>10.1}", c - rust),
        None => println!("{name:<44} {c:>10.1} {:>10} {:>10}", "-", "-"),
    }
}

/// Both sides with the same objects.
struct Sides {
    c: casca_scene,
    rust: casca::Scene,
    ids: Vec<(u64, casca::ObjectId)>,
}

impl Sides {
    fn new(min: [f32; 3], max: [f32; 3], cell: f32) -> Self {
        let mut grid = init!(casca_grid);
        (grid.min, grid.max, grid.cell) = (min, max, cell);
        let mut c = casca_scene { handle: 0 };
        // SAFETY: pointers are of references.
        assert_eq!(unsafe { casca_scene_create(&grid, &mut c) }, casca_status::CASCA_OK);
        let region = casca::Aabb::new(min.into(), max.into());
        let spec = casca::GridSpec::covering(region, cell).unwrap();
        Self { c, rust: casca::Scene::new(&spec).unwrap(), ids: Vec::new() }
    }

    fn add(&mut self, object: &Object, moves: bool) {
        let mut desc = init!(casca_object);
        let (bounds, occluder): (casca::Bounds, casca::Occluder) = match object.shape {
            Shape::Sphere { center, radius } => {
                desc.bounds.kind = CASCA_SHAPE_SPHERE;
                (desc.bounds.center, desc.bounds.radius) = (center.to_array(), radius);
                (Sphere::new(center, radius).into(), Sphere::new(center, radius).into())
            }
            Shape::Box { min, max } => {
                desc.bounds.kind = CASCA_SHAPE_BOX;
                (desc.bounds.min, desc.bounds.max) = (min.to_array(), max.to_array());
                (casca::Aabb::new(min, max).into(), casca::Aabb::new(min, max).into())
            }
            Shape::Mesh { .. } => return,
        };
        let mut rust = if moves { ObjectDesc::dynamic(bounds) } else { ObjectDesc::fixed(bounds) };
        desc.flags = if moves { CASCA_MOVES } else { 0 };
        if object.occludes {
            (desc.occluder, rust) = (desc.bounds, rust.occluder(occluder));
        }
        let mut id = 0;
        // SAFETY: pointers are of references.
        assert_eq!(unsafe { casca_scene_add(self.c, &desc, &mut id) }, casca_status::CASCA_OK);
        self.ids.push((id, self.rust.insert(rust).unwrap()));
    }
}

/// Calls that do next to nothing, and moves.
fn small_calls() {
    let mut sides = Sides::new([0.0; 3], [64.0; 3], 1.0);
    let ball = |x: f32| Shape::Sphere { center: [x, 9.0, 9.0].into(), radius: 0.2 };
    let motion = casca_scenes::world::Motion::Static;
    for i in 0..1000 {
        let shape = ball(1.0 + 0.02 * i as f32);
        sides.add(&Object { name: String::new(), shape, motion, occludes: false, tested: true }, true);
    }
    let (scene, ids) = (sides.c, sides.ids.clone());
    let version = black_box(casca_version as extern "C" fn() -> u32);
    row("casca_version", measure(9, 1 << 20, |_| _ = black_box(version())), None);
    let contains = casca_scene_contains;
    let mut answer = false;
    // SAFETY: pointers are of references, here and below.
    let c = measure(9, 1 << 18, |i| unsafe { _ = contains(scene, ids[i as usize % 1000].0, &mut answer) });
    let rust = measure(9, 1 << 18, |i| _ = black_box(sides.rust.contains(ids[i as usize % 1000].1)));
    row("contains: a handle and an id looked up", c, Some(rust));
    let mut stale = casca_scene { handle: scene.handle };
    stale.handle += 1;
    // SAFETY: as above.
    let c = measure(9, 1 << 16, |_| unsafe { _ = contains(stale, 0, &mut answer) });
    row("contains: refused, with its message", c, None);

    let at = |i: u32| [1.0 + 0.02 * (i % 1000) as f32 + 0.001 * (i % 7) as f32, 9.0, 9.0, 0.2f32];
    let update = casca_scene_update;
    let mut shape: casca_shape = init!(casca_object).bounds;
    (shape.kind, shape.radius) = (CASCA_SHAPE_SPHERE, 0.2);
    let c = measure(9, 1 << 16, |i| {
        shape.center = [at(i)[0], 9.0, 9.0];
        // SAFETY: as above.
        assert_eq!(
            unsafe { update(scene, ids[i as usize % 1000].0, &shape, std::ptr::null()) },
            casca_status::CASCA_OK
        );
    });
    let mut world = sides.rust;
    let rust = measure(9, 1 << 16, |i| {
        let [x, y, z, radius] = at(i);
        world.update(ids[i as usize % 1000].1, Sphere::new([x, y, z].into(), radius), None).unwrap();
    });
    row("update: one sphere moved", c, Some(rust));
    let (numbers, keys): (Vec<[f32; 4]>, Vec<u64>) =
        ((0..1000).map(at).collect(), ids.iter().map(|id| id.0).collect());
    let moves = casca_scene_move_spheres;
    let c = measure(9, 64, |_| {
        // SAFETY: as above.
        let status = unsafe { moves(scene, keys.as_ptr(), numbers.as_ptr().cast(), 1000) };
        assert_eq!(status, casca_status::CASCA_OK);
    });
    let rust = measure(9, 64, |_| {
        let each =
            ids.iter().zip(&numbers).map(|(id, n)| (id.1, Sphere::new([n[0], n[1], n[2]].into(), n[3])));
        world.update_many(each).unwrap();
    });
    row("move_spheres: of 1,000, each", c / 1000.0, Some(rust / 1000.0));
}

/// A query of so few objects that its border can be told from its work.
fn small_query() {
    let mut sides = Sides::new([0.0; 3], [32.0; 3], 1.0);
    let (min, max) = ([8.0, 0.0, 0.0].into(), [10.0, 32.0, 32.0].into());
    let motion = casca_scenes::world::Motion::Static;
    let wall =
        Object { name: String::new(), shape: Shape::Box { min, max }, motion, occludes: true, tested: true };
    sides.add(&wall, false);
    let (mut c_query, mut options) = (casca_query { handle: 0 }, init!(casca_query_options));
    options.method = CASCA_METHOD_FRUSTUM;
    // SAFETY: pointers are of references, here and below.
    assert_eq!(unsafe { casca_query_create(&options, &mut c_query) }, casca_status::CASCA_OK);
    let mut query = Query::with_method(casca::Method::Frustum).unwrap();
    let mut view = init!(casca_view);
    (view.kind, view.eye) = (CASCA_VIEW_OMNIDIRECTIONAL, [2.5, 16.5, 16.5]);
    let (mut count, mut ids) = (0, [0; 4]);
    let c = measure(15, 1 << 12, |_| {
        // SAFETY: as above.
        _ = unsafe { casca_query_run(c_query, sides.c, &view, std::ptr::null_mut()) };
        // SAFETY: as above.
        _ = unsafe { casca_query_get_visible(c_query, ids.as_mut_ptr(), 4, &mut count) };
    });
    assert_eq!((count, ids[0]), (1, sides.ids[0].0));
    let rust = measure(15, 1 << 12, |_| {
        let view = casca::View::omnidirectional(view.eye.into()).unwrap();
        black_box(query.run(&sides.rust, &view).visible());
    });
    row("query: one object, its view and its ids", c, Some(rust));
}

/// A walk through a scene.
fn walk(kind: SceneKind) {
    let world = build(kind, &SceneOptions::default());
    let (min, max) = (world.grid.min.to_array(), world.grid.max.to_array());
    let mut sides = Sides::new(min, max, world.grid.cell);
    assert_eq!(grid_for(&world.grid, None).unwrap().cell, world.grid.cell);
    world.objects.iter().for_each(|object| sides.add(object, false));
    let (mut c_query, mut query) = (casca_query { handle: 0 }, Query::new());
    // SAFETY: pointers are of references, here and below.
    assert_eq!(unsafe { casca_query_create(std::ptr::null(), &mut c_query) }, casca_status::CASCA_OK);
    let run = casca_query_run;
    let visible = casca_query_get_visible;
    let cameras: Vec<_> = (0..32).map(|frame| world.camera(8 * frame, 16.0 / 9.0)).collect();
    let told = |i: usize| {
        let mut view = init!(casca_view);
        view.eye = cameras[i].eye.to_array();
        view.matrix = cameras[i].view_projection().to_cols_array();
        view
    };
    let (mut ids, mut count, mut total) = (vec![0u64; sides.ids.len()], 0, 0);
    let mut ask = |i: usize| {
        let view = told(i);
        // SAFETY: as above.
        assert_eq!(unsafe { run(c_query, sides.c, &view, std::ptr::null_mut()) }, casca_status::CASCA_OK);
        // SAFETY: as above.
        let status = unsafe { visible(c_query, ids.as_mut_ptr(), ids.len(), &mut count) };
        assert_eq!(status, casca_status::CASCA_OK);
        ids[..count].to_vec()
    };
    let key: std::collections::HashMap<_, _> = sides.ids.iter().map(|&(c, rust)| (rust, c)).collect();
    for (i, camera) in cameras.iter().enumerate() {
        let of_rust = query.run(&sides.rust, &view_of(camera).unwrap());
        let of_rust: Vec<u64> = of_rust.iter().map(|id| key[&id]).collect();
        assert_eq!(ask(i), of_rust, "the same set, in the same order");
        total += of_rust.len();
    }
    // In turn, so that a busy machine slows both sides alike.
    let (mut c, mut rust) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..15 {
        c = c.min(measure(1, 32, |i| _ = black_box(ask(i as usize))));
        rust = rust.min(measure(1, 32, |i| {
            let pvs = query.run(&sides.rust, &view_of(&cameras[i as usize]).unwrap());
            black_box(pvs.visible().to_vec());
        }));
    }
    row(&format!("query: {}, {} in the set", kind.name(), total / 32), c, Some(rust));
}

fn main() {
    println!("{:<44} {:>10} {:>10} {:>10}", "ns a call, least of several runs", "C", "Rust", "border");
    small_calls();
    small_query();
    for kind in [SceneKind::City, SceneKind::Crowd, SceneKind::Forest] {
        walk(kind);
    }
    println!("all sets of both sides were the same");
}
