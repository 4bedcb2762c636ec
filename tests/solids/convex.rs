//! Convex solids lie inside what they are made of, wherever they are, and hold nearly all of it.
//!
//! Half-spaces are checked in whole numbers, hulls by rays through all triangles of three points.

use casca::internals::Shape;

use crate::common::*;

/// Solids made from points or planes may lack this share of their size (documented), with room for
/// rounding.
const LACK: f64 = 1.1e-6;

/// Mantissa and exponent: the number is `m * 2^e`.
fn parts(v: f64) -> (i128, i32) {
    let bits = v.to_bits();
    let (exponent, fraction) = ((bits >> 52 & 0x7ff) as i32, (bits & ((1 << 52) - 1)) as i128);
    let m = if exponent == 0 { fraction } else { fraction | 1 << 52 };
    (if v < 0.0 { -m } else { m }, exponent.max(1) - 1075)
}

/// A product in units of 2^-96, rounded down: exact for numbers that have no smaller bits.
fn units(a: f64, b: f64) -> i128 {
    let ((m, e), (n, f)) = (parts(a), parts(b));
    let (product, shift) = (m * n, e + f + 96);
    if shift < 0 {
        product >> (-shift).min(127)
    } else {
        assert!(product == 0 || product.unsigned_abs().leading_zeros() as i32 > shift, "{a} {b}");
        product << shift.min(127)
    }
}

/// Whether a point surely lies in a half-space: proven in whole numbers.
fn holds(plane: &Plane, p: DVec3) -> bool {
    let n = plane.normal.as_dvec3();
    let sum = units(n.x, p.x) + units(n.y, p.y) + units(n.z, p.z) + units(f64::from(plane.offset), 1.0);
    sum >= 0
}

/// Planes around a ball, the last of which cuts off little more than a corner.
fn planes_around(random: &mut Random, c: DVec3) -> Option<Vec<Plane>> {
    let plane = |d: DVec3, h: f64| {
        let n = d.as_vec3();
        Plane { normal: -n, offset: (n.as_dvec3().dot(c) + h * n.as_dvec3().length()) as f32 }
    };
    let mut planes: Vec<Plane> = (0..4 + random.below(8))
        .map(|_| {
            let (d, h) = (random.direction(), random.within(0.5, 1.0));
            plane(d, h)
        })
        .collect();
    let first = Convex::from_planes(&planes).ok()?;
    let corners: Vec<DVec3> = first.vertices().collect();
    let v = corners[random.below(corners.len())];
    let d = ((v - c).normalize() + random.direction() * 0.3).normalize();
    let cut = 10f64.powf(random.within(-9.0, -2.0));
    planes.push(plane(d, d.dot(v - c) - cut));
    Some(planes)
}

#[test]
fn solids_of_half_spaces_lie_in_each_of_them_exactly() {
    let mut random = Random(11);
    for reach in [0.0, 1.0, 1e2, 1e3, 1e4, 1e5, 1e6] {
        let (mut made, mut inside) = (0, 0);
        for _ in 0..150 {
            let c = random.direction() * reach;
            let Some(planes) = planes_around(&mut random, c) else { continue };
            let Ok(solid) = Convex::from_planes(&planes) else { continue };
            made += 1;
            let corners: Vec<DVec3> = solid.vertices().collect();
            for &v in &corners {
                assert!(planes.iter().all(|p| holds(p, v)), "a corner at {v} sticks out: {planes:?}");
            }
            // Points on and about the surface, of which faces tell whether they are inside.
            let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
            for _ in 0..40 {
                let (a, b) = (corners[random.below(corners.len())], corners[random.below(corners.len())]);
                let p = a.lerp(b, random.next());
                let p = middle + (p - middle) * (1.0 + random.within(-1e-10, 1e-10) * (1.0 + reach));
                if solid.contains_box(p, p) {
                    inside += 1;
                    assert!(planes.iter().all(|plane| holds(plane, p)), "{p} sticks out: {planes:?}");
                }
            }
        }
        assert!(made > 60 && inside > 300, "{reach}: {made} solids, {inside} points");
    }
}

#[test]
fn solids_of_half_spaces_hold_nearly_all_of_them() {
    let mut random = Random(12);
    for reach in [0.0, 10.0, 1e3, 1e5] {
        let mut tested = 0;
        for _ in 0..100 {
            let c = random.direction() * reach;
            let Some(planes) = planes_around(&mut random, c) else { continue };
            let Ok(solid) = Convex::from_planes(&planes) else { continue };
            let (min, max) = solid.bounds();
            let size = (max - min).max_element();
            for _ in 0..40 {
                // Where a ray from inside leaves the half-spaces, relative to `c` as far as f64
                // tells.
                let d = random.direction();
                let exits = planes.iter().map(|p| {
                    let n = p.normal.as_dvec3();
                    let (slope, at) = (n.dot(d), n.dot(c) + f64::from(p.offset));
                    if slope < 0.0 { at / -slope } else { f64::INFINITY }
                });
                let far = exits.fold(f64::INFINITY, f64::min);
                let rounding = 1e-14 * (reach + size) + 2.0 * LACK * size;
                // Corners may be cut off, and are sharp: as much again along the ray.
                let p = c + d * (far - 4.0 * rounding).max(0.0);
                let deep = planes.iter().all(|plane| {
                    let n = plane.normal.as_dvec3();
                    n.dot(p) + f64::from(plane.offset) >= rounding * n.length()
                });
                if deep {
                    tested += 1;
                    assert!(solid.contains_box(p, p), "{p} is missing: {planes:?}");
                }
            }
        }
        assert!(tested > 500, "{reach}: {tested}");
    }
}

/// Corners of a random solid, each `copies` times, `ulps` units in the last place apart.
fn copied(random: &mut Random, (size, reach): (f64, f64), copies: usize, ulps: i32) -> Vec<Vec3> {
    let c = random.direction() * reach;
    let mut points = Vec::new();
    for _ in 0..4 + random.below(8) {
        let p = (c + random.direction() * size).as_vec3();
        for _ in 0..copies {
            let mut step = |v: f32| {
                let by = random.below(2 * ulps as usize + 1) as i32 - ulps;
                if v == 0.0 { v } else { f32::from_bits(v.to_bits().wrapping_add_signed(by)) }
            };
            points.push(Vec3::new(step(p.x), step(p.y), step(p.z)));
        }
    }
    points
}

fn extent(points: &[Vec3]) -> f64 {
    let (lo, hi) =
        points.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |b, p| (b.0.min(*p), b.1.max(*p)));
    f64::from((hi - lo).max_element())
}

/// How far points reach to both sides of the plane through three of them, at least: zero for flat
/// ones.
fn thickness(points: &[Vec3]) -> f64 {
    let p: Vec<DVec3> = points.iter().map(|p| p.as_dvec3()).collect();
    let a = p[0];
    let farthest = |f: &dyn Fn(DVec3) -> f64| *p.iter().max_by(|x, y| f(**x).total_cmp(&f(**y))).unwrap();
    let b = farthest(&|q| q.distance(a));
    let along = (b - a).normalize_or_zero();
    let c = farthest(&|q| (q - a).cross(along).length());
    let n = along.cross(c - a).normalize_or_zero();
    p.iter().map(|q| n.dot(*q - a).abs()).fold(0.0, f64::max)
}

#[test]
fn points_that_come_several_times_make_a_solid() {
    let mut random = Random(13);
    let (mut asked, mut refused, mut table) = (0, 0, String::new());
    for ulps in 0..=4 {
        for size in [1e-3, 1.0, 1e3] {
            for reach in [0.0, 10.0, 1e3, 1e5] {
                let (mut own, mut made) = (0, 0);
                for _ in 0..40 {
                    let points = copied(&mut random, (size, reach), 5, ulps);
                    let size = extent(&points);
                    // What single precision left of it may be flat.
                    if thickness(&points) <= 1e-3 * size {
                        continue;
                    }
                    own += 1;
                    let Ok(solid) = Convex::from_points(&points) else { continue };
                    made += 1;
                    for v in solid.vertices() {
                        assert!(points.iter().any(|p| p.as_dvec3() == v), "{v} is none of {points:?}");
                    }
                    let middle = solid.vertices().sum::<DVec3>() / solid.vertices().len() as f64;
                    for p in &points {
                        let p = p.as_dvec3();
                        assert!(solid.contains_point(p), "{p} is beside the solid of {points:?}");
                        // So far towards the middle that the point is as deep as may be lacking.
                        let share = (20.0 * LACK * size / thickness(&points)).min(1.0);
                        let p = p.lerp(middle, share);
                        let rounds = 1e-13 * (reach + size) > 1e-7 * size;
                        assert!(rounds || solid.contains_box(p, p), "{p} is missing of {points:?}");
                    }
                }
                (asked, refused) = (asked + own, refused + own - made);
                table += &format!("{ulps} ulps, size {size:e}, {reach:e} away: {made} of {own}\n");
            }
        }
    }
    println!("{table}");
    assert!(asked > 1500, "{asked}");
    assert_eq!(refused, 0, "of {asked}:\n{table}");
}

#[test]
fn hulls_reach_no_farther_than_their_points_along_any_ray() {
    let mut random = Random(14);
    let mut met = 0;
    for (ulps, reach) in [(0, 0.0), (1, 1.0), (4, 1.0), (2, 300.0), (3, 1e5)] {
        for _ in 0..12 {
            let points = copied(&mut random, (1.0, reach), 2, ulps);
            let Ok(solid) = Convex::from_points(&points) else { continue };
            let middle = solid.vertices().sum::<DVec3>() / solid.vertices().len() as f64;
            let p: Vec<DVec3> = points.iter().map(|p| p.as_dvec3() - middle).collect();
            for _ in 0..30 {
                let d = random.direction();
                // The hull is the union of the triangles of its points and the middle.
                let mut exit = 0f64;
                for k in 2..p.len() {
                    for j in 1..k {
                        for i in 0..j {
                            let (u, v) = (p[j] - p[i], p[k] - p[i]);
                            let volume = u.cross(v).dot(d);
                            let (s, t) = (-p[i].cross(v).dot(d) / volume, -u.cross(p[i]).dot(d) / volume);
                            // In doubt the ray meets the triangle: the hull is not smaller than
                            // that.
                            if s >= -1e-9 && t >= -1e-9 && s + t <= 1.0 + 1e-9 {
                                exit = exit.max((p[i] + u * s + v * t).dot(d));
                            }
                        }
                    }
                }
                let out = middle + d * (exit + 1e-8);
                assert!(!solid.contains_box(out, out), "{out} is beyond {points:?}");
                let inside = middle + d * (exit * (1.0 - 1e-4));
                met += usize::from(solid.contains_box(inside, inside));
            }
        }
    }
    assert!(met > 1000, "{met}");
}

#[test]
fn solids_moved_lie_in_the_solid_moved_exactly() {
    let mut random = Random(15);
    let mut moved_far = 0;
    for reach in [0.0, 1.0, 1e3, 1e6] {
        for _ in 0..60 {
            // Half-spaces with short normals, so that those of the moved solid are exact numbers.
            let planes: Vec<Plane> = (0..8)
                .map(|i| {
                    let signs =
                        Vec3::new((1 - 2 * (i & 1)) as f32, (1 - (i & 2)) as f32, (1 - (i & 4) / 2) as f32);
                    let mut short = || (1.0 + random.below(7) as f32) / 8.0;
                    let n = Vec3::new(short(), short(), short()) * signs;
                    Plane { normal: -n, offset: 1.0 }
                })
                .collect();
            let solid = Convex::from_planes(&planes).unwrap();
            let by = (random.direction() * reach).as_vec3();
            let moved = solid.translated(by).unwrap();
            assert_eq!(moved.vertices().len(), solid.vertices().len());
            for v in moved.vertices() {
                for plane in &planes {
                    // n . (v - by) + offset, in whole numbers.
                    let n = plane.normal.as_dvec3();
                    let by = by.as_dvec3();
                    let sum = (0..3).map(|i| units(n[i], v[i]) + units(-n[i], by[i])).sum::<i128>();
                    assert!(
                        sum + units(f64::from(plane.offset), 1.0) >= 0,
                        "{v} of {planes:?} moved by {by}"
                    );
                }
            }
            for (a, b) in solid.vertices().zip(moved.vertices()) {
                let off = (b - a - by.as_dvec3()).length();
                assert!(off <= 1e-13 * (reach + 10.0) * 10.0, "{off}");
                moved_far += usize::from(off > 0.0);
            }
        }
    }
    assert!(moved_far > 100, "{moved_far}");
    let thin = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(0.3, 0.3, 1e-5)];
    let thin = Convex::from_points(&thin).unwrap();
    assert!(matches!(thin.translated(Vec3::splat(1e9)), Err(Error::Convex(_))));
}

#[test]
fn nothing_panics_on_extreme_planes_and_points() {
    let mut random = Random(16);
    let odd = [0.0, -0.0, 1e-45, 1e-38, 1e-20, 1.0, -1.0, 1e20, 3.4e38, f32::INFINITY, f32::NAN];
    let mut pick = || odd[random.below(odd.len())];
    for _ in 0..300 {
        let points: Vec<Vec3> = (0..6).map(|_| Vec3::new(pick(), pick(), pick())).collect();
        let _ = Convex::from_points(&points).map(|s| s.translated(points[0]));
        let planes: Vec<Plane> = points.iter().map(|&normal| Plane { normal, offset: pick() }).collect();
        let _ = Convex::from_planes(&planes);
    }
    // As many planes as there may be, all but the same.
    let near = |i: usize, n: Vec3| Plane { normal: n + Vec3::splat(i as f32 * 1e-7), offset: 1.0 };
    let planes: Vec<Plane> =
        (0..64).map(|i| near(i, Vec3::AXES[i % 3] * if i % 2 == 0 { 1.0 } else { -1.0 })).collect();
    let solid = Convex::from_planes(&planes).unwrap();
    assert!(solid.vertices().all(|v| planes.iter().all(|p| holds(p, v))));
}
