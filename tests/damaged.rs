//! Damaged files of prepared meshes give errors, and cost memory and time in proportion to their
//! bytes.

use casca::TriMesh;
use peak_alloc::PeakAlloc;

mod damage;
#[path = "damage/meshes.rs"]
mod meshes;

#[global_allocator]
static HEAP: PeakAlloc = PeakAlloc;

// One test: another one beside it would count too.
#[test]
fn damaged_meshes_are_read_or_refused() {
    let files = meshes::all();
    for file in &files {
        let mut mended = file.clone();
        meshes::mend(&mut mended);
        assert_eq!(&mended, file);
    }
    let mut taken = 0;
    damage::survive(&HEAP, "meshes", &files, 6000, &|file| meshes::mend(file), &mut |bytes| {
        let mut rest = bytes;
        taken += usize::from(TriMesh::read(&mut rest).is_ok());
    });
    println!("{taken} were read");
    // The whole ones, and those whose changes are as good.
    assert!(taken > 50, "{taken}");
}
