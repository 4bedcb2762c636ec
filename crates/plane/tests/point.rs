//! `Method::Point` against exact visibility in rational arithmetic.

mod common;
mod oracle;

use casca_plane::{GridSpec, ObjectDesc, ObjectId, Query, Scene, Shape, View};
use common::cases;
use common::forms::{occluder, shape, target};
use glam::{UVec2, Vec2};
use num_traits::Zero;
use oracle::{Form, Look, Number, Point, Region, number};
use proptest::prelude::*;

/// A scene with the oracle's view of it.
struct Twin {
    scene: Scene,
    ids: Vec<ObjectId>,
    shapes: Vec<Shape>,
    blocking: Vec<Form>,
}

impl Twin {
    /// Objects, each with whether it hides others.
    fn new(spec: &GridSpec, objects: &[(Shape, bool)]) -> Self {
        let mut scene = Scene::new(spec).unwrap();
        let ids = objects.iter().map(|(shape, hides)| {
            let desc = ObjectDesc::fixed(shape.clone());
            scene.insert(if *hides { desc.occluder(shape.clone()) } else { desc }).unwrap()
        });
        let ids = ids.collect();
        let blocking = objects.iter().filter(|(_, hides)| *hides).map(|(shape, _)| occluder(shape)).collect();
        Self { scene, ids, shapes: objects.iter().map(|(shape, _)| shape.clone()).collect(), blocking }
    }

    /// Compares all answers for an eye that looks all round.
    fn check(&self, eye: Vec2, points: &[Vec2]) -> Result<(), TestCaseError> {
        let region = Region::new(&Point::of(eye), &self.blocking, &Look::default());
        let mut query = Query::new();
        query.run(&self.scene, &View::all_round(eye).unwrap());
        for (id, shape) in self.ids.iter().zip(&self.shapes) {
            let form = target(shape);
            let seen = query.pvs().contains(*id);
            let least = region.meets(&form, &Number::zero());
            prop_assert!(seen || !least, "{shape:?} is lost from {eye}");
            let most = least || matches!(form, Form::Disc(..)) && region.meets(&form, &number(1e-6));
            prop_assert!(!seen || most, "{shape:?} is not visible from {eye}");
            prop_assert_eq!(query.sees(shape.clone()).unwrap(), seen);
        }
        for &p in points {
            let seen = region.meets(&Form::Chain(vec![Point::of(p), Point::of(p)]), &Number::zero());
            prop_assert_eq!(query.sees_point(p), seen, "the point {} from {}", p, eye);
        }
        Ok(())
    }
}

fn spec(min: f32, cell: f32, cells: u32) -> GridSpec {
    GridSpec { min: Vec2::splat(min), cell, dims: UVec2::splat(cells) }
}

/// Points with small integer coordinates: many of them are the same, or on one line.
fn lattice() -> impl Strategy<Value = Vec2> + Clone {
    (0..8i32, 0..8i32).prop_map(|(x, y)| Vec2::new(x as f32, y as f32))
}

/// Grids that hold all, or some, of the points from 0 to 8.
fn grids() -> impl Strategy<Value = GridSpec> {
    prop_oneof![
        Just(spec(-1.0, 1.0, 10)),
        Just(spec(-0.5, 0.5, 18)),
        Just(spec(-10.0, 3.0, 10)),
        Just(spec(2.0, 0.75, 5)),
        Just(spec(20.0, 1.0, 8)),
    ]
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn small_integers(
        grid in grids(),
        objects in proptest::collection::vec((shape(lattice(), false), any::<bool>()), 1..8),
        eye in lattice(),
        half in any::<bool>(),
        points in proptest::collection::vec(lattice(), 6),
    ) {
        let eye = if half { eye + Vec2::new(0.5, 0.0) } else { eye };
        Twin::new(&grid, &objects).check(eye, &points)?;
    }
}
