//! Sets of polylines.

use glam::Vec3;

use super::attributes::{AttributeError, Attributes};

/// The greatest number of vertices of a set.
pub const MOST_VERTICES: usize = 1 << 28;

/// Why lines were refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum LineError {
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} of line {line} is not finite")]
    NotFinite {
        /// The line, counted from 0.
        line: usize,
        /// The vertex of it, counted from 0.
        vertex: usize,
    },
    /// More than [`MOST_VERTICES`].
    #[error("more than {MOST_VERTICES} vertices")]
    TooMany,
}

/// Polylines, one after the other. Lines of one vertex are dots, lines without any show nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct LineSet {
    points: Vec<Vec3>,
    /// Where each line starts, and where the last one ends.
    starts: Vec<u32>,
    attributes: Attributes,
}

impl Default for LineSet {
    fn default() -> Self {
        Self { points: Vec::new(), starts: vec![0], attributes: Attributes::default() }
    }
}

impl LineSet {
    /// Takes up some lines.
    ///
    /// # Errors
    /// If a coordinate is not finite, or if there are too many vertices.
    pub fn new<L: IntoIterator<Item = Vec3>>(lines: impl IntoIterator<Item = L>) -> Result<Self, LineError> {
        let mut set = Self::default();
        lines.into_iter().try_for_each(|line| set.push(line))?;
        Ok(set)
    }

    /// Adds a line to a set without attributes.
    ///
    /// # Errors
    /// As [`Self::new`]; the set is as it was then.
    pub(crate) fn push(&mut self, line: impl IntoIterator<Item = Vec3>) -> Result<(), LineError> {
        let from = self.points.len();
        for point in line {
            let why = match self.points.len() < MOST_VERTICES {
                true if point.is_finite() => None,
                true => Some(LineError::NotFinite { line: self.len(), vertex: self.points.len() - from }),
                false => Some(LineError::TooMany),
            };
            if let Some(why) = why {
                self.points.truncate(from);
                return Err(why);
            }
            self.points.push(point);
        }
        self.starts.push(self.points.len() as u32);
        Ok(())
    }

    /// The same lines with these attributes instead of theirs.
    ///
    /// # Errors
    /// If there are not as many values as vertices and lines.
    pub fn with_attributes(self, attributes: Attributes) -> Result<Self, AttributeError> {
        attributes.check(self.points.len(), self.len())?;
        Ok(Self { attributes, ..self })
    }

    /// Numbers and colours.
    pub fn attributes(&self) -> &Attributes {
        &self.attributes
    }

    /// The lines that `keep` says yes to, with their attributes. It is given the number of a line
    /// and its vertices.
    pub fn chosen(&self, mut keep: impl FnMut(usize, &[Vec3]) -> bool) -> Self {
        let ranges = self.starts.windows(2).map(|w| w[0] as usize..w[1] as usize).enumerate();
        let kept: Vec<_> = ranges.filter(|(line, r)| keep(*line, &self.points[r.clone()])).collect();
        let mut starts = vec![0];
        let mut points = Vec::new();
        for (_, range) in &kept {
            points.extend_from_slice(&self.points[range.clone()]);
            starts.push(points.len() as u32);
        }
        Self { attributes: self.attributes.chosen(&kept), points, starts }
    }

    /// The number of lines.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there is no line.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The vertices of all lines.
    pub fn points(&self) -> &[Vec3] {
        &self.points
    }

    /// The vertices of each line.
    pub fn iter(&self) -> impl Iterator<Item = &[Vec3]> {
        self.starts.windows(2).map(|w| &self.points[w[0] as usize..w[1] as usize])
    }

    /// For each segment its line and the index of its first vertex in [`Self::points`]; a dot is a
    /// segment without length, whose two ends are one vertex.
    pub fn segments(&self) -> impl Iterator<Item = Segment> {
        self.starts.windows(2).enumerate().flat_map(|(line, w)| {
            let (from, to) = (w[0], w[1]);
            let last = if to - from == 1 { to } else { to.saturating_sub(1) };
            (from..last).map(move |a| Segment { line: line as u32, a, b: (a + 1).min(to - 1) })
        })
    }

    /// The smallest box around all vertices; the origin if there is none.
    pub fn bounds(&self) -> [Vec3; 2] {
        let Some(&first) = self.points.first() else { return [Vec3::ZERO; 2] };
        self.points.iter().fold([first; 2], |[min, max], p| [min.min(*p), max.max(*p)])
    }

    /// The unit tangent at each vertex: the central difference, one-sided at the ends; zero where
    /// neighbours coincide.
    pub fn tangents(&self) -> Vec<Vec3> {
        let of = |line: &[Vec3], i: usize| {
            let (before, after) = (line[i.saturating_sub(1)], line[(i + 1).min(line.len() - 1)]);
            (after.as_dvec3() - before.as_dvec3()).normalize_or_zero().as_vec3()
        };
        self.iter().flat_map(|line| (0..line.len()).map(move |i| of(line, i))).collect()
    }

    /// The way along its line from the first vertex to each vertex.
    pub fn arc_lengths(&self) -> Vec<f32> {
        self.iter().flat_map(arc_lengths_of).collect()
    }
}

/// The way along a line from its first vertex to each vertex.
pub(crate) fn arc_lengths_of(line: &[Vec3]) -> impl Iterator<Item = f32> {
    let mut way = 0.0;
    let mut last = line.first().copied().unwrap_or_default();
    line.iter().map(move |p| {
        way += p.as_dvec3().distance(last.as_dvec3());
        last = *p;
        way as f32
    })
}

/// A segment of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Segment {
    /// The line, counted from 0.
    pub line: u32,
    /// The index of its first end in [`LineSet::points`].
    pub a: u32,
    /// The index of its second end; that of the first one on dots.
    pub b: u32,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sets::attributes::{Of, Scalars};

    #[test]
    fn lines_have_tangents_lengths_and_segments_and_bad_ones_are_named() {
        let v = Vec3::new;
        let corner = [v(0.0, 0.0, 0.0), v(3.0, 0.0, 0.0), v(3.0, 4.0, 0.0)];
        let mut set = LineSet::new([corner.to_vec(), vec![], vec![Vec3::ONE]]).unwrap();
        assert_eq!((set.len(), set.bounds()), (3, [Vec3::ZERO, v(3.0, 4.0, 1.0)]));
        assert_eq!(set.tangents(), [Vec3::X, v(0.6, 0.8, 0.0), Vec3::Y, Vec3::ZERO]);
        assert_eq!(set.arc_lengths(), [0.0, 3.0, 7.0, 0.0]);
        let ends: Vec<_> = set.segments().map(|s| (s.line, s.a, s.b)).collect();
        assert_eq!(ends, [(0, 0, 1), (0, 1, 2), (2, 3, 3)]);
        let old = set.clone();
        let bad = set.push([Vec3::ZERO, v(0.0, f32::NAN, 0.0)]);
        assert_eq!(bad, Err(LineError::NotFinite { line: 3, vertex: 1 }));
        assert_eq!(set, old);
    }

    #[test]
    fn attributes_follow_chosen_lines_and_wrong_counts_are_refused() {
        let set = LineSet::new([vec![Vec3::ZERO, Vec3::X], vec![], vec![Vec3::Y]]).unwrap();
        let scalars = |of, values: &[f32]| Scalars { name: "s".into(), of, values: values.to_vec() };
        let all = Attributes {
            scalars: vec![scalars(Of::Vertices, &[1.0, 2.0, 3.0]), scalars(Of::Lines, &[7.0, 8.0, 9.0])],
            colours: Some(vec![[1; 3], [2; 3], [3; 3]]),
        };
        let set = set.with_attributes(all).unwrap();
        let last = set.chosen(|line, points| line == 2 && points.len() == 1);
        assert_eq!(last.points(), [Vec3::Y]);
        let wanted = Attributes {
            scalars: vec![scalars(Of::Vertices, &[3.0]), scalars(Of::Lines, &[9.0])],
            colours: Some(vec![[3; 3]]),
        };
        assert_eq!(*last.attributes(), wanted);
        let short = Attributes { scalars: vec![scalars(Of::Lines, &[1.0])], ..Default::default() };
        assert!(set.with_attributes(short).is_err());
    }
}
