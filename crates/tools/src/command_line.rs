//! What command lines share: exit codes, and places that are tried before the work and not after
//! it.

use std::fmt::Display;
use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use glam::{DVec3, Vec3};

/// What the programs exit with, for their `--help`. Code 2 is given by clap.
pub const EXIT_CODES: &str = "Exit codes:
  0  all is well
  1  something visible was lost
  2  the command line is wrong
  3  something else failed: a file, a scene, a device
  4  nothing was checked";

/// How work ended that did not fail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// All is well.
    Well,
    /// Something visible was lost.
    Lost,
    /// Nothing was looked at that could have been lost.
    NothingChecked,
}

/// The exit code of an outcome or an error.
fn code<E>(result: &Result<Outcome, E>) -> u8 {
    match result {
        Ok(Outcome::Well) => 0,
        Ok(Outcome::Lost) => 1,
        Ok(Outcome::NothingChecked) => 4,
        Err(_) => 3,
    }
}

/// Prints the error, if there is one; see [`EXIT_CODES`].
pub fn finish<E: Display>(result: Result<Outcome, E>) -> ExitCode {
    if let Err(error) = &result {
        eprintln!("error: {error}");
    }
    ExitCode::from(code(&result))
}

/// A file or folder that cannot be had.
#[derive(Debug, thiserror::Error)]
#[error("cannot {act} {}: {why}", path.display())]
pub struct PathError {
    act: &'static str,
    path: PathBuf,
    why: io::Error,
}

impl PathError {
    /// A file that cannot be written.
    pub fn write(path: &Path) -> impl FnOnce(io::Error) -> Self {
        Self::to("write", path)
    }

    /// A file or folder with which something cannot be done.
    fn to(act: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        move |why| Self { act, path: path.to_owned(), why }
    }
}

/// Makes a folder and those above it; an empty path is the current one.
///
/// # Errors
/// It is not there and cannot be made.
pub fn make_folder(path: &Path) -> Result<(), PathError> {
    if path.as_os_str().is_empty() {
        return Ok(());
    }
    std::fs::create_dir_all(path).map_err(PathError::to("make the folder", path))
}

/// Tries whether a file can be written, and makes the folders above it. A file that is there stays
/// as it is; none is left where there was none.
///
/// # Errors
/// It cannot be written.
pub fn try_writing(path: &Path) -> Result<(), PathError> {
    make_folder(path.parent().unwrap_or(Path::new("")))?;
    // To open and close a pipe would end it for whoever reads it.
    let special = std::fs::metadata(path).is_ok_and(|m| !m.is_file() && !m.is_dir());
    if special {
        return Ok(());
    }
    let is_new = std::fs::symlink_metadata(path).is_err();
    OpenOptions::new().append(true).create(true).open(path).map_err(PathError::write(path))?;
    if is_new {
        std::fs::remove_file(path).map_err(PathError::write(path))?;
    }
    Ok(())
}

/// Tries whether files can be written into a folder, which is made.
///
/// # Errors
/// As [`make_folder`] and [`try_writing`].
pub fn try_writing_into(folder: &Path, names: &[&str]) -> Result<(), PathError> {
    make_folder(folder)?;
    names.iter().try_for_each(|name| try_writing(&folder.join(name)))
}

/// Prints a line. That nobody reads it, as behind `| head`, is no reason to stop.
pub fn say(line: impl Display) {
    let _ = writeln!(io::stdout(), "{line}");
}

/// The largest coordinate: squares of such distances are finite in single precision.
const FARTHEST: f64 = 1e15;

/// Parses an argument such as `1.5,2,-3` as a point. The error gives an example.
pub fn point(text: &str) -> Result<DVec3, String> {
    let number = |word: &str| word.trim().parse().ok().filter(|n: &f64| n.abs() <= FARTHEST);
    let numbers = text.split(',').map(number).collect::<Option<Vec<f64>>>();
    let point = numbers.and_then(|numbers| <[f64; 3]>::try_from(numbers).ok()).map(DVec3::from_array);
    point.ok_or_else(|| format!("expected three numbers up to {FARTHEST:e}, such as 1.5,2,-3"))
}

/// Parses an argument as a point, and returns the direction to it, of length 1. The error repeats the argument.
pub fn direction(text: &str) -> Result<Vec3, String> {
    let direction = point(text)?.as_vec3().try_normalize();
    direction.ok_or_else(|| format!("{text} has no direction: its length must be finite and more than 0"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder of its own for a test.
    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("casca-command-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        folder
    }

    #[test]
    fn each_end_has_a_code_of_its_own() {
        let ends = [Ok(Outcome::Well), Ok(Outcome::Lost), Err("a file"), Ok(Outcome::NothingChecked)];
        let codes = ends.map(|end| code(&end));
        assert_eq!(codes, [0, 1, 3, 4], "2 is for the command line");
        for code in [0, 1, 2, 3, 4] {
            assert!(EXIT_CODES.contains(&format!("\n  {code}  ")));
        }
    }

    #[test]
    fn what_cannot_be_written_is_found_by_trying_and_named() {
        let folder = folder("write");
        let file = folder.join("file");
        std::fs::write(&file, "kept").unwrap();
        // A file is no folder, and a folder no file.
        for bad in [file.join("below"), file.join("below/far"), folder.clone()] {
            let said = try_writing(&bad).unwrap_err().to_string();
            assert!(said.starts_with("cannot ") && said.contains(file.parent().unwrap().to_str().unwrap()));
        }
        let said = try_writing_into(&file, &[]).unwrap_err().to_string();
        assert!(
            said.starts_with("cannot make the folder") && said.contains(file.to_str().unwrap()),
            "{said}"
        );
        std::fs::create_dir(folder.join("walk.png")).unwrap();
        let said = try_writing_into(&folder, &["frame.png", "walk.png"]).unwrap_err().to_string();
        assert!(said.contains("walk.png"), "{said}");
        // Nothing is left behind but folders, and what was there stays.
        try_writing(&file).unwrap();
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "kept");
        try_writing(&folder.join("new/deep/report.json")).unwrap();
        assert_eq!(std::fs::read_dir(folder.join("new/deep")).unwrap().count(), 0);
        assert!(!folder.join("frame.png").exists());
        assert!(make_folder(Path::new("")).is_ok());
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
