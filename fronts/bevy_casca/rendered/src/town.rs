//! A town of any size, the one of the example `headless` with materials: one house to twenty things
//! that stand around, and one thing in twenty walks.

use bevy::camera::visibility::RenderLayers;
use bevy::light::CascadeShadowConfigBuilder;
use bevy::prelude::*;

/// From the middle of a house to that of the next one, in metres.
const PITCH: f32 = 24.0;

/// The side of a house.
const HOUSE: f32 = 16.0;

/// The seconds in which the camera walks down its street, and back.
const ROUND: f32 = 40.0;

/// A thing of the town: all of them, the ground too.
#[derive(Component)]
pub struct Thing;

/// The ground, a thing of the town.
#[derive(Component)]
pub struct Ground;

/// A thing that walks about where it stands.
#[derive(Component)]
pub struct Walker {
    home: Vec3,
    phase: f32,
}

impl Walker {
    /// Where it is at a time, in seconds.
    pub fn at(&self, time: f32) -> Vec3 {
        let angle = self.phase + time * 0.7;
        self.home + Vec3::new(angle.sin(), 0.0, (angle * 0.63).cos()) * 1.5
    }
}

/// Numbers that look like chance.
fn dice(n: usize) -> f32 {
    let x = (n as u32).wrapping_mul(0x9e37_79b9).rotate_left(13).wrapping_mul(0x85eb_ca6b);
    ((x ^ x >> 15).wrapping_mul(0xc2b2_ae35) >> 8) as f32 / (1 << 24) as f32
}

/// Spawns so many things, and a sun with shadows.
pub fn fill(world: &mut World, size: usize) {
    let cube = world.resource_mut::<Assets<Mesh>>().add(Cuboid::new(1.0, 1.0, 1.0));
    let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
    let mut paint =
        |color| materials.add(StandardMaterial { base_color: color, perceptual_roughness: 0.9, ..default() });
    let ground = paint(Color::srgb(0.32, 0.34, 0.33));
    let walls: Vec<_> =
        (0..12).map(|i| paint(Color::hsl(15.0 + 5.0 * i as f32, 0.35, 0.45 + 0.3 * dice(i)))).collect();
    let things: Vec<_> = (0..12).map(|i| paint(Color::hsl(30.0 * i as f32, 0.65, 0.5))).collect();
    let mut put = |material: &Handle<StandardMaterial>, middle: Vec3, size: Vec3| {
        let at = Transform::from_translation(middle).with_scale(size);
        world.spawn((Thing, Mesh3d(cube.clone()), MeshMaterial3d(material.clone()), at)).id()
    };
    let row = ((size / 20) as f32).sqrt().ceil() as usize;
    let side = row as f32 * PITCH;
    let ground = put(&ground, Vec3::new(0.0, -0.5, 0.0), Vec3::new(side + 50.0, 1.0, side + 50.0));
    let houses = row * row;
    for i in 0..houses {
        let height = 8.0 + 30.0 * dice(i);
        let (x, z) = ((i % row) as f32 * PITCH - side / 2.0, (i / row) as f32 * PITCH - side / 2.0);
        put(&walls[i % walls.len()], Vec3::new(x, height / 2.0, z), Vec3::new(HOUSE, height, HOUSE));
    }
    let mut walkers = Vec::new();
    for i in houses + 1..size {
        let home = Vec3::new((dice(i) - 0.5) * side, 0.9, (dice(i + 77_777) - 0.5) * side);
        let thing = put(&things[i % things.len()], home, Vec3::new(0.6, 1.8, 0.4));
        if i.is_multiple_of(20) {
            walkers.push((thing, Walker { home, phase: dice(i) * 6.3 }));
        }
    }
    world.entity_mut(ground).insert(Ground);
    for (thing, walker) in walkers {
        world.entity_mut(thing).insert(walker);
    }
    let sun = DirectionalLight { illuminance: 8_000.0, shadow_maps_enabled: true, ..default() };
    let down = Transform::default().looking_to(Vec3::new(0.3, -1.0, -0.5), Vec3::Y);
    let cascades = CascadeShadowConfigBuilder::default().build();
    world.spawn((sun, cascades, down, RenderLayers::layer(0)));
}

/// Where the camera is at a time: it walks along a street and looks around.
pub fn street(time: f32) -> Transform {
    let t = 0.5 - 0.5 * (time * std::f32::consts::TAU / ROUND).cos();
    let at = Vec3::new(-PITCH / 2.0, 1.7, 20.0 - 20.0 * t);
    Transform::from_translation(at).looking_to(Vec3::new((3.0 * t).sin(), 0.0, -(3.0 * t).cos()), Vec3::Y)
}
