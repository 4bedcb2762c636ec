//! The report is short, and the files that it links are those that there are.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use casca_lab::experiments::{EXPERIMENTS, Lab, Section, finding, lines_of, write};
use casca_lab::pictures::worth;

const MOST_WORDS: usize = 2500;

/// The targets of all links to files in a Markdown text.
fn links(text: &str) -> BTreeSet<&str> {
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    targets.filter(|t| !t.starts_with('#') && !t.contains("://")).collect()
}

/// Checks a report and the folder beside it.
fn check(report: &Path) {
    let text = std::fs::read_to_string(report).unwrap();
    let words = text.split_whitespace().count();
    assert!(words <= MOST_WORDS, "{} has {words} words", report.display());
    let place = report.parent().unwrap();
    let links = links(&text);
    for link in &links {
        assert!(place.join(link).exists(), "{link} is linked, but missing");
    }
    for file in std::fs::read_dir(place.join("report")).unwrap() {
        let name = format!("report/{}", file.unwrap().file_name().to_string_lossy());
        assert!(links.contains(name.as_str()), "{name} is not linked");
    }
    assert!(!text.contains("NaN"), "a finding is not a number");
}

#[test]
fn the_report_in_the_repository_is_short_and_complete() {
    check(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/report.md"));
}

#[test]
fn the_front_page_says_what_the_chart_shows() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let read = |file: &str| std::fs::read_to_string(root.join(file)).unwrap();
    let said = finding(&lines_of(&read("docs/report/worth.csv")));
    for page in ["README.md", "docs/report.md"] {
        assert!(read(page).replace('\n', " ").contains(&said), "{page} lacks: {said}");
    }
    assert!(read("README.md").contains("](docs/report/worth.svg)"));
}

/// `CASCA_CHART=write` draws it anew.
#[test]
fn the_chart_is_that_of_its_table() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/report");
    let lines = lines_of(&std::fs::read_to_string(folder.join("worth.csv")).unwrap());
    let (there, drawn) = (folder.join("worth.svg"), std::env::temp_dir().join("casca-worth.svg"));
    let path = if std::env::var("CASCA_CHART").is_ok_and(|v| v == "write") { &there } else { &drawn };
    worth(path, &lines).unwrap();
    assert_eq!(std::fs::read(path).unwrap(), std::fs::read(there).unwrap());
}

/// The least and the greatest of some numbers, with two digits after the point.
fn span(numbers: impl Iterator<Item = f64> + Clone) -> String {
    let (least, most) = (numbers.clone().fold(f64::MAX, f64::min), numbers.fold(0.0, f64::max));
    format!("{least:.2} to {most:.2}")
}

#[test]
fn the_front_page_quotes_the_table_of_walking_cameras() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let read = |file: &str| std::fs::read_to_string(root.join(file)).unwrap();
    let (readme, rows) = (read("README.md"), read("docs/report/coherence-summary.csv"));
    // Still scenes, the default options: mean time, slowest frames and size of the set.
    let still = rows.lines().filter(|row| row.split(',').nth(1) == Some("0"));
    let kept = still.map(|row| {
        let way = row.split('"').nth(3).unwrap();
        way.split(", ").map(|number| number.parse().unwrap()).collect::<Vec<f64>>()
    });
    let (time, set) = (span(kept.clone().map(|way| way[0])), span(kept.clone().map(|way| way[2])));
    assert!(kept.count() > 5);
    let quoted = format!("in the next eight frames: {time} of the time and {set} times the set of a query");
    assert!(readme.replace('\n', " ").contains(&quoted), "{quoted}");
}

#[test]
fn the_front_page_is_short() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../README.md");
    let lines = std::fs::read_to_string(page).unwrap().lines().count();
    assert!(lines <= 110, "README.md has {lines} lines");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "takes minutes without optimisation")]
fn a_quick_run_makes_a_short_and_complete_report() {
    let place: PathBuf = std::env::temp_dir().join(format!("casca-quick-report-{}", std::process::id()));
    let folder = place.join("report");
    std::fs::create_dir_all(&folder).unwrap();
    let lab = Lab { quick: true, seed: 1, files: Vec::new(), folder, progress: &|_: &str| () };
    let sections: Vec<Section> = EXPERIMENTS.iter().map(|(_, run)| run(&lab).unwrap()).collect();
    let report = place.join("report.md");
    write(&report, &lab, &sections, "cargo run", "Seed 1.").unwrap();
    check(&report);
    std::fs::remove_dir_all(&place).unwrap();
}
