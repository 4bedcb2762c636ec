//! The frustum as it is compared with very many small boxes.

use glam::{DVec3, Vec3A, Vec4};
use smallvec::SmallVec;

use crate::geometry::Block;
use crate::geometry::plane::HalfSpace;
use crate::grid::Grid;
use crate::numeric::query::SINGLE_FRUSTUM;
use crate::view::View;

/// Where a box is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum BoxSide {
    /// Inside of all planes.
    Inside,
    /// Outside of one.
    Outside,
    /// Neither is certain.
    Crosses,
}

/// Four planes: the points `p` with `x * p.x + y * p.y + z * p.z + w >= 0` are inside.
#[derive(Debug, Clone, Copy)]
struct Four {
    x: Vec4,
    y: Vec4,
    z: Vec4,
    w: Vec4,
    /// Values nearer to 0 decide nothing.
    margin: Vec4,
}

/// The planes of a view, in single precision by fours.
#[derive(Debug, Clone)]
pub(super) struct Planes<'v> {
    exact: &'v [HalfSpace],
    fours: SmallVec<[Four; 2]>,
}

impl<'v> Planes<'v> {
    /// For boxes inside a grid.
    pub(super) fn new(view: &'v View, grid: &Grid) -> Self {
        let largest = grid.min().abs().max(grid.max().abs()).max_element();
        let four = |planes: &[HalfSpace]| {
            // A missing plane has everything far inside.
            let of = |value: &dyn Fn(&HalfSpace) -> f64, none: f64| {
                Vec4::from_array(std::array::from_fn(|i| planes.get(i).map_or(none, value) as f32))
            };
            Four {
                x: of(&|plane| plane.normal.x, 0.0),
                y: of(&|plane| plane.normal.y, 0.0),
                z: of(&|plane| plane.normal.z, 0.0),
                w: of(&|plane| plane.offset, 1.0),
                margin: of(&|plane| SINGLE_FRUSTUM * (largest + plane.offset.abs()), 0.0),
            }
        };
        Self { exact: &view.planes, fours: view.planes.chunks(4).map(four).collect() }
    }

    /// Where a box is; in doubt, it crosses.
    #[inline]
    pub(super) fn side(&self, middle: Vec3A, half: Vec3A) -> BoxSide {
        let mut side = BoxSide::Inside;
        for four in &self.fours {
            let at = four.x * middle.x + four.y * middle.y + four.z * middle.z + four.w;
            let reach = four.x.abs() * half.x + four.y.abs() * half.y + four.z.abs() * half.z + four.margin;
            if at.cmplt(-reach).any() {
                return BoxSide::Outside;
            }
            // Not written the other way round, so that a value that is not a number is doubt.
            if !at.cmpgt(reach).all() {
                side = BoxSide::Crosses;
            }
        }
        side
    }

    /// Whether a box is inside of all planes, or may cross one; asked in double precision.
    pub(super) fn side_of(&self, block: &Block) -> BoxSide {
        let (middle, half) = ((block.min + block.max) * 0.5, (block.max - block.min) * 0.5);
        let largest = block.min.abs().max(block.max.abs()).max(DVec3::ZERO).max_element();
        let inside = self.exact.iter().all(|plane| {
            plane.distance(middle) >= plane.normal.abs().dot(half) + 2.0 * plane.margin(largest)
        });
        if inside { BoxSide::Inside } else { BoxSide::Crosses }
    }
}

#[cfg(test)]
mod tests {
    use glam::{UVec3, Vec3};

    use super::*;
    use crate::grid::GridSpec;
    use crate::random::Random;

    #[test]
    fn sides_agree_with_double_precision_or_are_doubtful() {
        let mut random = Random::new(8);
        let mut doubtful = 0;
        for size in [1.0, 4096.0f32] {
            let spec = GridSpec { min: Vec3::splat(-size), cell: size / 16.0, dims: UVec3::splat(32) };
            let grid = Grid::new(&spec).unwrap();
            for _ in 0..60 {
                let planes: Vec<_> = (0..7)
                    .map(|_| crate::Plane {
                        normal: random.point(1.0).as_vec3(),
                        offset: (random.next() * 0.4 * f64::from(size)) as f32,
                    })
                    .collect();
                let view = View::from_planes(Vec3::ZERO, &planes).unwrap();
                let planes = Planes::new(&view, &grid);
                for _ in 0..60 {
                    let middle = random.point(f64::from(size)).as_vec3a();
                    let half = random.point(f64::from(size) * 0.05).as_vec3a().abs();
                    let (m, h) = (middle.as_dvec3(), half.as_dvec3());
                    let reach = |plane: &HalfSpace| plane.normal.abs().dot(h);
                    let outside = view.planes.iter().any(|p| p.distance(m) < -reach(p));
                    let inside = view.planes.iter().all(|p| p.distance(m) > reach(p));
                    match planes.side(middle, half) {
                        BoxSide::Inside => assert!(inside),
                        BoxSide::Outside => assert!(outside),
                        BoxSide::Crosses => doubtful += usize::from(inside || outside),
                    }
                }
            }
        }
        assert!(doubtful < 20, "{doubtful}");
        let everything = View::omnidirectional(Vec3::ZERO).unwrap();
        let spec = GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(8) };
        let planes = Planes::new(&everything, &Grid::new(&spec).unwrap());
        assert_eq!(planes.side(Vec3A::ONE, Vec3A::ONE), BoxSide::Inside);
    }
}
