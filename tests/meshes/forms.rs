//! Random meshes, sound and broken.

use std::f64::consts::TAU;

use casca_scenes::world::Mesh;

use crate::common::*;

#[derive(Debug, Clone, Copy)]
pub enum Form {
    Box,
    Tetrahedron,
    /// An icosahedron, its faces split this often.
    Ball(u32),
    /// A height field of this many squares in a row.
    Terrain(u32),
    /// A piece of a tube.
    Curved(u32),
    /// Three or more triangles at an edge.
    Fan(u32),
    /// Triangles that meet others in the middle of edges.
    Junctions(u32),
    /// Long thin triangles.
    Needles(u32),
    /// Triangles anywhere.
    Soup(u32),
    /// A ridge with this many long teeth.
    Comb(u32),
    /// This many cones, one above the other, without their bases.
    Cones(u32),
}

#[derive(Debug, Clone, Copy)]
pub enum Damage {
    /// Takes this share of the triangles away.
    Holes(f64),
    Duplicates(f64),
    ZeroArea(f64),
    Flips(f64),
    /// Every triangle gets vertices of its own.
    Split,
}

/// How to make a mesh, in a world from 0 to 16.
#[derive(Debug, Clone)]
pub struct Recipe {
    pub form: Form,
    pub center: [f64; 3],
    pub size: [f64; 3],
    pub axis: [f64; 3],
    pub angle: f64,
    pub damage: Vec<Damage>,
    pub seed: u64,
}

pub fn form() -> impl Strategy<Value = Form> {
    prop_oneof![
        3 => Just(Form::Box),
        1 => Just(Form::Tetrahedron),
        2 => (0..3u32).prop_map(Form::Ball),
        2 => (1..9u32).prop_map(Form::Terrain),
        1 => (9..25u32).prop_map(Form::Terrain),
        2 => (2..9u32).prop_map(Form::Curved),
        1 => prop_oneof![3..6u32, 6..40u32].prop_map(Form::Fan),
        1 => (1..5u32).prop_map(Form::Junctions),
        1 => (1..9u32).prop_map(Form::Needles),
        1 => (1..9u32).prop_map(Form::Soup),
        1 => (2..40u32).prop_map(Form::Comb),
        2 => (1..4u32).prop_map(Form::Cones),
    ]
}

fn damage() -> impl Strategy<Value = Damage> {
    let share = 0.02..0.5f64;
    prop_oneof![
        3 => share.clone().prop_map(Damage::Holes),
        1 => share.clone().prop_map(Damage::Duplicates),
        1 => share.clone().prop_map(Damage::ZeroArea),
        2 => share.prop_map(Damage::Flips),
        1 => Just(Damage::Split),
    ]
}

/// Three coordinates, half of them on a lattice.
pub fn places(range: std::ops::Range<f32>) -> impl Strategy<Value = [f64; 3]> {
    points(range, 1.0).prop_map(|p| p.as_dvec3().to_array())
}

pub fn recipe() -> impl Strategy<Value = Recipe> {
    let center = places(0.0..16.0);
    let size = prop_oneof![
        2 => prop::array::uniform3(0.3..3.0f64),
        2 => places(1.0..7.0),
        1 => (1.0..8.0f64).prop_map(|s| [s; 3]),
    ];
    let angle = prop_oneof![1 => Just(0.0), 2 => 0.0..6.3f64];
    let damages = prop_oneof![2 => Just(Vec::new()), 3 => prop::collection::vec(damage(), 1..3)];
    (form(), center, size, prop::array::uniform3(-1.0..1.0f64), angle, damages, any::<u64>()).prop_map(
        |(form, center, size, axis, angle, damage, seed)| Recipe {
            form,
            center,
            size,
            axis,
            angle,
            damage,
            seed,
        },
    )
}

#[derive(Debug, Clone, Default)]
pub struct Made {
    pub positions: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    /// Triangles taken away: one sees through there.
    pub holes: Vec<[DVec3; 3]>,
}

type Parts = (Vec<DVec3>, Vec<[u32; 3]>);

fn parts_of(mesh: Mesh) -> Parts {
    (mesh.positions.iter().map(|p| p.as_dvec3()).collect(), mesh.triangles)
}

pub fn cuboid() -> Parts {
    parts_of(Mesh::cuboid(Vec3::NEG_ONE, Vec3::ONE))
}

pub fn ball(splits: u32) -> Parts {
    parts_of(Mesh::ball(splits))
}

/// A sheet of squares, put somewhere by a function of two numbers from -1 to 1.
fn sheet(n: u32, mut at: impl FnMut(f64, f64) -> DVec3) -> Parts {
    let place = |i: u32| f64::from(i) / f64::from(n) * 2.0 - 1.0;
    parts_of(Mesh::sheet(n, n, |i, j| at(place(i), place(j)).as_vec3()))
}

fn parts(form: Form, random: &mut Random) -> Parts {
    match form {
        Form::Box => cuboid(),
        Form::Tetrahedron => {
            let p = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
            (p.map(DVec3::from_array).to_vec(), vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
        }
        Form::Ball(splits) => ball(splits),
        Form::Terrain(n) => {
            let rough = random.within(0.0, 0.6);
            sheet(n, |u, v| DVec3::new(u, random.within(-rough, rough), v))
        }
        Form::Curved(n) => {
            let around = random.within(0.5, 3.2);
            sheet(n, |u, v| DVec3::new((around * u).cos(), v, (around * u).sin()))
        }
        Form::Fan(n) => {
            let mut p = vec![DVec3::NEG_Y, DVec3::Y];
            p.extend((0..n).map(|_| random.point(-1.0, 1.0)));
            (p, (2..n + 2).map(|i| [0, 1, i]).collect())
        }
        Form::Junctions(n) => {
            // One side in one piece, the other in several.
            let mut p = vec![DVec3::NEG_X, DVec3::X, DVec3::NEG_Z];
            let mut t = vec![[0, 1, 2]];
            for i in 0..=n + 1 {
                p.push(DVec3::X * (f64::from(i) / f64::from(n + 1) * 2.0 - 1.0));
            }
            p.push(DVec3::Z);
            t.extend((0..=n).map(|i| [4 + i, 3 + i, 5 + n]));
            (p, t)
        }
        Form::Needles(n) => {
            let mut p = Vec::new();
            for _ in 0..n {
                let (a, b) = (random.point(-1.0, 1.0), random.point(-1.0, 1.0));
                p.extend([a, b, b + random.point(-1.0, 1.0) * 10f64.powf(random.within(-6.0, -1.0))]);
            }
            (p, (0..n).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
        }
        Form::Soup(n) => {
            let p = (0..n + 3).map(|_| random.point(-1.0, 1.0)).collect();
            let mut any = || random.below(n as usize + 3) as u32;
            (p, (0..2 * n).map(|_| [any(), any(), any()]).collect())
        }
        Form::Comb(n) => {
            let x = |i: f64| i / f64::from(n) * 2.0 - 1.0;
            let mut p: Vec<DVec3> = Vec::new();
            for y in [-0.9, -1.0] {
                p.extend((0..=n).map(|i| DVec3::new(x(f64::from(i)), y, 0.0)));
            }
            p.extend((0..n).map(|i| DVec3::new(x(f64::from(i) + 0.5), random.within(0.0, 1.0), 0.0)));
            let (low, tip) = (n + 1, 2 * n + 2);
            let tooth = |i: u32| [[i, i + 1, tip + i], [i + 1, i, low + i], [i + 1, low + i, low + i + 1]];
            (p, (0..n).flat_map(tooth).collect())
        }
        Form::Cones(n) => {
            let sides = 3 + random.below(9) as u32;
            let (mut p, mut t) = (Vec::new(), Vec::new());
            for i in 0..n {
                let (first, low) = (p.len() as u32, f64::from(i) * 0.6 - 0.8);
                let around = |side: u32| {
                    DVec3::Y
                        .any_orthonormal_vector()
                        .rotate_axis(DVec3::Y, f64::from(side) * TAU / f64::from(sides))
                };
                p.extend((0..sides).map(|side| around(side) + DVec3::Y * low));
                p.push(DVec3::Y * (low + random.within(0.3, 1.2)));
                t.extend((0..sides).map(|side| [first + side, first + sides, first + (side + 1) % sides]));
            }
            (p, t)
        }
    }
}

impl Recipe {
    pub fn make(&self, to_world: &dyn Fn(DVec3) -> DVec3) -> Made {
        let mut random = Random(self.seed);
        let (points, mut triangles) = parts(self.form, &mut random);
        let turn = DQuat::from_axis_angle(DVec3::from_array(self.axis).normalize_or(DVec3::Y), self.angle);
        let place = |p: DVec3| {
            let p = turn * (p * DVec3::from_array(self.size)) + DVec3::from_array(self.center);
            to_world(p).as_vec3()
        };
        let mut positions: Vec<Vec3> = points.into_iter().map(place).collect();
        let mut holes = Vec::new();
        for damage in &self.damage {
            match *damage {
                Damage::Holes(share) => triangles.retain(|t| {
                    let keep = random.next() >= share;
                    if !keep {
                        holes.push(t.map(|v| positions[v as usize].as_dvec3()));
                    }
                    keep
                }),
                Damage::Duplicates(share) => {
                    for i in 0..triangles.len() {
                        if random.next() < share {
                            let [a, b, c] = triangles[i];
                            triangles.push(if random.below(2) == 0 { [b, c, a] } else { [c, b, a] });
                        }
                    }
                }
                Damage::ZeroArea(share) => {
                    for i in 0..triangles.len() {
                        if random.next() < share {
                            let [a, b, _] = triangles[i];
                            triangles.push([a, b, b]);
                            let middle = positions[a as usize].midpoint(positions[b as usize]);
                            positions.push(middle);
                            triangles.push([a, positions.len() as u32 - 1, b]);
                        }
                    }
                }
                Damage::Flips(share) => {
                    for t in &mut triangles {
                        if random.next() < share {
                            t.swap(0, 1);
                        }
                    }
                }
                Damage::Split => {
                    positions = triangles.iter().flatten().map(|&v| positions[v as usize]).collect();
                    triangles = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
                }
            }
        }
        if triangles.is_empty() {
            triangles.push([0, 0, 0]);
            positions.push(to_world(DVec3::from_array(self.center)).as_vec3());
        }
        Made { positions, triangles, holes }
    }
}
