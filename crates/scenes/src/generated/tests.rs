use glam::Vec3;

use super::*;
use crate::world::{FRAME_SECONDS, Motion, Shape};

fn holds(shape: &Shape, p: Vec3) -> bool {
    match shape {
        Shape::Sphere { center, radius } => center.distance(p) <= *radius,
        Shape::Box { min, max } => min.cmple(p).all() && p.cmple(*max).all(),
        Shape::Mesh { .. } => false,
    }
}

#[test]
fn scenes_keep_to_their_grid_and_speeds_and_the_eye_is_free() {
    for (kind, seed) in SceneKind::ALL.into_iter().flat_map(|kind| [(kind, 1), (kind, 2)]) {
        let mut world = build(kind, &SceneOptions { seed, ..SceneOptions::default() });
        let (min, max) = (world.grid.min, world.grid.max);
        let dynamic = world.objects.iter().filter(|o| o.motion != Motion::Static).count();
        let step = if world.objects.len() > 50_000 { 15 } else { 1 };
        let mut last: Option<(usize, Vec<Vec3>)> = None;
        for frame in (0..world.frames).step_by(step) {
            let moved = world.set_frame(frame);
            assert!(moved.is_sorted());
            assert_eq!(moved.len(), dynamic, "every dynamic object is set");
            // The others stay where they were at first.
            let changed: Vec<usize> =
                if last.is_none() { (0..world.objects.len()).collect() } else { moved.clone() };
            for o in changed.iter().map(|&i| &world.objects[i]) {
                let (lo, hi) = o.shape.bounds();
                assert!(lo.cmple(hi).all() && lo.cmpge(min).all() && hi.cmple(max).all(), "{o:?}");
            }
            let eye = world.camera(frame, 1.5).eye;
            assert!(eye.cmpgt(min).all() && eye.cmplt(max).all());
            for o in world.objects.iter().filter(|o| o.occludes) {
                assert!(!holds(&o.shape, eye), "{} frame {frame}: eye {eye} in {o:?}", world.name);
            }
            let bounds = moved.iter().map(|&i| world.objects[i].shape.bounds());
            let middles: Vec<Vec3> = bounds.map(|(lo, hi)| (lo + hi) * 0.5).collect();
            if let Some((before, old)) = last {
                let seconds = (frame - before) as f32 * FRAME_SECONDS as f32;
                for ((a, b), &i) in old.iter().zip(&middles).zip(&moved) {
                    let Motion::Dynamic { max_speed } = world.objects[i].motion else { panic!() };
                    let way = a.distance(*b);
                    assert!(way <= max_speed * seconds, "{}: {way}", world.objects[i].name);
                }
            }
            last = Some((frame, middles));
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_scene() {
    for kind in SceneKind::ALL {
        let options = SceneOptions { seed: 7, ..SceneOptions::default() };
        let (a, b) = (build(kind, &options), build(kind, &options));
        assert_eq!(a.objects.len(), b.objects.len());
        assert!(a.objects.iter().zip(&b.objects).all(|(a, b)| a.shape.bounds() == b.shape.bounds()));
        assert_eq!(kind.name().parse::<SceneKind>(), Ok(kind));
    }
    assert!("house".parse::<SceneKind>().is_err());
}

#[test]
fn extra_hidden_spheres_change_nothing_else() {
    let with = |bunker| build(SceneKind::Spheres, &SceneOptions { bunker, ..SceneOptions::default() });
    let (few, many) = (with(Some(0)), with(Some(1000)));
    assert_eq!(many.objects.len(), few.objects.len() + 1000);
    assert!(few.objects.iter().zip(&many.objects).all(|(a, b)| a.shape.bounds() == b.shape.bounds()));
}

/// Whether a way crosses a triangle.
fn crosses(from: Vec3, to: Vec3, [a, b, c]: [Vec3; 3]) -> bool {
    let (ab, ac, way) = (b - a, c - a, to - from);
    let normal = ab.cross(ac);
    let t = normal.dot(a - from) / normal.dot(way);
    let p = from + way * t - a;
    let share = Vec3::new(normal.dot(ab.cross(p)), normal.dot(p.cross(ac)), 0.0) / normal.length_squared();
    (0.0..=1.0).contains(&t) && share.min_element() >= 0.0 && share.element_sum() <= 1.0
}

#[test]
fn walks_pass_through_no_meshes() {
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    assert!(crosses(Vec3::new(0.2, 0.2, 1.0), Vec3::new(0.3, 0.2, -1.0), triangle));
    assert!(!crosses(Vec3::new(0.7, 0.7, 1.0), Vec3::new(0.7, 0.7, -1.0), triangle));
    for kind in [SceneKind::Harbour, SceneKind::Voxels, SceneKind::Leaves] {
        let world = build(kind, &SceneOptions { frames: 2000, ..SceneOptions::default() });
        let eyes: Vec<Vec3> = (0..world.frames).map(|f| world.camera(f, 1.5).eye).collect();
        for o in &world.objects {
            let Shape::Mesh { mesh, transform } = &o.shape else { continue };
            // Tests of the ground measure the height above it.
            if o.name == "ground" {
                continue;
            }
            let (lo, hi) = mesh.bounds(transform);
            for (frame, w) in eyes.windows(2).enumerate() {
                if w[0].min(w[1]).cmple(hi).all() && w[0].max(w[1]).cmpge(lo).all() {
                    let corners =
                        |t: &[u32; 3]| t.map(|v| transform.transform_point3(mesh.positions[v as usize]));
                    let crossed = mesh.triangles.iter().any(|t| crosses(w[0], w[1], corners(t)));
                    assert!(!crossed, "{kind:?}: from {} to {} through {} {frame}", w[0], w[1], o.name);
                }
            }
        }
    }
}
