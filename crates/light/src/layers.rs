//! Triangles into voxels: a layer of what stays, a layer of what moves, and both as one (thesis
//! 2.1, 2.1.1; digest S1 to S3).
//!
//! Sums and counts are integers, so that neither the order of triangles nor of threads matters, and
//! the moving layer can be taken away again without a trace. Only bricks with triangles have
//! memory.

use std::ops::Range;

use casca_stage::gpu::Gpu;
use casca_stage::kernel::{Kernel, Lookup};
use casca_stage::wgpu::{BindingResource, Buffer, BufferUsages, CommandEncoder};

use crate::data::Triangle;
use crate::device::{filled, shader, zeros};
use crate::error::{LightError, Part};
use crate::volume::{BRICK_CELLS, Volume};

/// Bytes that the sums of a cell take: colours, normals with the count.
const SUMS: [u64; 2] = [24, 16];
/// As errors name it.
const OCCUPANCY: Part = Part::of_cells("occupancy");
const SURFACES: Part = Part::of_cells("surfaces");
const PAIRS_LIST: Part = Part::of_cells("the list of triangles by brick");
/// Pairs that a group of the shader takes.
const PAIRS: usize = 8;

/// The bricks that triangles touch, sorted, and the pairs of a triangle and a place among those
/// bricks.
fn pairs_of(
    volume: &Volume,
    triangles: &[Triangle],
    range: Range<usize>,
    most: u64,
) -> Result<(Vec<u32>, Vec<[u32; 2]>), LightError> {
    let mut pairs: Vec<[u32; 2]> = Vec::new();
    let mut places = vec![0_u32; volume.brick_count()];
    for i in range {
        volume.bricks_of(triangles[i].corners(), &mut |brick| {
            pairs.push([i as u32, brick]);
            places[brick as usize] = 1;
        });
        let needed = (pairs.len() * size_of::<[u32; 2]>()) as u64;
        if needed > most {
            let Part { name: what, by } = PAIRS_LIST;
            return Err(LightError::TooLarge { what, needed, limit: most, unit: "bytes", by });
        }
    }
    let bricks: Vec<u32> = (0..places.len() as u32).filter(|&b| places[b as usize] != 0).collect();
    bricks.iter().zip(0..).for_each(|(&b, place)| places[b as usize] = place);
    pairs.iter_mut().for_each(|pair| pair[1] = places[pair[1] as usize]);
    Ok((bricks, pairs))
}

/// A layer: its bricks, sorted, and their sums.
struct Layer {
    bricks: Vec<u32>,
    list: Buffer,
    pairs: Buffer,
    count: usize,
    sums: [Buffer; 2],
}

impl Layer {
    fn new(
        gpu: &Gpu,
        volume: &Volume,
        triangles: &[Triangle],
        range: Range<usize>,
    ) -> Result<Self, LightError> {
        let (bricks, pairs) =
            pairs_of(volume, triangles, range, gpu.device.limits().max_storage_buffer_binding_size)?;
        let cells = bricks.len() as u64 * u64::from(BRICK_CELLS);
        Ok(Self {
            list: filled(gpu, Part::of_cells("the list of bricks"), &bricks, BufferUsages::STORAGE)?,
            pairs: filled(gpu, PAIRS_LIST, &pairs, BufferUsages::STORAGE)?,
            count: pairs.len(),
            sums: [
                zeros(gpu, Part::of_cells("the sums of colours"), cells * SUMS[0])?,
                zeros(gpu, Part::of_cells("the sums of normals"), cells * SUMS[1])?,
            ],
            bricks,
        })
    }
}

/// Both layers, and both as one.
pub struct Layers {
    volume: Volume,
    fixed: Layer,
    moving: Layer,
    /// By brick: 0, or one more than its slot.
    table: Vec<u32>,
    /// The bricks with slots, in the order of the slots: those of the fixed layer come first.
    slots: Vec<u32>,
    /// How many slots there is memory for.
    capacity: usize,
    tables: [Buffer; 2],
    occupancy: Buffer,
    surfaces: Buffer,
    voxelize: Kernel,
    merge: Kernel,
}

/// A brick, and the words of its cells.
pub type BrickSurfaces = (u32, Vec<[u32; 4]>);

/// What the kernels need from elsewhere, by binding.
pub type Others<'a, 'b> = Lookup<'a, 'b>;

impl Layers {
    /// The layers of these triangles, of which the first `fixed` stay. Nothing is voxelized yet.
    ///
    /// # Errors
    /// The adapter has no buffers as large.
    pub fn new(gpu: &Gpu, volume: Volume, triangles: &[Triangle], fixed: usize) -> Result<Self, LightError> {
        let module = shader(gpu, "voxelize", include_str!("voxelize.wgsl"));
        let tables = [
            zeros(gpu, Part::of_cells("the table of bricks"), 4 * volume.brick_count() as u64)?,
            zeros(gpu, Part::of_cells("the table of moving bricks"), 4 * volume.brick_count() as u64)?,
        ];
        let mut new = Self {
            volume,
            fixed: Layer::new(gpu, &volume, triangles, 0..fixed)?,
            moving: Layer::new(gpu, &volume, triangles, fixed..triangles.len())?,
            table: vec![0; volume.brick_count()],
            slots: Vec::new(),
            capacity: 0,
            tables,
            occupancy: zeros(gpu, OCCUPANCY, 0)?,
            surfaces: zeros(gpu, SURFACES, 0)?,
            voxelize: Kernel::new(gpu, &module, "voxelize", &[0, 6, 20, 21, 22, 23, 24]),
            merge: Kernel::new(gpu, &module, "merge", &[1, 6, 25, 26, 27, 28, 29, 30, 31]),
        };
        new.assign_slots(gpu)?;
        Ok(new)
    }

    /// Bricks with voxels, in the order of their slots.
    pub fn bricks(&self) -> &[u32] {
        &self.slots
    }

    /// How many slots there is memory for. If it grows, all that is stored by slot is lost.
    pub fn capacity(&self) -> usize {
        self.capacity
    }

    /// The slot of a brick.
    pub fn slot(&self, brick: u32) -> Option<usize> {
        (self.table[brick as usize] as usize).checked_sub(1)
    }

    /// Finds the bricks of the moving triangles anew; returns those whose voxels change, sorted.
    ///
    /// # Errors
    /// The adapter has no buffers as large.
    pub fn move_triangles(
        &mut self,
        gpu: &Gpu,
        triangles: &[Triangle],
        fixed: usize,
    ) -> Result<Vec<u32>, LightError> {
        let new = Layer::new(gpu, &self.volume, triangles, fixed..triangles.len())?;
        let old = std::mem::replace(&mut self.moving, new);
        let before = self.capacity;
        self.assign_slots(gpu)?;
        // Bricks that lose their slot count, too, or their opacity would stay.
        let mut changed = old.bricks;
        if self.capacity != before {
            changed.extend(&self.slots);
        }
        changed.extend(&self.moving.bricks);
        changed.sort_unstable();
        changed.dedup();
        Ok(changed)
    }

    fn assign_slots(&mut self, gpu: &Gpu) -> Result<(), LightError> {
        self.slots.clone_from(&self.fixed.bricks);
        self.slots.extend(self.moving.bricks.iter().filter(|b| self.fixed.bricks.binary_search(b).is_err()));
        self.table.fill(0);
        self.slots.iter().zip(1..).for_each(|(&brick, entry)| self.table[brick as usize] = entry);
        let mut moving = vec![0_u32; self.table.len()];
        self.moving.bricks.iter().zip(1..).for_each(|(&brick, entry)| moving[brick as usize] = entry);
        gpu.queue.write_buffer(&self.tables[0], 0, bytemuck::cast_slice(&self.table));
        gpu.queue.write_buffer(&self.tables[1], 0, bytemuck::cast_slice(&moving));
        if self.slots.len() > self.capacity {
            // Some room for objects that move on.
            let capacity = self.slots.len() + self.moving.bricks.len() / 2;
            self.occupancy = zeros(gpu, OCCUPANCY, capacity as u64 * u64::from(BRICK_CELLS) / 8)?;
            self.surfaces = zeros(gpu, SURFACES, capacity as u64 * u64::from(BRICK_CELLS) * 16)?;
            self.capacity = capacity;
        }
        Ok(())
    }

    /// Adds up the triangles of the layer that stays, or of the one that moves, in sums that were
    /// cleared.
    pub fn voxelize(&self, gpu: &Gpu, encoder: &mut CommandEncoder, moving: bool, others: Others<'_, '_>) {
        let layer = if moving { &self.moving } else { &self.fixed };
        layer.sums.iter().for_each(|sums| encoder.clear_buffer(sums, 0, None));
        if layer.count == 0 {
            return;
        }
        self.voxelize.run_groups(gpu, encoder, layer.count.div_ceil(PAIRS), &|binding| match binding {
            6 => Some(layer.list.as_entire_binding()),
            22 => Some(layer.pairs.as_entire_binding()),
            23 => Some(layer.sums[0].as_entire_binding()),
            24 => Some(layer.sums[1].as_entire_binding()),
            other => others(other),
        });
    }

    /// Makes surfaces and occupancy of both layers' sums, in the bricks of `list` (all of them have
    /// slots).
    pub fn merge(
        &self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        list: &Buffer,
        count: usize,
        others: Others<'_, '_>,
    ) {
        self.merge.run_groups(gpu, encoder, count, &|binding| match binding {
            6 => Some(list.as_entire_binding()),
            25 => Some(self.fixed.sums[0].as_entire_binding()),
            26 => Some(self.fixed.sums[1].as_entire_binding()),
            27 => Some(self.moving.sums[0].as_entire_binding()),
            28 => Some(self.moving.sums[1].as_entire_binding()),
            29 => Some(self.tables[1].as_entire_binding()),
            30 => Some(self.surfaces.as_entire_binding()),
            31 => Some(self.occupancy.as_entire_binding()),
            other => others(other),
        });
    }

    /// The bindings that other kernels read.
    pub fn resource(&self, binding: u32) -> Option<BindingResource<'_>> {
        match binding {
            1 => Some(self.tables[0].as_entire_binding()),
            2 => Some(self.occupancy.as_entire_binding()),
            3 => Some(self.surfaces.as_entire_binding()),
            _ => None,
        }
    }

    /// The stored surfaces of a brick: four words a cell, for tests and programs that want to know.
    ///
    /// # Errors
    /// The device is lost.
    pub fn read_surfaces(&self, gpu: &Gpu) -> Result<Vec<BrickSurfaces>, LightError> {
        let bytes = gpu.read_buffer(&self.surfaces)?;
        let words: Vec<[u32; 4]> = bytemuck::pod_collect_to_vec(&bytes);
        let cells = words.chunks_exact(BRICK_CELLS as usize);
        let mut all: Vec<_> = self.slots.iter().copied().zip(cells.map(<[_]>::to_vec)).collect();
        all.sort_unstable_by_key(|(brick, _)| *brick);
        Ok(all)
    }
}
