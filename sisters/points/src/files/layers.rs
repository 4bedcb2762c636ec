//! The source of compressed points: what their bytes make `laz` do is checked while it reads them.
//!
//! Lengths of layers (LAS 1.4, formats 6 to 10) are checked before it reserves memory for them, and
//! the depth of the stack before it overflows.

use std::io::{self, BufRead, Read, Seek, SeekFrom};

use laz::{LazItemType, LazVlr};

/// Bytes of stack that the decoder may have in use when it reads: a time of a point (formats 1 and
/// 3 to 5) may refer to another sequence of times, that to another, and it recurses on each.
const MOST_STACK: usize = 1 << 20;
/// The stack that decoding needs. Between two reads it grows further: each of the six symbols has
/// at least 2^-15 of the probability, so 36,400 references may lie in a byte. They take 0.9 kB each
/// in a build without optimisation.
pub(super) const STACK: usize = 64 << 20;

/// What the next bytes of a chunk are.
enum Part {
    /// Some bytes that no length stands in: the first point, or the layers.
    Bytes(u64),
    /// The number of points and the lengths of the layers: their bytes so far.
    Lengths(Vec<u8>),
}

/// The source of a decoder. Each chunk is a point, the number of points, the length of each layer
/// (u32), and the layers.
pub(super) struct Layers<S> {
    source: S,
    /// Bytes of a point; layers of a chunk, none where points are not in layers.
    point: u64,
    layers: usize,
    /// Bytes from here to the end of the file, once the chunks have begun.
    left: Option<u64>,
    length: u64,
    part: Part,
    /// Points of this chunk, if it says them.
    points: u64,
    /// Whether the layers come next.
    after_lengths: bool,
    /// Where the stack was when decoding began.
    stack: Option<usize>,
}

/// About where the stack of the thread is.
#[inline(never)]
fn stack() -> usize {
    let here = 0_u8;
    std::ptr::from_ref(std::hint::black_box(&here)).addr()
}

impl<S: BufRead + Seek> Layers<S> {
    /// Of a file of `length` bytes. Nothing is checked before [`Self::begin`].
    pub fn new(source: S, vlr: &LazVlr, length: u64) -> Self {
        let layers = |kind: LazItemType| match kind {
            LazItemType::Point14 => 9,
            LazItemType::RGBNIR14 => 2,
            LazItemType::RGB14 | LazItemType::WavePacket14 => 1,
            LazItemType::Byte14(count) => count.into(),
            _ => 0,
        };
        let point = vlr.items().iter().map(|item| u64::from(item.size())).sum();
        let layers = vlr.items().iter().map(|item| layers(item.item_type())).sum();
        Self {
            source,
            point,
            layers,
            left: None,
            length,
            part: Part::Bytes(point),
            points: 0,
            after_lengths: false,
            stack: None,
        }
    }

    /// The points of the chunk, once its first one was read, where points lie in layers; or 0.
    pub fn points(&self) -> u64 {
        self.points
    }

    /// Says that the source is at a chunk.
    pub fn begin(&mut self) -> io::Result<()> {
        self.left = Some(self.length.saturating_sub(self.source.stream_position()?));
        self.part = Part::Bytes(self.point);
        self.points = 0;
        self.after_lengths = false;
        Ok(())
    }

    /// Says that decoding begins, on a stack of [`STACK`].
    pub fn watch(&mut self) {
        self.stack = Some(stack());
    }

    /// The bytes of a read that lie in one part; the parts go on where one is full.
    fn limit(&mut self, wanted: usize) -> usize {
        let lengths = 4 + 4 * self.layers;
        if let Part::Bytes(0) = self.part {
            self.part = match self.after_lengths {
                true => Part::Bytes(self.point),
                false => Part::Lengths(Vec::with_capacity(lengths)),
            };
            self.after_lengths = !self.after_lengths;
        }
        match &self.part {
            Part::Bytes(left) => wanted.min(usize::try_from(*left).unwrap_or(usize::MAX)),
            Part::Lengths(bytes) => wanted.min(lengths - bytes.len()),
        }
    }

    /// Takes note of bytes that were read.
    fn note(&mut self, read: &[u8], left: u64) -> io::Result<()> {
        match &mut self.part {
            Part::Bytes(rest) => *rest -= read.len() as u64,
            Part::Lengths(bytes) => {
                bytes.extend_from_slice(read);
                if bytes.len() == 4 + 4 * self.layers {
                    let mut numbers =
                        bytes.chunks_exact(4).map(|b| b.iter().rev().fold(0, |n, &b| n << 8 | u64::from(b)));
                    self.points = numbers.next().unwrap_or(0);
                    let sum: u64 = numbers.sum();
                    if sum > left {
                        let cause = format!("a chunk has layers of {sum} bytes, the file {left} more");
                        return Err(io::Error::new(io::ErrorKind::InvalidData, cause));
                    }
                    self.part = Part::Bytes(sum);
                }
            }
        }
        Ok(())
    }
}

impl<S: BufRead + Seek> Read for Layers<S> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if self.stack.is_some_and(|start| stack().abs_diff(start) > MOST_STACK) {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "a time refers to others without end"));
        }
        let Some(left) = self.left.filter(|_| self.layers > 0) else { return self.source.read(into) };
        let most = self.limit(into.len());
        let read = self.source.read(&mut into[..most])?;
        let left = left.saturating_sub(read as u64);
        self.left = Some(left);
        self.note(&into[..read], left)?;
        Ok(read)
    }
}

impl<S: BufRead + Seek> Seek for Layers<S> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        // Layers that the decoder passes over: their bytes count as read.
        if let (Some(_), SeekFrom::Current(skipped @ 0..)) = (self.left, to) {
            io::copy(&mut self.by_ref().take(skipped as u64), &mut io::sink())?;
            return self.source.stream_position();
        }
        self.source.seek(to)
    }
}
