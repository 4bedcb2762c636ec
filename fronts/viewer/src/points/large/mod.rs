//! Commands for clouds larger than memory: `generate`, `bricks`, `walk`.

mod picture;
mod town;
mod walk;

use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::PathBuf;

use casca_points::bricks::{BrickError, Bricks, BuildOptions, Builder};
use casca_points::files::{Attributes, FileError, PlyWriter, read_chunks};
use casca_stage::window::Done;
use casca_tools::command_line::say;
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use crate::points::large::town::Town;
use crate::points::operators::warned;

pub use walk::Walk;

/// Write the scan of a town, as large as you like, and its walls, behind which nothing can be seen.
#[derive(Debug, Args)]
pub struct Generate {
    /// The PLY file to write. The walls go to a text file beside it: a box of six numbers on each
    /// line.
    out: PathBuf,
    /// The number of points.
    #[arg(long, default_value_t = 10_000_000)]
    points: u64,
    /// The seed of heights, colours and points.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl Generate {
    pub fn run(&self) -> Done {
        let walls = self.out.with_extension("walls");
        if walls == self.out {
            return Err(format!(
                "{}: the walls go to the file of this name: choose another",
                walls.display()
            )
            .into());
        }
        let mut town = Town::new(self.seed);
        fs::write(&walls, town.walls()).map_err(|e| format!("cannot write {}: {e}", walls.display()))?;
        self.scan(&mut town).map_err(|e| format!("cannot write {}: {e}", self.out.display()).into())
    }

    fn scan(&self, town: &mut Town) -> io::Result<()> {
        let has = Attributes { colours: true, ..Attributes::default() };
        let mut writer = PlyWriter::new(BufWriter::new(File::create(&self.out)?), self.points, has, false)?;
        let bar = progress(Some(self.points), "scanning");
        let mut left = self.points;
        while left > 0 {
            let count = left.min(1 << 18);
            writer.push(&town.scan(count as usize))?;
            left -= count;
            bar.inc(count);
        }
        bar.finish();
        writer.finish()?;
        Ok(())
    }
}

/// Cut a file into bricks, which `walk` reads.
#[derive(Debug, Args)]
pub struct Cut {
    /// A PLY, LAS, LAZ or E57 file.
    file: PathBuf,
    /// The file of bricks to write.
    out: PathBuf,
}

#[derive(Debug, thiserror::Error)]
enum CutError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Brick(#[from] BrickError),
}

impl Cut {
    pub fn run(&self) -> Done {
        let mut builder = Builder::create(&self.out, BuildOptions::default())?;
        let bar = progress(None, "reading");
        let report = read_chunks::<CutError>(&self.file, 1 << 20, |cloud| {
            bar.inc(cloud.len() as u64);
            Ok(builder.push(&cloud)?)
        })?;
        bar.finish();
        let skipped = report.skipped;
        warned(report);
        let bar = progress(Some(0), "sorting and cutting");
        builder.finish(|done, all| {
            bar.set_length(all);
            bar.set_position(done);
        })?;
        bar.finish();
        let bricks = Bricks::open(&self.out)?;
        let (points, count) = (bricks.points(), bricks.len());
        say(format_args!(
            "{points} points in {count} bricks; {skipped} points without valid coordinates skipped"
        ));
        Ok(())
    }
}

/// A bar that counts points; without a total, how many and how fast.
fn progress(total: Option<u64>, label: &'static str) -> ProgressBar {
    let (bar, template) = match total {
        Some(total) => (ProgressBar::new(total), "{msg} {bar:40} {percent} %, {eta} left"),
        None => (ProgressBar::new_spinner(), "{spinner} {msg} {human_pos} points, {per_sec}"),
    };
    let style = ProgressStyle::with_template(template);
    style.map_or(bar.clone(), |style| bar.with_style(style)).with_message(label)
}
