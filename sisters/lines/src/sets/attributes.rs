//! Attributes of sets: numbers of vertices and of lines, and colours.

use std::ops::Range;

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

/// Numbers and colours of a [`LineSet`](super::LineSet).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Attributes {
    /// Numbers of vertices and of lines.
    pub scalars: Vec<Scalars>,
    /// The colour of each vertex as bytes of sRGB, if there are colours.
    pub colours: Option<Vec<[u8; 3]>>,
}

/// Not as many values as vertices or lines.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{name} has {values} values for {wanted} vertices or lines")]
pub struct AttributeError {
    /// The name of the numbers, or "colours".
    pub name: String,
    /// The number of values.
    pub values: usize,
    /// The number of vertices or lines.
    pub wanted: usize,
}

impl Attributes {
    /// Whether there are as many values as vertices and lines.
    pub(super) fn check(&self, vertices: usize, lines: usize) -> Result<(), AttributeError> {
        let count = |name: &str, values: usize, wanted: usize| match values == wanted {
            true => Ok(()),
            false => Err(AttributeError { name: name.to_owned(), values, wanted }),
        };
        for scalars in &self.scalars {
            let wanted = if scalars.of == Of::Vertices { vertices } else { lines };
            count(&scalars.name, scalars.values.len(), wanted)?;
        }
        self.colours.iter().try_for_each(|colours| count("colours", colours.len(), vertices))
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
        Self {
            scalars: self.scalars.iter().map(scalars).collect(),
            colours: self.colours.as_ref().map(|all| of_vertices().map(|v| all[v]).collect()),
        }
    }
}
