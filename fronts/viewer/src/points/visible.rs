//! The command `visible`: writes the visible points.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

use casca_points::files::PlyWriter;
use casca_stage::window::Done;
use clap::Args;

use crate::points::operators::{Look, Operator, parse_size};

/// Writes the points of a cloud that an eye can see, as PLY
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub struct Visible {
    /// A PLY, LAS, LAZ or E57 file [default: a scan of a house, made by rules]
    file: Option<PathBuf>,
    #[command(flatten)]
    look: Look,
    /// The way to find them
    #[arg(long, value_enum, default_value = "discs")]
    operator: Operator,
    /// The picture of the splat operator: points outside of it are not visible
    #[arg(long, default_value = "1024x768", value_parser = parse_size)]
    size: (u32, u32),
    /// The file to write
    #[arg(long)]
    out: PathBuf,
}

impl Visible {
    pub fn run(&self) -> Done {
        let looked = self.look.open(self.file.as_deref())?;
        let camera = looked.camera(looked.eye, looked.target, self.size)?;
        let (visible, time) = looked.visible(self.operator, &camera)?;
        let some = looked.cloud.subset(&visible);
        let named = |e: io::Error| format!("cannot write {}: {e}", self.out.display());
        let file = File::create(&self.out).map_err(named)?;
        PlyWriter::write_all(BufWriter::new(file), &some).map_err(named)?;
        let (all, seen, seconds) = (looked.cloud.len(), some.len(), time.as_secs_f64());
        // That nobody reads it is no reason to fail.
        let _ = writeln!(io::stdout(), "{seen} of {all} points are visible, found in {seconds:.3} s");
        Ok(())
    }
}
