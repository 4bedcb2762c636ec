//! Cones: the old rule's leaks to the numbers of the digest, those of the other marches, closed
//! forms, and rays by brute force.

use casca::soft::{Cone, Layer, March};
use casca::{Aabb, Sphere};
use glam::{UVec3, Vec3};

use crate::leak::{Wall, near_wall, through_walls};
use crate::{Dice, soft};

const STEPS: [f32; 5] = [0.1, 0.25, 0.5, 1.0, 2.5];

/// The tangent that the digest takes for 30 degrees.
const WIDE: f32 = 0.57735;

/// The old rule's leaks through a wall of so many cells, for a ray at an angle to x: mean and
/// greatest, for each of the steps.
type Row = (u32, f32, f32, [(f32, f32); 5]);

/// The digest's table, but for its row of isotropic opacities.
fn table() -> [Row; 6] {
    let [one, five] = [1f32, 5.0].map(|degrees| degrees.to_radians().tan());
    [
        (1, 0.0, one, [(0.0, 0.0), (0.018, 0.039), (0.142, 0.272), (0.362, 0.854), (0.732, 1.0)]),
        (1, 0.0, five, [(0.0, 0.0), (0.026, 0.045), (0.133, 0.256), (0.455, 0.848), (0.719, 1.0)]),
        (1, 0.0, WIDE, [(0.0, 0.001), (0.020, 0.039), (0.128, 0.287), (0.170, 0.257), (0.490, 0.885)]),
        (1, 45.0, WIDE, [(0.003, 0.006), (0.091, 0.133), (0.196, 0.237), (0.481, 0.588), (0.590, 0.863)]),
        (2, 0.0, one, [(0.0, 0.0), (0.002, 0.026), (0.019, 0.177), (0.135, 0.816), (0.465, 1.0)]),
        (2, 0.0, WIDE, [(0.0, 0.001), (0.020, 0.039), (0.125, 0.287), (0.154, 0.257), (0.490, 0.885)]),
    ]
}

fn samples(step: f32, corrected: bool) -> March {
    March::Samples { step, start: 2.0, first: 2.0, corrected }
}

#[test]
fn the_old_rule_leaks_as_the_digest_says() {
    for (cells, degrees, tan, leaks) in table() {
        for (step, (mean, greatest)) in STEPS.into_iter().zip(leaks) {
            let found = through_walls(Wall::Straight(cells), degrees, tan, &samples(step, false)).unwrap();
            let near = |a: f32, b: f32| (a - b).abs() < 0.01;
            assert!(
                near(found.mean, mean) && near(found.greatest, greatest),
                "{cells} {degrees} {step}: {found:?}"
            );
        }
    }
    for (tan, means) in [(1f32.to_radians().tan(), [0.154, 0.156, 0.179]), (WIDE, [0.150, 0.127, 0.128])] {
        for (step, mean) in STEPS.into_iter().zip(means) {
            let found = through_walls(Wall::Straight(1), 0.0, tan, &samples(step, true)).unwrap();
            assert!((found.mean - mean).abs() < 0.01, "{tan} {step}: {found:?}");
        }
    }
}

#[test]
fn slabs_and_rays_do_not_leak() {
    for (cells, degrees, tan, _) in table() {
        for march in [March::Slabs, March::Rays(1)] {
            let found = through_walls(Wall::Straight(cells), degrees, tan, &march).unwrap();
            assert!(found.greatest == 0.0, "{cells} {degrees} {march:?}: {found:?}");
        }
    }
    assert_eq!(through_walls(Wall::Askew, 0.0, WIDE, &March::Rays(1)).unwrap().greatest, 0.0);
    let mut grid = soft(UVec3::splat(96));
    let wall = grid.insert(Sphere::new(Vec3::ZERO, 0.1), Layer::Moving).unwrap();
    for plane in [5.0, 11.0, 38.0] {
        let min = Vec3::new(plane + 0.25, 0.0, 0.0);
        grid.update(wall, Aabb::new(min, Vec3::new(plane + 0.75, 96.0, 96.0))).unwrap();
        grid.rebuild();
        let cone = Cone { apex: Vec3::new(2.56, 48.0, 48.0), direction: Vec3::X, tan: WIDE, reach: 90.0 };
        assert_eq!(grid.cone(&cone, &March::Rays(64)).unwrap().transmittance, 0.0);
    }
}

#[test]
fn walls_near_by_are_seen_by_all_but_the_old_rule() {
    let wide = [0.906, 0.906, 0.859, 0.859, 0.013, 0.156, 0.193, 0.199, 0.023];
    for (ahead, wide) in (0..).zip(wide) {
        let narrow = near_wall(ahead, 1f32.to_radians().tan(), &March::OLD).unwrap();
        assert!((narrow - if ahead < 4 { 1.0 } else { 0.0 }).abs() < 0.01, "{ahead}: {narrow}");
        let found = near_wall(ahead, WIDE, &March::OLD).unwrap();
        assert!((found - wide).abs() < 0.01, "{ahead}: {found}");
        for tan in [1f32.to_radians().tan(), WIDE] {
            assert_eq!(near_wall(ahead, tan, &March::Slabs).unwrap(), 0.0);
            assert_eq!(near_wall(ahead, tan, &March::Rays(1)).unwrap(), 0.0);
        }
    }
}

/// A wall in one layer of cells across x.
fn wall_across(plane: f32, dims: UVec3) -> Aabb {
    Aabb::new(Vec3::new(plane + 0.25, 0.0, 0.0), dims.as_vec3().with_x(plane + 0.75))
}

#[test]
fn slabs_that_the_border_or_the_reach_cuts_off_do_not_leak() {
    let mut leaks = Vec::new();
    for n in [80u32, 100] {
        for sign in [1.0, -1.0] {
            let mirrored = |x: f32| if sign > 0.0 { x } else { n as f32 - x };
            let mut grid = soft(UVec3::splat(n));
            let wall = grid.insert(Sphere::new(Vec3::ZERO, 0.1), Layer::Moving).unwrap();
            for plane in [9, 33, 66, 70, n - 3, n - 1] {
                let low = if sign > 0.0 { plane } else { n - 1 - plane };
                grid.update(wall, wall_across(low as f32, UVec3::splat(n))).unwrap();
                grid.rebuild();
                let apex = Vec3::new(mirrored(2.56), 40.0, 40.0);
                let behind = plane as f32 + 1.0 - 2.56;
                for reach in [behind + 1e-4, behind + 0.7, behind + 1.9, behind + 5.0, f32::INFINITY] {
                    for tan in [0.1, WIDE] {
                        let cone = Cone { apex, direction: Vec3::X * sign, tan, reach };
                        let leak = grid.cone(&cone, &March::Slabs).unwrap().transmittance;
                        if leak > 0.0 {
                            leaks.push((n, sign, plane, reach, tan, leak));
                        }
                    }
                }
                let cone = Cone { apex, direction: Vec3::X * sign, tan: WIDE, reach: behind - 1.001 };
                assert_eq!(grid.cone(&cone, &March::Slabs).unwrap().transmittance, 1.0, "before the wall");
            }
        }
    }
    assert!(leaks.is_empty(), "{leaks:?}");
}

#[test]
fn slabs_do_not_leak_at_grazing_angles() {
    let dims = UVec3::new(64, 256, 1);
    let mut grid = soft(dims);
    let mut dice = Dice(11);
    let mut leaks = Vec::new();
    for plane in [4.0, 6.0, 7.0] {
        let wall = grid.insert(wall_across(plane, dims), Layer::Moving).unwrap();
        grid.rebuild();
        for degrees in [85f32, 88.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            for _ in 0..100 {
                let apex = Vec3::new(2.0 + dice.next(), 5.0 + 20.0 * dice.next(), 0.5);
                let cone =
                    Cone { apex, direction: Vec3::new(cos, sin, 0.0), tan: WIDE, reach: f32::INFINITY };
                assert_eq!(grid.cone(&cone, &March::Rays(1)).unwrap().transmittance, 0.0);
                let leak = grid.cone(&cone, &March::Slabs).unwrap().transmittance;
                if leak > 0.0 {
                    leaks.push((plane, degrees, apex, leak));
                }
            }
        }
        grid.remove(wall).unwrap();
    }
    assert!(leaks.is_empty(), "{} leaks, such as {:?}", leaks.len(), leaks.first());
}

#[test]
fn samples_start_where_the_cone_enters_the_grid() {
    // The same wall in a grid around the apex, and in one that starts five cells ahead of it.
    let answers = [(0.0f32, 1.5), (40.0, 3.0)].map(|(before, first)| {
        let mut grid = soft(UVec3::new(64 + before as u32, 64, 64));
        let (min, max) = (Vec3::new(before + 4.25, 0.0, 0.0), Vec3::new(before + 6.75, 64.0, 64.0));
        grid.insert(Aabb::new(min, max), Layer::Fixed).unwrap();
        grid.rebuild();
        let apex = Vec3::new(before - 5.0, 32.0, 32.0);
        let cone = Cone { apex, direction: Vec3::X, tan: 0.1, reach: 60.0 };
        // The first sample lies on the border of the smaller grid in both.
        let march = March::Samples { step: 0.5, start: 2.0, first, corrected: false };
        let nearest = grid.cone(&Cone { reach: 9.0, ..cone }, &march).unwrap().transmittance;
        (grid.cone(&cone, &march).unwrap(), nearest)
    });
    assert!(answers[0].0.transmittance < 0.01, "{answers:?}");
    assert_eq!(answers[0], answers[1]);
    let grid = soft(UVec3::splat(8));
    let past = Cone { apex: Vec3::splat(-5.0), direction: Vec3::X, tan: 0.1, reach: 60.0 };
    assert_eq!(grid.cone(&past, &March::OLD).unwrap().transmittance, 1.0);
}

#[test]
fn the_reach_counts_from_the_apex() {
    let dims = UVec3::splat(32);
    let mut grid = soft(dims);
    grid.insert(wall_across(15.0, dims), Layer::Fixed).unwrap();
    grid.rebuild();
    for start in [0.0, 2.0, 7.0] {
        let march = March::Samples { step: 0.5, start, first: 0.25, corrected: false };
        let passes = |reach: f32| {
            let cone = Cone { apex: Vec3::new(4.0, 16.0, 16.0), direction: Vec3::X, tan: 0.01, reach };
            grid.cone(&cone, &march).unwrap().transmittance
        };
        assert_eq!([passes(1.0), passes(10.0)], [1.0, 1.0], "{start}");
        assert!(passes(12.0) < 0.001, "{start}");
    }
}

#[test]
fn steps_grow_with_the_logarithm() {
    let mut grid = soft(UVec3::splat(256));
    grid.rebuild();
    for degrees in [1f32, 5.0, 20.0, 45.0] {
        for step in STEPS {
            let (tan, reach) = (degrees.to_radians().tan(), 200.0);
            // The two cells before the start are a part of the reach.
            let reach_in_all = reach + 2.0;
            let cone =
                Cone { apex: Vec3::new(8.0, 128.0, 128.0), direction: Vec3::X, tan, reach: reach_in_all };
            let answer = grid.cone(&cone, &samples(step, false)).unwrap();
            let law = (reach / 2.0).ln() / (1.0 + 2.0 * tan * step).ln();
            assert!(
                answer.steps as f32 <= law.ceil() + 1.0 && answer.steps as f32 >= law.floor() - 1.0,
                "{law} {answer:?}"
            );
            assert_eq!(answer.transmittance, 1.0);
        }
    }
}

#[test]
fn a_sphere_on_the_axis_takes_its_solid_angle() {
    let mut grid = soft(UVec3::splat(128));
    let (apex, away, radius) = (Vec3::new(10.0, 64.0, 64.0), 70.0f32, 16.0f32);
    grid.insert(Sphere::new(apex + Vec3::X * away, radius), Layer::Fixed).unwrap();
    grid.rebuild();
    for tan in [0.1f32, 0.3, 0.5, 0.8] {
        let cosine = |tan: f32| 1.0 / (1.0 + tan * tan).sqrt();
        let open = |radius: f32| {
            let sine = radius / away;
            (1.0 - (1.0 - (1.0 - sine * sine).sqrt()) / (1.0 - cosine(tan))).max(0.0)
        };
        let cone = Cone { apex, direction: Vec3::X, tan, reach: 110.0 };
        let rays = grid.cone(&cone, &March::Rays(4096)).unwrap().transmittance;
        // Cells that the sphere touches reach beyond it by a cell's diagonal at most.
        assert!(
            open(radius + 1.75) - 0.002 <= rays && rays <= open(radius) + 0.002,
            "{tan}: {rays} {}",
            open(radius)
        );
    }
}

#[test]
fn marches_are_near_exact_rays() {
    let mut dice = Dice(7);
    let mut grid = soft(UVec3::splat(64));
    for _ in 0..60 {
        let at = dice.point(0.0, 64.0);
        grid.insert(Aabb::from_center(at, dice.point(0.5, 4.0)), Layer::Fixed).unwrap();
    }
    grid.rebuild();
    let marches = [March::Slabs, samples(0.5, true), samples(0.5, false), March::default()];
    let (mut errors, mut cones) = ([0.0; 4], 0.0);
    for _ in 0..400 {
        let (apex, direction) = (dice.point(4.0, 60.0), dice.point(-1.0, 1.0));
        if grid.pyramid().any(0, apex.as_ivec3()) {
            continue;
        }
        let cone = Cone { apex, direction, tan: 0.05 + 0.5 * dice.next(), reach: 30.0 };
        let exact = grid.cone(&cone, &March::Rays(1024)).unwrap().transmittance;
        for (error, march) in errors.iter_mut().zip(&marches) {
            *error += (grid.cone(&cone, march).unwrap().transmittance - exact).abs();
        }
        cones += 1.0;
    }
    let [slabs, corrected, old, default] = errors.map(|e| e / cones);
    println!(
        "mean error of {cones} cones: slabs {slabs:.3}, corrected {corrected:.3}, old rule {old:.3}, default {default:.3}"
    );
    assert!(slabs < 0.07 && corrected < 0.08, "{slabs} {corrected} {old}");
    assert!(default < 0.02, "the default converges: {default}");
}
