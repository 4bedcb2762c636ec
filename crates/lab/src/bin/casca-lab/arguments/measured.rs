//! Arguments of commands that measure.

use std::path::PathBuf;

use casca_lab::experiments::{Effort, LabError};
use casca_scenes::generated::{SceneKind, SceneOptions};
use casca_scenes::name::SceneName;
use casca_scenes::world::World;
use clap::{Args, value_parser};

use super::{Common, Out};
use crate::limits::{FRAMES, WIDTHS};
use crate::page::Page;

/// Arguments of experiments that make a page.
#[derive(Debug, Clone, Args)]
pub struct PageArguments {
    /// A smoke run, whose figures mean nothing
    #[arg(long)]
    pub quick: bool,
    #[command(flatten)]
    pub out: Out,
    #[command(flatten)]
    pub common: Common,
}

impl PageArguments {
    /// The page of a command.
    pub fn page<'a>(&'a self, head: &'a str, command: &'a str) -> Page<'a> {
        Page {
            head,
            files: Vec::new(),
            command,
            feature: "experiments",
            out: &self.out.out,
            quick: self.quick,
            seed: self.common.seed,
            quiet: self.common.quiet,
        }
    }

    /// A command that tells whether it is quick.
    pub fn command(&self, name: &str) -> String {
        format!("{name}{}", if self.quick { " --quick" } else { "" })
    }
}

/// Arguments of experiments on pages that are short if nothing is said.
#[derive(Debug, Clone, Args)]
pub struct SizedPage {
    #[command(flatten)]
    pub page: PageArguments,
    /// All sizes
    #[arg(long, conflicts_with = "quick")]
    pub full: bool,
}

impl SizedPage {
    /// How far the experiment goes.
    pub fn effort(&self) -> Effort {
        match (self.full, self.page.quick) {
            (true, _) => Effort::Full,
            (_, true) => Effort::Quick,
            _ => Effort::Short,
        }
    }

    /// A command that tells how far it goes.
    pub fn command(&self, name: &str) -> String {
        if self.full { format!("{name} --full") } else { self.page.command(name) }
    }
}

/// Arguments of measurements on walks through scenes.
#[derive(Debug, Clone, Args)]
pub struct WalkArguments {
    /// Scenes: procedural ones or glTF files [default: all procedural ones]
    #[arg(long, value_delimiter = ',')]
    pub scenes: Vec<SceneName>,
    /// Frames of each walk that are measured, evenly spread
    #[arg(long, value_parser = value_parser!(u32).range(FRAMES))]
    pub frames: u32,
    #[command(flatten)]
    pub common: Common,
}

impl WalkArguments {
    /// The scenes that are asked for, or these; each can be opened.
    ///
    /// # Errors
    /// A file cannot be read.
    pub fn scenes_or(&self, kinds: &[SceneKind], files: Vec<PathBuf>) -> Result<Vec<SceneName>, LabError> {
        scenes_or(&self.scenes, kinds, files)
    }

    /// Opens a scene with the seed.
    ///
    /// # Errors
    /// A file cannot be read.
    pub fn open(&self, scene: &SceneName) -> Result<World, LabError> {
        let world = scene.open(&SceneOptions { seed: self.common.seed, ..SceneOptions::default() })?;
        world.source.tell();
        Ok(world)
    }
}

/// The scenes that are given, or else procedural ones and files; each can be opened.
///
/// # Errors
/// A file cannot be read.
pub fn scenes_or(
    given: &[SceneName],
    kinds: &[SceneKind],
    files: Vec<PathBuf>,
) -> Result<Vec<SceneName>, LabError> {
    let built = kinds.iter().copied().map(SceneName::Built);
    let names = match given {
        [] => built.chain(files.into_iter().map(SceneName::File)).collect(),
        given => given.to_vec(),
    };
    names.iter().try_for_each(SceneName::check)?;
    Ok(names)
}

/// How often frames are measured.
#[derive(Debug, Clone, Args)]
pub struct Repeats {
    /// Times each frame is measured; the least counts
    #[arg(long, default_value_t = 3, value_parser = value_parser!(u32).range(1..=1000))]
    pub repeats: u32,
}

/// The size of item buffers.
#[derive(Debug, Clone, Args)]
pub struct Width {
    /// Width of the item buffer that finds the visible objects, 16 to 16384
    #[arg(long, value_parser = value_parser!(u32).range(WIDTHS))]
    pub width: u32,
}
