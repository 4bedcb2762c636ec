//! Furry animals on the ground, behind walls, under a sun with shadows and a lamp.

use bevy::light::{CascadeShadowConfigBuilder, DirectionalLightShadowMap};
use bevy::prelude::*;
use bevy_casca::CascaSettings;
use bevy_casca_fur::{FurExtension, FurMaterial, FurSettings, Furry, fur_material};
use casca_fur::scenes::animals::Animal;
use casca_fur::strands::Fur;

use crate::fur::{furry, mesh_of};
use crate::rendered::Rendered;

/// The seeds of the kinds of animals.
const KINDS: [u64; 3] = [3, 4, 5];

/// Cells along an animal.
const DETAIL: u32 = 24;

/// Layers of its fur at most: pictures by a software adapter take long.
const LAYERS: u32 = 4;

/// Frames before the first picture, until all pipelines and lists of lights are there.
const WARM_UP: u32 = 2;

/// One kind of animals: from its feet to the origin of its mesh, and what all of it have.
type Kind = (f32, (Mesh3d, MeshMaterial3d<StandardMaterial>, Furry));

/// Where animals and walls are, and the eyes that look at them.
pub struct Herd {
    /// Their kinds and places.
    pub animals: Vec<(usize, Transform)>,
    walls: Vec<(Vec3, Vec3)>,
    /// The eyes.
    pub eyes: Vec<Transform>,
}

impl Herd {
    /// Rows of animals, with walls between them.
    pub fn behind_walls() -> Self {
        let place = |i: usize| {
            let (row, column) = (i / 6, i % 6);
            let at = Vec3::new(1.3 * column as f32 - 3.2, 0.0, -1.6 * row as f32);
            Transform::from_translation(at).with_rotation(Quat::from_rotation_y(1.7 * i as f32))
        };
        let wall = |x: f32, z: f32, wide: f32| (Vec3::new(x, 0.6, z), Vec3::new(wide, 1.2, 0.1));
        let walls =
            vec![wall(-2.0, -0.8, 4.2), wall(2.6, -2.4, 3.8), wall(-1.0, -4.0, 6.0), wall(1.6, -0.8, 0.7)];
        let eye = |x: f32, y: f32, z: f32, to: Vec3| Transform::from_xyz(x, y, z).looking_at(to, Vec3::Y);
        let eyes = vec![
            eye(0.0, 0.5, 2.4, Vec3::new(0.0, 0.3, -3.0)),
            eye(-3.2, 0.4, 1.2, Vec3::new(1.0, 0.2, -4.0)),
        ];
        Self { animals: (0..24).map(|i| (i % KINDS.len(), place(i))).collect(), walls, eyes }
    }

    /// An app with the herd, ready for pictures.
    pub fn app(&self, settings: Option<CascaSettings>) -> Result<Rendered, String> {
        let mut rendered = furry(settings, |world| self.fill(world), self.eyes[0])?;
        rendered.prepare(WARM_UP);
        Ok(rendered)
    }

    fn fill(&self, world: &mut World) {
        let kinds = KINDS.map(|seed| kind(world, seed));
        for (number, place) in &self.animals {
            let Some((high, animal)) = kinds[*number].clone() else { continue };
            world.spawn((animal, Transform::from_xyz(0.0, high, 0.0) * *place));
        }
        let cube = world.resource_mut::<Assets<Mesh>>().add(Cuboid::new(1.0, 1.0, 1.0));
        let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
        let mut matt = |r, g, b| {
            let base_color = Color::linear_rgb(r, g, b);
            materials.add(StandardMaterial { base_color, perceptual_roughness: 0.95, ..default() })
        };
        let (ground, brick) = (matt(0.2, 0.24, 0.1), matt(0.4, 0.2, 0.13));
        let flat = Transform::from_xyz(0.0, -0.05, 0.0).with_scale(Vec3::new(60.0, 0.1, 60.0));
        world.spawn((Mesh3d(cube.clone()), MeshMaterial3d(ground), flat));
        for &(middle, size) in &self.walls {
            let place = Transform::from_translation(middle).with_scale(size);
            world.spawn((Mesh3d(cube.clone()), MeshMaterial3d(brick.clone()), place));
        }
        world.insert_resource(FurSettings { most_layers: LAYERS, ..default() });
        world.insert_resource(DirectionalLightShadowMap { size: 1024 });
        world.insert_resource(ClearColor(Color::linear_rgb(0.58, 0.71, 0.86)));
        let sun = DirectionalLight { illuminance: 6_500.0, shadow_maps_enabled: true, ..default() };
        let cascades =
            CascadeShadowConfigBuilder { num_cascades: 1, maximum_distance: 9.0, ..default() }.build();
        world.spawn((sun, cascades, Transform::default().looking_to(Vec3::new(-0.6, -1.0, -0.5), Vec3::Y)));
        let lamp = PointLight { intensity: 20_000.0, range: 8.0, ..default() };
        world.spawn((lamp, Transform::from_xyz(1.0, 1.8, -1.6)));
        world.insert_resource(GlobalAmbientLight { brightness: 500.0, ..default() });
    }
}

/// Makes a kind of animals.
fn kind(world: &mut World, seed: u64) -> Option<Kind> {
    let animal = Animal::new(seed, DETAIL).ok()?;
    let own = animal.levels().first()?;
    let fur = Fur::for_radius(animal.radius(), 0.07, 0.35).ok()?;
    let bend = casca_fur::glam::Vec3::new(0.0, -0.6, 0.0);
    let plain = StandardMaterial { perceptual_roughness: 0.8, ..default() };
    let skin = StandardMaterial { base_color: Color::linear_rgb(0.3, 0.3, 0.3), ..plain.clone() };
    let fur = fur_material(plain, FurExtension::new(Fur { bend, ..fur }));
    let mesh = Mesh3d(world.resource_mut::<Assets<Mesh>>().add(mesh_of(own)));
    let skin = MeshMaterial3d(world.resource_mut::<Assets<StandardMaterial>>().add(skin));
    let fur = Furry(world.resource_mut::<Assets<FurMaterial>>().add(fur));
    Some((-animal.aabb().min.y, (mesh, skin, fur)))
}
