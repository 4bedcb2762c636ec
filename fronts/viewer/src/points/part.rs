//! The levels of a file that are read.

use std::path::Path;

use casca_points::PointCloud;
use casca_points::files::{FileError, Levels, Report, Selection, read_selected};
use clap::Args;

/// The levels of a COPC or EPT file that are read; all by default.
#[derive(Debug, Args)]
pub struct Part {
    /// The finest level of a COPC or EPT file that is read; 0 is the coarsest [default: all levels]
    #[arg(long, conflicts_with = "point_spacing")]
    level: Option<u32>,
    /// Reads levels until points are so close together, in the unit of the file
    #[arg(long, value_parser = parse_positive)]
    point_spacing: Option<f64>,
}

impl Part {
    pub fn selection(&self) -> Selection {
        let levels = match (self.level, self.point_spacing) {
            (Some(level), _) => Levels::To(level),
            (None, Some(spacing)) => Levels::Spacing(spacing),
            (None, None) => Levels::All,
        };
        Selection { levels, ..Selection::default() }
    }

    /// Reads this part of a file, and says what is wrong with it.
    pub fn read(&self, path: &Path) -> Result<(PointCloud, Vec<String>), FileError> {
        let mut all = PointCloud::default();
        let report = read_selected(path, &self.selection(), usize::MAX, |chunk| {
            all = chunk;
            Ok::<_, FileError>(())
        })?;
        Ok((all, warned(report)))
    }
}

/// Says on standard error what is wrong with a file.
pub fn warned(report: Report) -> Vec<String> {
    report.warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
    report.warnings
}

fn parse_positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "expected a number above 0".to_owned())
}
