//! Colours of lines: by direction, by numbers, or their own; and their meaning.

use crate::sets::attributes::Of;
use crate::sets::{LineSet, arc_lengths_of};

/// The colour of unknown values: NaN, the direction of a dot.
pub const UNKNOWN: [u8; 3] = [160; 3];
/// The number that every set has, besides those of its attributes: the length of each line.
pub const LENGTH: &str = "length";

/// How lines are coloured.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Colouring {
    /// The colours of the set, if it has some.
    #[default]
    Own,
    /// The tangent: the sizes of its x, y and z are red, green and blue, as tractograms have it
    /// (Pajevic and Pierpaoli 1999).
    Direction,
    /// A number of vertices or lines, from blue over green to yellow: that of this name, [`LENGTH`]
    /// among them, or the first one.
    Scalar(Option<String>),
}

/// The meaning of colours.
#[derive(Debug, Clone, PartialEq)]
pub enum Legend {
    /// Nothing.
    Own,
    /// The tangent along x is red, along y green, along z blue.
    Direction,
    /// A number.
    Scalar {
        /// Its name.
        name: String,
        /// The least and the greatest value: those of the first and the last colour of [`viridis`].
        range: [f32; 2],
    },
}

/// A colour for each vertex, as bytes of sRGB, and their meaning.
#[derive(Debug, Clone, PartialEq)]
pub struct Colours {
    /// In the order of [`LineSet::points`].
    pub of_vertices: Vec<[u8; 3]>,
    /// Their meaning.
    pub legend: Legend,
}

/// There is no number of a name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the lines have no numbers \"{name}\"; they have {}", .known.join(", "))]
pub struct ColourError {
    /// The name that was asked for.
    pub name: String,
    /// The names that there are.
    pub known: Vec<String>,
}

impl LineSet {
    /// Colours of the vertices; none for [`Colouring::Own`] of a set that has no colours.
    ///
    /// Time and memory: proportional to the vertices and lines.
    ///
    /// # Errors
    /// The numbers are not there.
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
            Colouring::Scalar(name) => Some(self.by_scalar(name.as_deref())?),
        })
    }

    fn by_scalar(&self, name: Option<&str>) -> Result<Colours, ColourError> {
        let all = &self.attributes().scalars;
        let own = all.iter().find(|s| name.is_none_or(|n| n == s.name));
        let (name, of, values) = match own {
            Some(scalars) => (&*scalars.name, scalars.of, scalars.values.clone()),
            None if name.is_none_or(|n| n == LENGTH) => {
                let length = |line| arc_lengths_of(line).last().unwrap_or(0.0);
                (LENGTH, Of::Lines, self.iter().map(length).collect())
            }
            None => {
                let known = all.iter().map(|s| &*s.name).chain([LENGTH]).map(str::to_owned).collect();
                return Err(ColourError { name: name.unwrap_or_default().to_owned(), known });
            }
        };
        let known = || values.iter().copied().filter(|v| v.is_finite());
        let found = [known().fold(f32::INFINITY, f32::min), known().fold(f32::NEG_INFINITY, f32::max)];
        let range = if found[0] <= found[1] { found } else { [0.0; 2] };
        let [low, high] = range.map(f64::from);
        let colour = |value: &f32| match high - low {
            _ if value.is_nan() => UNKNOWN,
            0.0 => viridis(0.5),
            size => viridis(((f64::from(*value) - low) / size) as f32),
        };
        let colours: Vec<[u8; 3]> = values.iter().map(colour).collect();
        let of_vertices = match of {
            Of::Vertices => colours,
            Of::Lines => {
                let of_line = |(line, colour): (&[_], _)| std::iter::repeat_n(colour, line.len());
                self.iter().zip(colours).flat_map(of_line).collect()
            }
        };
        Ok(Colours { of_vertices, legend: Legend::Scalar { name: name.to_owned(), range } })
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

#[cfg(test)]
mod tests {
    use glam::{Vec3, vec3};

    use super::*;
    use crate::sets::attributes::{Attributes, Scalars};

    fn set() -> LineSet {
        let lines = [vec![Vec3::ZERO, vec3(-3.0, 0.0, 4.0)], vec![Vec3::Y], vec![Vec3::ZERO, Vec3::Y * 10.0]];
        let scalars =
            |name: &str, of, values: &[f32]| Scalars { name: name.into(), of, values: values.to_vec() };
        let scalars = vec![
            scalars("fa", Of::Vertices, &[1.0, 2.0, f32::NAN, 3.0, 5.0]),
            scalars("bundle", Of::Lines, &[7.0, 7.0, 7.0]),
        ];
        LineSet::new(lines).unwrap().with_attributes(Attributes { scalars, colours: None }).unwrap()
    }

    #[test]
    fn directions_are_red_green_and_blue_and_dots_have_none() {
        let colours = set().colours(&Colouring::Direction).unwrap().unwrap();
        let (slope, up) = ([153, 0, 204], [0, 255, 0]);
        assert_eq!(colours.of_vertices, [slope, slope, UNKNOWN, up, up]);
        assert_eq!(set().colours(&Colouring::Own), Ok(None));
    }

    #[test]
    fn numbers_run_through_the_map_within_their_range() {
        let scalar = |name: Option<&str>| Colouring::Scalar(name.map(str::to_owned));
        let of = |name| set().colours(&scalar(name)).unwrap().unwrap();
        let first = of(None);
        assert_eq!(first.legend, Legend::Scalar { name: "fa".into(), range: [1.0, 5.0] });
        let map = [viridis(0.0), viridis(0.25), UNKNOWN, viridis(0.5), viridis(1.0)];
        assert_eq!(first.of_vertices, map);
        assert_eq!(of(Some("bundle")).of_vertices, [viridis(0.5); 5]);
        let length = of(Some(LENGTH));
        assert_eq!(length.legend, Legend::Scalar { name: LENGTH.into(), range: [0.0, 10.0] });
        assert_eq!(length.of_vertices[..3], [viridis(0.5), viridis(0.5), viridis(0.0)]);
        let why = set().colours(&scalar(Some("md"))).unwrap_err().to_string();
        assert_eq!(why, "the lines have no numbers \"md\"; they have fa, bundle, length");
        let none = LineSet::default().colours(&scalar(None)).unwrap().unwrap();
        assert_eq!(none.legend, Legend::Scalar { name: LENGTH.into(), range: [0.0; 2] });
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
