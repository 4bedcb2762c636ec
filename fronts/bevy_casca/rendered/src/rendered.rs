//! An app of Bevy's that renders into pictures, with or without the plugin.

use std::any::TypeId;
use std::path::Path;
use std::sync::mpsc::channel;

use bevy::app::PluginsState;
use bevy::asset::UnapprovedPathMode;
use bevy::camera::RenderTarget;
use bevy::camera::visibility::VisibleEntities;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::TextureFormat;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::window::ExitCondition;
use bevy_casca::{CascaPlugin, CascaScene, CascaSettings, standard_materials};
use casca_tools::image::write_png;

use crate::scenes::Scene;
use crate::town::Moves;

pub const WIDTH: u32 = 480;
pub const HEIGHT: u32 = 270;

/// Frames before the first picture. Bevy's first ones differ from run to run: it learns how much
/// memory its lists of lights need. The plugin prepares its meshes in them.
const WARM_UP: u32 = 40;

/// A picture is there after some frames, or never.
const MOST_UPDATES: u32 = 400;

/// An app that renders into pictures.
pub struct Rendered {
    pub app: App,
    target: Handle<Image>,
    camera: Entity,
}

impl Rendered {
    /// An app with a camera. `more` adds plugins, `fill` spawns the scene. The plugin is added if
    /// there are settings.
    pub fn with_plugins(
        settings: Option<CascaSettings>,
        more: impl FnOnce(&mut App),
        fill: impl FnOnce(&mut World),
        eye: Transform,
    ) -> Result<Self, String> {
        let mut app = App::new();
        let window =
            WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() };
        let render = RenderPlugin { synchronous_pipeline_compilation: true, ..default() };
        // Levels are made beside the program's own files.
        let files = AssetPlugin { unapproved_path_mode: UnapprovedPathMode::Allow, ..default() };
        let plugins = DefaultPlugins.set(window).set(render).set(files).disable::<LogPlugin>();
        #[cfg(feature = "window")]
        let plugins = plugins.disable::<bevy::winit::WinitPlugin>();
        // A frame is drawn before the next one begins.
        app.add_plugins(plugins.disable::<PipelinedRenderingPlugin>());
        if let Some(settings) = settings {
            app.add_plugins((CascaPlugin, standard_materials!(bevy::pbr)));
            app.insert_resource(settings);
        }
        more(&mut app);
        start(&mut app);
        let picture = Image::new_target_texture(WIDTH, HEIGHT, TextureFormat::Rgba8UnormSrgb, None);
        let target = app.world_mut().resource_mut::<Assets<Image>>().add(picture);
        fill(app.world_mut());
        let place = (RenderTarget::Image(target.clone().into()), eye);
        let camera = (Camera3d::default(), place, Msaa::Off, Tonemapping::Reinhard);
        let camera = app.world_mut().spawn(camera).id();
        Ok(Self { app, target, camera })
    }

    /// An app with a scene. Frames have been drawn until all meshes are prepared.
    pub fn new(scene: Scene, settings: Option<CascaSettings>) -> Result<Self, String> {
        let mut rendered = Self::with_plugins(settings, |_| (), |world| scene.fill(world), scene.eye(0.0))?;
        rendered.prepare(WARM_UP);
        Ok(rendered)
    }

    /// Draws so many frames, and more until all meshes are prepared.
    pub fn prepare(&mut self, frames: u32) {
        for frame in 0..MOST_UPDATES {
            self.app.update();
            if frame >= frames && !self.casca().is_some_and(CascaScene::is_preparing) {
                break;
            }
        }
    }

    /// Moves everything to where it is in a frame, and gives the picture of the first frame with it.
    pub fn picture(&mut self, scene: Scene, frame: u32) -> Result<Vec<u8>, String> {
        let time = frame as f32 * scene.step();
        let world = self.app.world_mut();
        let mut movers = world.query::<(&mut Transform, &Moves)>();
        movers.iter_mut(world).for_each(|(mut at, moves)| at.translation = moves.at(time));
        world.entity_mut(self.camera).insert(scene.eye(time));
        self.capture()
    }

    /// The lamps that shine.
    pub fn lamps(&mut self) -> usize {
        let world = self.app.world_mut();
        let mut lamps = world.query_filtered::<&ViewVisibility, Or<(With<PointLight>, With<SpotLight>)>>();
        lamps.iter(world).filter(|shines| shines.get()).count()
    }

    /// Moves the camera, and draws a frame.
    pub fn draw(&mut self, eye: Transform) {
        self.app.world_mut().entity_mut(self.camera).insert(eye);
        self.app.update();
    }

    /// The picture of the next frame: four bytes a pixel.
    pub fn capture(&mut self) -> Result<Vec<u8>, String> {
        capture(&mut self.app, &self.target)
    }

    /// The main world, and the camera in it.
    pub fn world_and_camera(&mut self) -> (&mut World, Entity) {
        (self.app.world_mut(), self.camera)
    }

    /// What the plugin made of the scene, if it is there.
    pub fn casca(&self) -> Option<&CascaScene> {
        self.app.world().get_resource()
    }

    /// The meshes in the list of the camera.
    pub fn drawn(&self) -> usize {
        let seen = self.app.world().get::<VisibleEntities>(self.camera);
        seen.map_or(0, |seen| seen.get(TypeId::of::<Mesh3d>()).len())
    }
}

/// Waits until all plugins of an app are ready.
pub fn start(app: &mut App) {
    while app.plugins_state() == PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();
}

/// The picture of the next frame: four bytes a pixel.
pub fn capture(app: &mut App, target: &Handle<Image>) -> Result<Vec<u8>, String> {
    let (send, receive) = channel();
    app.world_mut().spawn(Screenshot::image(target.clone())).observe(move |shot: On<ScreenshotCaptured>| {
        // Nobody waits any more if it comes too late.
        let _ = send.send(shot.image.data.clone());
    });
    for _ in 0..MOST_UPDATES {
        app.update();
        if let Ok(picture) = receive.try_recv() {
            return picture.ok_or("a picture without pixels".into());
        }
    }
    Err("no picture came".into())
}

/// Writes a PNG file into a folder, if there is one.
pub fn save(folder: Option<&Path>, name: &str, size: (u32, u32), pixels: &[u8]) -> Result<(), String> {
    let Some(folder) = folder else { return Ok(()) };
    std::fs::create_dir_all(folder).map_err(|why| why.to_string())?;
    write_png(&folder.join(name), size, pixels).map_err(|why| why.to_string())
}
