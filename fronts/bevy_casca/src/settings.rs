//! What a program may choose: a resource, components of single entities, and the order of systems.

use bevy_asset::Handle;
use bevy_ecs::prelude::*;
use bevy_mesh::Mesh;
use casca::PointOptions;

/// How entities are culled. Change it at any time; it counts from the next frame on.
#[derive(Resource, Debug, Clone, PartialEq)]
pub struct CascaSettings {
    /// Whether casca culls. If not, entities are culled by frustum as Bevy does it. Default: true.
    pub enabled: bool,
    /// How cameras find what they see, and lights what they shine on; invalid options hide nothing.
    /// A camera keeps what it finds for the way that it goes in the next frames: [`casca::KeptQuery`].
    /// Default: [`PointOptions::balanced`], [coherent](PointOptions::coherent).
    pub options: PointOptions,
    /// The share of the entities in its frustum that the query of a camera has to leave out. If it leaves
    /// out less, the query costs more than it saves, and the camera is culled by frustum only for 32 to
    /// 1,024 frames. Set 0 where entities are dear to draw: then no camera rests. Default: 2/3.
    pub least_hidden: f32,
    /// Which shadow casters are left out. Default: [`Shadows::Lit`].
    pub shadows: Shadows,
    /// An entity that has not moved for so many frames counts as still, and may hide others.
    /// Default: 8.
    pub still_after: u32,
    /// The most entities that are taken over in a frame; others are culled by frustum until it is
    /// their turn. Default: 4,096.
    pub most_new: usize,
    /// Meshes with more triangles than this hide nothing by themselves; give such entities an
    /// [`Occluder`]. Default: 200,000.
    pub most_triangles: usize,
    /// A folder of prepared meshes, made if it is missing: with it, a program prepares only meshes
    /// that no earlier run did. Whoever can write there can make things hide others. Default:
    /// `None`.
    #[cfg(feature = "cache")]
    pub cache: Option<std::path::PathBuf>,
}

impl Default for CascaSettings {
    fn default() -> Self {
        Self {
            enabled: true,
            options: PointOptions::balanced().coherent(true),
            least_hidden: 2.0 / 3.0,
            shadows: Shadows::Lit,
            still_after: 8,
            most_new: 1 << 12,
            most_triangles: 200_000,
            #[cfg(feature = "cache")]
            cache: None,
        }
    }
}

/// Which shadow casters are left out of shadow maps, and which lamps are left out whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Shadows {
    /// None but those that Bevy leaves out.
    All,
    /// Those that lie in the shadow of others: the shadow map stays the same without them. Lamps
    /// whose light falls on nothing that a camera sees are switched off.
    #[default]
    Lit,
}

/// On an entity: whatever is behind its [`Mesh3d`](bevy_mesh::Mesh3d) cannot be seen through it.
/// While it stays where it is, it hides others.
///
/// Give it to entities with a material that is opaque, casts the shadow of the mesh (or add
/// [`NotShadowCaster`](bevy_light::NotShadowCaster)) and moves no vertices. Where materials tell by
/// themselves, a [`MaterialsPlugin`](crate::MaterialsPlugin) does for all entities.
#[derive(Component, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Opaque {
    /// Drawn from its front only: back faces are culled, as by default.
    Front,
    /// Drawn from both sides.
    Both,
}

/// On an entity: what hides others in its place, wherever it moves. A simple mesh that is smaller
/// than what is drawn, in the space of the entity. It hides from both sides.
#[derive(Component, Debug, Clone, PartialEq, Eq)]
pub struct Occluder(pub Handle<Mesh>);

/// On an entity: it hides nothing.
#[derive(Component, Debug, Clone, Copy, Default)]
pub struct NotOccluder;

/// On an entity: nothing hides it, and it hides nothing; only the frustum culls it. On a camera or
/// a light: only the frustum culls entities for it, and the light is never switched off.
#[derive(Component, Debug, Clone, Copy, Default)]
pub struct NoOcclusionCulling;

/// What the plugin does in `PostUpdate`, in this order. The first three are part of Bevy's
/// `VisibilitySystems::CheckVisibility`. A system that moves entities in this frame must run before
/// that set.
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CascaSystems {
    /// Materials are judged: [`MaterialsPlugin`](crate::MaterialsPlugin).
    Materials,
    /// Entities that came, moved, changed or went are brought up to date in the
    /// [`CascaScene`](crate::CascaScene).
    Sync,
    /// Each camera is given the entities that it may see.
    Cameras,
    /// Each light is given the entities that may cast its shadows.
    Lights,
    /// The frame ends: what nobody saw is put into volumes.
    End,
}
