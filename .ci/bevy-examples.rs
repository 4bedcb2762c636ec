//! What `.ci/bevy-examples` puts around Bevy's examples: the plugin, a clock that stands still, pictures,
//! and what is drawn in them.

mod examples;

use std::any::TypeId;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use bevy::anti_alias::taa::TemporalAntiAliasing;
use bevy::app::PluginGroupBuilder;
use bevy::camera::visibility::{
    CascadesVisibleEntities, CubemapVisibleEntities, RenderLayers, ViewVisibility, VisibleEntities,
    VisibleMeshEntities,
};
use bevy::camera::{RenderTarget, primitives::Aabb};
use bevy::diagnostic::FrameCount;
use bevy::math::Vec3A;
use bevy::light::{DirectionalLightShadowMap, PointLightShadowMap};
use bevy::prelude::*;
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::PipelineCache;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::render::{Render, RenderApp, RenderPlugin};
use bevy::time::TimeUpdateStrategy;
use bevy::window::{PrimaryWindow, WindowResolution};
use bevy::winit::WinitSettings;
use bevy_casca::{CascaPlugin, CascaScene, standard_materials};

/// The window: small, since a processor draws.
const SIZE: (u32, u32) = (480, 270);

/// Frames in which all has to be there, one after the other, before the clock runs.
const READY: u32 = 8;

/// Frames after which the clock runs whatever is there.
const PATIENCE: u32 = 900;

/// Frames in which the clock runs, 60 in a second.
const MOVING: u32 = 12;

/// Frames in which it stands before a picture: still things hide, and averages over frames settle.
const HELD: u32 = 14;

/// The pictures: how far the eye is turned around what there is, in degrees, and the part of the view, from
/// left to right between -1 and 1, that a wall hides.
const PICTURES: [(f32, Option<[f32; 2]>); 5] =
    [(0.0, None), (0.0, None), (0.0, Some([0.0, 0.8])), (120.0, Some([-0.9, 0.1])), (240.0, None)];

/// The files that examples may load.
const FILES: &str = include_str!("files");

/// Pipelines that are not there yet.
static WAITING: AtomicUsize = AtomicUsize::new(0);

/// Bevy's plugins, with what watches them, and with the plugin `bevy_casca` if the environment asks for it.
pub fn plugins() -> PluginGroupBuilder {
    let render = RenderPlugin { synchronous_pipeline_compilation: true, ..default() };
    DefaultPlugins.set(render).disable::<PipelinedRenderingPlugin>().add(watch)
}

fn watch(app: &mut App) {
    if std::env::var("WITH").is_ok_and(|with| with == "casca") {
        app.add_plugins((CascaPlugin, standard_materials!(bevy::pbr)));
    }
    let mut windows = app.world_mut().query_filtered::<&mut Window, With<PrimaryWindow>>();
    for mut window in windows.iter_mut(app.world_mut()) {
        window.resolution = WindowResolution::new(SIZE.0, SIZE.1).with_scale_factor_override(1.0);
    }
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO))
        .init_resource::<Course>()
        .insert_resource(WinitSettings::continuous())
        // Most of the time of a frame goes into shadow maps here.
        .insert_resource(DirectionalLightShadowMap { size: 512 })
        .insert_resource(PointLightShadowMap { size: 256 })
        .add_systems(PostUpdate, place.before(TransformSystems::Propagate))
        .add_systems(Last, step);
    if let Some(render) = app.get_sub_app_mut(RenderApp) {
        render.add_systems(Render, |cache: Res<PipelineCache>| {
            WAITING.store(cache.waiting_pipelines().count(), Ordering::Relaxed);
        });
    }
}

/// How far a run has come.
#[derive(Resource, Default)]
struct Course {
    /// Frames until the clock ran, and of those the last ones in which all was there.
    loading: u32,
    ready: u32,
    runs: bool,
    /// Frames since then, or since the last picture.
    frame: u32,
    /// Pictures that were taken, and whether one is on its way.
    taken: usize,
    asked: bool,
    /// Around what eyes are turned.
    middle: Vec3,
    eyes: Vec<Eye>,
}

/// A camera that shows something in the window.
struct Eye {
    camera: Entity,
    /// Where the example has it, and where it is for a picture.
    before: Transform,
    now: Transform,
    /// Whether it has a place of its own.
    free: bool,
}

/// What hides a part of a picture.
#[derive(Component)]
struct Wall;

fn step(world: &mut World) {
    world.resource_scope(
        |world, mut course: Mut<Course>| {
            if course.runs { course.run(world) } else { course.load(world) }
        },
    );
}

/// Keeps turned eyes where they are, whatever an example does with them.
fn place(course: Res<Course>, mut places: Query<&mut Transform>) {
    for eye in course.eyes.iter().filter(|eye| eye.free) {
        if let Ok(mut place) = places.get_mut(eye.camera) {
            place.set_if_neq(eye.now);
        }
    }
}

impl Course {
    /// Lets the clock run when all is there.
    fn load(&mut self, world: &mut World) {
        let server = world.resource::<AssetServer>();
        let loads = |id| !server.is_loaded_with_dependencies(id) && !server.load_state(id).is_failed();
        let waits = FILES.lines().flat_map(|file| server.get_path_ids(file)).any(loads)
            || WAITING.load(Ordering::Relaxed) > 0
            || world.get_resource::<CascaScene>().is_some_and(CascaScene::is_preparing);
        self.ready = if waits { 0 } else { self.ready + 1 };
        self.loading += 1;
        if self.ready < READY && self.loading < PATIENCE {
            std::thread::sleep(Duration::from_millis(5));
            return;
        }
        println!("loaded after {} frames{}", self.loading, if waits { ", but not all" } else { "" });
        self.runs = true;
        // The same in each run, and none that was: renderers remember in which frame a mesh changed.
        world.insert_resource(FrameCount(2 * PATIENCE));
        // What was drawn while things loaded differs from run to run.
        let mut histories = world.query::<&mut TemporalAntiAliasing>();
        histories.iter_mut(world).for_each(|mut history| history.reset = true);
        world.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs(1) / 60));
    }

    /// Takes a picture when it is time.
    fn run(&mut self, world: &mut World) {
        self.frame += 1;
        if self.asked || self.frame < if self.taken == 0 { MOVING } else { HELD } {
            return;
        }
        self.asked = true;
        world.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
        println!("picture {} {}", self.taken, counts(world));
        world.spawn(Screenshot::primary_window()).observe(
            |shot: On<ScreenshotCaptured>, mut commands: Commands| {
                let picture = shot.image.clone();
                commands.queue(move |world: &mut World| {
                    world.resource_scope(|world, mut course: Mut<Course>| {
                        if let Err(why) = course.keep(world, picture) {
                            println!("no picture: {why}");
                            world.write_message(AppExit::error());
                        }
                    });
                });
            },
        );
    }

    /// Writes a picture, and makes ready for the next one.
    fn keep(&mut self, world: &mut World, picture: Image) -> Result<(), BevyError> {
        let name = format!("{}.{}.png", std::env::var("OUT")?, self.taken);
        picture.try_into_dynamic()?.to_rgb8().save(name)?;
        self.taken += 1;
        (self.asked, self.frame) = (false, 0);
        let Some(&(angle, wall)) = PICTURES.get(self.taken) else {
            world.write_message(AppExit::Success);
            return Ok(());
        };
        if self.eyes.is_empty() {
            self.look(world);
        }
        let walls: Vec<Entity> = world.query_filtered::<Entity, With<Wall>>().iter(world).collect();
        walls.into_iter().for_each(|wall| _ = world.despawn(wall));
        let mesh = world.resource_mut::<Assets<Mesh>>().add(Cuboid::from_length(1.0));
        let material = world.resource_mut::<Assets<StandardMaterial>>().add(Color::srgb(0.5, 0.4, 0.3));
        let [to, from] = [self.middle, -self.middle].map(Transform::from_translation);
        let turn = to * Transform::from_rotation(Quat::from_rotation_y(f32::to_radians(angle))) * from;
        for eye in &mut self.eyes {
            eye.now = if eye.free { turn * eye.before } else { eye.before };
            let camera = world.entity(eye.camera).get_components::<(&Camera, Option<&RenderLayers>)>();
            let Ok((camera, layers)) = camera else { continue };
            let layers = layers.cloned().unwrap_or_default();
            let Some(wall) = wall.and_then(|sides| before(camera, eye.now, self.middle, sides)) else {
                continue;
            };
            world.spawn((Wall, Mesh3d(mesh.clone()), MeshMaterial3d(material.clone()), wall, layers));
        }
        Ok(())
    }

    /// Finds the eyes, and what they look at.
    fn look(&mut self, world: &mut World) {
        let mut cameras = world.query_filtered::<
            (Entity, &Camera, &RenderTarget, &GlobalTransform, Has<ChildOf>), With<Camera3d>>();
        for (camera, state, target, at, child) in cameras.iter(world) {
            if state.is_active && matches!(target, RenderTarget::Window(_)) {
                let at = at.compute_transform();
                self.eyes.push(Eye { camera, before: at, now: at, free: !child });
            }
        }
        let mut meshes = world.query_filtered::<(&GlobalTransform, &Aabb), With<Mesh3d>>();
        let middles: Vec<Vec3A> =
            meshes.iter(world).map(|(at, aabb)| at.affine().transform_point3a(aabb.center)).collect();
        // The median, for each axis.
        self.middle = Vec3::from_array([0, 1, 2].map(|axis| {
            let mut along: Vec<f32> = middles.iter().map(|middle| middle[axis]).collect();
            along.sort_by(f32::total_cmp);
            along.get(along.len() / 2).copied().unwrap_or_default()
        }));
    }
}

/// A wall between an eye and what it looks at.
fn before(camera: &Camera, eye: Transform, middle: Vec3, [left, right]: [f32; 2]) -> Option<Transform> {
    let far = (middle - eye.translation).dot(*eye.forward()).abs().max(0.4) / 2.0;
    let depth = camera.clip_from_view().project_point3(Vec3::new(0.0, 0.0, -far)).z;
    let at = |x: f32, y: f32| camera.ndc_to_world(&eye.into(), Vec3::new(x, y, depth));
    let (low, high, beside) = (at(left, -1.0)?, at(right, 1.0)?, at(right, -1.0)?);
    let scale = Vec3::new(low.distance(beside), beside.distance(high), far / 50.0);
    Some(Transform { translation: (low + high) / 2.0, rotation: eye.rotation, scale })
}

/// What is drawn, and how much hides others.
fn counts(world: &mut World) -> String {
    let mut cameras = world.query::<(&Camera, &VisibleEntities)>();
    let active = cameras.iter(world).filter(|(camera, _)| camera.is_active);
    let drawn: usize = active.map(|(_, seen)| seen.get(TypeId::of::<Mesh3d>()).len()).sum();
    let mut suns = world.query::<&CascadesVisibleEntities>();
    let cascades = suns.iter(world).flat_map(|sun| sun.entities.values().flatten());
    let mut casters: usize = cascades.map(|cascade| cascade.entities.len()).sum();
    // Lamps that shine on nothing in sight have no shadow maps.
    let mut bulbs = world.query::<(&CubemapVisibleEntities, &ViewVisibility)>();
    let bulbs = bulbs.iter(world).filter(|(_, seen)| seen.get()).flat_map(|(bulb, _)| bulb.iter());
    casters += bulbs.map(|face| face.entities.len()).sum::<usize>();
    let mut spots = world.query::<(&VisibleMeshEntities, &ViewVisibility)>();
    let spots = spots.iter(world).filter(|(_, seen)| seen.get());
    casters += spots.map(|(spot, _)| spot.entities.len()).sum::<usize>();
    let meshes = world.query::<&Mesh3d>().iter(world).len();
    let hide = meshes.saturating_sub(CascaScene::all_why_not(world).count());
    format!("{drawn} {casters} {hide} {meshes}")
}

/// How many pixels differ in two pictures.
fn compare(a: &str, b: &str) -> Result<String, BevyError> {
    let (a, b) = (image::open(a)?.to_rgb8(), image::open(b)?.to_rgb8());
    let differ = a.pixels().zip(b.pixels()).filter(|(a, b)| a != b).count();
    Ok(if a.dimensions() == b.dimensions() { differ.to_string() } else { "size".into() })
}

/// Runs an example, or compares the pictures of two runs.
fn main() {
    let name = |name: &str| std::env::var(name).unwrap_or_default();
    if let Ok(example) = std::env::var("EXAMPLE") {
        return examples::run(&example);
    }
    let number = |i: usize| compare(&format!("{}.{i}.png", name("A")), &format!("{}.{i}.png", name("B")));
    let each = (0..PICTURES.len()).map(|i| number(i).unwrap_or_else(|_| "missing".into()));
    println!("{}", each.collect::<Vec<_>>().join(" "));
}
