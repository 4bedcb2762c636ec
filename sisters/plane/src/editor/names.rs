//! Which names and values in maps say that something blocks sight.

use std::collections::BTreeSet;

use super::Role;

/// What blocks sight.
const WALLS: [&str; 16] = [
    "opaque",
    "wall",
    "walls",
    "occluder",
    "occluders",
    "occlusion",
    "blocks sight",
    "block sight",
    "blocks view",
    "block view",
    "blocks vision",
    "block vision",
    "blocks light",
    "block light",
    "blocks los",
    "block los",
];

/// What blocks the way.
const OBSTACLES: [&str; 21] = [
    "collision",
    "collisions",
    "collide",
    "collides",
    "collider",
    "colliders",
    "collidable",
    "solid",
    "solids",
    "block",
    "blocks",
    "blocked",
    "blocking",
    "blocker",
    "blockers",
    "obstacle",
    "obstacles",
    "obstruction",
    "impassable",
    "unwalkable",
    "barrier",
];

/// The names that say what hides, of layers, properties and classes. Capitals, blanks, `_`, `-` and
/// a number at the end of a name in a map do not count: `Walls 2` is `walls`. A property says yes
/// with `true`, `yes`, `on` and numbers but 0, and no with `false`, `no`, `off` and 0.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MapNames {
    /// What blocks sight; at first `opaque`, `wall`, `walls`, `occluder`, `occluders`,
    /// `occlusion`, and `blocks` or `block` before `sight`, `view`, `vision`, `light` and `los`.
    pub walls: Vec<String>,
    /// What blocks the way. It blocks sight, with a warning, only in maps in which nothing is a
    /// wall by the names above; never if the list is empty. At first `collision`, `solid`,
    /// `blocked`, `obstacle` and the like.
    pub obstacles: Vec<String>,
    /// What hides until it is opened; at first `door` and `doors`.
    pub doors: Vec<String>,
}

impl Default for MapNames {
    fn default() -> Self {
        let owned = |all: &[&str]| all.iter().map(|&name| name.to_owned()).collect();
        Self { walls: owned(&WALLS), obstacles: owned(&OBSTACLES), doors: owned(&["door", "doors"]) }
    }
}

/// The names of walls and of doors that count while a map is read.
#[derive(Debug)]
pub(crate) struct Rule([Vec<String>; 2]);

/// The two roles that names give, in the order in which lists of two have them.
const ROLES: [Role; 2] = [Role::Wall, Role::Door];

impl Rule {
    pub fn new(walls: &[String], doors: &[String]) -> Self {
        Self(
            [walls, doors]
                .map(|names| names.iter().map(|name| plain(name)).filter(|name| !name.is_empty()).collect()),
        )
    }

    /// The role that a name gives, if it gives one.
    pub fn role(&self, name: &str) -> Option<Role> {
        let name = plain(name);
        let known = |names: &Vec<String>| {
            names.contains(&name)
                || names.iter().any(|n| n == name.trim_end_matches(|c: char| c.is_ascii_digit()))
        };
        (0..2).rev().find(|&which| known(&self.0[which])).map(|which| ROLES[which])
    }
}

/// What properties say of an object: whether it is a wall, and a door.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Says([Option<bool>; 2]);

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
pub(crate) fn plain(name: &str) -> String {
    name.chars().filter(|c| !matches!(c, ' ' | '_' | '-')).flat_map(char::to_lowercase).collect()
}

/// Whether a text says yes or no; `None` if it says neither.
pub(crate) fn truth(text: &str) -> Option<bool> {
    match text.trim().to_ascii_lowercase().as_str() {
        "true" | "yes" | "on" => Some(true),
        "false" | "no" | "off" => Some(false),
        number => number.parse().ok().map(|number: f64| number != 0.0),
    }
}

/// The layers of a map, and the names in it that might have said what blocks: as many as a warning
/// shows.
#[derive(Debug, Clone, Default)]
pub(crate) struct Inventory([BTreeSet<String>; 2]);

/// Names that a warning shows, of each kind, and letters of a name.
const MOST_NAMES: usize = 12;
const MOST_LETTERS: usize = 40;

impl Inventory {
    pub fn add_layer(&mut self, name: &str) {
        self.add(0, name);
    }

    pub fn add_name(&mut self, name: &str) {
        self.add(1, name);
    }

    fn add(&mut self, kind: usize, name: &str) {
        if !name.is_empty() && self.0[kind].len() < MOST_NAMES {
            self.0[kind].insert(name.chars().take(MOST_LETTERS).collect());
        }
    }

    pub fn extend(&mut self, other: &Self) {
        (0..2).for_each(|kind| other.0[kind].iter().for_each(|name| self.add(kind, name)));
    }

    /// Layers, and other names.
    pub fn lists(self) -> [Vec<String>; 2] {
        self.0.map(|names| names.into_iter().collect())
    }

    /// The names that make walls by a rule.
    pub fn walls(self, rule: &Rule) -> Vec<String> {
        let all = self.lists().concat();
        all.into_iter().filter(|name| rule.role(name) == Some(Role::Wall)).collect()
    }
}

fn quoted(names: &[String]) -> String {
    match names {
        [] => "none".to_owned(),
        names => names.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", "),
    }
}

/// Says that nothing blocks, what is there, and what to do.
pub(crate) fn nothing_blocks([layers, others]: [&[String]; 2]) -> String {
    let [layers, others] = [layers, others].map(quoted);
    format!(
        "nothing blocks sight. Layers: {layers}. Properties and classes: {others}. What hides are layers named \"walls\", and what \
         has the class \"wall\" or a property \"opaque\" that is true"
    )
}

/// Says that obstacles count.
pub(crate) fn obstacles_block(names: &[String]) -> String {
    format!(
        "nothing is named as a wall, so what blocks the way blocks sight, too: {}. Name what hides \"wall\" or \
         \"opaque\", or empty MapNames::obstacles",
        quoted(names)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_compared_without_capitals_blanks_and_numbers() {
        let names = MapNames::default();
        let rule = Rule::new(&names.walls, &names.doors);
        for name in ["walls", "Walls", "WALL", "Walls 2", "wall_3", "Opaque", "BlocksSight", "blocks_sight"] {
            assert_eq!(rule.role(name), Some(Role::Wall), "{name}");
        }
        for name in ["Door", "DOORS", "door-1"] {
            assert_eq!(rule.role(name), Some(Role::Door), "{name}");
        }
        for name in ["", "2", "wallpaper", "firewall", "Ground", "Collision", "no wall"] {
            assert_eq!(rule.role(name), None, "{name}");
        }
        let obstacles = Rule::new(&names.obstacles, &[]);
        assert_eq!(obstacles.role("Collisions 1"), Some(Role::Wall));
        let own = Rule::new(&["Tile Layer 1".into()], &[]);
        assert_eq!((own.role("tile layer 1"), own.role("Tile Layer 2")), (Some(Role::Wall), None));
    }

    #[test]
    fn values_say_yes_no_or_nothing() {
        for (text, says) in
            [("True", Some(true)), (" yes", Some(true)), ("1", Some(true)), ("0", Some(false))]
        {
            assert_eq!(truth(text), says, "{text}");
        }
        for (text, says) in [("FALSE", Some(false)), ("no", Some(false)), ("", None), ("maybe", None)] {
            assert_eq!(truth(text), says, "{text}");
        }
        let mut says = Says::default();
        says.add(Role::Wall, true);
        says.add(Role::Wall, false);
        assert_eq!(says.role(), Some(Role::Wall), "yes is stronger");
    }
}
