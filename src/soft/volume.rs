//! How much of the light of one source reaches each cell near a surface: the scalar twin of the matrix of hidden cells.

use glam::{DVec3, IVec3, Vec3};

use crate::derived::Light;
use crate::error::{Error, finite3};
use crate::grid::Grid;
use crate::grid::bricks::{BRICK, Bricks};
use crate::grid::cell_box::CellBox;
use crate::matrix::bits::{BitMatrix, cells_of};
use crate::numeric::soft::EVEN_STEPS;
use crate::soft::cone::between;
use crate::soft::grid::SoftGrid;
use crate::soft::rays::check_rays;
use crate::soft::walk::Segment;
use crate::view::Origin;

/// The value of a cell that no surface is near; others are up to 254.
const UNKNOWN: u8 = 255;
const FULL: f64 = 254.0;

#[derive(Clone, Default)]
struct Values(Option<Box<[u8; 512]>>);

/// The share of a light's rays that reaches each cell that is occupied or next to an occupied one. It holds for the grid as it was, and
/// does not follow later changes.
#[derive(Clone)]
pub struct VisibilityVolume {
    grid: Grid,
    values: Bricks<Values>,
}

/// Where the rays to a light lead.
enum Source {
    At { place: DVec3, range: f64 },
    Along(DVec3),
}

impl Source {
    fn new(light: &Light) -> Result<Self, Error> {
        let along = |direction: DVec3| {
            direction
                .try_normalize()
                .map(Self::Along)
                .ok_or(Error::NoDirection { what: "the direction of the light" })
        };
        match light {
            Light::Directional(direction) => {
                finite3("the direction of the light", *direction)?;
                along(direction.as_dvec3())
            }
            Light::Point { position, range } => {
                finite3("the position of the light", *position)?;
                between("the range of the light", *range, 0.0, f32::INFINITY)?;
                Ok(Self::At { place: position.as_dvec3(), range: f64::from(*range) })
            }
            Light::Spot(view) => match view.origin {
                Origin::Eye { at, .. } => Ok(Self::At { place: at, range: f64::INFINITY }),
                Origin::Direction(direction) => along(direction),
            },
        }
    }

    /// The other end of the ray from a point, if the point is in range.
    fn seen_from(&self, point: DVec3, far: f64) -> Option<DVec3> {
        match *self {
            Self::At { place, range } => (place.distance(point) <= range).then_some(place),
            Self::Along(direction) => Some(point - direction * far),
        }
    }
}

impl VisibilityVolume {
    /// Finds which cells a light reaches, by so many exact walks from points of each cell (1 to 4096; the first is its middle). The
    /// cell itself does not hide the light from itself, nor does the cell that a point or spot light is in. A spot light counts as shining in all directions.
    ///
    /// Costs the occupied cells, those inside of solids too, and those next to them, times the rays.
    ///
    /// # Errors
    /// Refuses a light whose numbers are not finite (but for the range) or without direction, and numbers of rays out of range.
    pub fn new(soft: &SoftGrid, light: &Light, rays: u32) -> Result<Self, Error> {
        check_rays(rays)?;
        let source = Source::new(light)?;
        let grid = *soft.grid();
        let (mut near, last) = (BitMatrix::new(grid.dims()), grid.dims() - 1);
        for (brick, mask) in soft.pyramid().any_bits(0).masks() {
            for c in cells_of(brick, mask) {
                let (lo, hi) = ((c - 1).max(IVec3::ZERO), (c + 1).min(last));
                for z in lo.z..=hi.z {
                    (lo.y..=hi.y).for_each(|y| near.set_run(lo.x, hi.x, y, z));
                }
            }
        }
        let far = (grid.max() - grid.min()).length();
        // A lamp may be in a cell that its own shade touches.
        let until = match source {
            Source::At { place, .. } => Some(CellBox { lo: grid.cell_of(place), hi: grid.cell_of(place) }),
            Source::Along(_) => None,
        };
        let mut values: Bricks<Values> = Bricks::new(grid.dims());
        for (brick, mask) in near.masks() {
            let held = values.get_mut(brick).0.get_or_insert_with(|| Box::new([UNKNOWN; 512]));
            for c in cells_of(brick, mask) {
                let open = (0..rays).filter(|&k| {
                    let from = grid.cell_bounds(c).0 + place_in_cell(k) * grid.cell_size();
                    source.seen_from(from, far).is_some_and(|to| {
                        soft.walk(&Segment { from, to, skips_first: true, until }).is_none()
                    })
                });
                held[place(c)] = (open.count() as f64 / f64::from(rays) * FULL).round() as u8;
            }
        }
        Ok(Self { grid, values })
    }

    /// The share of the light that reaches a cell, 0 to 1; `None` far from surfaces and outside the grid.
    pub fn get(&self, cell: IVec3) -> Option<f32> {
        let held = self.values.get(self.grid.contains(cell).then_some(cell >> 3i32)?).0.as_ref()?;
        let value = held[place(cell)];
        (value != UNKNOWN).then(|| f32::from(value) / FULL as f32)
    }

    /// The least share of the eight cells around a point in world units, the conservative choice: interpolation would let light through
    /// walls. `None` if all eight are far from surfaces.
    pub fn least(&self, point: Vec3) -> Option<f32> {
        self.around(point).map(|(share, _)| share).reduce(f32::min)
    }

    /// The share at a point in world units, interpolated between those of the eight cells around that are known. `None` if none is.
    pub fn smooth(&self, point: Vec3) -> Option<f32> {
        let (sum, all) = self.around(point).fold((0.0, 0.0), |(sum, all), (v, w)| (sum + v * w, all + w));
        (all > 0.0).then(|| sum / all)
    }

    /// The shares of the eight cells around a point, and their weights.
    fn around(&self, point: Vec3) -> impl Iterator<Item = (f32, f32)> {
        let at = (point.as_dvec3() - self.grid.min()) / self.grid.cell_size() - 0.5;
        let low = at.floor();
        (0..8).filter(move |_| point.is_finite()).filter_map(move |i| {
            let high = IVec3::new(i & 1, i >> 1 & 1, i >> 2);
            let weight = DVec3::select(high.cmpeq(IVec3::ONE), at - low, 1.0 - (at - low)).element_product();
            let cell = low.clamp(DVec3::splat(-2.0), self.grid.dims().as_dvec3()).as_ivec3() + high;
            Some((self.get(cell)?, weight as f32))
        })
    }

    /// Bytes on the heap.
    pub fn memory_bytes(&self) -> usize {
        let held = self.values.iter().filter(|(_, values)| values.0.is_some()).count();
        self.values.bytes() + held * size_of::<[u8; 512]>()
    }
}

impl std::fmt::Debug for VisibilityVolume {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "VisibilityVolume({} bytes)", self.memory_bytes())
    }
}

fn place(cell: IVec3) -> usize {
    let c = cell & (BRICK - 1);
    (c.z << 6 | c.y << 3 | c.x) as usize
}

/// Points of a unit cell, evenly spread; the first is its middle.
fn place_in_cell(k: u32) -> DVec3 {
    (DVec3::from_array(EVEN_STEPS) * f64::from(k) + 0.5).fract()
}
