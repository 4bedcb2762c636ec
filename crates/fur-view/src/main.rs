//! Shows furry animals: one, or a field of them among walls, in a window or in files. `casca-fur --help` lists the options.

mod choices;
mod field;
mod fit;
mod herd;
mod one;
mod shots;
mod study;
mod window;

use std::error::Error;
use std::process::ExitCode;

use casca_stage::command_line::{Outcome, finish, make_folder, say};
use casca_stage::gpu::Gpu;
use clap::Parser;

use crate::choices::Choices;

fn run(choices: &Choices) -> Result<Outcome, Box<dyn Error>> {
    let subject = choices.subject()?;
    if !choices.draws_files() {
        window::open(choices, subject)?;
        return Ok(Outcome::Well);
    }
    make_folder(&choices.out)?;
    let gpu = Gpu::headless(choices.software)?;
    say(format_args!("drawing on {}", gpu.name));
    if choices.study {
        study::study(&gpu, choices, &subject)?;
        return Ok(Outcome::Well);
    }
    match (choices.field, choices.time) {
        (_, true) => field::time(&gpu, choices, &subject)?,
        (Some(count), false) => return field::pictures(&gpu, choices, count),
        (None, false) if choices.coats => one::coats(&gpu, choices, &subject)?,
        (None, false) => one::pictures(&gpu, choices, &subject)?,
    }
    Ok(Outcome::Well)
}

fn main() -> ExitCode {
    finish(run(&Choices::parse()))
}
