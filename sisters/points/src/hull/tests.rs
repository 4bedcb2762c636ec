//! The hull beside an oracle in whole numbers: a point is not extreme if some segment, triangle or
//! tetrahedron of others holds it (Carathéodory's theorem). 128 bits hold its determinants for
//! coordinates up to 2^30.

use super::*;
use casca_truth::cases;
use proptest::prelude::*;

type Point = [i128; 3];

fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: Point, b: Point) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn in_segment(a: Point, b: Point, p: Point) -> bool {
    cross(sub(a, p), sub(b, p)) == [0; 3] && dot(sub(a, p), sub(b, p)) <= 0
}

fn in_triangle(a: Point, b: Point, c: Point, p: Point) -> bool {
    let normal = cross(sub(b, a), sub(c, a));
    let flat = normal != [0; 3] && dot(normal, sub(p, a)) == 0;
    // The signs by the normal's largest coordinate alone, so that the numbers stay small.
    let axis = (0..3).max_by_key(|&i| normal[i].abs()).unwrap_or(0);
    let side = |u: Point, v: Point| cross(sub(v, u), sub(p, u))[axis] * normal[axis].signum();
    flat && side(a, b) >= 0 && side(b, c) >= 0 && side(c, a) >= 0
}

fn in_tetrahedron(t: [Point; 4], p: Point) -> bool {
    let volume = |a, b, c, d| dot(cross(sub(b, a), sub(c, a)), sub(d, a)).signum();
    let [a, b, c, d] = t;
    let whole = volume(a, b, c, d);
    let parts = [volume(p, b, c, d), volume(a, p, c, d), volume(a, b, p, d), volume(a, b, c, p)];
    whole != 0 && parts.into_iter().all(|part| part * whole >= 0)
}

/// Whether points with coordinates up to 2^30 are extreme.
fn truth(points: &[Point]) -> Vec<bool> {
    let held = |p: Point| {
        let others: Vec<Point> = points.iter().copied().filter(|&q| q != p).collect();
        let n = others.len();
        (0..n).any(|i| {
            (0..i).any(|j| {
                let [a, b] = [others[i], others[j]];
                in_segment(a, b, p)
                    || (0..j).any(|k| {
                        let c = others[k];
                        in_triangle(a, b, c, p) || (0..k).any(|l| in_tetrahedron([a, b, c, others[l]], p))
                    })
            })
        })
    };
    points.iter().map(|&p| !held(p)).collect()
}

fn found(points: &[Point], scale: f64) -> Vec<bool> {
    let points: Vec<DVec3> =
        points.iter().map(|p| DVec3::new(p[0] as f64, p[1] as f64, p[2] as f64) * scale).collect();
    extreme_points(&points).into_iter().collect()
}

/// Points of a coarse grid (many are equal, collinear, flat or cospherical), or near a plane, up to
/// 2^30 away.
fn points() -> impl Strategy<Value = Vec<Point>> {
    let grid = |low: i32, high: i32| prop::array::uniform3(low..=high).prop_map(|p| p.map(i128::from));
    let sheet = (-(1 << 28)..1 << 28_i32, -(1 << 28)..1 << 28_i32, -1..=1_i32)
        .prop_map(|(x, y, up)| [x, y, 3 * x - 2 * y + up].map(i128::from));
    let line = (-9..9_i32, -1..=0_i32).prop_map(|(t, off)| [7 * t, -3 * t, t + off].map(i128::from));
    prop_oneof![
        prop::collection::vec(grid(-1, 1), 0..14),
        prop::collection::vec(grid(-3, 3), 0..14),
        prop::collection::vec(grid(-1 << 28, 1 << 28), 4..12),
        prop::collection::vec(sheet, 4..12),
        prop::collection::vec(line, 1..12),
        prop::collection::vec(grid(0, 4).prop_map(|[x, y, _]| [x, y, x + y]), 1..14),
    ]
}

proptest! {
    #![proptest_config(cases(600))]

    #[test]
    fn extreme_points_are_those_of_whole_numbers(points in points(), exponent in -900..900_i32) {
        prop_assert_eq!(found(&points, f64::from(exponent).exp2()), truth(&points));
    }
}

/// The points of a grid of whole numbers.
fn grid(size: i128) -> Vec<Point> {
    (0..size.pow(3)).map(|i| [i % size, i / size % size, i / size / size]).collect()
}

#[test]
fn a_filled_grid_has_eight_corners() {
    let points = grid(24);
    let corners = points.iter().map(|p| p.iter().all(|&x| x == 0 || x == 23));
    assert!(found(&points, 0.1).into_iter().eq(corners));
}

#[test]
fn all_points_of_a_paraboloid_over_a_grid_are_extreme() {
    // Each square of the grid is a flat facet: the four lifted corners are in one plane.
    let points: Vec<Point> =
        (0..80 * 80_i128).map(|i| [i % 80, i / 80, (i % 80).pow(2) + (i / 80).pow(2)]).collect();
    assert!(found(&points, 1.0).into_iter().all(|extreme| extreme));
}

#[test]
fn whole_points_of_a_sphere_are_extreme_and_twice_the_same() {
    // 25 * 13 * 17 is a sum of three squares in many ways: many facets have more than three corners.
    let sphere: Vec<Point> =
        grid(151).iter().map(|p| sub(*p, [75; 3])).filter(|&p| dot(p, p) == 5525).collect();
    assert!(sphere.len() > 400, "{}", sphere.len());
    let twice: Vec<Point> = sphere.iter().chain(&sphere).copied().chain([[0; 3], [1, 2, 3]]).collect();
    let extreme = found(&twice, 1.0);
    assert!(extreme[..2 * sphere.len()].iter().all(|&e| e));
    assert_eq!(extreme[2 * sphere.len()..], [false, false]);
}
