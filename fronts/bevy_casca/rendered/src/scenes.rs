//! Generated scenes, the same in each run: entities, their motion, and the way of the camera.

use bevy::prelude::*;
use bevy_casca::Occluder;
use casca_scenes::random::Dice;
use clap::ValueEnum;

use crate::town::{self, Moves};

/// A scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Scene {
    /// Streets between blocks, with things in them, a sun and lamps.
    City,
    /// Rooms in a row, with doors that open, and a lamp in each.
    House,
    /// The town of the window, with 2,000 things.
    Town,
}

impl Scene {
    pub const ALL: [Self; 3] = [Self::City, Self::House, Self::Town];

    /// The seconds from one picture to the next.
    pub fn step(self) -> f32 {
        match self {
            Self::City => 0.37,
            Self::House => 0.21,
            Self::Town => 0.29,
        }
    }

    /// Where the camera is at a time.
    pub fn eye(self, time: f32) -> Transform {
        let (at, to) = match self {
            Self::City => {
                let height = 1.7 + (time * 0.7).sin().max(0.0) * 14.0;
                let at = Vec3::new(time * 6.0 - 60.0, height, (time * 0.31).sin() * 1.2);
                let angle = (time * 0.4).sin() * 0.9;
                (at, Vec3::new(angle.cos(), -0.05, angle.sin()))
            }
            Self::House => {
                let at = Vec3::new(4.0 + 36.0 * (1.0 - (time * 0.2).cos()), 1.6, 0.3 * time.sin());
                (at, Vec3::new((time * 0.2).sin().signum(), 0.1 * time.sin(), 0.5 * (time * 1.3).sin()))
            }
            Self::Town => return town::street(time),
        };
        Transform::from_translation(at).looking_to(to, Vec3::Y)
    }

    /// Spawns all that is in the scene, but no camera.
    pub fn fill(self, world: &mut World) {
        match self {
            Self::City => city(&mut Set::new(world)),
            Self::House => house(&mut Set::new(world)),
            Self::Town => town::fill(world, 2000),
        }
    }
}

/// The world that a scene is spawned into, with meshes and materials.
struct Set<'a> {
    world: &'a mut World,
    dice: Dice,
    cube: Handle<Mesh>,
    ball: Handle<Mesh>,
    ring: Handle<Mesh>,
    colors: Vec<Handle<StandardMaterial>>,
    glass: Handle<StandardMaterial>,
}

impl<'a> Set<'a> {
    fn new(world: &'a mut World) -> Self {
        let mut dice = Dice::new(7, 0);
        let mut mesh = |mesh: Mesh| world.resource_mut::<Assets<Mesh>>().add(mesh);
        let cube = mesh(Cuboid::new(1.0, 1.0, 1.0).into());
        let ball = mesh(Sphere::new(0.5).mesh().uv(24, 12));
        let ring = mesh(Torus::new(0.3, 0.5).into());
        let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
        let mut tone = || dice.range(0.2, 1.0);
        let mut add = |base_color, material| materials.add(StandardMaterial { base_color, ..material });
        let dull = || StandardMaterial { perceptual_roughness: 0.8, ..default() };
        let colors = (0..16).map(|_| add(Color::srgb(tone(), tone(), tone()), dull())).collect();
        let clear = StandardMaterial { alpha_mode: AlphaMode::Blend, ..default() };
        let glass = add(Color::srgba(0.6, 0.8, 1.0, 0.3), clear);
        Self { world, dice, cube, ball, ring, colors, glass }
    }

    /// Spawns a mesh.
    fn put(&mut self, mesh: Handle<Mesh>, paint: Handle<StandardMaterial>, at: Vec3, size: Vec3) -> Entity {
        let place = Transform::from_translation(at).with_scale(size);
        self.world.spawn((Mesh3d(mesh), MeshMaterial3d(paint), place)).id()
    }

    /// Spawns a box of some color, from corner to corner.
    fn block(&mut self, color: usize, low: Vec3, high: Vec3) -> Entity {
        self.put(self.cube.clone(), self.colors[color % 16].clone(), (low + high) * 0.5, high - low)
    }

    /// Spawns a small thing: one in three is a ring.
    fn thing(&mut self, number: usize, at: Vec3) -> Entity {
        let mesh = if number.is_multiple_of(3) { self.ring.clone() } else { self.ball.clone() };
        let size = Vec3::splat(self.dice.range(0.3, 1.0));
        self.put(mesh, self.colors[15].clone(), at, size)
    }

    fn moves(&mut self, entity: Entity, rest: Vec3, by: Vec3) {
        let rate = self.dice.range(0.5, 2.0);
        self.world.entity_mut(entity).insert(Moves { rest, by, rate });
    }

    fn bulb(&mut self, at: Vec3, range: f32) {
        let light = PointLight { intensity: 400_000.0, range, shadow_maps_enabled: true, ..default() };
        self.world.spawn((light, Transform::from_translation(at)));
    }
}

/// Streets of 6 m between blocks of 10 m.
fn city(set: &mut Set) {
    set.block(0, Vec3::new(-150.0, -1.0, -150.0), Vec3::new(150.0, 0.0, 150.0));
    for (i, j) in (-8..8).flat_map(|i| (-8..8).map(move |j| (i, j))) {
        let middle = Vec3::new(i as f32 * 16.0 + 8.0, 0.0, j as f32 * 16.0 + 8.0);
        let half = Vec3::new(5.0, 0.0, 5.0);
        if set.dice.chance(0.85) {
            let height = set.dice.range(6.0, 24.0);
            let color = 1 + (set.dice.range(0.0, 14.0)) as usize;
            set.block(color, middle - half, middle + half + Vec3::Y * height);
            let window = middle + Vec3::new(5.1, 3.0, 0.0);
            set.put(set.cube.clone(), set.glass.clone(), window, Vec3::new(0.1, 2.0, 6.0));
        }
        for k in 0..8 {
            let dice = &mut set.dice;
            let side = Vec3::new(dice.range(5.6, 10.0), dice.range(0.3, 2.5), dice.range(-8.0, 8.0));
            let at = middle + if k % 2 == 0 { side } else { side.zyx() };
            let by = Vec3::new(dice.range(-3.0, 3.0), 0.2, dice.range(-3.0, 3.0));
            let thing = set.thing(k, at);
            if k == 5 {
                set.moves(thing, at, by);
            }
        }
    }
    let sun = DirectionalLight { illuminance: 6_000.0, shadow_maps_enabled: true, ..default() };
    set.world.spawn((sun, Transform::from_xyz(3.0, 6.0, 2.0).looking_at(Vec3::ZERO, Vec3::Y)));
    for x in [-40.0, 0.0, 32.0] {
        set.bulb(Vec3::new(x, 4.0, 0.5), 18.0);
        let spot = SpotLight { intensity: 900_000.0, range: 25.0, shadow_maps_enabled: true, ..default() };
        let at = Transform::from_xyz(x + 9.0, 7.0, -1.0);
        set.world.spawn((spot, at.looking_at(Vec3::new(x + 4.0, 0.0, 1.0), Vec3::Y)));
    }
}

/// Ten rooms of 8 m, with a door of 1.6 m between each two.
fn house(set: &mut Set) {
    let (rooms, size) = (10, 8.0);
    let end = rooms as f32 * size;
    set.block(0, Vec3::new(-0.2, -0.2, -4.0), Vec3::new(end, 0.0, 4.0));
    set.block(1, Vec3::new(-0.2, 3.0, -4.0), Vec3::new(end, 3.2, 4.0));
    for z in [-4.2, 4.0] {
        set.block(2, Vec3::new(-0.2, -0.2, z), Vec3::new(end, 3.2, z + 0.2));
    }
    for room in 0..=rooms {
        let x = room as f32 * size - 0.2;
        for (low, high) in [(-4.0, -0.8), (0.8, 4.0)] {
            set.block(3 + room, Vec3::new(x, 0.0, low), Vec3::new(x + 0.2, 3.0, high));
        }
        set.block(3 + room, Vec3::new(x, 2.2, -0.8), Vec3::new(x + 0.2, 3.0, 0.8));
        let door = set.block(14, Vec3::new(x + 0.02, 0.0, -0.8), Vec3::new(x + 0.18, 2.2, 0.8));
        // A door hides while it moves, too.
        let hider = Occluder(set.cube.clone());
        set.world.entity_mut(door).insert(hider);
        if room > 0 && room < rooms {
            set.moves(door, Vec3::new(x + 0.1, 1.1, 0.0), Vec3::Z * 1.5);
        }
    }
    for room in 0..rooms {
        for k in 0..40 {
            let dice = &mut set.dice;
            let at = Vec3::new(dice.range(0.5, 7.5), dice.range(0.2, 2.6), dice.range(-3.5, 3.5));
            let at = at + Vec3::X * room as f32 * size;
            // The way of the camera stays free.
            let at = if at.z.abs() < 1.2 { at.with_z(at.z + 1.8 * at.z.signum()) } else { at };
            let thing = set.thing(k, at);
            if k % 8 == 0 {
                set.moves(thing, at, Vec3::new(0.4, 0.1, 0.3));
            }
        }
        set.bulb(Vec3::new(room as f32 * size + 4.0, 2.7, 1.5), 12.0);
    }
}
