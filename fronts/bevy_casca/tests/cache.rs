//! Meshes that were prepared by an earlier run.
#![cfg(feature = "cache")]

mod common;

use std::fs;
use std::path::Path;

use common::*;

/// A run of a program: a wall with something behind it. Returns how many meshes hide, and how many
/// entities the camera sees.
fn run(cache: &Path) -> (usize, usize) {
    let mut app: App = headless(true);
    app.world_mut().resource_mut::<CascaSettings>().cache = Some(cache.into());
    let world = app.world_mut();
    opaque(world, 0, Vec3::new(0.0, 0.0, -10.0), Vec3::new(20.0, 20.0, 0.5));
    spawn_box(world, 1, Vec3::new(3.0, 0.0, -20.0), Vec3::ONE);
    spawn_camera(world, CAMERA, Transform::default().looking_to(Vec3::NEG_Z, Vec3::Y));
    settle(&mut app);
    (app.world().resource::<CascaScene>().occluders(), lists(&mut app)[&CAMERA].len())
}

#[test]
fn the_second_run_reads_what_the_first_prepared() {
    let folder = std::env::temp_dir().join(format!("bevy-casca-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    assert_eq!(run(&folder), (1, 1));
    let entries: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert_eq!(entries.len(), 1);
    // What is read is the entry: a damaged one is written anew, a sound one stays.
    let sound = fs::read(&entries[0]).unwrap();
    let written = fs::metadata(&entries[0]).unwrap().modified().unwrap();
    assert_eq!(run(&folder), (1, 1));
    assert_eq!(fs::metadata(&entries[0]).unwrap().modified().unwrap(), written);
    fs::write(&entries[0], &sound[..sound.len() / 2]).unwrap();
    assert_eq!(run(&folder), (1, 1));
    assert_eq!(fs::read(&entries[0]).unwrap(), sound);
    fs::remove_dir_all(&folder).unwrap();
}
