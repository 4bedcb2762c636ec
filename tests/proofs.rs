//! The files that `docs/conservativeness.md` names are there, and so are the code, constants and
//! tests of each lemma in `docs/lemmas.csv`.

use std::collections::BTreeSet;
use std::path::Path;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The text of a file, or of all files in a folder.
fn sources(path: &Path) -> String {
    if !path.is_dir() {
        return std::fs::read_to_string(path).unwrap_or_default();
    }
    let entries = std::fs::read_dir(path).unwrap();
    entries.map(|entry| sources(&entry.unwrap().path())).collect()
}

#[test]
fn lemmas_are_where_the_table_says() {
    let read = |file: &str| std::fs::read_to_string(root().join(file)).unwrap();
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
        let code: String = row[1].split_whitespace().map(|path| sources(&root().join(path))).collect();
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
