//! The numbers and lists of a file, read one after another.

use glam::{DVec3, Vec3};

use crate::error::FileError;

/// The rest of the contents, and the section that is being read.
pub(crate) struct Contents<'a> {
    pub(crate) rest: &'a [u8],
    pub(crate) section: &'static str,
}

impl Contents<'_> {
    pub(crate) fn take<const N: usize>(&mut self) -> Result<[u8; N], FileError> {
        let Some((head, rest)) = self.rest.split_first_chunk() else { return Err(self.short(N as u64)) };
        self.rest = rest;
        Ok(*head)
    }

    pub(crate) fn short(&self, needed: u64) -> FileError {
        FileError::Section { section: self.section, needed, held: self.rest.len() as u64 }
    }

    pub(crate) fn flag(&mut self, entry: usize) -> Result<bool, FileError> {
        match self.take()? {
            [0] => Ok(false),
            [1] => Ok(true),
            _ => Err(self.broken(entry, "has a flag that is neither 0 nor 1")),
        }
    }

    pub(crate) fn u16(&mut self) -> Result<u16, FileError> {
        self.take().map(u16::from_le_bytes)
    }

    pub(crate) fn u32(&mut self) -> Result<u32, FileError> {
        self.take().map(u32::from_le_bytes)
    }

    pub(crate) fn u64(&mut self) -> Result<u64, FileError> {
        self.take().map(u64::from_le_bytes)
    }

    pub(crate) fn f32(&mut self) -> Result<f32, FileError> {
        self.take().map(f32::from_le_bytes)
    }

    pub(crate) fn f64(&mut self) -> Result<f64, FileError> {
        self.take().map(f64::from_le_bytes)
    }

    pub(crate) fn vec3(&mut self) -> Result<Vec3, FileError> {
        Ok(Vec3::new(self.f32()?, self.f32()?, self.f32()?))
    }

    pub(crate) fn dvec3(&mut self) -> Result<DVec3, FileError> {
        Ok(DVec3::new(self.f64()?, self.f64()?, self.f64()?))
    }

    pub(crate) fn broken(&self, entry: usize, why: &'static str) -> FileError {
        FileError::Entry { section: self.section, entry, why }
    }

    /// Refuses an entry of the section unless a condition holds.
    pub(crate) fn check(&self, entry: usize, holds: bool, why: &'static str) -> Result<(), FileError> {
        if holds { Ok(()) } else { Err(self.broken(entry, why)) }
    }

    /// Entries of at least `size` bytes each.
    pub(crate) fn list<T>(
        &mut self,
        count: u64,
        size: u64,
        mut entry: impl FnMut(&mut Self, usize) -> Result<T, FileError>,
    ) -> Result<Vec<T>, FileError> {
        let needed = count.saturating_mul(size);
        if needed > self.rest.len() as u64 {
            return Err(self.short(needed));
        }
        let mut entries = Vec::with_capacity(count as usize);
        for i in 0..count as usize {
            entries.push(entry(self, i)?);
        }
        Ok(entries)
    }

    /// A section of entries of at least `size` bytes each.
    pub(crate) fn section<T>(
        &mut self,
        name: &'static str,
        size: u64,
        entry: impl FnMut(&mut Self, usize) -> Result<T, FileError>,
    ) -> Result<Vec<T>, FileError> {
        self.section = name;
        let count = self.u64()?;
        self.list(count, size, entry)
    }
}
