//! A town in a window. A second camera shows from above which things are culled.
//!
//! `cargo run --release --features window --bin city`. `--picture FILE` draws it without a window;
//! `page/build` makes a page of it.

use std::any::TypeId;
use std::path::PathBuf;
use std::process::ExitCode;

use bevy::camera::primitives::{Aabb, Frustum};
use bevy::camera::visibility::{CascadesVisibleEntities, RenderLayers, VisibleEntities};
use bevy::camera::{RenderTarget, Viewport};
use bevy::camera_controller::free_camera::{FreeCamera, FreeCameraPlugin};
use bevy::core_pipeline::tonemapping::{DebandDither, Tonemapping};
use bevy::diagnostic::{DiagnosticPath, DiagnosticsStore, FrameTimeDiagnosticsPlugin};
use bevy::ecs::entity::EntityHashSet;
use bevy::light::{NotShadowCaster, NotShadowReceiver};
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::winit::WinitPlugin;
use bevy_casca::{CascaDiagnostics, CascaPlugin, CascaSettings, NoOcclusionCulling, standard_materials};
use bevy_casca_rendered::town::{self, Moves, Part};
use clap::Parser;

/// The title of the window, before the counts.
const TITLE: &str = "casca in Bevy";

/// What only the camera above the town sees.
const ABOVE: RenderLayers = RenderLayers::layer(1);

/// The share of the window that the view from above takes, of its width and height.
const SHARE: f32 = 0.45;

/// The longest step of the walk, in seconds.
const STEP: f32 = 1.0 / 15.0;

/// A town that Bevy draws, with and without occlusion culling by casca
#[derive(Parser)]
struct Arguments {
    /// How many things are in the town
    #[arg(long, default_value_t = 5000)]
    entities: usize,
    /// Draws a picture into this PNG file instead of opening a window
    #[arg(long)]
    picture: Option<PathBuf>,
}

/// The camera that walks.
#[derive(Component)]
struct Eye;

/// The camera above.
#[derive(Component)]
struct Bird;

/// What is drawn from above in the place of a thing.
#[derive(Component)]
struct Twin(Entity);

#[derive(Component)]
struct Words;

/// The materials of things that are drawn, hidden, and out of view.
#[derive(Resource)]
struct Paints([Handle<StandardMaterial>; 3]);

/// The walk down the street.
#[derive(Resource)]
struct Walk {
    goes: bool,
    time: f32,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let mut app = App::new();
    let render = RenderPlugin { synchronous_pipeline_compilation: arguments.picture.is_some(), ..default() };
    // The window, or the picture of the page.
    let canvas = Some("#picture".into());
    let window = Window { title: TITLE.into(), canvas, fit_canvas_to_parent: true, ..default() };
    let primary_window = arguments.picture.is_none().then_some(window);
    let plugins = DefaultPlugins.set(render).set(WindowPlugin { primary_window, ..default() });
    let plugins = plugins.disable::<LogPlugin>();
    app.add_plugins(match arguments.picture {
        Some(_) => plugins.disable::<WinitPlugin>(),
        None => plugins,
    });
    app.insert_resource(ClearColor(Color::srgb(0.62, 0.74, 0.86)))
        .insert_resource(Walk { goes: true, time: 0.0 })
        .add_plugins((CascaPlugin, standard_materials!(bevy::pbr)))
        .add_plugins((FrameTimeDiagnosticsPlugin::default(), FreeCameraPlugin))
        .add_systems(Update, (keys, walk, watch, paint.pipe(tell)).chain());
    #[cfg(not(target_family = "wasm"))]
    if let Some(file) = arguments.picture {
        let done = picture(app, arguments.entities, &file).inspect_err(|why| eprintln!("{why}"));
        return ExitCode::from(u8::from(done.is_err()));
    }
    set_up(app.world_mut(), arguments.entities, &RenderTarget::default());
    app.run();
    ExitCode::SUCCESS
}

/// Runs some frames without a window, and writes the last one. A page has no files.
#[cfg(not(target_family = "wasm"))]
fn picture(mut app: App, entities: usize, file: &std::path::Path) -> Result<(), String> {
    use bevy::render::render_resource::TextureFormat;
    use bevy_casca_rendered::rendered;

    /// The picture is that of the frame after so many.
    const FRAMES: u32 = 60;
    let size = UVec2::new(1280, 720);
    rendered::start(&mut app);
    let image = Image::new_target_texture(size.x, size.y, TextureFormat::Rgba8UnormSrgb, None);
    let image = app.world_mut().resource_mut::<Assets<Image>>().add(image);
    set_up(app.world_mut(), entities, &RenderTarget::Image(image.clone().into()));
    for _ in 0..FRAMES {
        app.update();
    }
    let picture = rendered::capture(&mut app, &image)?;
    let picture = image::RgbaImage::from_raw(size.x, size.y, picture).ok_or("a picture of another size")?;
    picture.save(file).map_err(|why| format!("{}: {why}", file.display()))
}

/// Spawns the town, its twin for the view from above, cameras and words.
fn set_up(world: &mut World, entities: usize, target: &RenderTarget) {
    town::fill(world, entities);
    let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
    let paint = |color: [f32; 3]| {
        let base_color = Color::srgb_from_array(color);
        materials.add(StandardMaterial { base_color, perceptual_roughness: 0.9, ..default() })
    };
    let colors = [[0.95, 0.75, 0.35], [0.2, 0.4, 0.95], [0.33, 0.34, 0.36], [0.16, 0.17, 0.18]];
    let [seen, hidden, out, ground] = colors.map(paint);
    let mut things = world.query::<(Entity, &Mesh3d, &Part)>();
    let things: Vec<_> =
        things.iter(world).map(|(thing, mesh, part)| (thing, mesh.clone(), *part == Part::Ground)).collect();
    for (thing, mesh, flat) in things {
        let material = if flat { ground.clone() } else { out.clone() };
        let culls = (NoOcclusionCulling, NotShadowCaster, NotShadowReceiver);
        let mut twin = world.spawn((mesh, MeshMaterial3d(material), ABOVE, culls, ChildOf(thing)));
        if !flat {
            twin.insert(Twin(thing));
        }
    }
    world.insert_resource(Paints([seen, hidden, out]));
    let light = DirectionalLight { illuminance: 7_000.0, ..default() };
    world.spawn((light, Transform::default().looking_to(Vec3::new(0.4, -1.0, -0.6), Vec3::Y), ABOVE));
    let light = AmbientLight { brightness: 900.0, ..default() };
    let colors = (Tonemapping::AcesFitted, DebandDither::Disabled, light);
    let camera = (Camera3d::default(), target.clone(), Msaa::Off, colors);
    let gizmo = ShowFrustumGizmo { color: Some(Color::WHITE) };
    let eye = (camera.clone(), town::street(0.0), gizmo);
    world.spawn((Eye, eye, FreeCamera::default(), IsDefaultUiCamera));
    let second =
        Camera { order: 1, clear_color: ClearColorConfig::Custom(Color::srgb(0.1, 0.1, 0.12)), ..default() };
    world.spawn((Bird, camera, second, ABOVE, NoOcclusionCulling));
    let mut gizmos = world.resource_mut::<GizmoConfigStore>();
    gizmos.config_mut::<FrustumGizmoConfigGroup>().0.render_layers = ABOVE;
    let font = TextFont { font_size: FontSize::Px(14.0), ..default() };
    let place = Node {
        position_type: PositionType::Absolute,
        left: px(10),
        top: px(10),
        padding: UiRect::all(px(8)),
        ..default()
    };
    world.spawn((Words, Text::default(), font, place, BackgroundColor(Color::srgba(0.0, 0.0, 0.0, 0.65))));
}

/// F1 turns casca on and off, B the view from above; Space walks on after a flight.
fn keys(
    pressed: Res<ButtonInput<KeyCode>>,
    mut settings: ResMut<CascaSettings>,
    mut walk: ResMut<Walk>,
    mut bird: Single<&mut Camera, With<Bird>>,
) {
    if pressed.just_pressed(KeyCode::F1) {
        settings.enabled = !settings.enabled;
    }
    walk.goes |= pressed.just_pressed(KeyCode::Space);
    if pressed.just_pressed(KeyCode::KeyB) {
        bird.is_active = !bird.is_active;
    }
    let flies = [KeyCode::KeyW, KeyCode::KeyA, KeyCode::KeyS, KeyCode::KeyD, KeyCode::KeyE, KeyCode::KeyQ];
    walk.goes &= !pressed.any_pressed(flies);
}

/// Moves all that walks.
fn walk(
    time: Res<Time>,
    mut walk: ResMut<Walk>,
    mut eye: Single<&mut Transform, With<Eye>>,
    mut walkers: Query<(&mut Transform, &Moves), Without<Eye>>,
) {
    walkers.iter_mut().for_each(|(mut at, walker)| at.translation = walker.at(time.elapsed_secs()));
    if walk.goes {
        walk.time += time.delta_secs().min(STEP);
        **eye = town::street(walk.time);
    }
}

/// Keeps the second camera above the first, and its view in the corner of the window.
fn watch(
    eye: Single<(&Transform, &Camera), (With<Eye>, Without<Bird>)>,
    mut bird: Single<(&mut Transform, &mut Camera), With<Bird>>,
) {
    let (at, camera) = (eye.0.translation, eye.1);
    let above = Transform::from_translation(at + Vec3::new(0.0, 110.0, 75.0));
    *bird.0 = above.looking_at(at + Vec3::new(0.0, 0.0, -25.0), Vec3::Y);
    let Some(size) = camera.physical_target_size() else { return };
    let part = (size.as_vec2() * SHARE).as_uvec2().max(UVec2::ONE);
    let corner = UVec2::new(size.x - part.x.min(size.x), 0);
    let shown = bird.1.viewport.as_ref().map(|view| (view.physical_position, view.physical_size));
    if shown != Some((corner, part)) {
        bird.1.viewport = Some(Viewport { physical_position: corner, physical_size: part, ..default() });
    }
}

/// Gives each twin the color of what became of its thing in the last frame. Returns how many are in
/// view, hidden or not.
fn paint(
    eye: Single<(&VisibleEntities, &Frustum), With<Eye>>,
    things: Query<(&Aabb, &GlobalTransform), With<Part>>,
    mut twins: Query<(&Twin, &mut MeshMaterial3d<StandardMaterial>)>,
    paints: Res<Paints>,
) -> usize {
    let (visible, frustum) = *eye;
    let drawn: EntityHashSet = visible.get(TypeId::of::<Mesh3d>()).iter().copied().collect();
    let [seen, hidden, out] = &paints.0;
    let mut in_view = 0;
    for (twin, mut material) in &mut twins {
        let Ok((aabb, transform)) = things.get(twin.0) else { continue };
        let inside = frustum.intersects_obb(aabb, &transform.affine(), true, true);
        in_view += usize::from(inside);
        let now = match (drawn.contains(&twin.0), inside) {
            (true, _) => seen,
            (false, true) => hidden,
            (false, false) => out,
        };
        material.set_if_neq(MeshMaterial3d(now.clone()));
    }
    in_view
}

/// Writes the counts.
fn tell(
    in_view: In<usize>,
    settings: Res<CascaSettings>,
    store: Res<DiagnosticsStore>,
    eye: Single<(Entity, &VisibleEntities), With<Eye>>,
    suns: Query<&CascadesVisibleEntities>,
    things: Query<(), With<Part>>,
    mut words: Single<&mut Text, With<Words>>,
    mut window: Option<Single<&mut Window>>,
) {
    let time = |path: &DiagnosticPath| store.get(path).and_then(|d| d.smoothed()).unwrap_or_default();
    let (camera, visible) = *eye;
    let drawn = visible.get(TypeId::of::<Mesh3d>()).len();
    let cascades = suns.iter().filter_map(|sun| sun.entities.get(&camera)).flatten();
    let who = if settings.enabled { "casca culls" } else { "Bevy culls, casca is off" };
    let (ours, all) = (time(&CascaDiagnostics::TIME), time(&FrameTimeDiagnosticsPlugin::FRAME_TIME));
    // Pictures are drawn as fast as it comes.
    let took = window.as_ref().map(|_| format!("visibility {ours:.1} ms, frame {all:.1} ms\n"));
    let took = took.unwrap_or_default();
    // Pages give the title to screen readers.
    let title = format!("{TITLE}: {who}, {drawn} of {} things in view are drawn", in_view.0);
    if let Some(window) = &mut window
        && window.title != title
    {
        window.title = title;
    }
    words.0 = format!(
        "{who}\n{} things, {} in view\n{drawn} drawn, {} hidden\n{} draws in shadow maps\n\
         {took}\nF1 turns casca on and off\nB the view from above:\n\
         drawn (yellow), hidden (blue), out of view (grey)\n\
         W A S D Q E and the right mouse button fly, Space walks on",
        things.iter().len(),
        in_view.0,
        in_view.0.saturating_sub(drawn),
        cascades.map(|cascade| cascade.entities.len()).sum::<usize>(),
    );
}
