//! Arguments that make no sense, and places far away.

use casca::soft::{Cone, Layer, March, SoftGrid, VisibilityVolume};
use casca::{Aabb, Error, GridSpec, Light, Sphere, TriMesh};
use casca_truth::cases;
use glam::{UVec3, Vec3};
use proptest::prelude::*;

use crate::soft;

const BAD: [f32; 3] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];

#[test]
fn refuses_what_makes_no_sense() {
    let spec = |dims| GridSpec { min: Vec3::ZERO, cell: 1.0, dims };
    assert!(matches!(SoftGrid::new(&spec(UVec3::splat(2048))), Err(Error::SoftGridCells { .. })));
    assert!(matches!(SoftGrid::new(&spec(UVec3::splat(1 << 20))), Err(Error::GridDims { .. })));
    assert!(matches!(SoftGrid::new(&spec(UVec3::new(0, 1, 1))), Err(Error::GridDims { .. })));
    let mut grid = soft(UVec3::splat(16));
    let id = grid.insert(Sphere::new(Vec3::splat(8.0), 3.0), Layer::Fixed).unwrap();
    let mut other = soft(UVec3::splat(16));
    assert!(matches!(other.remove(id), Err(Error::UnknownShape(_))));
    let occupied =
        |g: &SoftGrid| (0..16).filter(|&i| g.is_occupied(Layer::Fixed, glam::IVec3::splat(i))).count();
    let before = occupied(&grid);
    assert!(grid.update(id, Sphere::new(Vec3::ZERO, f32::NAN)).is_err());
    assert!(grid.update(id, Aabb { min: Vec3::ONE, max: Vec3::ZERO }).is_err());
    assert_eq!(occupied(&grid), before);
    let ball = Sphere::new(Vec3::splat(8.0), 1.0);
    let cone = Cone { apex: Vec3::ONE, direction: Vec3::X, tan: 0.3, reach: 9.0 };
    for bad in BAD {
        let v = Vec3::new(0.0, bad, 1.0);
        assert!(grid.first_hit(v, Vec3::ONE).is_err() && grid.first_hit(Vec3::ONE, v).is_err());
        assert!(grid.visible_fraction(v, ball, 8).is_err());
        assert!(grid.ambient_occlusion(v, Vec3::X, 1.0, &March::Slabs).is_err());
        assert!(grid.ambient_occlusion(Vec3::X, v, 1.0, &March::Slabs).is_err());
        assert!(VisibilityVolume::new(&grid, &Light::directional(v), 1).is_err());
        for cone in [Cone { apex: v, ..cone }, Cone { direction: v, ..cone }, Cone { tan: bad, ..cone }] {
            assert!(grid.cone(&cone, &March::Slabs).is_err(), "{cone:?}");
        }
        let march = March::Samples { step: bad, start: 0.0, first: 1.0, corrected: true };
        assert!(grid.cone(&cone, &march).is_err());
    }
    assert!(matches!(
        grid.cone(&Cone { direction: Vec3::ZERO, ..cone }, &March::Slabs),
        Err(Error::NoDirection { .. })
    ));
    assert!(grid.cone(&Cone { reach: f32::NAN, ..cone }, &March::Slabs).is_err());
    for rays in [0, u32::MAX] {
        assert!(grid.visible_fraction(Vec3::ONE, ball, rays).is_err());
        assert!(grid.cone(&cone, &March::Rays(rays)).is_err());
    }
}

/// Numbers of all sizes.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![-3.0f32..19.0, Just(0.0), Just(8.0), Just(3e38), Just(-3e38), Just(1e-40), -1e6f32..1e6]
}

fn vector() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(number()).prop_map(Vec3::from)
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn all_finite_arguments_get_an_answer(
        points in prop::collection::vec(vector(), 6),
        direction in vector(),
        radius in prop_oneof![0.0f32..10.0, Just(3e38)],
        tan in 0.001f32..10.0,
        step in 0.01f32..4.0,
    ) {
        let mut grid = soft(UVec3::new(16, 9, 5));
        grid.insert(Sphere::new(points[0], radius), Layer::Moving).unwrap();
        let (min, max) = (points[1].min(points[2]), points[1].max(points[2]));
        grid.insert(Aabb { min, max }, Layer::Fixed).unwrap();
        let mesh = TriMesh::bounds_only(points[..3].to_vec(), vec![[0, 1, 2]]).unwrap();
        grid.insert(std::sync::Arc::new(mesh), Layer::Fixed).unwrap();
        grid.rebuild();
        let share = |v: f32| (0.0..=1.0).contains(&v);
        for march in [March::Slabs, March::Rays(5), March::Samples { step, start: 0.0, first: 0.25, corrected: true }] {
            for reach in [0.0, 7.0, f32::INFINITY] {
                let cone = Cone { apex: points[3], direction, tan, reach };
                match grid.cone(&cone, &march) {
                    Ok(answer) => prop_assert!(share(answer.transmittance), "{cone:?} {march:?} {answer:?}"),
                    Err(error) => prop_assert!(matches!(error, Error::NoDirection { .. }), "{error}"),
                }
                if let Ok(hidden) = grid.ambient_occlusion(points[4], direction, reach, &march) {
                    prop_assert!(share(hidden), "{hidden} {march:?}");
                }
            }
        }
        let ball = Sphere::new(points[5], radius);
        let shapes = [
            grid.visible_fraction(points[4], ball, 9),
            grid.visible_fraction(points[4], Aabb { min, max }, 9),
        ];
        for seen in shapes {
            let seen = seen.unwrap();
            prop_assert!(share(seen.least) && share(seen.most) && seen.least <= seen.most, "{seen:?}");
        }
        grid.first_hit(points[3], points[5]).unwrap();
        let lamp = Light::point(points[5], radius);
        let volume = VisibilityVolume::new(&grid, &lamp, 2).unwrap();
        prop_assert!(volume.smooth(points[3]).is_none_or(|v| (0.0..=1.0001).contains(&v)));
    }
}
