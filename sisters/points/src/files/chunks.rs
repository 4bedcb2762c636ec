//! Compressed points, chunk by chunk, by the decoders of `laz`.
//!
//! Not by its `LasZipDecompressor`: that panics where a table of chunks is too short, and loses the
//! points before a fault.

use super::head::{Head, Packed};
use super::layers::{Layers, STACK};
use super::sink::{PANICKED, Source, guarded, plain};
use laz::DecompressionSelection;
use laz::laszip::ChunkTable;
use laz::record::{LayeredPointRecordDecompressor, RecordDecompressor, SequentialPointRecordDecompressor};
use std::io::{Seek, SeekFrom};
use std::thread;
use std::vec::IntoIter;

/// Bytes of the first point of a chunk, at least: it is not compressed.
const LEAST_RECORD: u64 = 20;

/// The points of a file, in their order.
pub(super) struct Chunks<S: Source> {
    decoder: Box<dyn RecordDecompressor<Layers<S>> + Send + Sync>,
    packed: Packed,
    /// Bytes of a point.
    record: usize,
    /// Points and bytes of the chunks that come, where a table says them, and where the next begins.
    table: Option<IntoIter<(u64, u64)>>,
    next: u64,
    /// Points of this chunk that come.
    left: u64,
}

/// Records of points; and why those behind them are missing, and how many.
pub(super) type Batch = (Vec<u8>, Option<(String, u64)>);

impl<S: Source> Chunks<S> {
    /// Of a file, whose source is at its points.
    pub fn new(mut source: S, head: &Head, packed: &Packed) -> Result<Self, String> {
        let is_one = packed.is_one_chunk;
        let table = if is_one { None } else { table(&mut source, head, packed) };
        let first = if is_one { head.start } else { head.start + 8 };
        source.seek(SeekFrom::Start(first)).map_err(plain)?;
        let is_layered = packed.vlr.items().first().is_some_and(|item| item.version() > 2);
        if packed.vlr.uses_variable_size_chunks() && !is_one && !is_layered && table.is_none() {
            return Err("the table of its chunks, whose sizes vary, cannot be read".into());
        }
        let layers = Layers::new(source, &packed.vlr, head.length);
        let decoder: Box<dyn RecordDecompressor<Layers<S>> + Send + Sync> = match is_layered {
            true => Box::new(LayeredPointRecordDecompressor::new(layers)),
            false => Box::new(SequentialPointRecordDecompressor::new(layers)),
        };
        let (packed, record) = (packed.clone(), head.layout.record);
        Ok(Self { decoder, packed, record, table: table.map(Vec::into_iter), next: first, left: 0 })
    }

    /// The next points, at most so many.
    pub fn next(&mut self, most: u64) -> Batch {
        let mut records = room(most, self.record);
        let mut read = 0;
        let decoded = thread::scope(|scope| {
            let decode = || self.fill(&mut records, &mut read);
            let decoding = thread::Builder::new().stack_size(STACK).spawn_scoped(scope, decode);
            decoding.map_err(plain)?.join().unwrap_or_else(|_| Err(PANICKED.into()))
        });
        records.truncate(read * self.record);
        let gap = decoded.err().map(|cause| {
            let left = most - read as u64;
            // Those of this chunk, if there is another one that can be found.
            let points = self.left.min(left);
            self.left = 0;
            let has_next = self.table.as_ref().is_some_and(|table| table.len() > 0);
            (cause, if has_next { points } else { left })
        });
        (records, gap)
    }

    /// Decodes points, and counts them.
    fn fill(&mut self, records: &mut [u8], read: &mut usize) -> Result<(), String> {
        self.decoder.get_mut().watch();
        for record in records.chunks_exact_mut(self.record) {
            let is_first = self.left == 0;
            if is_first {
                self.go_to_next()?;
            }
            self.decoder.decompress_next(record).map_err(plain)?;
            if is_first && self.left == 0 {
                // The size of a chunk that only the chunk itself says.
                self.left = self.decoder.get().points.max(1);
            }
            self.left -= 1;
            *read += 1;
        }
        Ok(())
    }

    /// Goes to the next chunk; its points are 0 if only itself says how many.
    fn go_to_next(&mut self) -> Result<(), String> {
        let vlr = &self.packed.vlr;
        let fixed = (!vlr.uses_variable_size_chunks()).then(|| u64::from(vlr.chunk_size()));
        if self.packed.is_one_chunk {
            self.left = u64::MAX;
        } else if let Some(table) = &mut self.table {
            let (points, bytes) = table.next().ok_or("the table of its chunks ends here")?;
            self.left = fixed.unwrap_or(points);
            self.decoder.get_mut().seek(SeekFrom::Start(self.next)).map_err(plain)?;
            self.next = self.next.saturating_add(bytes);
        } else {
            self.left = fixed.unwrap_or(0);
        }
        self.decoder.get_mut().begin().map_err(plain)?;
        self.decoder.reset();
        self.decoder.set_fields_from(self.packed.vlr.items()).map_err(plain)?;
        // Not the layers of times: the decoder would recurse as often as a file says.
        self.decoder.set_selection(DecompressionSelection::base().decompress_z().decompress_rgb());
        Ok(())
    }
}

/// The points and bytes of chunks, if their table is there and agrees with the file.
///
/// Compressed points begin with the offset of the table, or -1 and the file ends with it. Each
/// chunk has at least a point.
fn table(source: &mut impl Source, head: &Head, packed: &Packed) -> Option<Vec<(u64, u64)>> {
    let mut number = |from: SeekFrom| {
        let mut bytes = [0; 8];
        source.seek(from)?;
        source.read_exact(&mut bytes).map(|()| u64::from_le_bytes(bytes))
    };
    let mut at = number(SeekFrom::Start(head.start)).ok()?;
    if at as i64 <= head.start as i64 {
        at = number(SeekFrom::End(-8)).ok()?;
    }
    let count = number(SeekFrom::Start(at)).ok()? >> 32;
    if count > head.length / LEAST_RECORD {
        return None;
    }
    source.seek(SeekFrom::Start(at)).ok()?;
    let is_varied = packed.vlr.uses_variable_size_chunks();
    let table = guarded(|| ChunkTable::read(&mut *source, is_varied)).ok()?;
    let entries: Vec<_> = table.as_ref().iter().map(|entry| (entry.point_count, entry.byte_count)).collect();
    let bytes = entries.iter().try_fold(head.start + 8, |sum, entry| sum.checked_add(entry.1));
    let is_sound = bytes == Some(at) && entries.iter().all(|entry| !is_varied || entry.0 > 0);
    (is_sound && !entries.is_empty()).then_some(entries)
}

/// Points that are decoded at once.
const BATCH: u64 = 1 << 16;
/// Bytes of points that are decoded at once, at most: records may have 64 KiB.
const BATCH_BYTES: u64 = 1 << 22;

/// Bytes for the next of the points that are `left`.
pub(super) fn room(left: u64, record: usize) -> Vec<u8> {
    let count = left.min(BATCH).min((BATCH_BYTES / record as u64).max(1));
    vec![0; count as usize * record]
}
