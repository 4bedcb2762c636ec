//! Whether objects hide.

use std::collections::BTreeMap;

use super::fault::{TmxFault, shortened};
use super::properties::TmxValue;
use crate::editor::Role;
use crate::tmx::tileset::Opaque;

/// The rules for the roles of the objects of a layer.
#[derive(Debug, Clone, Copy)]
pub(in crate::tmx) struct Roles<'l> {
    /// The names of the properties that say that an object hides, and that it is a door.
    pub names: [&'l str; 2],
    /// Whether all objects of the layer hide.
    pub walls: bool,
}

impl Roles<'_> {
    /// The role that an object gives itself, or else its tile, its class or its layer.
    pub(super) fn role(
        &self,
        properties: &BTreeMap<String, TmxValue>,
        class: &str,
        tile: Option<(&Opaque, u32)>,
        faults: &mut Vec<TmxFault>,
    ) -> Role {
        let mut says = |which: usize| {
            let name = self.names[which];
            match properties.get(name) {
                Some(TmxValue::Bool(says)) => return Some(*says),
                Some(other) => {
                    let (property, kind) = (shortened(name), other.kind());
                    faults.push(TmxFault::PropertyType { property, kind });
                }
                None => {}
            }
            let of_tile = tile.is_some_and(|(set, number)| set.says(number, which));
            (of_tile || class == name).then_some(true)
        };
        let (hides, door) = (says(0), says(1));
        match (door, hides) {
            (Some(true), _) => Role::Door,
            (_, Some(true)) => Role::Wall,
            (_, None) if self.walls => Role::Wall,
            _ => Role::Plain,
        }
    }
}
