//! Packed numbers, within limits: a small file must not fill the memory.

use std::io::Read;

use flate2::read::ZlibDecoder;

use super::error::{FileError, refused};

/// How many times its size a file may unpack to: arrays of one number pack a thousand times, but
/// coordinates hardly twice.
const MOST_UNPACKED: usize = 64;
/// Bytes that any file may unpack to.
const ANYWAY: usize = 1 << 20;

/// The bytes that a file may still unpack to.
pub(super) struct Room(usize);

impl Room {
    /// For a file of so many bytes.
    pub(super) fn of_file(bytes: usize) -> Self {
        Self(bytes.saturating_mul(MOST_UNPACKED).saturating_add(ANYWAY))
    }

    /// Takes some.
    pub(super) fn take(&mut self, bytes: usize) -> Result<(), FileError> {
        let why = || format!("the file unpacks to more than {MOST_UNPACKED} times its size");
        self.0 = self.0.checked_sub(bytes).ok_or_else(|| refused(why()))?;
        Ok(())
    }

    /// Appends what a reader gives: so many bytes.
    pub(super) fn read(&mut self, from: impl Read, size: usize, to: &mut Vec<u8>) -> Result<(), FileError> {
        self.take(size)?;
        let before = to.len();
        let limit = (size as u64).saturating_add(1);
        from.take(limit).read_to_end(to).map_err(|why| refused(format!("packed data are damaged: {why}")))?;
        match to.len() - before == size {
            true => Ok(()),
            false => Err(refused(format!("packed data are not of the {size} bytes that were promised"))),
        }
    }

    /// Appends what a block of zlib holds.
    pub(super) fn zlib(&mut self, block: &[u8], size: usize, to: &mut Vec<u8>) -> Result<(), FileError> {
        self.read(ZlibDecoder::new(block), size, to)
    }
}
