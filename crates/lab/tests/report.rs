//! The report is short, and the files that it links are those that there are.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use casca_lab::experiments::{EXPERIMENTS, Lab, Section, write};

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

/// The part of a text between two others.
fn between<'a>(text: &'a str, from: &str, to: &str) -> &'a str {
    let rest = text.split_once(from).unwrap_or_else(|| panic!("{from} is missing")).1;
    rest.split_once(to).unwrap_or_else(|| panic!("{to} is missing")).0
}

#[test]
fn the_front_page_quotes_the_report() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let read = |file: &str| std::fs::read_to_string(root.join(file)).unwrap();
    let (readme, report) = (read("README.md"), read("docs/report.md"));
    assert_eq!(
        between(&readme, "Measured at commit ", " "),
        between(&report, "- Commit: ", ","),
        "the commit measured"
    );
    let rows = |file: &str| -> Vec<Vec<String>> {
        read(file).lines().skip(1).map(|row| row.split(',').map(str::to_owned).collect()).collect()
    };
    let (against, shadows) = (rows("docs/report/against.csv"), rows("docs/report/shadows.csv"));
    let tables = "<!-- tables from docs/report/against.csv and docs/report/shadows.csv -->\n";
    let table = between(&readme, tables, "<!-- end of table -->");
    let mut checked = 0;
    for line in table.lines().skip(2) {
        let scene = between(line, "| ", " |");
        let of = |rows: &'_ [Vec<String>]| rows.iter().find(|row| row[0] == scene).cloned();
        let row = of(&against).unwrap_or_else(|| panic!("{scene} is not in the table"));
        let two = |number: &str| format!("{:.2}", number.parse::<f64>().unwrap());
        let [ms, p99, ratio, hzb_ms, hzb_p99, hzb_ratio, lost] =
            [3, 4, 5, 7, 8, 9, 10].map(|column: usize| two(&row[column]));
        let (frustum, visible) = (&row[1], &row[2]);
        // Without a row, the scene's shadows were not measured.
        let shadows = of(&shadows)
            .map_or("-".to_owned(), |row| format!("{} of {}, {} ms", row[4], row[3], two(&row[6])));
        let quoted = format!(
            "| {scene} | {frustum} | {visible} | {ms} ({p99}) ms, {ratio} | \
             {hzb_ms} ({hzb_p99}) ms, {hzb_ratio}, {lost} lost | {shadows} |"
        );
        assert_eq!(line, quoted);
        checked += 1;
    }
    assert!(checked >= 10);
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
    // Still scenes, a result kept for 5 cm and 5 degrees: mean time, slowest frames and size of the
    // set.
    let still = rows.lines().filter(|row| row.split(',').nth(1) == Some("0"));
    let kept = still.map(|row| {
        let way = row.split('"').nth(3).unwrap();
        way.split(", ").map(|number| number.parse().unwrap()).collect::<Vec<f64>>()
    });
    let (time, set) = (span(kept.clone().map(|way| way[0])), span(kept.clone().map(|way| way[2])));
    assert!(kept.count() > 5);
    let quoted = format!("5 cm and 5 degrees: {time} of the time and {set} times the set of a query");
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
