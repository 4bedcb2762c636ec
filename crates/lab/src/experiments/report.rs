//! What an experiment found, sections put together as one Markdown file, and where that was made.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::Lab;

/// A part of the report.
#[derive(Debug, Clone)]
pub struct Section {
    /// The heading.
    pub title: String,
    /// The text, tables and pictures under it.
    pub blocks: Vec<Block>,
}

/// A piece of a section.
#[derive(Debug, Clone)]
pub enum Block {
    /// Paragraphs of Markdown.
    Text(String),
    /// A small table, also written as CSV.
    Table(Table),
    /// A table that is only written as CSV: the words of its link, and the table.
    Rows(String, Table),
    /// A picture in the folder of the lab.
    Picture {
        /// The file's name.
        file: String,
        /// Its finding, in a sentence.
        caption: String,
    },
}

/// A table of texts and numbers.
#[derive(Debug, Clone)]
pub struct Table {
    /// The stem of the CSV file's name.
    pub name: String,
    /// The quantities in the columns, with their units.
    pub columns: Vec<String>,
    /// As many texts as there are columns, each.
    pub rows: Vec<Vec<String>>,
}

impl Block {
    /// Its table, if it has one.
    pub fn as_table(&self) -> Option<&Table> {
        match self {
            Self::Table(table) | Self::Rows(_, table) => Some(table),
            Self::Text(_) | Self::Picture { .. } => None,
        }
    }
}

impl Section {
    /// A section without content.
    pub fn new(title: &str) -> Self {
        Self { title: title.to_owned(), blocks: Vec::new() }
    }

    /// Adds paragraphs.
    pub fn text(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Text(text.into()));
    }

    /// Adds a small table.
    pub fn table(&mut self, table: Table) {
        self.blocks.push(Block::Table(table));
    }

    /// Adds a link to a table that is only written as CSV.
    pub fn rows(&mut self, words: &str, table: Table) {
        self.blocks.push(Block::Rows(words.to_owned(), table));
    }

    /// Adds a picture of the lab's folder.
    pub fn picture(&mut self, file: &str, caption: &str) {
        self.blocks.push(Block::Picture { file: file.to_owned(), caption: caption.to_owned() });
    }
}

impl Table {
    /// A table without rows.
    pub fn new(name: &str, columns: &[&str]) -> Self {
        let columns = columns.iter().map(|&c| c.to_owned()).collect();
        Self { name: name.to_owned(), columns, rows: Vec::new() }
    }

    /// Adds a row.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// As Markdown; columns that hold numbers only are aligned to the right.
    pub fn markdown(&self) -> String {
        let line = |cells: &[String]| {
            let cells: Vec<String> = cells.iter().map(|c| c.replace('|', "\\|")).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let mut out = line(&self.columns);
        let rules: Vec<&str> =
            (0..self.columns.len()).map(|i| if self.is_number(i) { "---:" } else { "---" }).collect();
        let _ = writeln!(out, "|{}|", rules.join("|"));
        self.rows.iter().for_each(|r| out.push_str(&line(r)));
        out
    }

    /// Whether a column has numbers only.
    fn is_number(&self, column: usize) -> bool {
        self.rows.iter().all(|r| r.get(column).is_some_and(|c| c.is_empty() || c.parse::<f64>().is_ok()))
    }

    /// As comma-separated values (RFC 4180).
    pub fn csv(&self) -> String {
        let field = |c: &String| match c.contains([',', '"', '\n']) {
            true => format!("\"{}\"", c.replace('"', "\"\"")),
            false => c.clone(),
        };
        let mut out = String::new();
        for row in std::iter::once(&self.columns).chain(&self.rows) {
            out.push_str(&row.iter().map(field).collect::<Vec<_>>().join(","));
            out.push('\n');
        }
        out
    }
}

/// The first value of a key in a file of `key: value` lines.
fn value(file: &str, key: &str) -> Option<String> {
    let text = std::fs::read_to_string(file).ok()?;
    let line = text.lines().find(|l| l.split(':').next().is_some_and(|k| k.trim() == key))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let out = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8(out.stdout).ok()?.trim().to_owned();
    (out.status.success() && !text.is_empty()).then_some(text)
}

/// The processor, memory and system, as far as they can be told.
fn machine() -> String {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let processor = value("/proc/cpuinfo", "model name").unwrap_or_else(|| std::env::consts::ARCH.to_owned());
    let memory = value("/proc/meminfo", "MemTotal")
        .and_then(|m| m.split_whitespace().next()?.parse::<f64>().ok())
        .map_or(String::new(), |kib| format!(", {:.0} GiB of memory", kib / f64::from(1 << 20)));
    // Other programs slow the queries down: readers should know.
    let load = std::fs::read_to_string("/proc/loadavg").ok();
    let load = load.as_deref().and_then(|l| l.split_whitespace().nth(2));
    let load = load.map_or(String::new(), |l| format!(", load {l} in the last 15 minutes"));
    format!("{processor}, {threads} threads{memory}, {}{load}", std::env::consts::OS)
}

/// The commit of the working tree, and whether it was changed; of the compiler, its version.
fn commit() -> String {
    let commit = output("git", &["rev-parse", "--short", "HEAD"]).unwrap_or_else(|| "unknown".to_owned());
    let changed = output("git", &["status", "--porcelain", "--untracked-files=no", "--", "src", "crates"]);
    let changed = if changed.is_some() { " with changes" } else { "" };
    let compiler = output("rustc", &["--version"]).unwrap_or_else(|| "rustc unknown".to_owned());
    format!("{commit}{changed}, {compiler}")
}

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

    #[test]
    fn tables_align_numbers_and_quote_what_needs_it() {
        let mut t = Table::new("t", &["method", "ms"]);
        t.row(["a|b, \"c\"".to_owned(), "1.5".to_owned()]);
        assert_eq!(t.markdown(), "| method | ms |\n|---|---:|\n| a\\|b, \"c\" | 1.5 |\n");
        assert_eq!(t.csv(), "method,ms\n\"a|b, \"\"c\"\"\",1.5\n");
    }
}
