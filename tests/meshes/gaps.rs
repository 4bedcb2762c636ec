//! Walls with cracks that a mesh closes.

use std::ops::ControlFlow;

use crate::common::*;
use crate::rays::Triangle;

/// A wall of panels in one mesh: rows are shifted against each other, so that corners meet edges,
/// and each corner is off by up to `crack` along each axis. It is turned about the middle of the
/// scene.
fn wall(random: &mut Random, turn: Quat, crack: f64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for row in 0..6u32 {
        for column in 0..6u32 {
            let shift = 0.4 * (row % 2) as f32;
            let low = Vec3::new(2.0 * column as f32 - 6.0 + shift, 2.0 * row as f32 - 6.0, 0.0);
            let first = positions.len() as u32;
            for (x, y) in [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)] {
                let at = low + Vec3::new(x, y, 0.0) + random.vector(-crack, crack).as_vec3();
                positions.push(Vec3::splat(12.0) + turn * at);
            }
            triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
    }
    (positions, triangles)
}

fn prepared((positions, triangles): &(Vec<Vec3>, Vec<[u32; 3]>), how: &MeshOptions) -> Arc<TriMesh> {
    let go_on = &mut |_| ControlFlow::Continue(());
    Arc::new(TriMesh::prepare(positions.clone(), triangles.clone(), how, go_on).unwrap())
}

/// The targets that are hidden from an eye.
fn hidden(mesh: &Arc<TriMesh>, targets: &[Aabb], eye: Vec3) -> Vec<Aabb> {
    let mut scene = empty();
    let wall = scene.solid(mesh.clone());
    let ids: Vec<_> = targets.iter().map(|&b| scene.fixed(b)).collect();
    let mut query = query_by(Method::Point(PointOptions::tight()));
    let pvs = query.run(&scene, &around(eye));
    assert!(pvs.contains(wall), "it does not hide itself");
    let hidden = ids.iter().zip(targets).filter(|(id, _)| !pvs.contains(**id));
    hidden.map(|(_, target)| *target).collect()
}

fn boxes(random: &mut Random, turn: Quat, count: usize) -> Vec<Aabb> {
    let mut targets = Vec::new();
    while targets.len() < count {
        let at = Vec3::new(random.within(-5.0, 5.0) as f32, random.within(-5.0, 5.0) as f32, -4.0);
        let low = Vec3::splat(12.0) + turn * at;
        targets.push(Aabb::new(low, low + random.within(0.01, 0.3) as f32));
    }
    targets
}

#[test]
fn cracks_up_to_the_gap_hide() {
    let mut random = Random(11);
    let turn = Quat::from_euler(glam::EulerRot::XYZ, 0.4, 0.7, 0.3);
    let made = wall(&mut random, turn, 5e-4);
    let eye = Vec3::new(0.3, 0.2, 9.0);
    let behind_crack = |i: u32| {
        let on_crack = Vec3::new(-4.0 + 0.13 * i as f32, 2.0 * (i % 3) as f32 - 2.0, 0.0);
        let middle = Vec3::splat(12.0) + turn * (eye + (on_crack - eye) * 1.4);
        Aabb::new(middle - 0.05, middle + 0.05)
    };
    let targets: Vec<Aabb> = (0..60).map(behind_crack).collect();
    let eye = Vec3::splat(12.0) + turn * eye;
    let count = |how: &MeshOptions| hidden(&prepared(&made, how), &targets, eye).len();
    let none = count(&MeshOptions::default());
    let all = count(&MeshOptions::default().gap(5e-3));
    assert!(all >= 58 && none < 20, "{none} {all}");
    assert_eq!(count(&MeshOptions::default().gap(0.0)), none);
}

/// How far a point is from a triangle: from its plane, if the foot is inside, or from its sides.
fn from_point(p: DVec3, t: &Triangle) -> f64 {
    let normal = (t[1] - t[0]).cross(t[2] - t[0]);
    let sides = [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
    if sides.iter().all(|&(a, b)| (b - a).cross(p - a).dot(normal) > 0.0) {
        return (p - t[0]).dot(normal.normalize()).abs();
    }
    let from_side = |(a, b): (DVec3, DVec3)| {
        p.distance(a.lerp(b, ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0)))
    };
    sides.map(from_side).into_iter().fold(f64::INFINITY, f64::min)
}

/// How far a segment passes a triangle: the distance is convex along it.
fn from_segment(from: DVec3, to: DVec3, t: &Triangle) -> f64 {
    let at = |share: f64| from_point(from.lerp(to, share), t);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..50 {
        let (one, two) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if at(one) < at(two) { high = two } else { low = one }
    }
    at((low + high) * 0.5)
}

#[test]
fn lines_of_sight_to_what_is_hidden_pass_near_triangles() {
    let mut random = Random(23);
    let (mut culled, mut through) = (0, 0);
    for round in 0..36 {
        let mut angle = || random.within(0.0, 6.0) as f32;
        let turn = Quat::from_euler(glam::EulerRot::XYZ, angle(), angle(), angle());
        let gap = [0.02, 0.1, 0.4][round % 3];
        let made = wall(&mut random, turn, gap * [0.1, 0.3, 0.8, 3.0][round % 4]);
        let triangles: Vec<Triangle> =
            made.1.iter().map(|t| t.map(|v| made.0[v as usize].as_dvec3())).collect();
        let facing = if random.below(3) == 0 { Facing::Front } else { Facing::Both };
        let how = MeshOptions::default().gap(gap as f32).facing(facing).tolerance(1e-4).min_radius(0.0);
        let targets = boxes(&mut random, turn, 150);
        let eye = Vec3::splat(12.0) + turn * Vec3::new(0.3, 0.2, 7.0);
        for target in hidden(&prepared(&made, &how), &targets, eye) {
            culled += 1;
            let share = random.vector(0.0, 1.0).as_vec3();
            let to = (target.min + (target.max - target.min) * share).as_dvec3();
            let apart = triangles.iter().map(|t| from_segment(eye.as_dvec3(), to, t));
            let least = apart.fold(f64::INFINITY, f64::min);
            assert!(least <= gap * (1.0 + 1e-4), "round {round}: {least} of {gap}");
            through += usize::from(least > 1e-6);
        }
    }
    assert!(culled > 500 && through > 5, "{culled} {through}");
}
