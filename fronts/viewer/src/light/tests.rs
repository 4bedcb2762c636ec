//! Pictures by frames with a budget and at once, after moves, and of each layer. They need any
//! adapter; a software one will do.

use std::time::Duration;

use casca_radiosity::lit::path::PathTracer;
use casca_stage::canvas::Canvas;
use casca_stage::gpu::Gpu;
use casca_stage::timing::Clock;
use glam::Vec3;

use crate::light::picture::{LAYERS, Layer};
use crate::light::renderer::{Renderer, Settings, Updated};
use crate::light::scene::Room;

const SIZE: (u32, u32) = (48, 36);
const SETTINGS: Settings = Settings { resolution: 16, rays: 32, window: 0 };
/// Frames of a small budget until light has settled, at most.
const MOST_FRAMES: usize = 2000;
/// Pictures whose states were asked for in another way: farther states have other numbers of rays.
const NOISE: f32 = 0.03;
/// The same states, some of which other questions asked for.
const MOVED: f32 = 0.006;

/// Updates frame by frame until light has settled.
fn settle(gpu: &Gpu, renderer: &mut Renderer, start: &Room, budget: Duration) -> usize {
    let camera = start.camera(SIZE);
    for frame in 1..=MOST_FRAMES {
        let clock = &mut Clock::off();
        if renderer.update(gpu, (&camera, SIZE), Some(budget), clock).unwrap().settled {
            return frame;
        }
    }
    panic!("light has not settled");
}

fn at_once(gpu: &Gpu, renderer: &mut Renderer, start: &Room) -> Updated {
    renderer.update(gpu, (&start.camera(SIZE), SIZE), None, &mut Clock::off()).unwrap()
}

fn drawn(gpu: &Gpu, renderer: &mut Renderer, start: &Room, layer: Layer) -> Vec<Vec3> {
    let canvas = Canvas::new(gpu, SIZE);
    renderer.draw(gpu, &canvas.picture(), &start.camera(SIZE), layer, &mut Clock::off()).unwrap();
    renderer.picture.read(gpu).unwrap().iter().map(|p| Vec3::from_slice(p)).collect()
}

/// The mean difference of two pictures over the mean of the second.
fn difference(found: &[Vec3], truth: &[Vec3]) -> f32 {
    let sum = |p: &dyn Fn((&Vec3, &Vec3)) -> Vec3| {
        found.iter().zip(truth).map(p).map(|d| d.abs().element_sum()).sum::<f32>()
    };
    sum(&|(f, t)| *f - *t) / sum(&|(_, t)| *t)
}

fn mean(pixels: &[Vec3]) -> f32 {
    pixels.iter().map(|c| c.element_sum()).sum::<f32>() / pixels.len() as f32
}

#[test]
fn frames_with_a_budget_end_in_the_picture_that_is_made_at_once() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let start = Room::open("cornell-point", 0).unwrap();
    let made = || Renderer::new(&gpu, &start.scene, SETTINGS).unwrap();
    let (mut whole, mut parts) = (made(), made());
    assert!(at_once(&gpu, &mut whole, &start).settled);
    let frames = settle(&gpu, &mut parts, &start, Duration::from_micros(200));
    assert!(frames > 3, "{frames}: the budget is too large to test parts");
    let truth = drawn(&gpu, &mut whole, &start, Layer::Picture);
    let off = difference(&drawn(&gpu, &mut parts, &start, Layer::Picture), &truth);
    println!("{frames} frames, {off}");
    assert!(off < NOISE, "{off}");
    // Nothing more happens.
    let before = drawn(&gpu, &mut whole, &start, Layer::Indirect);
    at_once(&gpu, &mut whole, &start);
    assert_eq!(drawn(&gpu, &mut whole, &start, Layer::Indirect), before);
}

#[test]
fn balls_that_moved_are_lit_where_they_are() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let mut start = Room::open("cornell-point", 3).unwrap();
    let mut moved = Renderer::new(&gpu, &start.scene, SETTINGS).unwrap();
    at_once(&gpu, &mut moved, &start);
    let old = drawn(&gpu, &mut moved, &start, Layer::Picture);
    let places: Vec<_> = start.balls_at(2.0).collect();
    moved.move_objects(&gpu, &places).unwrap();
    assert!(at_once(&gpu, &mut moved, &start).settled);
    for (ball, place) in places {
        start.scene.objects[ball].transform = place;
    }
    let mut fresh = Renderer::new(&gpu, &start.scene, SETTINGS).unwrap();
    at_once(&gpu, &mut fresh, &start);
    let truth = drawn(&gpu, &mut fresh, &start, Layer::Picture);
    let (now, then) =
        (difference(&drawn(&gpu, &mut moved, &start, Layer::Picture), &truth), difference(&old, &truth));
    println!("{now} after the move, {then} before");
    assert!(now < MOVED && then > 2.0 * MOVED, "{now}, {then}");
    let far = start.scene.objects.len();
    assert!(moved.move_objects(&gpu, &[(far, glam::Affine3A::IDENTITY)]).is_err());
}

#[test]
fn lights_go_out_with_all_of_their_bounces() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let start = Room::open("cornell-point", 0).unwrap();
    let mut renderer = Renderer::new(&gpu, &start.scene, SETTINGS).unwrap();
    at_once(&gpu, &mut renderer, &start);
    let lit = drawn(&gpu, &mut renderer, &start, Layer::Picture);
    let black = start.scene.lights.iter().map(|l| l.scaled(0.0)).collect::<Vec<_>>();
    renderer.set_lights(&black).unwrap();
    settle(&gpu, &mut renderer, &start, Duration::from_millis(20));
    let dark = drawn(&gpu, &mut renderer, &start, Layer::Picture);
    // What is left has not been passed on often enough to be none.
    assert!(mean(&lit) > 0.1 && mean(&dark) < 1e-3 * mean(&lit), "{} {}", mean(&lit), mean(&dark));
}

#[test]
fn layers_show_what_their_names_say() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let start = Room::open("cornell-point", 0).unwrap();
    let mut renderer = Renderer::new(&gpu, &start.scene, SETTINGS).unwrap();
    at_once(&gpu, &mut renderer, &start);
    let [picture, albedo, normals, direct, indirect, mirrored] =
        LAYERS.map(|(_, layer)| drawn(&gpu, &mut renderer, &start, layer));
    let middle = (SIZE.1 / 2 * SIZE.0 + SIZE.0 / 2) as usize;
    // The wall at the back faces the camera, and the floor lies below.
    let forward = -start.scene.camera.view.row(2).truncate();
    let facing = |n: Vec3| (2.0 * n - 1.0).dot(forward);
    assert!(facing(normals[middle]) < -0.5, "{}", normals[middle]);
    let below = ((SIZE.1 - 2) * SIZE.0 + SIZE.0 / 2) as usize;
    assert!(normals[below].abs_diff_eq(Vec3::new(0.5, 1.0, 0.5), 1e-3), "{}", normals[below]);
    let colours: Vec<Vec3> = start.scene.materials.iter().map(|m| m.albedo).collect();
    assert!(albedo.iter().all(|a| colours.iter().chain([&Vec3::ZERO]).any(|c| a.abs_diff_eq(*c, 1e-6))));
    assert!(mirrored.iter().all(|m| *m == Vec3::ZERO), "the box is matt");
    let sum: Vec<Vec3> = direct.iter().zip(&indirect).map(|(a, b)| *a + *b).collect();
    assert!(difference(&sum, &picture) < 1e-5);
    assert!(difference(&direct, &picture) > 0.1);
}

#[test]
fn a_mirror_shows_the_room_and_rough_metal_the_mean_of_it() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let mut start = Room::open("cornell-point", 0).unwrap();
    // Every wall half as bright as one that scatters, and half a mirror.
    for m in &mut start.scene.materials {
        (m.specular, m.gloss) = (Vec3::splat(0.4), 1.0);
        m.albedo *= 0.5;
    }
    let mut renderer = Renderer::new(&gpu, &start.scene, SETTINGS).unwrap();
    at_once(&gpu, &mut renderer, &start);
    let mirrored = drawn(&gpu, &mut renderer, &start, Layer::Mirrored);
    let truth = PathTracer::new(&start.scene);
    let size = (SIZE.0 as usize, SIZE.1 as usize);
    // Light that comes to the eye by the mirror and was scattered once or more before, less what is
    // scattered alone: mirrors in mirrors are no part of it.
    let orders = 0..=8;
    let mut matt = start.scene.clone();
    matt.materials.iter_mut().for_each(|m| m.specular = Vec3::ZERO);
    let camera = start.camera(SIZE);
    let whole = truth.render(&camera, size, &orders, 64, 1).unwrap().image;
    let alone = PathTracer::new(&matt).render(&camera, size, &orders, 64, 1).unwrap().image;
    let wanted = mean(&whole) - mean(&alone);
    println!("{} of {wanted}", mean(&mirrored));
    assert!(mean(&mirrored) > 0.4 * wanted && mean(&mirrored) < wanted, "{} of {wanted}", mean(&mirrored));
    let sum: Vec<Vec3> = {
        let [direct, indirect] =
            [Layer::Direct, Layer::Indirect].map(|layer| drawn(&gpu, &mut renderer, &start, layer));
        direct.iter().zip(&indirect).zip(&mirrored).map(|((a, b), c)| *a + *b + *c).collect()
    };
    let picture = drawn(&gpu, &mut renderer, &start, Layer::Picture);
    assert!(difference(&sum, &picture) < 1e-5);
}

#[test]
fn edges_of_rooms_are_not_black() {
    let Some(gpu) = Gpu::for_tests() else { return };
    // At this size, middles of pixels lie behind the wall that the floor ends at, and beside a box.
    let start = Room::open("cornell", 0).unwrap();
    for cells in [16, 32] {
        let (size, settings) = ((320, 240), Settings { resolution: cells, rays: 4, window: 0 });
        let mut renderer = Renderer::new(&gpu, &start.scene, settings).unwrap();
        let camera = start.camera(size);
        renderer.update(&gpu, (&camera, (48, 36)), None, &mut Clock::off()).unwrap();
        let canvas = Canvas::new(&gpu, size);
        let [albedo, light] = [Layer::Albedo, Layer::Indirect].map(|layer| {
            renderer.draw(&gpu, &canvas.picture(), &camera, layer, &mut Clock::off()).unwrap();
            renderer.picture.read(&gpu).unwrap()
        });
        let is_black = |p: &[f32; 4]| p[..3].iter().sum::<f32>() == 0.0;
        // Lamps scatter nothing.
        let scattering: Vec<_> = albedo.iter().zip(&light).filter(|(a, _)| !is_black(a)).collect();
        let black = scattering.iter().filter(|(_, l)| is_black(l)).count();
        println!("{cells}: {black} of {} pixels are black", scattering.len());
        assert!(scattering.len() > 30_000 && black == 0, "{cells}: {black}");
    }
}
