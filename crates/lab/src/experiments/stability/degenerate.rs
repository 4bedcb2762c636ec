//! Degenerate meshes in the place of one wall, meshes in place of boxes, and views along walls.

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};

use super::arena::{Arena, CELL, FRONT, HALF, sheet};
use super::case::{ASPECT, Case, Shot, block, box_mesh, glass, mesh, placed, quad, solid, sphere, still};
use crate::experiments::LabError;
use casca_scenes::world::{Camera, FRAME_SECONDS, Mesh, Motion, Object, Shape};

/// The width of needles, in metres: far less than a pixel, far more than rounding.
const NEEDLE: f32 = 1e-5;

/// A mesh with other triangles between its vertices.
fn of_triangles(shape: &Shape, change: impl Fn(&[[u32; 3]]) -> Vec<[u32; 3]>) -> Shape {
    let Shape::Mesh { mesh: old, .. } = shape else { return shape.clone() };
    mesh(old.positions.clone(), change(&old.triangles))
}

impl Arena<'_> {
    /// Meshes that are none, or bad ones, as occluders.
    fn degenerate(&self) -> Result<Vec<Case>, LabError> {
        let mut dice = self.dice(9);
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
        let (least, most) = ((-HALF).with_z(FRONT), HALF.with_z(FRONT));
        let both = [&lines[..], &[[least, least.with_x(HALF.x), most]]].concat();
        let needle = |_| {
            let (a, b) = (at(HALF), at(HALF));
            [a, b, b + Vec3::new(NEEDLE, NEEDLE, 0.0)]
        };
        let needles: Vec<[Vec3; 3]> = (0..300).map(needle).collect();
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
        let soup = |corners: &[[Vec3; 3]]| {
            let positions = corners.iter().flatten().copied().collect();
            mesh(positions, (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
        };
        let turned = |&[a, b, c]: &[u32; 3]| [c, b, a];
        let mut holes = self.dice(10);
        let whole = sheet(8, 6, |_, _| true);
        let closed = box_mesh(least.with_z(FRONT - 4.0 * CELL), most);
        let cases = [
            ("mesh wall, 8 x 6 quads", whole.clone()),
            ("triangles without area", soup(&lines)),
            ("triangles without area in a wall's mesh", soup(&both)),
            ("needles 0.01 mm wide", soup(&needles)),
            (
                "every triangle three times, also turned over",
                of_triangles(&whole, |all| {
                    let again = all.iter().map(|&[a, b, c]| [b, c, a]);
                    all.iter().copied().chain(all.iter().map(turned)).chain(again).collect()
                }),
            ),
            ("T-junctions", soup(&junctions)),
            ("sheet of 48 x 32 quads, a fifth missing", sheet(48, 32, |_, _| holes.range(0.0, 1.0) < 0.8)),
            ("closed box mesh without thickness", box_mesh(least, most)),
            ("box mesh inside out", of_triangles(&closed, |all| all.iter().map(turned).collect())),
            ("box mesh that lacks a triangle", of_triangles(&closed, |all| all[1..].to_vec())),
        ];
        self.walls(cases)
    }

    /// Eyes close to the plane of a long wall, looking along it.
    pub(super) fn grazing(&self) -> Result<Vec<Case>, LabError> {
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
                // The wall's face looks towards greater x, and it runs past the eye; small things
                // stick to both of its sides.
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
                let case =
                    Case::new(format!("eye {away} m off the face of {what}"), objects, CELL, still(cameras));
                cases.push(case);
            }
        }
        Ok(cases)
    }

    /// Degenerate occluders, and meshes in place of boxes, at rest and turning.
    pub(super) fn meshes(&self) -> Result<Vec<Case>, LabError> {
        let mut dice = self.dice(13);
        let boxes: Vec<(Vec3, Vec3)> = (0..60)
            .map(|_| {
                let at = dice.point(Vec3::new(-9.0, -6.0, -12.0), Vec3::new(9.0, 6.0, -6.0));
                (at, dice.point(Vec3::splat(0.2), Vec3::splat(1.2)))
            })
            .collect();
        let plain = boxes.iter().map(|&(p, s)| solid("box", block(p - s, p + s))).collect();
        let closed = boxes.iter().map(|&(p, s)| solid("mesh", box_mesh(p - s, p + s))).collect();
        let mut cases = self.degenerate()?;
        cases.extend([self.with("60 boxes", plain)?, self.with("60 boxes as meshes", closed)?]);
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
