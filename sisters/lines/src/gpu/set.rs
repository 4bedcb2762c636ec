//! Lines in the memory of a device, in bundles.

use casca_stage::gpu::Gpu;
use casca_stage::kernel::filled;
use casca_stage::wgpu::{Buffer, BufferUsages};
use glam::Vec3;
use rayon::prelude::*;

use crate::cells::Cells;
use crate::gpu::error::LinesGpuError;
use crate::gpu::rays::GpuCells;
use crate::gpu::settings::Settings;
use crate::gpu::sides::GpuSides;
use crate::occlusion::{Estimator, OptionsError};
use crate::places::Places;
use crate::sets::LineSet;

/// Segments of a bundle: enough that the objects of a scene are few, so few that a bundle is small.
pub const BUNDLE: u32 = 256;
/// Segments of a workgroup.
const CHUNK: u32 = 64;
/// The bit of a segment without length in the number of its vertex.
const DOT: u32 = 1 << 31;
/// Cells along a side of the grid whose order bundles follow.
const CELLS: f32 = 1024.0;

/// Segments that lie near each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bundle {
    /// The least and the greatest corner of its bounds.
    pub bounds: [Vec3; 2],
    /// Its first segment in the order of bundles.
    pub(super) first: u32,
    /// The number of its segments.
    pub segments: u32,
}

/// Lines in the memory of a device.
pub struct GpuLines {
    pub(super) vertices: Buffer,
    pub(super) tangents: Buffer,
    pub(super) segments: Buffer,
    pub(super) order: Buffer,
    pub(super) cells: GpuCells,
    /// For each segment the colours of its ends and the ways along its line to them.
    pub(super) colours: Buffer,
    pub(super) coloured: bool,
    pub(super) sides: Option<GpuSides>,
    margin: f32,
    bundles: Vec<Bundle>,
    vertex_count: usize,
}

impl GpuLines {
    /// Copies lines to the device and puts segments that lie near each other into bundles of
    /// [`BUNDLE`], and into the [`Cells`] that settings need. With [`Estimator::Places`] it also
    /// puts places along them.
    ///
    /// Time: n log n for n segments on all cores. Memory on the device: 32 bytes a vertex, 12 a
    /// segment, and as much as the cells take; 16 bytes a line and 22 a place.
    ///
    /// [`Estimator::Places`]: crate::occlusion::Estimator::Places
    ///
    /// # Errors
    /// The device has no room.
    pub fn new(gpu: &Gpu, lines: &LineSet, settings: &Settings) -> Result<Self, LinesGpuError> {
        let points = lines.points();
        let vertices: Vec<[f32; 4]> =
            points.iter().zip(lines.arc_lengths()).map(|(p, along)| with(p, along)).collect();
        let tangents: Vec<[f32; 4]> = lines.tangents().iter().map(|t| with(t, 0.0)).collect();
        let segments: Vec<[u32; 2]> =
            lines.segments().map(|s| [s.a | if s.a == s.b { DOT } else { 0 }, s.line]).collect();
        let ends: Vec<[Vec3; 2]> = lines.segments().map(|s| [s.a, s.b].map(|v| points[v as usize])).collect();
        let order = near_order(&ends, lines.bounds());
        let bundle = |(i, members): (usize, &[u32])| {
            let all = members.iter().flat_map(|&s| ends[s as usize]);
            let start = [Vec3::INFINITY, Vec3::NEG_INFINITY];
            let bounds = all.fold(start, |[min, max], p| [min.min(p), max.max(p)]);
            Bundle { bounds, first: i as u32 * BUNDLE, segments: members.len() as u32 }
        };
        let bundles = order.chunks(BUNDLE as usize).enumerate().map(bundle).collect();
        let sides = match settings.ao.estimator {
            Estimator::Places { step, .. } => Some(GpuSides::new(gpu, &Places::new(lines, step), step)?),
            _ => None,
        };
        let cells = Cells::new(lines, settings.ao.margin());
        let usage = BufferUsages::STORAGE;
        Ok(Self {
            vertices: filled(gpu, &vertices, usage)?,
            tangents: filled(gpu, &tangents, usage)?,
            segments: filled(gpu, &segments, usage)?,
            order: filled(gpu, &order, usage)?,
            cells: GpuCells::new(gpu, &cells)?,
            colours: filled(gpu, &[[0u32; 4]], usage)?,
            coloured: false,
            sides,
            margin: cells.margin(),
            bundles,
            vertex_count: points.len(),
        })
    }

    /// Paints the lines in these colours, bytes of sRGB for each vertex of the set that was copied;
    /// without them each line is painted in a pale colour of its own.
    ///
    /// Memory on the device: 16 bytes a segment.
    ///
    /// # Errors
    /// There are not as many colours as vertices, or the device has no room.
    pub fn paint(
        &mut self,
        gpu: &Gpu,
        lines: &LineSet,
        colours: Option<&[[u8; 3]]>,
    ) -> Result<(), LinesGpuError> {
        let along = lines.arc_lengths();
        let all: Vec<[u32; 4]> = match colours {
            Some(colours) if colours.len() == self.vertex_count && along.len() == self.vertex_count => {
                let word = |v: u32| {
                    let [r, g, b] = colours[v as usize];
                    u32::from_le_bytes([r, g, b, 255])
                };
                let way = |v: u32| along[v as usize].to_bits();
                lines.segments().map(|s| [word(s.a), word(s.b), way(s.a), way(s.b)]).collect()
            }
            Some(colours) => {
                let (colours, vertices) = (colours.len().min(along.len()), self.vertex_count);
                return Err(LinesGpuError::Colours { colours, vertices });
            }
            None => vec![[0; 4]],
        };
        self.colours = filled(gpu, &all, BufferUsages::STORAGE)?;
        self.coloured = colours.is_some();
        Ok(())
    }

    /// The bundles.
    pub fn bundles(&self) -> &[Bundle] {
        &self.bundles
    }

    /// Whether the cells and places suit settings: their margin and step are within a factor of 2
    /// of the best ones.
    pub fn suits(&self, settings: &Settings) -> bool {
        let near = |now: f32, best: f32| (best / 2.0..=best * 2.0).contains(&now);
        let places = match (settings.ao.estimator, &self.sides) {
            (Estimator::Places { step, .. }, Some(sides)) => near(sides.step(), step),
            (Estimator::Places { .. }, None) => false,
            _ => true,
        };
        places && near(self.margin, settings.ao.margin())
    }

    /// The values of places that settings take, if they take some; or why these lines have not what
    /// the settings need.
    pub(super) fn sides_for(&self, settings: &Settings) -> Result<Option<&GpuSides>, LinesGpuError> {
        let radius = settings.ao.estimator.line_radius();
        if radius > self.margin {
            return Err(OptionsError::Margin { radius, margin: self.margin }.into());
        }
        match (settings.by_places(), &self.sides) {
            (false, _) => Ok(None),
            (true, None) => Err(LinesGpuError::Places),
            (true, sides) => Ok(sides.as_ref()),
        }
    }

    /// The number of places along the lines.
    pub fn places(&self) -> u32 {
        self.sides.as_ref().map_or(0, GpuSides::count)
    }

    /// The next frame sends the rays of all places that it needs anew.
    pub fn forget(&self) {
        self.sides.iter().for_each(GpuSides::forget);
    }

    /// The number of vertices.
    pub fn vertices(&self) -> usize {
        self.vertex_count
    }

    /// The memory on the device in bytes.
    pub fn bytes(&self) -> u64 {
        let own = [&self.vertices, &self.tangents, &self.segments, &self.order];
        let own: u64 = own.map(Buffer::size).iter().sum();
        own + self.cells.bytes() + self.sides.as_ref().map_or(0, GpuSides::bytes)
    }

    /// The workgroups of some bundles: the first segment and the number of segments of each.
    pub(super) fn chunks(&self, bundles: &[u32]) -> Result<Vec<[u32; 2]>, LinesGpuError> {
        let mut chunks = Vec::with_capacity(bundles.len() * (BUNDLE / CHUNK) as usize);
        for &number in bundles {
            let unknown = LinesGpuError::Bundle { number, bundles: self.bundles.len() };
            let bundle = self.bundles.get(number as usize).ok_or(unknown)?;
            let part = |at| [bundle.first + at, CHUNK.min(bundle.segments - at)];
            chunks.extend((0..bundle.segments).step_by(CHUNK as usize).map(part));
        }
        Ok(chunks)
    }
}

/// A vector as shaders read it, with a number behind it.
fn with(v: &Vec3, w: f32) -> [f32; 4] {
    [v.x, v.y, v.z, w]
}

/// Segments in an order in which neighbours lie near each other: along the Z-curve through their
/// middles (Morton 1966, "A computer oriented geodetic data base and a new technique in file
/// sequencing").
fn near_order(ends: &[[Vec3; 2]], [min, max]: [Vec3; 2]) -> Vec<u32> {
    // Bounds of opposite huge coordinates: halves do not overflow.
    let size = (max * 0.5 - min * 0.5).max_element().max(f32::MIN_POSITIVE);
    let spread = |v: f32| {
        let v = (v * CELLS).clamp(0.0, CELLS - 1.0) as u32;
        (0..10).fold(0u32, |code, bit| code | (v >> bit & 1) << (3 * bit))
    };
    let code = |[a, b]: &[Vec3; 2]| {
        let at = ((*a * 0.5 - min * 0.5) + (*b * 0.5 - min * 0.5)) / (2.0 * size);
        spread(at.x) | spread(at.y) << 1 | spread(at.z) << 2
    };
    let mut keys: Vec<(u32, u32)> = ends.par_iter().map(code).zip(0..ends.len() as u32).collect();
    keys.par_sort_unstable();
    keys.into_iter().map(|(_, segment)| segment).collect()
}
