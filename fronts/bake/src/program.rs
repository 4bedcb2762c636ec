//! The command `casca bake`.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use casca::Aabb;
use casca::glam::DVec3;
use casca_scenes::generated::SceneOptions;
use casca_scenes::name::SceneName;
use casca_tools::command_line::{EXIT_CODES, Outcome};
use clap::{Args, Subcommand};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::{BakeError, Baked, Baker, Level, Places, ReadError, merge, write_whole};

/// Finds ahead of time, for each cell of a level, the objects that can be seen from anywhere in it.
///
/// A bake that was stopped goes on where it was when it is started again: its journal lies beside
/// the file. Objects that move are in no set: test them at run time.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES, args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct Options {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    bake: Option<Bake>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Puts the files of parts together.
    Merge {
        /// The file to write.
        #[arg(long)]
        out: PathBuf,
        /// Files of parts of one bake.
        #[arg(required = true)]
        files: Vec<PathBuf>,
    },
    /// Prints the cells and sets of a file.
    Show {
        /// The file.
        file: PathBuf,
        /// Prints the objects or cells that can be seen from this place: x,y,z in metres.
        #[arg(long, value_parser = place)]
        at: Option<[f64; 3]>,
    },
}

#[derive(Debug, Args)]
struct Bake {
    /// A glTF 2.0 file, or the name of a generated scene such as rooms.
    level: SceneName,
    /// The file to write.
    #[arg(long)]
    out: PathBuf,
    /// The edge of a cell along x and z, in metres.
    #[arg(long, default_value_t = 2.0)]
    cell: f32,
    /// The least and the greatest height of an eye over the floor, as 0.2:2.0, in metres. Cells are
    /// as high as that, and only those are baked in which an eye may be so. Without it, all cells
    /// of the level's box are.
    #[arg(long, value_parser = heights)]
    height: Option<(f32, f32)>,
    /// Bakes only cells whose middle lies in this box, as 0,0,0:40,2,40, in metres.
    #[arg(long, value_parser = corners)]
    within: Option<Aabb>,
    /// Up to about so many queries for each cell. More take longer and make smaller sets.
    #[arg(long, default_value_t = 50)]
    queries: u32,
    /// The edge of a cell of casca's grid, in metres.
    #[arg(long)]
    grid: Option<f32>,
    /// Promises that closed boxes among the parts of meshes hold no eye: then cells that reach into
    /// walls get smaller sets. Not for rooms that are modelled as one box.
    #[arg(long)]
    solid: bool,
    /// Finds which cells may be seen from each cell, instead of which objects: for all that moves.
    #[arg(long)]
    cell_to_cell: bool,
    /// Bakes one of several parts, as 2/5. Put the files together by merge.
    #[arg(long, value_parser = shard)]
    shard: Option<(u32, u32)>,
    /// Threads; 0 takes all cores.
    #[arg(long, default_value_t = 0)]
    threads: usize,
    /// Prints no progress.
    #[arg(long)]
    quiet: bool,
}

/// Two numbers with something between them.
fn pair<T: std::str::FromStr>(text: &str, between: char) -> Option<(T, T)> {
    let (a, b) = text.split_once(between)?;
    Some((a.trim().parse().ok()?, b.trim().parse().ok()?))
}

fn heights(text: &str) -> Result<(f32, f32), String> {
    pair(text, ':').ok_or_else(|| "give the least and the greatest height, as 0.2:2.0".to_owned())
}

fn shard(text: &str) -> Result<(u32, u32), String> {
    pair(text, '/').ok_or_else(|| "give a part and the number of parts, as 2/5".to_owned())
}

fn corners(text: &str) -> Result<Aabb, String> {
    let (low, high) = text.split_once(':').ok_or("give two corners, as 0,0,0:40,2,40")?;
    let [low, high] = [place(low)?, place(high)?].map(|corner| DVec3::from_array(corner).as_vec3());
    Ok(Aabb::new(low, high))
}

fn place(text: &str) -> Result<[f64; 3], String> {
    let numbers: Vec<f64> = text.split(',').map_while(|n| n.trim().parse().ok()).collect();
    numbers.try_into().map_err(|_| "give three numbers, as 1.5,1.7,-4".to_owned())
}

impl Bake {
    fn run(&self) -> Result<(), BakeError> {
        let world = self.level.open(&SceneOptions::default())?;
        world.source.tell();
        let mut level = Level::new(&world, self.grid, self.solid)?;
        let places = Places { edge: self.cell, height: self.height, within: self.within };
        if self.cell_to_cell {
            let (cells, numbers) = (places.cells(&level)?, places.numbers(&level)?);
            level = level.cell_to_cell(&cells, &numbers)?;
        }
        let mut baker = Baker::new(&level, &places, self.queries)?;
        if let Some((part, parts)) = self.shard {
            baker = baker.shard(part, parts)?;
        }
        let threads = match self.threads {
            0 => std::thread::available_parallelism().map_or(1, |n| n.get()),
            threads => threads,
        };
        let bar = match self.quiet {
            true => ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden()),
            false => ProgressBar::new(0),
        };
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} cells, {elapsed}, {eta} left") {
            bar.set_style(style);
        }
        baker.write(&self.out, threads, &mut |done, total| {
            bar.set_length(total as u64);
            if bar.position() == 0 {
                // Cells of an earlier run say nothing about the time left.
                bar.set_position(done as u64);
                bar.reset_eta();
            }
            bar.set_position(done as u64);
            ControlFlow::Continue(())
        })?;
        bar.finish_and_clear();
        if self.quiet { Ok(()) } else { show(&self.out, None) }
    }
}

fn show(file: &Path, at: Option<[f64; 3]>) -> Result<(), BakeError> {
    let read = |why| BakeError::File { act: "read", path: file.to_owned(), why };
    let bytes = std::fs::read(file).map_err(read)?;
    let of = |why: ReadError| BakeError::Of { path: file.to_owned(), why: Box::new(why.into()) };
    let baked = Baked::read(&bytes).map_err(of)?;
    if let Some(at) = at {
        match baked.set_at(at) {
            None => println!(
                "nothing is known about this place, or it is on the border of cells that see different things: all may be seen"
            ),
            Some(set) => set.iter().for_each(|seen| println!("{seen}")),
        }
        return Ok(());
    }
    let cells = baked.cells();
    let [x, y, z] = cells.dims;
    let sizes: Vec<usize> = (0..x * y * z).filter_map(|cell| Some(baked.set(cell)?.iter().count())).collect();
    let mean = sizes.iter().sum::<usize>() as f64 / sizes.len().max(1) as f64;
    println!("{x} x {y} x {z} cells of {:.2} x {:.2} x {:.2} m", cells.size[0], cells.size[1], cells.size[2]);
    println!("{} of them with sets, {} different ones", sizes.len(), baked.sets());
    match baked.is_cell_to_cell() {
        true => println!("{mean:.1} of them in the mean set"),
        false => println!("{mean:.1} of {} objects in the mean set", baked.objects()),
    }
    println!("{} bytes, {:.1} a cell", bytes.len(), bytes.len() as f64 / sizes.len().max(1) as f64);
    Ok(())
}

/// Does what the options say.
///
/// # Errors
/// [`BakeError`].
pub fn run(options: &Options) -> Result<Outcome, BakeError> {
    match (&options.command, &options.bake) {
        (Some(Command::Merge { out, files }), _) => write_whole(out, &merge(files)?)?,
        (Some(Command::Show { file, at }), _) => show(file, *at)?,
        (None, Some(bake)) => bake.run()?,
        (None, None) => {}
    }
    Ok(Outcome::Well)
}
