//! Attributes of sets: numbers of vertices and of lines, colours, and groups.

use std::ops::Range;

/// The group of a line that is in none.
pub const NO_GROUP: u32 = u32::MAX;

/// Whether values belong to vertices or lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Of {
    /// Each vertex has a value.
    Vertices,
    /// Each line has a value.
    Lines,
}

/// Numbers with a name.
#[derive(Debug, Clone, PartialEq)]
pub struct Scalars {
    /// The name, as the file has it.
    pub name: String,
    /// Whether they belong to vertices or lines.
    pub of: Of,
    /// The values, in the order of vertices or lines. NaN is a value that is not known.
    pub values: Vec<f32>,
}

/// Groups of lines, such as bundles of a tractogram.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Groups {
    /// Their names.
    pub names: Vec<String>,
    /// The group of each line, an index of `names` or [`NO_GROUP`].
    pub of: Vec<u32>,
}

/// Numbers, colours and groups of a [`LineSet`](super::LineSet).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Attributes {
    /// Numbers of vertices and of lines.
    pub scalars: Vec<Scalars>,
    /// The colour of each vertex as bytes of sRGB, if there are colours.
    pub colours: Option<Vec<[u8; 3]>>,
    /// The groups, if there are any.
    pub groups: Option<Groups>,
}

/// Why attributes were refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum AttributeError {
    /// Not as many values as vertices or lines.
    #[error("{name} has {values} values for {wanted} vertices or lines")]
    Count {
        /// The name of the numbers, "colours" or "groups".
        name: String,
        /// The number of values.
        values: usize,
        /// The number of vertices or lines.
        wanted: usize,
    },
    /// A line is in a group that there is not.
    #[error("there is no group {0}")]
    NoGroup(u32),
}

impl Attributes {
    /// Whether there are as many values as vertices and lines.
    pub(super) fn check(&self, vertices: usize, lines: usize) -> Result<(), AttributeError> {
        let count = |name: &str, values: usize, wanted: usize| match values == wanted {
            true => Ok(()),
            false => Err(AttributeError::Count { name: name.to_owned(), values, wanted }),
        };
        for scalars in &self.scalars {
            let wanted = if scalars.of == Of::Vertices { vertices } else { lines };
            count(&scalars.name, scalars.values.len(), wanted)?;
        }
        if let Some(colours) = &self.colours {
            count("colours", colours.len(), vertices)?;
        }
        let Some(groups) = &self.groups else { return Ok(()) };
        count("groups", groups.of.len(), lines)?;
        let known = |g: &u32| *g == NO_GROUP || (*g as usize) < groups.names.len();
        match groups.of.iter().find(|g| !known(g)) {
            Some(&group) => Err(AttributeError::NoGroup(group)),
            None => Ok(()),
        }
    }

    /// Those of some lines, by their numbers and the vertices of each.
    pub(super) fn chosen(&self, lines: &[(usize, Range<usize>)]) -> Self {
        let of_vertices = || lines.iter().flat_map(|(_, vertices)| vertices.clone());
        let scalars = |s: &Scalars| {
            let values = match s.of {
                Of::Vertices => of_vertices().map(|v| s.values[v]).collect(),
                Of::Lines => lines.iter().map(|(line, _)| s.values[*line]).collect(),
            };
            Scalars { name: s.name.clone(), of: s.of, values }
        };
        let groups = |g: &Groups| Groups {
            names: g.names.clone(),
            of: lines.iter().map(|(line, _)| g.of[*line]).collect(),
        };
        Self {
            scalars: self.scalars.iter().map(scalars).collect(),
            colours: self.colours.as_ref().map(|all| of_vertices().map(|v| all[v]).collect()),
            groups: self.groups.as_ref().map(groups),
        }
    }
}
