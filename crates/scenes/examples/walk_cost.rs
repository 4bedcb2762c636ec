//! What the queries of a walk through a generated scene cost: instructions by a profiler.
//!
//! `cargo build --release -p casca-scenes --example walk_cost`, then
//! `valgrind --tool=callgrind --toggle-collect='*walk_cost::walk*' target/release/examples/walk_cost SCENE [EVERY]`

use casca::{Method, PointOptions, Query};
use casca_scenes::generated::{SceneOptions, build};
use casca_scenes::measure::{Settled, timed};

#[inline(never)]
fn walk(settled: &Settled, query: &mut Query, every: usize) -> usize {
    settled.views.iter().step_by(every).map(|view| query.run(&settled.driver.scene, view).len()).sum()
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let name = words.first().map_or("leaves", String::as_str);
    let every = words.get(1).and_then(|w| w.parse().ok()).unwrap_or(10);
    let kind = name.parse().expect("the name of a scene");
    let world = build(kind, &SceneOptions { frames: 40, ..SceneOptions::default() });
    let method = Method::Point(PointOptions::default());
    let settled = Settled::new(&world, method).expect("a scene");
    let mut query = Query::with_method(method).expect("a method");
    let (found, time) = timed(|| walk(&settled, &mut query, every));
    println!("{name}: {found} found, {:.2} ms", time.as_secs_f64() * 1e3);
}
