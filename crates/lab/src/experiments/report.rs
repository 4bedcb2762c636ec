//! Sections put together as one Markdown file.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use super::machine::{commit, machine};
use super::{Block, Lab, Section, Table};

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

/// The Markdown of a block. Tables and pictures are in `folder`, as seen from the report.
fn markdown(block: &Block, folder: &str) -> String {
    let link = |words: &str, table: &Table| format!("[{words}]({folder}/{}.csv)", table.name);
    match block {
        Block::Text(text) => format!("\n{}\n", text.trim()),
        Block::Table(table) => format!("\n{}\n{}\n", table.markdown(), link("As CSV", table)),
        Block::Rows(words, table) => format!("\n{}\n", link(words, table)),
        Block::Picture { file, caption } => format!("\n![{caption}]({folder}/{file})\n"),
    }
}

const HEAD: &str = "# casca in the laboratory\n\n\
    The methods: `point` (casca's default: what the eye can see), `cell` (casca: what can be seen from anywhere in the eye's \
    grid cell), `frustum` (no occlusion) and `hzb` (a rasterised hierarchical depth buffer, as engines use it). \
    The PVS is the set of objects that a method finds visible; PVS/visible is its size over the \
    number of objects that can be seen: 1 is exact. Times are of one thread.\n";

/// Writes a report, and each table as CSV into the lab's folder, where the pictures are already.
/// `command` is how to make it again; `settings` tells the seed and the like.
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
    let mut out = format!(
        "{HEAD}\n`{command}` makes this page and the files in [{folder}]({folder}); all numbers come from one run.\n\n"
    );
    let _ = writeln!(out, "- Machine: {}.\n- Commit: {}.\n- {settings}", machine(), commit());
    if lab.quick {
        out.push_str("\n**A quick run: too few frames for its figures to mean anything.**\n");
    }
    for s in sections {
        let _ = writeln!(out, "\n## {}", s.title);
        s.blocks.iter().for_each(|block| out.push_str(&markdown(block, &folder)));
        for table in s.blocks.iter().filter_map(Block::as_table) {
            save(&lab.folder.join(format!("{}.csv", table.name)), &table.csv())?;
        }
    }
    save(path, &out)
}

#[cfg(test)]
mod tests {
    use super::*;

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
        section.table(table.clone());
        section.rows("All rows", Table { name: "rows".to_owned(), ..table });
        section.picture("a.svg", "A picture.");
        let file = folder.join("report.md");
        write(&file, &lab, &[section], "cargo run", "Settings.").unwrap();
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(text.contains("\n## Upkeep: 1,000 objects\n"));
        assert!(text.contains("A quick run") && text.contains("| 1 |") && text.contains("/a.svg)"));
        assert_eq!(text.matches("| 1 |").count(), 1, "other tables are only linked");
        for name in ["upkeep", "rows"] {
            assert!(text.contains(&format!("/{name}.csv)")), "{name}");
            assert_eq!(std::fs::read_to_string(folder.join(format!("{name}.csv"))).unwrap(), "a\n1\n");
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
