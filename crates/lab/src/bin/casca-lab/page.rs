//! An experiment on its own: progress, tables on the terminal, and a page with charts and tables.

use std::path::{Path, PathBuf};

use casca_lab::experiments::{Block, Lab, LabError, Section, write};
use casca_tools::command_line::{make_folder, say, try_writing_into};

use crate::progress;

/// Where and how an experiment runs.
pub struct Page<'a> {
    /// The title and introduction.
    pub head: &'a str,
    /// glTF files that join the procedural scenes.
    pub files: Vec<PathBuf>,
    /// The command and its options, without those that say where results go.
    pub command: &'a str,
    /// The feature that the program is built with for it.
    pub feature: &'a str,
    /// The folder of the page.
    pub out: &'a Path,
    /// Whether it is a smoke run.
    pub quick: bool,
    /// Seed of all that is random.
    pub seed: u64,
    /// No progress line.
    pub quiet: bool,
}

impl Page<'_> {
    /// Runs the experiment, prints its tables and titles, and writes its page, `name.md`.
    pub fn make<T>(
        &self,
        name: &str,
        experiment: impl FnOnce(&Lab) -> Result<(Section, T), LabError>,
    ) -> Result<T, LabError> {
        let (file, folder) = (format!("{name}.md"), self.out.join("report"));
        // Experiments take minutes: what cannot be written is said before them.
        try_writing_into(self.out, &[file.as_str()])?;
        make_folder(&folder)?;
        let bar = progress::spinner(self.quiet);
        bar.set_prefix(name.to_owned());
        let progress = |what: &str| bar.set_message(what.to_owned());
        let lab = Lab {
            quick: self.quick,
            seed: self.seed,
            files: self.files.clone(),
            folder,
            progress: &progress,
        };
        let (section, value) = experiment(&lab)?;
        bar.finish_and_clear();
        for block in &section.blocks {
            match block {
                Block::Table(table) => say(format_args!("\n{}", table.aligned())),
                Block::Picture { caption, .. } => say(caption),
                _ => {}
            }
        }
        let path = self.out.join(file);
        let command =
            format!("cargo run --release -p casca-lab --features {} -- {}", self.feature, self.command);
        write(&path, self.head, &lab, &[section], &command, &format!("Seed {}.", self.seed))?;
        say(path.display());
        Ok(value)
    }
}
