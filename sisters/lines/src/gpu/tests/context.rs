//! Meshes among the lines hide lines, in the picture and in the scene of bundles.

use std::f32::consts::{PI, TAU};

use super::*;
use crate::gpu::context::GREY;
use crate::mesh::Mesh;
use crate::view::Lens;

/// A ball with bumps: closed, not convex.
fn bumpy(radius: f32) -> Mesh {
    const SIDES: u32 = 96;
    let place = |i: u32| {
        let (sine, cosine) = ((i % SIDES) as f32 / SIDES as f32 * TAU).sin_cos();
        let (out, up) = ((i / SIDES) as f32 / SIDES as f32 * PI).sin_cos();
        let n = vec3(out * cosine, up, out * sine);
        n * radius * (0.85 + 0.15 * (7.0 * n.x).sin() * (5.0 * n.y).cos() * (6.0 * n.z).cos())
    };
    let square = |i: u32| {
        let (ring, side, next) = (i / SIDES * SIDES, i % SIDES, (i + 1) % SIDES);
        [ring + side, ring + next, ring + SIDES + next, ring + SIDES + side]
    };
    let squares: Vec<[u32; 4]> = (0..SIDES * SIDES).map(square).collect();
    let places = (0..SIDES * (SIDES + 1)).map(place).collect();
    Mesh::of_polygons(places, squares.iter().map(|s| &s[..]))
}

#[test]
fn a_slanted_mesh_hides_the_lines_behind_it_and_no_others() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let lines = wild(3);
    let on_device = GpuLines::new(&gpu, &lines, &of_margin(0.04)).unwrap();
    // Heights above the plane are distances to it.
    let (normal, side) = (vec3(0.3, 0.2, 1.0).normalize(), vec3(1.0, 0.0, -0.3).normalize());
    let corner = |u: f32, v: f32| (side * u + normal.cross(side) * v) * 60.0;
    let square = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let mesh = Mesh::of_polygons(square, [&[0, 1, 2, 3][..]]);
    let context = [GpuContext::new(&gpu, &Context::new(mesh, GREY).unwrap()).unwrap()];
    let (mut kept, mut lost) = (0, 0);
    for view in views([-Vec3::ONE, Vec3::ONE]) {
        let mut renderer = Renderer::new(&gpu, COLOUR, Settings::new(0.3, 0.01)).unwrap();
        let mut shown = |context: &[GpuContext]| {
            let seen = Seen::all(on_device.bundles().len());
            renderer.update(&gpu, &view, (&on_device, &seen), context, &mut Clock::off()).unwrap();
            renderer.read_fragments(&gpu).unwrap()
        };
        let (free, hidden) = (shown(&[]), shown(&context));
        let [near, far] = view.depths();
        // A line may lie 0.71 pixels beside the middle of its pixel, where the plane is another.
        let pixel = view.pixel_size(far) as f32;
        let height = |at: &Fragment| view.to_world(at.position).as_vec3().dot(normal);
        for (free, hidden) in free.iter().zip(&hidden) {
            if let Some(free) = free.as_ref().filter(|f| height(f) > 2.0 * pixel) {
                assert_eq!(hidden.as_ref(), Some(free));
                kept += 1;
            }
            if let Some(hidden) = hidden {
                assert!(height(hidden) > -2.0 * pixel, "{hidden:?} {near}");
            }
            lost += usize::from(free.is_some() && hidden.is_none());
        }
    }
    assert!(kept > 1000 && lost > 400, "{kept} {lost}");
}

#[test]
fn pictures_with_and_without_bundles_behind_meshes_are_the_same_in_every_pixel() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let lines = Recipe { lines: 400, ..Recipe::new(Family::Abc, 3) }.make().unwrap();
    let squares = Mesh::of_polygons(
        [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)].map(|(x, z)| vec3(x, 0.2 * x, z)).to_vec(),
        [&[0, 1, 2, 3][..]],
    );
    for mesh in [bumpy(0.9), squares] {
        let settings = Settings { samples: 8, ..Settings::new(0.2, 0.01) };
        let mut culled = Culled::new(&gpu, &lines, &[Context::new(mesh, GREY).unwrap()], settings);
        let mut drawn = 0;
        // From all around, close to the surface, and with a near plane that cuts into it.
        let eyes = [(vec3(0.4, 0.9, 2.4), 0.1), (vec3(-2.0, -0.5, 0.4), 0.1), (vec3(0.1, 1.2, 0.2), 0.05)];
        let all = eyes.into_iter().chain([(vec3(0.2, 1.5, 1.0), 1.2), (vec3(0.1, 0.1, 0.2), 0.01)]);
        for (eye, near) in all {
            for lens in [Lens::Perspective { fov_y: 0.9 }, Lens::Orthographic { half_height: 1.3 }] {
                let view = View::look_at([eye, Vec3::ZERO, Vec3::Y], lens, [near, 5.0], [160, 120]).unwrap();
                drawn += culled.changes_nothing(&view).0;
            }
        }
        let share = 1.0 - drawn as f64 / (10 * culled.lines.bundles().len()) as f64;
        println!("{share:.2} of the bundles hidden");
        assert!(share > 0.15, "{share}");
    }
}

#[test]
fn meshes_that_hide_nothing_or_cannot_are_refused_or_harmless() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let corners = || vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let mesh = |positions, triangles| Context::new(Mesh { positions, triangles }, GREY);
    assert!(mesh(corners(), vec![]).is_err() && mesh(vec![], vec![]).is_err());
    assert!(mesh(corners(), vec![[0, 1, 3]]).is_err());
    assert!(mesh(vec![Vec3::ZERO, Vec3::X, Vec3::Y * f32::NAN], vec![[0, 1, 2]]).is_err());
    let lines = set(Family::Spiral, 5);
    let on_device = GpuLines::new(&gpu, &lines, &of_margin(0.04)).unwrap();
    let flat = mesh(corners(), vec![[0, 1, 1]]).unwrap();
    let none = [Context::of_boxes(&[]), flat];
    let [view, _] = views(lines.bounds());
    let mut culling = Culling::new(on_device.bundles(), &none).unwrap();
    let with = Settings::new(0.3, 0.01);
    let seen = culling.look(&view, with.reach(&view)).unwrap();
    assert_eq!(seen, Seen::all(on_device.bundles().len()));
    let none = none.map(|c| GpuContext::new(&gpu, &c).unwrap());
    let mut renderer = Renderer::new(&gpu, COLOUR, with).unwrap();
    let mut shown = |context: &[GpuContext]| {
        renderer.update(&gpu, &view, (&on_device, &seen), context, &mut Clock::off()).unwrap();
        renderer.read_fragments(&gpu).unwrap()
    };
    assert!(shown(&none) == shown(&[]));
}
