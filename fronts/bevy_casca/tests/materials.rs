//! Materials that say what their entities hide, and diagnostics.

mod common;

use bevy_diagnostic::DiagnosticsStore;
use common::*;

#[test]
fn a_material_decides_who_hides_and_who_is_never_hidden() {
    let mut app = headless(true);
    app.init_asset::<Paint>().add_plugins(MaterialsPlugin::<MeshMaterial3d<Paint>>::new(paint_rule));
    let world = app.world_mut();
    let mut add = |paint| world.resource_mut::<Assets<Paint>>().add(paint);
    let wall = add(Paint::default());
    let glass = add(Paint { glass: true, ..Paint::default() });
    let in_front = add(Paint { in_front: true, ..Paint::default() });
    let entity_of_wall = spawn_box(world, 0, Vec3::ZERO, Vec3::new(30.0, 30.0, 1.0));
    world.entity_mut(entity_of_wall).insert(MeshMaterial3d(wall.clone()));
    things_behind(world, 1);
    for nr in 1..51 {
        let paint = [&glass, &in_front][usize::from(nr < 6)];
        on(world, nr, |thing| done(thing.insert(MeshMaterial3d(paint.clone()))));
    }
    let seen = |app: &mut App| {
        app.update();
        lists(app)[&CAMERA].len()
    };
    settle(&mut app);
    assert_eq!(seen(&mut app), 6, "the wall, and five that are drawn in front of it");
    let measured = |app: &App, path| {
        app.world().resource::<DiagnosticsStore>().get(&path).and_then(|found| found.value()).unwrap()
    };
    use CascaDiagnostics as Of;
    let counts = [Of::ENTITIES, Of::VISIBLE, Of::CULLED, Of::OCCLUDERS, Of::CASTERS];
    assert_eq!(counts.map(|path| measured(&app, path)), [46.0, 1.0, 45.0, 1.0, 0.0]);
    assert!(measured(&app, Of::TIME) > 0.0);

    let set_glass = |app: &mut App, glass| {
        let mut paints = app.world_mut().resource_mut::<Assets<Paint>>();
        paints.get_mut(&wall).unwrap().glass = glass;
    };
    set_glass(&mut app, true);
    assert_eq!(seen(&mut app), 51, "glass hides nothing, from the same frame on");
    assert_eq!(why_not(&mut app, 0), Some(WhyNot::NotOpaque));
    assert_eq!(why_not(&mut app, 3), Some(WhyNot::InFront));
    set_glass(&mut app, false);
    assert_eq!(seen(&mut app), 6);
    // Another material in the same place.
    app.world_mut().get_mut::<MeshMaterial3d<Paint>>(entity_of_wall).unwrap().0 = glass.clone();
    assert_eq!(seen(&mut app), 51);
    app.world_mut().get_mut::<MeshMaterial3d<Paint>>(entity_of_wall).unwrap().0 = wall.clone();
    assert_eq!(seen(&mut app), 6);
    app.world_mut().entity_mut(entity_of_wall).remove::<MeshMaterial3d<Paint>>();
    assert_eq!(seen(&mut app), 51);
    app.world_mut().entity_mut(entity_of_wall).insert(MeshMaterial3d(wall.clone()));
    assert_eq!(seen(&mut app), 6);
    app.world_mut().resource_mut::<Assets<Paint>>().remove(&wall);
    assert_eq!(seen(&mut app), 51, "without its material it is not drawn");
    assert_eq!(why_not(&mut app, 0), Some(WhyNot::NoMaterial));
    app.world_mut().entity_mut(entity_of_wall).insert(Opaque::Front);
    assert_eq!(seen(&mut app), 51, "whatever is told of it");
    app.world_mut().get_mut::<MeshMaterial3d<Paint>>(entity_of_wall).unwrap().0 = glass.clone();
    assert_eq!(seen(&mut app), 6, "it is told to be opaque");
    // No longer drawn in front.
    let thing = entity(app.world_mut(), 3);
    app.world_mut().get_mut::<MeshMaterial3d<Paint>>(thing).unwrap().0 = glass;
    assert_eq!(seen(&mut app), 5);
}

/// As much of `bevy_pbr` as the rule for its material asks for.
mod pbr {
    pub use super::common::MeshMaterial3d;
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

    #[derive(Debug, Clone, Copy, PartialEq, Default)]
    pub enum OpaqueRendererMethod {
        #[default]
        Forward,
        Deferred,
        Auto,
    }

    #[derive(Resource, Debug, Default)]
    #[expect(dead_code, reason = "its text is read")]
    pub struct DefaultOpaqueRendererMethod(OpaqueRendererMethod);

    impl DefaultOpaqueRendererMethod {
        pub fn deferred() -> Self {
            Self(OpaqueRendererMethod::Deferred)
        }
    }

    pub mod decal {
        use super::*;

        #[derive(Component)]
        pub struct ForwardDecal;

        #[derive(Asset, TypePath)]
        pub struct ForwardDecalMaterial<B: Asset>(pub std::marker::PhantomData<B>);
    }

    pub mod wireframe {
        use super::*;

        #[derive(Component)]
        pub struct Wireframe;

        #[derive(Component)]
        pub struct Mesh3dWireframe;
    }

    #[derive(Asset, TypePath, Clone)]
    pub struct StandardMaterial {
        pub alpha_mode: AlphaMode,
        pub cull_mode: Option<Face>,
        pub depth_bias: f32,
        pub specular_transmission: f32,
        pub opaque_render_method: OpaqueRendererMethod,
        #[dependency]
        pub base_color_texture: Option<Handle<Image>>,
    }

    impl Default for StandardMaterial {
        fn default() -> Self {
            Self {
                alpha_mode: AlphaMode::Opaque,
                cull_mode: Some(Face::Back),
                depth_bias: 0.0,
                specular_transmission: 0.0,
                opaque_render_method: OpaqueRendererMethod::Auto,
                base_color_texture: None,
            }
        }
    }
}

#[test]
fn standard_materials_hide_if_they_are_opaque_from_the_sides_that_are_drawn() {
    use pbr::{AlphaMode, Face, StandardMaterial};
    let plain = StandardMaterial::default;
    // What a camera sees of a wall and of what is behind it, from outside and from within the wall.
    let table = [
        (plain(), [1, 2]),
        (StandardMaterial { cull_mode: None, ..plain() }, [1, 1]),
        (StandardMaterial { cull_mode: Some(Face::Front), ..plain() }, [2, 2]),
        (StandardMaterial { alpha_mode: AlphaMode::Blend, ..plain() }, [2, 2]),
        (StandardMaterial { alpha_mode: AlphaMode::Mask(0.5), ..plain() }, [2, 2]),
        (StandardMaterial { specular_transmission: 0.1, ..plain() }, [2, 2]),
        (StandardMaterial { depth_bias: -1.0, ..plain() }, [2, 2]),
    ];
    for (row, (material, expected)) in table.into_iter().enumerate() {
        for (z, expected) in [20.0, 0.0].into_iter().zip(expected) {
            let mut app = walled(material.clone());
            let eye = Transform::from_xyz(0.1, 0.1, z).looking_to(Vec3::NEG_Z, Vec3::Y);
            on(app.world_mut(), CAMERA, |camera| done(camera.insert(eye)));
            app.update();
            assert_eq!(lists(&mut app)[&CAMERA].len(), expected, "row {row}, from {z}");
        }
    }
}

/// An app with a wall of a material, and a thing behind it.
fn walled(material: pbr::StandardMaterial) -> App {
    let mut app = headless(true);
    app.init_asset::<pbr::StandardMaterial>().register_type::<pbr::MeshMaterial3d<Paint>>();
    app.init_asset::<Paint>().init_asset::<pbr::decal::ForwardDecalMaterial<pbr::StandardMaterial>>();
    app.init_resource::<pbr::DefaultOpaqueRendererMethod>();
    app.add_plugins(bevy_casca::standard_materials!(pbr, DeferredPrepass));
    let world = app.world_mut();
    let material = world.resource_mut::<Assets<pbr::StandardMaterial>>().add(material);
    let wall = spawn_box(world, 0, Vec3::ZERO, Vec3::new(30.0, 30.0, 4.0));
    world.entity_mut(wall).insert(pbr::MeshMaterial3d(material));
    spawn_box(world, 1, Vec3::new(0.0, 0.0, -10.0), Vec3::splat(0.4));
    spawn_camera(world, CAMERA, Transform::from_xyz(0.1, 0.1, 20.0).looking_to(Vec3::NEG_Z, Vec3::Y));
    settle(&mut app);
    app
}

#[derive(Component)]
struct DeferredPrepass;

/// Whether the wall hides the thing behind it in the next frame.
fn hides(app: &mut App) -> bool {
    app.update();
    !lists(app)[&CAMERA].contains(&1)
}

#[test]
fn a_material_hides_when_the_renderer_has_what_it_needs() {
    let picture = |usage| Image { asset_usage: usage, ..Image::default() };
    let textured = |handle: &Handle<Image>| pbr::StandardMaterial {
        base_color_texture: Some(handle.clone()),
        ..Default::default()
    };
    // One that never comes, also with what says that it hides.
    let mut app = walled(Default::default());
    assert!(hides(&mut app));
    let handle = app.world().resource::<Assets<Image>>().reserve_handle();
    let set = |app: &mut App, material: pbr::StandardMaterial| {
        let wall = entity(app.world_mut(), 0);
        let id = app.world().get::<pbr::MeshMaterial3d<pbr::StandardMaterial>>(wall).unwrap().0.id();
        let mut all = app.world_mut().resource_mut::<Assets<pbr::StandardMaterial>>();
        *all.get_mut(id).unwrap() = material;
    };
    set(&mut app, textured(&handle));
    let wall = entity(app.world_mut(), 0);
    for frame in 0..10 {
        assert!(!hides(&mut app), "frame {frame}");
        assert_eq!(why_not(&mut app, 0), Some(WhyNot::Textures));
        if frame == 5 {
            let cube = app.world().resource::<Cube>().0.clone();
            app.world_mut().entity_mut(wall).insert((Opaque::Both, Occluder(cube)));
        }
    }
    app.world_mut().entity_mut(wall).remove::<(Opaque, Occluder)>();
    // It comes, but not for the renderer.
    let insert = |app: &mut App, usage| {
        let mut images = app.world_mut().resource_mut::<Assets<Image>>();
        images.insert(&handle, picture(usage)).unwrap();
    };
    insert(&mut app, RenderAssetUsages::MAIN_WORLD);
    assert!(!hides(&mut app) && !hides(&mut app) && !hides(&mut app));
    insert(&mut app, RenderAssetUsages::RENDER_WORLD);
    assert!(!hides(&mut app), "the material may have been prepared before its picture");
    assert!(hides(&mut app));
    // A picture or a material that changes is drawn at once; another one has to come first.
    insert(&mut app, RenderAssetUsages::RENDER_WORLD);
    set(&mut app, textured(&handle));
    assert!(hides(&mut app));
    let other = app.world_mut().resource_mut::<Assets<Image>>().add(picture(RenderAssetUsages::default()));
    set(&mut app, textured(&other));
    assert!(!hides(&mut app));
    assert!(hides(&mut app));
    set(&mut app, textured(&handle));
    assert!(hides(&mut app));
    app.world_mut().resource_mut::<Assets<Image>>().remove(&handle);
    assert!(!hides(&mut app), "without its picture it is drawn no more once it changes");
}

#[test]
fn deferred_materials_hide_where_all_cameras_draw_them() {
    use pbr::{DefaultOpaqueRendererMethod, OpaqueRendererMethod, StandardMaterial};
    let by = |method| StandardMaterial { opaque_render_method: method, ..Default::default() };
    let camera = |app: &mut App| entity(app.world_mut(), CAMERA);
    let mut app = walled(by(OpaqueRendererMethod::Forward));
    app.insert_resource(DefaultOpaqueRendererMethod::deferred());
    assert!(hides(&mut app));
    let mut app = walled(by(OpaqueRendererMethod::Auto));
    assert!(hides(&mut app));
    app.insert_resource(DefaultOpaqueRendererMethod::deferred());
    assert!(!hides(&mut app));
    // What was prepared keeps its method.
    app.insert_resource(DefaultOpaqueRendererMethod::default());
    assert!(!hides(&mut app));
    let id = camera(&mut app);
    app.world_mut().entity_mut(id).insert(DeferredPrepass);
    assert!(hides(&mut app));

    let mut app = walled(by(OpaqueRendererMethod::Deferred));
    assert!(!hides(&mut app) && !hides(&mut app));
    let id = camera(&mut app);
    app.world_mut().entity_mut(id).insert(DeferredPrepass);
    settle(&mut app);
    assert!(hides(&mut app));
    spawn_camera(app.world_mut(), CAMERA + 1, Transform::default());
    assert!(!hides(&mut app), "a camera does not draw it");
    assert_eq!(why_not(&mut app, 0), Some(WhyNot::Deferred));
    let other = entity(app.world_mut(), CAMERA + 1);
    app.world_mut().entity_mut(other).insert(RenderLayers::layer(3));
    assert!(hides(&mut app), "it looks at other things");
    app.world_mut().entity_mut(id).remove::<DeferredPrepass>();
    assert!(!hides(&mut app));
}

#[test]
fn what_is_drawn_through_walls_is_never_hidden() {
    use pbr::{MeshMaterial3d, StandardMaterial, decal, wireframe};
    type Change = fn(&mut EntityWorldMut);
    type Decal = decal::ForwardDecalMaterial<StandardMaterial>;
    let mut app = walled(StandardMaterial::default());
    assert!(hides(&mut app));
    let thing = entity(app.world_mut(), 1);
    fn without<C: Component>(thing: &mut EntityWorldMut) {
        thing.remove::<C>();
    }
    let cases: [(Change, Change); 6] = [
        (|thing| done(thing.insert(decal::ForwardDecal)), without::<decal::ForwardDecal>),
        (|thing| done(thing.insert(wireframe::Wireframe)), without::<wireframe::Wireframe>),
        (|thing| done(thing.insert(wireframe::Mesh3dWireframe)), without::<wireframe::Mesh3dWireframe>),
        // While it is disabled nobody sees what it becomes.
        (
            |thing| done(thing.insert((Disabled, decal::ForwardDecal)).remove::<Disabled>()),
            without::<decal::ForwardDecal>,
        ),
        // A material for which there is no rule, unless the thing says by itself what it is.
        (
            |thing| done(thing.insert(MeshMaterial3d::<Paint>(Handle::default()))),
            |thing| done(thing.insert(Opaque::Front)),
        ),
        (
            |thing| done(thing.insert(MeshMaterial3d::<Decal>(Handle::default()))),
            without::<MeshMaterial3d<Decal>>,
        ),
    ];
    for (nr, (put, take)) in cases.into_iter().enumerate() {
        put(&mut app.world_mut().entity_mut(thing));
        assert!(!hides(&mut app) && !hides(&mut app), "case {nr}");
        let why = if nr == 4 { WhyNot::NoRule } else { WhyNot::InFront };
        assert!(nr == 5 || why_not(&mut app, 1) == Some(why), "case {nr}");
        take(&mut app.world_mut().entity_mut(thing));
        assert!(hides(&mut app) || hides(&mut app), "case {nr}");
    }
}
