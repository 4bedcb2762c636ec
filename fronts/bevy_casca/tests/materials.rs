//! Materials that say what their entities hide, and diagnostics.

mod common;

use bevy_asset::{AsAssetId, Asset, AssetApp, AssetId, Assets, Handle};
use bevy_casca::{CascaDiagnostics, CascaScene, MaterialsPlugin, Opaque, Surface};
use bevy_diagnostic::DiagnosticsStore;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::TypePath;
use bevy_transform::components::Transform;
use common::{Nr, entity, headless, lists, settle, spawn_box, spawn_camera};

const CAMERA: u32 = 1_000_000;

/// A material, as far as the rule below asks.
#[derive(Asset, TypePath, Clone, Copy)]
struct Paint {
    alpha: f32,
    bias: f32,
}

#[derive(Component, Clone)]
struct Painted(Handle<Paint>);

impl AsAssetId for Painted {
    type Asset = Paint;

    fn as_asset_id(&self) -> AssetId<Paint> {
        self.0.id()
    }
}

fn rule(paint: &Paint) -> Surface {
    match paint {
        _ if paint.bias != 0.0 => Surface::InFront,
        _ if paint.alpha == 1.0 => Surface::Opaque(Opaque::Front),
        _ => Surface::Unknown,
    }
}

#[test]
fn a_material_decides_who_hides_and_who_is_never_hidden() {
    let mut app = headless(true);
    app.init_asset::<Paint>().add_plugins(MaterialsPlugin::<Painted>::new(rule));
    let world = app.world_mut();
    let mut add = |alpha, bias| world.resource_mut::<Assets<Paint>>().add(Paint { alpha, bias });
    let (wall, glass, in_front) = (add(1.0, 0.0), add(0.5, 0.0), add(1.0, 3.0));
    let entity_of_wall = spawn_box(world, 0, Vec3::ZERO, Vec3::new(30.0, 30.0, 1.0));
    world.entity_mut(entity_of_wall).insert(Painted(wall.clone()));
    for nr in 1..51 {
        let at = Vec3::new((nr % 10) as f32 - 4.5, (nr / 10) as f32 - 2.0, -10.0);
        let thing = spawn_box(world, nr, at, Vec3::splat(0.4));
        let paint = [&glass, &in_front][usize::from(nr < 6)];
        world.entity_mut(thing).insert(Painted(paint.clone()));
    }
    spawn_camera(world, CAMERA, Transform::from_xyz(0.0, 0.0, 20.0).looking_to(Vec3::NEG_Z, Vec3::Y));
    let seen = |app: &mut bevy_app::App| {
        app.update();
        lists(app)[&CAMERA].len()
    };
    settle(&mut app);
    assert_eq!(seen(&mut app), 6, "the wall, and five that are drawn in front of it");
    let measured = |app: &bevy_app::App, path| {
        app.world().resource::<DiagnosticsStore>().get(&path).and_then(|found| found.value()).unwrap()
    };
    assert_eq!(measured(&app, CascaDiagnostics::ENTITIES), 46.0);
    assert_eq!(measured(&app, CascaDiagnostics::VISIBLE), 1.0);
    assert_eq!(measured(&app, CascaDiagnostics::CULLED), 45.0);
    assert_eq!(measured(&app, CascaDiagnostics::OCCLUDERS), 1.0);
    assert_eq!(measured(&app, CascaDiagnostics::CASTERS), 0.0);
    assert!(measured(&app, CascaDiagnostics::TIME) > 0.0);

    let set_alpha = |app: &mut bevy_app::App, alpha| {
        let mut paints = app.world_mut().resource_mut::<Assets<Paint>>();
        paints.get_mut(&wall).unwrap().alpha = alpha;
    };
    set_alpha(&mut app, 0.5);
    assert_eq!(seen(&mut app), 51, "glass hides nothing, from the same frame on");
    set_alpha(&mut app, 1.0);
    assert_eq!(seen(&mut app), 6);
    // Another material in the same place.
    app.world_mut().get_mut::<Painted>(entity_of_wall).unwrap().0 = glass.clone();
    assert_eq!(seen(&mut app), 51);
    app.world_mut().get_mut::<Painted>(entity_of_wall).unwrap().0 = wall.clone();
    assert_eq!(seen(&mut app), 6);
    app.world_mut().entity_mut(entity_of_wall).remove::<Painted>();
    assert_eq!(seen(&mut app), 51);
    app.world_mut().entity_mut(entity_of_wall).insert(Painted(wall.clone()));
    assert_eq!(seen(&mut app), 6);
    app.world_mut().resource_mut::<Assets<Paint>>().remove(&wall);
    assert_eq!(seen(&mut app), 51, "without its material it is not drawn");
    // No longer drawn in front.
    app.world_mut().entity_mut(entity_of_wall).insert(Opaque::Front);
    let thing = entity(app.world_mut(), 3);
    app.world_mut().get_mut::<Painted>(thing).unwrap().0 = glass;
    assert_eq!(seen(&mut app), 5);
    assert!(app.world().get::<Nr>(thing).is_some() && app.world().resource::<CascaScene>().unreadable() == 0);
}

/// As much of `bevy_pbr` as the rule for its material asks for.
mod pbr {
    use super::*;

    #[derive(Debug, Clone, Copy, PartialEq, Default)]
    pub enum AlphaMode {
        #[default]
        Opaque,
        Mask(f32),
        Blend,
    }

    #[derive(Debug, Clone, Copy, PartialEq)]
    pub enum Face {
        Front,
        Back,
    }

    #[derive(Asset, TypePath, Clone, Copy)]
    pub struct StandardMaterial {
        pub alpha_mode: AlphaMode,
        pub cull_mode: Option<Face>,
        pub depth_bias: f32,
        pub specular_transmission: f32,
    }

    impl Default for StandardMaterial {
        fn default() -> Self {
            Self {
                alpha_mode: AlphaMode::Opaque,
                cull_mode: Some(Face::Back),
                depth_bias: 0.0,
                specular_transmission: 0.0,
            }
        }
    }

    #[derive(Component, Clone)]
    pub struct MeshMaterial3d<M: Asset>(pub Handle<M>);

    impl<M: Asset> AsAssetId for MeshMaterial3d<M> {
        type Asset = M;

        fn as_asset_id(&self) -> AssetId<M> {
            self.0.id()
        }
    }
}

#[test]
fn standard_materials_hide_if_they_are_opaque_from_the_sides_that_are_drawn() {
    use pbr::{AlphaMode, Face, MeshMaterial3d, StandardMaterial};
    let plain = StandardMaterial::default();
    // What a camera sees of a wall and of what is behind it, from outside and from within the wall.
    let table = [
        (plain, [1, 2]),
        (StandardMaterial { cull_mode: None, ..plain }, [1, 1]),
        (StandardMaterial { cull_mode: Some(Face::Front), ..plain }, [2, 2]),
        (StandardMaterial { alpha_mode: AlphaMode::Blend, ..plain }, [2, 2]),
        (StandardMaterial { alpha_mode: AlphaMode::Mask(0.5), ..plain }, [2, 2]),
        (StandardMaterial { specular_transmission: 0.1, ..plain }, [2, 2]),
        (StandardMaterial { depth_bias: -1.0, ..plain }, [2, 2]),
    ];
    for (row, (material, expected)) in table.into_iter().enumerate() {
        for (z, expected) in [20.0, 0.0].into_iter().zip(expected) {
            let mut app = headless(true);
            app.init_asset::<StandardMaterial>().add_plugins(bevy_casca::standard_materials!(pbr));
            let world = app.world_mut();
            let material = world.resource_mut::<Assets<StandardMaterial>>().add(material);
            let wall = spawn_box(world, 0, Vec3::ZERO, Vec3::new(30.0, 30.0, 4.0));
            world.entity_mut(wall).insert(MeshMaterial3d(material));
            spawn_box(world, 1, Vec3::new(0.0, 0.0, -10.0), Vec3::splat(0.4));
            let eye = Transform::from_xyz(0.1, 0.1, z).looking_to(Vec3::NEG_Z, Vec3::Y);
            spawn_camera(world, CAMERA, eye);
            settle(&mut app);
            app.update();
            assert_eq!(lists(&mut app)[&CAMERA].len(), expected, "row {row}, from {z}");
        }
    }
}
