//! The grid of voxels: cubic cells, as many along each axis as the scene needs, in bricks of 8x8x8
//! (thesis 2.1; a cube of N³ cells, as in the thesis, would be three quarters empty for a hall such
//! as Sponza).

use casca::{Grid, GridSpec};
use glam::{UVec3, Vec3};

use crate::error::LightError;
pub use crate::numeric::{BRICK, BRICK_CELLS, LEVELS, RESOLUTIONS};
use crate::numeric::{FARTHEST, LEAST_CELL, NORMAL_ROUNDING, TOUCH};

/// Axes have multiples of this many cells, so that every texel of every mip is whole.
const TEXEL: u32 = 1 << LEVELS;
/// Cells between the scene and the border of the grid: rays and cones that start above a surface at
/// its edge must start in the grid. They start up to 2.05 cells away from it along an axis
/// (`PUSH_OFF` n (|n| + ...), at its greatest). Of 3 and 4 cells, 4 loses less light in the furnace
/// test: 2 % against 10 %, as walls along the scene's box then lie better in texels. A grid of 16
/// cells has 8 left.
const BORDER: u32 = 4;

/// The grid of voxels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Volume {
    /// Least corner in metres.
    pub origin: Vec3,
    /// Edge of a cell in metres.
    pub cell: f32,
    /// Cells along each axis, with those that fill the coarsest texels: multiples of 32.
    pub dims: UVec3,
}

impl Volume {
    /// The grid over a box in metres, with `resolution` cells along the longest axis.
    ///
    /// # Errors
    /// Refuses resolutions outside of [`RESOLUTIONS`], and boxes over which [`Grid::new`] makes no
    /// grid.
    pub fn new((min, max): (Vec3, Vec3), resolution: u32) -> Result<Self, LightError> {
        if !RESOLUTIONS.contains(&resolution) {
            return Err(LightError::Resolution(resolution));
        }
        let size = (max - min).max(Vec3::ZERO);
        let inner = (resolution - 2 * BORDER) as f32;
        // A scene without extent gets cells nevertheless.
        let rounding = min.abs().max(max.abs()).max_element() * LEAST_CELL;
        let cell = (size.max_element() / inner).max(rounding).max(f32::MIN_POSITIVE);
        let needed = (size / cell).ceil().as_uvec3().min(UVec3::splat(resolution - 2 * BORDER)) + 2 * BORDER;
        let dims = UVec3::from_array(needed.to_array().map(|n| n.next_multiple_of(TEXEL)));
        let origin = min - cell * BORDER as f32;
        Grid::new(&GridSpec { min: origin, cell, dims })?;
        Ok(Self { origin, cell, dims })
    }

    /// The same grid for the library.
    pub fn spec(&self) -> GridSpec {
        GridSpec { min: self.origin, cell: self.cell, dims: self.dims }
    }

    /// Bricks along each axis.
    pub fn bricks(&self) -> UVec3 {
        self.dims / BRICK
    }

    /// Number of bricks.
    pub fn brick_count(&self) -> usize {
        self.bricks().element_product() as usize
    }

    /// Number of a brick.
    pub fn number(&self, brick: UVec3) -> u32 {
        let n = self.bricks();
        brick.x + n.x * (brick.y + n.y * brick.z)
    }

    /// The brick of a number.
    pub fn brick(&self, number: u32) -> UVec3 {
        let n = self.bricks();
        UVec3::new(number % n.x, number / n.x % n.y, number / (n.x * n.y))
    }

    /// The corners of a brick in metres.
    pub fn brick_box(&self, number: u32) -> (Vec3, Vec3) {
        let low = self.brick(number).as_vec3() * BRICK as f32;
        (self.origin + low * self.cell, self.origin + (low + BRICK as f32) * self.cell)
    }

    /// A point in metres, in cells from the grid's corner.
    pub fn cells_from(&self, point: Vec3) -> Vec3 {
        (point - self.origin) / self.cell
    }

    /// The bricks that a triangle (in cells) may touch, by their numbers: those of its box that its
    /// plane reaches. None if a corner is not finite or far from the grid. Costs the bricks of its
    /// box.
    pub fn bricks_of(&self, [a, b, c]: [Vec3; 3], visit: &mut dyn FnMut(u32)) {
        let (low, high) = (a.min(b).min(c) - TOUCH, a.max(b).max(c) + TOUCH);
        let inside = high.cmpge(Vec3::ZERO).all() && low.cmplt(self.dims.as_vec3()).all();
        // Comparisons fail for what is not finite.
        if !(inside && low.min_element() > -FARTHEST && high.max_element() < FARTHEST) {
            return;
        }
        let edge = BRICK as f32;
        let first = (low / edge).max(Vec3::ZERO).as_uvec3();
        let last = (high / edge).as_uvec3().min(self.bricks() - 1);
        let (to_b, to_c) = (b - a, c - a);
        let normal = to_b.cross(to_c);
        let rounding = to_b.length() * to_c.length() * NORMAL_ROUNDING;
        let room = normal.abs().element_sum() * (0.5 * edge + 1.0);
        for z in first.z..=last.z {
            for y in first.y..=last.y {
                for x in first.x..=last.x {
                    let brick = UVec3::new(x, y, z);
                    let centre = (brick.as_vec3() + 0.5) * edge;
                    let to_a = a - centre;
                    // The room of a cell around the brick covers all other rounding.
                    if normal.dot(to_a).abs() <= room + rounding * to_a.abs().element_sum() {
                        visit(self.number(brick));
                    }
                }
            }
        }
    }
}
