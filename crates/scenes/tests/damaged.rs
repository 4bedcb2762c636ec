//! Damaged glTF files give errors, and cost memory and time in proportion to their bytes.

use casca_scenes::import::{read, read_lit};
use peak_alloc::PeakAlloc;

#[path = "../../../tests/damage/mod.rs"]
mod damage;
mod files;

#[global_allocator]
static HEAP: PeakAlloc = PeakAlloc;

// One test: another one beside it would count too.
#[test]
fn damaged_scenes_are_read_or_refused() {
    let whole = files::all();
    for file in &whole {
        let mut mended = file.clone();
        files::mend(&mut mended);
        assert_eq!(&mended, file);
        assert_eq!(read("whole", file, None).map(|world| world.objects.len()).ok(), Some(4));
    }
    let mut taken = 0;
    damage::survive(&HEAP, "scenes", &whole, 4000, &files::mend, &mut |bytes| {
        let world = read("damaged", bytes, None);
        let lit = read_lit("damaged", bytes, None);
        taken += usize::from(world.is_ok() && lit.is_ok());
    });
    println!("{taken} were read");
    assert!(taken > 100, "{taken}");
}
