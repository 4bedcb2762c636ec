//! The point method under growing numbers of hidden objects. Prints the ratios of medians at
//! the end.
//!
//! `cargo bench --bench point`; speed against accuracy, and against other methods:
//! `casca-lab report --only tradeoff`.

use std::time::Duration;

use casca::{Method, Query};
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::measure::{Settled, median, ratio};
use criterion::Criterion;

const WALK: &str = "point, walk of 50 queries";

fn measure(c: &mut Criterion, name: &str, options: SceneOptions) -> f64 {
    let mut world = build(SceneKind::Spheres, &SceneOptions { frames: 50, ..options });
    world.set_frame(0);
    let settled = Settled::new(&world, Method::default()).expect("a plain scene");
    let mut group = c.benchmark_group(WALK);
    group.sample_size(20).measurement_time(Duration::from_secs(3)).warm_up_time(Duration::from_millis(500));
    let mut query = Query::new();
    group.bench_function(name, |b| b.iter(|| settled.walk(&mut query)));
    group.finish();
    settled.walk(&mut query) as f64 / settled.views.len() as f64
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    let beyond = |n| SceneOptions { beyond_walls: Some(n), ..SceneOptions::default() };
    let hidden = |n| SceneOptions { bunker: true, hidden_extra: n, ..SceneOptions::default() };
    let mut found = Vec::new();
    for (name, options) in [
        ("walls", beyond(0)),
        ("walls, 95000 beyond", beyond(95_000)),
        ("bunker", hidden(0)),
        ("bunker, 50000 inside", hidden(50_000)),
    ] {
        found.push((name, measure(&mut criterion, name, options)));
    }
    criterion.final_summary();
    println!("\nratios of medians");
    let time = |name| median(WALK, name);
    ratio(
        "5,000 objects and 95,000 beyond walls / without those",
        time("walls, 95000 beyond"),
        time("walls"),
    );
    ratio("50,000 moving ones in a bunker / without", time("bunker, 50000 inside"), time("bunker"));
    for (name, n) in found {
        println!("{:<64}{n:>10.1}", format!("mean PVS: {name}"));
    }
}
