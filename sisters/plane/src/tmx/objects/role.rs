//! Whether objects hide.

use std::collections::BTreeMap;

use super::fault::{TmxFault, shortened};
use super::properties::TmxValue;
use crate::editor::{Role, Rule, Says, truth};

/// The rules for the roles of what is in a layer.
#[derive(Debug, Clone, Copy)]
pub(in crate::tmx) struct Roles<'l> {
    pub rule: &'l Rule,
    /// The role that the layer gives, if it gives one.
    pub layer: Option<Role>,
}

impl Roles<'_> {
    /// The role that an object gives itself, or else its class, its tile or its layer.
    pub(super) fn role(
        &self,
        properties: &BTreeMap<String, TmxValue>,
        class: &str,
        of_tile: Says,
        faults: &mut Vec<TmxFault>,
    ) -> Role {
        let mut own = Says::default();
        for (name, value) in properties {
            let Some(role) = self.rule.role(name) else { continue };
            match value.truth() {
                Some(says) => own.add(role, says),
                None => {
                    let (property, kind) = (shortened(name), value.kind());
                    faults.push(TmxFault::PropertyType { property, kind });
                }
            }
        }
        let all = own.or(self.rule.role(class).into()).or(of_tile);
        all.role().or(self.layer).unwrap_or_default()
    }
}

impl TmxValue {
    /// Whether it says yes or no; `None` if it says neither.
    fn truth(&self) -> Option<bool> {
        match self {
            Self::Bool(says) => Some(*says),
            Self::Int(number) => Some(*number != 0),
            Self::Float(number) => Some(*number != 0.0),
            Self::String(text) => truth(text),
            _ => None,
        }
    }
}
