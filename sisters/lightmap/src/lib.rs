//! Lightmaps and grids of probes for levels, baked by [`casca_radiosity`]: light with all of its bounces
//! that crosses no wall.
//!
//! [`light`] unwraps meshes and lights them; [`Level`] reads a glTF file, and writes it with a second set
//! of texture coordinates. What it writes beside are KTX 2 images that Bevy reads as `Lightmap` and
//! `IrradianceVolume`. Light is that which a matt white surface scatters: irradiance over pi, in the
//! units of the file's lights. So a `lightmap_exposure` of 1 is right.

mod atlas;
mod backs;
mod beside;
mod error;
mod file;
mod ktx2;
mod light;
mod probes;
#[cfg(feature = "cli")]
pub mod program;

pub use atlas::{Placed, Texel, Texels, on_page, texels, unwrap};
pub use backs::Backs;
pub use beside::{Beside, beside};
pub use error::BakeError;
pub use file::Level;
pub use ktx2::{packed, unpacked};
pub use light::{Following, Light, Progress, light};
pub use probes::Probes;
pub use uvunwrap::{Atlas, InstanceRect, OutputMesh};

/// How a level is baked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Texels a metre, at least; 0.01 to 1000.
    pub texels: f32,
    /// The longest side of a page of lightmaps, in texels; 64 to 8192. More pages are made where one is
    /// too small.
    pub side: u32,
    /// Metres between probes, at most; 0.001 to 1e6.
    pub spacing: f32,
    /// Cells of the radiosity cache along the longest axis, 1 to 512.
    pub cells: u32,
    /// Rays of each surface in a cell that a texel reads, 1 to 4096. Others send a quarter.
    pub rays: u32,
    /// Lights that are no surfaces stay with the engine, and lightmaps have only what comes from their
    /// light by bounces.
    pub live: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self { texels: 8.0, side: 4096, spacing: 1.0, cells: 64, rays: 256, live: false }
    }
}

/// The least and the greatest of each setting. What lies beyond makes a room one texel, or takes any memory.
const TEXELS: (f32, f32) = (0.01, 1000.0);
const SIDES: (f32, f32) = (64.0, 8192.0);
const SPACINGS: (f32, f32) = (1e-3, 1e6);

impl Settings {
    fn check(&self) -> Result<(), BakeError> {
        for (what, value, (least, most)) in [
            ("texels a metre", self.texels, TEXELS),
            ("texels of the longest side", self.side as f32, SIDES),
            ("metres between probes", self.spacing, SPACINGS),
        ] {
            // Not so for what is no number.
            if !(least..=most).contains(&value) {
                return Err(BakeError::Setting(what, value, least, most));
            }
        }
        Ok(())
    }
}
