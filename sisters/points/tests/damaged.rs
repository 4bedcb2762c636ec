//! Damaged and hostile files give errors, and cost memory and time in proportion to their bytes.

use casca_points::PointCloud;
use casca_points::bricks::{Bricks, Loader, Want};
use casca_points::files::{FileError, read_source};
use laz::encoders::ArithmeticEncoder;
use peak_alloc::PeakAlloc;
use std::io::Cursor;
use std::sync::{Arc, Mutex, PoisonError};

#[path = "../../../tests/damage/mod.rs"]
mod damage;
mod files;

use files::{number, with};

#[global_allocator]
static HEAP: PeakAlloc = PeakAlloc;

/// The tests run one after the other: the allocator counts for all.
static ALONE: Mutex<()> = Mutex::new(());

/// Reads a file in chunks. Returns the number of its points, `None` if it is refused, and the
/// warnings or the error.
fn parse(bytes: &[u8]) -> (Option<usize>, String) {
    let mut points = 0;
    let each = |chunk: PointCloud| {
        points += chunk.len();
        Ok::<_, FileError>(())
    };
    match read_source(Cursor::new(bytes.to_vec()), "test".into(), 4096, each) {
        Ok(report) => (Some(points), report.warnings.join("; ")),
        Err(error) => (None, error.to_string()),
    }
}

/// That so many points of a file are read, or none and it is refused, within the limits; and that
/// this is said.
#[track_caller]
fn told(file: &[u8], points: Option<usize>, reason: &str) {
    let mut said = (None, String::new());
    damage::check(&HEAP, reason, file, &mut |bytes| said = parse(bytes));
    assert!(said.0 == points && said.1.contains(reason), "{said:?} / {reason}");
}

#[test]
fn damaged_clouds_are_read_or_refused() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let read = &mut |bytes: &[u8]| drop(parse(bytes));
    damage::survive(&HEAP, "clouds", &files::all(), 4000, &files::mend, read);
}

#[test]
fn damaged_bricks_are_read_or_refused() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bricks");
    let files = [files::bricks(40), files::bricks(200), files::bricks(0)];
    damage::survive(&HEAP, "bricks", &files, 1000, &|_| (), &mut |bytes| {
        std::fs::write(&path, bytes).unwrap();
        let Ok(bricks) = Bricks::open(&path).map(Arc::new) else { return };
        let Ok(loader) = Loader::new(bricks.clone(), 1 << 24) else { return };
        let every = 0..bricks.len() as u32;
        let wants: Vec<Want> = every.map(|brick| Want { brick, points: u32::MAX }).collect();
        loader.want(&wants);
        loader.settle();
        loader.gather(&wants);
    });
}

#[test]
fn sizes_of_layers_are_checked_against_the_file() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let whole = files::las(40, 7, 3, true);
    told(&whole, Some(40), "");
    let chunk = number(&whole, 96) + 8;
    let record = usize::from(u16::from_le_bytes([whole[105], whole[106]]));
    // Behind the first point and the number of points come the sizes of nine layers, one of colours
    // and three of bytes.
    for layer in 0..13 {
        for size in [0xffff_ffff_u32, 0x7fff_ffff, whole.len() as u32] {
            let at = chunk + record + 4 + 4 * layer;
            told(&with(&whole, &[(at, &size.to_le_bytes())]), None, "layers of");
        }
    }
}

#[test]
fn headers_of_scans_are_checked_against_the_file() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    // A record of 64 KiB, of which 65,536 would be read at once.
    let file = with(&files::las(40, 2, 0, false), &[(105, &[255; 6])]);
    told(&file, None, "after point 0 of 4294967295");
    // An extended record of 2^40 bytes behind the points.
    let plain = files::las(40, 7, 0, false);
    let mut file = with(&plain, &[(235, &(plain.len() as u64).to_le_bytes()), (243, &[1, 0, 0, 0])]);
    file.extend([&[0; 20], &(1_u64 << 40).to_le_bytes()[..], &[0; 32]].concat());
    told(&file, Some(40), "");
    // More points than 64 bits can give the place of.
    let file = with(&plain, &[(107, &[0; 4]), (247, &[255; 8])]);
    told(&file, Some(40), "after point 40 of 18446744073709551615");
    // A table of more chunks than the file has bytes for.
    let file = files::las(40, 7, 0, true);
    let table = number(&file, number(&file, 96));
    for chunks in [0x00ff_ffff, u32::MAX] {
        told(&with(&file, &[(table + 4, &chunks.to_le_bytes())]), Some(40), "");
    }
}

#[test]
fn the_parts_of_compressed_points_are_checked() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    for format in [2, 7] {
        told(&files::las(40, format, 20_000, true), None, "20000 extra bytes");
        let whole = files::las(40, format, 6, true);
        told(&whole, Some(40), "");
        // The items of the record of LAZ, from the number of them on.
        let record = whole.windows(14).position(|w| w == b"laszip encoded").expect("a record of LAZ");
        let at = record + 16 + 2 + 2 + 32 + 32;
        assert_eq!(whole[at], 3, "coordinates, colours and bytes");
        // Each has a kind and a length; that of colours begins at 8.
        told(&with(&whole, &[(at + 10, &[7, 0])]), None, "bytes a point");
        // Bytes in the place of colours: as long, but a second item of that kind.
        told(&with(&whole, &[(at + 8, &whole[at + 14..at + 16])]), None, "twice");
        // Lengths of the same sum that are not those of the kinds.
        told(&with(&whole, &[(at + 10, &[4, 0]), (at + 16, &[8])]), None, "of 4 bytes");
        told(&with(&whole, &[(at, &[0])]), None, "bytes a point");
    }
}

#[test]
fn sizes_in_scans_are_checked_against_the_file() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    // The ranges of all coordinates are one number: the crate would unpack points without end.
    let ranges = [("maximum=\"9999999\"", "maximum=\"-001000\""); 3];
    let records = [("recordCount=\"1000\"", "recordCount=\"9999\"")];
    for (count, changes, reason) in [(40, &ranges[..], "0 bits"), (1000, &records, "its points take")] {
        let mut file = files::e57(count, false, None);
        told(&file, Some(count), "");
        for (from, to) in changes {
            let at = file.windows(from.len()).position(|w| w == from.as_bytes()).expect(from);
            file = with(&file, &[(at, to.as_bytes())]);
        }
        files::mend(&mut file);
        told(&file, None, reason);
    }
    let mut file = with(&files::e57(40, true, None), &[(32, &(50_u64 << 20).to_le_bytes())]);
    files::mend(&mut file);
    told(&file, None, "promises 52428800 bytes of XML");
}

/// A compressed file with other points; the table of chunks lies behind them.
fn replaced(mut file: Vec<u8>, from: usize, to: usize, bytes: &[u8]) -> Vec<u8> {
    let start = number(&file, 96);
    let table = number(&file, start) + bytes.len() - (to - from);
    file = with(&file, &[(start, &(table as u32).to_le_bytes())]);
    file.splice(from..to, bytes.iter().copied());
    file
}

#[test]
fn times_that_refer_to_others_without_end_are_no_danger() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    for value in [0xff, 0xfe, 0xf0, 0xc0, 0x80] {
        // The times are the last of nine layers.
        let mut file = files::las(40, 6, 0, true);
        let lengths = number(&file, 96) + 8 + 30 + 4;
        let layer = |i: usize| number(&file, lengths + 4 * i);
        let begin = lengths + 36 + (0..8).map(layer).sum::<usize>();
        let end = begin + layer(8);
        file[lengths + 32..lengths + 36].copy_from_slice(&(1_u32 << 20).to_le_bytes());
        let file = replaced(file, begin, end, &vec![value; 1 << 20]);
        told(&file, Some(40), "");
    }
}

/// Writes times that refer to other sequences of times, so many in each point and in the last.
struct Times {
    model: laz::models::ArithmeticModel,
    references: Vec<usize>,
}

impl<W: std::io::Write> laz::record::FieldCompressor<W> for Times {
    fn size_of_field(&self) -> usize {
        8
    }

    fn compress_first(&mut self, into: &mut W, bytes: &[u8]) -> std::io::Result<()> {
        into.write_all(bytes)
    }

    fn compress_with(&mut self, encoder: &mut ArithmeticEncoder<W>, _: &[u8]) -> std::io::Result<()> {
        for _ in 0..self.references.pop().unwrap_or(0) {
            encoder.encode_symbol(&mut self.model, 5)?;
        }
        // The time of the point before.
        encoder.encode_symbol(&mut self.model, 0)
    }
}

/// A file of points whose times make so many references, the last point's first in the list.
fn references(references: Vec<usize>) -> Vec<u8> {
    use laz::record::{RecordCompressor, SequentialPointRecordCompressor};
    let count = references.len() + 1;
    let file = files::las(count, 1, 0, true);
    let model = laz::models::ArithmeticModelBuilder::new(6).build();
    let mut points = SequentialPointRecordCompressor::new(Vec::new());
    points.add_field_compressor(laz::las::v2::LasPoint0Compressor::default());
    points.add_field_compressor(Times { model, references });
    (0..count).for_each(|_| points.compress_next(&[0; 28]).unwrap());
    points.done().unwrap();
    let begin = number(&file, 96) + 8;
    let end = number(&file, begin - 8);
    replaced(file, begin, end, &points.into_inner())
}

#[test]
fn references_of_times_do_not_overflow_the_stack() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    // Writers need one. After many, each takes less than a thousandth of a bit.
    told(&references(vec![1; 1000]), Some(1001), "");
    told(&references(vec![500; 1000]), Some(1001), "");
    for before in [0, 1, 500] {
        let mut all = vec![before; 1000];
        all.insert(0, 10_000_000);
        told(&references(all), Some(1001), "refers to others without end");
    }
}

#[test]
fn points_that_are_all_the_same_are_read() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    // Nothing compresses better: the number of chunks and their bytes must not look like damage.
    for (format, count) in [(2, 100_000), (7, 100_000), (2, 1_000_000), (7, 1_000_000)] {
        told(&files::las_of_one(count, format), Some(count), "");
    }
}
