//! Pictures of shells: fur shows beyond walls, and more shells come nearer to strands.

use casca_fur::gpu::look::Look;
use casca_fur::gpu::records::{Block, DrawList, Stand, Sun};
use casca_fur::gpu::reference::Reference;
use casca_fur::gpu::renderer::Renderer;
use casca_fur::mesh::{Coat, Mesh};
use casca_fur::strands::Fur;
use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_tools::camera::Camera;
use glam::{Affine3A, Vec3};

const TO_SUN: Vec3 = Vec3::new(0.6, 0.64, 0.48);

/// A ball of radius 1 with fur of full length, but on its left half.
fn ball() -> Mesh {
    let length = |p: Vec3| f32::from(u8::from(p.x > -0.2));
    crate::ball(3, |p| Coat { color: Vec3::new(0.7, 0.5, 0.3), length: length(p) })
}

fn stand() -> Stand {
    Stand { mesh: 0, place: Affine3A::IDENTITY, root: [1.0; 3], tip: [1.0; 3] }
}

fn shoot(gpu: &Gpu, renderer: &mut Renderer, canvas: &Canvas, camera: &Camera, list: &DrawList) -> Vec<u8> {
    let sun = Sun { towards: TO_SUN, center: Vec3::ZERO, radius: 4.0, shadows: true };
    renderer.cast_shadows(gpu, list, &sun).unwrap();
    renderer.draw(gpu, &canvas.picture(), camera, list, &sun).unwrap();
    canvas.read_picture(gpu).unwrap()
}

#[test]
fn fur_stands_above_the_skin_only_where_the_coat_has_length() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let mesh = [ball()];
    let canvas = Canvas::new(&gpu, (96, 96));
    let camera = Camera::look_at(Vec3::Z * 4.0, Vec3::ZERO, 40.0, 1.0, 0.1, 20.0);
    let mut look = Look::new(Fur { spacing: 0.08, ..Fur::for_radius(1.0, 0.2, 0.4).unwrap() });
    let mut renderer = Renderer::new(&gpu, COLOUR, &mesh, &look).unwrap();
    // The ball is 96 / 2 / tan(20°) / sqrt(15) = 34 pixels in radius, the fur 7 more.
    let beyond = |pixels: &[u8]| {
        let sky = pixels[..4].to_vec();
        let at = |i: usize| Vec3::new((i % 96) as f32 - 47.5, (i / 96) as f32 - 47.5, 0.0);
        let shown = |right: bool| {
            let far =
                |i: &usize| at(*i).length() > 36.0 && (at(*i).x > 20.0) == right && at(*i).x.abs() > 20.0;
            (0..96 * 96).filter(far).filter(|i| pixels[4 * i..4 * i + 4] != sky).count()
        };
        (shown(false), shown(true))
    };
    let mut counts = Vec::new();
    for marched in [true, false] {
        look.marched = marched;
        renderer.set_look(&gpu, &look);
        let pixels =
            shoot(&gpu, &mut renderer, &canvas, &camera, &DrawList::new(&[(stand(), 12)], Vec::new()));
        let (bald, furry) = beyond(&pixels);
        println!("followed {marched}: {furry} pixels of fur beyond the skin");
        assert!(bald == 0 && furry > 40, "{marched}: {bald} {furry}");
        counts.push(furry);
    }
    // Rays that are followed through slabs meet strands between shells.
    assert!(counts[0] > counts[1] + counts[1] / 10, "{counts:?}");
    let skin = shoot(&gpu, &mut renderer, &canvas, &camera, &DrawList::new(&[(stand(), 0)], Vec::new()));
    assert_eq!(beyond(&skin), (0, 0));
}

#[test]
fn shells_come_nearer_to_ray_traced_strands_with_their_number() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let mesh = ball();
    let (size, canvas) = ((96, 72), Canvas::new(&gpu, (192, 144)));
    let camera =
        Camera::look_at(Vec3::new(1.6, 0.9, 1.4), Vec3::new(0.4, 0.3, 0.3), 40.0, 4.0 / 3.0, 0.1, 20.0);
    let mut fur = Fur { spacing: 0.06, ..Fur::for_radius(1.0, 0.15, 0.3).unwrap() };
    fur.bend = Vec3::new(0.0, -0.5, 0.0);
    let look = Look::new(fur);
    let reference = Reference::new(&mesh, &look).unwrap();
    assert!(reference.strands() > 500);
    let truth = reference.picture(&camera, size, 2, &[Vec3::ONE; 2], TO_SUN.normalize());
    let mut renderer = Renderer::new(&gpu, COLOUR, std::slice::from_ref(&mesh), &look).unwrap();
    let sun = Sun { towards: TO_SUN, center: Vec3::ZERO, radius: 2.0, shadows: false };
    let mut error = |layers| {
        let list = DrawList::new(&[(stand(), layers)], Vec::new());
        renderer.draw(&gpu, &canvas.picture(), &camera, &list, &sun).unwrap();
        let pixels = casca_tools::image::halved(&canvas.read_picture(&gpu).unwrap(), canvas.size());
        let sum: f64 = truth.iter().zip(&pixels).map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2)).sum();
        (sum / truth.len() as f64).sqrt() / 255.0
    };
    let errors = [0, 4, 16, 48].map(&mut error);
    println!("RMSE with 0, 4, 16 and 48 layers: {errors:.4?}");
    assert!(errors.is_sorted_by(|a, b| a > b) && errors[3] < 0.5 * errors[0], "{errors:?}");
    // Steps along rays over skin that is taken for flat left 0.0190 with 16 layers.
    assert!(errors[1] < 0.025 && errors[2] < 0.0125, "{errors:?}");
}

#[test]
fn fur_that_stands_out_behind_a_wall_is_drawn_and_the_wall_hides_the_rest() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let mesh = [ball()];
    let look = Look::new(Fur { spacing: 0.08, ..Fur::for_radius(1.0, 0.2, 0.5).unwrap() });
    let mut renderer = Renderer::new(&gpu, COLOUR, &mesh, &look).unwrap();
    let canvas = Canvas::new(&gpu, (96, 96));
    let camera = Camera::look_at(Vec3::Z * 4.0, Vec3::ZERO, 40.0, 1.0, 0.1, 20.0);
    let wall = Block { min: [-3.0, -3.0, 1.4], paint: 1, max: [0.68, 3.0, 1.5], pad: 0 };
    let list = |stands: &[(Stand, u32)]| DrawList::new(stands, vec![wall]);
    let [with, without] =
        [&[(stand(), 12)][..], &[]].map(|stands| shoot(&gpu, &mut renderer, &canvas, &camera, &list(stands)));
    let differing: Vec<usize> =
        (0..96 * 96).filter(|i| with[4 * i..4 * i + 4] != without[4 * i..4 * i + 4]).collect();
    // The skin ends at column 82, the wall at 83.
    assert!(differing.len() > 20, "{}", differing.len());
    assert!(differing.iter().all(|i| i % 96 >= 80), "the wall hides what is behind it");
}

#[test]
fn shadows_do_not_depend_on_the_eye() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let mesh = [ball()];
    let look = Look::new(Fur { spacing: 0.08, ..Fur::for_radius(1.0, 0.3, 0.4).unwrap() });
    let mut renderer = Renderer::new(&gpu, COLOUR, &mesh, &look).unwrap();
    let canvas = Canvas::new(&gpu, (96, 96));
    let camera = Camera::look_at(Vec3::new(1.0, 3.0, 4.0), Vec3::ZERO, 60.0, 1.0, 0.1, 20.0);
    let ground = Block { min: [-4.0, -1.5, -4.0], paint: 0, max: [4.0, -1.3, 4.0], pad: 0 };
    let list = DrawList::new(&[(stand(), 8)], vec![ground]);
    let sun = Sun { towards: TO_SUN, center: Vec3::ZERO, radius: 4.0, shadows: true };
    let [here, there] = [Vec3::Z * 4.0, Vec3::new(-3.0, 0.5, -3.0)].map(|eye| {
        // A look from elsewhere, before.
        let other = Camera::look_at(eye, Vec3::ZERO, 60.0, 1.0, 0.1, 20.0);
        renderer.draw(&gpu, &canvas.picture(), &other, &list, &sun).unwrap();
        renderer.cast_shadows(&gpu, &list, &sun).unwrap();
        renderer.draw(&gpu, &canvas.picture(), &camera, &list, &sun).unwrap();
        canvas.read_picture(&gpu).unwrap()
    });
    assert!(here == there, "the map of shadows follows whoever looked before it was made");
}

#[test]
fn absurd_lists_and_looks_neither_panic_nor_end_the_device() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let mesh = [ball()];
    let look = Look::new(Fur::for_radius(1.0, 0.2, 0.5).unwrap());
    let mut renderer = Renderer::new(&gpu, COLOUR, &mesh, &look).unwrap();
    let canvas = Canvas::new(&gpu, (16, 16));
    let camera = Camera::look_at(Vec3::Z * 4.0, Vec3::ZERO, 40.0, 1.0, 0.1, 20.0);
    let nowhere = Stand { place: Affine3A::from_scale(Vec3::ZERO), ..stand() };
    let lost = Stand { place: Affine3A::from_translation(Vec3::NAN), ..stand() };
    let [unknown, last] = [7, usize::MAX].map(|mesh| Stand { mesh, ..stand() });
    for stands in [&[][..], &[(nowhere, 2), (lost, 2), (unknown, 2), (last, 2)], &[(stand(), 1)]] {
        let list = DrawList::new(stands, Vec::new());
        assert_eq!(shoot(&gpu, &mut renderer, &canvas, &camera, &list).len(), 16 * 16 * 4);
    }
    for (height, spacing, radius) in [(f32::NAN, 0.1, 0.3), (0.0, 0.0, 0.0), (1e30, 1e-30, 1e30)] {
        let fur = Fur { height, spacing, radius, ..look.fur };
        renderer.set_look(&gpu, &Look { fur, ..look });
        let list = DrawList::new(&[(stand(), 1)], Vec::new());
        assert_eq!(shoot(&gpu, &mut renderer, &canvas, &camera, &list).len(), 16 * 16 * 4);
    }
    let crowded = Fur { per_cell: u32::MAX, ..look.fur };
    renderer.set_look(&gpu, &Look { fur: crowded, ..look });
    let list = DrawList::new(&[(stand(), 1)], Vec::new());
    assert_eq!(shoot(&gpu, &mut renderer, &canvas, &camera, &list).len(), 16 * 16 * 4);
}
