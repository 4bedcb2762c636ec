//! Views with a reach on whole scenes: no set lacks an object that an eye within reach sees.

use std::path::{Path, PathBuf};

use casca_scenes::drive::{Driver, fitted_cell, view_of};
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::import;
use casca_scenes::world::World;
use casca_truth::oracle::{BallCounts, BallOptions, BallOracle, OracleOptions};

use crate::common::*;

const ASPECT: f32 = 16.0 / 9.0;
/// Balls around the eye of one frame.
const BALLS: usize = 6;
/// Rays aimed at a scene in one round, at most.
const CHUNK: u64 = 10_000_000;
/// Frames of a scene in one round, at most: a few rays find all of the smallest ones.
const FRAMES: usize = 40;

/// Reaches from 2 mm to 3 m, ascending; the first is 0.
fn reaches(random: &mut Random) -> [f32; BALLS] {
    let mut reaches = std::array::from_fn(|_| 0.002 * 1500f32.powf(random.unit()));
    reaches[0] = 0.0;
    reaches.sort_by(f32::total_cmp);
    reaches
}

/// Aims this many rays from balls at random frames of a scene; returns how much was looked at, and
/// the objects that were lost by sets for `share` of the reach.
fn chunk(world: &mut World, random: &mut Random, rays: u64, share: f32) -> (BallCounts, Vec<String>) {
    let cell = fitted_cell(world).unwrap();
    world.set_frame(0);
    let mut driver = Driver::new(world, cell, |_| ()).unwrap();
    let seed = u64::from(random.unit().to_bits());
    let each = OracleOptions { width: 320, height: 180, samples_per_object: 8, max_candidates: 3000, seed };
    let options = BallOptions { each, eyes: 64, buffers: 8, past_rims: 2048 };
    let mut oracle = BallOracle::new(&world.objects, options);
    let presets = [PointOptions::fast(), PointOptions::balanced(), PointOptions::tight()];
    let mut queries = presets.map(|p| query_by(Method::Point(p)));
    let mut lost = Vec::new();
    for _ in 0..FRAMES {
        let number = (random.unit() * world.frames as f32) as usize;
        let moved = go_to(&mut driver, world, number);
        let camera = world.camera(number, ASPECT);
        let view = view_of(&camera).unwrap();
        driver.scene.end_frame([queries[1].run(&driver.scene, &view)]).unwrap();
        oracle.begin(&world.objects, &moved, &camera);
        for reach in reaches(random) {
            oracle.look(&world.objects, reach);
            let wide = view.clone().with_reach(reach * share).unwrap();
            for query in &mut queries {
                let pvs = query.run(&driver.scene, &wide);
                for s in oracle.missing(|object| driver.sees(pvs, object)) {
                    lost.push(format!("{} frame {number}, {reach} m, {:?}: {s:?}", world.name, pvs.method()));
                }
            }
        }
        if oracle.counts().rays >= rays {
            break;
        }
    }
    (oracle.counts(), lost)
}

fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes");
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> = entries.map(|e| e.path()).collect();
    files.retain(|p| p.extension().is_some_and(|e| e == "glb"));
    files.sort();
    files
}

#[test]
fn balls_find_what_sets_for_half_the_reach_lack() {
    for kind in [SceneKind::City, SceneKind::Forest] {
        let mut world = build(kind, &SceneOptions::default());
        let (_, lost) = chunk(&mut world, &mut Random(3), 6_000_000, 0.5);
        println!("{kind:?}: {} lost", lost.len());
        assert!(!lost.is_empty(), "{kind:?}");
    }
}

#[test]
#[ignore = "takes minutes"]
fn long_run_of_balls() {
    let wanted: u64 =
        std::env::var("CASCA_BALL_RAYS").ok().and_then(|v| v.parse().ok()).unwrap_or(100_000_000);
    let seed: u64 = std::env::var("CASCA_SEED").ok().and_then(|v| v.parse().ok()).unwrap_or(1);
    let (mut random, files) = (Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)), files());
    if files.is_empty() {
        println!("files: skipped, there are none");
    }
    let (mut aimed, mut pixels, mut lost) = (0, 0, Vec::new());
    let (mut round, scenes) = (0, (SceneKind::ALL.len() + files.len()) as u64);
    let each = wanted.div_ceil(scenes).min(CHUNK);
    // Each round has other scenes of each kind; only whole rounds count, so that no scene is left
    // out.
    while aimed < wanted {
        let options = SceneOptions { seed: seed.wrapping_add(round), ..SceneOptions::default() };
        let built = SceneKind::ALL.into_iter().map(|kind| build(kind, &options));
        for mut world in built.chain(files.iter().map(|f| import::load(f).unwrap())) {
            let (counts, new) = chunk(&mut world, &mut random, each, 1.0);
            (aimed, pixels) = (aimed + counts.rays, pixels + counts.item_rays);
            println!(
                "round {round}, {}: {:.1} million rays aimed, {:.1} million pixels, {} lost so far",
                world.name,
                aimed as f64 / 1e6,
                pixels as f64 / 1e6,
                lost.len() + new.len()
            );
            lost.extend(new);
        }
        round += 1;
    }
    assert!(lost.is_empty(), "{} lost, the first: {:#?}", lost.len(), &lost[..lost.len().min(10)]);
}
