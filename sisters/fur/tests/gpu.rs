//! Shells on the graphics processor: their pictures, beside rays and beside each other.

use casca_fur::gpu::error::FurGpuError;
use casca_fur::gpu::look::{Look, sky_pixel};
use casca_fur::gpu::records::{Block, DrawList, Stand, Sun};
use casca_fur::gpu::reference::Reference;
use casca_fur::gpu::renderer::Renderer;
use casca_fur::mesh::{Coat, Mesh, Vertex};
use casca_fur::skin::{Channel, Clip, Interpolation, Joint, Pose, Skeleton, Track, Weights};
use casca_fur::strands::{Fur, Lean};
use casca_scenes::world;
use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, DEPTH, Gpu};
use casca_stage::wgpu::{Color, TextureFormat};
use casca_tools::camera::Camera;
use casca_tools::image::halved;
use glam::{Affine3A, Quat, Vec3};

#[path = "../examples/own_pass.rs"]
#[expect(dead_code, reason = "it is a program")]
mod own_pass;

const TO_SUN: Vec3 = Vec3::new(0.6, 0.64, 0.48);

/// Where a ball stands, in its own colours.
const STAND: Stand = Stand { mesh: 0, place: Affine3A::IDENTITY, root: [1.0; 3], tip: [1.0; 3] };

/// A ball of radius 1, cut so often, with a coat at each vertex.
fn ball(cuts: u32, coat: impl Fn(Vec3) -> Coat) -> Mesh {
    let ball = world::Mesh::ball(cuts);
    let vertex = |&p: &Vec3| Vertex { position: p, normal: p };
    let (vertices, coats) = ball.positions.iter().map(|p| (vertex(p), coat(*p))).unzip();
    Mesh::new(vertices, coats, ball.triangles).unwrap()
}

/// Fur of a ball, so high and dense, with so much between its strands.
fn fur(height: f32, density: f32, spacing: f32) -> Fur {
    Fur { spacing, ..Fur::for_radius(1.0, height, density).unwrap() }
}

/// One ball with so many layers.
fn alone(layers: u32) -> DrawList {
    DrawList::new(&[(STAND, layers)], Vec::new())
}

/// Looks at the middle of a ball.
fn looking(from: Vec3, aspect: f32) -> Camera {
    Camera::look_at(from, Vec3::ZERO, 40.0, aspect, 0.1, 20.0)
}

fn renderer(gpu: &Gpu, mesh: &Mesh, look: &Look) -> Renderer {
    Renderer::new(gpu, COLOUR, std::slice::from_ref(mesh), look).unwrap()
}

/// A picture with shadows.
fn shoot(gpu: &Gpu, renderer: &mut Renderer, size: u32, camera: &Camera, list: &DrawList) -> Vec<u8> {
    let canvas = Canvas::new(gpu, (size, size));
    let sun = Sun { towards: TO_SUN, center: Vec3::ZERO, radius: 4.0, shadows: true };
    renderer.cast_shadows(gpu, list, &sun).unwrap();
    renderer.draw(gpu, &canvas.picture(), camera, list, &sun).unwrap();
    canvas.read_picture(gpu).unwrap()
}

/// A picture without a shadow map and with four samples a pixel, as the reference takes it.
fn sampled(
    gpu: &Gpu,
    renderer: &mut Renderer,
    (width, height): (u32, u32),
    camera: &Camera,
    list: &DrawList,
    to_sun: Vec3,
) -> Vec<u8> {
    let canvas = Canvas::new(gpu, (2 * width, 2 * height));
    let sun = Sun { towards: to_sun, center: Vec3::ZERO, radius: 2.0, shadows: false };
    renderer.draw(gpu, &canvas.picture(), camera, list, &sun).unwrap();
    halved(&canvas.read_picture(gpu).unwrap(), canvas.size())
}

fn rmse(a: &[u8], b: &[u8]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2)).sum();
    (sum / a.len() as f64).sqrt() / 255.0
}

/// A skeleton whose second joint turns in the middle, and a pose with this turn.
fn turned(turn: Quat) -> (Skeleton, Pose) {
    let skeleton = Skeleton::new(vec![Joint::at(None, Vec3::ZERO), Joint::at(Some(0), Vec3::ZERO)]).unwrap();
    let track = Track::new(vec![0.0], vec![turn], Interpolation::Step).unwrap();
    let clip = Clip::new(vec![(1, Channel::Rotation(track))], &skeleton).unwrap();
    let mut pose = Pose::rest(&skeleton);
    pose.set(&skeleton, &clip, 0.0);
    (skeleton, pose)
}

/// A ball with fur of full length, but on its left half.
fn half_bald() -> Mesh {
    let length = |p: Vec3| f32::from(u8::from(p.x > -0.2));
    ball(3, |p| Coat { color: Vec3::new(0.7, 0.5, 0.3), length: length(p) })
}

#[test]
fn fur_stands_above_the_skin_only_where_the_coat_has_length() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let camera = looking(Vec3::Z * 4.0, 1.0);
    let mut look = Look::new(fur(0.2, 0.4, 0.08));
    let mut renderer = renderer(&gpu, &half_bald(), &look);
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
    for walked in [true, false] {
        look.walked = walked;
        renderer.set_look(&gpu, &look);
        let (bald, furry) = beyond(&shoot(&gpu, &mut renderer, 96, &camera, &alone(12)));
        println!("walked {walked}: {furry} pixels of fur beyond the skin");
        assert!(bald == 0 && furry > 40, "{walked}: {bald} {furry}");
    }
    assert_eq!(beyond(&shoot(&gpu, &mut renderer, 96, &camera, &alone(0))), (0, 0));
}

#[test]
fn shells_come_nearer_to_ray_traced_strands_with_their_number() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let (mesh, size) = (half_bald(), (96, 72));
    let (eye, target) = (Vec3::new(1.6, 0.9, 1.4), Vec3::new(0.4, 0.3, 0.3));
    let camera = Camera::look_at(eye, target, 40.0, 4.0 / 3.0, 0.1, 20.0);
    let look = Look::new(Fur { bend: Vec3::new(0.0, -0.5, 0.0), ..fur(0.15, 0.3, 0.06) });
    let reference = Reference::new(&mesh, &look).unwrap();
    assert!(reference.strands() > 500);
    let truth = reference.picture(&camera, size, 2, &[Vec3::ONE; 2], TO_SUN.normalize());
    for (walked, few, some) in [(true, 0.025, 0.0125), (false, 0.05, 0.025)] {
        let mut renderer = renderer(&gpu, &mesh, &Look { walked, ..look });
        let errors = [0, 4, 16, 48]
            .map(|layers| rmse(&truth, &sampled(&gpu, &mut renderer, size, &camera, &alone(layers), TO_SUN)));
        println!("walked {walked}: RMSE with 0, 4, 16 and 48 layers: {errors:.4?}");
        assert!(errors.is_sorted_by(|a, b| a > b) && errors[3] < 0.5 * errors[0], "{errors:?}");
        // Walks over skin that is taken for flat left 0.0190 with 16 layers.
        assert!(errors[1] < few && errors[2] < some, "{errors:?}");
    }
}

#[test]
fn fur_that_stands_out_behind_a_wall_is_drawn_and_the_wall_hides_the_rest() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let mut renderer = renderer(&gpu, &half_bald(), &Look::new(fur(0.2, 0.5, 0.08)));
    let camera = looking(Vec3::Z * 4.0, 1.0);
    let wall = Block { min: [-3.0, -3.0, 1.4], paint: 1, max: [0.68, 3.0, 1.5], pad: 0 };
    let list = |stands: &[(Stand, u32)]| DrawList::new(stands, vec![wall]);
    let [with, without] =
        [&[(STAND, 12)][..], &[]].map(|stands| shoot(&gpu, &mut renderer, 96, &camera, &list(stands)));
    let differing: Vec<usize> =
        (0..96 * 96).filter(|i| with[4 * i..4 * i + 4] != without[4 * i..4 * i + 4]).collect();
    // The skin ends at column 82, the wall at 83.
    assert!(differing.len() > 20, "{}", differing.len());
    assert!(differing.iter().all(|i| i % 96 >= 80), "the wall hides what is behind it");
}

#[test]
fn shadows_do_not_depend_on_the_eye() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let mut renderer = renderer(&gpu, &half_bald(), &Look::new(fur(0.3, 0.4, 0.08)));
    let camera = Camera::look_at(Vec3::new(1.0, 3.0, 4.0), Vec3::ZERO, 60.0, 1.0, 0.1, 20.0);
    let ground = Block { min: [-4.0, -1.5, -4.0], paint: 0, max: [4.0, -1.3, 4.0], pad: 0 };
    let list = DrawList::new(&[(STAND, 8)], vec![ground]);
    let [here, there] = [Vec3::Z * 4.0, Vec3::new(-3.0, 0.5, -3.0)].map(|eye| {
        // A look from elsewhere, before.
        shoot(&gpu, &mut renderer, 96, &Camera::look_at(eye, Vec3::ZERO, 60.0, 1.0, 0.1, 20.0), &list);
        shoot(&gpu, &mut renderer, 96, &camera, &list)
    });
    assert!(here == there, "the map of shadows follows whoever looked before it was made");
}

#[test]
fn absurd_lists_looks_weights_and_poses_neither_panic_nor_end_the_device() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let mesh = half_bald();
    let look = Look::new(Fur::for_radius(1.0, 0.2, 0.5).unwrap());
    let mut renderer = renderer(&gpu, &mesh, &look);
    let camera = looking(Vec3::Z * 4.0, 1.0);
    let nowhere = Stand { place: Affine3A::from_scale(Vec3::ZERO), ..STAND };
    let lost = Stand { place: Affine3A::from_translation(Vec3::NAN), ..STAND };
    let [unknown, last] = [7, usize::MAX].map(|mesh| Stand { mesh, ..STAND });
    for stands in [&[][..], &[(nowhere, 2), (lost, 2), (unknown, 2), (last, 2)], &[(STAND, 1)]] {
        shoot(&gpu, &mut renderer, 16, &camera, &DrawList::new(stands, Vec::new()));
    }
    let odd = |(height, spacing, radius)| Fur { height, spacing, radius, ..look.fur };
    let furs = [(f32::NAN, 0.1, 0.3), (0.0, 0.0, 0.0), (1e30, 1e-30, 1e30)].map(odd);
    for fur in furs.into_iter().chain([Fur { per_cell: u32::MAX, ..look.fur }]) {
        renderer.set_look(&gpu, &Look { fur, ..look });
        shoot(&gpu, &mut renderer, 16, &camera, &alone(1));
    }
    renderer.set_look(&gpu, &look);
    let (skeleton, _) = turned(Quat::IDENTITY);
    let few = Weights::new(&[[0; 4]], &[[1.0; 4]], &skeleton).unwrap();
    assert!(renderer.set_weights(&gpu, 0, &few).is_err());
    let count = mesh.vertices().len();
    let all = Weights::new(&vec![[1; 4]; count], &vec![[1.0; 4]; count], &skeleton).unwrap();
    assert!([1, usize::MAX].iter().all(|&mesh| renderer.set_weights(&gpu, mesh, &all).is_err()));
    renderer.set_weights(&gpu, 0, &all).unwrap();
    let mut list = alone(2);
    let rest = shoot(&gpu, &mut renderer, 96, &camera, &list);
    // A pose without the joint.
    list.pose(0, &Pose::default()).unwrap();
    assert!(shoot(&gpu, &mut renderer, 96, &camera, &list) == rest);
    // A pose that flattens everything.
    let flat = Track::new(vec![0.0], vec![Vec3::ZERO], Interpolation::Step).unwrap();
    let clip = Clip::new(vec![(0, Channel::Scale(flat))], &skeleton).unwrap();
    let mut pose = Pose::rest(&skeleton);
    pose.set(&skeleton, &clip, 0.0);
    list.pose(0, &pose).unwrap();
    shoot(&gpu, &mut renderer, 96, &camera, &list);
    assert!(list.lean(1, Lean::default()).is_err() && list.pose(1, &Pose::default()).is_err());
}

/// A ball in many colours, with fur that is easy to see.
fn motley() -> (Mesh, Look) {
    let mesh = ball(3, |p| Coat { color: Vec3::new(0.6, 0.5, 0.4) + 0.3 * p, length: 1.0 });
    (mesh, Look::new(fur(0.2, 0.3, 0.12)))
}

fn differing(a: &[u8], b: &[u8], within: impl Fn(usize) -> bool) -> usize {
    let far = |i: &usize| (0..4).any(|c| a[4 * i + c].abs_diff(b[4 * i + c]) > 8);
    (0..a.len() / 4).filter(|i| within(*i)).filter(far).count()
}

#[test]
fn strands_stick_to_skin_that_turns() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let ((mesh, look), turn) = (motley(), Quat::from_axis_angle(Vec3::new(0.3, 0.9, 0.2).normalize(), 0.8));
    let (skeleton, pose) = turned(turn);
    let count = mesh.vertices().len();
    let camera = looking(Vec3::Z * 4.0, 1.0);
    let mut renderer = renderer(&gpu, &mesh, &look);
    let shot = |renderer: &mut Renderer, place, pose: Option<&Pose>| {
        let mut list = DrawList::new(&[(Stand { place, ..STAND }, 12)], Vec::new());
        pose.into_iter().for_each(|pose| list.pose(0, pose).unwrap());
        shoot(&gpu, renderer, 96, &camera, &list)
    };
    let rest = shot(&mut renderer, Affine3A::IDENTITY, None);
    let placed = shot(&mut renderer, Affine3A::from_quat(turn), None);
    let whole =
        Weights::new(&vec![[1, 0, 0, 0]; count], &vec![[1.0, 0.0, 0.0, 0.0]; count], &skeleton).unwrap();
    renderer.set_weights(&gpu, 0, &whole).unwrap();
    let posed = shot(&mut renderer, Affine3A::IDENTITY, Some(&pose));
    let unposed = shot(&mut renderer, Affine3A::IDENTITY, None);
    let all = |_: usize| true;
    let [same, moved] = [differing(&posed, &placed, all), differing(&posed, &rest, all)];
    println!("{same} pixels of a turned joint differ from a turned object, {moved} from rest");
    // Rounding puts some pixels on the other side of a strand's edge.
    assert!(same < 40 && moved > 1000, "{same} {moved}");
    assert!(differing(&unposed, &rest, all) < 10, "without a pose weights change nothing");

    // The right half turns, the left half does not.
    let joints: Vec<[u32; 4]> =
        mesh.vertices().iter().map(|v| [u32::from(v.position.x > 0.0), 0, 0, 0]).collect();
    let halves = Weights::new(&joints, &vec![[1.0, 0.0, 0.0, 0.0]; count], &skeleton).unwrap();
    renderer.set_weights(&gpu, 0, &halves).unwrap();
    let parted = shot(&mut renderer, Affine3A::IDENTITY, Some(&turned(Quat::from_rotation_x(0.5)).1));
    let [left, right] =
        [differing(&parted, &rest, |i| i % 96 < 36), differing(&parted, &rest, |i| i % 96 > 60)];
    println!("{left} pixels of the half that rests differ, {right} of the one that turns");
    assert!(left < 40 && right > 300, "{left} {right}");
}

#[test]
fn strands_that_lean_in_the_world_look_as_if_they_were_combed_so() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let ((mesh, look), camera) = (motley(), looking(Vec3::Z * 4.0, 1.0));
    let mut renderer = renderer(&gpu, &mesh, &look);
    let place = Affine3A::from_quat(Quat::from_rotation_x(1.2));
    let mut list = DrawList::new(&[(Stand { place, ..STAND }, 12)], Vec::new());
    let straight = shoot(&gpu, &mut renderer, 96, &camera, &list);
    let lean = Lean { towards: Vec3::new(3.0, 1.0, 0.0), most: 1.5 };
    list.lean(0, lean).unwrap();
    let leaning = shoot(&gpu, &mut renderer, 96, &camera, &list);
    list.lean(0, Lean::default()).unwrap();
    let bend = place.inverse().transform_vector3(lean.towards.normalize() * 1.5);
    renderer.set_look(&gpu, &Look { fur: Fur { bend, ..look.fur }, ..look });
    let combed = shoot(&gpu, &mut renderer, 96, &camera, &list);
    let [same, moved] = [&combed, &straight].map(|other| differing(&leaning, other, |_| true));
    println!("{same} pixels differ from combed fur, {moved} from straight fur");
    assert!(same < 40 && moved > 500, "{same} {moved}");
}

#[test]
fn a_pass_of_ones_own_shows_what_the_renderer_shows() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let (mesh, look) = (ball(3, |_| Coat::default()), Look::new(Fur::for_radius(1.0, 0.2, 0.4).unwrap()));
    let size = (96, 64);
    let camera = Camera::look_at(Vec3::Z * 4.0, Vec3::ZERO, 45.0, 1.5, 0.1, 20.0);
    let stand = Stand { root: [0.4, 0.2, 0.1], tip: [1.0, 0.5, 0.2], ..STAND };
    let other = Stand { place: Affine3A::from_translation(Vec3::X * 1.5), ..stand };
    let mut list = DrawList::new(&[(stand, 3), (other, 2)], Vec::new());
    // The first is posed and leans, the second stands at rest.
    let (skeleton, pose) = turned(Quat::from_rotation_z(0.7));
    let up = |v: &Vertex| (v.position.y + 0.5).clamp(0.0, 1.0);
    let shares: Vec<[f32; 4]> = mesh.vertices().iter().map(|v| [1.0 - up(v), up(v), 0.0, 0.0]).collect();
    let weights = Weights::new(&vec![[0, 1, 0, 0]; shares.len()], &shares, &skeleton).unwrap();
    list.pose(0, &pose).unwrap();
    list.lean(0, Lean { towards: Vec3::new(0.5, -0.4, 0.0), most: 1.0 }).unwrap();
    let sun = Sun { towards: Vec3::ONE, center: Vec3::ZERO, radius: 2.0, shadows: true };

    let mut renderer = renderer(&gpu, &mesh, &look);
    let canvas = Canvas::new(&gpu, size);
    let shot = |renderer: &mut Renderer| {
        renderer.cast_shadows(&gpu, &list, &sun).unwrap();
        renderer.draw(&gpu, &canvas.picture(), &camera, &list, &sun).unwrap();
        canvas.read_picture(&gpu).unwrap()
    };
    let rest = shot(&mut renderer);
    renderer.set_weights(&gpu, 0, &weights).unwrap();
    let want = shot(&mut renderer);
    let moved = rest.chunks(4).zip(want.chunks(4)).filter(|(a, b)| a != b).count();
    assert!(moved > 200, "{moved}");
    let same = |p: &[u8]| p.chunks(4).zip(want.chunks(4)).filter(|(a, b)| a == b).count();
    let sky = want.chunks(4).filter(|p| *p == &want[..4]).count();
    assert!(sky > 1000 && sky < 5000, "the ball covers a part: {sky}");

    let [r, g, b] = [0, 1, 2].map(|i| f64::from(want[i]) / 255.0);
    let drawn = |fur: &Renderer, samples| {
        own_pass::drawn(&gpu, fur, size, samples, Color { r, g, b, a: 1.0 }).unwrap()
    };
    let meshes = std::slice::from_ref(&mesh);
    for samples in [1, 4] {
        let mut fur = Renderer::for_pass(&gpu, COLOUR, samples, meshes, &look).unwrap();
        assert_eq!(same(&drawn(&fur, samples)), sky, "nothing before it is prepared");
        assert!(fur.set_weights(&gpu, 1, &weights).is_err(), "there is one mesh");
        fur.set_weights(&gpu, 0, &weights).unwrap();
        fur.cast_shadows(&gpu, &list, &sun).unwrap();
        fur.prepare(&gpu, &camera, size.1, &list, &sun).unwrap();
        let got = drawn(&fur, samples);
        if samples == 1 {
            assert!(got == want, "one sample: the same, pixel by pixel");
        } else {
            // Outlines differ, where some of the samples are of the sky.
            let others = 96 * 64 - same(&got);
            println!("{others} pixels differ with 4 samples");
            assert!(others > 50 && others < 3000, "{others}");
        }
    }
    for (format, samples) in [(TextureFormat::Rgba8UnormSrgb, 1), (COLOUR, 3), (COLOUR, 0), (DEPTH, 1)] {
        let refused = Renderer::for_pass(&gpu, format, samples, meshes, &look);
        assert!(matches!(refused, Err(FurGpuError::Pass { .. })), "{format:?} {samples}");
    }
}

/// The RMSE of two pictures where the first shows no sky, and how much brighter the second is.
fn apart(a: &[u8], b: &[u8]) -> (f64, f64) {
    let sky = sky_pixel();
    let seen: Vec<_> = a.chunks(4).zip(b.chunks(4)).filter(|(a, _)| *a != sky).collect();
    let off = |i: usize| seen.iter().map(move |(a, b)| (f64::from(b[i]) - f64::from(a[i])) / 255.0);
    let square: f64 = (0..3).flat_map(off).map(|off| off * off).sum();
    let count = seen.len() as f64;
    ((square / (3.0 * count)).sqrt(), off(1).sum::<f64>() / count)
}

const LIT: (u32, u32) = (120, 90);

#[test]
fn shells_are_lit_as_strands_of_the_reference() {
    let Some(gpu) = Gpu::for_tests() else { return };
    // Fur of full length on one side, half as long on the other, and bald below.
    let length = |p: Vec3| if p.y < -0.4 { 0.0 } else { 0.75 + 0.25 * p.x.signum() };
    let mesh = ball(4, |p| Coat { color: Vec3::new(0.6, 0.5, 0.4), length: length(p) });
    let (sun, eye) = (Vec3::new(-0.9, 0.3, 0.3).normalize(), Vec3::new(0.0, 0.3, 2.2));
    let look =
        Look::new(Fur { bend: Vec3::new(0.4, -0.5, 0.0), clump: 0.5, curl: 0.3, ..fur(0.1, 0.3, 0.04) });
    let camera = |eye| Camera::look_at(eye, Vec3::ZERO, 45.0, 4.0 / 3.0, 0.1, 20.0);
    let wanted = Reference::new(&mesh, &look).unwrap().picture(&camera(eye), LIT, 2, &[Vec3::ONE; 2], sun);
    let mut renderer = renderer(&gpu, &mesh, &look);
    // Twice as large, and with everything turned around the axis of y.
    let [drawn, turned] = [Quat::IDENTITY, Quat::from_rotation_y(2.0)].map(|turn| {
        let place = Affine3A::from_scale_rotation_translation(Vec3::splat(2.0), turn, Vec3::ZERO);
        let list = DrawList::new(&[(Stand { place, ..STAND }, 48)], Vec::new());
        sampled(&gpu, &mut renderer, LIT, &camera(turn * (2.0 * eye)), &list, turn * sun)
    });
    let ((same, off), (again, _)) = (apart(&wanted, &drawn), apart(&drawn, &turned));
    println!("{same:.4} ({off:+.4}); turned {again:.4}");
    assert!(same < 0.03 && off.abs() < 0.004 && again < 0.02, "{same} {off} {again}");
}
