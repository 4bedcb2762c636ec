//! What the preparation of meshes costs, for several kinds of them: instructions by a profiler,
//! times by the clock of this thread, and bytes.
//!
//! `cargo run --release -p casca-scenes --example preparation -- KIND [TRIANGLES] [RUNS]`
//!
//! A kind is `soup`, `ground`, `tiles`, `balls`, `boulders`, `boxes`, `boards`, `cones`, `houses`,
//! `pieces`, or the name of a generated scene, whose meshes are prepared in world space. With
//! `digest` as fourth word it prints a number that tells what was prepared from anything else.

use std::fmt::Write;
use std::hint::black_box;

use casca::TriMesh;
use casca_scenes::generated::{SceneOptions, build};
use casca_scenes::measure::timed;
use casca_scenes::random::{Generator, generator};
use casca_scenes::world::{Mesh, Shape};
use glam::{Affine3A, Quat, Vec3};
use rand::RngExt;

fn point(dice: &mut Generator, size: f32) -> Vec3 {
    Vec3::new(dice.random(), dice.random(), dice.random()) * size
}

/// Triangles of about a tenth of a metre, each with vertices of its own, anywhere in a cube.
fn soup(triangles: usize, dice: &mut Generator) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..triangles as u32 {
        let at = point(dice, 10.0);
        mesh.positions.extend([at, at + point(dice, 0.1), at + point(dice, 0.1)]);
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    mesh
}

/// Rolling ground, one mesh.
fn ground(triangles: usize) -> Mesh {
    let n = ((triangles / 2) as f32).sqrt().round() as u32;
    let pitch = 320.0 / n as f32;
    let height = |x: f32, z: f32| {
        let wave =
            |length: f32, turn: f32| 0.05 * length * ((x * turn.cos() + z * turn.sin()) / length * 6.3).sin();
        (0..12).map(|i| wave(90.0 * 0.75f32.powi(i), i as f32 * 2.1)).sum::<f32>()
    };
    let vertex = |i: u32| {
        let (x, z) = ((i % (n + 1)) as f32 * pitch, (i / (n + 1)) as f32 * pitch);
        Vec3::new(x, height(x, z), z)
    };
    let square = |i: u32| {
        let a = i / n * (n + 1) + i % n;
        [[a, a + n + 2, a + 1], [a, a + n + 1, a + n + 2]]
    };
    Mesh {
        positions: (0..(n + 1) * (n + 1)).map(vertex).collect(),
        triangles: (0..n * n).flat_map(square).collect(),
        ..Mesh::default()
    }
}

fn moved(mesh: Mesh, to: &Affine3A) -> Mesh {
    Mesh { positions: mesh.positions.iter().map(|&p| to.transform_point3(p)).collect(), ..mesh }
}

/// A place and a turn.
fn anywhere(dice: &mut Generator) -> Affine3A {
    let turn = Quat::from_rotation_y(dice.random::<f32>() * 6.0) * Quat::from_rotation_x(dice.random());
    Affine3A::from_scale_rotation_translation(
        Vec3::splat(0.5 + dice.random::<f32>()),
        turn,
        point(dice, 200.0),
    )
}

/// A ball with bumps.
fn rock(dice: &mut Generator) -> Mesh {
    let (mut mesh, phase) = (Mesh::ball(3), point(dice, 6.0));
    mesh.positions.iter_mut().for_each(|p| {
        let bumps = (*p * 3.0 + phase).to_array().map(f32::sin);
        *p *= 1.0 + 0.12 * bumps.iter().sum::<f32>();
    });
    mesh
}

/// A cone with this number of sides, without its base.
fn cone(sides: u32, low: f32, high: f32) -> Mesh {
    let rim = |i: u32| {
        let (sin, cos) = (std::f32::consts::TAU * i as f32 / sides as f32).sin_cos();
        Vec3::new(cos, low, sin)
    };
    Mesh {
        positions: (0..sides).map(rim).chain([Vec3::Y * high]).collect(),
        triangles: (0..sides).map(|i| [i, sides, (i + 1) % sides]).collect(),
        ..Mesh::default()
    }
}

fn joined(parts: impl IntoIterator<Item = Mesh>) -> Mesh {
    parts.into_iter().fold(Mesh::default(), |mut all, part| {
        all.append(part);
        all
    })
}

/// Walls, windows that stand out, a floor and a roof, all of boxes, and two slanted panes.
fn house() -> Mesh {
    let mut parts = vec![
        Mesh::cuboid(Vec3::ZERO, Vec3::new(8.0, 3.0, 0.25)),
        Mesh::cuboid(Vec3::new(0.0, 0.0, 9.75), Vec3::new(8.0, 3.0, 10.0)),
        Mesh::cuboid(Vec3::new(0.0, 0.0, 0.25), Vec3::new(0.25, 3.0, 9.75)),
        Mesh::cuboid(Vec3::new(7.75, 0.0, 0.25), Vec3::new(8.0, 3.0, 9.75)),
        Mesh::cuboid(Vec3::new(0.0, 3.0, 0.0), Vec3::new(8.0, 3.25, 10.0)),
    ];
    for i in 0..6 {
        let x = 1.0 + i as f32 * 1.1;
        parts.push(Mesh::cuboid(Vec3::new(x, 1.0, -0.125), Vec3::new(x + 0.75, 2.0, 0.0)));
    }
    let ridge = |x: f32| [Vec3::new(x, 3.25, -0.5), Vec3::new(x, 3.25, 10.5), Vec3::new(4.0, 6.0, 5.0)];
    parts.extend([-0.5, 8.5].map(|x| Mesh {
        positions: ridge(x).to_vec(),
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    }));
    joined(parts)
}

/// A tree: a trunk and cones above each other.
fn tree() -> Mesh {
    let trunk = Mesh::cuboid(Vec3::new(-0.15, 0.0, -0.15), Vec3::new(0.15, 2.0, 0.15));
    joined([trunk].into_iter().chain((0..6).map(|i| cone(9, 1.0 + 0.6 * i as f32, 2.2 + 0.6 * i as f32))))
}

/// As many copies of a mesh as have this many triangles, each in its own place.
fn copies(triangles: usize, dice: &mut Generator, mut mesh: impl FnMut(&mut Generator) -> Mesh) -> Vec<Mesh> {
    let (mut all, mut count) = (Vec::new(), 0);
    while count < triangles {
        let own = mesh(dice);
        count += own.triangles.len();
        all.push(moved(own, &anywhere(dice)));
    }
    all
}

/// The meshes of a scene, each in its place.
fn scene(name: &str) -> Vec<Mesh> {
    let kind = name.parse().expect("a kind of meshes or the name of a scene");
    let world = build(kind, &SceneOptions { frames: 1, ..SceneOptions::default() });
    let mesh = |shape: Shape| match shape {
        Shape::Mesh { mesh, transform } => Some(moved((*mesh).clone(), &transform)),
        _ => None,
    };
    world.objects.into_iter().filter_map(|o| mesh(o.shape)).collect()
}

fn meshes(kind: &str, n: usize) -> Vec<Mesh> {
    let mut dice = generator(1, 7);
    let dice = &mut dice;
    match kind {
        "soup" => vec![soup(n, dice)],
        "ground" => vec![ground(n)],
        "tiles" => copies(n, dice, |_| ground(98)),
        "balls" => {
            let ball = Mesh::ball(2);
            copies(n, dice, |_| ball.clone())
        }
        "boulders" => copies(n, dice, rock),
        "boxes" => copies(n, dice, |_| Mesh::cuboid(Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0))),
        "boards" => copies(n, dice, |_| Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::ONE, Vec3::ONE - Vec3::X],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        }),
        "cones" => copies(n, dice, |_| cone(12, 0.0, 3.0)),
        "houses" => copies(n, dice, |_| house()),
        "pieces" => copies(n, dice, |_| tree()),
        name => scene(name),
    }
}

/// Tells texts apart (FNV-1a).
struct Digest(u64);

impl Write for Digest {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        self.0 = text.bytes().fold(self.0, |h, b| (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3));
        Ok(())
    }
}

#[inline(never)]
fn prepare(meshes: Vec<Mesh>) -> Vec<TriMesh> {
    let prepared = meshes.into_iter().map(|m| TriMesh::new(m.positions, m.triangles).expect("a mesh"));
    prepared.collect()
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let number = |at: usize, otherwise| words.get(at).and_then(|w| w.parse().ok()).unwrap_or(otherwise);
    let (kind, triangles, runs): (_, usize, usize) =
        (words.first().map_or("soup", String::as_str), number(1, 100_000), number(2, 1));
    let meshes = meshes(kind, triangles);
    let count: usize = meshes.iter().map(|m| m.triangles.len()).sum();
    let mut best = f64::INFINITY;
    let mut prepared = Vec::new();
    for _ in 0..runs.max(1) {
        let given = meshes.clone();
        let (made, time) = timed(|| black_box(prepare(given)));
        best = best.min(time.as_secs_f64());
        prepared = made;
    }
    let bytes: usize = prepared.iter().map(|m| m.memory_bytes() + size_of::<TriMesh>()).sum();
    let given: usize = prepared.iter().map(|m| size_of_val(m.positions()) + size_of_val(m.triangles())).sum();
    let (count, bytes, given) = (count as f64, bytes as f64, given as f64);
    println!(
        "{kind}: {} meshes, {count} triangles, {:.0} ns and {:.1} bytes a triangle ({:.1} given), {:.2} sides",
        meshes.len(),
        best * 1e9 / count,
        bytes / count,
        given / count,
        prepared.iter().map(TriMesh::sides).sum::<usize>() as f64 / count,
    );
    if words.get(3).is_some() {
        let mut digest = Digest(0xcbf2_9ce4_8422_2325);
        prepared.iter().for_each(|mesh| write!(digest, "{mesh:?}").expect("numbers are written"));
        println!("{kind}: digest {:016x}", digest.0);
    }
}
