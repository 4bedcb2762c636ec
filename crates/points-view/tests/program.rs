//! The program as a user starts it: what it says about wrong files, and that a closed pipe ends it quietly.

use std::path::Path;
use std::process::{Command, Stdio};

fn program(folder: &Path, words: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_casca-points"));
    command.current_dir(folder).args(words.split(' '));
    command
}

/// The exit code and the errors of a command.
fn run(folder: &Path, words: &str) -> (Option<i32>, String) {
    let output = program(folder, words).output().unwrap();
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn a_town_is_cut_and_walked_through_and_errors_name_their_file() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    assert_eq!(run(folder, "generate town.ply --points 2000").0, Some(0));
    assert_eq!(run(folder, "bricks town.ply town.bricks").0, Some(0));
    let walk = "walk town.bricks --walls town.walls --frames 40 --check";
    let (code, said) = run(folder, walk);
    assert_eq!((code, said.as_str()), (Some(0), ""));

    // Nobody reads the output.
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let output = program(folder, walk).stdout(writer).stderr(Stdio::piped()).output().unwrap();
    assert_eq!((output.status.code(), String::from_utf8(output.stderr).unwrap().as_str()), (Some(0), ""));

    std::fs::write(folder.join("bad.walls"), "0 0 0 1 1 1\n0 0 x 0 10 10 10\n").unwrap();
    std::fs::write(folder.join("one.txt"), "1\n1 2 3 1 0 0 1 0 0 0.3\n").unwrap();
    for (words, part) in [
        ("walk town.bricks --walls bad.walls", "bad.walls, line 2: a wall is six finite numbers"),
        ("generate town.walls", "choose another"),
        ("generate nowhere/town.ply --points 1", "nowhere/town.walls"),
        ("visible one.txt --out seen.ply", "at one place"),
    ] {
        let (code, said) = run(folder, words);
        assert!(code == Some(3) && said.contains(part), "{words}: {said}");
    }
    assert_eq!(run(folder, "visible one.txt --eye 1,2,9 --out seen.ply").0, Some(0));
}
