//! Lines on a device of which some move from frame to frame.
//!
//! Moved lines are found by comparing vertices, so that nobody can forget to name one. Cells
//! change where moved lines were and are. Values of places stay, but for those of the moved lines
//! and those of which a ray meets a moved line, where it was or where it is: a pass of the next
//! frame sends the rays of all known values through cells that hold nothing else.

use std::ops::Range;

use casca_stage::gpu::Gpu;
use glam::Vec3;

use crate::cells::Cells;
use crate::gpu::error::LinesGpuError;
use crate::gpu::grid::{GpuCells, write_ranges};
use crate::gpu::numeric::CHUNK;
use crate::gpu::set::{BUNDLE, GpuLines, Host, with};
use crate::gpu::settings::Settings;
use crate::numeric::MOST_MOVED;
use crate::sets::{LineSet, arc_lengths_of, tangents_of};

/// Lines on a device, and what the processor must know of them to move a part.
pub struct MovingLines {
    lines: GpuLines,
    host: Host,
    set: LineSet,
    settings: Settings,
    /// Where each segment is in the order of bundles, and the first segment of each line.
    ranks: Vec<u32>,
    firsts: Vec<u32>,
    colours: Option<Vec<[u8; 3]>>,
}

/// How much of a set moved, and what that changed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Moved {
    /// Lines with a vertex at another place.
    pub lines: usize,
    /// Segments of these lines that have a length.
    pub segments: usize,
    /// Cells whose lists changed; 0 if all cells were made anew.
    pub cells: usize,
    /// Whether all cells were made anew: a line left their grid, or they no longer suited it.
    pub new_cells: bool,
    /// Whether all was made anew, and all values of places are lost: there are other lines or
    /// vertices, too many of them moved, or a line shrank or grew to another number of places.
    pub new_lines: bool,
}

impl MovingLines {
    /// Copies lines to the device, as [`GpuLines::new`] does. Memory on the processor: the set, its
    /// cells, 16 bytes a segment, and 4 bytes a place.
    ///
    /// # Errors
    /// The device has no room.
    pub fn new(gpu: &Gpu, set: LineSet, settings: &Settings) -> Result<Self, LinesGpuError> {
        let (lines, host) = GpuLines::with_host(gpu, &set, settings)?;
        let mut ranks = vec![0; host.order.len()];
        for (rank, &segment) in host.order.iter().enumerate() {
            ranks[segment as usize] = rank as u32;
        }
        let mut firsts = vec![0; set.len() + 1];
        set.segments().for_each(|s| firsts[s.line as usize + 1] += 1);
        for i in 0..set.len() {
            firsts[i + 1] += firsts[i];
        }
        Ok(Self { lines, host, set, settings: *settings, ranks, firsts, colours: None })
    }

    /// The lines on the device.
    pub fn lines(&self) -> &GpuLines {
        &self.lines
    }

    /// Puts the cells into parts of 2^`part` words.
    #[cfg(test)]
    pub(super) fn split_cells(&mut self, gpu: &Gpu, part: u32) {
        self.lines.cells = GpuCells::of_parts(gpu, &self.host.cells, part).unwrap();
    }

    /// The lines where they are now.
    pub fn set(&self) -> &LineSet {
        &self.set
    }

    /// Paints the lines, as [`GpuLines::paint`]; they keep their colours when they move.
    ///
    /// # Errors
    /// As there.
    pub fn paint(&mut self, gpu: &Gpu, colours: Option<Vec<[u8; 3]>>) -> Result<(), LinesGpuError> {
        self.lines.paint(gpu, &self.set, colours.as_deref())?;
        self.colours = colours;
        Ok(())
    }

    /// Moves the lines to where they are in `to`. Bundles keep their segments, so their bounds grow
    /// when lines drift apart; [`follow`](crate::gpu::culling::Culling::follow) takes them.
    ///
    /// Time: a comparison of all vertices, a copy of the lists of cells to the device, and
    /// n log n for the n segments that moved; the next frame also sends the rays of all known
    /// values through the moved lines alone. Where all is made anew, as [`Self::new`].
    ///
    /// # Errors
    /// The device has no room. The lines must be made anew, then.
    pub fn update(&mut self, gpu: &Gpu, to: LineSet) -> Result<Moved, LinesGpuError> {
        let alike = to.len() == self.set.len() && (0..to.len()).all(|i| to.range(i) == self.set.range(i));
        let differs = |(_, (a, b)): &(usize, (&[Vec3], &[Vec3]))| a != b;
        let pairs = || self.set.iter().zip(to.iter()).enumerate().filter(differs);
        let moved: Vec<u32> = if alike { pairs().map(|(i, _)| i as u32).collect() } else { Vec::new() };
        if alike && moved.is_empty() {
            self.set = to;
            return Ok(Moved::default());
        }
        let vertices: usize = pairs().map(|(_, (a, _))| a.len()).sum();
        let is_part = alike && vertices as f64 <= to.points().len() as f64 * MOST_MOVED;
        let has_places = self.host.places.as_mut().is_none_or(|p| is_part && p.update(&to, &moved));
        if !is_part || !has_places {
            let all = Self::new(gpu, to, &self.settings)?;
            let colours = self.colours.take();
            *self = all;
            if colours.as_ref().is_none_or(|c| c.len() == self.set.points().len()) {
                self.paint(gpu, colours)?;
            }
            let segments = self.host.cells.ends().len();
            return Ok(Moved { lines: self.set.len(), segments, new_cells: true, new_lines: true, cells: 0 });
        }
        let both = pairs().map(|(_, (a, _))| a.to_vec()).chain(pairs().map(|(_, (_, b))| b.to_vec()));
        let both = LineSet::new(both)?;
        self.set = to;
        let found = self.follow_cells(gpu, &moved)?;
        self.follow_vertices(gpu, &moved)?;
        self.follow_bounds(gpu, &moved)?;
        if let (Some(places), Some(sides)) = (&self.host.places, &self.lines.sides) {
            let cells = GpuCells::new(gpu, &Cells::new(&both, self.host.cells.margin()))?;
            sides.follow(gpu, (places, &moved), cells)?;
        }
        if self.colours.is_some() {
            self.lines.paint(gpu, &self.set, self.colours.as_deref())?;
        }
        Ok(found)
    }

    fn follow_cells(&mut self, gpu: &Gpu, moved: &[u32]) -> Result<Moved, LinesGpuError> {
        let found = match self.host.cells.update(&self.set, moved) {
            Some(change) => {
                self.lines.cells.follow(gpu, &self.host.cells, &change.segments)?;
                let (segments, cells) = (change.segments.len(), change.cells);
                Moved { segments, cells, ..Moved::default() }
            }
            None => {
                self.host.cells = Cells::new(&self.set, self.host.cells.margin());
                self.lines.cells = GpuCells::new(gpu, &self.host.cells)?;
                Moved { segments: self.host.cells.ends().len(), new_cells: true, ..Moved::default() }
            }
        };
        Ok(Moved { lines: moved.len(), ..found })
    }

    fn follow_vertices(&self, gpu: &Gpu, moved: &[u32]) -> Result<(), LinesGpuError> {
        let ranges: Vec<Range<usize>> =
            moved.iter().filter_map(|&line| self.set.range(line as usize)).collect();
        let lines = || ranges.iter().map(|r| &self.set.points()[r.clone()]);
        let vertices: Vec<[f32; 4]> =
            lines().flat_map(|l| l.iter().zip(arc_lengths_of(l)).map(|(p, way)| with(p, way))).collect();
        let tangents: Vec<[f32; 4]> = lines().flat_map(tangents_of).map(|t| with(&t, 0.0)).collect();
        write_ranges(gpu, &self.lines.vertices, &ranges, &vertices)?;
        write_ranges(gpu, &self.lines.tangents, &ranges, &tangents)?;
        Ok(())
    }

    /// Bounds of the bundles and chunks that hold moved segments.
    fn follow_bounds(&mut self, gpu: &Gpu, moved: &[u32]) -> Result<(), LinesGpuError> {
        let segments = moved.iter().map(|&l| self.firsts[l as usize]..self.firsts[l as usize + 1]);
        let ranks = segments.flatten().map(|s| self.ranks[s as usize]);
        let mut chunks: Vec<usize> = ranks.map(|rank| (rank / CHUNK) as usize).collect();
        chunks.sort_unstable();
        chunks.dedup();
        let corners: Vec<[f32; 4]> = chunks
            .iter()
            .flat_map(|c| self.host.bounds(&self.set, c * CHUNK as usize, CHUNK))
            .map(|corner| with(&corner, 0.0))
            .collect();
        let ranges: Vec<Range<usize>> = chunks.iter().map(|c| 2 * c..2 * c + 2).collect();
        write_ranges(gpu, &self.lines.corners, &ranges, &corners)?;
        let mut bundles: Vec<usize> = chunks.iter().map(|c| c * CHUNK as usize / BUNDLE as usize).collect();
        bundles.dedup();
        for bundle in bundles {
            let bounds = self.host.bounds(&self.set, bundle * BUNDLE as usize, BUNDLE);
            self.lines.bundles_mut()[bundle].bounds = bounds;
        }
        Ok(())
    }
}
