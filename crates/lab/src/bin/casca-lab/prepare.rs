//! Prepares meshes once and keeps them in a file, so that the next start only reads them: meshes
//! made here, or those of a glTF 2.0 file.

use std::collections::HashSet;
use std::fs::File;
use std::io::{BufReader, BufWriter, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use casca::{Facing, FileError, MeshOptions, TriMesh};
use casca_cache::MeshCache;
use casca_scenes::import;
use casca_scenes::measure::timed_by_wall;
use casca_scenes::world::{Mesh, Shape};
use casca_tools::command_line::{EXIT_CODES, Outcome, PathError, say, try_writing};
use clap::Parser;
use glam::{EulerRot, Quat, Vec3};

use crate::Failure;
use crate::arguments::{Cached, Out, about};
use crate::progress;

/// The options.
#[derive(Debug, Parser)]
#[command(about = "Prepares meshes, saves them, and reads them back", after_help = EXIT_CODES, allow_negative_numbers = true,
    mut_arg("out", about("target/prepare/meshes.casca", "Where the prepared meshes go")))]
pub struct Options {
    /// A glTF 2.0 file (.glb or .gltf) [default: a mesh made here]
    input: Option<PathBuf>,
    /// How far outlines may leave the edges of triangles [default: a 2000th of each mesh's
    /// diagonal]
    #[arg(long, value_parser = parse_length)]
    tolerance: Option<f32>,
    #[command(flatten)]
    cached: Cached,
    #[command(flatten)]
    out: Out,
    /// No progress bar
    #[arg(long)]
    quiet: bool,
}

fn parse_length(text: &str) -> Result<f32, String> {
    let found = text.parse::<f32>().ok().filter(|n| n.is_finite() && *n >= 0.0);
    found.ok_or_else(|| "expected a length from 0".to_owned())
}

/// Rocks: a ball with bumps, some times over.
fn rocks() -> Vec<(String, Arc<Mesh>)> {
    const RINGS: u32 = 96;
    const AROUND: u32 = 192;
    let rock = |number: u32| {
        let mut mesh = Mesh::default();
        let turn = Quat::from_euler(EulerRot::XYZ, number as f32, 2.0 * number as f32, 0.0);
        for ring in 0..=RINGS {
            for step in 0..AROUND {
                let tilt = std::f32::consts::PI * ring as f32 / RINGS as f32;
                let angle = std::f32::consts::TAU * step as f32 / AROUND as f32;
                // At the poles all steps are one point.
                let flat = if ring % RINGS == 0 { 0.0 } else { tilt.sin() };
                let n = Vec3::new(flat * angle.cos(), tilt.cos(), flat * angle.sin());
                let wave = (turn * n * 3.0).to_array().map(f32::sin);
                mesh.positions.push(n * (1.0 + 0.1 * wave.iter().sum::<f32>()));
            }
        }
        for ring in 0..RINGS {
            for step in 0..AROUND {
                let corner = |down: u32, on: u32| (ring + down) * AROUND + (step + on) % AROUND;
                let (a, b, c, d) = (corner(0, 0), corner(0, 1), corner(1, 1), corner(1, 0));
                mesh.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        (format!("rock {number}"), Arc::new(mesh))
    };
    (1..=4).map(rock).collect()
}

/// The meshes of a file, each once, with the name of the first object that has it.
fn meshes_of(path: &Path) -> Result<Vec<(String, Arc<Mesh>)>, import::ImportError> {
    let mut known = HashSet::new();
    let mut meshes = Vec::new();
    for object in import::load(path)?.objects {
        if let Shape::Mesh { mesh, .. } = object.shape
            && known.insert(Arc::as_ptr(&mesh))
        {
            meshes.push((object.name, mesh));
        }
    }
    Ok(meshes)
}

/// Prepares meshes, with a bar that counts their triangles.
fn prepare(
    meshes: &[(String, Arc<Mesh>)],
    options: &Options,
    cache: Option<&MeshCache>,
) -> Result<Vec<TriMesh>, casca::Error> {
    let mut how = MeshOptions::default();
    how.tolerance = options.tolerance;
    let bar = progress::bar(options.quiet, triangles(meshes), "", "triangle");
    let mut done = 0;
    let prepared = meshes.iter().map(|(name, mesh)| {
        bar.set_message(name.clone());
        let count = mesh.triangles.len();
        let mut progress = |share: f32| {
            bar.set_position(done + (share * count as f32) as u64);
            ControlFlow::Continue(())
        };
        let hiding = mesh.hiding();
        let facing = if hiding.as_ref().is_some_and(|h| h.1) { Facing::Front } else { Facing::Both };
        let how = how.occludes(hiding.is_some()).facing(facing);
        let triangles = hiding.map_or_else(|| mesh.triangles.clone(), |h| h.0.into_owned());
        let positions = mesh.positions.clone();
        let prepared = match cache {
            Some(cache) => cache.prepare(positions, triangles, &how, &mut progress),
            None => TriMesh::prepare(positions, triangles, &how, &mut progress),
        };
        done += count as u64;
        prepared
    });
    let prepared = prepared.collect();
    bar.finish_and_clear();
    prepared
}

fn triangles(meshes: &[(String, Arc<Mesh>)]) -> usize {
    meshes.iter().map(|(_, mesh)| mesh.triangles.len()).sum()
}

fn save(path: &Path, prepared: &[TriMesh]) -> std::io::Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    prepared.iter().try_for_each(|mesh| mesh.write(&mut file))?;
    file.flush()
}

/// Reads the meshes of a file to its end.
fn load(path: &Path) -> Result<Vec<TriMesh>, Failure> {
    let mut file = BufReader::new(File::open(path).map_err(PathError::read(path))?);
    let mut loaded = Vec::new();
    loop {
        match TriMesh::read(&mut file) {
            Ok(mesh) => loaded.push(mesh),
            Err(FileError::Truncated { held: 0, .. }) => return Ok(loaded),
            Err(e) => return Err(format!("{}: {e}", path.display()).into()),
        }
    }
}

/// Says which mesh is not the same after loading. Equal meshes have equal bytes.
fn compare(meshes: &[(String, Arc<Mesh>)], prepared: &[TriMesh], loaded: &[TriMesh]) -> Result<(), Failure> {
    let bytes = |mesh: &TriMesh| {
        let mut bytes = Vec::new();
        mesh.write(&mut bytes).map(|()| bytes)
    };
    if loaded.len() != prepared.len() {
        return Err(format!("{} meshes were saved, but {} loaded", prepared.len(), loaded.len()).into());
    }
    for ((name, _), (a, b)) in meshes.iter().zip(prepared.iter().zip(loaded)) {
        if bytes(a)? != bytes(b)? {
            return Err(format!("{name} is not the same after loading").into());
        }
    }
    Ok(())
}

/// Prepares the meshes, writes them, reads them back and compares.
pub fn run(options: &Options) -> Result<Outcome, Failure> {
    // Large meshes take a while: what cannot be written is said before it.
    try_writing(&options.out.out)?;
    let meshes = match &options.input {
        Some(path) => meshes_of(path)?,
        None => rocks(),
    };
    let cache = options.cached.open()?;
    // Several threads may prepare meshes, and files are waited for.
    let (prepared, preparing) = timed_by_wall(|| prepare(&meshes, options, cache.as_ref()));
    let prepared = prepared?;
    let (saved, saving) = timed_by_wall(|| save(&options.out.out, &prepared));
    saved.map_err(PathError::write(&options.out.out))?;
    let (loaded, loading) = timed_by_wall(|| load(&options.out.out));
    compare(&meshes, &prepared, &loaded?)?;

    let row = |name: &str, value: String| say(format_args!("{name:<26}{value:>12}"));
    let sum = |count: fn(&TriMesh) -> usize| prepared.iter().map(count).sum::<usize>().to_string();
    let seconds = |time: Duration| format!("{:.3} s", time.as_secs_f64());
    row("meshes", prepared.len().to_string());
    row("closed", sum(|m| usize::from(m.is_closed())));
    row("triangles", triangles(&meshes).to_string());
    row("patches kept of them", sum(TriMesh::patches));
    row("sides of their outlines", sum(TriMesh::sides));
    row(
        "bytes",
        std::fs::metadata(&options.out.out).map_err(PathError::read(&options.out.out))?.len().to_string(),
    );
    if let Some(counts) = cache.map(|cache| cache.counts()) {
        row("read from the cache", counts.hits.to_string());
    }
    row("preparing", seconds(preparing));
    row("saving", seconds(saving));
    row("loading", seconds(loading));
    if prepared.is_empty() {
        return Ok(Outcome::NothingChecked);
    }
    say(format_args!("\nall meshes are the same after loading: {}", options.out.out.display()));
    Ok(Outcome::Well)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(words: &[&str]) -> Result<Options, String> {
        Options::try_parse_from(std::iter::once(&"prepare").chain(words)).map_err(|e| e.to_string())
    }

    #[test]
    fn lengths_that_are_none_are_refused() {
        for bad in ["NaN", "inf", "-1", "-0.001", "1e99", "", "wide"] {
            let said = options(&[&format!("--tolerance={bad}")]).expect_err(bad);
            assert!(said.contains("expected a length from 0"), "{bad}: {said}");
        }
        for (good, length) in [("0", 0.0), ("0.25", 0.25)] {
            assert_eq!(options(&["--tolerance", good]).unwrap().tolerance, Some(length));
        }
    }

    #[test]
    fn a_place_that_cannot_be_written_or_read_is_named() {
        let place = std::env::temp_dir().join(format!("casca-prepare-{}", std::process::id()));
        std::fs::create_dir_all(&place).unwrap();
        let failure = |words: &[&str]| run(&options(words).unwrap()).unwrap_err().to_string();
        let name = place.to_str().unwrap();
        assert!(failure(&["--quiet", "--out", name]).contains(name));
        let file = place.join("meshes.casca");
        let said = failure(&["--quiet", "--out", file.to_str().unwrap(), "no/such.glb"]);
        assert!(said.contains("no/such.glb"), "{said}");
        assert!(!file.exists());
        std::fs::remove_dir_all(&place).unwrap();
    }
}
