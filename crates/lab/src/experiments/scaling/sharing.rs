//! Static objects that share a mesh: as instances of it, or each with a mesh of its own.

use casca::{Aabb, GridSpec, Method};

use super::super::{Contender, Effort, LabError, Section, Table};
use super::bench::Bench;
use super::measure::{Turn, frustums, take_turns};
use casca_scenes::drive::{Driver, Sharing};
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::measure::timed_by_wall;

const SCENES: [SceneKind; 5] =
    [SceneKind::SpheresMeshes, SceneKind::CityMeshes, SceneKind::Terrain, SceneKind::Rocks, SceneKind::Town];
const METHODS: [Method; 2] = [Method::point(), Method::cell()];
const WAYS: [(&str, Sharing); 2] = [("instances", Sharing::Instances), ("own meshes", Sharing::Own)];

pub(super) fn run(bench: &Bench, section: &mut Section) -> Result<(), LabError> {
    let columns =
        ["scene", "meshes", "setup, s", "memory, MB", "point, ms", "PVS of point", "cell, ms", "PVS of cell"];
    let mut table = Table::new("scaling-sharing", &columns);
    let scenes = if bench.effort == Effort::Quick { &SCENES[2..3] } else { &SCENES };
    let walks = bench.walks();
    for &kind in scenes {
        (bench.lab.progress)(&format!("shared meshes of {}", kind.name()));
        let world = build(kind, &SceneOptions { seed: bench.lab.seed, ..SceneOptions::default() });
        let grid = GridSpec::fit(Aabb::new(world.grid.min, world.grid.max), world.objects.len())?;
        let mut drivers = Vec::new();
        for (_, sharing) in WAYS {
            // Several threads prepare meshes.
            let (driver, setup) = timed_by_wall(|| Driver::sharing(&world, &grid, sharing));
            let driver = driver?;
            // Queries by cell would add their lists.
            let memory = driver.scene.memory().total() as f64;
            drivers.push((driver, setup.as_secs_f64(), memory));
        }
        let cameras = match drivers.first() {
            Some((driver, ..)) => frustums(driver, &world, walks.views)?,
            None => Vec::new(),
        };
        let mut turns = Vec::new();
        for (driver, ..) in &drivers {
            for method in METHODS {
                turns.push(Turn::new(Contender::casca("", method)?, driver));
            }
        }
        take_turns(&mut turns, &world, &cameras, walks.repeats)?;
        let mut results = turns.into_iter().map(Turn::results);
        for ((name, _), (_, setup, memory)) in WAYS.iter().zip(&drivers) {
            let first = [kind.name().to_owned(), (*name).to_owned()];
            let second = [format!("{setup:.3}"), format!("{:.1}", memory / 1e6)];
            let queries = results.by_ref().take(METHODS.len());
            let queries: Vec<String> = queries
                .flat_map(|(times, found)| [format!("{:.3}", times.median), format!("{found:.1}")])
                .collect();
            table.row(first.into_iter().chain(second).chain(queries));
        }
    }
    section.text(
        "### Shared meshes\n\nStatic objects whose mesh others share are instances of it, as in a game, unless their transform stretches \
         it; the lab does so in all experiments. Here beside a mesh of its own for each object: instances take less memory and setup, \
         but have no opaque cells, so that `cell` finds less hidden.",
    );
    section.table(table);
    Ok(())
}
