//! What layers and their groups say of all in them.

use super::error::TmxError;
use super::names::{Role, Rule, Says};
use super::tileset::properties;
use super::xml::{Element, Xml};

/// What holds for all in a layer, by itself and its groups.
#[derive(Debug, Clone, Copy)]
pub(super) struct Above {
    /// The shift in pixels.
    pub(super) shift: [f64; 2],
    /// The role that they give, if they give one.
    pub(super) role: Option<Role>,
}

impl Above {
    /// What holds in a layer or a group in this one, at its start.
    pub(super) fn inner(self, xml: &Xml<'_>, layer: &Element<'_>, rule: &Rule) -> Result<Self, TmxError> {
        let [x, y] = [xml.decimal(layer, "offsetx")?, xml.decimal(layer, "offsety")?];
        let shift = [self.shift[0] + x, self.shift[1] + y];
        let mut says = Says::default();
        // The properties stand before all else.
        if let Some(mut inside) = xml.inside()
            && let Some(child) = inside.child()?
            && child.local_name().as_ref() == b"properties"
        {
            says = properties(&mut inside, rule)?;
        }
        let mut role = says.role();
        for name in ["class", "name"] {
            let named = xml.attribute(layer, name)?;
            role = role.or_else(|| rule.role(&named.unwrap_or_default()));
        }
        Ok(Self { shift, role: role.or(self.role) })
    }
}
