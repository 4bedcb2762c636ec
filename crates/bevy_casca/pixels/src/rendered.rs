//! An app of Bevy's that renders into pictures, with or without the plugin.

use std::any::TypeId;
use std::sync::mpsc::{Receiver, channel};

use bevy::app::PluginsState;
use bevy::camera::RenderTarget;
use bevy::camera::visibility::{
    CascadesVisibleEntities, CubemapVisibleEntities, VisibleEntities, VisibleMeshEntities,
};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::render_resource::TextureFormat;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::window::ExitCondition;
use bevy_casca::{CascaPlugin, CascaScene, CascaSettings, Shadows, standard_materials};

use crate::scenes::{Moves, Scene};

pub const WIDTH: u32 = 480;
pub const HEIGHT: u32 = 270;

/// Frames before the first picture. Bevy's first ones differ from run to run: it learns how much
/// memory its lists of lights need. The plugin prepares its meshes in them.
const WARM_UP: u32 = 40;

/// A picture is there after some frames, or never.
const MOST_UPDATES: u32 = 400;

pub struct Rendered {
    app: App,
    scene: Scene,
    target: Handle<Image>,
    camera: Entity,
}

impl Rendered {
    /// An app with a scene; with the plugin if shadows are given.
    pub fn new(scene: Scene, shadows: Option<Shadows>) -> Result<Self, String> {
        let mut app = App::new();
        let window =
            WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() };
        let render = RenderPlugin { synchronous_pipeline_compilation: true, ..default() };
        app.add_plugins(DefaultPlugins.set(window).set(render).disable::<LogPlugin>());
        if let Some(shadows) = shadows {
            app.add_plugins((CascaPlugin, standard_materials!(bevy::pbr)));
            app.insert_resource(CascaSettings { shadows, ..default() });
        }
        while app.plugins_state() == PluginsState::Adding {
            bevy::tasks::tick_global_task_pools_on_main_thread();
        }
        app.finish();
        app.cleanup();
        let picture = Image::new_target_texture(WIDTH, HEIGHT, TextureFormat::Rgba8UnormSrgb, None);
        let target = app.world_mut().resource_mut::<Assets<Image>>().add(picture);
        scene.fill(app.world_mut());
        let eye = (
            Camera3d::default(),
            RenderTarget::Image(target.clone().into()),
            Msaa::Off,
            Tonemapping::Reinhard,
        );
        let camera = app.world_mut().spawn((eye, scene.eye(0.0))).id();
        for _ in 0..WARM_UP {
            app.update();
        }
        Ok(Self { app, scene, target, camera })
    }

    /// Moves everything to where it is in a frame, and gives the picture of the first frame with it.
    pub fn picture(&mut self, frame: u32) -> Result<Vec<u8>, String> {
        let time = frame as f32 * self.scene.step();
        let world = self.app.world_mut();
        let mut movers = world.query::<(&mut Transform, &Moves)>();
        movers.iter_mut(world).for_each(|(mut at, moves)| at.translation = moves.at(time));
        if let Some(mut at) = world.get_mut::<Transform>(self.camera) {
            *at = self.scene.eye(time);
        }
        let picture = capture(world, &self.target);
        for _ in 0..MOST_UPDATES {
            self.app.update();
            if let Ok(picture) = picture.try_recv() {
                return picture.ok_or("a picture without pixels".into());
            }
        }
        Err("no picture came".into())
    }

    /// The meshes in the list of the camera.
    pub fn drawn(&mut self) -> usize {
        let seen = self.app.world().get::<VisibleEntities>(self.camera);
        seen.map_or(0, |seen| seen.get(TypeId::of::<Mesh3d>()).len())
    }

    /// The meshes in the shadow maps of all lights, each as often as it is drawn there.
    pub fn casters(&mut self) -> usize {
        let world = self.app.world_mut();
        let mut suns = world.query::<&CascadesVisibleEntities>();
        let cascades = suns.iter(world).flat_map(|sun| sun.entities.values().flatten());
        let mut count: usize = cascades.map(|cascade| cascade.entities.len()).sum();
        let mut bulbs = world.query::<&CubemapVisibleEntities>();
        count +=
            bulbs.iter(world).flat_map(|bulb| bulb.iter()).map(|face| face.entities.len()).sum::<usize>();
        let mut spots = world.query::<&VisibleMeshEntities>();
        count + spots.iter(world).map(|spot| spot.entities.len()).sum::<usize>()
    }

    /// The number of meshes that are prepared to hide others.
    pub fn occluders(&self) -> usize {
        self.app.world().get_resource::<CascaScene>().map_or(0, CascaScene::occluders)
    }
}

/// Asks for a picture of the next frame.
fn capture(world: &mut World, target: &Handle<Image>) -> Receiver<Option<Vec<u8>>> {
    let (send, receive) = channel();
    world.spawn(Screenshot::image(target.clone())).observe(move |shot: On<ScreenshotCaptured>| {
        // Nobody waits any more if it comes too late.
        let _ = send.send(shot.image.data.clone());
    });
    receive
}
