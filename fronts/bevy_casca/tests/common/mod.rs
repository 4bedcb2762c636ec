//! Apps without a window: one with casca and one with Bevy's own culling, in step.
#![allow(dead_code, unused_imports)]

pub use std::any::TypeId;
pub use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

pub use bevy_app::{App, PostUpdate, TaskPoolPlugin};
pub use bevy_asset::{AsAssetId, Asset, AssetApp, AssetId, AssetPlugin, Assets, Handle, RenderAssetUsages};
pub use bevy_camera::primitives::{Aabb, CUBE_MAP_FACES, Sphere};
pub use bevy_camera::visibility::*;
pub use bevy_camera::*;
pub use bevy_casca::casca::glam;
pub use bevy_casca::*;
pub use bevy_ecs::entity_disabling::Disabled;
pub use bevy_ecs::prelude::*;
pub use bevy_image::Image;
pub use bevy_light::cluster::ClusterVisibilityClass;
pub use bevy_light::*;
pub use bevy_math::{Affine3A, Mat4, Quat, UVec2, Vec2, Vec3};
pub use bevy_mesh::morph::MorphWeights;
pub use bevy_mesh::skinning::SkinnedMesh;
pub use bevy_mesh::{Indices, Mesh, Mesh3d, MeshPlugin, PrimitiveTopology};
pub use bevy_reflect::{Reflect, TypePath};
pub use bevy_shape::Cuboid;
use bevy_transform::TransformPlugin;
pub use bevy_transform::components::{GlobalTransform, Transform};
use casca_scenes::world::{self, Motion, Object, Shape};
use casca_truth::oracle::{Oracle, OracleOptions};

/// The number of the first camera.
pub const CAMERA: u32 = 1_000_000;

/// The number of an entity, the same in both apps.
#[derive(Component, Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Nr(pub u32);

/// Named as Bevy names its own.
#[derive(Component, Reflect, Clone, Default)]
#[reflect(Component)]
#[type_path = "bevy_pbr::mesh_material"]
pub struct MeshMaterial3d<M: Asset>(pub Handle<M>);

impl<M: Asset> AsAssetId for MeshMaterial3d<M> {
    type Asset = M;

    fn as_asset_id(&self) -> AssetId<M> {
        self.0.id()
    }
}

/// As much of `bevy_pbr` as the rule for its material asks for.
pub mod pbr {
    pub use super::MeshMaterial3d;
    use super::*;

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

        #[derive(Component, Default)]
        pub struct ForwardDecal;

        #[derive(Asset, TypePath, Default)]
        pub struct ForwardDecalMaterial<B: Asset>(pub std::marker::PhantomData<B>);
    }

    pub mod wireframe {
        use super::*;

        #[derive(Component, Default)]
        pub struct Wireframe;

        #[derive(Component, Default)]
        pub struct Mesh3dWireframe;
    }

    #[derive(Asset, TypePath, Clone)]
    pub struct StandardMaterial {
        pub alpha_mode: &'static str,
        pub cull_mode: Option<&'static str>,
        pub depth_bias: f32,
        pub specular_transmission: f32,
        pub opaque_render_method: OpaqueRendererMethod,
        #[dependency]
        pub base_color_texture: Option<Handle<Image>>,
    }

    impl Default for StandardMaterial {
        fn default() -> Self {
            Self {
                alpha_mode: "opaque",
                cull_mode: Some("back"),
                depth_bias: 0.0,
                specular_transmission: 0.0,
                opaque_render_method: OpaqueRendererMethod::Auto,
                base_color_texture: None,
            }
        }
    }
}

pub use pbr::StandardMaterial as Paint;

#[derive(Component)]
pub struct DeferredPrepass;

/// An app with materials.
pub fn painted() -> App {
    let mut app = headless(true);
    app.init_asset::<Paint>().init_asset::<pbr::decal::ForwardDecalMaterial<Paint>>();
    // There is no rule for this one.
    app.register_type::<MeshMaterial3d<Image>>();
    app.init_resource::<pbr::DefaultOpaqueRendererMethod>();
    app.add_plugins(bevy_casca::standard_materials!(pbr, DeferredPrepass));
    app
}

/// The mesh of all boxes: a cube of edge 1.
#[derive(Resource, Clone)]
pub struct Cube(pub Handle<Mesh>);

/// An app without renderer and window.
pub fn headless(with_casca: bool) -> App {
    let mut app = App::new();
    // Before Bevy's own: the order of plugins does not matter.
    if with_casca {
        app.insert_resource(CascaSettings { least_hidden: 0.0, ..Default::default() });
        app.add_plugins(CascaPlugin);
    }
    app.add_plugins((TaskPoolPlugin::default(), TransformPlugin, AssetPlugin::default(), MeshPlugin));
    app.init_asset::<Image>();
    app.add_plugins((CameraPlugin, LightPlugin));
    let cube = app.world_mut().resource_mut::<Assets<Mesh>>().add(Mesh::from(Cuboid::new(1.0, 1.0, 1.0)));
    app.insert_resource(Cube(cube));
    app
}

/// The numbers of all visible entities.
pub fn visible(app: &mut App) -> BTreeSet<u32> {
    let mut all = app.world_mut().query::<(&Nr, &ViewVisibility)>();
    all.iter(app.world()).filter(|(_, seen)| seen.get()).map(|(nr, _)| nr.0).collect()
}

/// A box around a middle.
pub fn spawn_box(world: &mut World, nr: u32, middle: Vec3, size: Vec3) -> Entity {
    let cube = world.resource::<Cube>().0.clone();
    world.spawn((Nr(nr), Mesh3d(cube), Transform::from_translation(middle).with_scale(size))).id()
}

pub fn spawn_camera(world: &mut World, nr: u32, at: Transform) -> Entity {
    let lens = PerspectiveProjection { aspect_ratio: 16.0 / 9.0, ..Default::default() };
    world.spawn((Nr(nr), Camera3d::default(), Projection::Perspective(lens), at)).id()
}

/// A box that is drawn and occludes.
pub fn opaque(world: &mut World, nr: u32, middle: Vec3, size: Vec3) -> Entity {
    let entity = spawn_box(world, nr, middle, size);
    world.entity_mut(entity).insert(Opaque::Front);
    entity
}

/// Fifty small boxes behind whatever stands at the origin, and a camera before it.
pub fn things_behind(world: &mut World, from: u32) {
    for i in 0..50 {
        let at = Vec3::new((i % 10) as f32 - 4.5, (i / 10) as f32 - 2.0, -10.0);
        spawn_box(world, from + i, at, Vec3::splat(0.4));
    }
    spawn_camera(world, CAMERA, Transform::from_xyz(0.0, 0.0, 20.0).looking_to(Vec3::NEG_Z, Vec3::Y));
}

/// Numbers that look like chance.
pub fn dice(n: u32) -> f32 {
    let x = n.wrapping_mul(0x9e37_79b9).rotate_left(13).wrapping_mul(0x85eb_ca6b);
    ((x ^ x >> 15).wrapping_mul(0xc2b2_ae35) >> 8) as f32 / (1 << 24) as f32
}

/// Ends a statement in the place of an expression.
pub fn done<T>(_: T) {}

/// Disables entities, where a program registers it.
#[derive(Component, Clone)]
pub struct Asleep;

/// The entity of a number, also one that is disabled.
pub fn find(world: &mut World, nr: u32) -> Option<Entity> {
    let mut all = world.query::<(Entity, &Nr, Has<Disabled>, Has<Asleep>)>();
    all.iter(world).find(|(_, found, ..)| found.0 == nr).map(|(entity, ..)| entity)
}

pub fn entity(world: &mut World, nr: u32) -> Entity {
    find(world, nr).unwrap()
}

/// Changes the entity of a number.
pub fn on(world: &mut World, nr: u32, change: impl Fn(&mut EntityWorldMut)) {
    let entity = entity(world, nr);
    change(&mut world.entity_mut(entity));
}

/// Why the entity of a number hides nothing.
pub fn why_not(app: &mut App, nr: u32) -> Option<WhyNot> {
    let entity = entity(app.world_mut(), nr);
    CascaScene::why_not(app.world(), entity)
}

/// The numbers of a list, which is in order.
fn numbers(world: &World, list: &[Entity]) -> BTreeSet<u32> {
    assert!(list.is_sorted(), "a list is not in order");
    let number = |entity: &Entity| world.get::<Nr>(*entity).map_or(u32::MAX, |nr| nr.0);
    let set: BTreeSet<u32> = list.iter().map(number).collect();
    assert_eq!(set.len(), list.len(), "an entity is listed twice");
    set
}

/// The numbers in the list of each camera.
pub fn lists(app: &mut App) -> Lists {
    let mut cameras = app.world_mut().query::<(&Nr, &VisibleEntities)>();
    let world = app.world();
    let meshes = |(nr, seen): (&Nr, &VisibleEntities)| {
        assert!(seen.entities.values().all(|list| list.is_sorted()), "a list is not in order");
        (nr.0, numbers(world, &seen.entities[&TypeId::of::<Mesh3d>()]))
    };
    cameras.iter(world).map(meshes).collect()
}

/// A light, a camera for suns, and the number of the view.
pub type View = (u32, u32, usize);

/// The numbers in the lists of all views of lights.
pub fn light_lists(app: &mut App) -> BTreeMap<View, BTreeSet<u32>> {
    let world = app.world_mut();
    let mut suns = world.query::<(&Nr, &CascadesVisibleEntities)>();
    let mut bulbs = world.query::<(&Nr, &CubemapVisibleEntities)>();
    let mut spots = world.query::<(&Nr, &VisibleMeshEntities)>();
    let (world, mut out) = (&*world, BTreeMap::new());
    let mut add = |light: &Nr, by: &Nr, lists: &mut dyn Iterator<Item = &VisibleMeshEntities>| {
        let lists = lists.map(|list| numbers(world, &list.entities)).enumerate();
        out.extend(lists.map(|(i, list)| ((light.0, by.0, i), list)));
    };
    for (nr, lists) in suns.iter(world) {
        for (camera, lists) in &lists.entities {
            add(nr, world.get(*camera).unwrap(), &mut lists.iter());
        }
    }
    bulbs.iter(world).for_each(|(nr, lists)| add(nr, nr, &mut lists.iter()));
    spots.iter(world).for_each(|(nr, list)| add(nr, nr, &mut std::iter::once(list)));
    out
}

/// Runs an app until no mesh is being prepared, and all that waits has been taken over.
pub fn settle(app: &mut App) {
    for _ in 0..200 {
        app.update();
        let preparing = app.world().get_resource::<CascaScene>().is_some_and(CascaScene::is_preparing);
        if !preparing {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    app.update();
    app.update();
}

/// Two apps in step.
pub struct Pair {
    pub ours: App,
    pub bevys: App,
    before: BTreeSet<u32>,
}

impl Pair {
    pub fn new(fill: impl Fn(&mut World)) -> Self {
        let (mut ours, mut bevys) = (headless(true), headless(false));
        fill(ours.world_mut());
        fill(bevys.world_mut());
        settle(&mut ours);
        settle(&mut bevys);
        let before = visible(&mut ours);
        Self { ours, bevys, before }
    }

    /// Changes both worlds alike, and runs a frame of both. Looks at what must hold in any.
    pub fn frame(&mut self, change: impl Fn(&mut World)) -> (Lists, Lists) {
        let start = self.ours.world_mut().increment_change_tick();
        for app in [&mut self.ours, &mut self.bevys] {
            change(app.world_mut());
            app.update();
        }
        let (ours, bevys) = (lists(&mut self.ours), lists(&mut self.bevys));
        for (camera, seen) in &ours {
            let more: Vec<_> = seen.difference(&bevys[camera]).collect();
            assert!(more.is_empty(), "camera {camera} sees more than Bevy lets it: {more:?}");
        }
        let visible = visible(&mut self.ours);
        let mut all = self.ours.world_mut().query::<(&Nr, Ref<ViewVisibility>)>();
        let now = self.ours.world_mut().change_tick();
        let all = all.iter(self.ours.world()).filter(|(_, seen)| !seen.added().is_newer_than(start, now));
        let changed =
            all.filter(|(_, seen)| seen.last_changed().is_newer_than(start, now)).map(|(nr, _)| nr.0);
        let needless = changed.filter(|nr| visible.contains(nr) == self.before.contains(nr));
        let needless: Vec<_> = needless.collect();
        assert!(needless.is_empty(), "marked changed, but as before: {needless:?}");
        self.before.clone_from(&visible);
        let mut listed: BTreeSet<u32> = ours.values().flatten().copied().collect();
        listed.extend(light_lists(&mut self.ours).into_values().flatten());
        let world = self.ours.world_mut();
        let mut culled = world.query_filtered::<&Nr, (With<Mesh3d>, Without<NoCpuCulling>)>();
        let culled = culled.iter(world).map(|nr| nr.0);
        let hidden = culled.filter(|nr| visible.contains(nr) && !listed.contains(nr));
        let hidden: Vec<_> = hidden.collect();
        assert!(hidden.is_empty(), "visible, but in no list: {hidden:?}");
        assert!(ours.values().flatten().all(|nr| visible.contains(nr)), "listed, but not visible");
        (ours, bevys)
    }
}

pub type Lists = BTreeMap<u32, BTreeSet<u32>>;

/// The boxes of an app as the oracle takes them, with their numbers.
pub fn truth(app: &mut App) -> (Vec<u32>, Vec<Object>) {
    let cube = Arc::new(world::Mesh::cuboid(glam::Vec3::splat(-0.5), glam::Vec3::splat(0.5)));
    let world = app.world_mut();
    let mut all = world.query_filtered::<(&Nr, &GlobalTransform, &InheritedVisibility), With<Mesh3d>>();
    let drawn = all.iter(world).filter(|(.., drawn)| drawn.get());
    let mut boxes: Vec<(u32, Affine3A)> = drawn.map(|(nr, at, _)| (nr.0, at.affine())).collect();
    boxes.sort_by_key(|(nr, _)| *nr);
    let object = |(_, at): &(u32, Affine3A)| Object {
        name: String::new(),
        shape: Shape::Mesh {
            mesh: cube.clone(),
            transform: glam::Affine3A::from_cols_array(&at.to_cols_array()),
        },
        motion: Motion::Dynamic { max_speed: 1e3 },
        occludes: true,
        tested: true,
    };
    let objects = boxes.iter().map(object).collect();
    (boxes.into_iter().map(|(nr, _)| nr).collect(), objects)
}

/// Asks the oracle whether a set of numbers lacks anything that a camera sees. Returns how many
/// boxes it sees.
pub fn judge(app: &mut App, camera: u32, set: &BTreeSet<u32>) -> usize {
    let camera = entity(app.world_mut(), camera);
    let at = *app.world().get::<GlobalTransform>(camera).unwrap();
    let view = glam::Affine3A::from_cols_array(&at.affine().to_cols_array()).inverse();
    let lens = PerspectiveProjection::default();
    let camera = world::Camera {
        eye: glam::Vec3::from(at.translation().to_array()),
        view: view.into(),
        projection: glam::camera::rh::proj::directx::perspective(lens.fov, 16.0 / 9.0, lens.near, lens.far),
    };
    let (numbers, objects) = truth(app);
    let options = OracleOptions { width: 96, height: 54, samples_per_object: 4, ..Default::default() };
    let all: Vec<usize> = (0..objects.len()).collect();
    let verdict =
        Oracle::new(&objects, options).frame(&objects, &all, &camera, &|i| set.contains(&numbers[i]));
    let lost: Vec<u32> = verdict.false_negatives.iter().map(|lost| numbers[lost.object]).collect();
    assert_eq!(lost, [0; 0], "visible, but not in the set");
    verdict.exact.len()
}
