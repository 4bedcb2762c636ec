use glam::Vec3;

use super::measure::{Walks, measure};
use super::worlds;
use casca::Method;
use casca_scenes::world::{Shape, World};
use casca_truth::oracle::ItemBuffer;

/// The objects that an item buffer of this width shows from the first frame.
fn visible(world: &World, width: usize) -> usize {
    let mut buffer = ItemBuffer::new(width, width * 9 / 16);
    buffer.render(&world.objects, &world.camera(0, 16.0 / 9.0));
    buffer.visible().iter().filter(|pixels| **pixels > 0).count()
}

#[test]
fn all_spheres_of_the_shell_are_visible_and_found() {
    for count in [10, 100, 1000] {
        let world = worlds::shell(count, 3);
        assert_eq!((world.objects.len(), visible(&world, 1280)), (count, count));
        let row = measure(&world, 0.0, Method::point(), Walks { views: 3, repeats: 1 }).unwrap();
        assert_eq!((row.found, row.in_frustum), (count as f64, count as f64));
        assert!(row.memory > 0.0 && row.point.p99 >= row.point.median && row.point.median > 0.0);
    }
}

#[test]
fn the_ground_has_the_same_hills_at_every_number_of_triangles() {
    let heights = |triangles: usize| -> Vec<Vec3> {
        let world = worlds::ground(triangles, 7);
        let meshes: Vec<_> = world
            .objects
            .iter()
            .filter_map(|o| if let Shape::Mesh { mesh, .. } = &o.shape { Some(mesh.clone()) } else { None })
            .collect();
        let all: usize = meshes.iter().map(|m| m.triangles.len()).sum();
        assert!((all as f64 / triangles as f64 - 1.0).abs() < 0.2, "{all} of {triangles}");
        // The corners of the tiles are vertices at any resolution.
        meshes.iter().map(|m| m.positions[0]).collect()
    };
    assert_eq!(heights(800), heights(20_000));
    let world = worlds::ground(20_000, 7);
    let seen = visible(&world, 640);
    assert!(seen > 20 && seen < 1500, "the hills hide most: {seen}");
}

#[test]
fn scattered_spheres_stay_in_their_cube() {
    let world = worlds::scatter(500, 2);
    let inside = |o: &casca_scenes::world::Object| match o.shape {
        Shape::Sphere { center, radius } => {
            (center - radius).cmpge(world.grid.min).all() && (center + radius).cmple(world.grid.max).all()
        }
        _ => false,
    };
    assert!(world.objects.len() == 500 && world.objects.iter().all(inside));
}

#[test]
fn soups_share_no_vertices() {
    let soup = worlds::soup(50, 1);
    assert_eq!((soup.triangles.len(), soup.positions.len()), (50, 150));
    let mut used: Vec<u32> = soup.triangles.iter().flatten().copied().collect();
    used.sort_unstable();
    assert!(used.iter().copied().eq(0..150));
}
