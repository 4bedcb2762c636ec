//! Whether a point lies within a solid, as levels are put together of solids that reach into each
//! other: all that it sees are backs.

use casca_radiosity::lit::LitTriangle;
use casca_scenes::world::Sides;
use casca_truth::oracle::tree::{Part, Primitive, Tree};
use glam::{DVec3, Vec3};
use obvhs::BvhBuildParams;

/// Rays start this far away from their point, as a share of the greatest coordinate: single precision
/// places points within less.
const OFF: f64 = 1e-6;

/// The triangles of a level, for rays.
pub struct Backs {
    tree: Tree,
    crosses: Vec<DVec3>,
}

impl Backs {
    /// The triangles, in their order. O(n log n).
    pub fn new(triangles: &[LitTriangle]) -> Self {
        let part = |(object, t): (u32, &LitTriangle)| Part {
            shape: Primitive::Triangle(t.corners.map(|p| p.as_dvec3())),
            object,
            triangle: 0,
            sides: Sides::Both,
        };
        Self {
            tree: Tree::of((0..).zip(triangles).map(part).collect(), BvhBuildParams::medium_build()),
            crosses: triangles.iter().map(|t| t.cross().as_dvec3()).collect(),
        }
    }

    /// The first triangle along a ray, and how many times its direction away.
    pub fn first(&self, from: DVec3, direction: DVec3) -> Option<(usize, f64)> {
        let mut best = None;
        self.tree.first(from, direction, &mut best);
        best.map(|(number, t)| (number as usize, t))
    }

    /// Whether a point sees nothing but backs; on a surface with a normal from the side of that, else
    /// all around.
    pub(crate) fn is_buried(&self, point: Vec3, normal: Option<Vec3>) -> bool {
        let corners = (0..8).map(|i| [1, 2, 4].map(|bit| if i & bit == 0 { 1.0 } else { -1.0 }));
        let side = normal.unwrap_or_default().as_dvec3();
        let mut ways = corners.map(DVec3::from_array).filter(|way| normal.is_none() || way.dot(side) > 0.0);
        ways.all(|way| {
            let from =
                point.as_dvec3() + (if normal.is_some() { side } else { way }) * (OFF * self.tree.scale);
            self.first(from, way).is_some_and(|(number, _)| self.crosses[number].dot(way) > 0.0)
        })
    }
}
