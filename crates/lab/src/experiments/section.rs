//! What an experiment found.

use std::fmt::Write;

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_align_numbers_and_quote_what_needs_it() {
        let mut t = Table::new("t", &["method", "ms"]);
        t.row(["a|b, \"c\"".to_owned(), "1.5".to_owned()]);
        assert_eq!(t.markdown(), "| method | ms |\n|---|---:|\n| a\\|b, \"c\" | 1.5 |\n");
        assert_eq!(t.csv(), "method,ms\n\"a|b, \"\"c\"\"\",1.5\n");
    }
}
