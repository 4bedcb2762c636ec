//! Hidden cells: the masks against the lattice rule, the caps of the thesis
//! and rays from random points of the viewer's cell.

use casca::internals::{BitMatrix, OcclusionMatrix, QueryInternals, SceneInternals, occlusion_by_lattice};

use crate::common::*;

/// A scene whose opaque cells are exactly those of the blocks given.
fn scene_of(dims: IVec3, blocks: &[(IVec3, IVec3)]) -> Scene {
    let mut scene = empty();
    for (lo, size) in blocks {
        let hi = (lo + size).min(dims);
        scene.solid(Aabb::new(lo.as_vec3(), hi.as_vec3()));
    }
    // Walks go no farther than there is anything.
    scene.fixed(Aabb::new(Vec3::ZERO, dims.as_vec3()));
    scene
}

fn hidden_by_masks(scene: &Scene, dims: IVec3, viewer: IVec3, resolution: u32) -> OcclusionMatrix {
    let options = CellOptions::default().mask_resolution(resolution);
    let mut query = query_by(Method::Cell(options));
    query.record_cells(true);
    query.run(scene, &around(viewer.as_vec3() + 0.5));
    assert!(!query.pvs().stats().eye_in_occluder);
    let mut hidden = query.hidden_cells().unwrap().clone();
    let visited = query.visited_cells().unwrap();
    // What lies behind the last shell walked is hidden too: there is something everywhere.
    for c in cells(dims).filter(|&c| !visited.get(c)) {
        hidden.set(c);
    }
    hidden
}

fn cells(dims: IVec3) -> impl Iterator<Item = IVec3> {
    (0..dims.z)
        .flat_map(move |z| (0..dims.y).flat_map(move |y| (0..dims.x).map(move |x| IVec3::new(x, y, z))))
}

/// Whether a segment passes through the inside of an opaque cell, by stepping
/// along every plane it crosses.
fn is_cut(opaque: &BitMatrix, from: DVec3, to: DVec3) -> bool {
    let way = to - from;
    let mut cuts = vec![0.0, 1.0];
    for axis in 0..3 {
        let (a, b) = (from[axis].min(to[axis]), from[axis].max(to[axis]));
        let mut plane = a.ceil();
        while plane <= b {
            cuts.push((plane - from[axis]) / way[axis]);
            plane += 1.0;
        }
    }
    cuts.retain(|t| (0.0..=1.0).contains(t));
    cuts.sort_by(f64::total_cmp);
    cuts.windows(2).any(|w| opaque.get((from + way * ((w[0] + w[1]) * 0.5)).floor().as_ivec3()))
}

fn arb_scene() -> impl Strategy<Value = (IVec3, Vec<(IVec3, IVec3)>, IVec3)> {
    let dims = (6..20i32, 6..16i32, 6..20i32).prop_map(|(x, y, z)| IVec3::new(x, y, z));
    dims.prop_flat_map(|dims| {
        let corner = (0..dims.x, 0..dims.y, 0..dims.z).prop_map(|(x, y, z)| IVec3::new(x, y, z));
        let size = (1..6i32, 1..6i32, 1..6i32).prop_map(|(x, y, z)| IVec3::new(x, y, z));
        (Just(dims), prop::collection::vec((corner.clone(), size), 0..12), corner)
    })
}

proptest! {
    #![proptest_config(cases(96))]

    #[test]
    fn masks_stay_within_the_lattice_rule_and_rays_confirm_it(
        (dims, blocks, viewer) in arb_scene(),
        log in 6..11u32,
        points in prop::collection::vec(prop::array::uniform6(0.0..1.0f64), 64),
    ) {
        let scene = scene_of(dims, &blocks);
        prop_assume!(!scene.is_opaque(viewer));
        let opaque = &*scene.static_opacity();
        let masks = hidden_by_masks(&scene, dims, viewer, 1 << log);
        let lattice = occlusion_by_lattice(opaque, dims, viewer);
        for c in masks.iter().filter(|c| c.cmpge(IVec3::ZERO).all() && c.cmplt(dims).all()) {
            prop_assert!(lattice.get(c), "{c} is hidden by masks only");
        }
        let hidden: Vec<IVec3> = lattice.iter().collect();
        for (i, p) in points.iter().enumerate() {
            if hidden.is_empty() {
                break;
            }
            let c = hidden[i * 7919 % hidden.len()];
            let from = viewer.as_dvec3() + DVec3::new(p[0], p[1], p[2]);
            let to = c.as_dvec3() + DVec3::new(p[3], p[4], p[5]);
            prop_assert!(is_cut(opaque, from, to), "{to} in hidden {c} is seen from {from}");
        }
    }

}

#[test]
fn masks_find_most_of_what_the_lattice_rule_finds() {
    let dims = IVec3::new(40, 30, 40);
    let mut blocks = Vec::new();
    let mut random = Random(11);
    let mut next = |n: usize| random.below(n) as i32;
    for _ in 0..60 {
        let lo = IVec3::new(next(40), next(30), next(40));
        blocks.push((lo, IVec3::new(2 + next(5), 2 + next(5), 2 + next(5))));
    }
    let scene = scene_of(dims, &blocks);
    let viewer = cells(dims).find(|&c| c.x == 20 && c.z == 20 && !scene.is_opaque(c)).unwrap();
    let lattice = occlusion_by_lattice(&scene.static_opacity(), dims, viewer).count() as f64;
    let mut last = 0.0;
    for (resolution, least) in [(64, 0.5), (256, 0.8), (1024, 0.9)] {
        let share = hidden_by_masks(&scene, dims, viewer, resolution).count() as f64 / lattice;
        println!("{resolution}: {:.1}% of {lattice} cells", share * 100.0);
        assert!(share > least, "{resolution}: {share}");
        assert!(share >= last);
        last = share;
    }
}
