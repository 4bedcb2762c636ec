//! Sets for eyes that may go some way, as charts (SVG), tables (CSV) and a page.

use std::path::PathBuf;

use casca_lab::command_line::{EXIT_CODES, Outcome, SceneName};
use casca_lab::experiments::reach::{Effort, ReachScore, measure, section};
use casca_lab::experiments::{HEAD, LabError};
use casca_scenes::generated::{SceneKind, SceneOptions};
use clap::Parser;

use crate::page::Page;
use crate::report::files_in;

/// The options.
#[derive(Debug, Parser)]
#[command(
    about = "Charts sets for eyes that may go some way, and checks them against all that such eyes see",
    after_help = EXIT_CODES, allow_negative_numbers = true
)]
pub struct Options {
    /// Scenes: procedural ones or glTF files [default: all procedural ones and the files in ../shared/scenes]
    #[arg(long, value_delimiter = ',')]
    scenes: Vec<SceneName>,
    /// More frames, and an item buffer for every eye: takes an hour
    #[arg(long, conflicts_with = "quick")]
    full: bool,
    /// A smoke run, whose figures mean nothing
    #[arg(long)]
    quick: bool,
    /// Seed of all that is random
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Where the page goes, and its folder of charts and tables
    #[arg(long, default_value = "target/reach")]
    out: PathBuf,
    /// No progress line
    #[arg(long)]
    quiet: bool,
}

/// Measures, prints the tables, writes charts, tables and page, and tells whether a set lacked something.
pub fn run(options: &Options) -> Result<Outcome, LabError> {
    let names = match &options.scenes[..] {
        [] => {
            let built = SceneKind::ALL.into_iter().map(SceneName::Built);
            built.chain(files_in("../shared/scenes").into_iter().map(SceneName::File)).collect()
        }
        given => given.to_vec(),
    };
    names.iter().try_for_each(SceneName::check)?;
    let (effort, size) = match (options.full, options.quick) {
        (true, _) => (Effort::full(options.seed), " --full"),
        (_, true) => (Effort::quick(options.seed), " --quick"),
        _ => (Effort::short(options.seed), ""),
    };
    let page = Page {
        head: HEAD,
        files: Vec::new(),
        feature: "experiments",
        command: &format!("reach{size}"),
        out: &options.out,
        quick: options.quick,
        seed: options.seed,
        quiet: options.quiet,
    };
    let scores = page.make("reach", |lab| {
        let mut scores = Vec::new();
        for name in &names {
            let world = name.open(&SceneOptions { seed: options.seed, ..SceneOptions::default() })?;
            let scene = world.name.clone();
            let told = |done| (lab.progress)(&format!("{scene}, frame {done} of {}", effort.frames));
            scores.push(measure(world, &effort, told)?);
        }
        Ok((section(lab, &effort, &scores)?, scores))
    })?;
    Ok(report_losses(&scores))
}

/// Prints losses.
fn report_losses(scores: &[ReachScore]) -> Outcome {
    for score in scores {
        for (reach, lost) in &score.examples {
            eprintln!(
                "{}: object {} is seen from {} by the ray from {} to {}, but is not in the set for {reach} m",
                score.scene, lost.object, lost.eye, lost.origin, lost.target
            );
        }
    }
    match scores.iter().map(ReachScore::lost).sum() {
        0 => Outcome::Well,
        _ => Outcome::Lost,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_made_and_sizes_exclude_each_other() {
        let options = |words: &[&str]| Options::try_parse_from(std::iter::once(&"reach").chain(words));
        assert!(options(&["--full", "--quick"]).is_err() && options(&["--full"]).unwrap().full);
        assert!(options(&["--scenes", "house"]).unwrap_err().to_string().contains("spheres, city"));
        let place = std::env::temp_dir().join(format!("casca-reach-{}", std::process::id()));
        let out = place.to_str().unwrap();
        let quick = options(&["--quick", "--quiet", "--scenes", "rooms", "--out", out]).unwrap();
        assert_eq!(run(&quick).unwrap(), Outcome::Well);
        let page = std::fs::read_to_string(place.join("reach.md")).unwrap();
        assert!(page.contains("(report/reach-size-solids.svg)") && page.contains("(report/reach.csv)"));
        assert!(place.join("report/reach-size-solids.svg").exists());
        std::fs::remove_dir_all(&place).unwrap();
    }
}
