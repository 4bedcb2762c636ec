//! A city without a window: how many entities Bevy's culling and casca leave to draw, and how long
//! both take.
//!
//! `cargo run --release -p bevy_casca --example headless`, or with numbers of entities behind `--`.
//!
//! Times are those of whole frames of an app that does nothing but move a twentieth of its entities
//! and cull: `PostUpdate` without a renderer. Each draw that is left out saves time besides.

use std::any::TypeId;
use std::time::Instant;

use bevy_app::{App, TaskPoolPlugin};
use bevy_asset::{AssetApp, AssetPlugin, Assets};
use bevy_camera::visibility::{CascadesVisibleEntities, VisibleEntities};
use bevy_camera::{Camera3d, CameraPlugin, PerspectiveProjection, Projection};
use bevy_casca::casca::KeptOptions;
use bevy_casca::{CascaDiagnostics, CascaPlugin, CascaScene, CascaSettings, Opaque, Shadows};
use bevy_diagnostic::DiagnosticsStore;
use bevy_ecs::prelude::*;
use bevy_light::{CascadeShadowConfigBuilder, DirectionalLight, LightPlugin};
use bevy_math::Vec3;
use bevy_mesh::{Mesh, Mesh3d, MeshPlugin};
use bevy_shape::Cuboid;
use bevy_transform::TransformPlugin;
use bevy_transform::components::Transform;

const FRAMES: usize = 120;

#[derive(Component)]
struct Walker(f32);

/// Who culls.
#[derive(Clone, Copy, PartialEq)]
enum Culls {
    Bevy,
    Casca,
    /// Only for cameras: lights as Bevy does it.
    CascaForCameras,
    /// So, and cameras keep their results.
    CascaKept,
}

fn main() {
    let given: Vec<usize> = std::env::args().skip(1).filter_map(|n| n.parse().ok()).collect();
    let sizes = if given.is_empty() { vec![2_000, 20_000, 200_000] } else { given };
    println!(
        "| entities | culled by | drawn | shadow casters | frame, ms (99%) | of it casca | ready after |"
    );
    println!("|---|---|---|---|---|---|---|");
    for size in sizes {
        for culls in [Culls::Bevy, Culls::CascaForCameras, Culls::CascaKept, Culls::Casca] {
            measure(size, culls);
        }
    }
}

/// Numbers that look like chance.
fn dice(n: usize) -> f32 {
    let x = (n as u32).wrapping_mul(0x9e37_79b9).rotate_left(13).wrapping_mul(0x85eb_ca6b);
    ((x ^ x >> 15).wrapping_mul(0xc2b2_ae35) >> 8) as f32 / (1 << 24) as f32
}

/// One house to twenty things that stand around or walk.
fn fill(world: &mut World, size: usize) {
    let cube = world.resource_mut::<Assets<Mesh>>().add(Mesh::from(Cuboid::new(1.0, 1.0, 1.0)));
    let mut put = |middle: Vec3, size: Vec3| {
        let at = Transform::from_translation(middle).with_scale(size);
        world.spawn((Mesh3d(cube.clone()), at, Opaque::Front)).id()
    };
    let row = ((size / 20) as f32).sqrt().ceil() as usize;
    let side = row as f32 * 24.0;
    put(Vec3::new(0.0, -0.5, 0.0), Vec3::new(side + 50.0, 1.0, side + 50.0));
    let houses = row * row;
    for i in 0..houses {
        let height = 8.0 + 30.0 * dice(i);
        let (x, z) = ((i % row) as f32 * 24.0 - side / 2.0, (i / row) as f32 * 24.0 - side / 2.0);
        put(Vec3::new(x, height / 2.0, z), Vec3::new(16.0, height, 16.0));
    }
    let mut walkers = Vec::new();
    for i in houses + 1..size {
        let middle = Vec3::new((dice(i) - 0.5) * side, 0.9, (dice(i + 77_777) - 0.5) * side);
        let thing = put(middle, Vec3::new(0.6, 1.8, 0.4));
        if i.is_multiple_of(20) {
            walkers.push(thing);
        }
    }
    for (i, walker) in walkers.into_iter().enumerate() {
        world.entity_mut(walker).insert(Walker(dice(i) * 6.3));
    }
    let lens = PerspectiveProjection { aspect_ratio: 16.0 / 9.0, far: 1e4, ..Default::default() };
    world.spawn((Camera3d::default(), Projection::Perspective(lens), street(0)));
    let sun = DirectionalLight { shadow_maps_enabled: true, ..Default::default() };
    let down = Transform::default().looking_to(Vec3::new(0.3, -1.0, -0.5), Vec3::Y);
    world.spawn((sun, CascadeShadowConfigBuilder::default().build(), down));
}

/// Where the camera is: it walks along a street and looks around.
fn street(frame: usize) -> Transform {
    let t = frame as f32 / FRAMES as f32;
    let at = Vec3::new(-12.0, 1.7, 20.0 - 20.0 * t);
    Transform::from_translation(at).looking_to(Vec3::new((3.0 * t).sin(), 0.0, -(3.0 * t).cos()), Vec3::Y)
}

fn measure(size: usize, culls: Culls) {
    let mut app = App::new();
    app.add_plugins((TaskPoolPlugin::default(), TransformPlugin, AssetPlugin::default(), MeshPlugin));
    app.init_asset::<bevy_image::Image>().add_plugins((CameraPlugin, LightPlugin));
    if culls != Culls::Bevy {
        app.add_plugins(CascaPlugin);
        let shadows = if culls == Culls::Casca { Shadows::Lit } else { Shadows::All };
        let kept = (culls == Culls::CascaKept).then(|| KeptOptions::new().reach(0.1).turn(0.1));
        app.insert_resource(CascaSettings { shadows, kept, ..CascaSettings::default() });
    }
    fill(app.world_mut(), size);
    let start = Instant::now();
    let mut frames = 0;
    // Until all entities are known, all meshes are prepared, and bounds have been computed.
    while frames < 4 || culls != Culls::Bevy && !is_ready(&app, size) {
        app.update();
        frames += 1;
        if start.elapsed().as_secs() > 60 {
            break;
        }
    }
    let ready = start.elapsed().as_secs_f64();
    let (mut times, mut drawn, mut casters, mut own) = (Vec::new(), 0, 0, 0.0);
    for frame in 0..FRAMES {
        let world = app.world_mut();
        for (walker, mut at) in world.query::<(&Walker, &mut Transform)>().iter_mut(world) {
            let angle = walker.0 + frame as f32 * 0.02;
            at.translation += Vec3::new(angle.cos(), 0.0, angle.sin()) * 0.03;
        }
        let mut camera = world.query_filtered::<&mut Transform, With<Camera3d>>();
        camera.iter_mut(world).for_each(|mut at| *at = street(frame));
        let start = Instant::now();
        app.update();
        times.push(start.elapsed().as_secs_f64() * 1e3);
        let world = app.world_mut();
        let mut lists = world.query::<&VisibleEntities>();
        drawn += lists.iter(world).map(|list| list.len(TypeId::of::<Mesh3d>())).sum::<usize>();
        let mut lists = world.query::<&CascadesVisibleEntities>();
        let lists = lists.iter(world).flat_map(|cascades| cascades.entities.values().flatten());
        casters += lists.map(|list| list.entities.len()).sum::<usize>();
        let store = world.get_resource::<DiagnosticsStore>();
        let time = store.and_then(|store| store.get(&CascaDiagnostics::TIME)?.value());
        own += time.unwrap_or(0.0);
    }
    times.sort_by(f64::total_cmp);
    let name = match culls {
        Culls::Bevy => "Bevy",
        Culls::Casca => "casca",
        Culls::CascaForCameras => "casca, cameras only",
        Culls::CascaKept => "casca, cameras only, kept results",
    };
    println!(
        "| {size} | {name} | {} | {} | {:.2} ({:.2}) | {:.2} | {frames} frames, {ready:.2} s |",
        drawn / FRAMES,
        casters / FRAMES,
        times[FRAMES / 2],
        times[FRAMES * 99 / 100],
        own / FRAMES as f64,
    );
}

fn is_ready(app: &App, size: usize) -> bool {
    let casca = app.world().resource::<CascaScene>();
    casca.scene().is_some_and(|scene| scene.len() >= size) && !casca.is_preparing()
}
