//! How much of the light of one source reaches each cell near a surface: the scalar twin of the
//! matrix of hidden cells.

use glam::{DVec3, IVec3, Vec3};

use crate::derived::Light;
use crate::derived::shadows::light::LightKind;
use crate::error::{Error, finite3};
use crate::grid::Grid;
use crate::grid::bricks::{BRICK, Bricks, Pages};
use crate::grid::cell_box::CellBox;
use crate::matrix::bits::{BitMatrix, Mask, NONE, block_mask, both, cells_of, either};
use crate::numeric::soft::{COMPARED, EVEN_STEPS, LEAST_WEIGHT, STRAY};
use crate::soft::cone::between;
use crate::soft::grid::SoftGrid;
use crate::soft::rays::check_rays;
use crate::soft::walk::Segment;
use crate::view::Origin;

/// The value of a cell that no surface is near; others are up to 254.
const UNKNOWN: u8 = 255;
const FULL: f64 = 254.0;
/// Bricks along an axis of a page, the largest block that walks cross in one step.
const PAGE: i32 = 8;

#[derive(Clone, Default)]
struct Values(Option<Box<[u8; 512]>>);

/// The share of a light's rays that reaches each cell that is occupied or next to an occupied one.
/// It holds for the grid as it was at the last [`VisibilityVolume::update`].
///
/// The share of an occupied cell is not the light on the surface in it: from inside a flat floor,
/// rays to a low sun cross the cells of the floor beside. [`VisibilityVolume::least`] and
/// [`VisibilityVolume::smooth`] therefore use the open cells in front of a surface.
#[derive(Clone)]
pub struct VisibilityVolume {
    grid: Grid,
    source: Source,
    rays: u32,
    /// The cells that were occupied at the last update.
    occupied: BitMatrix,
    values: Bricks<Values>,
}

/// Where the rays to a light lead.
#[derive(Clone, Copy)]
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
        match &light.kind {
            LightKind::Directional(direction) => {
                finite3("the direction of the light", *direction)?;
                along(direction.as_dvec3())
            }
            LightKind::Point { position, range } => {
                finite3("the position of the light", *position)?;
                between("the range of the light", *range, 0.0, f32::INFINITY)?;
                Ok(Self::At { place: position.as_dvec3(), range: f64::from(*range) })
            }
            LightKind::Spot(view) => match view.origin {
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
    /// Finds which cells a light reaches, by so many exact walks from points of each cell (1 to
    /// 4096; the first is its middle). The cell itself does not hide the light from itself, nor
    /// does the cell that a point or spot light is in. A spot light counts as shining in all
    /// directions.
    ///
    /// Costs the number of rays times the number of cells that are occupied or next to an occupied
    /// one. Cells inside solids count.
    ///
    /// # Errors
    /// Refuses a light whose numbers are not finite (but for the range) or without direction, and
    /// numbers of rays out of range.
    pub fn new(soft: &SoftGrid, light: &Light, rays: u32) -> Result<Self, Error> {
        check_rays(rays)?;
        let (source, grid) = (Source::new(light)?, *soft.grid());
        let (occupied, values) = (BitMatrix::new(grid.dims()), Bricks::new(grid.dims()));
        let mut volume = Self { grid, source, rays, occupied, values };
        volume.update(soft);
        Ok(volume)
    }

    /// Brings the volume up to date with a grid, as of its last [`SoftGrid::rebuild`]. Walks again
    /// only in those bricks of 8x8x8 cells near which cells changed, or whose rays to the light may
    /// cross a brick that changed. Returns the number of bricks that it walked in, and of those
    /// that it let go because no surface is near them any longer. The result is that of a new
    /// volume, to the bit. A grid with other cells starts it anew, and so does a change of so many
    /// bricks that new walks cost less than the comparisons.
    ///
    /// Costs the cells of these bricks times the rays, and a comparison of each brick near a
    /// surface with each one that changed, but hardly more than a new volume. With the feature
    /// `rayon`, several threads share the bricks.
    ///
    /// ```
    /// use casca::soft::{Layer, SoftGrid, VisibilityVolume};
    /// use casca::{GridSpec, Light, Sphere};
    /// use glam::{IVec3, UVec3, Vec3};
    ///
    /// # fn main() -> Result<(), casca::Error> {
    /// let mut soft = SoftGrid::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(64) })?;
    /// soft.insert(Sphere::new(Vec3::new(32.0, 32.0, 8.0), 4.0), Layer::Fixed)?;
    /// let cloud = soft.insert(Sphere::new(Vec3::new(32.0, 32.0, 40.0), 6.0), Layer::Moving)?;
    /// soft.rebuild();
    /// let mut sun = VisibilityVolume::new(&soft, &Light::directional(Vec3::NEG_Z), 1)?;
    /// assert_eq!(sun.get(IVec3::new(32, 32, 12)), Some(0.0));
    /// soft.update(cloud, Sphere::new(Vec3::new(8.0, 8.0, 40.0), 6.0))?;
    /// soft.rebuild();
    /// sun.update(&soft);
    /// assert_eq!(sun.get(IVec3::new(32, 32, 12)), Some(1.0));
    /// # Ok(())
    /// # }
    /// ```
    pub fn update(&mut self, soft: &SoftGrid) -> usize {
        self.update_comparing(soft, COMPARED * self.rays as usize)
    }

    /// [`Self::update`], which starts anew if a brick had to be compared with more than `most`
    /// others.
    fn update_comparing(&mut self, soft: &SoftGrid, most: usize) -> usize {
        let now = soft.pyramid().any_bits(0);
        if self.grid != *soft.grid() {
            self.grid = *soft.grid();
            (self.occupied, self.values) = (BitMatrix::new(self.grid.dims()), Bricks::new(self.grid.dims()));
        }
        let changed: Vec<IVec3> = {
            let new = now.masks().filter(|(brick, mask)| self.occupied.brick(*brick) != *mask);
            let gone = self.occupied.masks().filter(|(brick, _)| *now.brick(*brick) == NONE);
            new.chain(gone).map(|(brick, _)| brick).collect()
        };
        if changed.is_empty() {
            return 0;
        }
        let near_changed = self.around_bricks(changed.iter().copied());
        let near = self.around_bricks(now.masks().chain(self.occupied.masks()).map(|(brick, _)| brick));
        let blocks = self.changed_blocks(&changed, now);
        let crosses = |brick: IVec3| blocks.iter().any(|block| self.may_cross(brick, block));
        let all: Vec<IVec3> = near.iter().collect();
        let stale = |brick: IVec3| blocks.len() > most || near_changed.get(brick) || crosses(brick);
        let made = for_each(&all, |brick| stale(brick).then(|| self.walks(soft, brick)));
        let mut count = 0;
        for (&brick, values) in all.iter().zip(made) {
            let Some(values) = values else { continue };
            let held = self.values.get(brick).0.is_some();
            count += usize::from(held || values.is_some());
            match values {
                Some(_) => self.values.get_mut(brick).0 = values,
                None => self.values.release(brick),
            }
        }
        self.occupied = now.clone();
        count
    }

    /// Some bricks and those beside them, as a matrix with a bit for each brick.
    fn around_bricks(&self, bricks: impl Iterator<Item = IVec3>) -> BitMatrix {
        let dims = (self.grid.dims() + (BRICK - 1)) >> 3i32;
        let mut near = BitMatrix::new(dims);
        for b in bricks {
            let (lo, hi) = ((b - 1).max(IVec3::ZERO), (b + 1).min(dims - 1));
            for z in lo.z..=hi.z {
                (lo.y..=hi.y).for_each(|y| near.set_run(lo.x, hi.x, y, z));
            }
        }
        near
    }

    /// The blocks, in cells, inside which walks may go another way than before. A walk crosses an
    /// empty page in one step: where a page became empty or is so no longer, walks may be rounded
    /// to other cells anywhere in it.
    fn changed_blocks(&self, changed: &[IVec3], now: &BitMatrix) -> Vec<(DVec3, DVec3)> {
        let block = |brick: &IVec3| {
            let page = brick.div_euclid(IVec3::splat(PAGE));
            let turned = self.occupied.pages().page_is_empty(page) != now.pages().page_is_empty(page);
            let (low, size) = if turned { (page * PAGE, PAGE) } else { (*brick, 1) };
            let min = (low * BRICK).as_dvec3();
            (min - STRAY, min + f64::from(size * BRICK) + STRAY)
        };
        let mut blocks: Vec<_> = changed.iter().map(block).collect();
        blocks.dedup();
        blocks
    }

    /// Whether a ray from a point of a brick to the light may cross a block. The rays at a share of
    /// their way fill a box, whose sides move evenly with that share: the shares at which it meets
    /// the block are an interval on each axis.
    fn may_cross(&self, brick: IVec3, (min, max): &(DVec3, DVec3)) -> bool {
        let lo = (brick * BRICK).as_dvec3();
        let hi = lo + f64::from(BRICK);
        let to = |from: DVec3| match self.source {
            Source::At { place, .. } => (place - self.grid.min()) / self.grid.cell_size(),
            Source::Along(direction) => from - direction * (self.far() / self.grid.cell_size()),
        };
        let ((lo_to, hi_to), mut first, mut last) = ((to(lo), to(hi)), 0.0f64, 1.0f64);
        // Where from + (to - from) s is at most `most`.
        let mut keep = |from: f64, to: f64, most: f64| {
            let (way, room) = (to - from, most - from);
            match way {
                w if w > 0.0 => last = last.min(room / way),
                w if w < 0.0 => first = first.max(room / way),
                _ if room < 0.0 => last = -1.0,
                _ => {}
            }
        };
        for axis in 0..3 {
            keep(lo[axis], lo_to[axis], max[axis]);
            keep(-hi[axis], -hi_to[axis], -min[axis]);
        }
        first <= last
    }

    /// The length of the rays to a light without place.
    fn far(&self) -> f64 {
        (self.grid.max() - self.grid.min()).length()
    }

    /// The values of a brick; `None` if no surface is near it.
    fn walks(&self, soft: &SoftGrid, brick: IVec3) -> Option<Box<[u8; 512]>> {
        let known = near_surfaces(soft.pyramid().any_bits(0), brick);
        if known == NONE {
            return None;
        }
        // A lamp may be in a cell that its own shade touches.
        let until = match self.source {
            Source::At { place, .. } => {
                let cell = self.grid.cell_of(place);
                Some(CellBox { lo: cell, hi: cell })
            }
            Source::Along(_) => None,
        };
        let (far, mut values) = (self.far(), Box::new([UNKNOWN; 512]));
        for c in cells_of(brick, &known) {
            let open = (0..self.rays).filter(|&k| {
                let from = self.grid.cell_bounds(c).0 + place_in_cell(k) * self.grid.cell_size();
                self.source
                    .seen_from(from, far)
                    .is_some_and(|to| soft.walk(&Segment { from, to, skips_first: true, until }).is_none())
            });
            values[place(c)] = (open.count() as f64 / f64::from(self.rays) * FULL).round() as u8;
        }
        Some(values)
    }

    /// The share of the light that reaches a cell, 0 to 1; `None` far from surfaces and outside the
    /// grid.
    pub fn get(&self, cell: IVec3) -> Option<f32> {
        let held = self.values.get(self.grid.contains(cell).then_some(cell >> 3i32)?).0.as_ref()?;
        let value = held[place(cell)];
        (value != UNKNOWN).then(|| f32::from(value) / FULL as f32)
    }

    /// The least share of the cells around a point in world units, the conservative choice:
    /// interpolation would let light through walls. `None` if all of them are far from surfaces.
    ///
    /// The cells are the open ones of the eight around the point. If none of these is open, as in
    /// the lower half of the cells of a floor, they are the open ones of the 26 beside the point's
    /// cell, and all eight if none of those is open, as deep inside a solid. A point on a wall of
    /// one cell has open cells on both sides: to ask for one side, add the length of a cell along
    /// its normal.
    pub fn least(&self, point: Vec3) -> Option<f32> {
        self.around(point).map(|(share, _)| share).reduce(f32::min)
    }

    /// The share at a point in world units, interpolated between the same cells as those of
    /// [`VisibilityVolume::least`]. `None` if none of them is known.
    pub fn smooth(&self, point: Vec3) -> Option<f32> {
        let (sum, all) = self.around(point).fold((0.0, 0.0), |(sum, all), (v, w)| (sum + v * w, all + w));
        (all > 0.0).then(|| sum / all)
    }

    /// The shares of cells around a point, and their weights: of the nearest open cells, else of
    /// all eight around it.
    fn around(&self, point: Vec3) -> impl Iterator<Item = (f32, f32)> {
        let at = (point.as_dvec3() - self.grid.min()) / self.grid.cell_size() - 0.5;
        let at = at.clamp(DVec3::splat(-3.0), self.grid.dims().as_dvec3() + 2.0);
        let choices = [(1.0, true), (1.5, true), (1.0, false)].into_iter().filter(move |_| point.is_finite());
        let mut choices = choices.map(move |(distance, open)| self.within(at, distance, open).peekable());
        choices.find_map(|mut cells| cells.peek().is_some().then_some(cells)).into_iter().flatten()
    }

    /// The known shares of cells whose middle is at most `reach` cells from a place along each
    /// axis, 1 or 1.5, and their weights: of open cells or of all. The place is in cells from the
    /// middle of the first one.
    fn within(&self, at: DVec3, distance: f64, open: bool) -> impl Iterator<Item = (f32, f32)> {
        (0..27).filter_map(move |i| {
            let cell = at.round().as_ivec3() + IVec3::new(i % 3, i / 3 % 3, i / 9) - 1;
            let room = distance - (cell.as_dvec3() - at).abs();
            if room.min_element() < 0.0 || open && self.occupied.get(cell) {
                return None;
            }
            Some((self.get(cell)?, room.element_product().max(LEAST_WEIGHT) as f32))
        })
    }

    /// Bytes on the heap.
    pub fn memory_bytes(&self) -> usize {
        let held = self.values.iter().filter(|(_, values)| values.0.is_some()).count();
        self.occupied.bytes() + self.values.bytes() + held * size_of::<[u8; 512]>()
    }
}

impl std::fmt::Debug for VisibilityVolume {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "VisibilityVolume({} bytes)", self.memory_bytes())
    }
}

/// The cells of a brick that are occupied or next to an occupied one.
fn near_surfaces(occupied: &BitMatrix, brick: IVec3) -> Mask {
    let dims = occupied.dims();
    let (lo, hi) = (brick * BRICK, (brick * BRICK + (BRICK - 1)).min(dims - 1));
    let bricks = CellBox { lo: (brick - 1).max(IVec3::ZERO), hi: (brick + 1).min((dims - 1) >> 3i32) };
    let mut near = NONE;
    for b in bricks.cells() {
        let beside = both(occupied.brick(b), &block_mask(b, lo - 1, hi + 1));
        for c in cells_of(b, &beside) {
            near = either(&near, &block_mask(brick, (c - 1).max(lo), (c + 1).min(hi)));
        }
    }
    near
}

/// What a function says of each brick, in their order.
#[cfg(feature = "rayon")]
fn for_each<T: Send>(bricks: &[IVec3], of: impl Fn(IVec3) -> T + Sync) -> Vec<T> {
    use rayon::prelude::*;
    bricks.par_iter().map(|&brick| of(brick)).collect()
}

/// What a function says of each brick, in their order.
#[cfg(not(feature = "rayon"))]
fn for_each<T>(bricks: &[IVec3], of: impl Fn(IVec3) -> T) -> Vec<T> {
    bricks.iter().map(|&brick| of(brick)).collect()
}

fn place(cell: IVec3) -> usize {
    let c = cell & (BRICK - 1);
    (c.z << 6 | c.y << 3 | c.x) as usize
}

/// Points of a unit cell, evenly spread; the first is its middle.
fn place_in_cell(k: u32) -> DVec3 {
    (DVec3::from_array(EVEN_STEPS) * f64::from(k) + 0.5).fract()
}

#[cfg(test)]
mod tests {
    use glam::UVec3;

    use super::*;
    use crate::soft::Layer;
    use crate::{Aabb, GridSpec};

    /// A cube of one cell in each of 16 x 16 x 5 bricks, at a place in its brick, and a plate of 16
    /// x 16 bricks above.
    fn cubes(at: f32) -> SoftGrid {
        let spec = GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::new(128, 128, 64) };
        let mut grid = SoftGrid::new(&spec).unwrap();
        for i in 0..16 * 16 * 5 {
            let brick = IVec3::new(i % 16, i / 16 % 16, i / 256);
            let middle = (brick * BRICK).as_vec3() + at;
            grid.insert(Aabb::from_center(middle, Vec3::splat(0.2)), Layer::Fixed).unwrap();
        }
        let plate = Aabb::new(Vec3::new(0.0, 0.0, 60.2), Vec3::new(128.0, 128.0, 60.8));
        grid.insert(plate, Layer::Fixed).unwrap();
        grid.rebuild();
        grid
    }

    #[test]
    fn large_changes_start_anew_with_the_same_result_to_the_bit() {
        let (before, after) = (cubes(3.5), cubes(4.5));
        let sun = Light::directional(Vec3::NEG_Z);
        let [old, new] = [&before, &after].map(|grid| VisibilityVolume::new(grid, &sun, 1).unwrap());
        let (mut compared, mut anew) = (old.clone(), old);
        // The change does not shade the plate.
        assert_eq!(compared.update_comparing(&after, usize::MAX), 1280);
        assert_eq!(anew.update(&after), 1280 + 256);
        for cell in (CellBox { lo: IVec3::ZERO, hi: after.grid().dims() - 1 }).cells() {
            let share = new.get(cell);
            assert_eq!([compared.get(cell), anew.get(cell)], [share; 2], "{cell}");
        }
    }
}
