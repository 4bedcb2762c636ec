//! The program: a bake that is killed goes on, parts are merged, and bad arguments are refused.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::Duration;

use casca_bake::{Baked, journal_of};

const LEVEL: [&str; 10] = [
    "rooms",
    "--cell",
    "4",
    "--height",
    "0.2:2.0",
    "--within",
    "0,0,0:20,2,20",
    "--queries",
    "16",
    "--quiet",
];

fn program() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_casca"));
    command.arg("bake");
    command
}

fn bake(arguments: &[&str], out: &Path) -> Command {
    let mut command = program();
    command.args(arguments).arg("--out").arg(out);
    command
}

fn run(arguments: &[&str], out: &Path) -> Vec<u8> {
    let Output { status, stderr, .. } = bake(arguments, out).output().unwrap();
    assert!(status.success(), "{}", String::from_utf8_lossy(&stderr));
    assert!(!journal_of(out).exists(), "the journal is deleted");
    std::fs::read(out).unwrap()
}

/// What an error says; nothing may be left behind.
fn refused(command: &mut Command, out: &Path) -> String {
    let Output { status, stderr, .. } = command.output().unwrap();
    let text = String::from_utf8(stderr).unwrap();
    assert!(!status.success() && !out.exists(), "{text}");
    text
}

fn names(folder: &Path) -> Vec<PathBuf> {
    std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect()
}

#[test]
fn killed_bakes_and_parts_on_any_threads_make_the_same_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let whole = run(&[&LEVEL[..], &["--threads", "2"]].concat(), &at("whole"));
    let baked = Baked::read(&whole).unwrap();
    assert!(baked.sets() > 3, "{}", baked.sets());
    assert_eq!(run(&[&LEVEL[..], &["--threads", "1"]].concat(), &at("one")), whole);

    // Killed again and again, each time after some cells more.
    let out = at("killed");
    let (mut kills, mut sizes) = (0, vec![0]);
    loop {
        let mut child = bake(&LEVEL, &out).spawn().unwrap();
        let before = *sizes.last().unwrap();
        let size = || std::fs::metadata(journal_of(&out)).map_or(0, |data| data.len());
        while child.try_wait().unwrap().is_none() && size() < before + 1000 {
            std::thread::sleep(Duration::from_millis(1));
        }
        if child.try_wait().unwrap().is_some() {
            break;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        // It was done before the kill came: the file must be whole.
        if out.exists() {
            break;
        }
        kills += 1;
        sizes.push(size());
    }
    assert!(kills > 1 && sizes.is_sorted(), "{kills} {sizes:?}");
    assert_eq!(std::fs::read(&out).unwrap(), whole);

    let parts: Vec<PathBuf> = (1..=3).map(|part| at(&format!("part{part}"))).collect();
    for (part, path) in ["1/3", "2/3", "3/3"].iter().zip(&parts) {
        run(&[&LEVEL[..], &["--shard", part]].concat(), path);
    }
    let merged = at("merged");
    let merge = |files: &[&PathBuf], out: &Path| {
        let mut command = program();
        command.arg("merge").arg("--out").arg(out).args(files);
        command
    };
    // In any order.
    let reversed: Vec<&PathBuf> = parts.iter().rev().collect();
    assert!(merge(&reversed, &merged).status().unwrap().success());
    assert_eq!(std::fs::read(&merged).unwrap(), whole);

    let none = at("none");
    let other = at("other");
    run(&["rooms", "--cell", "20", "--queries", "16", "--quiet", "--shard", "1/8"], &other);
    assert!(refused(&mut merge(&[&parts[0], &other], &none), &none).contains("other cells"));
    std::fs::write(&other, &whole[..whole.len() - 9]).unwrap();
    assert!(refused(&mut merge(&[&parts[0], &other], &none), &none).contains("cut off"));
    assert!(refused(&mut merge(&[&at("nothing")], &none), &none).contains("cannot read"));

    // Sets from cell to cell are another bake.
    let to_cells = at("to-cells");
    run(&[&LEVEL[..], &["--cell-to-cell"]].concat(), &to_cells);
    let bytes = std::fs::read(&to_cells).unwrap();
    assert!(Baked::read(&bytes).unwrap().is_cell_to_cell());
    assert!(refused(&mut merge(&[&parts[0], &to_cells], &none), &none).contains("kinds of sets"));
    // Parts must tell of the same cells: one that a part does not know would count as hidden.
    let (near, far) = (at("near"), at("far"));
    for (corner, out) in [("0,0,0:8,2,8", &near), ("8,0,8:16,2,16", &far)] {
        let few = ["rooms", "--cell", "4", "--height", "0.2:2.0", "--within", corner];
        run(&[&few[..], &["--queries", "16", "--quiet", "--cell-to-cell"]].concat(), out);
    }
    assert!(refused(&mut merge(&[&near, &far], &none), &none).contains("kinds of sets"));

    let show = |at: &[&str]| {
        let output = program().arg("show").arg(&merged).args(at).output();
        String::from_utf8(output.unwrap().stdout).unwrap()
    };
    assert!(show(&[]).contains("in the mean set"));
    let seen: Vec<u32> = show(&["--at", "10,1.5,10"]).lines().map(|line| line.parse().unwrap()).collect();
    assert!(baked.set_at([10.0, 1.5, 10.0]).unwrap().iter().eq(seen.iter().copied()) && !seen.is_empty());
    assert!(show(&["--at", "20,1.5,200"]).contains("all may be seen"));
}

#[test]
fn bad_input_is_one_error_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let refuse = |change: &[&str], says: &str| {
        let text = refused(&mut bake(&[&LEVEL[..1], change].concat(), &out), &out);
        assert!(text.contains(says), "{change:?}: {text}");
    };
    refuse(&["--cell", "0"], "edges that are greater than 0");
    refuse(&["--cell", "NaN"], "edges that are greater than 0");
    refuse(&["--cell", "0.00001"], "2^28 cells");
    refuse(&["--height", "2:1"], "the greatest height must exceed");
    refuse(&["--height", "2"], "as 0.2:2.0");
    refuse(&["--grid=-1"], "cannot be used");
    refuse(&["--shard", "4/3"], "counted from 1");
    refuse(&["--shard", "0/0"], "counted from 1");
    let text = refused(&mut bake(&["nowhere.glb"], &out), &out);
    assert!(text.contains("nowhere.glb"), "{text}");
    std::fs::write(folder.path().join("cut.glb"), b"glTF\x02\0\0\0\xff\0").unwrap();
    refused(&mut bake(&[folder.path().join("cut.glb").to_str().unwrap()], &out), &out);
    let nowhere = folder.path().join("no folder/out");
    assert!(refused(&mut bake(&LEVEL, &nowhere), &nowhere).contains("cannot open"));
    // The journal of another bake is kept.
    let journal = journal_of(&out);
    std::fs::write(&journal, "CASCAJR1, but of another bake, with a name of 32 bytes").unwrap();
    assert!(refused(&mut bake(&LEVEL, &out), &out).contains("another level or other options"));
    assert_eq!(names(folder.path()).len(), 2, "{:?}", names(folder.path()));
}
