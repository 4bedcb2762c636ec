//! Pictures of everything and pictures of the PVS are the same, pixel for pixel.
//!
//! `cargo test --release -p casca-viewer --test pixels`; any adapter will do, also a software one.

use std::path::Path;

use casca_scenes::generated::{SceneKind, SceneOptions};
use casca_scenes::name::SceneName;
use casca_scenes::world::Camera;
use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_viewer::scene::draw::{Painter, Shot, coloured};
use casca_viewer::scene::playback::{Method, Playback};
use casca_viewer::scene::proof;
use casca_viewer::scene::renderer::Renderer;

const SIZE: (u32, u32) = (640, 360);

fn playback(scene: &str) -> Playback {
    let scene: SceneName = scene.parse().unwrap();
    Playback::new(scene.open(&SceneOptions::default()).unwrap()).unwrap()
}

/// Compares pictures of a scene, and tells how much `point` left out.
fn proves(gpu: &Gpu, scene: &str, frames: usize) {
    let mut playback = playback(scene);
    let methods = [Method::Point, Method::Cell];
    let rows = proof::prove(gpu, &mut playback, (SIZE, frames), &methods, None).unwrap();
    assert!(
        proof::report(&playback.world.name, playback.world.objects.len(), &rows),
        "{scene}: pixels differ"
    );
    assert!(rows.iter().all(|row| row.frames == frames && row.drawn > 0));
    assert!(rows[0].drawn < frames * playback.world.objects.len(), "{scene}: nothing was left out");
}

#[test]
fn procedural_scenes() {
    let Some(gpu) = Gpu::for_tests() else { return };
    for kind in SceneKind::SOLIDS {
        proves(&gpu, kind.name(), if kind == SceneKind::Crowd { 2 } else { 4 });
    }
}

#[test]
fn files() {
    let Some(gpu) = Gpu::for_tests() else { return };
    for name in ["cornell", "kitchen-parts", "sponza", "sponza-parts"] {
        let path = format!("../../../shared/scenes/{name}.glb");
        if Path::new(&path).is_file() {
            proves(&gpu, &path, 3);
        } else {
            println!("skipped: {path} is not here");
        }
    }
}

/// The picture and the item buffer of some objects.
fn shoot(gpu: &Gpu, playback: &Playback, camera: &Camera, renderer: &mut Renderer, set: &[usize]) -> Shot {
    let list = coloured(&playback.geometry, &playback.world.objects, set);
    Painter { gpu, canvas: &Canvas::new(gpu, SIZE), renderer }.shot(camera, &list).unwrap()
}

/// Pixels of another colour.
fn differing(a: &Shot, b: &Shot) -> usize {
    a.pixels.chunks(4).zip(b.pixels.chunks(4)).filter(|(a, b)| a != b).count()
}

/// Without an object that pixels show, the picture is another, and the check names it.
#[test]
fn a_lost_object_shows() {
    let Some(gpu) = Gpu::for_tests() else { return };
    for scene in ["spheres", "city"] {
        let mut playback = playback(scene);
        let camera = playback.path_camera(SIZE.0 as f32 / SIZE.1 as f32);
        playback.frame(Method::Point, &camera, &mut |_| Ok(())).unwrap();
        let mut renderer = Renderer::new(&gpu, COLOUR, &playback.geometry);
        let set = playback.compare(&[Method::Point], &camera).unwrap().remove(0);
        let want = shoot(&gpu, &playback, &camera, &mut renderer, &set);
        let canvas = Canvas::new(&gpu, SIZE);
        let objects = &playback.world.objects;
        let mut counts = vec![0; objects.len()];
        for &item in &want.items {
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
            let got = shoot(&gpu, &playback, &camera, &mut renderer, &rest);
            let changed: Vec<usize> =
                (0..want.items.len()).filter(|&p| want.items[p] != got.items[p]).collect();
            assert_eq!(
                changed.len(),
                pixels,
                "{scene}: object {lost} is gone from all its pixels, and only there"
            );
            assert_eq!(want.differing(&got), changed);
            assert!(differing(&want, &got) > 0 && differing(&want, &got) <= pixels);
            let mut painter = Painter { gpu: &gpu, canvas: &canvas, renderer: &mut renderer };
            let check = painter.check(&camera, (&playback.geometry, objects), &rest).unwrap();
            assert_eq!(check.lost, [lost]);
        }
    }
}
