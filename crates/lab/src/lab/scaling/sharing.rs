//! Static objects that share a mesh: as instances of it, or each with a mesh of its own.

use casca::{Aabb, GridSpec, Method};

use super::super::{Contender, LabError, Section, Table};
use super::Bench;
use super::measure::{frustums, run as run_contender};
use crate::drive::{Driver, Sharing};
use crate::measure::timed;
use crate::scenes::{SceneKind, SceneOptions, build};

const SCENES: [SceneKind; 5] =
    [SceneKind::SpheresMeshes, SceneKind::CityMeshes, SceneKind::Terrain, SceneKind::Rocks, SceneKind::Town];
const WAYS: [(&str, Sharing); 2] = [("instances", Sharing::Instances), ("own meshes", Sharing::Own)];

pub(super) fn run(bench: &Bench, section: &mut Section) -> Result<(), LabError> {
    let columns =
        ["scene", "meshes", "setup, s", "memory, MB", "point, ms", "PVS of point", "cell, ms", "PVS of cell"];
    let mut table = Table::new("scaling-sharing", &columns);
    let scenes = if bench.reach == super::Reach::Smoke { &SCENES[2..3] } else { &SCENES };
    let walks = bench.reach.walks();
    for &kind in scenes {
        (bench.lab.progress)(&format!("shared meshes of {}", kind.name()));
        let world = build(kind, &SceneOptions { seed: bench.lab.seed, ..SceneOptions::default() });
        let grid = GridSpec::fit(Aabb::new(world.grid.min, world.grid.max), world.objects.len())?;
        for (name, sharing) in WAYS {
            let (driver, setup) = timed(|| Driver::sharing(&world, &grid, sharing));
            let driver = driver?;
            let memory = driver.scene.memory().total() as f64;
            let cameras = frustums(&driver, &world, walks.views)?;
            let mut cells = vec![kind.name().to_owned(), name.to_owned()];
            cells.extend([format!("{:.3}", setup.as_secs_f64()), format!("{:.1}", memory / 1e6)]);
            for method in [Method::point(), Method::cell()] {
                let mut contender = Contender::casca("", method)?;
                let (times, found) =
                    run_contender(&mut contender, (&driver, &world), &cameras, walks.repeats)?;
                cells.extend([format!("{:.3}", times.median), format!("{found:.1}")]);
            }
            table.row(cells);
        }
    }
    section.text(
        "### Shared meshes\n\nStatic objects whose mesh others share are instances of it, as in a game, unless their transform stretches \
         it; the lab does so in all experiments. Here beside a mesh of its own for each object: instances take less memory and setup, \
         but have no opaque cells.",
    );
    section.table(table);
    Ok(())
}
