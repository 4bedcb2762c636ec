//! Meshes, materials and settings that are wrong: no fur, no panic, and fur again once they are right.

mod common;

use bevy_asset::{Assets, RenderAssetUsages};
use bevy_casca_fur::{ATTRIBUTE_FUR_LAYER, ATTRIBUTE_FUR_LENGTH, Unfit, shells as shells_of};
use bevy_math::{Quat, Vec3};
use bevy_mesh::{Indices, Mesh, Mesh3d, Meshable, PrimitiveTopology};
use bevy_shape::{Cuboid, Sphere};
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

/// Meshes that get no fur, and why.
fn bad() -> Vec<(Mesh, Unfit)> {
    let list = |topology| Mesh::new(topology, RenderAssetUsages::default());
    let mut nan = vec![[0.5; 3]; 24];
    nan[7][1] = f32::NAN;
    let mut endless = vec![[0.5; 3]; 24];
    endless[0][0] = f32::INFINITY;
    vec![
        (good().with_removed_attribute(Mesh::ATTRIBUTE_NORMAL), Unfit::Normals),
        (good().with_removed_attribute(Mesh::ATTRIBUTE_POSITION), Unfit::Positions),
        (list(PrimitiveTopology::TriangleList), Unfit::Positions),
        (list(PrimitiveTopology::TriangleStrip), Unfit::Topology),
        (list(PrimitiveTopology::LineList), Unfit::Topology),
        (positions(nan.clone()), Unfit::NotFinite),
        (positions(endless), Unfit::NotFinite),
        (positions(vec![[0.0; 3]; 5]), Unfit::Normals),
        (good().with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, nan), Unfit::NotFinite),
        (good().with_inserted_attribute(ATTRIBUTE_FUR_LENGTH, vec![f32::NAN; 24]), Unfit::NotFinite),
        (good().with_inserted_attribute(ATTRIBUTE_FUR_LENGTH, vec![1.0f32; 3]), Unfit::Lengths),
        (good().with_inserted_indices(Indices::U32(vec![0, 1, 24])), Unfit::Indices),
        (good().with_inserted_indices(Indices::U16(vec![0, 1])), Unfit::Empty),
        (
            list(PrimitiveTopology::TriangleList)
                .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, Vec::<[f32; 3]>::new())
                .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, Vec::<[f32; 3]>::new()),
            Unfit::Empty,
        ),
    ]
}

#[test]
fn unfit_meshes_have_no_fur_until_they_are_mended() {
    let mut app = app();
    camera(&mut app);
    let fur = material(&mut app, fur());
    for (i, (mesh, why)) in bad().into_iter().enumerate() {
        assert_eq!(shells_of(&mesh, 4).err(), Some(why), "mesh {i}");
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
fn all_kinds_of_indices_give_the_same_layers_outermost_first() {
    let mesh = Sphere::new(1.0).mesh().uv(6, 4);
    let vertices = mesh.count_vertices();
    let short = match mesh.indices() {
        Some(Indices::U32(long)) => long.iter().map(|&i| i as u16).collect(),
        Some(Indices::U16(short)) => short.clone(),
        None => panic!("no indices"),
    };
    let long: Vec<u32> = short.iter().map(|&i| i.into()).collect();
    let of = |mesh: &Mesh| -> (Vec<[f32; 3]>, Vec<usize>) {
        (floats(mesh, ATTRIBUTE_FUR_LAYER), mesh.indices().unwrap().iter().collect())
    };
    let (marks, indices) =
        of(&shells_of(&mesh.clone().with_inserted_indices(Indices::U16(short)), 5).unwrap());
    let same = of(&shells_of(&mesh.clone().with_inserted_indices(Indices::U32(long)), 5).unwrap());
    assert_eq!((&marks, &indices), (&same.0, &same.1));
    assert_eq!((marks.len(), indices.len()), (5 * vertices, 5 * mesh.indices().unwrap().len()));
    assert!(indices.iter().all(|&i| i < 5 * vertices));
    assert!(
        marks.chunks(vertices).zip((1..=5).rev()).all(|(c, k)| c.iter().all(|m| *m == [k as f32, 5.0, 1.0]))
    );
    // The triangles of a layer keep to their layer, tips first.
    let layers: Vec<usize> = indices.chunks(3).map(|t| t[0] / vertices).collect();
    assert!(
        layers.is_sorted() && indices.chunks(3).all(|t| t.iter().all(|i| i / vertices == t[0] / vertices))
    );
    // Without indices: three vertices are a triangle.
    let loose = mesh.clone().with_duplicated_vertices();
    let (marks, indices) = of(&shells_of(&loose, 2).unwrap());
    assert_eq!((marks.len(), indices), (2 * loose.count_vertices(), (0..marks.len()).collect::<Vec<_>>()));
    // None is one layer, and too many are 256.
    assert_eq!(of(&shells_of(&loose, 0).unwrap()).0.len(), loose.count_vertices());
    assert_eq!(of(&shells_of(&loose, u32::MAX).unwrap()).0.len(), 256 * loose.count_vertices());
}

#[test]
fn bald_skin_and_vertices_without_normals_have_no_length() {
    let mut lengths = vec![2.0f32; 24];
    (lengths[0], lengths[1], lengths[2]) = (0.0, 0.25, -3.0);
    let mut normals = vec![[0.0, 3.0, 0.0]; 24];
    normals[3] = [0.0; 3];
    let mesh = good()
        .with_inserted_attribute(ATTRIBUTE_FUR_LENGTH, lengths)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals);
    let all = shells_of(&mesh, 3).unwrap();
    let found: Vec<f32> = floats(&all, ATTRIBUTE_FUR_LAYER)[..6].iter().map(|mark| mark[2]).collect();
    assert_eq!(found, [0.0, 0.25, 0.0, 0.0, 1.0, 1.0]);
    let normals = floats(&all, Mesh::ATTRIBUTE_NORMAL);
    assert!(normals.iter().all(|n| *n == [0.0, 1.0, 0.0]), "normals are of unit length");
}

#[test]
fn large_meshes_get_fewer_layers() {
    let flat = |count| {
        Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, vec![[0.0, 0.0, 1.0]; count])
            .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0, 0.0, 1.0]; count])
    };
    let count = 1_200_000;
    let mesh = flat(count);
    assert_eq!(shells_of(&mesh, 32).unwrap().count_vertices(), 3 * count);
    let mut app = app();
    camera(&mut app);
    let (handle, fur) = (add(&mut app, mesh), material(&mut app, fur()));
    let animal = animal(&mut app, &handle, &fur, Vec3::new(0.0, 0.0, -3.0));
    run(&mut app, 3);
    assert_eq!(layers(&mut app, animal), Some((3, false)));
    assert!(app.world().get::<Mesh3d>(animal).is_some_and(|mesh| mesh.0 == handle));
    assert_eq!(shells_of(&flat(4_200_000), 1).err(), Some(Unfit::TooLarge));
}
