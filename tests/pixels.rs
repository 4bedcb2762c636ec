//! Pictures of everything and pictures of the PVS are the same, pixel for pixel.
//!
//! `cargo test --release --features demo --test pixels`; any adapter will do, also a software one.

#[allow(dead_code, reason = "the tests use a part of it")]
#[path = "../examples/viewer/canvas.rs"]
mod canvas;
#[path = "../examples/viewer/frame_loop.rs"]
mod frame_loop;
#[path = "../examples/viewer/geometry.rs"]
mod geometry;
#[allow(dead_code, reason = "the tests use a part of it")]
#[path = "../examples/viewer/gpu.rs"]
mod gpu;
#[path = "../examples/viewer/proof.rs"]
mod proof;
#[allow(dead_code, reason = "the tests use a part of it")]
#[path = "../examples/viewer/renderer.rs"]
mod renderer;
#[allow(dead_code, reason = "the tests use a part of it")]
#[path = "../examples/viewer/stage.rs"]
mod stage;

use std::path::Path;

use casca_lab::command_line::SceneName;
use casca_lab::scenes::{SceneKind, SceneOptions};
use casca_lab::world::Camera;

use canvas::{Canvas, coloured};
use gpu::{COLOUR, Gpu, GpuError};
use renderer::Renderer;
use stage::{Method, Stage};

const SIZE: (u32, u32) = (640, 360);

/// A device, unless the machine has none.
fn gpu() -> Option<Gpu> {
    match Gpu::headless(false) {
        Ok(gpu) => Some(gpu),
        Err(GpuError::NoAdapter(why)) => {
            println!("skipped: no adapter: {why}");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

fn stage(scene: &str) -> Stage {
    let scene: SceneName = scene.parse().unwrap();
    Stage::new(scene.open(&SceneOptions::default()).unwrap()).unwrap()
}

/// Compares pictures of a scene, and tells how much `point` left out.
fn proves(gpu: &Gpu, scene: &str, frames: usize) {
    let mut stage = stage(scene);
    let methods = [Method::Point, Method::Cell];
    let rows = proof::prove(gpu, &mut stage, (SIZE, frames), &methods, None).unwrap();
    assert!(proof::report(&stage.world.name, stage.world.objects.len(), &rows), "{scene}: pixels differ");
    assert!(rows.iter().all(|row| row.frames == frames && row.drawn > 0));
    assert!(rows[0].drawn < frames * stage.world.objects.len(), "{scene}: nothing was left out");
}

#[test]
fn procedural_scenes() {
    let Some(gpu) = gpu() else { return };
    for kind in SceneKind::ALL {
        proves(&gpu, kind.name(), if kind == SceneKind::Crowd { 2 } else { 4 });
    }
}

#[test]
fn files() {
    let Some(gpu) = gpu() else { return };
    for name in ["cornell", "kitchen-parts", "sponza", "sponza-parts"] {
        let path = format!("../shared/scenes/{name}.glb");
        if Path::new(&path).is_file() {
            proves(&gpu, &path, 3);
        } else {
            println!("skipped: {path} is not here");
        }
    }
}

/// The pictures and the item buffer of some objects.
fn shoot(
    gpu: &Gpu,
    stage: &Stage,
    camera: &Camera,
    renderer: &mut Renderer,
    set: &[usize],
) -> (Vec<u8>, Vec<u32>) {
    let canvas = Canvas::new(gpu, SIZE);
    let list = coloured(&stage.geometry, &stage.world.objects, set);
    let pixels = canvas.pixels(gpu, renderer, camera, &list).unwrap();
    (pixels, canvas.items(gpu, renderer, camera, &list).unwrap())
}

/// Pixels that differ.
fn differing(a: &[u8], b: &[u8]) -> usize {
    a.chunks(4).zip(b.chunks(4)).filter(|(a, b)| a != b).count()
}

/// Without an object that pixels show, the picture is another, and the check names it.
#[test]
fn a_lost_object_shows() {
    let Some(gpu) = gpu() else { return };
    for scene in ["spheres", "city"] {
        let mut stage = stage(scene);
        let camera = stage.path_camera(SIZE.0 as f32 / SIZE.1 as f32);
        stage.frame(Method::Point, &camera, &mut |_| Ok(())).unwrap();
        let mut renderer = Renderer::new(&gpu, COLOUR, &stage.geometry);
        let set = stage.compare(&[Method::Point], &camera).unwrap().remove(0);
        let (want, items) = shoot(&gpu, &stage, &camera, &mut renderer, &set);
        let canvas = Canvas::new(&gpu, SIZE);
        let objects = &stage.world.objects;
        let mut counts = vec![0; objects.len()];
        for &item in &items {
            if let Some(count) = counts.get_mut(item as usize) {
                *count += 1;
            }
        }
        let shown = || (0..counts.len()).filter(|&i| counts[i] > 0);
        let largest = shown().max_by_key(|&i| counts[i]).unwrap();
        let smallest = shown().min_by_key(|&i| counts[i]).unwrap();
        for lost in [largest, smallest] {
            let pixels = counts[lost];
            let rest: Vec<usize> = set.iter().copied().filter(|&i| i != lost).collect();
            let (got, got_items) = shoot(&gpu, &stage, &camera, &mut renderer, &rest);
            let changed = items.iter().zip(&got_items).filter(|(a, b)| a != b).count();
            assert_eq!(changed, pixels, "{scene}: object {lost} is gone from all its pixels, and only there");
            assert!(differing(&want, &got) > 0 && differing(&want, &got) <= pixels);
            let check =
                canvas.check(&gpu, &mut renderer, &camera, (&stage.geometry, objects), &rest).unwrap();
            assert_eq!(check.lost, [lost]);
        }
    }
}
