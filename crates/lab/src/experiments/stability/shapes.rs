//! Walls and objects of awkward sizes and places, around one wall in the middle of an arena.

use glam::Vec3;

use super::arena::{ARENA, Arena, CELL, FRONT, HALF, brick, sheet, wall};
use super::case::{Case, Known, block, box_mesh, glass, mesh, quad, solid, sphere};
use crate::experiments::LabError;
use casca_scenes::world::{Object, Shape};

/// The thickness of the thinnest wall that is a solid, in cells.
const THIN: f32 = 1e-3;
/// What a tile lacks on each side, as a share of half the wall: of 6 m, 0.1 mm between two tiles.
const GAP: f32 = 8e-6;

impl Arena<'_> {
    /// Walls from thick to no thickness at all.
    pub(super) fn thin(&self) -> Result<Vec<Case>, LabError> {
        let between = block(
            Vec3::new(-HALF.x, -HALF.y, FRONT - CELL * 1.45),
            Vec3::new(HALF.x, HALF.y, FRONT - CELL * 0.45),
        );
        self.walls([
            ("wall 4 cells thick", wall(4.0 * CELL)),
            ("wall 1/2 cell thick", wall(0.5 * CELL)),
            ("wall 1/10 cell thick", wall(0.1 * CELL)),
            ("wall 1/1000 cell thick", wall(THIN * CELL)),
            ("wall a box without thickness", wall(0.0)),
            ("wall a mesh sheet", sheet(1, 1, |_, _| true)),
            ("wall 1 cell thick between planes", between),
        ])
    }

    /// Solids that share faces, planes or all of their surface.
    pub(super) fn touching(&self) -> Result<Vec<Case>, LabError> {
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
        let mut cases = self.walls([("wall of one box", wall(thick))])?;
        for (name, objects) in [
            ("wall of 96 boxes that touch", tiles(12, 8, 0.0, &boxes)),
            ("wall of 96 closed meshes that touch", tiles(12, 8, 0.0, &closed)),
            ("wall of 96 sheets that share edges", tiles(12, 8, 0.0, &flat)),
            ("wall of 96 boxes 0.1 mm apart", tiles(12, 8, GAP, &boxes)),
            ("wall of 96 sheets 0.1 mm apart", tiles(12, 8, GAP, &flat)),
            ("wall of 96 boxes that overlap, coplanar", tiles(12, 8, -0.02, &boxes)),
            ("three equal walls", vec![solid("wall", wall(thick)); 3]),
        ] {
            cases.push(self.with(name, objects)?);
        }
        let mut dice = self.dice(6);
        let mut posters = vec![solid("wall", wall(thick))];
        for i in 0..40 {
            let at = dice.point(-HALF, HALF);
            let (w, h) = (dice.range(0.1, 0.8), dice.range(0.1, 0.8));
            let (near, far) = match i % 4 {
                // Before the wall's front, touching it; in its plane; through it; behind it,
                // touching it.
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
    pub(super) fn nested(&self) -> Result<Vec<Case>, LabError> {
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
        cases.push(self.with("objects that hide nothing", objects)?.with_known(front(1, 1, 0.2)));
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
    pub(super) fn sizes(&self) -> Result<Vec<Case>, LabError> {
        let plain = vec![solid("wall", wall(4.0 * CELL))];
        let mut cases = vec![self.with("objects of usual sizes", plain.clone())?];
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
}
