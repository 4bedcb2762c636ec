//! Dense sets of lines with ambient occlusion, in a window or into pictures. `casca-lines --help` lists the options.

mod headless;
mod options;
mod source;
mod times;
mod window;

use std::io::{self, Write};
use std::process::ExitCode;

use casca_stage::window::Done;
use clap::Parser;

use options::Options;
use source::Source;

fn run(options: &Options) -> Done {
    let source = Source::open(options)?;
    if options.headless {
        headless::pictures(options, &source)
    } else if options.time {
        times::print(options, &source)
    } else {
        window::open(options, source)
    }
}

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let _ = writeln!(io::stderr(), "error: {error}");
            ExitCode::from(3)
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::run;
    use crate::options::Options;

    fn said(words: &[&str]) -> String {
        let options = Options::try_parse_from(std::iter::once(&"casca-lines").chain(words));
        options
            .map_err(|e| e.to_string())
            .and_then(|o| run(&o).map_err(|e| e.to_string()))
            .expect_err(words[0])
    }

    #[test]
    fn wrong_values_and_files_are_named_with_what_is_possible() {
        let folder = std::env::temp_dir();
        let file = |name: &str, text: &str| {
            let path = folder.join(format!("casca-lines-{}-{name}", std::process::id()));
            std::fs::write(&path, text).unwrap();
            path.to_str().unwrap().to_owned()
        };
        let (broken, empty) = (file("broken.txt", "2\n3 x"), file("empty.obj", "# nothing\n"));
        for (words, part) in [
            (vec!["--headless", "no/such.obj"], "no/such.obj"),
            (vec!["--headless", "lines.stl"], ".trk"),
            (vec!["--headless", &*broken], &*broken),
            (vec!["--headless", &*empty], "no line"),
            (vec!["--headless", "--lines", "0"], "no line"),
            (vec!["--headless", "--rooms", "32", "--lines", "1000000"], "vertices"),
            (vec!["--set", "hair"], "pompom"),
            (vec!["--radius", "0"], "from 0.001 to 1"),
            (vec!["--radius", "NaN"], "from 0.001 to 1"),
            (vec!["--factor", "inf"], "from 0 to 100"),
            (vec!["--fov", "180"], "from 1 to 150, or 0"),
            (vec!["--zoom", "0"], "from 0.1 to 100"),
            (vec!["--samples", "0"], "1..=4096"),
            (vec!["--slices", "64"], "128 or 256"),
            (vec!["--from", "0,0,0"], "direction"),
            (vec!["--from", "1,2"], "direction"),
            (vec!["--size", "0x720"], "from 1 to 8192"),
            (vec!["--look", "photo", "--headless"], "occluded"),
            (vec!["--out", "x"], "--headless"),
            (vec!["x.obj", "--rooms", "3"], "cannot be used with"),
        ] {
            let said = said(&words);
            assert!(said.contains(part), "{words:?}: {said}");
        }
        [broken, empty].iter().for_each(|path| std::fs::remove_file(path).unwrap());
    }
}
