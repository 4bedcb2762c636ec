//! The program as a user starts it: files that it writes, and what it says about wrong ones.

use std::path::Path;
use std::process::Command;

/// The exit code and all that a command says.
fn run(folder: &Path, words: &str) -> (Option<i32>, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_casca-fur"));
    let output = command.current_dir(folder).args(words.split(' ')).output().unwrap();
    let said = [output.stdout, output.stderr].concat();
    (output.status.code(), String::from_utf8(said).unwrap())
}

#[test]
fn pictures_are_written_and_errors_name_their_cause() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("file"), "no folder").unwrap();
    std::fs::write(folder.join("broken.glb"), "no scene").unwrap();
    for (words, part) in [
        ("--headless --out file", "file"),
        ("--headless broken.glb", "broken.glb"),
        ("--headless nowhere.glb", "nowhere.glb"),
        ("--headless --density 0", "the density of the fur"),
        ("--field 3 --headless --thickness 0", "spacing"),
    ] {
        let (code, said) = run(folder, words);
        assert!(code == Some(3) && said.contains(part), "{words}: {said}");
    }
    let (code, said) = run(folder, "--headless --size 48x32 --smooth 0 --layers 4 --out one");
    if said.contains("no graphics adapter") {
        return println!("skipped: no adapter");
    }
    assert_eq!(code, Some(0), "{said}");
    assert!(folder.join("one/animal.png").is_file());
    let (code, said) =
        run(folder, "--field 6 --headless --size 48x32 --smooth 0 --layers 2 --frames 1 --out field");
    assert!(code == Some(0) && said.matches(" 0 pixels differ").count() == 2, "{said}");
    assert!(folder.join("field/field-0.png").is_file() && folder.join("field/field-0-layered.png").is_file());
}
