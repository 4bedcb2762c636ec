//! The house in order, as far as texts tell: sources, examples and pages say nothing that is not so.

use std::collections::BTreeSet;
use std::fs;
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

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(file: &str) -> String {
    fs::read_to_string(root().join(file)).expect("a file of the package")
}

/// The Rust files of a folder, or a file by itself.
fn sources(path: &Path) -> Vec<PathBuf> {
    if !path.is_dir() {
        return path.extension().is_some_and(|e| e == "rs").then(|| path.to_owned()).into_iter().collect();
    }
    fs::read_dir(path).unwrap().flat_map(|entry| sources(&entry.unwrap().path())).collect()
}

/// The library asks nothing of an operating system: no clock, thread, file, environment or network,
/// all of which fail or panic on targets such as `wasm32-unknown-unknown`. `.ci/wasm` runs it
/// there; this test needs no such target.
#[test]
fn no_clock_thread_file_or_environment_in_the_library() {
    let files = sources(&root().join("src"));
    assert!(files.len() > 30, "the sources were not found");
    let mut hits = Vec::new();
    for file in files {
        for (number, line) in fs::read_to_string(&file).unwrap().lines().enumerate() {
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

/// The files that `docs/conservativeness.md` names are there, and so are the code, constants and
/// tests of each lemma in `docs/lemmas.csv`.
#[test]
fn lemmas_are_where_the_table_says() {
    let (page, table) = (read("docs/conservativeness.md"), read("docs/lemmas.csv"));
    let number = |text: &str| text.split(',').next().and_then(|n| n.parse::<u32>().ok());
    let stated: Vec<u32> = page.split("**Lemma ").skip(1).filter_map(number).collect();
    assert!(stated.iter().copied().eq(1..=stated.len() as u32) && stated.len() > 20, "{stated:?}");
    let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let kept: Vec<u32> = rows.iter().filter_map(|row| row[0].parse().ok()).collect();
    assert_eq!(kept, stated, "each lemma has a row");
    // Between backticks, also those that proofs are said to stand in.
    let is_file = |name: &&str| ["src/", "crates/", "tests/"].iter().any(|at| name.starts_with(at));
    let named = page.split('`').skip(1).step_by(2).filter(is_file);
    let kept = rows.iter().flat_map(|row| [row[1], row[3]]).flat_map(str::split_whitespace);
    let mut missing: BTreeSet<&str> = named.chain(kept).filter(|file| !root().join(file).exists()).collect();
    for row in &rows {
        // Code uses a constant itself, or by a function of `numeric`.
        let paths = row[1].split_whitespace().flat_map(|path| sources(&root().join(path)));
        let code: String = paths.map(|path| fs::read_to_string(path).unwrap()).collect();
        for constant in row[2].split_whitespace() {
            let (module, name) = constant.split_once("::").unwrap();
            let source = read(&format!("src/numeric/{module}.rs"));
            let is_used = code.contains(name) || source.matches(name).count() > 1;
            if !source.contains(&format!("const {name}:")) || !is_used {
                missing.insert(constant);
            }
        }
        assert!(!row[1].is_empty() && !row[3].is_empty(), "{row:?}");
    }
    assert!(missing.is_empty(), "{missing:?}");
}

/// The tests of this package have all internals at hand; applications do not.
#[test]
fn examples_need_no_internals() {
    let texts: Vec<String> =
        sources(&root().join("examples")).iter().map(|path| fs::read_to_string(path).unwrap()).collect();
    assert!(texts.iter().any(|text| text.contains("use casca::")));
    assert!(!texts.iter().any(|text| text.contains("internals")));
}

#[test]
fn the_front_page_shows_the_readmes_example() {
    let (readme, source) = (read("README.md"), read("src/lib.rs"));
    let example = readme.split("```rust\n").nth(1).and_then(|rest| rest.split("```").next());
    let docs = source.lines().filter_map(|line| line.strip_prefix("//!"));
    let docs: Vec<&str> = docs.map(|line| line.strip_prefix(' ').unwrap_or(line)).collect();
    let example: Vec<&str> = example.expect("README has an example").lines().collect();
    assert!(example.len() > 20 && docs.windows(example.len()).any(|lines| lines == example));
}
