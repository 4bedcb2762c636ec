//! Light that bounces, in a window or into pictures.
//!
//! `cargo run --release -p casca-light-view -- FILE.glb` opens a window; `-- --help` lists the options.

mod headless;
mod options;
mod scene;
mod stages;
mod window;

use std::error::Error;
use std::process::ExitCode;

use casca_lab::command_line::{Outcome, finish, make_folder, say};
use casca_stage::gpu::Gpu;
use clap::Parser;

use crate::options::Options;

fn run(options: &Options) -> Result<Outcome, Box<dyn Error>> {
    let layers = options.layers()?;
    let start = options.start()?;
    if !(options.headless || options.time) {
        window::open(start, options)?;
        return Ok(Outcome::Well);
    }
    if options.headless {
        make_folder(&options.out)?;
    }
    let gpu = Gpu::headless(options.software)?;
    say(format_args!("drawing on {}", gpu.name));
    if options.headless {
        headless::pictures(&gpu, &start, options, &layers)?;
    }
    if options.time {
        stages::time(&gpu, &start, options)?;
    }
    Ok(Outcome::Well)
}

fn main() -> ExitCode {
    finish(run(&Options::parse()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(words: &[&str]) -> String {
        let options = Options::try_parse_from(std::iter::once(&"light").chain(words));
        let failed = |e: Box<dyn Error>| e.to_string();
        options.map_err(|e| e.to_string()).and_then(|o| run(&o).map_err(failed)).expect_err(words[0])
    }

    #[test]
    fn what_is_wrong_is_named_before_anything_is_drawn() {
        let broken = std::env::temp_dir().join(format!("casca-light-{}.glb", std::process::id()));
        std::fs::write(&broken, "glTF, but no more").unwrap();
        let broken_name = broken.to_str().unwrap();
        for (words, word) in [
            (vec!["--headless", "no/such.glb"], "no/such.glb"),
            (vec!["--headless", broken_name], broken_name),
            (vec!["--headless", "house"], "cornell-point"),
            (vec!["--headless", "--layers", "colour"], "occlusion"),
            (vec!["--size", "0x720"], "from 1 to 8192"),
            (vec!["--size", "NaNx1"], "from 1 to 8192"),
            (vec!["--balls", "70000"], "--balls"),
            (vec!["--sun", "1,2"], "three numbers"),
            (vec!["--from", "1,2,3"], "--to"),
        ] {
            let said = said(&words);
            assert!(said.contains(word), "{words:?}: {said}");
        }
        std::fs::remove_file(&broken).unwrap();
    }

    #[test]
    fn absurd_settings_are_refused_with_what_is_possible() {
        if Gpu::headless(false).is_err() {
            return println!("skipped: no adapter");
        }
        let out = std::env::temp_dir();
        for (option, value, word) in [
            ("--resolution", "0", "from 16 to 512"),
            ("--resolution", "4294967295", "from 16 to 512"),
            ("--step", "NaN", "from 0.1 to 5"),
            ("--reach", "inf", "from 0.01 to 2"),
            ("--aperture", "90", "from 0.001 to 1"),
        ] {
            let said = said(&["--headless", "--out", out.to_str().unwrap(), option, value]);
            assert!(said.contains(word), "{option} {value}: {said}");
        }
    }
}
