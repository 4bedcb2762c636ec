//! Convex solids with serde: by their corners. Faces and edges are found anew, so that no file can
//! contradict itself.

use std::sync::Arc;

use glam::DVec3;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::error::{Error, not_negative};
use crate::numeric::shape::CORNER;
use crate::shape::convex::{Convex, MAX_CONVEX};

/// A polytope with [`MAX_CONVEX`] faces has at most this many corners.
const MOST_CORNERS: usize = 2 * MAX_CONVEX - 4;

/// A convex solid as it is stored.
#[derive(Serialize, Deserialize)]
#[serde(rename = "Convex")]
struct ConvexFields {
    vertices: Vec<DVec3>,
    /// See [`Convex::lost`].
    #[serde(default)]
    lost: f64,
}

impl ConvexFields {
    fn solid(self) -> Result<Convex, Error> {
        const WHAT: &str = "a corner of a convex solid";
        if !(4..=MOST_CORNERS).contains(&self.vertices.len()) {
            return Err(Error::Convex("it needs 4 to 124 corners"));
        }
        if let Some(&value) = self.vertices.iter().find(|v| !v.is_finite()) {
            return Err(Error::NotFinite { what: WHAT, value });
        }
        let largest = self.vertices.iter().map(|v| v.abs().max_element()).fold(0.0, f64::max);
        if largest > f64::from(f32::MAX) {
            return Err(Error::Convex("its corners lie beyond the range of single precision"));
        }
        not_negative("how much the convex solid lost", self.lost)?;
        let solid = Convex::hull(&self.vertices, CORNER * largest);
        let mut solid = solid.ok_or(Error::Convex("its corners lie in one plane, or too close together"))?;
        solid.lost += self.lost;
        Ok(solid)
    }
}

impl Serialize for Convex {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        ConvexFields { vertices: self.vertices.clone(), lost: self.lost }.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Convex {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        ConvexFields::deserialize(deserializer)?.solid().map_err(D::Error::custom)
    }
}

/// Serialises a shared solid.
pub(crate) fn serialize<S: Serializer>(solid: &Arc<Convex>, serializer: S) -> Result<S::Ok, S::Error> {
    solid.as_ref().serialize(serializer)
}

/// Reads a solid, to be shared.
pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Arc<Convex>, D::Error> {
    Convex::deserialize(deserializer).map(Arc::new)
}
