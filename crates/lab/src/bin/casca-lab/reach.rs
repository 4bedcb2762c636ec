//! Sets for eyes that may go some way, as charts (SVG), tables (CSV) and a page.

use casca_lab::experiments::reach::{ReachScore, Sampling, measure, section};
use casca_lab::experiments::{HEAD, LabError};
use casca_scenes::generated::{SceneKind, SceneOptions};
use casca_scenes::name::SceneName;
use casca_tools::command_line::{EXIT_CODES, Outcome};
use clap::Parser;

use crate::arguments::{SizedPage, about, scenes_or};
use crate::report::files_in;

/// The options.
#[derive(Debug, Parser)]
#[command(
    about = "Charts sets for eyes that may go some way, and checks them against all that such eyes see",
    after_help = EXIT_CODES, allow_negative_numbers = true,
    mut_arg("out", about("target/reach", "Where the page goes, and its folder of charts, pictures and tables")),
    mut_arg("full", |a| a.help("More frames, and an item buffer for every eye: takes an hour"))
)]
pub struct Options {
    /// Scenes: procedural ones or glTF files [default: all procedural ones and the files in
    /// ../shared/scenes]
    #[arg(long, value_delimiter = ',')]
    scenes: Vec<SceneName>,
    #[command(flatten)]
    sized: SizedPage,
}

/// Measures, prints the tables, writes charts, tables and page, and tells whether a set lacked
/// something.
pub fn run(options: &Options) -> Result<Outcome, LabError> {
    let names = scenes_or(&options.scenes, &SceneKind::ALL, files_in("../shared/scenes"))?;
    let seed = options.sized.page.common.seed;
    let sampling = Sampling::new(options.sized.effort(), seed);
    let command = options.sized.command("reach");
    let page = options.sized.page.page(HEAD, &command);
    let scores = page.make("reach", |lab| {
        let mut scores = Vec::new();
        for name in &names {
            let world = name.open(&SceneOptions { seed, ..SceneOptions::default() })?;
            let scene = world.name.clone();
            let told = |done| (lab.progress)(&format!("{scene}, frame {done} of {}", sampling.frames));
            scores.push(measure(world, &sampling, told)?);
        }
        Ok((section(lab, &sampling, &scores)?, scores))
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
        assert!(options(&["--full", "--quick"]).is_err() && options(&["--full"]).unwrap().sized.full);
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
