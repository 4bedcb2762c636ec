//! The functions that the library exports, the header declares and `symbols.txt` lists are the same,
//! so that none vanishes; and `unsafe` stands in the one room that it belongs to.
//! `CASCA_SYMBOLS=write cargo test -p casca-capi --test symbols` adds new ones to the list.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn here() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn sources() -> Vec<(PathBuf, String)> {
    let entries = fs::read_dir(here().join("src")).unwrap().map(|entry| entry.unwrap().path());
    let rust = entries.filter(|path| path.extension().is_some_and(|e| e == "rs"));
    rust.map(|path| (path.clone(), fs::read_to_string(path).unwrap())).collect()
}

/// The names that follow `#[unsafe(no_mangle)]`.
fn exported_by_sources() -> BTreeSet<String> {
    let of = |text: &str| {
        let after = text.split("#[unsafe(no_mangle)]").skip(1);
        let name = |part: &str| part.split_once("fn ").unwrap().1.split('(').next().unwrap().to_owned();
        after.map(name).collect::<Vec<String>>()
    };
    sources().iter().flat_map(|(_, text)| of(text)).collect()
}

/// The names that a shared library defines, if there are tools to read them.
fn exported_by_library() -> Option<BTreeSet<String>> {
    let library = std::env::current_exe().unwrap().with_file_name("libcasca_c.so");
    if !library.exists() {
        println!("skipped: no {}", library.display());
        return None;
    }
    let read = Command::new("nm").args(["-D", "--defined-only"]).arg(library).output();
    let Ok(read) = read else {
        println!("skipped: no nm");
        return None;
    };
    let text = String::from_utf8(read.stdout).unwrap();
    let names = text.lines().filter_map(|line| line.split_whitespace().last());
    Some(names.map(str::to_owned).collect())
}

#[test]
fn no_function_vanishes() {
    let path = here().join("symbols.txt");
    let sources = exported_by_sources();
    let listed = fs::read_to_string(&path).unwrap_or_default();
    let mut listed: BTreeSet<String> = listed.lines().map(str::to_owned).collect();
    if std::env::var("CASCA_SYMBOLS").is_ok_and(|how| how == "write") {
        // One that vanished stays on the list, and the test fails.
        listed.extend(sources.iter().cloned());
        fs::write(&path, listed.iter().map(|name| format!("{name}\n")).collect::<String>()).unwrap();
    }
    assert!(listed.len() > 60, "symbols.txt lists {}", listed.len());
    assert_eq!(sources, listed, "the sources and symbols.txt");
    let header = fs::read_to_string(here().join("include/casca.h")).unwrap();
    let undeclared: Vec<_> = listed
        .iter()
        .filter(|name| !header.contains(&format!(" {name}(")) && !header.contains(&format!("*{name}(")))
        .collect();
    assert!(undeclared.is_empty(), "not in casca.h: {undeclared:?}");
    if let Some(library) = exported_by_library() {
        assert_eq!(library, listed, "the shared library and symbols.txt");
    }
}

#[test]
fn unsafe_stands_in_one_room() {
    for (path, text) in sources() {
        let blocks = text.lines().filter(|line| {
            let code = line.split("//").next().unwrap();
            ["unsafe {", "unsafe impl", "unsafe trait"].iter().any(|word| code.contains(word))
        });
        let (count, is_border) = (blocks.count(), path.ends_with("border.rs"));
        assert_eq!(count > 0, is_border, "{}: {count} unsafe blocks", path.display());
        let reasons = text.matches("// SAFETY: ").count() + text.matches("/// # Safety").count();
        assert!(!is_border || reasons >= count, "{count} unsafe blocks, {reasons} reasons");
    }
}
