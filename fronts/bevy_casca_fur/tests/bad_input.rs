//! Meshes, materials and settings that are wrong: no fur, no panic, and fur again once they are right.

mod common;

use bevy_asset::{Assets, RenderAssetUsages};
use bevy_casca_fur::ATTRIBUTE_FUR_LENGTH;
use bevy_math::{Quat, Vec3};
use bevy_mesh::{Indices, Mesh, Mesh3d, PrimitiveTopology};
use bevy_shape::Cuboid;
use bevy_transform::components::Transform;
use casca_fur::glam;
use casca_fur::strands::Fur;
use common::*;

fn good() -> Mesh {
    Cuboid::new(1.0, 1.0, 1.0).into()
}

fn positions(values: Vec<[f32; 3]>) -> Mesh {
    good().with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, values)
}

/// Meshes that get no fur.
fn bad() -> Vec<Mesh> {
    let list = |topology| Mesh::new(topology, RenderAssetUsages::default());
    let mut nan = vec![[0.5; 3]; 24];
    nan[7][1] = f32::NAN;
    let mut endless = vec![[0.5; 3]; 24];
    endless[0][0] = f32::INFINITY;
    vec![
        good().with_removed_attribute(Mesh::ATTRIBUTE_NORMAL),
        good().with_removed_attribute(Mesh::ATTRIBUTE_POSITION),
        list(PrimitiveTopology::TriangleList),
        list(PrimitiveTopology::TriangleStrip),
        list(PrimitiveTopology::LineList),
        positions(nan.clone()),
        positions(endless),
        positions(vec![[0.0; 3]; 5]),
        good().with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, nan),
        good().with_inserted_attribute(ATTRIBUTE_FUR_LENGTH, vec![f32::NAN; 24]),
        good().with_inserted_attribute(ATTRIBUTE_FUR_LENGTH, vec![1.0f32; 3]),
        good().with_inserted_indices(Indices::U32(vec![0, 1, 24])),
        good().with_inserted_indices(Indices::U16(vec![0, 1])),
        list(PrimitiveTopology::TriangleList)
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, Vec::<[f32; 3]>::new())
            .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, Vec::<[f32; 3]>::new()),
    ]
}

#[test]
fn unfit_meshes_have_no_fur_until_they_are_mended() {
    let mut app = app();
    camera(&mut app);
    let fur = material(&mut app, fur());
    for (i, mesh) in bad().into_iter().enumerate() {
        let handle = add(&mut app, mesh);
        let animal = animal(&mut app, &handle, &fur, Vec3::new(0.0, 0.0, -4.0));
        run(&mut app, 3);
        assert_eq!(layers(&mut app, animal), None, "mesh {i}");
        let put = |app: &mut bevy_app::App, mesh| {
            app.world_mut().resource_mut::<Assets<Mesh>>().insert(&handle, mesh).unwrap();
            run(app, 3);
        };
        put(&mut app, good());
        assert!(layers(&mut app, animal).is_some_and(|(layers, _)| layers > 0), "mesh {i}");
        // Worse again, and gone.
        put(&mut app, positions(vec![[f32::NAN; 3]; 24]));
        assert_eq!(layers(&mut app, animal), None, "mesh {i}");
        put(&mut app, good());
        app.world_mut().resource_mut::<Assets<Mesh>>().remove(&handle);
        run(&mut app, 3);
        assert_eq!(layers(&mut app, animal), None, "mesh {i}");
    }
}

#[test]
fn odd_fur_places_and_settings_do_no_harm() {
    let mut app = app();
    camera(&mut app);
    let ball = ball(&mut app);
    let good_fur = material(&mut app, fur());
    let furs = [
        Fur { height: f32::NAN, ..fur() },
        Fur { height: -1.0, ..fur() },
        Fur { spacing: 0.0, ..fur() },
        Fur { spacing: 1e-12, ..fur() },
        Fur { radius: f32::INFINITY, ..fur() },
        Fur { per_cell: u32::MAX, ..fur() },
        Fur { bend: glam::Vec3::NAN, ..fur() },
    ];
    for (i, fur) in furs.into_iter().enumerate() {
        let fur = material(&mut app, fur);
        let animal = animal(&mut app, &ball, &fur, Vec3::new(0.0, 0.0, -4.0));
        run(&mut app, 3);
        assert_eq!(layers(&mut app, animal), None, "fur {i}");
    }
    let places = [
        Transform::from_scale(Vec3::ZERO),
        Transform::from_scale(Vec3::new(-1.0, f32::NAN, 1e30)),
        Transform::from_xyz(f32::NAN, 0.0, 0.0),
        Transform::from_xyz(f32::INFINITY, 0.0, f32::NEG_INFINITY),
        Transform::from_rotation(Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)),
        Transform::from_scale(Vec3::splat(1e38)),
    ];
    let animals = places.map(|place| {
        let animal = animal(&mut app, &ball, &good_fur, Vec3::ZERO);
        app.world_mut().entity_mut(animal).insert(place);
        animal
    });
    for (budget, weight) in
        [(f64::NAN, 1.0), (-1.0, 1.0), (1e3, f64::NAN), (1e3, -1.0), (0.0, 1.0), (1e300, 1e300)]
    {
        settings(&mut app).budget = budget;
        settings(&mut app).pixel_weight = weight;
        settings(&mut app).most_layers = u32::MAX;
        run(&mut app, 3);
        for animal in animals {
            assert!(layers(&mut app, animal).is_some_and(|(layers, _)| layers <= 256));
        }
    }
}

#[test]
fn large_meshes_get_fewer_layers() {
    let flat = |count| {
        Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, vec![[0.0, 0.0, 1.0]; count])
            .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0, 0.0, 1.0]; count])
    };
    let mut app = app();
    camera(&mut app);
    let fur = material(&mut app, fur());
    for (count, most) in [(1_200_000, Some((3, false))), (4_200_000, None)] {
        let handle = add(&mut app, flat(count));
        let animal = animal(&mut app, &handle, &fur, Vec3::new(0.0, 0.0, -3.0));
        run(&mut app, 3);
        assert_eq!(layers(&mut app, animal), most);
        assert!(app.world().get::<Mesh3d>(animal).is_some_and(|mesh| mesh.0 == handle));
    }
}
