//! Walls and objects of awkward sizes, places and makes, around one wall in the middle of an arena.

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};

use super::case::{
    ASPECT, Case, Dice, Known, Shot, block, box_mesh, glass, grid, mesh, placed, quad, solid, sphere, still,
};
use crate::experiments::{Lab, LabError};
use casca_scenes::world::{Camera, FRAME_SECONDS, Mesh, Motion, Object, Shape};

/// Of the grid, in metres.
const CELL: f32 = 0.5;
/// The front of the wall lies on this plane, 10 m before the eye and on a plane between cells.
const FRONT: f32 = -10.0;
/// Half of the wall's width and height.
const HALF: Vec3 = Vec3::new(6.0, 4.0, 0.0);
/// The corners of the arena.
const ARENA: [Vec3; 2] = [Vec3::new(-14.0, -14.0, -26.0), Vec3::new(14.0, 14.0, 4.0)];

/// What every arena has: objects behind the wall and around it, and cameras that sway before it.
struct Arena<'a> {
    lab: &'a Lab<'a>,
    cameras: Vec<Camera>,
    crowd: Vec<Object>,
}

/// A box of the wall: `x` and `y` as shares of its half sizes, and its thickness.
fn brick(x: (f32, f32), y: (f32, f32), thickness: f32) -> Shape {
    block(
        Vec3::new(x.0 * HALF.x, y.0 * HALF.y, FRONT - thickness),
        Vec3::new(x.1 * HALF.x, y.1 * HALF.y, FRONT),
    )
}

fn wall(thickness: f32) -> Shape {
    brick((-1.0, 1.0), (-1.0, 1.0), thickness)
}

/// A flat mesh in the wall's plane, of `n` by `m` quadrilaterals; `keep` chooses among them.
fn sheet(n: u32, m: u32, mut keep: impl FnMut(u32, u32) -> bool) -> Shape {
    let at = |i: u32, j: u32| {
        let share = |k: u32, of: u32| 2.0 * k as f32 / of as f32 - 1.0;
        Vec3::new(share(i, n) * HALF.x, share(j, m) * HALF.y, FRONT)
    };
    let positions = (0..=m).flat_map(|j| (0..=n).map(move |i| at(i, j))).collect();
    let mut triangles = Vec::new();
    for j in 0..m {
        for i in 0..n {
            if keep(i, j) {
                let a = j * (n + 1) + i;
                let (b, c, d) = (a + 1, a + n + 2, a + n + 1);
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    mesh(positions, triangles)
}

impl<'a> Arena<'a> {
    fn new(lab: &'a Lab) -> Self {
        let mut dice = Dice::new(lab.seed, 5);
        let base = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, 70.0, ASPECT, 0.1, 100.0);
        let cameras = (0..lab.pick(8, 3)).map(|_| {
            let turn = Quat::from_scaled_axis(dice.ball() * 0.15);
            placed(&base, dice.ball() * Vec3::new(2.0, 1.0, 0.4), turn)
        });
        let cameras = cameras.collect();
        let mut crowd = Vec::new();
        for i in 0..lab.pick(500, 250) {
            let (lo, hi) = (Vec3::new(-13.0, -13.0, -25.0), Vec3::new(13.0, 13.0, -12.5));
            let (at, size) = (dice.point(lo, hi), dice.range(0.05, 0.35));
            let shape = match i % 3 {
                0 => block(at - size, at + size),
                1 => box_mesh(at - size, at + size),
                _ => sphere(at, size),
            };
            crowd.push(if i % 4 == 0 { glass("crowd", shape) } else { solid("crowd", shape) });
        }
        Self { lab, cameras, crowd }
    }

    /// The arena with these objects before its own.
    fn with(&self, name: &str, mut objects: Vec<Object>) -> Result<Case, LabError> {
        objects.extend(self.crowd.iter().cloned());
        let grid = grid(ARENA[0], ARENA[1], CELL)?;
        Ok(Case::new(name, objects, grid, still(self.cameras.iter().copied())))
    }

    fn dice(&self, case: u64) -> Dice {
        Dice::new(self.lab.seed, case)
    }

    /// Walls from thick to no thickness at all.
    fn thin(&self) -> Result<Vec<Case>, LabError> {
        let mut cases = vec![self.with("wall 4 cells thick", vec![solid("wall", wall(4.0 * CELL))])?.calm()];
        for (share, what) in [(0.5, "1/2 cell"), (0.1, "1/10 cell"), (1e-3, "1/1000 cell")] {
            let name = format!("wall {what} thick");
            cases.push(self.with(&name, vec![solid("wall", wall(share * CELL))])?);
        }
        cases.push(self.with("wall a box without thickness", vec![solid("wall", wall(0.0))])?);
        cases.push(self.with("wall a mesh sheet", vec![solid("wall", sheet(1, 1, |_, _| true))])?);
        let between = block(
            Vec3::new(-HALF.x, -HALF.y, FRONT - CELL * 1.45),
            Vec3::new(HALF.x, HALF.y, FRONT - CELL * 0.45),
        );
        cases.push(self.with("wall 1 cell thick between planes", vec![solid("wall", between)])?);
        Ok(cases)
    }

    /// Solids that share faces, planes or all of their surface.
    fn touching(&self) -> Result<Vec<Case>, LabError> {
        let thick = 4.0 * CELL;
        let tiles = |n: usize, m: usize, gap: f32, make: &dyn Fn((f32, f32), (f32, f32)) -> Shape| {
            let span = |k: usize, of: usize| {
                let of = of as f32;
                (2.0 * k as f32 / of - 1.0 + gap, 2.0 * (k + 1) as f32 / of - 1.0 - gap)
            };
            let place = |i: usize| (span(i % n, n), span(i / n, m));
            (0..n * m).map(place).map(|(x, y)| solid("tile", make(x, y))).collect::<Vec<Object>>()
        };
        let boxes = |x, y| brick(x, y, thick);
        let flat = |x: (f32, f32), y: (f32, f32)| {
            let at = |a, b| Vec3::new(a * HALF.x, b * HALF.y, FRONT);
            quad([at(x.0, y.0), at(x.1, y.0), at(x.1, y.1), at(x.0, y.1)])
        };
        let closed = |x, y| match brick(x, y, thick) {
            Shape::Box { min, max } => box_mesh(min, max),
            other => other,
        };
        let mut cases = vec![self.with("wall of one box", vec![solid("wall", wall(thick))])?.calm()];
        cases.push(self.with("wall of 96 boxes that touch", tiles(12, 8, 0.0, &boxes))?);
        cases.push(self.with("wall of 96 closed meshes that touch", tiles(12, 8, 0.0, &closed))?);
        cases.push(self.with("wall of 96 sheets that share edges", tiles(12, 8, 0.0, &flat))?);
        cases.push(self.with("wall of 96 boxes 0.1 mm apart", tiles(12, 8, 8e-6, &boxes))?);
        cases.push(self.with("wall of 96 sheets 0.1 mm apart", tiles(12, 8, 8e-6, &flat))?);
        cases.push(self.with("wall of 96 boxes that overlap, coplanar", tiles(12, 8, -0.02, &boxes))?);
        let twice = vec![solid("wall", wall(thick)), solid("wall", wall(thick)), solid("wall", wall(thick))];
        cases.push(self.with("three equal walls", twice)?);
        let mut dice = self.dice(6);
        let mut posters = vec![solid("wall", wall(thick))];
        for i in 0..40 {
            let at = dice.point(-HALF, HALF);
            let (w, h) = (dice.range(0.1, 0.8), dice.range(0.1, 0.8));
            let (near, far) = match i % 4 {
                // Before the wall's front, touching it; in its plane; through it; behind it, touching it.
                0 => (FRONT + 0.01, FRONT),
                1 => (FRONT, FRONT),
                2 => (FRONT + 0.01, FRONT - 0.5),
                _ => (FRONT - thick, FRONT - thick - 0.01),
            };
            let shape = block(Vec3::new(at.x - w, at.y - h, far), Vec3::new(at.x + w, at.y + h, near));
            posters.push(glass("poster", shape));
        }
        cases.push(self.with("thin objects on, in, through and behind the wall", posters)?);
        Ok(cases)
    }

    /// Objects that coincide with occluders or hold each other.
    fn nested(&self) -> Result<Vec<Case>, LabError> {
        let mut dice = self.dice(7);
        // Before the wall, none before another.
        let places: Vec<Vec3> = (0..24)
            .map(|i| {
                let way = Vec3::new((i % 6) as f32 * 0.22 - 0.55, (i / 6) as f32 * 0.22 - 0.33, -1.0);
                way * dice.range(5.0, 8.0)
            })
            .collect();
        let shape = |i: usize, at: Vec3, r: f32| match i % 3 {
            0 => block(at - r, at + r),
            1 => box_mesh(at - r, at + r),
            _ => sphere(at, r),
        };
        let front = |first: usize, step: usize, r: f32| -> Vec<Known> {
            let seen = |(i, p): (usize, &Vec3)| Known {
                object: first + i * step,
                // A point of the surface towards the eye; on a sphere the nearest one.
                point: match i % 3 {
                    2 => p.as_dvec3() * (1.0 - f64::from(r) / p.as_dvec3().length()),
                    _ => p.as_dvec3().with_z(f64::from(p.z + r)),
                },
            };
            places.iter().enumerate().map(seen).collect()
        };
        let room = || vec![solid("wall", wall(2.0 * CELL))];
        let mut cases = Vec::new();
        let mut objects = room();
        objects.extend(places.iter().enumerate().map(|(i, &p)| glass("pane", shape(i, p, 0.2))));
        cases.push(self.with("objects that hide nothing", objects)?.with_known(front(1, 1, 0.2)).calm());
        let mut objects = room();
        objects.extend(places.iter().enumerate().map(|(i, &p)| solid("own", shape(i, p, 0.2))));
        cases.push(self.with("objects equal to their occluder", objects)?.with_known(front(1, 1, 0.2)));
        for (name, twin_first) in
            [("objects equal to another's occluder", false), ("the same, occluders first", true)]
        {
            let mut objects = room();
            for (i, &p) in places.iter().enumerate() {
                let pair = [glass("twin", shape(i, p, 0.2)), solid("occluder", shape(i, p, 0.2))];
                objects.extend(if twin_first { [pair[1].clone(), pair[0].clone()] } else { pair });
            }
            let mut known = front(1, 2, 0.2);
            known.extend(front(2, 2, 0.2));
            cases.push(self.with(name, objects)?.with_known(known));
        }
        for (name, solid_at) in
            [("nested objects, the innermost hides", 0), ("nested objects, the outermost hides", 3)]
        {
            let mut objects = room();
            for (i, &p) in places.iter().enumerate() {
                for k in 0..4 {
                    let s = shape(i, p, 0.05 * (k + 1) as f32);
                    objects.push(if k == solid_at { solid("shell", s) } else { glass("shell", s) });
                }
            }
            // The outermost is always seen; the inner ones only where nothing around them hides.
            let mut known = front(4, 4, 0.2);
            if solid_at == 0 {
                (0..3).for_each(|k| known.extend(front(1 + k, 4, 0.05 * (k + 1) as f32)));
            }
            cases.push(self.with(name, objects)?.with_known(known));
        }
        Ok(cases)
    }

    /// Points, and objects as large as the scene and larger.
    fn sizes(&self) -> Result<Vec<Case>, LabError> {
        let plain = vec![solid("wall", wall(4.0 * CELL))];
        let mut cases = vec![self.with("objects of usual sizes", plain.clone())?.calm()];
        let mut dice = self.dice(8);
        for (name, size) in
            [("zero-size objects", 0.0), ("objects of 1e-6 m", 1e-6), ("objects of 1e-30 m", 1e-30)]
        {
            let mut objects = plain.clone();
            let mut known = Vec::new();
            for i in 0..60 {
                // Every fourth hovers close before the wall, on a plane between cells.
                let at = match i % 4 {
                    0 => dice.point(-HALF, HALF).with_z(FRONT + CELL),
                    _ => {
                        dice.point(Vec3::new(-1.5, -0.8, -1.0), Vec3::new(1.5, 0.8, -1.0))
                            * dice.range(2.5, 6.0)
                    }
                };
                let shape = match i % 3 {
                    0 => sphere(at, size),
                    1 => block(at, at + size),
                    _ => mesh(vec![at, at + Vec3::X * size, at + Vec3::Y * size], vec![[0, 1, 2]]),
                };
                known.push(Known { object: objects.len(), point: at.as_dvec3() });
                let object = glass("dot", shape);
                objects.push(if i % 2 == 0 { object } else { Object { occludes: true, ..object } });
            }
            cases.push(self.with(name, objects)?.with_known(known));
        }
        let huge = 1e6;
        let mut objects = plain.clone();
        objects.push(glass("fog", block(ARENA[0] - 1.0, ARENA[1] + 1.0)));
        objects.push(glass("sky", sphere(Vec3::ZERO, 50.0)));
        objects.push(glass("far sky", sphere(Vec3::ZERO, huge)));
        objects.push(glass("everything", block(Vec3::splat(-huge), Vec3::splat(huge))));
        cases.push(self.with("scene-size objects around the eye", objects)?);
        let mut objects = plain.clone();
        objects.push(solid("fog", block(ARENA[0] - 1.0, ARENA[1] + 1.0)));
        objects.push(solid("far sky", sphere(Vec3::ZERO, huge)));
        cases.push(self.with("scene-size occluders around the eye", objects)?);
        let mut objects = plain;
        objects.push(solid("ground", block(Vec3::new(-huge, -huge, -huge), Vec3::new(huge, -3.5, huge))));
        objects.push(solid("planet", sphere(Vec3::new(0.0, huge + 6.0, 0.0), huge)));
        objects.push(solid(
            "backdrop",
            quad(
                [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                    .map(|(x, y)| Vec3::new(x * huge, y * huge, -22.0)),
            ),
        ));
        cases.push(self.with("occluders 1e6 m wide", objects)?);
        Ok(cases)
    }

    /// Meshes that are none, or bad ones, as occluders.
    fn degenerate(&self) -> Result<Vec<Case>, LabError> {
        let thick = 4.0 * CELL;
        let mut dice = self.dice(9);
        let mut cases =
            vec![self.with("mesh wall, 8 x 6 quads", vec![solid("wall", sheet(8, 6, |_, _| true))])?.calm()];
        let mut at = |reach: Vec3| dice.point(-reach, reach).with_z(FRONT);
        // Triangles whose corners lie on a line or in a point; across the wall's place.
        let mut lines = Vec::new();
        for i in 0..300u32 {
            let (a, b) = (at(HALF), at(HALF));
            lines.push(match i % 3 {
                0 => [a, b, a],
                1 => [a, a, a],
                _ => [a, (a + b) * 0.5, b],
            });
        }
        let soup = |corners: &[[Vec3; 3]]| {
            let positions = corners.iter().flatten().copied().collect();
            mesh(positions, (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
        };
        cases.push(self.with("triangles without area", vec![solid("lines", soup(&lines))])?);
        let mut both = lines.clone();
        both.push([
            Vec3::new(-HALF.x, -HALF.y, FRONT),
            Vec3::new(HALF.x, -HALF.y, FRONT),
            HALF.with_z(FRONT),
        ]);
        cases.push(self.with("triangles without area in a wall's mesh", vec![solid("lines", soup(&both))])?);
        let needles: Vec<[Vec3; 3]> = (0..300)
            .map(|_| {
                let (a, b) = (at(HALF), at(HALF));
                [a, b, b + Vec3::new(1e-5, 1e-5, 0.0)]
            })
            .collect();
        cases.push(self.with("needles 0.01 mm wide", vec![solid("needles", soup(&needles))])?);
        let repeated = match sheet(8, 6, |_, _| true) {
            Shape::Mesh { mesh: m, .. } => {
                let mut triangles = m.triangles.clone();
                // Each again, turned over, and once more.
                triangles.extend(m.triangles.iter().map(|&[a, b, c]| [c, b, a]));
                triangles.extend(m.triangles.iter().map(|&[a, b, c]| [b, c, a]));
                mesh(m.positions.clone(), triangles)
            }
            other => other,
        };
        cases.push(self.with("every triangle three times, also turned over", vec![solid("wall", repeated)])?);
        // Each column of quads meets one twice as tall: vertices lie on edges.
        let mut junctions = Vec::new();
        for i in 0..8 {
            let rows = if i % 2 == 0 { 3 } else { 6 };
            for j in 0..rows {
                let x = |k: i32| (k as f32 / 4.0 - 1.0) * HALF.x;
                let y = |k: i32| (2.0 * k as f32 / rows as f32 - 1.0) * HALF.y;
                let [a, b, c, d] = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
                    .map(|(i, j)| Vec3::new(x(i), y(j), FRONT));
                junctions.extend([[a, b, c], [a, c, d]]);
            }
        }
        cases.push(self.with("T-junctions", vec![solid("wall", soup(&junctions))])?);
        let mut holes = self.dice(10);
        let torn = sheet(48, 32, |_, _| holes.range(0.0, 1.0) < 0.8);
        cases.push(self.with("sheet of 48 x 32 quads, a fifth missing", vec![solid("wall", torn)])?);
        let flat = box_mesh(Vec3::new(-HALF.x, -HALF.y, FRONT), Vec3::new(HALF.x, HALF.y, FRONT));
        cases.push(self.with("closed box mesh without thickness", vec![solid("wall", flat)])?);
        let (lo, hi) = (Vec3::new(-HALF.x, -HALF.y, FRONT - thick), Vec3::new(HALF.x, HALF.y, FRONT));
        let inside_out = match box_mesh(lo, hi) {
            Shape::Mesh { mesh: m, .. } => {
                mesh(m.positions.clone(), m.triangles.iter().map(|&[a, b, c]| [c, b, a]).collect())
            }
            other => other,
        };
        cases.push(self.with("box mesh inside out", vec![solid("wall", inside_out)])?);
        let open = match box_mesh(lo, hi) {
            Shape::Mesh { mesh: m, .. } => mesh(m.positions.clone(), m.triangles[1..].to_vec()),
            other => other,
        };
        cases.push(self.with("box mesh that lacks a triangle", vec![solid("wall", open)])?);
        Ok(cases)
    }

    /// Eyes close to the plane of a long wall, looking along it.
    fn grazing(&self) -> Result<Vec<Case>, LabError> {
        let base = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, 70.0, ASPECT, 0.01, 100.0);
        let mut dice = self.dice(11);
        let turns: Vec<(Vec3, Quat)> = (0..self.lab.pick(8, 3))
            .map(|_| (dice.ball() * Vec3::new(0.0, 1.0, 0.5), Quat::from_scaled_axis(dice.ball() * 0.2)))
            .collect();
        let mut cases = Vec::new();
        for (what, make) in [
            ("a box", (|lo, hi| block(lo, hi)) as fn(Vec3, Vec3) -> Shape),
            ("a closed mesh", box_mesh),
            ("a sheet", |lo, hi| quad([hi.with_y(lo.y).with_z(lo.z), hi.with_y(lo.y), hi, hi.with_z(lo.z)])),
        ] {
            for away in [4.0f32, 0.1, 1e-3, 1e-5, 0.0] {
                // The wall's face looks towards greater x, and it runs past the eye; small things stick to both of its sides.
                let (lo, hi) = (Vec3::new(-1.0 - away, -6.0, -24.0), Vec3::new(-away, 6.0, 3.0));
                let mut objects = vec![solid("wall", make(lo, hi))];
                let mut dice = self.dice(12);
                for i in 0..self.lab.pick(200, 100) {
                    let size = dice.range(0.01, 0.2);
                    let p = dice.point(lo, hi);
                    let x = match i % 3 {
                        0 => hi.x + size,
                        1 => lo.x - size,
                        _ => dice.range(-8.0, 8.0),
                    };
                    objects.push(glass("sticker", sphere(p.with_x(x), size)));
                }
                let cameras = turns.iter().map(|&(step, turn)| placed(&base, step, turn));
                let grid = grid(ARENA[0], ARENA[1], CELL)?;
                let case =
                    Case::new(format!("eye {away} m off the face of {what}"), objects, grid, still(cameras));
                cases.push(if away > 1.0 { case.calm() } else { case });
            }
        }
        Ok(cases)
    }

    /// Meshes in place of boxes, at rest and turning.
    fn meshes(&self) -> Result<Vec<Case>, LabError> {
        let mut dice = self.dice(13);
        let boxes: Vec<(Vec3, Vec3)> = (0..60)
            .map(|_| {
                let at = dice.point(Vec3::new(-9.0, -6.0, -12.0), Vec3::new(9.0, 6.0, -6.0));
                (at, dice.point(Vec3::splat(0.2), Vec3::splat(1.2)))
            })
            .collect();
        let plain = boxes.iter().map(|&(p, s)| solid("box", block(p - s, p + s))).collect();
        let closed = boxes.iter().map(|&(p, s)| solid("mesh", box_mesh(p - s, p + s))).collect();
        let mut cases = vec![self.with("60 boxes", plain)?.calm(), self.with("60 boxes as meshes", closed)?];
        let Shape::Mesh { mesh: unit, .. } = box_mesh(Vec3::NEG_ONE, Vec3::ONE) else { return Ok(cases) };
        let turned = |unit: &Arc<Mesh>, i: usize, frame: usize| {
            let (p, s) = boxes[i];
            let turn =
                Quat::from_scaled_axis(Vec3::new(0.3, 0.5, 0.7) * (i + 1) as f32 * (frame as f32 * 0.05));
            let transform = Affine3A::from_scale_rotation_translation(s, turn, p);
            Shape::Mesh { mesh: unit.clone(), transform }
        };
        let moving = (0..boxes.len())
            .map(|i| Object {
                motion: Motion::Dynamic { max_speed: 1000.0 },
                ..solid("turning mesh", turned(&unit, i, 0))
            })
            .collect();
        let case = self.with("60 boxes as meshes that turn", moving)?;
        let shots = self.cameras.iter().enumerate().map(|(frame, &camera)| Shot {
            camera,
            moves: (0..boxes.len()).map(|i| (i, turned(&unit, i, frame))).collect(),
            time: frame as f64 * FRAME_SECONDS,
        });
        cases.push(Case { shots: shots.collect(), ..case });
        Ok(cases)
    }
}

/// Walls thinner than a cell.
pub(super) fn thin(lab: &Lab) -> Result<Vec<Case>, LabError> {
    Arena::new(lab).thin()
}

/// Views along walls.
pub(super) fn grazing(lab: &Lab) -> Result<Vec<Case>, LabError> {
    Arena::new(lab).grazing()
}

/// Coplanar and touching occluders.
pub(super) fn touching(lab: &Lab) -> Result<Vec<Case>, LabError> {
    Arena::new(lab).touching()
}

/// Objects equal to occluders, and nested ones.
pub(super) fn nested(lab: &Lab) -> Result<Vec<Case>, LabError> {
    Arena::new(lab).nested()
}

/// Zero-size and scene-size objects.
pub(super) fn sizes(lab: &Lab) -> Result<Vec<Case>, LabError> {
    Arena::new(lab).sizes()
}

/// Degenerate occluders, and meshes in place of boxes.
pub(super) fn meshes(lab: &Lab) -> Result<Vec<Case>, LabError> {
    let arena = Arena::new(lab);
    let mut cases = arena.degenerate()?;
    cases.extend(arena.meshes()?);
    Ok(cases)
}
