//! The inside of closed meshes against parity along rays in any direction.

use std::ops::ControlFlow;

use casca::internals::{Shape, Which};

use crate::common::*;
use crate::forms::{Form, Recipe, recipe};
use crate::rays::{Triangle, point_of};

/// How often a ray meets triangles, or nothing if it comes too close to an edge.
fn crossings(triangles: &[Triangle], from: DVec3, way: DVec3) -> Option<usize> {
    let mut count = 0;
    for t in triangles {
        let [a, b, c] = t.map(|p| p - from);
        let sides =
            [(a, b), (b, c), (c, a)].map(|(p, q)| way.dot(p.cross(q)) / (p.length() * q.length() + 1e-300));
        if sides.iter().all(|&s| s > 1e-10) || sides.iter().all(|&s| s < -1e-10) {
            let normal = (b - a).cross(c - a);
            let away = normal.dot(a) / normal.dot(way);
            // It starts on the surface: neither side is sure.
            if away.abs() < 1e-9 {
                return None;
            }
            count += usize::from(away > 0.0);
        } else if !(sides.iter().any(|&s| s > 1e-10) && sides.iter().any(|&s| s < -1e-10)) {
            return None;
        }
    }
    Some(count)
}

fn is_inside(triangles: &[Triangle], p: DVec3, random: &mut Random) -> Option<bool> {
    let ray = |random: &mut Random| {
        (0..8).find_map(|_| crossings(triangles, p, random.vector(-1.0, 1.0).normalize_or(DVec3::X)))
    };
    let (one, two) = (ray(random)?, ray(random)?);
    assert_eq!(one % 2, two % 2, "the mesh has no inside");
    Some(one % 2 == 1)
}

fn triangles_of(mesh: &TriMesh) -> Vec<Triangle> {
    mesh.triangles().iter().map(|t| t.map(|v| mesh.positions()[v as usize].as_dvec3())).collect()
}

fn closed() -> impl Strategy<Value = Recipe> {
    let forms = prop_oneof![Just(Form::Box), Just(Form::Tetrahedron), (0..3u32).prop_map(Form::Ball)];
    (recipe(), forms).prop_map(|(recipe, form)| Recipe { form, ..recipe })
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn what_is_inside_is_inside(recipes in prop::collection::vec(closed(), 1..3), cell in 0.2..1.0f32, seed in any::<u64>()) {
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        for recipe in &recipes {
            let made = recipe.make(&|p| p);
            let base = positions.len() as u32;
            positions.extend(made.positions);
            triangles.extend(made.triangles.iter().map(|t| t.map(|v| v + base)));
        }
        let mesh = TriMesh::new(positions, triangles).unwrap();
        let grid = Grid::new(cell).unwrap();
        let mut cells: Vec<IVec3> = Vec::new();
        mesh.rows(&grid, Which::Opaque, &mut |run| cells.extend(run.cells()));
        let all = triangles_of(&mesh);
        let mut random = Random(seed);
        prop_assert!(mesh.is_closed() || cells.is_empty());
        for _ in 0..cells.len().min(60) {
            let (min, max) = grid.cell_bounds(cells[random.below(cells.len())]);
            let p = min + (max - min) * random.vector(0.0, 1.0);
            prop_assert!(is_inside(&all, p, &mut random) != Some(false), "{p}");
        }
        for _ in 0..60 {
            let t = all[random.below(all.len())];
            let middle = if random.below(2) == 0 { point_of(&t, &mut random) } else { random.point(0.0, 16.0) };
            let half = random.point(0.01, 1.0);
            let (min, max) = (middle - half, middle + half);
            if !mesh.contains_box(min, max) {
                continue;
            }
            for _ in 0..20 {
                let p = min + (max - min) * random.vector(0.0, 1.0);
                prop_assert!(is_inside(&all, p, &mut random) != Some(false), "{p}");
                let which = random.below(all.len());
                let on = point_of(&all[which], &mut random);
                prop_assert!(on.cmple(min).any() || on.cmpge(max).any(), "{on}");
            }
        }
        for _ in 0..60 {
            let p = random.point(0.0, 16.0);
            if mesh.is_closed() && is_inside(&all, p, &mut random) == Some(true) {
                prop_assert!(mesh.contains_point(p), "{p}");
            }
        }
    }
}

#[test]
fn sound_solids_are_found_inside() {
    let recipe = Recipe {
        form: Form::Ball(2),
        center: [8.0; 3],
        size: [6.0; 3],
        axis: [1.0, 2.0, 3.0],
        angle: 1.0,
        damage: vec![],
        seed: 1,
    };
    let made = recipe.make(&|p| p);
    let mesh = TriMesh::new(made.positions, made.triangles).unwrap();
    assert!(mesh.is_closed() && mesh.contains_box(DVec3::splat(6.0), DVec3::splat(10.0)));
    let grid = Grid::new(0.5).unwrap();
    let mut count = 0;
    mesh.rows(&grid, Which::Opaque, &mut |run| count += run.cells().count());
    assert!(count > 5000, "{count}");
}

#[test]
fn solids_that_hide_from_their_front_are_wound_outwards() {
    let (points, faces) = crate::forms::cuboid();
    let positions: Vec<Vec3> = points.iter().map(|p| (p * 6.0 + 8.0).as_vec3()).collect();
    let mut how = casca::MeshOptions::default();
    how.facing = casca::Facing::Front;
    let grid = Grid::new(1.0).unwrap();
    let cells = |triangles: Vec<[u32; 3]>| {
        let mesh =
            TriMesh::prepare(positions.clone(), triangles, &how, &mut |_| ControlFlow::Continue(())).unwrap();
        assert!(mesh.is_closed());
        let mut count = 0;
        mesh.rows(&grid, Which::Opaque, &mut |run| count += run.cells().count());
        count
    };
    assert!(cells(faces.clone()) > 500);
    let mut mixed = faces.clone();
    mixed[3].swap(0, 1);
    assert_eq!(cells(mixed), 0);
    assert_eq!(cells(faces.iter().map(|&[a, b, c]| [a, c, b]).collect()), 0);
}
