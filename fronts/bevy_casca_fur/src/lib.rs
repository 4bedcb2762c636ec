//! Fur for Bevy: layers (shells) on any mesh, lit, shadowed and fogged by Bevy's own renderer.
//!
//! [`FurPlugin`] gives each entity with a mesh and [`Furry`] a child, the [`Coat`], whose mesh
//! holds all layers of the fur, and chooses in each frame how many there are: by their height in
//! pixels, by what was visible in the last frame, and by a budget ([`FurSettings`]). Its
//! shader has the rule of [`casca_fur`] for the places of strands, as the text of that crate.
//!
//! ```
//! use bevy_casca_fur::{FurExtension, FurMaterial, FurPlugin, Furry, fur_material};
//! # use bevy_app::{App, Startup};
//! # use bevy_asset::Assets;
//! # use bevy_color::Color;
//! # use bevy_ecs::prelude::*;
//! # use bevy_mesh::{Mesh, Mesh3d};
//! # use bevy_pbr::{MeshMaterial3d, StandardMaterial};
//! # use bevy_shape::Sphere;
//! # type Plugins = FurPlugin;
//!
//! fn set_up(
//!     mut commands: Commands,
//!     mut meshes: ResMut<Assets<Mesh>>,
//!     mut skins: ResMut<Assets<StandardMaterial>>,
//!     mut furs: ResMut<Assets<FurMaterial>>,
//! ) -> Result {
//!     // A ball of radius 0.5; fur of 10% of it, of which roots cover 30% of the skin.
//!     let strands = casca_fur::strands::Fur::for_radius(0.5, 0.1, 0.3)?;
//!     let brown = StandardMaterial::from(Color::srgb(0.5, 0.35, 0.2));
//!     let fur = furs.add(fur_material(brown.clone(), FurExtension::new(strands)));
//!     commands.spawn((
//!         Mesh3d(meshes.add(Sphere::new(0.5))),
//!         MeshMaterial3d(skins.add(brown)),
//!         Furry(fur),
//!     ));
//!     Ok(())
//! }
//!
//! # fn main() {
//! let mut app = App::new();
//! # app.add_plugins(bevy_asset::AssetPlugin::default());
//! // After DefaultPlugins.
//! app.add_plugins(FurPlugin).add_systems(Startup, set_up);
//! # }
//! ```

mod coat;
mod grow;
mod material;
mod numeric;
mod plugin;
mod settings;
mod shells;
mod sights;
mod store;

pub use casca_fur;

pub use coat::{Coat, Furry};
pub use material::{FurExtension, FurMaterial, fur_material};
pub use plugin::{FurPlugin, FurSystems};
pub use settings::FurSettings;
pub use shells::{ATTRIBUTE_FUR_LAYER, ATTRIBUTE_FUR_LENGTH, Unfit, shells};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
