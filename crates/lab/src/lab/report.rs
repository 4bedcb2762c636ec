//! Sections put together as one Markdown file.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use super::machine::{commit, machine};
use super::{Block, Lab, Section};

/// Why a report could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {path}: {why}")]
pub struct ReportError {
    path: PathBuf,
    why: std::io::Error,
}

fn save(path: &Path, text: &str) -> Result<(), ReportError> {
    std::fs::write(path, text).map_err(|why| ReportError { path: path.to_owned(), why })
}

/// The anchor that Markdown viewers give a heading.
fn anchor(title: &str) -> String {
    let kept = title.to_lowercase();
    kept.chars()
        .filter(|c| c.is_alphanumeric() || *c == ' ' || *c == '-')
        .map(|c| if c == ' ' { '-' } else { c })
        .collect()
}

/// Writes a report, and each table as CSV into the lab's folder, where the pictures are already.
/// `command` is how to make it again; `settings` is what to know of it.
///
/// # Errors
/// If a file cannot be written.
pub fn write(
    path: &Path,
    lab: &Lab,
    sections: &[Section],
    command: &str,
    settings: &str,
) -> Result<(), ReportError> {
    let folder = lab.folder.file_name().unwrap_or_default().to_string_lossy();
    let mut out = String::from("# casca in the laboratory\n\n");
    let _ = writeln!(
        out,
        "Speed against accuracy, the experiments of the thesis, and what happens where methods fail.\n\
         Made by `{command}`; all numbers are of that one run, and each table is also a CSV file in [{folder}]({folder}).\n"
    );
    let _ = writeln!(out, "- Machine: {}.\n- Commit: {}.\n- {settings}\n", machine(), commit());
    if lab.quick {
        out.push_str("**A quick run: too few frames for its figures to mean anything.**\n\n");
    }
    for s in sections {
        let _ = writeln!(out, "- [{}](#{})", s.title, anchor(&s.title));
    }
    for s in sections {
        let _ = writeln!(out, "\n## {}", s.title);
        for block in &s.blocks {
            out.push('\n');
            match block {
                Block::Text(text) => {
                    let _ = writeln!(out, "{}", text.trim());
                }
                Block::Table(table) => {
                    out.push_str(&table.markdown());
                    save(&lab.folder.join(format!("{}.csv", table.name)), &table.csv())?;
                }
                Block::Picture { file, caption } => {
                    let _ = writeln!(out, "![{caption}]({folder}/{file})\n\n*{caption}*");
                }
            }
        }
    }
    save(path, &out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::Table;

    #[test]
    fn a_report_holds_its_sections_and_writes_its_tables() {
        let folder = std::env::temp_dir().join(format!("casca-report-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let lab =
            Lab { quick: true, seed: 1, files: Vec::new(), folder: folder.clone(), progress: &|_: &str| () };
        let mut section = Section::new("Upkeep: 1,000 objects");
        let mut table = Table::new("upkeep", &["a"]);
        table.row(["1".to_owned()]);
        section.text("Words.");
        section.table(table);
        section.picture("a.png", "A picture.");
        let file = folder.join("report.md");
        write(&file, &lab, &[section], "cargo run", "Settings.").unwrap();
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(text.contains("(#upkeep-1000-objects)") && text.contains("\n## Upkeep: 1,000 objects\n"));
        assert!(text.contains("A quick run") && text.contains("| 1 |") && text.contains("/a.png)"));
        assert_eq!(std::fs::read_to_string(folder.join("upkeep.csv")).unwrap(), "a\n1\n");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
