//! Which entities hide others, and why others do not.

use std::any::TypeId;
use std::fmt;

use bevy_asset::{Assets, RenderAssetUsages};
use bevy_camera::primitives::Aabb;
use bevy_camera::visibility::{
    InheritedVisibility, NoCpuCulling, NoFrustumCulling, RenderLayers, ViewVisibility, Visibility,
    VisibilityClass, VisibilityRange,
};
use bevy_ecs::entity_disabling::DefaultQueryFilters;
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use bevy_light::NotShadowCaster;
use bevy_mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy_mesh::skinning::SkinnedMesh;
use bevy_mesh::{Mesh, Mesh3d};
use bevy_transform::components::GlobalTransform;
use casca::Method;

use crate::layers;
use crate::materials::{Deferred, Judged};
use crate::occluders::Key;
use crate::scene::{CascaScene, InScene};
use crate::settings::{CascaSettings, NoOcclusionCulling, NotOccluder, Occluder, Opaque};
use crate::sync::Refused;

/// Makes the reasons: of those without numbers the text is the documentation, too.
macro_rules! reasons {
    ($($name:ident: $text:literal,)*) => {
        /// Why an entity hides nothing: [`CascaScene::why_not`].
        #[derive(Debug, Clone, Copy, PartialEq)]
        #[non_exhaustive]
        pub enum WhyNot {
            $(#[doc = concat!("Because ", $text, ".")] $name,)*
            /// Because it has no component of this name: Bevy does not draw it, or nobody knows where.
            Lacks(&'static str),
            /// Because it has a component of this name, with which nothing hides.
            Has(&'static str),
            /// Because it moves. If it stays where it is, it hides after so many frames.
            Moves(u32),
            /// Because its mesh has so many triangles: more than [`CascaSettings::most_triangles`].
            Triangles(usize),
            /// Because casca refuses its mesh or its box.
            Refused(casca::Error),
        }

        impl fmt::Display for WhyNot {
            fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
                match self {
                    $(Self::$name => f.write_str($text),)*
                    Self::Lacks(component) => write!(f, "it has no {component}"),
                    Self::Has(component) => write!(f, "it has {component}"),
                    Self::Moves(frames) => write!(f, "it moves, and has to rest for {frames} frames"),
                    Self::Triangles(count) => write!(f, "its mesh has {count} triangles: too many"),
                    Self::Refused(error) => error.fmt(f),
                }
            }
        }
    };
}

reasons! {
    Off: "casca is switched off, or culls by frustum only",
    Disabled: "a component disables it",
    Invisible: "it is not visible",
    Layer: "it is on a render layer from 31 on",
    Flat: "its transform is flat or not finite",
    Mirrored: "it is mirrored, and only its fronts are drawn",
    InFront: "it is drawn before nearer things, or is not a mesh alone",
    NoRule: "there is no rule for its material",
    NoMaterial: "its material is not there",
    NotOpaque: "nothing says that it is opaque",
    Sides: "it has two materials that are drawn from different sides",
    Textures: "a texture of its material is not with the renderer",
    Deferred: "a camera does not draw its deferred material",
    NoMesh: "its mesh is not there",
    NotRendered: "its mesh is for the main world alone",
    Preparing: "its mesh is being prepared",
    Unreadable: "only the graphics processor has its mesh",
    NotTriangles: "its mesh is not a list of triangles",
    Positions: "the positions in its mesh cannot be read",
    OutOfBox: "its mesh reaches out of its Aabb",
    Waits: "it is taken over in one of the next frames",
}

impl From<casca::Error> for WhyNot {
    fn from(error: casca::Error) -> Self {
        Self::Refused(error)
    }
}

/// All that decides how an entity is in the scene.
#[derive(QueryData)]
pub(crate) struct Managed {
    pub(crate) entity: Entity,
    mesh: &'static Mesh3d,
    pub(crate) aabb: &'static Aabb,
    pub(crate) transform: &'static GlobalTransform,
    visible: &'static InheritedVisibility,
    layers: Option<&'static RenderLayers>,
    opaque: Option<&'static Opaque>,
    judged: Option<&'static Judged>,
    proxy: Option<&'static Occluder>,
    not_occluder: Has<NotOccluder>,
    not_caster: Has<NotShadowCaster>,
    pub(crate) skinned: Has<SkinnedMesh>,
    classes: Option<&'static VisibilityClass>,
}

impl ManagedItem<'_, '_> {
    pub(crate) fn layers(&self) -> u64 {
        layers::of_entity(self.layers, !self.visible.get(), !self.not_caster)
    }

    /// Whether it cannot be seen where its mesh is hidden.
    pub(crate) fn may_be_hidden(&self) -> Result<(), WhyNot> {
        let is_told = self.opaque.is_some() || self.proxy.is_some();
        // A lamp with a light in it goes on shining where nobody sees it. A class may be there twice.
        let mesh_alone = |classes: &&VisibilityClass| {
            !classes.is_empty() && classes.iter().all(|class| *class == TypeId::of::<Mesh3d>())
        };
        self.classes.filter(mesh_alone).ok_or(WhyNot::InFront)?;
        self.judged.map_or(Ok(()), |judged| judged.may_be_hidden(is_told))
    }

    /// The mesh that it hides with, if it does.
    pub(crate) fn key(&self, moves: bool, meshes: &Assets<Mesh>, deferred: &Deferred) -> Result<Key, WhyNot> {
        if moves && self.proxy.is_none() {
            return Err(WhyNot::Moves(0));
        }
        if self.not_occluder {
            return Err(WhyNot::Has("NotOccluder"));
        }
        if self.skinned {
            return Err(WhyNot::Has("SkinnedMesh"));
        }
        let layers = self.layers();
        if !layers::may_hide(layers) {
            return Err(WhyNot::Layer);
        }
        let determinant = self.transform.affine().matrix3.determinant();
        if !determinant.is_finite() || determinant == 0.0 {
            return Err(WhyNot::Flat);
        }
        let mesh = meshes.get(self.mesh.id()).ok_or(WhyNot::NoMesh)?;
        if !mesh.asset_usage.contains(RenderAssetUsages::RENDER_WORLD) {
            return Err(WhyNot::NotRendered);
        }
        // Whatever is told of an entity: it hides nothing if its material is not drawn.
        let told = self.proxy.map(|_| Opaque::Both).or(self.opaque.copied());
        let sides = match self.judged {
            Some(judged) => judged.hides(told, deferred, layers)?,
            None => told.ok_or(WhyNot::NotOpaque)?,
        };
        if determinant < 0.0 && sides == Opaque::Front {
            return Err(WhyNot::Mirrored);
        }
        Ok(Key { mesh: self.proxy.map_or(self.mesh.id(), |Occluder(proxy)| proxy.id()), sides })
    }
}

impl CascaScene {
    /// Why an entity hides nothing; `None` if it hides what is behind it. Of several reasons, one.
    ///
    /// It costs nothing unless it is called. Systems may have the world as a parameter: `&World`.
    pub fn why_not(world: &World, entity: Entity) -> Option<WhyNot> {
        let entity = world.get_entity(entity).map_err(|_| WhyNot::Lacks("Mesh3d"));
        entity.and_then(|entity| ask(world, entity)).err()
    }

    /// All entities with a mesh that hide nothing, and why. It looks at every entity of the world.
    pub fn all_why_not(world: &World) -> impl Iterator<Item = (Entity, WhyNot)> {
        let meshes = world.iter_entities().filter(|entity| entity.contains::<Mesh3d>());
        meshes.filter_map(|entity| Some((entity.id(), ask(world, entity).err()?)))
    }
}

/// The names of components, and whether an entity has them.
macro_rules! components {
    ($entity:ident, $($name:ident)*) => { [$((stringify!($name), $entity.contains::<$name>())),*] };
}

fn ask(world: &World, entity: EntityRef) -> Result<(), WhyNot> {
    let settings = world.get_resource::<CascaSettings>().ok_or(WhyNot::Off)?;
    let casca = world.get_resource::<CascaScene>().ok_or(WhyNot::Off)?;
    let meshes = world.get_resource::<Assets<Mesh>>().ok_or(WhyNot::Off)?;
    if !settings.enabled || matches!(settings.method, Method::Frustum) {
        return Err(WhyNot::Off);
    }
    let disabling = world.get_resource::<DefaultQueryFilters>();
    if disabling.is_some_and(|all| all.disabling_ids().any(|id| entity.contains_id(id))) {
        return Err(WhyNot::Disabled);
    }
    let forbidden = components!(entity, NoOcclusionCulling NoFrustumCulling NoCpuCulling VisibilityRange
        MorphWeights MeshMorphWeights);
    if let Some((name, _)) = forbidden.into_iter().find(|(_, has)| *has) {
        return Err(WhyNot::Has(name));
    }
    if entity.get::<Mesh3d>().is_some_and(|mesh| !meshes.contains(mesh.id())) {
        return Err(WhyNot::NoMesh);
    }
    let needed = components!(entity, Mesh3d Aabb GlobalTransform Visibility InheritedVisibility
        ViewVisibility VisibilityClass);
    if let Some((name, _)) = needed.into_iter().find(|(_, has)| !has) {
        return Err(WhyNot::Lacks(name));
    }
    let item = entity.get_components::<Managed>().map_err(|_| WhyNot::Waits)?;
    if !item.visible.get() {
        return Err(WhyNot::Invisible);
    }
    item.may_be_hidden()?;
    let deferred = world.get_resource::<Deferred>().copied().unwrap_or_default();
    let key = item.key(false, meshes, &deferred)?;
    let Some(known) = entity.get::<InScene>() else {
        return Err(entity.get::<Refused>().map_or(WhyNot::Waits, |refused| refused.0));
    };
    if known.moves && item.proxy.is_none() {
        let rests = casca.movers.get(&item.entity).map_or(casca.frame, |mover| mover.rests);
        return Err(WhyNot::Moves(rests.saturating_sub(casca.frame)));
    }
    casca.occluders.why_not(&key)?;
    known.refused.as_deref().copied().map_or(Ok(()), Err)?;
    let hides = casca.scene.as_ref().is_some_and(|scene| matches!(scene.occluder(known.id), Ok(Some(_))));
    if hides { Ok(()) } else { Err(WhyNot::Waits) }
}
