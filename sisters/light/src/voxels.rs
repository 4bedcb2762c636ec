//! The surfaces in cells: which triangles each cell touches, and the entries of each cell.
//!
//! An entry is the surface in one cell that faces along one of six dominant axes, emits or not, and
//! has no gap along its axis. Both of its sides hold light, each as a *state*: state `2 e` is the
//! front of entry `e`, and `2 e + 1` its back.

use glam::{DVec3, Vec3};

use crate::clip::{Polygon, cross, inside, part_of, range, touched};
use crate::error::LightError;
use crate::forest::Forest;
use crate::lattice::{Cell, Lattice, Level};
use crate::numeric::{FLAT, GAP, GROW, LEAST_PART, MOST_REFERENCES, SAME_NORMAL};
use crate::surfaces::Surface;

mod renew;

/// No entry, or no triangle.
pub(crate) const NONE: u32 = u32::MAX;

/// The surface in one cell that faces one way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Entry {
    /// Unit mean normal of the fronts.
    pub(crate) normal: Vec3,
    /// Mean albedo by area.
    pub(crate) albedo: Vec3,
    /// In square cells of the size of its own.
    pub(crate) area: f32,
    /// The middle of its surface, in cells.
    pub(crate) middle: Vec3,
    /// The number of its cell.
    pub(crate) cell: u32,
    /// The range of its triangles in [`Voxels::members`].
    pub(crate) first: u32,
    pub(crate) end: u32,
    /// Its place among the entries of its cell.
    pub(crate) rank: u16,
    /// Dominant axis times two, plus one for downwards; six more if it emits.
    pub(crate) bin: u8,
    /// Whether it is flat and nothing else touches its cell, so that segments above it are free.
    pub(crate) alone: bool,
}

/// A triangle that touches a cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reference {
    pub(crate) surface: u32,
    /// The entry of its part in the cell, or [`NONE`] if it has hardly any there.
    pub(crate) entry: u32,
}

/// The part of a triangle in a cell, while entries are made.
#[derive(Clone, Copy)]
struct Part {
    cell: u32,
    surface: u32,
    /// Twelve kinds of entries, or 255 if there is hardly any part.
    bin: u8,
    /// Of what is solid, and its albedo.
    area: f32,
    albedo: Vec3,
    /// The middle of its corners.
    middle: Vec3,
    /// Where it lies along its dominant axis.
    low: f32,
    high: f32,
}

impl Part {
    /// The part in a cell of a triangle, whose corners are in cells of that size.
    fn new(lattice: &Lattice, cell: Cell, whole: &Polygon, (number, surface): (u32, &Surface)) -> Self {
        let polygon = part_of(whole, cell.at);
        let axis = surface.normal.abs().max_position();
        let bin = (2 * axis) as u8 + u8::from(surface.normal[axis] < 0.0) + 6 * u8::from(surface.emits);
        let area = 0.5 * cross(&polygon).length();
        let in_grid = || polygon.iter().map(|p| *p / lattice.fine(cell)).collect();
        let of = lattice.number(cell);
        let (albedo, solid) = if area > 0.0 { surface.over(in_grid, of.into()) } else { (Vec3::ZERO, 0.0) };
        let area = area * f64::from(solid);
        let (low, high) = range(&polygon, axis);
        let middle = polygon.iter().sum::<DVec3>() / polygon.len().max(1) as f64;
        Self {
            cell: of,
            surface: number,
            albedo,
            bin: if area > LEAST_PART { bin } else { u8::MAX },
            area: area as f32,
            middle: (middle / lattice.fine(cell)).as_vec3(),
            low: low as f32,
            high: high as f32,
        }
    }
}

/// All surfaces in cells.
#[derive(Debug, Clone)]
pub(crate) struct Voxels {
    pub(crate) lattice: Lattice,
    pub(crate) surfaces: Vec<Surface>,
    pub(crate) tree: Forest,
    pub(crate) entries: Vec<Entry>,
    pub(crate) members: Vec<u32>,
    pub(crate) references: Vec<Reference>,
    /// By occupied cell, in order of bricks: where its references start; one more for the end.
    starts: Vec<u32>,
    /// By occupied cell: where its entries start; one more for the end.
    heads: Vec<u32>,
    /// By brick of 4x4x4 cells: its occupied cells.
    pub(crate) masks: Vec<u64>,
    /// By brick: occupied cells of the bricks before it.
    ranks: Vec<u32>,
}

impl Voxels {
    /// O(touched cells times their logarithm).
    pub(crate) fn new(lattice: Lattice, surfaces: Vec<Surface>) -> Result<Self, LightError> {
        let tree = Forest::new(&lattice, &surfaces);
        Self::with(lattice, surfaces, tree)
    }

    /// The same with the tree of the triangles.
    pub(crate) fn with(lattice: Lattice, surfaces: Vec<Surface>, tree: Forest) -> Result<Self, LightError> {
        let mut voxels = Self::empty(lattice, surfaces, tree);
        let mut parts = Vec::new();
        for surface in (0..).zip(&voxels.surfaces) {
            voxels.add_all_parts(surface, &mut parts)?;
        }
        voxels.sort(&mut parts);
        for of_cell in parts.chunk_by(|a, b| a.cell == b.cell) {
            let (brick, bit) = lattice.slot_of(of_cell[0].cell);
            voxels.masks[brick] |= 1 << bit;
            voxels.add_cell(of_cell);
        }
        voxels.count();
        Ok(voxels)
    }

    /// No cells yet.
    fn empty(lattice: Lattice, surfaces: Vec<Surface>, tree: Forest) -> Self {
        let count = lattice.bricks();
        Self {
            lattice,
            tree,
            surfaces,
            entries: Vec::new(),
            members: Vec::new(),
            references: Vec::new(),
            starts: vec![0],
            heads: vec![0],
            masks: vec![0; count],
            ranks: vec![0; count],
        }
    }

    /// Sorts parts by cells, in the order in which bricks number these.
    fn sort(&self, parts: &mut [Part]) {
        let lattice = &self.lattice;
        parts.sort_unstable_by_key(|p| (lattice.slot_of(p.cell), p.bin, p.surface));
    }

    /// Counts the occupied cells before each brick.
    fn count(&mut self) {
        let mut before = 0;
        for (rank, mask) in self.ranks.iter_mut().zip(&self.masks) {
            *rank = before;
            before += mask.count_ones();
        }
    }

    /// Adds the parts of a triangle, with its number, in all cells, if they are not too many.
    fn add_all_parts(&self, surface: (u32, &Surface), parts: &mut Vec<Part>) -> Result<(), LightError> {
        let in_cells = |(level, of): (usize, &Level)| {
            let Level { fine, low, dims, .. } = *of;
            let (whole, margin) = (surface.1.scaled(fine), GROW * fine);
            touched(&inside(&whole, low, low + dims, margin), low, low + dims, margin, &mut |at| {
                let cell = Cell { level, at };
                if !self.lattice.is_finer(cell) {
                    parts.push(Part::new(&self.lattice, cell, &whole, surface));
                }
                parts.len() < MOST_REFERENCES
            })
        };
        let is_all = self.lattice.levels().iter().enumerate().all(in_cells);
        if is_all { Ok(()) } else { Err(LightError::TooManyReferences) }
    }

    /// Adds a cell with its parts, which are sorted by bin and surface.
    fn add_cell(&mut self, parts: &[Part]) {
        let (first, start) = (self.entries.len(), self.references.len());
        for of_bin in parts.chunk_by(|a, b| a.bin == b.bin) {
            if of_bin[0].bin == u8::MAX {
                let reference = |p: &Part| Reference { surface: p.surface, entry: NONE };
                self.references.extend(of_bin.iter().map(reference));
                continue;
            }
            let mut of_bin = of_bin.to_vec();
            of_bin.sort_unstable_by(|a, b| a.low.total_cmp(&b.low).then(a.surface.cmp(&b.surface)));
            let mut rest = &of_bin[..];
            while !rest.is_empty() {
                let mut high = rest[0].high;
                let gap = rest.iter().position(|p| {
                    let is_beyond = p.low > high + GAP;
                    high = high.max(p.high);
                    is_beyond
                });
                let (near, others) = rest.split_at(gap.unwrap_or(rest.len()));
                rest = others;
                let rank = (self.entries.len() - first) as u16;
                self.add_entry(near, rank);
            }
        }
        if let [entry] = &mut self.entries[first..] {
            entry.alone &= self.references[start..].iter().all(|r| r.entry == first as u32);
        } else {
            self.entries[first..].iter_mut().for_each(|e| e.alone = false);
        }
        self.starts.push(self.references.len() as u32);
        self.heads.push(self.entries.len() as u32);
    }

    fn add_entry(&mut self, parts: &[Part], rank: u16) {
        let number = self.entries.len() as u32;
        let first = self.members.len() as u32;
        let (mut normal, mut albedo, mut middle, mut area) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, 0.0);
        for p in parts {
            let (surface, share) = (&self.surfaces[p.surface as usize], f64::from(p.area));
            normal += surface.normal * share;
            albedo += p.albedo.as_dvec3() * share;
            middle += p.middle.as_dvec3() * share;
            area += share;
            self.members.push(p.surface);
            self.references.push(Reference { surface: p.surface, entry: number });
        }
        let mean = &self.surfaces[parts[0].surface as usize];
        let is_flat = parts.iter().all(|p| {
            let other = &self.surfaces[p.surface as usize];
            // The triangle's corner nearest to the plane tells less than its part, but is on it.
            let height = mean.normal.dot(other.corners[0] - mean.corners[0]);
            other.normal.dot(mean.normal) > SAME_NORMAL && height.abs() < FLAT
        });
        self.entries.push(Entry {
            normal: normal.try_normalize().unwrap_or(mean.normal).as_vec3(),
            albedo: (albedo / area).as_vec3(),
            area: area as f32,
            middle: (middle / area).as_vec3(),
            cell: parts[0].cell,
            first,
            end: self.members.len() as u32,
            rank,
            bin: parts[0].bin,
            alone: is_flat,
        });
    }

    /// By brick the occupied cells before it; by occupied cell where its entries start.
    #[cfg(feature = "gpu")]
    pub(crate) fn tables(&self) -> (&[u32], &[u32]) {
        (&self.ranks, &self.heads)
    }

    /// The number of a cell among the occupied ones.
    fn occupied(&self, c: Cell) -> Option<usize> {
        if !self.lattice.has(c) {
            return None;
        }
        let (brick, bit) = self.lattice.slot(c);
        let mask = self.masks[brick];
        (mask >> bit & 1 == 1).then(|| {
            let before = mask & ((1 << bit) - 1);
            (self.ranks[brick] + before.count_ones()) as usize
        })
    }

    /// The triangles that touch a cell.
    pub(crate) fn references_of(&self, c: Cell) -> &[Reference] {
        let of = |i: usize| &self.references[self.starts[i] as usize..self.starts[i + 1] as usize];
        self.occupied(c).map_or(&[], of)
    }

    /// The entries of a cell.
    pub(crate) fn entries_of(&self, c: Cell) -> std::ops::Range<u32> {
        self.occupied(c).map_or(0..0, |i| self.heads[i]..self.heads[i + 1])
    }

    /// The triangles of an entry, in order.
    pub(crate) fn members_of(&self, entry: u32) -> &[u32] {
        let e = &self.entries[entry as usize];
        &self.members[e.first as usize..e.end as usize]
    }

    /// Bytes of all parts.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.surfaces[..])
            + self.tree.bytes()
            + size_of_val(&self.entries[..])
            + size_of_val(&self.members[..])
            + size_of_val(&self.references[..])
            + size_of_val(&self.starts[..])
            + size_of_val(&self.heads[..])
            + size_of_val(&self.masks[..])
            + size_of_val(&self.ranks[..])
    }
}

/// Where a ray meets a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Hit {
    /// The distance from the start, in cells.
    pub(crate) distance: f64,
    /// The triangle.
    pub(crate) surface: u32,
}

/// Rays: the surface that one hits first, and the entry of that surface there.
impl Voxels {
    /// The first surface within a reach along a unit direction.
    pub(crate) fn first(&self, from: DVec3, direction: DVec3, reach: f64) -> Option<Hit> {
        self.tree.first(from, direction, reach).map(|(distance, surface)| Hit { distance, surface })
    }

    /// Whether the segment between two points meets no surface.
    pub(crate) fn free(&self, from: DVec3, to: DVec3) -> bool {
        self.free_of(from, to, &mut NONE.clone())
    }

    /// The same for many segments of one point: what blocked the last one is tried first.
    pub(crate) fn free_of(&self, from: DVec3, to: DVec3, last: &mut u32) -> bool {
        let way = to - from;
        let Some(direction) = way.try_normalize() else { return true };
        let blocker = self.tree.blocker(from, direction, way.length(), *last);
        *last = blocker.unwrap_or(*last);
        blocker.is_none()
    }

    /// The entry of a triangle at a point on it: that of the point's cell, or of a cell next to the
    /// point. Rounding may put a point into a cell in which hardly anything of the triangle is.
    pub(crate) fn entry_at(&self, surface: u32, point: DVec3) -> Option<u32> {
        let of = |c: Cell| {
            let is_it = |r: &&Reference| r.surface == surface && r.entry != NONE;
            self.references_of(c).iter().find(is_it).map(|r| r.entry)
        };
        let near = || self.lattice.all_at(point).flat_map(|at| self.lattice.around(at));
        of(self.lattice.at(point)).or_else(|| near().find_map(of))
    }
}
