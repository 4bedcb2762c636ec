//! Light that bounces, in a window or into pictures.
//!
//! `cargo run --release -p casca-light-view -- FILE.glb` opens a window; `-- --help` lists the options.

mod controls;
mod headless;
mod options;
mod scene;
mod stages;
mod window;

use std::error::Error;
use std::process::ExitCode;

use casca_stage::command_line::{Outcome, finish, say};
use casca_stage::gpu::Gpu;
use clap::Parser;

use crate::options::Options;
use crate::scene::Start;

fn run(options: &Options) -> Result<Outcome, Box<dyn Error>> {
    let layers = options.check()?;
    let mut start = Start::open(&options.scene, options.balls)?;
    start.change(options.sun, options.from.zip(options.to));
    if !(options.headless || options.time) {
        window::open(start, options)?;
        return Ok(Outcome::Well);
    }
    let gpu = Gpu::headless(options.software)?;
    if gpu.clamp(options.size) != options.size {
        let ((w, h), (width, height)) = (gpu.clamp(options.size), options.size);
        return Err(format!("--size {width}x{height}: {} draws pictures up to {w}x{h}", gpu.name).into());
    }
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
    use casca_light::renderer::{Renderer, Settings};
    use casca_scenes::lit::Kind;

    fn said(words: &[&str]) -> String {
        let options = Options::parse_from(std::iter::once(&"casca-light").chain(words));
        run(&options).expect_err(words[1]).to_string()
    }

    #[test]
    fn scenes_that_cannot_be_had_are_named_before_anything_is_drawn() {
        let folder = std::env::temp_dir().join(format!("casca-light-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let file = |name: &str, bytes: &[u8]| {
            let path = folder.join(name);
            std::fs::write(&path, bytes).unwrap();
            path.to_str().unwrap().to_owned()
        };
        let empty = br#"{"asset": {"version": "2.0"}}"#;
        for (scene, word) in [
            ("no/such.glb".to_owned(), "no/such.glb: cannot be read"),
            (file("broken.glb", b"glTF, but no more"), "broken.glb: is not a valid"),
            (file("empty.gltf", empty), "empty.gltf: holds no triangles"),
            (file("house.obj", b"v 0 0 0"), "neither a .glb or .gltf file nor"),
            (folder.to_str().unwrap().to_owned(), "neither a .glb or .gltf file nor"),
            ("house".to_owned(), "cornell-point"),
            (String::new(), "cornell-point"),
        ] {
            let said = said(&["--headless", &scene]);
            assert!(said.contains(word), "{scene}: {said}");
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn the_ranges_of_the_command_line_are_those_of_the_library() {
        let Ok(gpu) = Gpu::headless(false) else { return println!("skipped: no adapter") };
        let scene = Kind::Furnace.build();
        let taken = |settings| Renderer::new(&gpu, &scene, settings).is_ok();
        let middle = Settings { resolution: 16, ..Settings::default() };
        for (name, (low, high)) in [
            ("step", (*options::STEPS.start(), *options::STEPS.end())),
            ("reach", (*options::REACHES.start(), *options::REACHES.end())),
            (
                "aperture",
                (options::slope(*options::APERTURES.start()), options::slope(*options::APERTURES.end())),
            ),
        ] {
            let with = |value| match name {
                "step" => Settings { step: value, ..middle },
                "reach" => Settings { reach: value, ..middle },
                _ => Settings { aperture: value, ..middle },
            };
            assert!(taken(with(low)) && taken(with(high)), "{name}");
            assert!(!taken(with(0.5 * low)) && !taken(with(1.01 * high)), "{name}");
        }
    }
}
