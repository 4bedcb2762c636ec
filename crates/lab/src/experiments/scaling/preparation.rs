//! How fast meshes are prepared.

use std::ops::ControlFlow;

use casca::{MeshOptions, TriMesh};
use rayon::ThreadPoolBuilder;

use super::super::{LabError, Section, Table, grouped};
use super::bench::Bench;
use super::worlds;
use crate::pictures::palette::other;
use crate::pictures::{Axis, Line, lines};
use casca_scenes::measure::timed;
use casca_scenes::world::{Mesh, Shape};

/// The seconds that one thread takes to prepare meshes, and the triangles and bytes of these.
pub(super) fn prepare(meshes: &[Mesh]) -> Result<(f64, usize, usize), LabError> {
    let pool = ThreadPoolBuilder::new().num_threads(1).build()?;
    let (mut seconds, mut triangles, mut bytes) = (0.0, 0, 0);
    for Mesh { positions, triangles: corners, .. } in meshes {
        let (positions, corners) = (positions.clone(), corners.clone());
        triangles += corners.len();
        let (mesh, time) = pool.install(|| {
            let go_on = &mut |_| ControlFlow::Continue(());
            timed(|| TriMesh::prepare(positions, corners, &MeshOptions::default(), go_on))
        });
        bytes += mesh?.memory_bytes();
        seconds += time.as_secs_f64();
    }
    Ok((seconds, triangles, bytes))
}

/// Makes meshes of about this many triangles together, from a seed.
type Build = fn(usize, u64) -> Vec<Mesh>;

/// The meshes of the ground with about this many triangles.
fn ground(triangles: usize, seed: u64) -> Vec<Mesh> {
    let objects = worlds::ground(triangles, seed).objects;
    let mesh = |shape: Shape| match shape {
        Shape::Mesh { mesh, .. } => Some((*mesh).clone()),
        _ => None,
    };
    objects.into_iter().filter_map(|o| mesh(o.shape)).collect()
}

pub(super) fn run(bench: &Bench, section: &mut Section) -> Result<(), LabError> {
    let sizes = bench.sizes([2000, 20_000], [10_000, 100_000, 1_000_000], [10_000_000]);
    let seed = bench.lab.seed;
    let mut table =
        Table::new("scaling-preparation", &["meshes", "triangles", "seconds", "triangles a second", "MB"]);
    let mut all = Vec::new();
    let kinds: [(&str, Build); 3] = [
        ("ground, 100 meshes", ground),
        ("balls of 320 triangles", |n, _| vec![Mesh::ball(2); n.div_ceil(320)]),
        ("soup, one mesh", |n, seed| vec![worlds::soup(n, seed)]),
    ];
    for (i, (name, build)) in kinds.into_iter().enumerate() {
        let mut points = Vec::new();
        // Ten millions in one mesh would take gigabytes.
        for &size in sizes.iter().filter(|&&n| i == 0 || n <= 1_000_000) {
            (bench.lab.progress)(&format!("preparation of {name}: {} triangles", grouped(size)));
            let (seconds, triangles, bytes) = prepare(&build(size, seed))?;
            let rate = triangles as f64 / seconds.max(f64::MIN_POSITIVE);
            points.push((triangles as f64, rate / 1e6));
            table.row([
                name.to_owned(),
                triangles.to_string(),
                format!("{seconds:.3}"),
                format!("{rate:.0}"),
                format!("{:.2}", bytes as f64 / 1e6),
            ]);
        }
        all.push(Line::new(name, other(i), points));
    }
    let last = |line: &Line| line.points.last().map_or(0.0, |p| p.1);
    let title = format!(
        "One core prepares {:.1} to {:.1} million triangles a second at the largest sizes",
        all.iter().map(last).fold(f64::INFINITY, f64::min),
        all.iter().map(last).fold(0.0, f64::max)
    );
    let file = "scaling-preparation.svg";
    let axes = (&Axis::log("triangles"), &Axis::linear("million triangles a second"));
    lines(
        &bench.lab.folder.join(file),
        &title,
        "TriMesh::prepare with default options, one thread.",
        axes,
        &all,
    )?;
    section.picture(file, &title);
    section.rows("All preparations as CSV", table);
    Ok(())
}
