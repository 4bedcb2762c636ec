//! Ways of shadows among strands against rays towards the sun.

use casca_fur::gpu::look::{Look, sky_pixel};
use casca_fur::gpu::reference::{Reference, SelfShadow};
use casca_fur::mesh::{Mesh, Vertex};
use casca_fur::strands::Fur;
use casca_scenes::world;
use casca_stage::camera::Camera;
use glam::Vec3;

const SIZE: (u32, u32) = (120, 90);

fn rmse(a: &[u8], b: &[u8]) -> f64 {
    let sky = sky_pixel();
    let seen = || a.chunks(4).zip(b.chunks(4)).filter(|(a, _)| *a != sky);
    let square = |(a, b): (&[u8], &[u8])| {
        (0..3).map(|i| (f64::from(a[i]) - f64::from(b[i])).powi(2)).sum::<f64>() / 3.0
    };
    (seen().map(square).sum::<f64>() / seen().count() as f64).sqrt() / 255.0
}

/// How much brighter one picture is than another, of 1.
fn bias(a: &[u8], b: &[u8]) -> f64 {
    let sky = sky_pixel();
    let seen = || a.chunks(4).zip(b.chunks(4)).filter(|(a, _)| *a != sky);
    let sum: f64 = seen().map(|(a, b)| (f64::from(b[1]) - f64::from(a[1])) / 255.0).sum();
    sum / seen().count() as f64
}

#[test]
fn light_by_depth_is_nearer_to_traced_shadows_than_a_factor_by_height() {
    let ball = world::Mesh::ball(5);
    let vertices = ball.positions.iter().map(|&p| Vertex { position: p, normal: p }).collect();
    let mesh = Mesh::new(vertices, Vec::new(), ball.triangles).unwrap();
    let camera = Camera::look_at(Vec3::new(0.0, 0.3, 2.2), Vec3::ZERO, 45.0, 4.0 / 3.0, 0.1, 20.0);
    let tint = [Vec3::new(0.4, 0.3, 0.2), Vec3::new(0.9, 0.7, 0.5)];
    let mut sums = [0.0; 2];
    for (height, density, sun) in [
        (0.05, 0.1, Vec3::new(0.45, 0.75, 0.5)),
        (0.05, 0.3, Vec3::new(0.45, 0.75, 0.5)),
        (0.1, 0.1, Vec3::new(0.45, 0.75, 0.5)),
        (0.1, 0.3, Vec3::new(0.45, 0.75, 0.5)),
        (0.1, 0.3, Vec3::new(-0.9, 0.3, 0.3)),
        (0.1, 0.3, Vec3::new(0.0, 0.2, 1.0)),
    ] {
        let fur = Fur { bend: Vec3::new(0.0, -0.5, 0.0), ..Fur::for_radius(1.0, height, density).unwrap() };
        let look = Look::new(Fur { spacing: 0.03, ..fur });
        let shot = |way| {
            let made = Reference::new(&mesh, &look).unwrap().with_self_shadow(way);
            made.picture(&camera, SIZE, 2, &tint, sun.normalize())
        };
        let traced = shot(SelfShadow::Traced);
        let [by_height, by_depth] = [SelfShadow::Height, SelfShadow::Depth].map(shot);
        let errors = [rmse(&traced, &by_height), rmse(&traced, &by_depth)];
        println!(
            "{height} high, density {density}, sun {sun}: by height {:.4} (brighter by {:+.3}), by depth {:.4} ({:+.3})",
            errors[0],
            bias(&traced, &by_height),
            errors[1],
            bias(&traced, &by_depth)
        );
        (0..2).for_each(|i| sums[i] += errors[i] / 6.0);
    }
    println!("mean: by height {:.4}, by depth {:.4}", sums[0], sums[1]);
    assert!(sums[1] < 0.9 * sums[0] && sums[1] > 0.0, "{sums:?}");
}
