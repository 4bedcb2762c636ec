//! Queries while hidden objects are added, and the cell method against the procedure of the thesis.
//! Prints the ratios of medians at the end.
//!
//! `cargo bench --bench hidden`; objects beyond walls: `casca-lab report --only scaling`; upkeep:
//! `casca-lab report --only thesis`.

use std::time::Duration;

use casca::internals::{SceneInternals, occlusion_by_caps, occlusion_by_lattice};
use casca::{CellOptions, Method, Query, View};
use casca_scenes::drive::{Driver, grid_for};
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::measure::{Settled, median, ratio};
use criterion::Criterion;

const METHODS: [(&str, Method); 2] = [("cell", Method::cell()), ("point", Method::point())];
const HIDDEN: [usize; 3] = [0, 10_000, 50_000];

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

/// The queries of a walk while hidden dynamic objects are added.
fn hidden_objects(c: &mut Criterion) {
    for (name, method) in METHODS {
        let mut group = c.benchmark_group(walk(name));
        group.sample_size(10).measurement_time(Duration::from_secs(7)).warm_up_time(Duration::from_secs(1));
        for hidden_extra in HIDDEN {
            let options = SceneOptions { bunker: true, hidden_extra, ..SceneOptions::default() };
            let mut world = build(SceneKind::Spheres, &options);
            world.set_frame(0);
            let settled = Settled::new(&world, method).unwrap();
            let mut query = Query::with_method(method).unwrap();
            group.bench_function(hidden_extra.to_string(), |b| b.iter(|| settled.walk(&mut query)));
        }
        group.finish();
    }
}

fn walk(method: &str) -> String {
    format!("{method}, walk of 150 queries")
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    against_the_thesis(&mut criterion);
    hidden_objects(&mut criterion);
    criterion.final_summary();
    println!("\nratios of medians");
    let thesis = |name| median("occlusion 100x60x100", name);
    ratio("caps of the thesis / masks of 256", thesis("caps"), thesis("masks 256"));
    ratio("lattice rule over all shells / masks of 256", thesis("lattice"), thesis("masks 256"));
    for (name, _) in METHODS {
        let [few, _, many] = HIDDEN.map(|n| median(&walk(name), &n.to_string()));
        ratio(&format!("{name}: query with 50,000 hidden / without"), many, few);
    }
}
