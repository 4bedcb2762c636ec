//! The cell method: against the procedure of the thesis, and under growing
//! numbers of hidden objects. Prints the ratios of medians at the end.
//!
//! `cargo bench --bench cell`; accuracy at the same settings: `casca-lab walk`; upkeep:
//! `casca-lab report --only thesis`.

use std::time::Duration;

use casca::internals::{SceneInternals, occlusion_by_caps, occlusion_by_lattice};
use casca::{CellOptions, Method, Query, View};
use casca_scenes::drive::{Driver, grid_for};
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::measure::{Settled, median, ratio};
use criterion::Criterion;

fn settled(hidden_extra: usize) -> Settled {
    let options = SceneOptions { bunker: true, hidden_extra, ..SceneOptions::default() };
    let mut world = build(SceneKind::Spheres, &options);
    world.set_frame(0);
    Settled::new(&world, Method::cell()).unwrap()
}

/// Masks against the thesis' caps, both in all directions.
fn against_the_thesis(c: &mut Criterion) {
    let world = build(SceneKind::Spheres, &SceneOptions::default());
    let driver = Driver::new(&world, &grid_for(&world.grid, None).unwrap(), |_| ()).unwrap();
    let scene = &driver.scene;
    let eye = world.camera(75, 1.0).eye;
    let viewer = scene.grid().cell_of(eye.as_dvec3());
    let view = View::omnidirectional(eye).unwrap();
    let mut group = c.benchmark_group("occlusion 100x60x100");
    group.sample_size(10).measurement_time(Duration::from_secs(3)).warm_up_time(Duration::from_millis(500));
    for resolution in [128, 256, 512, 1024] {
        let options = CellOptions::default().mask_resolution(resolution);
        let mut query = Query::with_method(Method::Cell(options)).unwrap();
        group.bench_function(format!("masks {resolution}"), |b| b.iter(|| query.run(scene, &view).len()));
    }
    let opaque = &*scene.static_opacity();
    group.bench_function("caps", |b| b.iter(|| occlusion_by_caps(opaque, viewer).0.count()));
    group.bench_function("lattice", |b| b.iter(|| occlusion_by_lattice(opaque, viewer).count()));
    group.finish();
}

/// The query of the walk while hidden dynamic objects are added.
fn hidden_objects(c: &mut Criterion) {
    let scenes = [0, 10_000, 50_000].map(|n| (n, settled(n)));
    let mut group = c.benchmark_group("walk of 150 queries");
    group.sample_size(10).measurement_time(Duration::from_secs(7)).warm_up_time(Duration::from_secs(1));
    for (n, s) in &scenes {
        let mut query = Query::with_method(Method::cell()).unwrap();
        group.bench_function(format!("{n} hidden"), |b| {
            b.iter(|| s.views.iter().map(|v| query.run(&s.driver.scene, v).len()).sum::<usize>());
        });
    }
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    against_the_thesis(&mut criterion);
    hidden_objects(&mut criterion);
    criterion.final_summary();
    let (thesis, walk) = ("occlusion 100x60x100", "walk of 150 queries");
    println!("\nratios of medians");
    ratio("caps of the thesis / masks of 256", median(thesis, "caps"), median(thesis, "masks 256"));
    ratio(
        "lattice rule over all shells / masks of 256",
        median(thesis, "lattice"),
        median(thesis, "masks 256"),
    );
    ratio("query with 50,000 hidden / without", median(walk, "50000 hidden"), median(walk, "0 hidden"));
}
