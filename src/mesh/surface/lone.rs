//! Lone triangles of packed surfaces, and where the patches of those are stored.

use glam::{DVec3, Vec3};

use crate::mesh::surface::index::PatchIndex;
use crate::numeric::mesh::{SINE, SLAB};
use crate::numeric::{greater, lesser};

/// The slab of a patch.
pub(crate) struct Slab {
    pub(crate) normal: DVec3,
    pub(crate) lo: f64,
    pub(crate) hi: f64,
    pub(crate) slack: f32,
}

/// The direction of the cross product of two sides.
pub(super) fn direction(cross: DVec3) -> DVec3 {
    cross.normalize_or(DVec3::Z)
}

/// The sine of an angle of which a cosine is known, rounded up.
pub(super) fn sine(cosine: f64) -> f32 {
    let sine = if cosine > 0.0 { (1.0 - cosine * cosine).max(0.0).sqrt() + SINE } else { 1.0 };
    (sine.min(1.0) as f32).next_up().min(1.0)
}

/// A triangle whose outline starts at one of its corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lone(u32);

impl Lone {
    pub(super) fn new(triangle: u32, start: u32) -> Self {
        Self(triangle << 2 | start)
    }

    #[inline]
    pub(super) fn triangle(self) -> usize {
        (self.0 >> 2) as usize
    }

    /// Its corners in the order of its outline.
    #[inline]
    pub(super) fn ring(self, triangles: &[[u32; 3]]) -> [u32; 3] {
        let [a, b, c] = triangles[self.triangle()];
        match self.0 & 3 {
            0 => [a, b, c],
            1 => [b, c, a],
            _ => [c, a, b],
        }
    }

    /// The number of its first side: greater than those of sides that are stored.
    #[inline]
    pub(super) fn first_side(self) -> u32 {
        Record::LONE | self.0 & !3
    }
}

/// The slab of a triangle: as that of a patch which was prepared.
#[inline]
pub(super) fn slab_of(corners: [Vec3; 3]) -> Slab {
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    let normal = direction((b - a).cross(c - a));
    let [p, q, r] = [normal.dot(a), normal.dot(b), normal.dot(c)];
    let [x, y, z] = corners.map(Vec3::abs);
    let room = SLAB * f64::from(x.max(y).max(z).max_element());
    let (lo, hi) = (lesser(r, lesser(q, p)) - room, greater(r, greater(q, p)) + room);
    Slab { normal, lo, hi, slack: 0.0 }
}

/// The sine of a triangle, likewise.
pub(super) fn sine_of(corners: [Vec3; 3]) -> f32 {
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    let cross = (b - a).cross(c - a);
    let length = cross.length();
    sine(if length > 0.0 { lesser(cross.dot(direction(cross)) / length, 1.0) } else { 1.0 })
}

/// Tells where a patch of a packed surface is stored.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Record(u32);

/// Where a patch is stored.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Stored {
    /// Its place among those that are stored as they are.
    Patch(usize),
    /// It is a bundle, whose last part ends before a place.
    Bundle(PatchIndex),
    Lone(Lone),
}

impl Record {
    /// Triangles have 29 bits and a corner two, other places fewer than 30.
    const LONE: u32 = 1 << 31;
    const BUNDLE: u32 = 1 << 30;

    pub(super) fn new(stored: Stored) -> Self {
        Self(match stored {
            Stored::Patch(at) => at as u32,
            Stored::Bundle(next) => next.get() | Self::BUNDLE,
            Stored::Lone(lone) => lone.0 | Self::LONE,
        })
    }

    #[inline]
    pub(super) fn stored(self) -> Stored {
        if self.0 >= Self::LONE {
            Stored::Lone(Lone(self.0 & !Self::LONE))
        } else if self.0 >= Self::BUNDLE {
            Stored::Bundle(PatchIndex::new(self.0 & !Self::BUNDLE))
        } else {
            Stored::Patch(self.0 as usize)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_hold_the_greatest_numbers() {
        let places = [0, 1, (1 << 30) - 1];
        let lone = [0, (1 << 29) - 1].into_iter().flat_map(|t| (0..3).map(move |start| Lone::new(t, start)));
        let all = places
            .into_iter()
            .flat_map(|at| [Stored::Patch(at), Stored::Bundle(PatchIndex::new(at as u32))])
            .chain(lone.map(Stored::Lone));
        all.for_each(|stored| assert_eq!(Record::new(stored).stored(), stored));
        assert!(Lone::new((1 << 29) - 1, 2).first_side().checked_add(3).is_some());
    }
}
