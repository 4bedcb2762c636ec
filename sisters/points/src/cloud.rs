//! A point cloud in memory.

use bitvec::slice::BitSlice;
use glam::{DVec3, Vec3};

/// Points with their attributes. A vector of an attribute that no point has is empty; all others
/// have one entry for each point.
///
/// Coordinates of surveys are millions of metres, which single precision resolves to half a metre.
/// So positions are relative to an origin in double precision.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PointCloud {
    /// The place that positions are relative to.
    pub origin: DVec3,
    /// Positions minus the origin, in the units of the source, usually metres.
    pub positions: Vec<Vec3>,
    /// Red, green and blue from 0 to 255.
    pub colours: Vec<[u8; 3]>,
    /// Normals of the surface, of any length; one that is zero or not finite is not known.
    pub normals: Vec<Vec3>,
    /// The radius of the disc that stands for the point, in the units of the positions.
    pub radii: Vec<f32>,
}

/// An attribute that not all points have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("there are {given} {attribute} for {points} points; give one for each point, or none")]
pub struct LengthError {
    /// "colours", "normals" or "radii".
    pub attribute: &'static str,
    /// Its entries.
    pub given: usize,
    /// The number of positions.
    pub points: usize,
}

impl PointCloud {
    /// The number of points.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Positions in the coordinates of the source: origin added, in double precision.
    pub fn world_positions(&self) -> impl Iterator<Item = DVec3> {
        self.positions.iter().map(|p| self.origin + p.as_dvec3())
    }

    /// The points whose bits are set, with their attributes. Points without a bit are left out.
    pub fn subset(&self, chosen: &BitSlice) -> Self {
        fn some<T: Copy>(all: &[T], chosen: &BitSlice) -> Vec<T> {
            chosen.iter_ones().map_while(|i| all.get(i)).copied().collect()
        }
        Self {
            origin: self.origin,
            positions: some(&self.positions, chosen),
            colours: some(&self.colours, chosen),
            normals: some(&self.normals, chosen),
            radii: some(&self.radii, chosen),
        }
    }

    /// Checks that each attribute has no entry or one for each point.
    ///
    /// # Errors
    /// Names the first attribute that has another number.
    pub fn check(&self) -> Result<(), LengthError> {
        let points = self.len();
        let lengths =
            [("colours", self.colours.len()), ("normals", self.normals.len()), ("radii", self.radii.len())];
        match lengths.into_iter().find(|&(_, given)| given != 0 && given != points) {
            Some((attribute, given)) => Err(LengthError { attribute, given, points }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bitvec::vec::BitVec;

    #[test]
    fn an_attribute_of_some_points_only_is_an_error() {
        let mut cloud =
            PointCloud { positions: vec![Vec3::ONE; 3], radii: vec![0.1; 3], ..Default::default() };
        assert_eq!(cloud.check(), Ok(()));
        cloud.normals.push(Vec3::X);
        assert_eq!(cloud.check(), Err(LengthError { attribute: "normals", given: 1, points: 3 }));
    }

    #[test]
    fn a_subset_keeps_the_attributes_that_there_are() {
        let positions = vec![Vec3::X, Vec3::Y, Vec3::Z];
        let cloud = PointCloud { positions, colours: vec![[1; 3], [2; 3], [3; 3]], ..Default::default() };
        let some = cloud.subset(&[true, false, true, true].into_iter().collect::<BitVec>());
        assert_eq!((some.positions, some.colours), (vec![Vec3::X, Vec3::Z], vec![[1; 3], [3; 3]]));
        assert!(some.radii.is_empty());
    }
}
