//! The library asks nothing of an operating system: no clock, thread, file, environment or network,
//! all of which fail or panic on targets such as `wasm32-unknown-unknown`. `.ci/wasm` runs it
//! there; this test reads the sources, which needs no such target.

use std::path::{Path, PathBuf};

/// Names of what is not there, wherever they are imported from.
const NAMES: [&str; 6] =
    ["Instant", "SystemTime", "UNIX_EPOCH", "File", "available_parallelism", "thread_local"];
/// Modules of it. Other things may have these names, too: they count in a path, or beside one from
/// `std`.
const MODULES: [&str; 5] = ["thread", "fs", "env", "net", "process"];

/// The first of those words in a line of code, comments left out.
fn absent_word(line: &str) -> Option<&'static str> {
    let code = line.split("//").next().unwrap_or_default();
    let words: Vec<&str> = code.split(|c: char| !(c.is_alphanumeric() || c == '_')).collect();
    let is_path = |word: &str| code.contains("std::") || code.contains(&format!("{word}::"));
    let modules = MODULES.into_iter().filter(|word| is_path(word));
    NAMES.into_iter().chain(modules).find(|absent| words.contains(absent))
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn no_clock_thread_file_or_environment_in_the_library() {
    let mut files = Vec::new();
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut files);
    assert!(files.len() > 30, "the sources were not found");
    let mut hits = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        for (number, line) in text.lines().enumerate() {
            if let Some(word) = absent_word(line) {
                hits.push(format!("{}:{}: {word}", file.display(), number + 1));
            }
        }
    }
    assert!(hits.is_empty(), "not there on every target:\n{}", hits.join("\n"));
}

#[test]
fn the_words_are_found_in_code_and_not_in_comments_or_longer_words() {
    assert_eq!(absent_word("let start = std::time::Instant::now();"), Some("Instant"));
    assert_eq!(absent_word("use std::{fs, io};"), Some("fs"));
    assert_eq!(absent_word("thread::spawn(walk);"), Some("thread"));
    assert_eq!(absent_word("let offset = refs + envelope; // std::fs"), None);
    assert_eq!(absent_word("let process = net(offset::of(1));"), None);
    assert_eq!(absent_word("//! a thread of its own"), None);
}
