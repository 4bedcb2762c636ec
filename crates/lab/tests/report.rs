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

/// The part of a text between two others.
fn between<'a>(text: &'a str, from: &str, to: &str) -> &'a str {
    let rest = text.split_once(from).unwrap_or_else(|| panic!("{from} is missing")).1;
    rest.split_once(to).unwrap_or_else(|| panic!("{to} is missing")).0
}

#[test]
fn the_front_page_quotes_the_report() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let read = |file: &str| std::fs::read_to_string(root.join(file)).unwrap();
    let (readme, report, rows) = (read("README.md"), read("docs/report.md"), read("docs/report/against.csv"));
    assert_eq!(
        between(&readme, "Measured at commit ", " "),
        between(&report, "- Commit: ", ","),
        "the commit measured"
    );
    let rows: Vec<Vec<&str>> = rows.lines().skip(1).map(|row| row.split(',').collect()).collect();
    let table = between(&readme, "<!-- table from docs/report/against.csv -->\n", "<!-- end of table -->");
    let mut checked = 0;
    for line in table.lines().skip(2) {
        let scene = between(line, "| ", " |");
        let row =
            rows.iter().find(|row| row[0] == scene).unwrap_or_else(|| panic!("{scene} is not in the table"));
        let two = |column: usize| format!("{:.2}", row[column].parse::<f64>().unwrap());
        let [ms, ratio, hzb_ms, hzb_ratio, lost] = [3, 5, 7, 9, 10].map(two);
        let (frustum, visible) = (row[1], row[2]);
        let quoted = format!(
            "| {scene} | {frustum} | {visible} | {ms} ms, {ratio} | {hzb_ms} ms, {hzb_ratio}, {lost} lost |"
        );
        assert_eq!(line, quoted);
        checked += 1;
    }
    assert!(checked >= 10);
}

#[test]
fn the_front_page_quotes_the_table_of_walking_cameras() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let read = |file: &str| std::fs::read_to_string(root.join(file)).unwrap();
    let (readme, rows) = (read("README.md"), read("docs/report/coherence-summary.csv"));
    let mut checked = 0;
    for row in rows.lines() {
        let plain: Vec<&str> = row.split(',').collect();
        // Mean time, slowest frames and size of the set, of each way.
        let ways: Vec<Vec<&str>> =
            row.split('"').skip(1).step_by(2).map(|w| w.split(", ").collect()).collect();
        let scene = plain[0];
        let start = format!("| {scene} | {} ms | ", plain[3]);
        if plain[1] != "0" || !readme.contains(&start) {
            continue;
        }
        let shown = [0, 1, 2, 4].map(|way: usize| format!("{}, {}", ways[way][0], ways[way][2])).join(" | ");
        assert!(readme.contains(&format!("{start}{shown} |")), "{scene}: {shown}");
        checked += 1;
    }
    assert_eq!(checked, 5);
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
