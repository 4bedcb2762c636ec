//! Journals: the cells that are done, so that a bake that was killed goes on where it was.
//!
//! A journal begins with a magic word and 32 bytes that tell the bake from others. Then come
//! records: the length of the rest in bytes, its CRC-32, the cell and its objects, each as four
//! bytes, little-endian. What follows the last whole record is cut off when the journal is opened.

use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::error::BakeError;

const MAGIC: [u8; 8] = *b"CASCAJR1";

/// The bytes before the first record.
const HEADER: usize = MAGIC.len() + 32;

/// A cell and its set.
pub(crate) type Done = (u32, Vec<u32>);

/// An open journal.
pub(crate) struct Journal {
    file: File,
    path: PathBuf,
}

impl Journal {
    /// Opens a journal, or begins one. Returns the cells that are done.
    pub(crate) fn open(path: &Path, bake: &[u8; 32]) -> Result<(Self, Vec<Done>), BakeError> {
        let open = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path);
        let mut file = open.map_err(BakeError::file("open", path))?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(BakeError::file("read", path))?;
        let header = [&MAGIC[..], bake].concat();
        // A bake may be killed before its header is whole.
        if bytes.len() < HEADER && header.starts_with(&bytes) {
            bytes = header;
            file.set_len(0).map_err(BakeError::file("write", path))?;
            file.seek(SeekFrom::Start(0)).map_err(BakeError::file("write", path))?;
            file.write_all(&bytes).map_err(BakeError::file("write", path))?;
        } else if !bytes.starts_with(&header) {
            return Err(BakeError::OtherJournal(path.to_owned()));
        }
        let (mut done, mut at) = (Vec::new(), HEADER);
        while let Some((record, next)) = record(&bytes, at) {
            done.push(record);
            at = next;
        }
        file.set_len(at as u64).map_err(BakeError::file("write", path))?;
        file.seek(SeekFrom::End(0)).map_err(BakeError::file("write", path))?;
        Ok((Self { file, path: path.to_owned() }, done))
    }

    /// Notes a cell, in one write.
    pub(crate) fn note(&mut self, cell: u32, set: &[u32]) -> Result<(), BakeError> {
        let body: Vec<u8> = [cell].iter().chain(set).flat_map(|n| n.to_le_bytes()).collect();
        let mut record = Vec::with_capacity(body.len() + 8);
        record.extend((body.len() as u32).to_le_bytes());
        record.extend(crc32fast::hash(&body).to_le_bytes());
        record.extend(body);
        self.file.write_all(&record).map_err(BakeError::file("write", &self.path))
    }

    /// Deletes it.
    pub(crate) fn remove(self) -> Result<(), BakeError> {
        drop(self.file);
        std::fs::remove_file(&self.path).map_err(BakeError::file("delete", &self.path))
    }
}

/// The record at a place, and where the next one begins.
fn record(bytes: &[u8], at: usize) -> Option<(Done, usize)> {
    let number = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    let (length, crc) = (number(at)? as usize, number(at + 4)?);
    let next = (at + 8).checked_add(length)?;
    let body = bytes.get(at + 8..next)?;
    if length % 4 != 0 || crc32fast::hash(body) != crc {
        return None;
    }
    let mut numbers = body.chunks_exact(4).map(|n| u32::from_le_bytes([n[0], n[1], n[2], n[3]]));
    let cell = numbers.next()?;
    Some(((cell, numbers.collect()), next))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_journal_cut_off_or_damaged_anywhere_keeps_the_whole_records_before() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal");
        let records: Vec<Done> = vec![(7, vec![1, 2, 900]), (3, vec![]), (8, vec![5])];
        let (mut journal, done) = Journal::open(&path, &[9; 32]).unwrap();
        assert!(done.is_empty());
        records.iter().for_each(|(cell, set)| journal.note(*cell, set).unwrap());
        drop(journal);
        let whole = std::fs::read(&path).unwrap();
        let ends = [HEADER, HEADER + 24, HEADER + 36, HEADER + 52];
        assert_eq!(whole.len(), ends[3]);
        for length in 0..=whole.len() {
            std::fs::write(&path, &whole[..length]).unwrap();
            let (mut journal, done) = Journal::open(&path, &[9; 32]).unwrap();
            let kept = ends.iter().filter(|end| **end <= length).count().saturating_sub(1);
            assert_eq!(done, records[..kept], "{length}");
            // It goes on after the last whole one.
            journal.note(99, &[4]).unwrap();
            let (_, done) = Journal::open(&path, &[9; 32]).unwrap();
            assert_eq!(done.last(), Some(&(99, vec![4])));
            assert_eq!(done.len(), kept + 1);
        }
        for at in HEADER..whole.len() {
            let mut bytes = whole.clone();
            bytes[at] ^= 4;
            std::fs::write(&path, &bytes).unwrap();
            let (_, done) = Journal::open(&path, &[9; 32]).unwrap();
            let kept = ends.iter().filter(|end| **end <= at).count() - 1;
            assert_eq!(done, records[..kept], "{at}");
        }
    }

    #[test]
    fn the_journal_of_another_bake_is_refused_and_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal");
        Journal::open(&path, &[1; 32]).unwrap().0.note(1, &[2]).unwrap();
        let before = std::fs::read(&path).unwrap();
        assert!(matches!(Journal::open(&path, &[2; 32]), Err(BakeError::OtherJournal(_))));
        std::fs::write(folder.path().join("text"), "something else").unwrap();
        assert!(matches!(
            Journal::open(&folder.path().join("text"), &[1; 32]),
            Err(BakeError::OtherJournal(_))
        ));
        assert_eq!(std::fs::read(&path).unwrap(), before);
    }
}
