//! Materials that say what their entities hide, and diagnostics.

mod common;

use bevy_diagnostic::DiagnosticsStore;
use common::*;

#[test]
fn a_material_decides_who_hides_and_who_is_never_hidden() {
    let mut app = painted();
    let world = app.world_mut();
    let mut add = |paint| world.resource_mut::<Assets<Paint>>().add(paint);
    let wall = add(Paint::default());
    let glass = add(Paint { alpha_mode: "blend", ..Paint::default() });
    let in_front = add(Paint { depth_bias: 1.0, ..Paint::default() });
    fn paint(world: &mut World, nr: u32, paint: &Handle<Paint>) {
        on(world, nr, |thing| done(thing.insert(MeshMaterial3d(paint.clone()))));
    }
    spawn_box(world, 0, Vec3::ZERO, Vec3::new(30.0, 30.0, 1.0));
    things_behind(world, 1);
    paint(world, 0, &wall);
    (1..51).for_each(|nr| paint(world, nr, if nr < 6 { &in_front } else { &glass }));
    settle(&mut app);
    let measured = |app: &App, path| {
        app.world().resource::<DiagnosticsStore>().get(&path).and_then(|found| found.value()).unwrap()
    };
    use CascaDiagnostics as Of;
    let counts = [Of::ENTITIES, Of::VISIBLE, Of::CULLED, Of::OCCLUDERS, Of::CASTERS];
    assert_eq!(counts.map(|path| measured(&app, path)), [46.0, 1.0, 45.0, 1.0, 0.0]);
    assert!(measured(&app, Of::TIME) > 0.0);

    let turn = |world: &mut World, alpha_mode| {
        world.resource_mut::<Assets<Paint>>().get_mut(&wall).unwrap().alpha_mode = alpha_mode;
    };
    let bare = |world: &mut World| on(world, 0, |wall| done(wall.remove::<MeshMaterial3d<Paint>>()));
    let lose = |world: &mut World| _ = world.resource_mut::<Assets<Paint>>().remove(&wall);
    // What changes, how many are seen from the same frame on, and why the wall hides nothing.
    type Step<'a> = (&'a dyn Fn(&mut World), usize, Option<WhyNot>);
    let steps: [Step; 12] = [
        // The wall, and five that are drawn in front of it.
        (&|_| {}, 6, None),
        (&|world| turn(world, "blend"), 51, Some(WhyNot::NotOpaque)),
        (&|world| turn(world, "opaque"), 6, None),
        (&|world| paint(world, 0, &glass), 51, Some(WhyNot::NotOpaque)),
        (&|world| paint(world, 0, &wall), 6, None),
        (&bare, 51, Some(WhyNot::NoMaterial)),
        (&|world| paint(world, 0, &wall), 6, None),
        // Without its material it is not drawn, whatever is told of it.
        (&lose, 51, Some(WhyNot::NoMaterial)),
        (&|world| on(world, 0, |wall| done(wall.insert(Opaque::Front))), 51, Some(WhyNot::NoMaterial)),
        (&|world| paint(world, 0, &glass), 6, None),
        (&|world| paint(world, 0, &in_front), 51, Some(WhyNot::InFront)),
        // No longer drawn in front.
        (&|world| [0, 3].iter().for_each(|nr| paint(world, *nr, &glass)), 5, None),
    ];
    for (nr, (change, seen, why)) in steps.into_iter().enumerate() {
        change(app.world_mut());
        app.update();
        assert_eq!(lists(&mut app)[&CAMERA].len(), seen, "step {nr}");
        assert_eq!(why_not(&mut app, 0), why, "step {nr}");
        assert_eq!(why_not(&mut app, 5), Some(WhyNot::InFront));
    }
}

#[test]
fn standard_materials_hide_if_they_are_opaque_from_the_sides_that_are_drawn() {
    let plain = Paint::default;
    // What a camera sees of a wall and of what is behind it, from outside and from within the wall.
    let table = [
        (plain(), [1, 2]),
        (Paint { cull_mode: None, ..plain() }, [1, 1]),
        (Paint { cull_mode: Some("front"), ..plain() }, [2, 2]),
        (Paint { alpha_mode: "blend", ..plain() }, [2, 2]),
        (Paint { alpha_mode: "mask", ..plain() }, [2, 2]),
        (Paint { specular_transmission: 0.1, ..plain() }, [2, 2]),
        (Paint { depth_bias: -1.0, ..plain() }, [2, 2]),
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
fn walled(material: Paint) -> App {
    let mut app = painted();
    let world = app.world_mut();
    let material = world.resource_mut::<Assets<Paint>>().add(material);
    let wall = spawn_box(world, 0, Vec3::ZERO, Vec3::new(30.0, 30.0, 4.0));
    world.entity_mut(wall).insert(MeshMaterial3d(material));
    spawn_box(world, 1, Vec3::new(0.0, 0.0, -10.0), Vec3::splat(0.4));
    spawn_camera(world, CAMERA, Transform::from_xyz(0.1, 0.1, 20.0).looking_to(Vec3::NEG_Z, Vec3::Y));
    settle(&mut app);
    app
}

/// Whether the wall hides the thing behind it in the next frame.
fn hides(app: &mut App) -> bool {
    app.update();
    !lists(app)[&CAMERA].contains(&1)
}

#[test]
fn a_material_hides_when_the_renderer_has_what_it_needs() {
    let picture = |usage| Image { asset_usage: usage, ..Image::default() };
    // One that never comes, also with what says that it hides.
    let mut app = walled(Default::default());
    assert!(hides(&mut app));
    let handle = app.world().resource::<Assets<Image>>().reserve_handle();
    let set = |app: &mut App, picture: &Handle<Image>| {
        let mut all = app.world_mut().resource_mut::<Assets<Paint>>();
        all.iter_mut().for_each(|(_, paint)| paint.base_color_texture = Some(picture.clone()));
    };
    set(&mut app, &handle);
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
    set(&mut app, &handle);
    assert!(hides(&mut app));
    let other = app.world_mut().resource_mut::<Assets<Image>>().add(picture(RenderAssetUsages::default()));
    set(&mut app, &other);
    assert!(!hides(&mut app));
    assert!(hides(&mut app));
    set(&mut app, &handle);
    assert!(hides(&mut app));
    app.world_mut().resource_mut::<Assets<Image>>().remove(&handle);
    assert!(!hides(&mut app), "without its picture it is drawn no more once it changes");
}

#[test]
fn deferred_materials_hide_where_all_cameras_draw_them() {
    use pbr::{DefaultOpaqueRendererMethod, OpaqueRendererMethod};
    let by = |opaque_render_method| walled(Paint { opaque_render_method, ..Default::default() });
    let with = |app: &mut App| on(app.world_mut(), CAMERA, |eye| done(eye.insert(DeferredPrepass)));
    let mut app = by(OpaqueRendererMethod::Forward);
    app.insert_resource(DefaultOpaqueRendererMethod::deferred());
    assert!(hides(&mut app));
    let mut app = by(OpaqueRendererMethod::Auto);
    assert!(hides(&mut app));
    app.insert_resource(DefaultOpaqueRendererMethod::deferred());
    assert!(!hides(&mut app));
    // What was prepared keeps its method.
    app.insert_resource(DefaultOpaqueRendererMethod::default());
    assert!(!hides(&mut app));
    with(&mut app);
    assert!(hides(&mut app));

    let mut app = by(OpaqueRendererMethod::Deferred);
    assert!(!hides(&mut app) && !hides(&mut app));
    with(&mut app);
    settle(&mut app);
    assert!(hides(&mut app));
    spawn_camera(app.world_mut(), CAMERA + 1, Transform::default());
    assert!(!hides(&mut app), "a camera does not draw it");
    assert_eq!(why_not(&mut app, 0), Some(WhyNot::Deferred));
    on(app.world_mut(), CAMERA + 1, |other| done(other.insert(RenderLayers::layer(3))));
    assert!(hides(&mut app), "it looks at other things");
    on(app.world_mut(), CAMERA, |camera| done(camera.remove::<DeferredPrepass>()));
    assert!(!hides(&mut app));
}

#[test]
fn what_is_drawn_through_walls_is_never_hidden() {
    use pbr::{decal, wireframe};
    type Change = fn(&mut EntityWorldMut);
    type Decal = decal::ForwardDecalMaterial<Paint>;
    fn with<C: Component + Default>(thing: &mut EntityWorldMut) {
        thing.insert(C::default());
    }
    fn without<C: Component>(thing: &mut EntityWorldMut) {
        thing.remove::<C>();
    }
    fn asleep(thing: &mut EntityWorldMut) {
        thing.insert((Disabled, decal::ForwardDecal)).remove::<Disabled>();
    }
    let mut app = walled(Paint::default());
    assert!(hides(&mut app));
    let cases: [(Change, Change); 6] = [
        (with::<decal::ForwardDecal>, without::<decal::ForwardDecal>),
        (with::<wireframe::Wireframe>, without::<wireframe::Wireframe>),
        (with::<wireframe::Mesh3dWireframe>, without::<wireframe::Mesh3dWireframe>),
        // While it is disabled nobody sees what it becomes.
        (asleep, without::<decal::ForwardDecal>),
        // A material for which there is no rule, unless the thing says by itself what it is.
        (with::<MeshMaterial3d<Image>>, |thing| done(thing.insert(Opaque::Front))),
        (with::<MeshMaterial3d<Decal>>, without::<MeshMaterial3d<Decal>>),
    ];
    for (nr, (put, take)) in cases.into_iter().enumerate() {
        on(app.world_mut(), 1, put);
        assert!(!hides(&mut app) && !hides(&mut app), "case {nr}");
        let why = if nr == 4 { WhyNot::NoRule } else { WhyNot::InFront };
        assert!(nr == 5 || why_not(&mut app, 1) == Some(why), "case {nr}");
        on(app.world_mut(), 1, take);
        assert!(hides(&mut app) || hides(&mut app), "case {nr}");
    }
}
