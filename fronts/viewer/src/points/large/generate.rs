//! The command `generate`.

use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::PathBuf;

use casca_points::files::{Attributes, PlyWriter};
use casca_stage::window::Done;
use clap::Args;

use crate::points::large::progress::progress;
use crate::points::large::town::Town;

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
