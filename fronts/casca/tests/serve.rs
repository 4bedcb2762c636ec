//! The program: what it says, and how it ends.

use std::io::{BufRead, BufReader};
use std::process::{Command, Output, Stdio};

fn program() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_casca"));
    command.arg("serve");
    command
}

fn run(arguments: &[&str]) -> (Option<i32>, String, String) {
    let Output { status, stdout, stderr } = program().args(arguments).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (status.code(), text(stdout), text(stderr))
}

#[test]
fn levels_are_checked() {
    let (code, said, _) = run(&["--check", "rooms"]);
    assert!(code == Some(0) && said.contains("103 occluders, 181 walls"), "{said}");
    for (level, why) in [("house", "neither"), ("none.glb", "cannot be read")] {
        let (code, _, said) = run(&["--check", level]);
        assert!(code == Some(3) && said.contains(why), "{said}");
        let (code, _, said) = run(&["--level", level, "--listen", "127.0.0.1:0", "--http", "127.0.0.1:0"]);
        assert!(code == Some(3) && said.contains(why), "{said}");
    }
    let (code, _, said) = run(&["--token", "no-such-file"]);
    assert!(code == Some(3) && said.contains("no-such-file"), "{said}");
    assert_eq!(run(&["--ticks", "0"]).0, Some(2));
}

#[test]
fn it_ends_when_its_time_is_over() {
    let (code, said, log) =
        run(&["--bots", "4", "--seconds", "1", "--listen", "127.0.0.1:0", "--http", "127.0.0.1:0"]);
    assert_eq!(code, Some(0), "{log}");
    assert!(said.contains("token: ") && said.contains("map: http://127.0.0.1:"), "{said}");
    assert!(log.contains("stopped") && !log.contains("token"), "{log}");
}

#[test]
fn what_it_bakes_it_takes() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    let path = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let file = path("rooms.pvs");
    let (code, said, log) = run(&["--bake", &file, "--cell", "4"]);
    assert!(code == Some(0) && said.contains("bytes") && log.contains("of"), "{said}{log}");
    let any = ["--listen", "127.0.0.1:0", "--http", "127.0.0.1:0", "--seconds", "1", "--bots", "4"];
    assert_eq!(run(&[any.as_slice(), &["--baked", &file]].concat()).0, Some(0));
    let (code, _, said) = run(&[any.as_slice(), &["--baked", "none.pvs"]].concat());
    assert!(code == Some(3) && said.contains("none.pvs"), "{said}");
    let wrong = path("wrong.pvs");
    std::fs::write(&wrong, "PVS").unwrap();
    let (code, _, said) = run(&[any.as_slice(), &["--baked", &wrong]].concat());
    assert!(code == Some(3) && said.contains("no file of baked visibility"), "{said}");
    let (code, _, said) = run(&["--bake", &wrong, "--cell", "0.1"]);
    assert!(code == Some(3) && said.contains("0.25 m at least"), "{said}");
}

#[cfg(unix)]
#[test]
fn signals_stop_it() {
    for signal in ["-TERM", "-INT"] {
        let mut server = program()
            .args(["--bots", "2", "--listen", "127.0.0.1:0", "--http", "127.0.0.1:0", "--seconds", "60"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(server.stdout.take().unwrap()).lines();
        // The second line says that it listens.
        assert!(lines.by_ref().nth(1).unwrap().unwrap().contains("clients: ws://"));
        let sent = Command::new("kill").args([signal, &server.id().to_string()]).status().unwrap();
        assert!(sent.success());
        assert_eq!(server.wait().unwrap().code(), Some(0), "{signal}");
    }
}
