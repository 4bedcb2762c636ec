//! Damaged and hostile files give errors, and cost memory and time in proportion to their bytes.

use casca_lines::sets::files::read;
use peak_alloc::PeakAlloc;

#[path = "../../../tests/damage/mod.rs"]
mod damage;
mod files;

#[global_allocator]
static HEAP: PeakAlloc = PeakAlloc;

// One test: another one beside it would count too.
#[test]
fn damaged_lines_are_read_or_refused() {
    let formats = files::all().into_iter().map(|(format, _)| format);
    let whole: Vec<Vec<u8>> = files::all().into_iter().map(|(_, file)| file).collect();
    for (format, file) in formats.zip(&whole) {
        assert_eq!(read(file, format).map(|lines| lines.len()).ok(), Some(2), "{format:?}");
    }
    for format in files::FORMATS {
        let name = format!("{format:?}");
        let own: Vec<Vec<u8>> =
            files::all().into_iter().filter(|(other, _)| *other == format).map(|(_, file)| file).collect();
        damage::survive(&HEAP, &name, &own, 2000, &|_| (), &mut |bytes| drop(read(bytes, format)));
    }
}
