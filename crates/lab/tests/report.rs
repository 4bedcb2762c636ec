//! The report is short, and the files that it links are those that there are.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use casca_lab::lab::{EXPERIMENTS, HEAD, Lab, Section, write};

const MOST_LINES: usize = 520;

/// The targets of all links to files in a Markdown text.
fn links(text: &str) -> BTreeSet<&str> {
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    targets.filter(|t| !t.starts_with('#') && !t.contains("://")).collect()
}

/// Checks a report and the folder beside it.
fn check(report: &Path) {
    let text = std::fs::read_to_string(report).unwrap();
    let lines = text.lines().count();
    assert!(lines <= MOST_LINES, "{} has {lines} lines", report.display());
    let place = report.parent().unwrap();
    let links = links(&text);
    for link in &links {
        assert!(place.join(link).exists(), "{link} is linked, but missing");
    }
    for file in std::fs::read_dir(place.join("report")).unwrap() {
        let name = format!("report/{}", file.unwrap().file_name().to_string_lossy());
        assert!(links.contains(name.as_str()), "{name} is not linked");
    }
    assert!(links.iter().any(|l| l.ends_with(".svg")) && links.iter().any(|l| l.ends_with(".csv")));
    assert!(!text.contains("NaN"), "a finding is not a number");
}

#[test]
fn the_report_in_the_repository_is_short_and_complete() {
    check(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/report.md"));
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
    write(&report, HEAD, &lab, &sections, "cargo run", "Seed 1.").unwrap();
    check(&report);
    std::fs::remove_dir_all(&place).unwrap();
}
