//! Worlds of any size for this section.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Affine3A, Vec2, Vec3};
use rand::RngExt;

use casca_scenes::random::{Generator, generator};
use casca_scenes::world::{Animation, Camera, GridHint, Mesh, Motion, Object, Shape, World};

const FRAMES: usize = 150;

/// Nothing moves but the camera.
struct Still<F>(F);

impl<F: Fn(usize, f32) -> Camera + Send + Sync> Animation for Still<F> {
    fn shapes(&self, _: usize, _: &mut dyn FnMut(usize, Shape)) {}

    fn camera(&self, frame: usize, aspect: f32) -> Camera {
        self.0(frame, aspect)
    }
}

fn fixed(shape: Shape, occludes: bool) -> Object {
    Object { name: String::new(), shape, motion: Motion::Static, occludes, tested: true }
}

/// The shell: its distance from the eye, and half its height and width as tangents, a little less
/// than the view's.
const DISTANCE: f32 = 60.0;
const OPENING: Vec2 = Vec2::new(0.95, 0.53);
const FOV: f32 = 60.0;

/// Spheres side by side on a shell around the eye, so that all of them are visible. They are
/// occluders.
pub(super) fn shell(count: usize, seed: u64) -> World {
    let mut dice = generator(seed, 0x5e11);
    let rows = (count as f32 * OPENING.y / OPENING.x).sqrt().round().max(1.0) as usize;
    let columns = count.div_ceil(rows);
    let pitch = OPENING * 2.0 / Vec2::new(columns as f32, rows as f32);
    let eye = Vec3::splat(1.5 * DISTANCE);
    let ball = |i: usize| {
        let place = Vec2::new((i % columns) as f32 + 0.5, (i / columns) as f32 + 0.5) * pitch - OPENING;
        let distance = DISTANCE * (0.95 + 0.1 * dice.random::<f32>());
        // Of the pitch as it appears off the axis, a sphere takes less than half: none covers
        // another.
        let way = Vec3::new(1.0, place.y, place.x);
        let radius = 0.3 * pitch.min_element() * distance / way.length_squared();
        fixed(Shape::Sphere { center: eye + way.normalize() * distance, radius }, true)
    };
    World {
        source: Default::default(),
        name: "shell".to_owned(),
        objects: (0..count).map(ball).collect(),
        grid: GridHint { min: Vec3::ZERO, max: Vec3::splat(3.0 * DISTANCE), cell: 1.0 },
        frames: FRAMES,
        animation: Box::new(Still(move |frame: usize, aspect| {
            // A step aside of up to a centimetre: each view is another one.
            let aside = Vec3::new(0.0, 0.0, 0.01 * (frame as f32 * 0.3).sin());
            Camera::look_at(eye + aside, eye + aside + Vec3::X, FOV, aspect, 0.1, 300.0)
        })),
    }
}

/// Small static spheres that hide others, one in 8 cubic metres.
pub(super) fn scatter(count: usize, seed: u64) -> World {
    let mut dice = generator(seed, 0x5ca7);
    let side = (8.0 * count as f32).cbrt().max(2.0);
    let mut number = |lo: f32, hi: f32| lo + (hi - lo) * dice.random::<f32>();
    let ball = |_| {
        let radius = number(0.2, 0.5);
        let center = Vec3::new(
            number(radius, side - radius),
            number(radius, side - radius),
            number(radius, side - radius),
        );
        fixed(Shape::Sphere { center, radius }, true)
    };
    World {
        source: Default::default(),
        name: "scatter".to_owned(),
        objects: (0..count).map(ball).collect(),
        grid: GridHint { min: Vec3::ZERO, max: Vec3::splat(side), cell: 1.0 },
        frames: 1,
        animation: Box::new(Still(move |_, aspect| {
            Camera::look_at(Vec3::splat(-1.0), Vec3::splat(side), FOV, aspect, 0.1, 2.0 * side)
        })),
    }
}

/// The ground: its size, and the number of meshes along each side.
const GROUND: f32 = 320.0;
const TILES: usize = 10;
const BOXES: usize = 2000;
const EYE: f32 = 1.7;

/// Hills: waves of several lengths and directions.
#[derive(Clone)]
struct Hills([(Vec2, f32, f32); 12]);

impl Hills {
    fn new(dice: &mut Generator) -> Self {
        Self(std::array::from_fn(|i| {
            let length = 90.0 * 0.75f32.powi(i as i32);
            let way = Vec2::from_angle(TAU * dice.random::<f32>()) * TAU / length;
            (way, TAU * dice.random::<f32>(), 0.05 * length)
        }))
    }

    fn at(&self, p: Vec2) -> f32 {
        20.0 + self.0.iter().map(|(way, phase, height)| height * (way.dot(p) + phase).sin()).sum::<f32>()
    }
}

/// A square of the ground with this many squares of two triangles along each side.
fn tile(hills: &Hills, corner: Vec2, squares: usize) -> Mesh {
    let (side, pitch) = (squares + 1, GROUND / (TILES * squares) as f32);
    let vertex = |i: usize| {
        let p = corner + Vec2::new((i % side) as f32, (i / side) as f32) * pitch;
        Vec3::new(p.x, hills.at(p), p.y)
    };
    let square = |i: usize| {
        let a = (i / squares * side + i % squares) as u32;
        let (b, c, d) = (a + 1, a + side as u32, a + side as u32 + 1);
        [[a, d, b], [a, c, d]]
    };
    Mesh {
        positions: (0..side * side).map(vertex).collect(),
        triangles: (0..squares * squares).flat_map(square).collect(),
        ..Mesh::default()
    }
}

/// Rolling ground of about this many triangles, and boxes on it. The hills are the same for any
/// number.
pub(super) fn ground(triangles: usize, seed: u64) -> World {
    let mut dice = generator(seed, 0x6e0d);
    let hills = Hills::new(&mut dice);
    let squares = ((triangles as f64 / (2 * TILES * TILES) as f64).sqrt().round() as usize).max(1);
    let tile = |i: usize| {
        let corner = Vec2::new((i % TILES) as f32, (i / TILES) as f32) * (GROUND / TILES as f32);
        let mesh = Arc::new(tile(&hills, corner, squares));
        fixed(Shape::Mesh { mesh, transform: Affine3A::IDENTITY }, true)
    };
    let mut objects: Vec<Object> = (0..TILES * TILES).map(tile).collect();
    for _ in 0..BOXES {
        let p = Vec2::new(dice.random::<f32>(), dice.random::<f32>()) * (GROUND - 2.0) + 1.0;
        let (base, half) = (Vec3::new(p.x, hills.at(p), p.y), 0.2 + 0.6 * dice.random::<f32>());
        objects.push(fixed(Shape::Box { min: base - half, max: base + half }, false));
    }
    World {
        source: Default::default(),
        name: "ground".to_owned(),
        objects,
        grid: GridHint { min: Vec3::ZERO, max: Vec3::new(GROUND, 60.0, GROUND), cell: 1.0 },
        frames: FRAMES,
        animation: Box::new(Still(move |frame: usize, aspect| {
            // A round about the middle, with a look ahead.
            let way = Vec2::from_angle(TAU * frame as f32 / FRAMES as f32);
            let p = Vec2::splat(GROUND * 0.5) + way * GROUND * 0.25;
            let eye = Vec3::new(p.x, hills.at(p) + EYE, p.y);
            let ahead = way.perp();
            Camera::look_at(eye, eye + Vec3::new(ahead.x, -0.05, ahead.y), FOV, aspect, 0.1, 500.0)
        })),
    }
}

/// Triangles of about a tenth of a metre, each with vertices of its own, anywhere in a cube of 10
/// m.
pub(super) fn soup(triangles: usize, seed: u64) -> Mesh {
    let mut dice = generator(seed, 0x50a9);
    let mut point = |size: f32| Vec3::new(dice.random(), dice.random(), dice.random()) * size;
    let positions = (0..triangles).flat_map(|_| {
        let at = point(10.0);
        [at, at + point(0.1), at + point(0.1)]
    });
    let positions = positions.collect();
    let corners = |i: u32| [3 * i, 3 * i + 1, 3 * i + 2];
    Mesh { positions, triangles: (0..triangles as u32).map(corners).collect(), ..Mesh::default() }
}
