//! Damaged and hostile files give errors, and cost memory and time in proportion to their bytes.

use std::io::Cursor;
use std::sync::{Arc, Mutex, PoisonError};

use casca_points::PointCloud;
use casca_points::bricks::{Bricks, Loader, Want};
use casca_points::files::{FileError, read_source};
use peak_alloc::PeakAlloc;

#[path = "../../../tests/damage/mod.rs"]
mod damage;
mod files;

#[global_allocator]
static HEAP: PeakAlloc = PeakAlloc;

/// The tests run one after the other: the allocator counts for all.
static ALONE: Mutex<()> = Mutex::new(());

/// Reads a file in chunks; says how many points it has, or why it has none.
fn parse(bytes: &[u8]) -> Result<usize, String> {
    let mut points = 0;
    let each = |chunk: PointCloud| {
        points += chunk.len();
        Ok::<_, FileError>(())
    };
    let read = read_source(Cursor::new(bytes.to_vec()), "test".into(), 4096, each);
    read.map(|_| points).map_err(|e| e.to_string())
}

/// That so many points of a file are read, within the limits, with a warning that says why others
/// are not.
fn warned(file: &[u8], points: usize, reason: &str) {
    let mut said = (0, Vec::new());
    damage::check(&HEAP, reason, file, &mut |bytes| {
        said.0 = 0;
        let each = |chunk: PointCloud| {
            said.0 += chunk.len();
            Ok::<_, FileError>(())
        };
        said.1 = read_source(Cursor::new(bytes.to_vec()), "test".into(), 4096, each).unwrap().warnings;
    });
    assert!(said.0 == points && said.1.iter().any(|said| said.contains(reason)), "{said:?} / {reason}");
}

/// That a file is refused for a reason, within the limits.
fn refused(file: &[u8], reason: &str) {
    let mut said = Ok(0);
    damage::check(&HEAP, reason, file, &mut |bytes| said = parse(bytes));
    let said = said.expect_err(reason);
    assert!(said.contains(reason), "{said} / {reason}");
}

fn number(file: &[u8], at: usize) -> usize {
    u32::from_le_bytes(std::array::from_fn(|i| file[at + i])) as usize
}

/// Opens a file of bricks and loads all of its points.
fn load(path: &std::path::Path) {
    let Ok(bricks) = Bricks::open(path).map(Arc::new) else { return };
    let Ok(loader) = Loader::new(bricks.clone(), 1 << 24) else { return };
    let wants: Vec<Want> = (0..bricks.len() as u32).map(|brick| Want { brick, points: u32::MAX }).collect();
    loader.want(&wants);
    loader.settle();
    loader.gather(&wants);
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
        load(&path);
    });
}

#[test]
fn sizes_of_layers_are_checked_against_the_file() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let whole = files::las(40, 7, 3, true);
    assert_eq!(parse(&whole), Ok(40));
    let chunk = number(&whole, 96) + 8;
    let record = usize::from(u16::from_le_bytes([whole[105], whole[106]]));
    // Behind the first point and the number of points come the sizes of nine layers, one of colours
    // and three of bytes.
    for layer in 0..13 {
        for size in [0xffff_ffff_u32, 0x7fff_ffff, whole.len() as u32] {
            let mut file = whole.clone();
            let at = chunk + record + 4 + 4 * layer;
            file[at..at + 4].copy_from_slice(&size.to_le_bytes());
            refused(&file, "layers of");
        }
    }
}

#[test]
fn headers_of_scans_are_checked_against_the_file() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    // A record of 64 KiB, of which 65,536 would be read at once.
    let mut file = files::las(40, 2, 0, false);
    file[105..107].copy_from_slice(&u16::MAX.to_le_bytes());
    file[107..111].copy_from_slice(&u32::MAX.to_le_bytes());
    refused(&file, "after point 0 of 4294967295");
    // An extended record of 2^40 bytes behind the points.
    let mut file = files::las(40, 7, 0, false);
    let end = file.len() as u64;
    file[235..243].copy_from_slice(&end.to_le_bytes());
    file[243..247].copy_from_slice(&1_u32.to_le_bytes());
    file.extend([0; 20]);
    file.extend((1_u64 << 40).to_le_bytes());
    file.extend([0; 32]);
    damage::check(&HEAP, "extended record", &file, &mut |bytes| drop(parse(bytes)));
    // More points than 64 bits can give the place of.
    let mut file = files::las(40, 7, 0, false);
    file[107..111].fill(0);
    file[247..255].fill(255);
    warned(&file, 40, "after point 40 of 18446744073709551615");
    // A table of more chunks than the file has bytes for.
    let mut file = files::las(40, 7, 0, true);
    let table = number(&file, number(&file, 96));
    for chunks in [0x00ff_ffff, u32::MAX] {
        file[table + 4..table + 8].copy_from_slice(&chunks.to_le_bytes());
        damage::check(&HEAP, "chunks", &file, &mut |bytes| assert_eq!(parse(bytes), Ok(40)));
    }
}

/// The items of the record of LAZ, from the number of them on.
fn items(file: &[u8]) -> usize {
    file.windows(14).position(|w| w == b"laszip encoded").expect("a record of LAZ") + 16 + 2 + 2 + 32 + 32
}

#[test]
fn the_parts_of_compressed_points_are_checked() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    for format in [2, 7] {
        let whole = files::las(40, format, 20_000, true);
        refused(&whole, "20000 extra bytes");
        let whole = files::las(40, format, 6, true);
        assert_eq!(parse(&whole), Ok(40));
        let at = items(&whole);
        assert_eq!(whole[at], 3, "coordinates, colours and bytes");
        let change = |item: usize, field: usize, value: u16| {
            let mut file = whole.clone();
            let at = at + 2 + 6 * item + 2 * field;
            file[at..at + 2].copy_from_slice(&value.to_le_bytes());
            file
        };
        refused(&change(1, 1, 7), "bytes a point");
        // Bytes in the place of colours: as long, but a second item of that kind.
        let bytes = u16::from_le_bytes([whole[at + 14], whole[at + 15]]);
        refused(&change(1, 0, bytes), "twice");
        // Lengths of the same sum that are not those of the kinds.
        let mut moved = change(1, 1, 4);
        moved[at + 16] = 8;
        refused(&moved, "of 4 bytes");
        let mut none = whole.clone();
        none[at] = 0;
        refused(&none, "bytes a point");
    }
}

/// An E57 file with other texts of the same lengths in its XML.
fn e57_with(count: usize, changes: &[(&str, &str)]) -> Vec<u8> {
    let mut file = files::e57(count, false);
    for (from, to) in changes {
        assert_eq!(from.len(), to.len());
        let at = file.windows(from.len()).position(|w| w == from.as_bytes()).expect(from);
        file[at..at + from.len()].copy_from_slice(to.as_bytes());
    }
    files::mend(&mut file);
    file
}

#[test]
fn scans_whose_points_take_no_bits_are_refused() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    assert_eq!(parse(&files::e57(40, false)), Ok(40));
    // The ranges of all coordinates are one number: the crate would unpack points without end.
    refused(&e57_with(40, &[("maximum=\"9999999\"", "maximum=\"-001000\""); 3]), "0 bits");
    refused(&e57_with(1000, &[("recordCount=\"1000\"", "recordCount=\"9999\"")]), "its points take");
}

#[test]
fn the_length_of_xml_is_checked_against_the_file() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let mut file = files::e57(40, true);
    file[32..40].copy_from_slice(&(50_u64 << 20).to_le_bytes());
    files::mend(&mut file);
    refused(&file, "promises 52428800 bytes of XML");
}

/// A compressed file with other points; the table of chunks lies behind them.
fn replaced(mut file: Vec<u8>, from: usize, to: usize, bytes: &[u8]) -> Vec<u8> {
    let start = number(&file, 96);
    let table = number(&file, start) + bytes.len() - (to - from);
    file[start..start + 4].copy_from_slice(&(table as u32).to_le_bytes());
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
        damage::check(&HEAP, "times", &file, &mut |bytes| assert_eq!(parse(bytes), Ok(40)));
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

    fn compress_with(
        &mut self,
        encoder: &mut laz::encoders::ArithmeticEncoder<W>,
        _: &[u8],
    ) -> std::io::Result<()> {
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
    assert_eq!(parse(&references(vec![1; 1000])), Ok(1001));
    assert_eq!(parse(&references(vec![500; 1000])), Ok(1001));
    for before in [0, 1, 500] {
        let mut all = vec![before; 1000];
        all.insert(0, 10_000_000);
        warned(&references(all), 1001, "refers to others without end");
    }
}

#[test]
fn points_that_are_all_the_same_are_read() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    // Nothing compresses better: the number of chunks and their bytes must not look like damage.
    for (format, count) in [(2, 100_000), (7, 100_000), (2, 1_000_000), (7, 1_000_000)] {
        let file = files::las_of_one(count, format);
        let mut read = Ok(0);
        damage::check(&HEAP, "equal points", &file, &mut |bytes| read = parse(bytes));
        assert_eq!(read, Ok(count), "format {format}, {} bytes", file.len());
    }
}
