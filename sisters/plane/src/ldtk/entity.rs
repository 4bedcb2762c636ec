//! Entities of levels.

use std::collections::BTreeMap;

use glam::{DVec2, Vec2};
use serde_json::Value;

use super::error::LdtkWarning;
use super::import::LdtkImport;
use super::project::{Blocking, Entity, Layer};
use crate::editor::{FARTHEST, Placed, Role, Rule, Says, truth};
use crate::error::{Error, finite2, not_negative};
use crate::geometry::ellipse::ellipse;
use crate::geometry::{Disc, Rect, Shape};
use crate::scene::Scene;

/// An entity of a level: see [`LdtkLevel::entities`](super::LdtkLevel::entities).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct LdtkEntity {
    /// The name of its kind.
    pub name: String,
    /// The name that no other entity has.
    pub iid: String,
    /// The name of its layer.
    pub layer: String,
    /// Where it is in the level, in pixels: x to the right, y down.
    pub rect: Rect,
    /// Whether the editor draws it as an ellipse in its rectangle.
    pub is_ellipse: bool,
    /// Whether it hides others. Entities without width and height hide nothing.
    pub role: Role,
    /// The values of its fields, by their names.
    pub fields: BTreeMap<String, LdtkValue>,
}

/// The value of a field.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum LdtkValue {
    /// No value.
    Null,
    /// A boolean.
    Bool(bool),
    /// A whole number.
    Int(i64),
    /// Another number.
    Float(f64),
    /// A text, a colour, a path or the value of an enum.
    Text(String),
    /// The values of an array.
    List(Vec<LdtkValue>),
    /// A point, a tile or a reference to an entity, as the file has it: a point has `cx` and `cy`,
    /// for example.
    Object(BTreeMap<String, LdtkValue>),
}

impl From<&Value> for LdtkValue {
    // It calls itself, but files with more than 127 lists in each other are refused.
    fn from(value: &Value) -> Self {
        match value {
            Value::Null => Self::Null,
            Value::Bool(value) => Self::Bool(*value),
            Value::Number(value) => match (value.as_i64(), value.as_f64()) {
                (Some(whole), _) => Self::Int(whole),
                (None, Some(value)) => Self::Float(value),
                (None, None) => Self::Null,
            },
            Value::String(text) => Self::Text(text.clone()),
            Value::Array(values) => Self::List(values.iter().map(Self::from).collect()),
            Value::Object(members) => {
                Self::Object(members.iter().map(|(name, value)| (name.clone(), value.into())).collect())
            }
        }
    }
}

impl LdtkImport {
    pub(super) fn entity(
        &self,
        layer: &Layer,
        entity: &Entity,
        blocking: &Blocking,
        rule: &Rule,
    ) -> Result<LdtkEntity, LdtkWarning> {
        let size = DVec2::new(entity.width, entity.height);
        let shift = DVec2::new(layer.shift_x.into(), layer.shift_y.into());
        let least = DVec2::from(entity.px) - DVec2::from(entity.pivot) * size + shift;
        let near = |p: DVec2| p.abs().max_element() <= FARTHEST as f64;
        if !near(least) || !near(least + size) || size.min_element() < 0.0 {
            return Err(LdtkWarning::Far { entity: entity.name.clone(), layer: layer.name.clone() });
        }
        Ok(LdtkEntity {
            name: entity.name.clone(),
            iid: entity.iid.clone(),
            layer: layer.name.clone(),
            rect: Rect::new(least.as_vec2(), (least + size).as_vec2()),
            is_ellipse: blocking.ellipses.contains(&entity.def_uid),
            role: Self::role(layer, entity, rule),
            fields: entity.field_instances.iter().map(|f| (f.name.clone(), (&f.value).into())).collect(),
        })
    }

    fn role(layer: &Layer, entity: &Entity, rule: &Rule) -> Role {
        if entity.width == 0.0 && entity.height == 0.0 {
            return Role::Plain;
        }
        let (mut fields, mut names) = (Says::default(), Says::default());
        for field in &entity.field_instances {
            if let (Some(role), Some(says)) = (rule.role(&field.name), says(&field.value)) {
                fields.add(role, says);
            }
        }
        let named = entity.tags.iter().chain([&entity.name]).filter_map(|name| rule.role(name));
        named.for_each(|role| names.add(role, true));
        fields.or(names).role().or_else(|| rule.role(&layer.name)).unwrap_or_default()
    }
}

/// Whether the value of a field says yes or no; `None` if it says neither.
fn says(value: &Value) -> Option<bool> {
    match value {
        Value::Bool(says) => Some(*says),
        Value::Number(number) => Some(number.as_f64() != Some(0.0)),
        Value::String(text) => truth(text),
        _ => None,
    }
}

impl LdtkEntity {
    /// Adds the entity to a scene as a fixed object with this user data: walls and closed doors
    /// with occluders. The upper left corner of its level lies at `origin`, and a pixel is `pixel`
    /// world units wide.
    ///
    /// Ellipses hide as polygons of [`DISC_SIDES`](crate::DISC_SIDES) sides that lie inside, and
    /// are seen as polygons around them. Costs as [`Scene::insert`].
    ///
    /// # Errors
    /// An origin that is not finite, a size that is not finite or is negative, and those of
    /// [`Scene::insert`]. Nothing is added then.
    pub fn insert(
        &self,
        scene: &mut Scene,
        origin: Vec2,
        pixel: f32,
        user_data: u64,
    ) -> Result<Placed, Error> {
        finite2("the origin of the level", origin)?;
        not_negative("the size of a pixel", pixel)?;
        let at = |p: Vec2| (origin.as_dvec2() + p.as_dvec2() * f64::from(pixel)).as_vec2();
        let Rect { min, max } = self.rect;
        let half = (max - min).as_dvec2() / 2.0 * f64::from(pixel);
        let (bounds, occluder): (Shape, Shape) = if min == max {
            (Disc::new(at(min), 0.0).into(), Disc::new(at(min), 0.0).into())
        } else if self.is_ellipse && half.min_element() > 0.0 {
            let axes = [DVec2::new(half.x, 0.0), DVec2::new(0.0, half.y)];
            let [inner, outer] = ellipse(at((min + max) / 2.0), axes)?;
            (outer, inner)
        } else {
            let rect = Rect::new(at(min), at(max));
            (rect.into(), rect.into())
        };
        let hides = self.role != Role::Plain && min != max;
        Placed::insert(scene, vec![(bounds, hides.then_some(occluder))], user_data)
    }
}
