//! A city without a window: how many entities Bevy's culling and casca leave to draw, and how long
//! both take, in turn, frame by frame.
//!
//! `cargo run --release -p bevy_casca --example headless`, or with numbers of entities behind `--`.
//!
//! The step is what Bevy's sets for visibility run, with whatever stands in the place of their
//! systems. In whole frames, without a renderer, the level loads: 1,000 entities come in each.

#[path = "town/layout.rs"]
mod layout;

use std::any::TypeId;
use std::time::Instant;

use bevy_app::{App, PostUpdate, TaskPoolPlugin};
use bevy_asset::{AssetApp, AssetPlugin, Assets};
use bevy_camera::visibility::{
    CascadesVisibleEntities, CubemapVisibleEntities, ViewVisibility, VisibilitySystems, VisibleEntities,
};
use bevy_camera::{Camera3d, CameraPlugin, PerspectiveProjection, Projection};
use bevy_casca::{CascaPlugin, CascaScene, CascaSettings, Opaque};
use bevy_ecs::prelude::*;
use bevy_light::SimulationLightSystems;
use bevy_light::{CascadeShadowConfigBuilder, DirectionalLight, LightPlugin, PointLight};
use bevy_math::Vec3;
use bevy_mesh::{Mesh, Mesh3d, MeshPlugin};
use bevy_shape::Cuboid;
use bevy_transform::components::Transform;
use bevy_transform::{TransformPlugin, TransformSystems};
use layout::{Part, dice};

const FRAMES: usize = 120;

#[derive(Component)]
struct Walker(f32);

/// Times between which the step runs, in two parts.
#[derive(Resource, Default)]
struct Marks(Vec<Instant>);

/// What there is besides things that stand still.
#[derive(Clone, Copy)]
struct Scene {
    name: &'static str,
    houses: bool,
    /// Whether one thing in twenty walks.
    walks: bool,
    sun: bool,
    lamps: usize,
}

const STILL: Scene = Scene { name: "still", houses: true, walks: false, sun: false, lamps: 0 };

const SCENES: [Scene; 5] = [
    STILL,
    Scene { name: "1 in 20 walks", walks: true, ..STILL },
    Scene { name: "walks, sun", walks: true, sun: true, ..STILL },
    Scene { name: "still, 8 lamps", lamps: 8, ..STILL },
    Scene { name: "still, no houses", houses: false, ..STILL },
];

fn main() {
    let given: Vec<usize> = std::env::args().skip(1).filter_map(|n| n.parse().ok()).collect();
    let sizes = if given.is_empty() { vec![2_000, 20_000, 200_000] } else { given };
    println!(
        "| entities | scene | by | drawn | casters | lamps | step, ms: median, mean (99%) | of Bevy's | frames that load: median, mean (99%), number |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for size in sizes {
        SCENES.iter().for_each(|scene| measure(size, scene));
    }
}

/// Camera and lights.
fn light(world: &mut World, scene: &Scene) {
    let lens = PerspectiveProjection { aspect_ratio: 16.0 / 9.0, far: 1e4, ..Default::default() };
    world.spawn((Camera3d::default(), Projection::Perspective(lens), layout::street(0.0)));
    let sun = DirectionalLight { shadow_maps_enabled: scene.sun, ..Default::default() };
    let down = Transform::default().looking_to(Vec3::new(0.3, -1.0, -0.5), Vec3::Y);
    world.spawn((sun, CascadeShadowConfigBuilder::default().build(), down));
    for i in 0..scene.lamps {
        let at = Vec3::new(24.0 * (i % 3) as f32 - 36.0, 3.0, 12.0 - 24.0 * (i / 3) as f32);
        let lamp = PointLight { shadow_maps_enabled: true, range: 30.0, ..Default::default() };
        world.spawn((lamp, Transform::from_translation(at)));
    }
}

/// A city, with casca that is on or off or without it, and the times of the frames in which it came.
fn city(size: usize, scene: &Scene, casca: Option<bool>) -> (App, Vec<f64>) {
    let mut app = App::new();
    app.add_plugins((TaskPoolPlugin::default(), TransformPlugin, AssetPlugin::default(), MeshPlugin));
    app.init_asset::<bevy_image::Image>().add_plugins((CameraPlugin, LightPlugin));
    if let Some(enabled) = casca {
        app.add_plugins(CascaPlugin).insert_resource(CascaSettings { enabled, ..Default::default() });
    }
    let mark = |mut marks: ResMut<Marks>| marks.0.push(Instant::now());
    let first = (VisibilitySystems::CalculateBounds, VisibilitySystems::UpdateFrusta);
    let lights = (SimulationLightSystems::AssignLightsToClusters, SimulationLightSystems::UpdateLightFrusta);
    app.init_resource::<Marks>().add_systems(
        PostUpdate,
        (
            mark.after(TransformSystems::Propagate)
                .before(first.0)
                .before(first.1)
                .before(VisibilitySystems::VisibilityPropagate),
            mark.after(VisibilitySystems::CheckVisibility).before(lights.0.clone()).before(lights.1.clone()),
            mark.after(lights.0).after(lights.1).before(SimulationLightSystems::CheckLightVisibility),
            mark.after(VisibilitySystems::MarkNewlyHiddenEntitiesInvisible),
        ),
    );
    light(app.world_mut(), scene);
    let cube = app.world_mut().resource_mut::<Assets<Mesh>>().add(Mesh::from(Cuboid::new(1.0, 1.0, 1.0)));
    let boxes = layout::boxes(size).filter(|(part, ..)| scene.houses || *part != Part::House);
    let boxes: Vec<_> = boxes.collect();
    let (mut coming, mut times, start) = (boxes.chunks(1000), Vec::new(), Instant::now());
    loop {
        let (frame, come) = (Instant::now(), coming.next());
        for (part, i, middle, size) in come.unwrap_or_default() {
            let at = Transform::from_translation(*middle).with_scale(*size);
            let mut thing = app.world_mut().spawn((Mesh3d(cube.clone()), at, Opaque::Front));
            if *part == Part::Thing && i.is_multiple_of(20) {
                thing.insert(Walker(dice(*i) * 6.3));
            }
        }
        app.update();
        times.push(frame.elapsed().as_secs_f64() * 1e3);
        // All entities are known, all meshes are prepared, and bounds have been computed.
        let known = app.world().get_resource::<CascaScene>().filter(|_| casca == Some(true));
        let is_there = |it: &CascaScene| it.scene().is_some_and(|scene| scene.len() >= boxes.len());
        let is_ready = times.len() >= 4 && known.is_none_or(|it| is_there(it) && !it.is_preparing());
        if come.is_none() && is_ready || start.elapsed().as_secs() > 60 {
            break;
        }
    }
    app.world_mut().resource_mut::<Marks>().0.clear();
    (app, times)
}

/// Moves what moves. Runs a frame; returns the time of the step.
fn run(app: &mut App, scene: &Scene, frame: usize) -> f64 {
    let world = app.world_mut();
    let mut walkers = world.query::<(&Walker, &mut Transform)>();
    for (walker, mut at) in walkers.iter_mut(world).filter(|_| scene.walks) {
        let angle = walker.0 + frame as f32 * 0.02;
        at.translation += Vec3::new(angle.cos(), 0.0, angle.sin()) * 0.03;
    }
    let mut camera = world.query_filtered::<&mut Transform, With<Camera3d>>();
    camera.iter_mut(world).for_each(|mut at| *at = layout::street(frame as f32 / FRAMES as f32));
    app.update();
    let marks = std::mem::take(&mut app.world_mut().resource_mut::<Marks>().0);
    marks.chunks(2).map(|part| (part[1] - part[0]).as_secs_f64() * 1e3).sum()
}

/// How many entities are drawn and cast shadows, and how many lamps shine.
fn counts(app: &mut App) -> [usize; 3] {
    let world = app.world_mut();
    let mut lists = world.query::<&VisibleEntities>();
    let drawn = lists.iter(world).map(|list| list.len(TypeId::of::<Mesh3d>())).sum();
    let mut lists = world.query::<&CascadesVisibleEntities>();
    let lists = lists.iter(world).flat_map(|cascades| cascades.entities.values().flatten());
    let mut casters = lists.map(|list| list.entities.len()).sum();
    let mut lamps = world.query::<(&CubemapVisibleEntities, &ViewVisibility)>();
    let lamps = lamps.iter(world).filter(|(_, shines)| shines.get());
    let lit = lamps.map(|(lists, _)| lists.iter().map(|list| list.entities.len()).sum());
    let lit: Vec<usize> = lit.collect();
    casters += lit.iter().sum::<usize>();
    [drawn, casters, lit.len()]
}

fn measure(size: usize, scene: &Scene) {
    let all = [(None, "Bevy"), (Some(false), "casca, off"), (Some(true), "casca")];
    let mut cities = all.map(|(casca, _)| city(size, scene, casca));
    let mut times = all.map(|_| Vec::new());
    let mut sums = all.map(|_| [0; 3]);
    for frame in 0..FRAMES {
        for (((app, _), times), sums) in cities.iter_mut().zip(&mut times).zip(&mut sums) {
            times.push(run(app, scene, frame));
            sums.iter_mut().zip(counts(app)).for_each(|(sum, count)| *sum += count);
        }
    }
    let of = |times: &mut Vec<f64>| {
        times.sort_by(f64::total_cmp);
        let mean = times.iter().sum::<f64>() / times.len() as f64;
        [times[times.len() / 2], mean, times[times.len() * 99 / 100]]
    };
    let steps = times.each_mut().map(of);
    for ((((_, name), step), [drawn, casters, lamps]), (_, load)) in
        all.iter().zip(steps).zip(&sums).zip(&mut cities)
    {
        let [[median, mean, most], [b_median, b_mean, _]] = [step, steps[0]];
        let [drawn, casters, lamps] = [drawn, casters, lamps].map(|sum| *sum as f64 / FRAMES as f64);
        print!("| {size} | {} | {name} | {drawn:.0} | {casters:.0} | {lamps:.1} ", scene.name);
        print!("| {median:.3}, {mean:.3} ({most:.3}) | {:.2}, {:.2} ", median / b_median, mean / b_mean);
        let ([median, mean, most], frames) = (of(load), load.len());
        println!("| {median:.2}, {mean:.2} ({most:.2}), {frames} |");
    }
}
