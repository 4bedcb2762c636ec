//! The program as a user starts it: pictures without a window, with and without culling, and exit codes.

use std::path::Path;
use std::process::Command;

/// The exit code, the output and the errors of a command.
fn run(folder: &Path, words: &str) -> (Option<i32>, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_casca-lines"));
    let output = command.current_dir(folder).args(words.split(' ')).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

#[test]
fn pictures_are_written_culling_does_not_change_them_and_errors_end_with_3() {
    let folder = std::env::temp_dir().join(format!("casca-lines-program-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let words = "--rooms 3 --lines 30 --headless --size 96x72 --samples 16 --look plain,occluded --out";
    let (code, said, errors) = run(&folder, &format!("{words} all"));
    if errors.contains("no graphics adapter") {
        return println!("skipped: no adapter");
    }
    assert_eq!(code, Some(0), "{errors}");
    assert!(said.contains("270 lines"), "{said}");
    assert_eq!(run(&folder, &format!("{words} some --cull")).0, Some(0));
    let picture = |name: &str| std::fs::read(folder.join(name)).unwrap();
    for name in ["lines_rooms_plain.png", "lines_rooms_occluded.png"] {
        assert!(picture(&format!("all/{name}")) == picture(&format!("some/{name}")), "{name}");
    }
    assert!(picture("all/lines_rooms_plain.png") != picture("all/lines_rooms_occluded.png"));
    // A file is swayed at another time than 0.
    std::fs::write(folder.join("zigzag.obj"), "v 0 0 0\nv 1 1 0\nv 2 0 0.5\nv 3 1 0\nl 1 2 3 4\n").unwrap();
    let words = "zigzag.obj --headless --size 96x72 --look occlusion --fov 0 --out";
    assert_eq!(run(&folder, &format!("{words} still")).0, Some(0));
    assert_eq!(run(&folder, &format!("{words} moved --at 1")).0, Some(0));
    let name = "lines_zigzag_occlusion.png";
    assert!(picture(&format!("still/{name}")) != picture(&format!("moved/{name}")));
    // A picture cannot be written where a file has the name of the folder.
    let (code, _, errors) = run(&folder, &format!("{words} zigzag.obj"));
    assert!(code == Some(3) && errors.contains("zigzag.obj"), "{errors}");
    std::fs::remove_dir_all(&folder).unwrap();
}
