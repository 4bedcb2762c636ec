//! `docs/conservativeness.md` and its table of lemmas name code, constants and tests that are
//! there.

use std::collections::BTreeSet;
use std::path::Path;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The words between backticks.
fn names(cell: &str) -> Vec<&str> {
    cell.split('`').skip(1).step_by(2).collect()
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
    let page = read("docs/conservativeness.md");
    let number = |text: &str| text.split(',').next().and_then(|n| n.parse::<u32>().ok());
    let stated: Vec<u32> = page.split("**Lemma ").skip(1).filter_map(number).collect();
    assert!(stated.iter().copied().eq(1..=stated.len() as u32) && stated.len() > 20, "{stated:?}");
    let (_, table) = page.split_once("| lemma | code | constants | tests |").unwrap();
    let rows: Vec<Vec<&str>> = table
        .lines()
        .skip(2)
        .take_while(|line| line.starts_with('|'))
        .map(|line| line.split('|').map(str::trim).collect())
        .collect();
    let kept: Vec<u32> = rows.iter().filter_map(|row| row[1].parse().ok()).collect();
    assert_eq!(kept, stated, "each lemma has a row");
    // Also those that proofs are said to stand in.
    let is_file = |name: &&str| ["src/", "crates/", "tests/"].iter().any(|at| name.starts_with(at));
    let files = names(&page).into_iter().filter(is_file);
    let mut missing: BTreeSet<&str> = files.filter(|file| !root().join(file).exists()).collect();
    for row in &rows {
        // Code uses a constant itself, or by a function of `numeric`.
        let code: String = names(row[2]).iter().map(|path| sources(&root().join(path))).collect();
        for constant in names(row[3]) {
            let (module, name) = constant.split_once("::").unwrap();
            let source = read(&format!("src/numeric/{module}.rs"));
            let is_used = code.contains(name) || source.matches(name).count() > 1;
            if !source.contains(&format!("const {name}:")) || !is_used {
                missing.insert(constant);
            }
        }
        assert!(!names(row[2]).is_empty() && !names(row[4]).is_empty(), "{row:?}");
    }
    assert!(missing.is_empty(), "{missing:?}");
}
