//! No mesh of ordinary size costs a query many times what others of its size do: forty kinds of
//! them, seen from near their tips, their edges, their planes, from inside and from afar.

use std::f32::consts::{PI, TAU};

use casca_scenes::world::Mesh;

use crate::common::*;

/// Corners and triangles.
type Parts = (Vec<Vec3>, Vec<[u32; 3]>);

const EYES: [Vec3; 8] = [
    Vec3::new(0.0, 0.5, 0.0),
    Vec3::new(0.05, 0.02, 0.03),
    Vec3::new(0.0, 14.0, 0.0),
    Vec3::new(0.16, 0.5, 14.4),
    Vec3::new(4.0, 0.0, 0.3),
    Vec3::new(1.0, -2.5, 0.7),
    Vec3::new(7.9, 0.3, 0.1),
    Vec3::new(60.0, 25.0, 40.0),
];

/// What costs at most this many times the median of its size is like the others.
const TIMES: u64 = 20;

/// The work of a query in units of 50 to 100 ns: objects tested, and so on.
fn work(s: &Stats) -> u64 {
    let objects = u64::from(s.objects_tested) + 5 * u64::from(s.occlusion_tests);
    objects + s.patch_blocks + 20 * u64::from(s.patches_drawn + s.refine_patches) + 5 * s.refine_squares
}

fn polar(angle: f32, r: f32, y: f32) -> Vec3 {
    Vec3::new(r * angle.cos(), y, r * angle.sin())
}

/// A number from 0 to 1, without order.
pub fn noise(i: usize, k: usize) -> f32 {
    let mut x = (i as u32).wrapping_mul(0x9e37_79b9) ^ (k as u32).wrapping_mul(0x85eb_ca6b);
    for by in [0x7feb_352d, 0x846c_a68b] {
        x = (x ^ x >> 15).wrapping_mul(by);
    }
    (x >> 8) as f32 / (1 << 24) as f32
}

/// A point whose coordinates are at most 1.
fn any(i: usize, k: usize) -> Vec3 {
    Vec3::new(noise(i, k), noise(i, k + 1), noise(i, k + 2)) * 2.0 - 1.0
}

/// Squares of two triangles, `m` by `k`, by two shares.
fn shares(m: usize, k: usize, at: impl Fn(f32, f32) -> Vec3) -> Parts {
    sheet(m as u32, k as u32, |i, j| at(i as f32 / m as f32, j as f32 / k as f32))
}

/// A sheet of about as many squares along both sides.
fn field(n: usize, at: impl Fn(f32, f32) -> Vec3) -> Parts {
    let side = ((n / 2) as f32).sqrt() as usize;
    shares(side, side, at)
}

/// Triangles side by side around the origin.
fn fan(n: usize, rim: impl Fn(f32, usize) -> Vec3) -> Parts {
    let rim = (0..=n).map(|i| rim(TAU * i as f32 / n as f32, i));
    (std::iter::once(Vec3::ZERO).chain(rim).collect(), (0..n as u32).map(|i| [0, i + 1, i + 2]).collect())
}

/// Triangles that share nothing.
fn soup(n: usize, corners: impl Fn(usize) -> [Vec3; 3]) -> Parts {
    ((0..n).flat_map(corners).collect(), (0..n as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

fn join(count: usize, part: impl Fn(usize) -> Parts) -> Parts {
    (0..count).map(part).fold((Vec::new(), Vec::new()), |(mut p, mut t), (corners, triangles)| {
        let base = p.len() as u32;
        p.extend(corners);
        t.extend(triangles.iter().map(|t| t.map(|v| v + base)));
        (p, t)
    })
}

fn ball(n: usize, r: f32, columns: usize) -> Parts {
    shares(columns, (n / 2 / columns).max(2), |u, v| polar(TAU * u, r * (PI * v).sin(), r * (PI * v).cos()))
}

fn block(c: Vec3, half: Vec3) -> Parts {
    let block = Mesh::cuboid(c - half, c + half);
    (block.positions, block.triangles)
}

/// A flat rectangle between corners that lie across.
fn plate(a: Vec3, across: Vec3, up: Vec3) -> Parts {
    shares(1, 1, |u, v| a + across * u + up * v)
}

/// Meshes of about `n` triangles, within 9 of the origin.
#[rustfmt::skip]
fn kinds(n: usize) -> Vec<(&'static str, Parts)> {
    let (half, odd) = (n / 2, |i: usize| (i % 2) as f32);
    let fold = move |u: f32| odd((u * half as f32).round() as usize);
    let line = |i: usize, of: usize| 16.0 * i as f32 / of as f32 - 8.0;
    let away = |i: usize| any(i, 1).normalize_or(Vec3::X);
    let thin = move |at: Vec3, i: usize| at + any(i, 7) * 0.3;
    let flat = |u: f32, v: f32| Vec3::new(16.0 * u - 8.0, 0.0, 16.0 * v - 8.0);
    let turn = move |i: usize, by: f32| TAU * (i as f32 + by) / n as f32;
    vec![
        ("fan", fan(n, |a, _| polar(a, 8.0, 0.0))),
        ("folded fan", fan(n, |a, i| polar(a, 8.0, odd(i)))),
        ("deeply folded fan", fan(n, |a, i| polar(a, 8.0, 4.0 * odd(i)))),
        ("half a fan", fan(n, |a, i| polar(a / 2.0, 8.0, odd(i)))),
        ("fan, three times around", fan(n, |a, i| polar(3.0 * a, 8.0, odd(i)))),
        ("fan with any heights", fan(n, |a, i| polar(a, 8.0, 6.0 * noise(i, 1) - 3.0))),
        ("fan with any rim", fan(n, |_, i| away(i) * 8.0)),
        ("fans", join(6, |k| fan(n / 6, |a, i| polar(a, 8.0, odd(i) + 0.4 * k as f32)))),
        ("cone", fan(n, |a, _| polar(a, 8.0, -6.0))),
        ("funnel", shares(n / 6, 3, |u, v| polar(TAU * u, 0.05 + 8.0 * v, 6.0 * v * v))),
        ("star", fan(n, |a, i| polar(a, 1.0 + 7.0 * odd(i), 0.3 * odd(i)))),
        ("spokes", soup(n, |i| [Vec3::ZERO, polar(turn(i, 0.0), 8.0, odd(i)), polar(turn(i, 0.5), 8.0, odd(i))])),
        ("bunch", soup(n, |i| [Vec3::ZERO, any(i, 1) * 8.0, any(i, 4) * 8.0])),
        ("bunch of blades", soup(n, |i| [Vec3::ZERO, away(i) * 8.0, thin(away(i) * 8.0, i)])),
        ("quills", soup(n, |i| [away(i) * 9.0, thin(away(i), i), thin(away(i), i + n)])),
        ("small soup", soup(n, |i| [4, 7, 10].map(|k| any(i, 1) * 8.0 + any(i, k)))),
        ("large soup", soup(n, |i| [1, 4, 7].map(|k| any(i, k) * 8.0))),
        ("long soup", soup(n, |i| [any(i, 1) * 9.0, any(i, 4) * 9.0, thin(any(i, 4) * 9.0, i)])),
        ("long soup from the middle", soup(n, |i| [any(i, 1) * 0.7, any(i, 4) * 9.0, thin(any(i, 4) * 9.0, i)])),
        ("strip", shares(half, 1, |u, v| flat(u, 0.5 + v / 8.0))),
        ("waves", shares(half, 1, |u, v| flat(u, 0.5 + v / 8.0) + Vec3::Y * (u * 60.0).sin())),
        ("slivers", shares(half, 1, |u, v| flat(u, v) + Vec3::Y * 0.3 * fold(u))),
        ("pleats", shares(half, 1, |u, v| Vec3::new(16.0 * u - 8.0, 8.0 * v - 4.0, fold(u)))),
        ("comb", soup(n, |i| [(0.0, 8.0), (8.0 / n as f32, -8.0), (-8.0 / n as f32, -8.0)]
            .map(|(by, z)| Vec3::new(line(i, n) + by, 0.0, z)))),
        ("tilted comb", soup(n, |i| [(0.0, 8.0), (0.2, -8.0), (-0.2, -8.0)]
            .map(|(by, z)| Vec3::new(line(i, n) + by, 5.0 * by, z)))),
        ("pickets", soup(n, |i| [(-6.0, -8.0), (6.0, -8.0), (0.0, 8.0)]
            .map(|(by, y)| Vec3::new(line(i, n) + by / n as f32, y, 1.0)))),
        ("pages", join(half, |i| plate(-Vec3::Y * 4.0, polar(turn(2 * i, 0.0), 8.0, 0.0), Vec3::Y * 8.0))),
        ("blinds", join(half, |i| plate(Vec3::new(-8.0, line(i, half), -1.0), Vec3::X * 16.0, Vec3::new(0.0, 0.4, 0.4)))),
        ("sheets", join(n / 8, |i| shares(2, 2, |u, v| flat(u, v) + Vec3::Y * (line(i, n / 8) + 0.3 * u * v)))),
        ("ball", ball(n, 7.0, ((n / 2) as f32).sqrt() as usize)),
        ("ball of meridians", ball(n, 7.0, n / 8)),
        ("ball of rings", ball(n, 7.0, 6)),
        ("balls in balls", join(5, |k| ball(n / 5, 1.5 * (k + 1) as f32, ((n / 10) as f32).sqrt() as usize))),
        ("boxes in boxes", join(n / 12, |k| block(Vec3::ZERO, Vec3::splat(96.0 * (k + 1) as f32 / n as f32)))),
        ("boxes", join(n / 12, |i| block(any(i, 1) * 7.0, Vec3::splat(0.5)))),
        ("bars", join(n / 12, |i| block(any(i, 1) * 7.0, Vec3::splat(0.1).with_x(8.0 * odd(i)) + Vec3::Y * 4.0 * odd(i + 1)))),
        ("plane", field(n, flat)),
        ("hills", field(n, |u, v| flat(u, v) + Vec3::Y * (u * 9.0).sin() * (v * 7.0).cos())),
        ("rubble", field(n, |u, v| flat(u, v) + Vec3::Y * 3.0 * noise((u * 1e3) as usize, (v * 1e3) as usize))),
        ("spiral", shares(half, 1, |u, v| polar(5.0 * TAU * u, 8.0 * u + 0.1 + v, 0.0))),
        ("spiral wall", shares(half, 1, |u, v| polar(5.0 * TAU * u, 8.0 * u + 0.1, 4.0 * v - 2.0))),
        ("stairs", shares(half, 1, |u, v| polar(4.0 * TAU * u, 0.1 + 7.9 * v, 10.0 * u - 5.0))),
        ("ring", field(n, |u, v| polar(TAU * u, 5.0 + 2.5 * (TAU * v).cos(), 2.5 * (TAU * v).sin()))),
        ("tube", shares(half, 1, |u, v| polar(TAU * u, 3.0, 16.0 * v - 8.0))),
        ("pleated tube", shares(half, 1, |u, v| polar(TAU * u, 3.0 + 0.5 * fold(u), 16.0 * v - 8.0))),
    ]
}

/// The mesh among some balls.
fn scene((corners, triangles): Parts) -> Scene {
    let mut scene = Scene::new(0.5).unwrap();
    scene.solid(mesh(corners, triangles));
    for i in 0..300 {
        scene.fixed(Sphere::new(any(i, 20) * 16.0, 0.3));
    }
    scene
}

#[test]
fn no_kind_of_mesh_costs_many_times_what_others_of_its_size_do() {
    let mut query = Query::new();
    for n in [50, 200, 600, 2000] {
        let mut works = Vec::new();
        for (kind, parts) in kinds(n) {
            let scene = scene(parts);
            for eye in EYES {
                query.run(&scene, &around(eye));
                works.push((work(query.pvs().stats()), kind, eye));
            }
        }
        works.sort_unstable_by_key(|w| w.0);
        let (median, most) = (works[works.len() / 2].0, works[works.len() - 1]);
        assert!(most.0 < TIMES * median, "{n} triangles: {most:?}, the median is {median}");
        println!("{n} triangles: {most:?}, the median is {median}");
    }
}
