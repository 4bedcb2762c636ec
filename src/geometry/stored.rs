//! Plain geometry, read with serde: values that every function would refuse are refused here
//! already.

use glam::{Quat, Vec3};

use crate::geometry::{Aabb, Obb, Plane, Sphere};

/// Reads a struct with these fields, and checks the value.
macro_rules! checked {
    ($type:ident, $what:literal, $($field:ident: $kind:ty),+) => {
        impl<'de> serde::Deserialize<'de> for $type {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                #[derive(serde::Deserialize)]
                #[serde(rename = $what)]
                struct Fields {
                    $($field: $kind),+
                }
                let Fields { $($field),+ } = Fields::deserialize(deserializer)?;
                let value = Self { $($field),+ };
                value.check(concat!("the ", $what)).map_err(serde::de::Error::custom)?;
                Ok(value)
            }
        }
    };
}

checked!(Aabb, "box", min: Vec3, max: Vec3);
checked!(Sphere, "sphere", center: Vec3, radius: f32);
checked!(Obb, "turned box", center: Vec3, half: Vec3, rotation: Quat);
checked!(Plane, "plane", normal: Vec3, offset: f32);
