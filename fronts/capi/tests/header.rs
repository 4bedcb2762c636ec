//! The header is what the sources say, and `symbols.txt` lists its functions, so that none
//! vanishes: `CASCA_HEADER=write cargo test -p casca-capi --test header` makes the header anew, and
//! adds new functions to the list. `unsafe` stands in the one room that it belongs to.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use cbindgen::{Builder, Config};

fn here() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Whether files are to be written anew.
fn writes() -> bool {
    std::env::var("CASCA_HEADER").is_ok_and(|how| how == "write")
}

/// The header, as the sources and the chapter at its head make it.
fn generated() -> String {
    let mut config = Config::from_file(here().join("cbindgen.toml")).unwrap();
    config.header = Some(fs::read_to_string(here().join("src/manual.h")).unwrap().trim_end().to_owned());
    config.after_includes =
        Some(fs::read_to_string(here().join("src/before.h")).unwrap().trim_end().to_owned());
    let mut builder = Builder::new().with_config(config);
    for file in ORDER {
        builder = builder.with_src(here().join("src").join(file));
    }
    let mut text = Vec::new();
    builder.generate().unwrap().write(&mut text);
    String::from_utf8(text).unwrap()
}

/// The sources in the order of the header's chapters.
const ORDER: [&str; 12] = [
    "version.rs",
    "error.rs",
    "view.rs",
    "mesh.rs",
    "shape.rs",
    "scene.rs",
    "query.rs",
    "frame.rs",
    "sight.rs",
    "job.rs",
    "plane.rs",
    "plane_query.rs",
];

#[test]
fn the_header_is_that_of_the_sources() {
    let path = here().join("include/casca.h");
    let generated = generated();
    if writes() {
        fs::write(&path, &generated).unwrap();
    }
    let kept = fs::read_to_string(&path).unwrap_or_default();
    let differs = kept.lines().zip(generated.lines()).position(|(kept, new)| kept != new);
    assert!(
        kept == generated,
        "include/casca.h differs from line {:?} on: CASCA_HEADER=write cargo test -p casca-capi --test header",
        differs.map(|line| line + 1)
    );
}

fn sources() -> Vec<(PathBuf, String)> {
    let entries = fs::read_dir(here().join("src")).unwrap().map(|entry| entry.unwrap().path());
    let rust = entries.filter(|path| path.extension().is_some_and(|e| e == "rs"));
    rust.map(|path| (path.clone(), fs::read_to_string(path).unwrap())).collect()
}

/// The names that follow `#[unsafe(no_mangle)]`.
fn exported() -> BTreeSet<String> {
    let of = |text: &str| {
        let after = text.split("#[unsafe(no_mangle)]").skip(1);
        let name = |part: &str| part.split_once("fn ").unwrap().1.split('(').next().unwrap().to_owned();
        after.map(name).collect::<Vec<String>>()
    };
    sources().iter().flat_map(|(_, text)| of(text)).collect()
}

#[test]
fn no_function_vanishes() {
    let path = here().join("symbols.txt");
    let sources = exported();
    let listed = fs::read_to_string(&path).unwrap_or_default();
    let mut listed: BTreeSet<String> = listed.lines().map(str::to_owned).collect();
    if writes() {
        // One that vanished stays on the list, and the test fails.
        listed.extend(sources.iter().cloned());
        fs::write(&path, listed.iter().map(|name| format!("{name}\n")).collect::<String>()).unwrap();
    }
    assert!(listed.len() > 60, "symbols.txt lists {}", listed.len());
    assert_eq!(sources, listed, "the sources and symbols.txt");
    let header = generated();
    let declares =
        |name: &str| header.contains(&format!(" {name}(")) || header.contains(&format!("*{name}("));
    let undeclared: Vec<_> = listed.iter().filter(|name| !declares(name)).collect();
    assert!(undeclared.is_empty(), "not in casca.h: {undeclared:?}");
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
