//! Descriptions of objects with serde. A scene would refuse the descriptions that are refused here.

use std::borrow::Cow;

use glam::Affine3A;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de, ser};

use crate::object::{ALL_LAYERS, Bounds, Motion, ObjectDesc, Occluder};

/// A description as it is stored.
#[derive(Serialize, Deserialize)]
#[serde(rename = "ObjectDesc")]
struct DescFields<'a> {
    bounds: Cow<'a, Bounds>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    occluder: Option<Cow<'a, Occluder>>,
    motion: Motion,
    #[serde(default)]
    user_data: u64,
    #[serde(default = "all_layers")]
    layers: u64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    transform: Option<Affine3A>,
}

fn all_layers() -> u64 {
    ALL_LAYERS
}

impl Serialize for ObjectDesc {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.check().and_then(|()| self.clone().place()).map_err(ser::Error::custom)?;
        let fields = DescFields {
            bounds: Cow::Borrowed(&self.bounds),
            occluder: self.occluder.as_ref().map(Cow::Borrowed),
            motion: self.motion,
            user_data: self.user_data,
            layers: self.layers,
            transform: self.transform,
        };
        fields.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for ObjectDesc {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let DescFields { bounds, occluder, motion, user_data, layers, transform } =
            DescFields::deserialize(deserializer)?;
        let occluder = occluder.map(Cow::into_owned);
        let bounds = bounds.into_owned();
        let desc = Self { bounds, occluder, motion, contradicts: false, user_data, layers, transform };
        desc.check().and_then(|()| desc.clone().place()).map_err(de::Error::custom)?;
        Ok(desc)
    }
}
