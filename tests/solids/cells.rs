//! The opaque cells of a scene after solids came, moved and went, against the runs of each solid
//! alone and against points inside them.

use casca::internals::{BitMatrix, SceneInternals, Shape, ShapeInternals, Which};

use crate::common::*;

/// A solid in a cube of this size; many boxes have faces in common, inside cells.
fn some_solid(random: &mut Random, size: f32, most: f32) -> Occluder {
    let center = random.place(0.0, 1.0, 0.125) * size;
    let half = random.place(0.0, 1.0, 0.125) * random.unit() * most * 0.5 + 0.5;
    match random.below(5) {
        0 => Sphere::new(center, half.x).into(),
        1 => Obb::new(center, half, Quat::from_rotation_y(random.unit() * 6.0)).into(),
        2 => {
            let points: Vec<Vec3> =
                (0..8).map(|_| center + (random.place(0.0, 1.0, 0.125) - 0.5) * 2.0 * half).collect();
            Convex::from_points(&points).map_or(Sphere::new(center, 1.5).into(), |c| Arc::new(c).into())
        }
        _ => {
            let quarter = |v: Vec3| (v * 0.25).round() * 4.0 + 0.25;
            let (min, max) = (quarter(center - half), quarter(center + half));
            Aabb::new(min, max.max(min + 4.0)).into()
        }
    }
}

/// A box around a solid.
fn box_of(solid: &Occluder) -> Aabb {
    let (min, max) = solid.shape().bounds();
    Aabb::new(min.as_vec3() - 0.01, max.as_vec3() + 0.01)
}

/// The cells that solids make opaque each for itself.
fn alone<'a>(scene: &Scene, solids: impl IntoIterator<Item = &'a Occluder>) -> BitMatrix {
    let mut cells = BitMatrix::default();
    for solid in solids {
        solid.shape().rows(scene.grid(), Which::Opaque, &mut |run| run.cells().for_each(|c| cells.set(c)));
    }
    cells
}

fn assert_same(a: &BitMatrix, b: &BitMatrix, what: &str) {
    assert!(a.is_subset(b) && b.is_subset(a), "{what}: {} cells, {} expected", a.count(), b.count());
}

/// Points all over a cell lie in some of the solids.
fn assert_filled(cell: IVec3, solids: &[&Occluder]) {
    for i in 0..64 {
        let at = IVec3::new(i % 4, i / 4 % 4, i / 16).as_dvec3() * 0.332 + 0.002;
        assert!(solids.iter().any(|s| s.shape().contains_point(cell.as_dvec3() + at)), "{cell} is open");
    }
}

/// Inserts and removes solids; after each step the scene is as one that never had the others.
fn come_and_go(seed: u64, cells: u32, most: f32, steps: usize) -> usize {
    let mut random = Random(seed);
    let mut scene = empty();
    let mut held: Vec<(ObjectId, Occluder)> = Vec::new();
    let (mut joint, mut removed) = (0, 0);
    for step in 0..steps {
        if held.len() > 4 && random.below(3) > 0 || held.len() > 14 {
            let (id, _) = held.remove(random.below(held.len()));
            scene.remove(id).unwrap();
            removed += 1;
        } else {
            let solid = some_solid(&mut random, cells as f32, most);
            let id = scene.insert(ObjectDesc::fixed(box_of(&solid)).occluder(solid.clone())).unwrap();
            held.push((id, solid));
        }
        let mut fresh = empty();
        for (_, solid) in &held {
            fresh.insert(ObjectDesc::fixed(box_of(solid)).occluder(solid.clone())).unwrap();
        }
        assert_same(&scene.static_opacity(), &fresh.static_opacity(), &format!("seed {seed}, step {step}"));
        assert_eq!(scene.id_matrix().entries(), fresh.id_matrix().entries());
        let single = alone(&scene, held.iter().map(|h| &h.1));
        assert!(single.is_subset(&scene.static_opacity()), "seed {seed}, step {step}");
        for c in scene.static_opacity().iter().filter(|&c| !single.get(c)) {
            joint += 1;
            for i in 0..125 {
                let at = IVec3::new(i % 5, i / 5 % 5, i / 25).as_dvec3() * 0.249 + 0.002;
                let point = c.as_dvec3() + at;
                assert!(
                    held.iter().any(|h| h.1.shape().contains_point(point)),
                    "seed {seed}, step {step}, cell {c}"
                );
            }
        }
    }
    assert!(removed > steps / 8, "{removed} removed");
    held.into_iter().for_each(|(id, _)| scene.remove(id).unwrap());
    assert_eq!((scene.static_opacity().count(), scene.id_matrix().entries()), (0, 0));
    joint
}

#[test]
fn static_solids_leave_what_others_fill() {
    let small: usize = (1..6).map(|seed| come_and_go(seed, 20, 12.0, 60)).sum();
    let large: usize = (6..8).map(|seed| come_and_go(seed, 72, 80.0, 32)).sum();
    assert!(small > 50 && large > 50, "{small} {large} cells that solids fill together");
    come_and_go(9, 140, 160.0, 12);
}

/// Solids that fill whole pages of bricks, with others in them and beside them.
#[test]
fn static_solids_as_large_as_pages_come_and_go() {
    let mut scene = empty();
    let boxed = |a: [f32; 3], b: [f32; 3]| Occluder::from(Aabb::new(a.into(), b.into()));
    let solids = [
        boxed([0.5; 3], [199.5; 3]),
        boxed([-5.0; 3], [130.25, 205.0, 205.0]),
        boxed([130.25, -5.0, -5.0], [205.0; 3]),
        Sphere::new(Vec3::splat(100.0), 99.0).into(),
        Sphere::new(Vec3::new(80.3, 90.0, 70.0), 10.4).into(),
        Obb::new(Vec3::splat(100.0), Vec3::splat(80.0), Quat::from_rotation_z(0.4)).into(),
        boxed([128.0; 3], [192.0; 3]),
    ];
    let mut random = Random(3);
    for round in 0..2 {
        let mut held: Vec<(ObjectId, &Occluder)> = Vec::new();
        let mut order: Vec<&Occluder> = solids.iter().collect();
        for i in 1..order.len() {
            order.swap(i, random.below(i + 1));
        }
        for solid in order {
            held.push((
                scene.insert(ObjectDesc::fixed(box_of(solid)).occluder(solid.clone())).unwrap(),
                solid,
            ));
        }
        while !held.is_empty() {
            let (id, _) = held.swap_remove(random.below(held.len()));
            scene.remove(id).unwrap();
            let single = alone(&scene, held.iter().map(|h| h.1));
            let both = [&solids[1], &solids[2]].iter().all(|s| held.iter().any(|h| std::ptr::eq(h.1, *s)));
            let all = &*scene.static_opacity();
            assert!(single.is_subset(all), "round {round}: {:?}", single.iter().find(|&c| !all.get(c)));
            let solids: Vec<&Occluder> = held.iter().map(|h| h.1).collect();
            all.iter().filter(|&c| !single.get(c)).for_each(|c| assert_filled(c, &solids));
            // The cells at x = 130 lie in both halves, wherever no other solid covers them.
            let seam = (0..40_000).map(|i| IVec3::new(130, i % 200, i / 200));
            assert!(!both || seam.into_iter().all(|c| scene.is_opaque(c)), "round {round}");
        }
        assert_eq!(scene.static_opacity().count(), 0);
    }
}

/// A cell that a solid too large for the lists of cells fills together with another goes with it.
#[test]
fn a_huge_solid_takes_its_share_of_cells_with_it() {
    let mut scene = empty();
    let huge = Aabb::new(Vec3::splat(0.5), Vec3::new(100.5, 255.5, 255.5));
    let small = Aabb::new(Vec3::new(100.5, 20.0, 20.0), Vec3::splat(110.0));
    let shared = IVec3::new(100, 50, 50);
    for huge_first in [true, false] {
        let mut ids = Vec::new();
        for b in if huge_first { [huge, small] } else { [small, huge] } {
            ids.push(scene.solid(b));
        }
        assert!(scene.is_opaque(shared), "both fill it, whichever came first");
        let gone = if huge_first { ids[0] } else { ids[1] };
        scene.remove(gone).unwrap();
        assert!(!scene.is_opaque(shared), "half of it is open");
        ids.into_iter().filter(|&id| id != gone).for_each(|id| scene.remove(id).unwrap());
        assert_eq!(scene.static_opacity().count(), 0);
    }
}

#[test]
fn dynamic_solids_make_their_own_cells_opaque_and_no_others() {
    for (seed, cells, most) in [(1, 24, 14.0), (2, 24, 30.0), (3, 90, 110.0)] {
        let mut random = Random(seed);
        let mut scene = empty();
        let mut held: Vec<(ObjectId, Occluder)> = Vec::new();
        for step in 0..120 {
            match random.below(4) {
                0 | 1 if held.len() > 3 => {
                    let i = random.below(held.len());
                    let solid = if step % 2 == 0 {
                        let size = cells as f32;
                        some_solid(&mut random, size, most)
                    } else {
                        match &held[i].1 {
                            Occluder::Sphere(s) => {
                                Sphere::new(s.center + random.place(0.0, 1.0, 0.125), s.radius).into()
                            }
                            Occluder::Box(b) => Aabb::new(b.min + 0.3, b.max + 0.6).into(),
                            other => other.clone(),
                        }
                    };
                    scene.update(held[i].0, box_of(&solid), Some(solid.clone())).unwrap();
                    held[i].1 = solid;
                }
                2 if held.len() > 6 => {
                    let (id, _) = held.swap_remove(random.below(held.len()));
                    scene.remove(id).unwrap();
                }
                _ => {
                    let solid = some_solid(&mut random, cells as f32, most);
                    let desc = ObjectDesc::dynamic(box_of(&solid)).occluder(solid.clone());
                    held.push((scene.insert(desc).unwrap(), solid));
                }
            }
            let expected = alone(&scene, held.iter().map(|h| &h.1));
            assert_same(&scene.dynamic_opacity(), &expected, &format!("seed {seed}, step {step}"));
            let mut entries = 0;
            for (_, solid) in &held {
                let mut bricks = BTreeSet::new();
                box_of(solid).rows(scene.grid(), Which::Touched, &mut |run| {
                    bricks.extend(run.cells().map(|cell| (cell >> 3i32).to_array()));
                });
                entries += bricks.len();
            }
            assert_eq!(scene.id_matrix().entries(), entries, "seed {seed}, step {step}");
        }
    }
}

/// The inside of a solid costs neither time nor room: these would take gigabytes cell by cell.
#[test]
fn huge_solids_cost_their_surface() {
    let mut scene = empty();
    let bare = scene.memory().total();
    let (low, high) = (Vec3::splat(0.5), Vec3::splat(1023.5));
    let middle = (low + high) * 0.5;
    let solids: [Occluder; 3] = [
        Aabb::new(low, high).into(),
        Sphere::new(middle, 500.0).into(),
        Obb::new(middle, Vec3::splat(300.0), Quat::from_rotation_x(0.3)).into(),
    ];
    for solid in solids {
        for dynamic in [false, true] {
            let bounds = box_of(&solid);
            let desc = if dynamic { ObjectDesc::dynamic(bounds) } else { ObjectDesc::fixed(bounds) };
            let id = scene.insert(desc.occluder(solid.clone())).unwrap();
            assert!(scene.is_opaque(IVec3::splat(512)) && !scene.is_opaque(IVec3::ZERO));
            let surface = scene.memory().total() - bare;
            assert!(surface < 40 << 20, "{surface} bytes for {solid:?}");
            let inside = solid.shape().contains_box(DVec3::splat(511.0), DVec3::splat(513.0));
            assert!(inside);
            scene.remove(id).unwrap();
            assert!(!scene.is_opaque(IVec3::splat(512)));
        }
    }
    assert_eq!((scene.static_opacity().count(), scene.dynamic_opacity().count()), (0, 0));
}
