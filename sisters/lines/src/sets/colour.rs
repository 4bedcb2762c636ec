//! Colours of lines: by direction, by numbers, by groups, or their own; and their meaning.

use crate::sets::LineSet;
use crate::sets::attributes::{NO_GROUP, Of};

/// The colour of unknown values: NaN, a line in no group, the direction of a dot.
pub const UNKNOWN: [u8; 3] = [160; 3];
/// The number that every set has, besides those of its attributes: the length of each line.
pub const LENGTH: &str = "length";
/// Turns of the circle of hues from one group to the next: the golden ratio, so that the hues of
/// any first groups lie far from each other.
const HUE_STEP: f64 = 0.618_033_988_749_895;

/// How lines are coloured.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Colouring {
    /// The colours of the set, if it has some.
    #[default]
    Own,
    /// The tangent: the sizes of its x, y and z are red, green and blue, as tractograms have it
    /// (Pajevic and Pierpaoli 1999).
    Direction,
    /// A number of vertices or lines, from blue over green to yellow.
    Scalar {
        /// Its name, [`LENGTH`] among them; the first one if there is none.
        name: Option<String>,
        /// The values of the first and the last colour; the least and the greatest if there are
        /// none. Values beyond have the colours of the ends.
        range: Option<[f32; 2]>,
    },
    /// The group of a line.
    Group,
}

/// The meaning of colours.
#[derive(Debug, Clone, PartialEq)]
pub enum Legend {
    /// Nothing.
    Own,
    /// The tangent along x is red, along y green, along z blue.
    Direction,
    /// A number, with the values of the first and the last colour of [`viridis`].
    Scalar {
        /// Its name.
        name: String,
        /// The values of the first and the last colour.
        range: [f32; 2],
    },
    /// Groups that have lines, by their names.
    Groups(Vec<(String, [u8; 3])>),
}

/// A colour for each vertex, as bytes of sRGB, and their meaning.
#[derive(Debug, Clone, PartialEq)]
pub struct Colours {
    /// In the order of [`LineSet::points`].
    pub of_vertices: Vec<[u8; 3]>,
    /// Their meaning.
    pub legend: Legend,
}

/// Why lines have no such colours.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ColourError {
    /// There is no number of that name.
    #[error("the lines have no numbers \"{name}\"; they have {}", .known.join(", "))]
    NoScalar {
        /// The name that was asked for.
        name: String,
        /// The names that there are.
        known: Vec<String>,
    },
    /// The lines are in no groups.
    #[error("the lines are in no groups")]
    NoGroups,
    /// A value of the range is not finite.
    #[error("a range from {0} to {1}: both must be finite")]
    Range(f32, f32),
}

impl LineSet {
    /// Colours of the vertices; none for [`Colouring::Own`] of a set that has no colours.
    ///
    /// Time and memory: proportional to the vertices and lines.
    ///
    /// # Errors
    /// The numbers or groups are not there, or the range is not finite.
    pub fn colours(&self, by: &Colouring) -> Result<Option<Colours>, ColourError> {
        Ok(match by {
            Colouring::Own => {
                let own = self.attributes().colours.clone();
                own.map(|of_vertices| Colours { of_vertices, legend: Legend::Own })
            }
            Colouring::Direction => {
                let byte = |t: f32| (t.abs() * 255.0).round() as u8;
                let colour = |t: &glam::Vec3| match *t == glam::Vec3::ZERO {
                    true => UNKNOWN,
                    false => t.to_array().map(byte),
                };
                let of_vertices = self.tangents().iter().map(colour).collect();
                Some(Colours { of_vertices, legend: Legend::Direction })
            }
            Colouring::Scalar { name, range } => Some(self.by_scalar(name.as_deref(), *range)?),
            Colouring::Group => Some(self.by_group()?),
        })
    }

    /// The names of the numbers that lines can be coloured by.
    pub fn scalar_names(&self) -> Vec<String> {
        let own = self.attributes().scalars.iter().map(|s| s.name.clone());
        own.chain([LENGTH.to_owned()]).collect()
    }

    fn by_scalar(&self, name: Option<&str>, range: Option<[f32; 2]>) -> Result<Colours, ColourError> {
        if let Some([low, high]) = range.filter(|r| !r.iter().all(|v| v.is_finite())) {
            return Err(ColourError::Range(low, high));
        }
        let own = self.attributes().scalars.iter().find(|s| name.is_none_or(|n| n == s.name));
        let (name, of, values) = match own {
            Some(scalars) => (&*scalars.name, scalars.of, scalars.values.clone()),
            None if name.is_none_or(|n| n == LENGTH) => (LENGTH, Of::Lines, self.lengths()),
            None => {
                let name = name.unwrap_or_default().to_owned();
                return Err(ColourError::NoScalar { name, known: self.scalar_names() });
            }
        };
        let known = || values.iter().copied().filter(|v| v.is_finite());
        let found = [known().fold(f32::INFINITY, f32::min), known().fold(f32::NEG_INFINITY, f32::max)];
        let range = range.unwrap_or(if found[0] <= found[1] { found } else { [0.0; 2] });
        let [low, high] = range.map(f64::from);
        let colour = |value: &f32| match high - low {
            _ if value.is_nan() => UNKNOWN,
            0.0 => viridis(0.5),
            size => viridis(((f64::from(*value) - low) / size) as f32),
        };
        let colours: Vec<[u8; 3]> = values.iter().map(colour).collect();
        let of_vertices = if of == Of::Vertices { colours } else { self.spread(&colours) };
        Ok(Colours { of_vertices, legend: Legend::Scalar { name: name.to_owned(), range } })
    }

    fn by_group(&self) -> Result<Colours, ColourError> {
        let groups = self.attributes().groups.as_ref().ok_or(ColourError::NoGroups)?;
        let of_line = |g: &u32| if *g == NO_GROUP { UNKNOWN } else { hue(*g) };
        let colours: Vec<[u8; 3]> = groups.of.iter().map(of_line).collect();
        let mut used = vec![false; groups.names.len()];
        groups.of.iter().filter(|g| **g != NO_GROUP).for_each(|g| used[*g as usize] = true);
        let named = (0..).zip(&groups.names).zip(used).filter(|(_, used)| *used);
        let mut named: Vec<_> = named.map(|((i, name), _)| (name.clone(), hue(i))).collect();
        if groups.of.contains(&NO_GROUP) {
            named.push(("in no group".to_owned(), UNKNOWN));
        }
        Ok(Colours { of_vertices: self.spread(&colours), legend: Legend::Groups(named) })
    }

    /// A value of each line at all of its vertices.
    fn spread(&self, values: &[[u8; 3]]) -> Vec<[u8; 3]> {
        self.iter().zip(values).flat_map(|(line, value)| std::iter::repeat_n(*value, line.len())).collect()
    }

    fn lengths(&self) -> Vec<f32> {
        let step = |pair: &[glam::Vec3]| pair[1].as_dvec3().distance(pair[0].as_dvec3());
        self.iter().map(|line| line.windows(2).map(step).sum::<f64>() as f32).collect()
    }
}

/// The map of colours viridis (Smith and van der Walt 2015, of matplotlib) from 0 to 1, by the
/// polynomials of Zucker (2019, <https://www.shadertoy.com/view/WlfXRN>, public domain): no byte is
/// more than 4 off. Values beyond have the colours of the ends.
pub fn viridis(t: f32) -> [u8; 3] {
    const POWERS: [[f64; 3]; 7] = [
        [0.2777273272234177, 0.005407344544966578, 0.3340998053353061],
        [0.1050930431085774, 1.404613529898575, 1.384590162594685],
        [-0.3308618287255563, 0.214847559468213, 0.09509516302823659],
        [-4.634230498983486, -5.799100973351585, -19.33244095627987],
        [6.228269936347081, 14.17993336680509, 56.69055260068105],
        [4.776384997670288, -13.74514537774601, -65.35303263337234],
        [-5.435455855934631, 4.645852612178535, 26.3124352495832],
    ];
    let t = f64::from(t.clamp(0.0, 1.0));
    let value = |c: usize| POWERS.iter().rev().fold(0.0, |sum, power| sum * t + power[c]);
    [0, 1, 2].map(|c| (value(c).clamp(0.0, 1.0) * 255.0).round() as u8)
}

/// A colour for each number, those of near numbers unlike each other.
fn hue(number: u32) -> [u8; 3] {
    let turn = (f64::from(number) * HUE_STEP).fract() * 6.0;
    // Every second one is darker.
    let light = if number.is_multiple_of(2) { 0.90 } else { 0.66 };
    let part = |shift: f64| {
        let k = (shift + turn) % 6.0;
        let dim = k.min(4.0 - k).clamp(0.0, 1.0);
        (light * (1.0 - 0.75 * dim) * 255.0).round() as u8
    };
    [5.0, 3.0, 1.0].map(part)
}

#[cfg(test)]
mod tests {
    use glam::{Vec3, vec3};

    use super::*;
    use crate::sets::attributes::{Attributes, Groups, Scalars};

    fn set() -> LineSet {
        let lines = [vec![Vec3::ZERO, vec3(-3.0, 0.0, 4.0)], vec![Vec3::Y], vec![Vec3::ZERO, Vec3::Y * 10.0]];
        let scalars =
            |name: &str, of, values: &[f32]| Scalars { name: name.into(), of, values: values.to_vec() };
        let attributes = Attributes {
            scalars: vec![
                scalars("fa", Of::Vertices, &[1.0, 2.0, f32::NAN, 3.0, 5.0]),
                scalars("bundle", Of::Lines, &[7.0, 7.0, 7.0]),
            ],
            colours: None,
            groups: Some(Groups { names: vec!["left".into(), "right".into()], of: vec![1, NO_GROUP, 0] }),
        };
        LineSet::new(lines).unwrap().with_attributes(attributes).unwrap()
    }

    fn scalar(name: Option<&str>, range: Option<[f32; 2]>) -> Colouring {
        Colouring::Scalar { name: name.map(str::to_owned), range }
    }

    #[test]
    fn directions_are_red_green_and_blue_and_dots_have_none() {
        let colours = set().colours(&Colouring::Direction).unwrap().unwrap();
        let (slope, up) = ([153, 0, 204], [0, 255, 0]);
        assert_eq!(colours.of_vertices, [slope, slope, UNKNOWN, up, up]);
    }

    #[test]
    fn numbers_run_through_the_map_within_their_range() {
        let set = set();
        let of = |by: &Colouring| set.colours(by).unwrap().unwrap();
        let first = of(&scalar(None, None));
        assert_eq!(first.legend, Legend::Scalar { name: "fa".into(), range: [1.0, 5.0] });
        let map = [viridis(0.0), viridis(0.25), UNKNOWN, viridis(0.5), viridis(1.0)];
        assert_eq!(first.of_vertices, map);
        let narrow = of(&scalar(Some("fa"), Some([3.0, 1.0]))).of_vertices;
        assert_eq!(narrow, [viridis(1.0), viridis(0.5), UNKNOWN, viridis(0.0), viridis(0.0)]);
        assert_eq!(of(&scalar(Some("bundle"), None)).of_vertices, [viridis(0.5); 5]);
        let length = of(&scalar(Some(LENGTH), None));
        assert_eq!(length.legend, Legend::Scalar { name: LENGTH.into(), range: [0.0, 10.0] });
        assert_eq!(length.of_vertices[..3], [viridis(0.5), viridis(0.5), viridis(0.0)]);
        let why = set.colours(&scalar(Some("md"), None)).unwrap_err().to_string();
        assert_eq!(why, "the lines have no numbers \"md\"; they have fa, bundle, length");
        let range = set.colours(&scalar(None, Some([0.0, f32::NAN])));
        assert!(matches!(range, Err(ColourError::Range(..))));
        let none = LineSet::default().colours(&scalar(None, None)).unwrap().unwrap();
        assert_eq!(none.legend, Legend::Scalar { name: LENGTH.into(), range: [0.0; 2] });
    }

    #[test]
    fn groups_have_colours_far_from_each_other() {
        let colours = set().colours(&Colouring::Group).unwrap().unwrap();
        let Legend::Groups(named) = &colours.legend else { panic!("groups") };
        let (left, right) = (named[0].1, named[1].1);
        assert_eq!(named.iter().map(|n| &*n.0).collect::<Vec<_>>(), ["left", "right", "in no group"]);
        assert_eq!(colours.of_vertices, [right, right, UNKNOWN, left, left]);
        // A group keeps its colour where others lose all lines.
        let chosen = set().chosen(|line, _| line == 0).colours(&Colouring::Group).unwrap().unwrap();
        assert_eq!(chosen.legend, Legend::Groups(vec![("right".to_owned(), right)]));
        let apart = |a: [u8; 3], b: [u8; 3]| (0..3).map(|c| u32::from(a[c].abs_diff(b[c]))).sum::<u32>();
        for i in 0..8 {
            (0..i).for_each(|j| assert!(apart(hue(i), hue(j)) > 60, "{i}, {j}: {:?} {:?}", hue(i), hue(j)));
        }
        assert_eq!(LineSet::default().colours(&Colouring::Group), Err(ColourError::NoGroups));
        assert_eq!(set().colours(&Colouring::Own), Ok(None));
    }

    /// Colours of the table of matplotlib.
    #[test]
    fn the_map_is_that_of_matplotlib() {
        let table = [
            (0.0, [68, 1, 84]),
            (0.25, [59, 82, 139]),
            (0.5, [33, 145, 140]),
            (0.75, [94, 201, 98]),
            (1.0, [253, 231, 37]),
        ];
        for (t, wanted) in table {
            let got = viridis(t);
            assert!((0..3).all(|c| got[c].abs_diff(wanted[c]) <= 4), "{t}: {got:?}");
        }
        assert_eq!((viridis(-9.0), viridis(f32::INFINITY)), (viridis(0.0), viridis(1.0)));
    }
}
