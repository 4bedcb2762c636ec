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

/// The anchor that Markdown viewers give a heading.
fn anchor(title: &str) -> String {
    let kept = title.to_lowercase();
    kept.chars()
        .filter(|c| c.is_alphanumeric() || *c == ' ' || *c == '-')
        .map(|c| if c == ' ' { '-' } else { c })
        .collect()
}

/// The Markdown of a block. Tables and pictures are in `folder`, as seen from the report.
fn markdown(block: &Block, folder: &str) -> String {
    let link = |words: &str, table: &Table| format!("[{words}]({folder}/{}.csv)", table.name);
    match block {
        Block::Text(text) => format!("\n{}\n", text.trim()),
        Block::Table(table) => format!("\n{}\n{}\n", table.markdown(), link("As CSV", table)),
        Block::Rows(words, table) => format!("\n{}\n", link(words, table)),
        Block::Item(text, table) => format!("- {} ({})\n", text.trim(), link("rows", table)),
        Block::Picture { file, caption } => format!("\n![{caption}]({folder}/{file})\n"),
    }
}

/// The introduction of pages about objects and queries.
pub const HEAD: &str = "# casca in the laboratory\n\n\
    Speed against accuracy, the stability of each method, and the experiments of the thesis that casca follows.\n\n\
    The methods: `point` (casca's default: the objects that the eye can see), `cell` (casca: the objects that can \
    be seen from anywhere in the eye's grid cell), `frustum` (no occlusion), `hzb` (a rasterised hierarchical depth \
    buffer, as engines use it) and `rays` (a ray-cast depth buffer). The PVS is the set of objects that a method \
    finds visible. PVS/visible is its size over the number of objects that can be seen: 1 is exact.\n";

/// Writes a report, and each table as CSV into the lab's folder, where the pictures are already.
/// `head` is its title and introduction, [`HEAD`] for one; `command` is how to make it again;
/// `settings` tells the seed and the like.
///
/// # Errors
/// If a file cannot be written.
pub fn write(
    path: &Path,
    head: &str,
    lab: &Lab,
    sections: &[Section],
    command: &str,
    settings: &str,
) -> Result<(), ReportError> {
    let folder = lab.folder.file_name().unwrap_or_default().to_string_lossy();
    let mut out = format!(
        "{head}\n`{command}` makes this page, its pictures and its tables; all numbers and the sentences about them come from \
         one run. Every row is in a CSV file in [{folder}]({folder}).\n\n"
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
        if s.own_page && sections.len() > 1 {
            let page = format!("{}.md", anchor(&s.title));
            let _ = writeln!(out, "\n{}\n\n[All of it]({folder}/{page})", first_paragraph(s));
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let text = format!("# {}\n\nA page of [the report](../{name}).\n{}", s.title, body(s, "."));
            save(&lab.folder.join(page), &text)?;
        } else {
            out.push_str(&body(s, &folder));
        }
        for table in s.blocks.iter().filter_map(Block::as_table) {
            save(&lab.folder.join(format!("{}.csv", table.name)), &table.csv())?;
        }
    }
    save(path, &out)
}

/// The blocks of a section. Tables and pictures are in `folder`, as seen from the page.
fn body(section: &Section, folder: &str) -> String {
    let (mut out, mut in_list) = (String::new(), false);
    for block in &section.blocks {
        let item = matches!(block, Block::Item(..));
        if item && !in_list {
            out.push('\n');
        }
        in_list = item;
        out.push_str(&markdown(block, folder));
    }
    out
}

/// The first words of a section, up to an empty line.
fn first_paragraph(section: &Section) -> &str {
    let texts = section.blocks.iter().filter_map(|block| match block {
        Block::Text(text) => text.trim().split("\n\n").next(),
        _ => None,
    });
    texts.into_iter().find(|text| !text.starts_with('#')).unwrap_or("")
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
        section.item("An item.", Table { name: "item".to_owned(), ..table.clone() });
        section.rows("All rows", Table { name: "rows".to_owned(), ..table });
        section.picture("a.svg", "A picture.");
        let file = folder.join("report.md");
        write(&file, HEAD, &lab, &[section], "cargo run", "Settings.").unwrap();
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(text.contains("(#upkeep-1000-objects)") && text.contains("\n## Upkeep: 1,000 objects\n"));
        assert!(text.contains("A quick run") && text.contains("| 1 |") && text.contains("/a.svg)"));
        assert_eq!(text.matches("| 1 |").count(), 1, "other tables are only linked");
        for name in ["upkeep", "item", "rows"] {
            assert!(text.contains(&format!("/{name}.csv)")), "{name}");
            assert_eq!(std::fs::read_to_string(folder.join(format!("{name}.csv"))).unwrap(), "a\n1\n");
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn long_sections_have_pages_of_their_own() {
        let folder = std::env::temp_dir().join(format!("casca-pages-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let lab =
            Lab { quick: true, seed: 1, files: Vec::new(), folder: folder.clone(), progress: &|_: &str| () };
        let mut long = Section::on_its_own_page("Long: one");
        long.text("First words.\n\nSecond words.");
        long.table(Table::new("long", &["a"]));
        let file = folder.join("report.md");
        write(&file, HEAD, &lab, &[long, Section::new("Short")], "cargo run", "Settings.").unwrap();
        let (front, page) =
            (std::fs::read_to_string(file), std::fs::read_to_string(folder.join("long-one.md")));
        let (front, page) = (front.unwrap(), page.unwrap());
        assert!(
            front.contains("First words.") && !front.contains("Second") && front.contains("/long-one.md)")
        );
        assert!(
            page.starts_with("# Long: one\n")
                && page.contains("Second words.")
                && page.contains("(./long.csv)")
        );
        assert!(page.contains("(../report.md)") && folder.join("long.csv").exists());
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
