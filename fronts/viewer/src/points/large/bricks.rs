//! The command `bricks`.

use std::io::{self, Write};
use std::path::PathBuf;

use casca_points::bricks::{BrickError, Bricks, BuildOptions, Builder};
use casca_points::files::{FileError, read_chunks};
use casca_stage::window::Done;
use clap::Args;

use crate::points::large::progress::progress;
use crate::points::operators::warned;

/// Cut a file into bricks, which `walk` reads.
#[derive(Debug, Args)]
pub struct Cut {
    /// A PLY, LAS, LAZ or E57 file.
    file: PathBuf,
    /// The file of bricks to write.
    out: PathBuf,
    /// The most points of a brick.
    #[arg(long, default_value_t = 65536)]
    points: u32,
    /// Megabytes of memory for sorting.
    #[arg(long, default_value_t = 256)]
    memory: u64,
    /// The seed of the order of points.
    #[arg(long, default_value_t = 1)]
    seed: u64,
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
        let memory = self.memory.saturating_mul(1 << 20);
        let mut builder =
            Builder::create(&self.out, BuildOptions { most_points: self.points, memory, seed: self.seed })?;
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
        let mut out = io::stdout().lock();
        writeln!(
            out,
            "{points} points in {count} bricks; {skipped} points without valid coordinates skipped"
        )?;
        Ok(())
    }
}
