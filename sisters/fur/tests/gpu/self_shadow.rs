//! Shadows among strands by depth, against rays towards the sun, and shells against the reference.

use casca_fur::gpu::look::{Look, sky_pixel};
use casca_fur::gpu::records::{DrawList, Stand, Sun};
use casca_fur::gpu::reference::Reference;
use casca_fur::gpu::renderer::Renderer;
use casca_fur::mesh::{Coat, Mesh};
use casca_fur::strands::Fur;
use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_tools::camera::Camera;
use glam::{Affine3A, Quat, Vec3};

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
fn light_by_depth_is_near_to_traced_shadows() {
    let mesh = crate::ball(5, |_| Coat::default());
    let camera = Camera::look_at(Vec3::new(0.0, 0.3, 2.2), Vec3::ZERO, 45.0, 4.0 / 3.0, 0.1, 20.0);
    let tint = [Vec3::new(0.4, 0.3, 0.2), Vec3::new(0.9, 0.7, 0.5)];
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
        let made = || Reference::new(&mesh, &look).unwrap();
        let shot = |reference: Reference| reference.picture(&camera, SIZE, 2, &tint, sun.normalize());
        let (traced, by_depth) = (shot(made().with_traced_shadows()), shot(made()));
        let (error, brighter) = (rmse(&traced, &by_depth), bias(&traced, &by_depth));
        println!("{height} high, density {density}, sun {sun}: {error:.4} (brighter by {brighter:+.3})");
        // A factor that grows from root to tip, whatever the sun does, left 0.079 to 0.108.
        assert!(error > 0.0 && error < 0.085 && brighter.abs() < 0.03, "{error} {brighter}");
    }
}

/// A ball with fur of full length on one side, half as long and bald on the other.
fn ball() -> Mesh {
    let length = |p: Vec3| if p.y < -0.4 { 0.0 } else { 0.75 + 0.25 * p.x.signum() };
    crate::ball(4, |p| Coat { color: Vec3::new(0.6, 0.5, 0.4), length: length(p) })
}

/// Shells of the ball, with everything turned around the axis of y.
fn shells(gpu: &Gpu, mesh: &Mesh, look: &Look, sun: Vec3, turn: Quat) -> Vec<u8> {
    let mut renderer = Renderer::new(gpu, COLOUR, std::slice::from_ref(mesh), look).unwrap();
    let canvas = Canvas::new(gpu, (2 * SIZE.0, 2 * SIZE.1));
    let place = Affine3A::from_scale_rotation_translation(Vec3::splat(2.0), turn, Vec3::ZERO);
    let list = DrawList::new(&[(Stand { mesh: 0, place, root: [1.0; 3], tip: [1.0; 3] }, 48)], Vec::new());
    let sun = Sun { towards: turn * sun, center: Vec3::ZERO, radius: 2.0, shadows: false };
    let camera = Camera::look_at(turn * (2.0 * EYE), Vec3::ZERO, 45.0, 4.0 / 3.0, 0.1, 20.0);
    renderer.draw(gpu, &canvas.picture(), &camera, &list, &sun).unwrap();
    casca_tools::image::halved(&canvas.read_picture(gpu).unwrap(), canvas.size())
}

const EYE: Vec3 = Vec3::new(0.0, 0.3, 2.2);

#[test]
fn shells_are_lit_as_strands_of_the_reference() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let mesh = ball();
    let sun = Vec3::new(-0.9, 0.3, 0.3).normalize();
    let fur = Fur { bend: Vec3::new(0.4, -0.5, 0.0), ..Fur::for_radius(1.0, 0.1, 0.3).unwrap() };
    let look = Look::new(Fur { spacing: 0.04, ..fur });
    let camera = Camera::look_at(EYE, Vec3::ZERO, 45.0, 4.0 / 3.0, 0.1, 20.0);
    let wanted = Reference::new(&mesh, &look).unwrap().picture(&camera, SIZE, 2, &[Vec3::ONE; 2], sun);
    let drawn = shells(&gpu, &mesh, &look, sun, Quat::IDENTITY);
    let turned = shells(&gpu, &mesh, &look, sun, Quat::from_rotation_y(2.0));
    let (same, off, again) = (rmse(&wanted, &drawn), bias(&wanted, &drawn), rmse(&drawn, &turned));
    println!("{same:.4} ({off:+.4}); turned {again:.4}");
    assert!(same < 0.03 && off.abs() < 0.004 && again < 0.02, "{same} {off} {again}");
}
