//! A town of any size, the one of the example `headless` with materials: one thing in twenty walks.

#[path = "../../examples/town/layout.rs"]
mod layout;

use bevy::camera::visibility::RenderLayers;
use bevy::light::CascadeShadowConfigBuilder;
use bevy::prelude::*;
pub use layout::Part;
use layout::dice;

/// The seconds in which the camera walks down its street, and back.
const ROUND: f32 = 40.0;

/// Something that goes to and fro.
#[derive(Component)]
pub struct Moves {
    pub rest: Vec3,
    pub by: Vec3,
    pub rate: f32,
}

impl Moves {
    /// Where it is at a time, in seconds.
    pub fn at(&self, time: f32) -> Vec3 {
        self.rest + self.by * (time * self.rate).sin()
    }
}

/// Spawns so many things, and a sun with shadows.
pub fn fill(world: &mut World, size: usize) {
    sun(world);
    things(world, size).into_iter().for_each(|thing| thing.spawn(world));
}

/// A thing that is not there yet.
pub struct Coming {
    parts: (Part, Mesh3d, MeshMaterial3d<StandardMaterial>, Transform),
    moves: Option<Moves>,
}

impl Coming {
    pub fn spawn(self, world: &mut World) {
        let mut thing = world.spawn(self.parts);
        self.moves.into_iter().for_each(|moves| _ = thing.insert(moves));
    }
}

/// So many things.
pub fn things(world: &mut World, size: usize) -> Vec<Coming> {
    let cube = world.resource_mut::<Assets<Mesh>>().add(Cuboid::new(1.0, 1.0, 1.0));
    let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
    let mut paint =
        |color| materials.add(StandardMaterial { base_color: color, perceptual_roughness: 0.9, ..default() });
    let ground = paint(Color::srgb(0.32, 0.34, 0.33));
    let walls: Vec<_> =
        (0..12).map(|i| paint(Color::hsl(15.0 + 5.0 * i as f32, 0.35, 0.45 + 0.3 * dice(i)))).collect();
    let colors: Vec<_> = (0..12).map(|i| paint(Color::hsl(30.0 * i as f32, 0.65, 0.5))).collect();
    let thing = |(part, i, middle, size): (Part, usize, Vec3, Vec3)| {
        let material = match part {
            Part::Ground => &ground,
            Part::House => &walls[i % walls.len()],
            Part::Thing => &colors[i % colors.len()],
        };
        let at = Transform::from_translation(middle).with_scale(size);
        let angle = dice(i) * 6.3;
        let by = Vec3::new(angle.cos(), 0.0, angle.sin()) * 2.5;
        let walks = part == Part::Thing && i.is_multiple_of(20);
        let moves = walks.then_some(Moves { rest: middle, by, rate: 0.5 });
        let parts = (part, Mesh3d(cube.clone()), MeshMaterial3d(material.clone()), at);
        Coming { parts, moves }
    };
    layout::boxes(size).map(thing).collect()
}

/// Spawns a sun with shadows.
pub fn sun(world: &mut World) {
    let sun = DirectionalLight { illuminance: 8_000.0, shadow_maps_enabled: true, ..default() };
    let down = Transform::default().looking_to(Vec3::new(0.3, -1.0, -0.5), Vec3::Y);
    let cascades = CascadeShadowConfigBuilder::default().build();
    world.spawn((sun, cascades, down, RenderLayers::layer(0)));
}

/// Where the camera is at a time: it walks along a street and back.
pub fn street(time: f32) -> Transform {
    layout::street(0.5 - 0.5 * (time * std::f32::consts::TAU / ROUND).cos())
}
