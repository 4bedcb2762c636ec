//! The source of compressed points: what their bytes make `laz` do is checked while it reads them.
//!
//! Lengths of layers (LAS 1.4, formats 6 to 10) are checked before it reserves memory for them, and
//! the depth of the stack before it overflows.

use laz::{LazItemType, LazVlr};
use std::io::{self, BufRead, Read, Seek, SeekFrom};
use std::ops::Range;

/// Bytes of stack that the decoder may have in use when it reads: a time of a point (formats 1 and
/// 3 to 5) may refer to another sequence of times, that to another, and it recurses on each.
const MOST_STACK: usize = 1 << 20;
/// The stack that decoding needs. Between two reads it grows further: each of the six symbols has
/// at least 2^-15 of the probability, so 36,400 references may lie in a byte. They take 0.9 kB each
/// in a build without optimisation.
pub(super) const STACK: usize = 64 << 20;

/// The source of a decoder. Each chunk is a point, the number of points, the length of each layer
/// (u32), and the layers.
pub(super) struct Layers<S> {
    source: S,
    /// Where the number of points and the lengths stand in a chunk; nowhere where points are not in layers.
    lengths: Range<usize>,
    /// Bytes of this chunk that were read, and those of them that are lengths.
    at: usize,
    read: Vec<u8>,
    /// Bytes from here to the end of the file, once the chunks have begun.
    left: Option<u64>,
    length: u64,
    /// Points of this chunk, once its first one was read, where points lie in layers; or 0.
    pub points: u64,
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
        let point = vlr.items().iter().map(|item| usize::from(item.size())).sum();
        let layers: usize = vlr.items().iter().map(|item| layers(item.item_type())).sum();
        let lengths = if layers > 0 { point..point + 4 + 4 * layers } else { 0..0 };
        Self { source, lengths, at: 0, read: Vec::new(), left: None, length, points: 0, stack: None }
    }

    /// Says that the source is at a chunk.
    pub fn begin(&mut self) -> io::Result<()> {
        self.left = Some(self.length.saturating_sub(self.source.stream_position()?));
        (self.at, self.points) = (0, 0);
        self.read.clear();
        Ok(())
    }

    /// Says that decoding begins, on a stack of [`STACK`].
    pub fn watch(&mut self) {
        self.stack = Some(stack());
    }

    /// Checks the lengths of a chunk, behind which so many bytes are left.
    fn check(&mut self, left: u64) -> io::Result<()> {
        let number = |bytes: &[u8]| bytes.iter().rev().fold(0, |n, &byte| n << 8 | u64::from(byte));
        let mut numbers = self.read.chunks_exact(4).map(number);
        self.points = numbers.next().unwrap_or(0);
        let sum: u64 = numbers.sum();
        if sum > left {
            let cause = format!("a chunk has layers of {sum} bytes, the file {left} more");
            return Err(io::Error::new(io::ErrorKind::InvalidData, cause));
        }
        Ok(())
    }
}

impl<S: BufRead + Seek> Read for Layers<S> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if self.stack.is_some_and(|start| stack().abs_diff(start) > MOST_STACK) {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "a time refers to others without end"));
        }
        let Some(left) = self.left.filter(|_| !self.lengths.is_empty()) else {
            return self.source.read(into);
        };
        // No read goes over the begin or the end of the lengths.
        let ends = [self.lengths.start, self.lengths.end].into_iter();
        let most = ends.filter(|&end| end > self.at).map(|end| end - self.at).min().unwrap_or(usize::MAX);
        let most = most.min(into.len());
        let read = self.source.read(&mut into[..most])?;
        let left = left.saturating_sub(read as u64);
        self.left = Some(left);
        let is_length = self.lengths.contains(&self.at);
        self.at = self.at.saturating_add(read);
        if is_length {
            self.read.extend_from_slice(&into[..read]);
            if self.at == self.lengths.end {
                self.check(left)?;
            }
        }
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
