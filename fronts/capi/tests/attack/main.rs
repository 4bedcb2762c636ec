//! The random attack through the C face: scenes that change as applications change them, by the
//! exported functions alone, and sets judged by exact visibility, which shares no code with casca.
//! And garbage. `CASCA_CASES=N` plays N times as many scenes, `CASCA_SEED=S` others.
// Some of the functions are safe to call, and go through the same macro.
#![allow(unused_unsafe)]

#[macro_use]
#[path = "../common/mod.rs"]
mod common;
mod garbage;

use std::sync::Arc;

use casca::glam::camera::rh::{proj, view::look_to_mat4};
use casca::glam::{Affine3A, Mat4, Quat, Vec3};
use casca_c::*;
use casca_scenes::world::{Camera, Mesh, Motion, Object, Shape};
use casca_truth::oracle::{Oracle, OracleOptions};
use casca_truth::places::coordinate;

const SIZE: f32 = 16.0;

/// `CASCA_SEED` or `CASCA_CASES`, or what stands for it.
fn variable(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(default)
}

/// Numbers from a seed.
struct Dice(u64);

impl Dice {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    fn within(&mut self, min: f32, max: f32) -> f32 {
        min + (max - min) * ((self.bits() >> 40) as f32 / (1u64 << 24) as f32)
    }

    /// A coordinate, half of the time on a lattice.
    fn coordinate(&mut self, range: std::ops::Range<f32>, step: f32) -> f32 {
        coordinate(f64::from(self.within(0.0, 1.0)), range, step)
    }

    fn place(&mut self) -> Vec3 {
        let reach = if self.below(8) == 0 { SIZE } else { 0.0 };
        Vec3::from_array(std::array::from_fn(|_| self.coordinate(-reach..SIZE + reach, 2.0)))
    }

    fn direction(&mut self) -> Vec3 {
        let at = |dice: &mut Self| dice.within(-1.0, 1.0);
        Vec3::new(at(self), at(self), at(self)).normalize_or(Vec3::X)
    }

    fn shape(&mut self, mesh: &Arc<Mesh>) -> Shape {
        let at = self.place();
        match self.below(5) {
            0 | 1 => Shape::Sphere { center: at, radius: self.within(0.05, 4.0) },
            2 | 3 => {
                let size = Vec3::from_array(std::array::from_fn(|_| self.coordinate(0.0..8.0, 2.0)));
                Shape::Box { min: at, max: at + size }
            }
            _ => Shape::Mesh { mesh: mesh.clone(), transform: self.transform(at) },
        }
    }

    fn transform(&mut self, at: Vec3) -> Affine3A {
        let turn = Quat::from_axis_angle(self.direction(), self.within(0.0, 6.0));
        let scale = Vec3::from_array(std::array::from_fn(|_| self.within(0.3, 5.0)));
        Affine3A::from_scale_rotation_translation(scale, turn, at)
    }

    fn object(&mut self, mesh: &Arc<Mesh>) -> Object {
        let motion = if self.below(2) == 0 { Motion::Static } else { Motion::Dynamic { max_speed: 3.0 } };
        let occludes = self.below(5) > 0;
        Object { name: String::new(), shape: self.shape(mesh), motion, occludes, tested: true }
    }

    fn camera(&mut self) -> Camera {
        let (eye, forward) = (self.place(), self.direction());
        let up = if forward.y.abs() > 0.9 { Vec3::Z } else { Vec3::Y };
        let (fov, aspect) = (self.within(20.0, 110.0).to_radians(), self.within(0.5, 2.0));
        let projection = proj::directx::perspective(fov, aspect, self.within(0.01, 0.3), 100.0);
        Camera { eye, view: look_to_mat4(eye, forward, up), projection }
    }
}

fn prepared(mesh: &Mesh) -> casca_mesh {
    let mut desc = init!(casca_mesh_desc);
    desc.positions = mesh.positions.as_ptr().cast();
    desc.position_count = mesh.positions.len();
    desc.indices = mesh.triangles.as_ptr().cast();
    desc.index_count = 3 * mesh.triangles.len();
    let mut made = casca_mesh { handle: 0 };
    ok!(casca_mesh_create(&desc, &mut made));
    made
}

fn no_shape() -> casca_shape {
    // SAFETY: all zeros are a value.
    unsafe { std::mem::zeroed() }
}

/// A shape as C describes it, and its transform.
fn described(shape: &Shape, mesh: casca_mesh) -> (casca_shape, Option<[f32; 16]>) {
    let mut described = no_shape();
    match shape {
        Shape::Sphere { center, radius } => {
            (described.kind, described.radius) = (CASCA_SHAPE_SPHERE, *radius);
            described.center = center.to_array();
        }
        Shape::Box { min, max } => {
            described.kind = CASCA_SHAPE_BOX;
            (described.min, described.max) = (min.to_array(), max.to_array());
        }
        Shape::Mesh { transform, .. } => {
            (described.kind, described.mesh) = (CASCA_SHAPE_MESH, mesh);
            return (described, Some(Mat4::from(*transform).to_cols_array()));
        }
    }
    (described, None)
}

/// What the C side is told, and the truth beside it.
struct Game {
    scene: casca_scene,
    mesh: casca_mesh,
    queries: Vec<casca_query>,
    objects: Vec<Object>,
    ids: Vec<u64>,
}

impl Game {
    fn new(mesh: casca_mesh) -> Self {
        let mut grid = init!(casca_grid);
        (grid.max, grid.cell) = ([SIZE; 3], 0.8);
        let mut scene = casca_scene { handle: 0 };
        ok!(casca_scene_create(&grid, &mut scene));
        let ways = [
            (CASCA_METHOD_POINT, CASCA_PRESET_BALANCED, 0),
            (CASCA_METHOD_POINT, CASCA_PRESET_FAST, CASCA_COHERENT),
            (CASCA_METHOD_POINT, CASCA_PRESET_TIGHT, CASCA_KEPT),
            (CASCA_METHOD_CELL, 0, 0),
        ];
        let query = |(method, preset, flags)| {
            let mut options = init!(casca_query_options);
            (options.method, options.preset, options.flags) = (method, preset, flags);
            options.reach = 0.4;
            let mut query = casca_query { handle: 0 };
            ok!(casca_query_create(&options, &mut query));
            query
        };
        Self { scene, mesh, queries: ways.map(query).into(), objects: Vec::new(), ids: Vec::new() }
    }

    fn add(&mut self, object: Object) {
        let (shape, transform) = described(&object.shape, self.mesh);
        let mut desc = init!(casca_object);
        desc.bounds = shape;
        desc.occluder = if object.occludes { shape } else { no_shape() };
        if object.motion != Motion::Static {
            (desc.flags, desc.max_speed) = (CASCA_MOVES | CASCA_HAS_MAX_SPEED, 3.0);
        }
        if let Some(transform) = transform {
            (desc.flags, desc.transform) = (desc.flags | CASCA_PLACED, transform);
        }
        let mut id = 0;
        ok!(casca_scene_add(self.scene, &desc, &mut id));
        self.objects.push(object);
        self.ids.push(id);
    }

    fn change(&mut self, dice: &mut Dice, mesh: &Arc<Mesh>) {
        if self.objects.is_empty() || dice.below(8) == 0 {
            return self.add(dice.object(mesh));
        }
        let i = dice.below(self.objects.len());
        if dice.below(8) == 0 {
            ok!(casca_scene_remove(self.scene, self.ids.swap_remove(i)));
            self.objects.swap_remove(i);
            return;
        }
        let by = Vec3::from_array(std::array::from_fn(|_| dice.coordinate(-1.0..1.0, 0.5)));
        let (id, object) = (self.ids[i], &mut self.objects[i]);
        match &mut object.shape {
            Shape::Sphere { center, .. } => *center += by,
            Shape::Box { min, max } => (*min, *max) = (*min + by, *max + by),
            Shape::Mesh { transform, .. } => *transform = Affine3A::from_translation(by) * *transform,
        }
        let (shape, transform) = described(&object.shape, self.mesh);
        match (&object.shape, transform) {
            (_, Some(columns)) if dice.below(2) == 0 => {
                let rows = Mat4::from_cols_array(&columns).transpose().to_cols_array();
                ok!(casca_scene_set_transform(self.scene, id, rows.as_ptr(), CASCA_ROW_MAJOR));
            }
            (_, Some(columns)) => {
                ok!(casca_scene_set_transforms(self.scene, &id, columns.as_ptr(), 1, 0));
            }
            (Shape::Sphere { center, radius }, _) if !object.occludes => {
                let sphere = center.extend(*radius).to_array();
                ok!(casca_scene_move_spheres(self.scene, &id, sphere.as_ptr(), 1));
            }
            (Shape::Box { min, max }, _) if !object.occludes => {
                let corners = [min.to_array(), max.to_array()].concat();
                ok!(casca_scene_move_boxes(self.scene, &id, corners.as_ptr(), 1));
            }
            _ => {
                let occluder = if object.occludes { &raw const shape } else { std::ptr::null() };
                ok!(casca_scene_update(self.scene, id, &shape, occluder));
            }
        }
    }

    /// The ids that a query finds, which must be what the judge asks for one by one.
    fn found(&self, query: casca_query, view: &casca_view) -> Vec<u64> {
        let (mut count, mut written) = (0, 0);
        ok!(casca_query_run(query, self.scene, view, &mut count));
        let mut ids = vec![0; count];
        ok!(casca_query_get_visible(query, ids.as_mut_ptr(), count, &mut written));
        assert_eq!(written, count);
        ids
    }

    /// Objects that are exactly visible may be seen by their boxes, too.
    fn look(&self, query: casca_query, exact: &[usize]) {
        for &i in exact {
            let (mut corners, mut answer) = ([0f32; 6], 0);
            let (min, max) = corners.split_at_mut(3);
            ok!(casca_scene_get_box(self.scene, self.ids[i], min.as_mut_ptr(), max.as_mut_ptr()));
            ok!(casca_query_may_see_boxes(query, self.scene, corners.as_ptr(), 1, &mut answer));
            assert_eq!(answer, 1, "{:?}", self.objects[i]);
        }
    }
}

/// The view of a camera in one of the ways that C may tell it.
fn told(camera: &Camera, way: usize) -> casca_view {
    let mut view = init!(casca_view);
    let matrix = camera.view_projection();
    (view.eye, view.matrix) = (camera.eye.to_array(), matrix.to_cols_array());
    match way {
        0 => {}
        1 => (view.flags, view.matrix) = (CASCA_ROW_MAJOR, matrix.transpose().to_cols_array()),
        2 => view.kind = CASCA_VIEW_MATRIX,
        3 => {
            // The same camera with depth from -1 to 1: twice z less w.
            let deeper = Mat4::from_cols_array(&[
                1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, -1.0, 1.0,
            ]);
            view.flags = CASCA_DEPTH_MINUS_ONE;
            view.matrix = (deeper * camera.projection * camera.view).to_cols_array();
        }
        4 => {
            // Reversed depth: w less z.
            let reversed = Mat4::from_cols_array(&[
                1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0, 1.0,
            ]);
            view.matrix = (reversed * camera.projection * camera.view).to_cols_array();
        }
        _ => view.kind = CASCA_VIEW_OMNIDIRECTIONAL,
    }
    view
}

/// The objects that are seen, or one that is and was not found. Without a camera all directions
/// count, and rays start at the eye rather than at a near plane.
fn judge(
    game: &Game,
    found: &[u64],
    camera: Option<&Camera>,
    eye: Vec3,
    seed: u64,
) -> Result<Vec<usize>, Box<Object>> {
    let sees = |i: usize| found.contains(&game.ids[i]);
    let (width, height) = if camera.is_some() { (96, 72) } else { (1, 1) };
    let options = OracleOptions { width, height, samples_per_object: 24, max_candidates: 1000, seed };
    let mut oracle = Oracle::new(&game.objects, options);
    let Some(camera) = camera else {
        let left: Vec<usize> = (0..game.ids.len()).filter(|&i| !sees(i)).collect();
        let report = oracle.rays().probe(&game.objects, eye.as_dvec3(), &left, 100, seed, |_| true);
        return report
            .seen
            .first()
            .map_or(Ok(Vec::new()), |lost| Err(Box::new(game.objects[lost.object].clone())));
    };
    let verdict = oracle.frame(&game.objects, &[], camera, &sees);
    let lost = verdict.false_negatives.first();
    lost.map_or(Ok(verdict.exact), |lost| Err(Box::new(game.objects[lost.object].clone())))
}

/// Plays one scene; returns how many objects were judged visible, and how many were left out.
fn play(seed: u64, mesh: &Arc<Mesh>, prepared: casca_mesh) -> (usize, usize) {
    let mut dice = Dice(seed);
    let mut game = Game::new(prepared);
    for _ in 0..5 + dice.below(35) {
        game.add(dice.object(mesh));
    }
    let (mut visible, mut left_out) = (0, 0);
    for frame in 0..6u32 {
        ok!(casca_scene_begin_frame(game.scene, f64::from(frame) / 60.0, std::ptr::null_mut()));
        for _ in 0..dice.below(8) {
            game.change(&mut dice, mesh);
        }
        let camera = dice.camera();
        let view = told(&camera, dice.below(6));
        for (i, &query) in game.queries.iter().enumerate() {
            let found = game.found(query, &view);
            let all_round = view.kind == CASCA_VIEW_OMNIDIRECTIONAL;
            let exact = judge(&game, &found, (!all_round).then_some(&camera), camera.eye, u64::from(frame))
                .unwrap_or_else(|lost| panic!("seed {seed}, frame {frame}, query {i}: {lost:?}"));
            game.look(query, &exact);
            visible += exact.len();
            left_out += game.objects.len() - found.len();
        }
        let queries = game.queries.as_ptr();
        ok!(casca_scene_end_frame(game.scene, queries, game.queries.len(), std::ptr::null_mut()));
    }
    game.queries.iter().for_each(|query| ok!(casca_query_free(*query)));
    ok!(casca_scene_free(game.scene));
    (visible, left_out)
}

#[test]
fn nothing_visible_is_lost() {
    let mesh = Arc::new(Mesh::cuboid(Vec3::ZERO, Vec3::ONE));
    let prepared = prepared(&mesh);
    let (mut visible, mut left_out) = (0, 0);
    let first = variable("CASCA_SEED", 1).wrapping_mul(1 << 32);
    let count = 200 * variable("CASCA_CASES", 1);
    for seed in first..first + count {
        let played = play(seed, &mesh, prepared);
        (visible, left_out) = (visible + played.0, left_out + played.1);
    }
    ok!(casca_mesh_free(prepared));
    println!("{count} scenes: {visible} visible found, 0 lost, {left_out} hidden left out");
    assert!(visible > 1000 && left_out > 1000, "{visible} {left_out}");
}
