//! Numbers from bytes.

use glam::Vec3;

use super::error::{FileError, broken};

/// The bytes of a file, from a place on.
pub(super) struct Bytes<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) at: usize,
    /// Whether numbers start with their highest byte.
    pub(super) big: bool,
}

impl<'a> Bytes<'a> {
    pub(super) fn take(&mut self, count: usize) -> Result<&'a [u8], FileError> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let Some(taken) = rest.get(..count) else {
            return Err(broken("byte", self.at, format!("the file ends within the next {count} bytes")));
        };
        self.at += count;
        Ok(taken)
    }

    pub(super) fn array<const N: usize>(&mut self) -> Result<[u8; N], FileError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        if self.big {
            array.reverse();
        }
        Ok(array)
    }

    pub(super) fn f32(&mut self) -> Result<f32, FileError> {
        self.array().map(f32::from_le_bytes)
    }

    pub(super) fn i32(&mut self) -> Result<i32, FileError> {
        self.array().map(i32::from_le_bytes)
    }

    pub(super) fn point(&mut self) -> Result<Vec3, FileError> {
        Ok(Vec3::new(self.f32()?, self.f32()?, self.f32()?))
    }

    pub(super) fn left(&self) -> usize {
        self.bytes.len().saturating_sub(self.at)
    }
}
