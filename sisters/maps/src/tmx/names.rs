//! Which names and values in maps say that something blocks sight.

use super::element::{Element, finite};

/// What blocks sight, unless [`TmxImport::walls`](super::TmxImport::walls) says otherwise.
#[rustfmt::skip]
pub const WALLS: [&str; 16] = [
    "opaque", "wall", "walls", "occluder", "occluders", "occlusion", "blocks sight", "block sight",
    "blocks view", "block view", "blocks vision", "block vision", "blocks light", "block light", "blocks los", "block los",
];

/// Whether an object of a map hides what is behind it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Role {
    /// It hides nothing.
    #[default]
    Plain,
    /// It hides.
    Wall,
    /// It hides until it is opened.
    Door,
}

/// The names of walls and of doors, as names are compared.
#[derive(Debug)]
pub struct Rule([(Role, Vec<String>); 2]);

impl Rule {
    pub fn new(walls: &[String], doors: &[String]) -> Self {
        let names =
            |all: &[String]| all.iter().map(|name| plain(name)).filter(|name| !name.is_empty()).collect();
        Self([(Role::Door, names(doors)), (Role::Wall, names(walls))])
    }

    /// The role that a name gives, if it gives one.
    pub fn role(&self, name: &str) -> Option<Role> {
        let name = plain(name);
        let bare = name.trim_end_matches(|c: char| c.is_ascii_digit());
        let known = |names: &[String]| names.iter().any(|other| *other == name || other == bare);
        self.0.iter().find(|(_, names)| known(names)).map(|(role, _)| *role)
    }

    /// What the properties of an element say. One that is neither true nor false says nothing.
    pub fn properties(&self, of: Element<'_>) -> Says {
        let mut says = Says::default();
        for property in of.all("properties").flat_map(Element::children) {
            let kind = property.attribute("type").unwrap_or("string");
            let value =
                property.attribute("value").filter(|_| ["bool", "string", "int", "float"].contains(&kind));
            if let Some(role) = self.role(property.attribute("name").unwrap_or_default())
                && let Some(value) = value.and_then(truth)
            {
                says.add(role, value);
            }
        }
        says
    }
}

/// What properties say of an object: whether it is a wall, and a door.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Says([Option<bool>; 2]);

impl Says {
    /// Adds what a property with the name of a role says. Yes is stronger than no.
    pub fn add(&mut self, role: Role, says: bool) {
        let own = &mut self.0[usize::from(role == Role::Door)];
        *own = Some(says || *own == Some(true));
    }

    /// These, and others where they say nothing.
    pub fn or(self, others: Self) -> Self {
        Self([0, 1].map(|which| self.0[which].or(others.0[which])))
    }

    /// Whether it is a wall, be it a door or not.
    pub fn is_wall(self) -> bool {
        self.0[0] == Some(true)
    }

    /// The role, if anything is said of it: [`Role::Plain`] for a no.
    pub fn role(self) -> Option<Role> {
        match self.0 {
            [_, Some(true)] => Some(Role::Door),
            [Some(true), _] => Some(Role::Wall),
            [Some(false), _] => Some(Role::Plain),
            _ => None,
        }
    }
}

impl From<Option<Role>> for Says {
    /// What a name says: yes or nothing.
    fn from(role: Option<Role>) -> Self {
        let mut says = Self::default();
        role.into_iter().for_each(|role| says.add(role, true));
        says
    }
}

/// A name as names are compared.
pub fn plain(name: &str) -> String {
    name.chars().filter(|c| !matches!(c, ' ' | '_' | '-')).flat_map(char::to_lowercase).collect()
}

/// Whether a text says yes or no; `None` if it says neither.
fn truth(text: &str) -> Option<bool> {
    match text.trim().to_ascii_lowercase().as_str() {
        "true" | "yes" | "on" => Some(true),
        "false" | "no" | "off" => Some(false),
        number => finite(number).map(|number| number != 0.0),
    }
}
