//! What a frame of Bevy's costs with its own culling, with its occlusion culling on the graphics
//! adapter, and with casca: the main world, extraction, what the render world prepares, and drawing
//! until the adapter is done.
//!
//! `cargo run --release --bin times`, or with numbers of entities behind `--`. All four draw the
//! same town, and the last picture of each is compared with Bevy's.

use std::time::Instant;

use bevy::app::AppLabel;
use bevy::camera::Exposure;
use bevy::core_pipeline::prepass::DepthPrepass;
use bevy::prelude::*;
use bevy::render::occlusion_culling::OcclusionCulling;
use bevy::render::render_resource::PollType;
use bevy::render::renderer::{RenderAdapterInfo, RenderDevice};
use bevy::render::{Render, RenderApp, RenderSystems};
use bevy_casca::{CascaScene, CascaSettings, Shadows};
use bevy_casca_rendered::rendered::Rendered;
use bevy_casca_rendered::town::{self, Walker};
use clap::Parser;

/// Frames before the first that counts.
const WARM_UP: usize = 40;

/// Seconds from one frame to the next.
const STEP: f32 = 1.0 / 60.0;

/// Times frames of Bevy's with its own culling and with casca.
#[derive(Parser)]
struct Arguments {
    /// Numbers of entities
    #[arg(default_values_t = [2_000, 20_000])]
    entities: Vec<usize>,
    /// Frames of each
    #[arg(long, default_value_t = 60)]
    frames: usize,
}

/// Who culls.
#[derive(Clone, Copy, PartialEq)]
enum Culls {
    Bevy,
    /// With `OcclusionCulling`, for the camera and the sun.
    BevyOcclusion,
    /// For cameras; lights as Bevy does it.
    CascaForCameras,
    Casca,
}

impl Culls {
    const ALL: [Self; 4] = [Self::Bevy, Self::BevyOcclusion, Self::CascaForCameras, Self::Casca];

    fn name(self) -> &'static str {
        match self {
            Self::Bevy => "Bevy",
            Self::BevyOcclusion => "Bevy, `OcclusionCulling`",
            Self::CascaForCameras => "casca, cameras only",
            Self::Casca => "casca",
        }
    }
}

fn main() -> Result<(), String> {
    let arguments = Arguments::parse();
    println!(
        "| entities | culled by | drawn | shadow casters | main world, ms | extraction | preparing | drawing | all | pixels that differ |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    let mut adapter = String::new();
    for &entities in &arguments.entities {
        let mut first = None;
        for culls in Culls::ALL {
            let (picture, info) = measure(entities, culls, arguments.frames.max(1), first.as_deref())?;
            first.get_or_insert(picture);
            adapter = info;
        }
    }
    println!("\nThe adapter: {adapter}. Medians of {} frames.", arguments.frames.max(1));
    Ok(())
}

/// Prints a row. Returns the last picture, and what the adapter is.
fn measure(
    entities: usize,
    culls: Culls,
    frames: usize,
    other: Option<&[u8]>,
) -> Result<(Vec<u8>, String), String> {
    let shadows = match culls {
        Culls::Bevy | Culls::BevyOcclusion => None,
        Culls::CascaForCameras => Some(Shadows::All),
        Culls::Casca => Some(Shadows::Lit),
    };
    let settings = shadows.map(|shadows| CascaSettings { shadows, ..default() });
    let fill = |world: &mut World| town::fill(world, entities);
    let mut rendered = Rendered::with(settings, fill, town::street(0.0))?;
    let draws = (|mut since: ResMut<DrawsSince>| since.0 = Instant::now())
        .after(RenderSystems::Prepare)
        .before(RenderSystems::Render);
    rendered
        .app()
        .sub_app_mut(RenderApp)
        .insert_resource(DrawsSince(Instant::now()))
        .add_systems(Render, draws);
    let (world, camera) = rendered.world_and_camera();
    world.entity_mut(camera).insert((DepthPrepass, Exposure::default()));
    if culls == Culls::BevyOcclusion {
        let suns = world.query_filtered::<Entity, With<DirectionalLight>>().iter(world).collect::<Vec<_>>();
        suns.into_iter().chain([camera]).for_each(|entity| {
            world.entity_mut(entity).insert(OcclusionCulling);
        });
    }
    let (mut parts, mut drawn, mut casters) = (vec![[0.0; 4]; 0], 0, 0);
    for frame in 0..WARM_UP + frames {
        place(&mut rendered, frame.saturating_sub(WARM_UP) as f32 * STEP);
        let times = frame_of(rendered.app())?;
        if frame < WARM_UP || !is_ready(&rendered, entities) {
            continue;
        }
        parts.push(times);
        drawn += rendered.drawn();
        casters += rendered.casters();
    }
    let counted = parts.len().max(1);
    let median = |part: &dyn Fn(&[f64; 4]) -> f64| {
        let mut all: Vec<f64> = parts.iter().map(part).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or(f64::NAN)
    };
    let picture = rendered.capture()?;
    let differ =
        other.map_or(0, |other| picture.chunks(4).zip(other.chunks(4)).filter(|(a, b)| a != b).count());
    println!(
        "| {entities} | {} | {} | {} | {:.2} | {:.2} | {:.2} | {:.1} | {:.1} | {differ} |",
        culls.name(),
        drawn / counted,
        casters / counted,
        median(&|p| p[0]),
        median(&|p| p[1]),
        median(&|p| p[2]),
        median(&|p| p[3]),
        median(&|p| p.iter().sum()),
    );
    let info = rendered.app().sub_app(RenderApp).world().resource::<RenderAdapterInfo>();
    Ok((picture, info.name.clone()))
}

/// Moves the camera and all walkers to where they are at a time.
fn place(rendered: &mut Rendered, time: f32) {
    let (world, camera) = rendered.world_and_camera();
    let mut walkers = world.query::<(&mut Transform, &Walker)>();
    walkers.iter_mut(world).for_each(|(mut at, walker)| at.translation = walker.at(time));
    if let Some(mut at) = world.get_mut::<Transform>(camera) {
        *at = town::street(time);
    }
}

/// When the render world began to draw.
#[derive(Resource)]
struct DrawsSince(Instant);

/// A frame: the milliseconds of the main world, of extraction, of the render world before it draws,
/// and of drawing, until the adapter is done.
fn frame_of(app: &mut App) -> Result<[f64; 4], String> {
    let apps = app.sub_apps_mut();
    let mut at = vec![Instant::now()];
    apps.main.run_default_schedule();
    at.push(Instant::now());
    let render = apps.sub_apps.get_mut(&RenderApp.intern()).ok_or("Bevy renders nothing")?;
    render.extract(apps.main.world_mut());
    at.push(Instant::now());
    render.update();
    at.push(render.world().get_resource::<DrawsSince>().ok_or("Bevy draws nothing")?.0);
    apps.main.world_mut().clear_trackers();
    let device = render.world().resource::<RenderDevice>();
    device.poll(PollType::wait_indefinitely()).map_err(|why| format!("the adapter: {why}"))?;
    at.push(Instant::now());
    Ok(std::array::from_fn(|i| (at[i + 1] - at[i]).as_secs_f64() * 1e3))
}

fn is_ready(rendered: &Rendered, entities: usize) -> bool {
    let casca = rendered.casca();
    casca.is_none_or(|casca: &CascaScene| {
        casca.scene().is_some_and(|scene| scene.len() >= entities) && !casca.is_preparing()
    })
}
