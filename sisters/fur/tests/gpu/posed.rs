//! Pictures of posed animals: strands stick to their skin, and joints move the vertices that follow them.

use casca_fur::gpu::look::Look;
use casca_fur::gpu::records::{DrawList, Stand, Sun};
use casca_fur::gpu::renderer::Renderer;
use casca_fur::mesh::{Coat, Mesh};
use casca_fur::skin::{Channel, Clip, Ending, Interpolation, Joint, Pose, Skeleton, Track, Weights};
use casca_fur::strands::{Fur, Lean};
use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_tools::camera::Camera;
use glam::{Affine3A, Quat, Vec3};

const SIZE: (u32, u32) = (96, 96);

fn ball() -> Mesh {
    crate::ball(3, |p| Coat { color: Vec3::new(0.6, 0.5, 0.4) + 0.3 * p, length: 1.0 })
}

fn look() -> Look {
    Look::new(Fur { spacing: 0.12, ..Fur::for_radius(1.0, 0.2, 0.3).unwrap() })
}

/// The joint in the middle and its turn at time 0.
fn turned(turn: Quat) -> (Skeleton, Pose) {
    let skeleton = Skeleton::new(vec![Joint::at(None, Vec3::ZERO), Joint::at(Some(0), Vec3::ZERO)]).unwrap();
    let track = Track::new(vec![0.0], vec![turn], Interpolation::Step).unwrap();
    let clip = Clip::new(vec![(1, Channel::Rotation(track))], &skeleton).unwrap();
    let mut pose = Pose::rest(&skeleton);
    pose.set(&skeleton, &clip, 0.0, Ending::Loop);
    (skeleton, pose)
}

fn shoot(gpu: &Gpu, renderer: &mut Renderer, list: &DrawList, camera: &Camera) -> Vec<u8> {
    let canvas = Canvas::new(gpu, SIZE);
    let sun = Sun { towards: Vec3::new(0.6, 0.64, 0.48), center: Vec3::ZERO, radius: 3.0, shadows: true };
    renderer.cast_shadows(gpu, list, &sun).unwrap();
    renderer.draw(gpu, &canvas.picture(), camera, list, &sun).unwrap();
    canvas.read_picture(gpu).unwrap()
}

fn differing(a: &[u8], b: &[u8], within: impl Fn(usize) -> bool) -> usize {
    let far = |i: &usize| (0..4).any(|c| a[4 * i + c].abs_diff(b[4 * i + c]) > 8);
    (0..a.len() / 4).filter(|i| within(*i)).filter(far).count()
}

#[test]
fn strands_stick_to_skin_that_turns() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let (mesh, turn) = ([ball()], Quat::from_axis_angle(Vec3::new(0.3, 0.9, 0.2).normalize(), 0.8));
    let (skeleton, pose) = turned(turn);
    let count = mesh[0].vertices().len();
    let camera = Camera::look_at(Vec3::Z * 4.0, Vec3::ZERO, 40.0, 1.0, 0.1, 20.0);
    let stand = Stand { mesh: 0, place: Affine3A::IDENTITY, root: [1.0; 3], tip: [1.0; 3] };
    let list = |place, pose: Option<&Pose>| {
        let mut list = DrawList::new(&[(Stand { place, ..stand }, 12)], Vec::new());
        if let Some(pose) = pose {
            list.pose(0, pose).unwrap();
        }
        list
    };
    let mut renderer = Renderer::new(&gpu, COLOUR, &mesh, &look()).unwrap();
    let shot = |renderer: &mut Renderer, list: DrawList| shoot(&gpu, renderer, &list, &camera);
    let rest = shot(&mut renderer, list(Affine3A::IDENTITY, None));
    let placed = shot(&mut renderer, list(Affine3A::from_quat(turn), None));
    let whole =
        Weights::new(&vec![[1, 0, 0, 0]; count], &vec![[1.0, 0.0, 0.0, 0.0]; count], &skeleton).unwrap();
    renderer.set_weights(&gpu, 0, &whole).unwrap();
    let posed = shot(&mut renderer, list(Affine3A::IDENTITY, Some(&pose)));
    let unposed = shot(&mut renderer, list(Affine3A::IDENTITY, None));
    let all = |_: usize| true;
    let [same, moved] = [differing(&posed, &placed, all), differing(&posed, &rest, all)];
    println!("{same} pixels of a turned joint differ from a turned object, {moved} from rest");
    // Rounding puts some pixels on the other side of a strand's edge.
    assert!(same < 40 && moved > 1000, "{same} {moved}");
    assert!(differing(&unposed, &rest, all) < 10, "without a pose weights change nothing");

    // The right half turns, the left half does not.
    let joints: Vec<[u32; 4]> =
        mesh[0].vertices().iter().map(|v| [u32::from(v.position.x > 0.0), 0, 0, 0]).collect();
    let halves = Weights::new(&joints, &vec![[1.0, 0.0, 0.0, 0.0]; count], &skeleton).unwrap();
    renderer.set_weights(&gpu, 0, &halves).unwrap();
    let (_, slight) = turned(Quat::from_rotation_x(0.5));
    let parted = shot(&mut renderer, list(Affine3A::IDENTITY, Some(&slight)));
    let [left, right] =
        [differing(&parted, &rest, |i| i % 96 < 36), differing(&parted, &rest, |i| i % 96 > 60)];
    println!("{left} pixels of the half that rests differ, {right} of the one that turns");
    assert!(left < 40 && right > 300, "{left} {right}");
}

#[test]
fn strands_that_lean_in_the_world_look_as_if_they_were_combed_so() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let camera = Camera::look_at(Vec3::Z * 4.0, Vec3::ZERO, 40.0, 1.0, 0.1, 20.0);
    let mut renderer = Renderer::new(&gpu, COLOUR, &[ball()], &look()).unwrap();
    let place = Affine3A::from_quat(Quat::from_rotation_x(1.2));
    let stand = Stand { mesh: 0, place, root: [1.0; 3], tip: [1.0; 3] };
    let mut list = DrawList::new(&[(stand, 12)], Vec::new());
    let straight = shoot(&gpu, &mut renderer, &list, &camera);
    let lean = Lean { towards: Vec3::new(3.0, 1.0, 0.0), most: 1.5 };
    list.lean(0, lean).unwrap();
    let leaning = shoot(&gpu, &mut renderer, &list, &camera);
    list.lean(0, Lean::default()).unwrap();
    let bend = place.inverse().transform_vector3(lean.towards.normalize() * 1.5);
    let combed = Look { fur: Fur { bend, ..look().fur }, ..look() };
    renderer.set_look(&gpu, &combed);
    let combed = shoot(&gpu, &mut renderer, &list, &camera);
    let [same, moved] = [&combed, &straight].map(|other| differing(&leaning, other, |_| true));
    println!("{same} pixels differ from combed fur, {moved} from straight fur");
    assert!(same < 40 && moved > 500, "{same} {moved}");
    assert!(list.lean(1, Lean::default()).is_err() && list.pose(1, &Pose::default()).is_err());
}

#[test]
fn absurd_weights_and_poses_are_refused_or_drawn_at_rest() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let mesh = [ball()];
    let (skeleton, _) = turned(Quat::IDENTITY);
    let count = mesh[0].vertices().len();
    let mut renderer = Renderer::new(&gpu, COLOUR, &mesh, &look()).unwrap();
    let few = Weights::new(&[[0; 4]], &[[1.0; 4]], &skeleton).unwrap();
    assert!(renderer.set_weights(&gpu, 0, &few).is_err());
    let all = Weights::new(&vec![[1; 4]; count], &vec![[1.0; 4]; count], &skeleton).unwrap();
    assert!(
        renderer.set_weights(&gpu, 1, &all).is_err() && renderer.set_weights(&gpu, usize::MAX, &all).is_err()
    );
    renderer.set_weights(&gpu, 0, &all).unwrap();
    let camera = Camera::look_at(Vec3::Z * 4.0, Vec3::ZERO, 40.0, 1.0, 0.1, 20.0);
    let stand = Stand { mesh: 0, place: Affine3A::IDENTITY, root: [1.0; 3], tip: [1.0; 3] };
    let mut list = DrawList::new(&[(stand, 2)], Vec::new());
    let rest = shoot(&gpu, &mut renderer, &list, &camera);
    // A pose without the joint.
    list.pose(0, &Pose::default()).unwrap();
    assert!(shoot(&gpu, &mut renderer, &list, &camera) == rest);
    // A pose that flattens everything.
    let flat = Track::new(vec![0.0], vec![Vec3::ZERO], Interpolation::Step).unwrap();
    let clip = Clip::new(vec![(0, Channel::Scale(flat))], &skeleton).unwrap();
    let mut pose = Pose::rest(&skeleton);
    pose.set(&skeleton, &clip, 0.0, Ending::Loop);
    list.pose(0, &pose).unwrap();
    assert_eq!(shoot(&gpu, &mut renderer, &list, &camera).len(), 96 * 96 * 4);
}
