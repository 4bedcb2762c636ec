//! Gives damaged files to every reader of files that others write: they are read or refused,
//! without a panic and without more memory than the readers may have. The allocator counts what is
//! asked for, touched or not.
//!
//! The first byte chooses the reader; its upper bit says that the rest are damages to a valid file,
//! and not a file. With `CASCA_SEEDS` the valid files are written to the folder of that name, for a
//! corpus.
#![no_main]

use std::io::Cursor;
use std::panic::{self, AssertUnwindSafe};
use std::path::Path;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

use casca::TriMesh;
use casca_baked::{Baked, Cells, Writer};
use casca_maps::TmxImport;
use casca_points::PointCloud;
use casca_points::bricks::{Bricks, Loader, Want};
use casca_points::files::{FileError, read_source};
use libfuzzer_sys::fuzz_target;
use peak_alloc::PeakAlloc;

#[path = "../../sisters/points/tests/files/mod.rs"]
mod clouds;
#[path = "../../tests/damage/mod.rs"]
mod damage;
#[path = "../../sisters/lines/tests/files/mod.rs"]
mod lines;
#[path = "../../sisters/maps/tests/files/mod.rs"]
mod maps;
#[path = "../../tests/damage/meshes.rs"]
mod meshes;
#[path = "../../crates/scenes/tests/files/mod.rs"]
mod scenes;

#[global_allocator]
static HEAP: PeakAlloc = PeakAlloc;

/// What the last panic said. The fuzzer ends at any panic, but those of libraries that a reader
/// catches are errors.
static LAST_PANIC: Mutex<String> = Mutex::new(String::new());

/// A format: valid files, what sets their checksums right, and the reader.
struct Kind {
    name: &'static str,
    files: Vec<Vec<u8>>,
    mend: fn(&mut Vec<u8>),
    read: Box<dyn Fn(&[u8]) + Send + Sync>,
}

static KINDS: LazyLock<Vec<Kind>> = LazyLock::new(|| {
    panic::set_hook(Box::new(|why| {
        *LAST_PANIC.lock().unwrap_or_else(PoisonError::into_inner) = why.to_string()
    }));
    let kind = |name, files, mend, read| Kind { name, files, mend, read };
    let mut all = vec![
        kind("clouds", clouds::all(), clouds::mend, Box::new(cloud)),
        kind("bricks", vec![clouds::bricks(40), clouds::bricks(200)], |_| (), Box::new(bricks)),
        kind("maps", maps::all(), |_| (), Box::new(|bytes| map(bytes, maps::TILESET.as_bytes()))),
        kind("tilesets", vec![maps::TILESET.into()], |_| (), Box::new(|bytes| map(&maps::all()[0], bytes))),
        kind("scenes", scenes::all(), scenes::mend, Box::new(scene)),
        kind("meshes", meshes::all(), |file| meshes::mend(file), Box::new(mesh)),
        kind("sets", vec![sets(2), sets(40)], mend_sets, Box::new(|bytes| _ = read_sets(bytes))),
    ];
    for format in lines::FORMATS {
        let files = lines::all().into_iter().filter(|(other, _)| *other == format).map(|(_, file)| file);
        let read = move |bytes: &[u8]| drop(casca_lines::sets::files::read(bytes, format));
        all.push(kind("lines", files.collect(), |_| (), Box::new(read)));
    }
    if let Ok(folder) = std::env::var("CASCA_SEEDS") {
        seed(folder.as_ref(), &all);
    }
    all
});

/// Writes the valid files as inputs.
fn seed(folder: &Path, kinds: &[Kind]) {
    std::fs::create_dir_all(folder).expect("a folder");
    for (number, kind) in kinds.iter().enumerate() {
        for (i, file) in kind.files.iter().enumerate() {
            let path = folder.join(format!("{}-{number}-{i}", kind.name));
            std::fs::write(path, [&[number as u8], file.as_slice()].concat()).expect("a file");
        }
    }
}

fn cloud(bytes: &[u8]) {
    let each = |_: PointCloud| Ok::<_, FileError>(());
    let _ = read_source(Cursor::new(bytes.to_vec()), "fuzz".into(), 4096, each);
}

fn bricks(bytes: &[u8]) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("bricks");
    std::fs::write(&path, bytes).expect("a file");
    let Ok(bricks) = Bricks::open(&path).map(Arc::new) else { return };
    let loader = Loader::new(bricks.clone(), 1 << 24).expect("a thread");
    let wants: Vec<Want> = (0..bricks.len() as u32).map(|brick| Want { brick, points: u32::MAX }).collect();
    loader.want(&wants);
    loader.settle();
    loader.gather(&wants);
}

/// A file of baked sets.
fn sets(objects: u32) -> Vec<u8> {
    let cells = Cells { low: [0.0; 3], size: [1.0; 3], dims: [4, 3, 2], origin: [0.0; 3] };
    let mut writer = Writer::new(cells, objects).expect("cells");
    for cell in 0..20 {
        let set: Vec<u32> = (0..objects).filter(|object| (object * 7 + cell / 3) % 5 < 3).collect();
        writer.put(cell, &set).expect("a set");
    }
    writer.finish().expect("a file")
}

/// Sets the checksum of a file of sets right.
fn mend_sets(file: &mut Vec<u8>) {
    if let Some(body) = file.len().checked_sub(4) {
        let sum = crc32fast::hash(&file[..body]);
        file[body..].copy_from_slice(&sum.to_le_bytes());
    }
}

/// Reads all sets, also those of a file that was not checked.
fn read_sets(bytes: &[u8]) -> Option<()> {
    let is_sound = Baked::read(bytes).is_ok();
    let baked = Baked::open(bytes).ok()?;
    let all = baked.objects();
    for cell in 0..baked.cells().dims.iter().product::<u32>().min(1000) {
        // A damaged one may name the same objects for ever.
        let Some(set) = baked.set(cell) else { continue };
        let seen = set.iter().take(1000).filter(|object| *object >= all).count();
        assert!(!is_sound || seen == 0, "a set of a sound file names objects that are not there");
    }
    baked.set_at([0.5, 1.5, 0.5]).map(|set| _ = set.contains(3))
}

fn map(map: &[u8], tileset: &[u8]) {
    let _ = TmxImport::default().parse(map, |_| Ok(tileset.to_vec()));
}

fn scene(bytes: &[u8]) {
    let _ = casca_scenes::import::read("fuzz", bytes, None);
}

fn mesh(mut bytes: &[u8]) {
    let _ = TriMesh::read(&mut bytes);
}

fuzz_target!(|data: &[u8]| {
    let Some((&first, rest)) = data.split_first() else { return };
    let kinds = &*KINDS;
    let kind = &kinds[usize::from(first & 0x7f) % kinds.len()];
    let mut file = rest.to_vec();
    if first & 0x80 != 0 {
        // The numbers that choose the damages are the bytes, and zeros behind them.
        let mut bytes = rest.iter();
        let mut next = || (0..3).fold(0, |n, _| n << 8 | u64::from(bytes.next().copied().unwrap_or(0)));
        let whole = &kind.files[next() as usize % kind.files.len()];
        file = damage::damaged(whole, &kind.files, &mut next);
        if next() % 2 == 0 {
            (kind.mend)(&mut file);
        }
    }
    let check = || damage::check(&HEAP, kind.name, &file, &mut |bytes| (kind.read)(bytes));
    if panic::catch_unwind(AssertUnwindSafe(check)).is_err() {
        eprintln!("{}: {}", kind.name, LAST_PANIC.lock().unwrap_or_else(PoisonError::into_inner));
        std::process::abort();
    }
});
