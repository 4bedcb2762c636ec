//! The program as a user starts it: what it writes, what it says about wrong files, and exit codes.

use std::path::Path;
use std::process::{Command, Stdio};

fn program(folder: &Path, words: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_casca"));
    command.current_dir(folder).args(words.split(' '));
    command
}

/// The exit code, the output and the errors of a command.
fn run(folder: &Path, words: &str) -> (Option<i32>, String, String) {
    let output = program(folder, words).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

#[test]
fn without_a_display_all_systems_say_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    for system in ["view rooms", "plane", "points", "light", "lines", "fur"] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_casca"));
        command.current_dir(folder.path()).args(system.split_whitespace());
        let output =
            command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET").output();
        let output = output.unwrap();
        if cfg!(target_os = "linux") {
            let said = String::from_utf8(output.stderr).unwrap();
            assert_eq!(output.status.code(), Some(3), "{system}: {said}");
            assert_eq!(said, "error: no window can be opened (no display?): try --headless\n", "{system}");
        }
    }
}

#[test]
fn a_cloud_is_cut_and_walked_through_and_errors_name_their_file() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    assert_eq!(run(folder, "points visible --spacing 0.2 --operator splat --out house.ply").0, Some(0));
    assert_eq!(run(folder, "points bricks house.ply house.bricks").0, Some(0));
    std::fs::write(folder.join("house.walls"), "-4 0.5 -2 4 5 2\n").unwrap();
    let walk = "points walk house.bricks --walls house.walls --frames 20";
    let (code, _, said) = run(folder, walk);
    assert_eq!((code, said.as_str()), (Some(0), ""));

    // Nobody reads the output.
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let output = program(folder, walk).stdout(writer).stderr(Stdio::piped()).output().unwrap();
    assert_eq!((output.status.code(), String::from_utf8(output.stderr).unwrap().as_str()), (Some(0), ""));

    std::fs::write(folder.join("bad.walls"), "0 0 0 1 1 1\n0 0 x 0 10 10 10\n").unwrap();
    let ply = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
        property float nx\nproperty float ny\nproperty float nz\nend_header\n1 2 3 0 0 1\n";
    std::fs::write(folder.join("one.ply"), ply).unwrap();
    for (words, part) in [
        ("points walk house.bricks --walls bad.walls", "bad.walls, line 2: a wall is six finite numbers"),
        ("points visible one.ply --out seen.ply", "at one place"),
    ] {
        let (code, _, said) = run(folder, words);
        assert!(code == Some(3) && said.contains(part), "{words}: {said}");
    }
    assert_eq!(run(folder, "points visible one.ply --eye 1,2,9 --out seen.ply").0, Some(0));
}

#[test]
fn pictures_are_written_culling_does_not_change_them_and_errors_end_with_3() {
    let folder = std::env::temp_dir().join(format!("casca-view-lines-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let words = "lines --rooms 3 --lines 30 --headless --size 96x72 --samples 16 --look plain,occluded --out";
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
    // Rooms at other distances have thinner tubes than the first, for which the lines were copied.
    let house = "lines --rooms 6 --lines 4 --headless --frames 2 --size 24x18 --samples 4 --out six";
    let (code, said, errors) = run(&folder, house);
    assert!(code == Some(0) && said.matches("ms: query").count() == 2, "{said}{errors}");
    // A picture cannot be written where a file has the name of the folder.
    std::fs::write(folder.join("file"), "no folder").unwrap();
    let (code, _, errors) = run(&folder, &format!("{words} file"));
    assert!(code == Some(3) && errors.contains("file"), "{errors}");
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn furry_pictures_are_written_and_errors_name_their_cause() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("file"), "no folder").unwrap();
    std::fs::write(folder.join("broken.glb"), "no scene").unwrap();
    for (words, part) in [
        ("--headless --out file", "file"),
        ("--headless broken.glb", "broken.glb"),
        ("--headless nowhere.glb", "nowhere.glb"),
        ("--headless --density 0", "the density of the fur"),
    ] {
        let (code, _, said) = run(folder, &format!("fur {words}"));
        assert!(code == Some(3) && said.contains(part), "{words}: {said}");
    }
    let (code, _, said) = run(folder, "fur --headless --size 48x32 --layers 4 --out one");
    if said.contains("no graphics adapter") {
        return println!("skipped: no adapter");
    }
    assert_eq!(code, Some(0), "{said}");
    assert!(folder.join("one/animal.png").is_file());
    let (code, said, _) =
        run(folder, "fur --field 6 --headless --size 48x32 --layers 2 --frames 1 --out field");
    assert!(code == Some(0) && said.matches(" 0 pixels differ").count() == 1, "{said}");
    assert!(folder.join("field/field-0.png").is_file());
}

#[test]
fn an_open_mesh_without_a_skin_hides_nothing_and_cannot_walk() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let still = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"scene":0,"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
        "bufferViews":[{"buffer":0,"byteLength":36}],
        "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}"#;
    std::fs::write(folder.join("still.gltf"), still).unwrap();
    let (code, _, said) = run(folder, "fur still.gltf --walk --headless");
    assert!(code == Some(3) && said.contains("still.gltf: has no mesh with a skin"), "{said}");
    let words = "fur still.gltf --headless --size 48x32 --layers 2 --out still";
    let (code, said, errors) = run(folder, words);
    if errors.contains("no graphics adapter") {
        return println!("skipped: no adapter");
    }
    assert!(code == Some(0) && folder.join("still/still.png").is_file(), "{said}{errors}");
}

#[test]
fn pictures_of_a_map_and_of_one_frame_have_the_names_that_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (code, said, _) = run(folder, "plane --rooms 3 --headless --frames 5 --size 96x64 --out plane");
    if code == Some(3) {
        return println!("skipped: no adapter");
    }
    assert_eq!(code, Some(0));
    assert!(said.contains("guards are visible") && said.contains("plane/plane-rooms-3.png"), "{said}");
    assert!(std::fs::metadata(folder.join("plane/plane-rooms-3.png")).unwrap().len() > 100);
    let words = "view spheres --at 7 --headless --size 96x64 --out view";
    let picture = |words: &str| {
        assert_eq!(run(folder, words).0, Some(0), "{words}");
        std::fs::read(folder.join("view/spheres-0007-point.png")).unwrap()
    };
    assert_ne!(picture(words), picture(&format!("{words} --bare")), "without numbers");
    assert_eq!(run(folder, "view spheres --bare").0, Some(2));
}
