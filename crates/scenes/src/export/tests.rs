use glam::Affine3A;

use super::*;
use crate::generated::{self, SceneKind, SceneOptions};
use crate::import;

/// Writes a scene, and reads it back.
fn read_back(world: &mut World) -> World {
    import::read("level", &glb(world).unwrap(), None).unwrap()
}

/// A ball of triangles stays inside its sphere, by at most this share of the radius.
const WITHIN: f32 = 0.05;

fn same(written: &Object, read: &Object) -> bool {
    let ((lo, hi), (read_lo, read_hi)) = (written.shape.bounds(), read.shape.bounds());
    let near = match &written.shape {
        Shape::Sphere { radius, .. } => radius * WITHIN,
        _ => 1e-4,
    };
    lo.abs_diff_eq(read_lo, near)
        && hi.abs_diff_eq(read_hi, near)
        && (&written.name, written.occludes, written.tested) == (&read.name, read.occludes, read.tested)
        && (written.motion == Motion::Static) == (read.motion == Motion::Static)
}

#[test]
fn scenes_are_read_back_as_they_were_in_every_frame() {
    for kind in [SceneKind::Rooms, SceneKind::City, SceneKind::Forest] {
        let options = SceneOptions { frames: 12, scale: 0.3, ..SceneOptions::default() };
        let mut world = generated::build(kind, &options);
        let mut read = read_back(&mut world);
        assert_eq!((read.frames, read.objects.len()), (world.frames, world.objects.len()));
        for frame in 0..world.frames {
            world.set_frame(frame);
            read.set_frame(frame);
            for (a, b) in world.objects.iter().zip(&read.objects) {
                assert!(same(a, b), "{kind:?}, frame {frame}: {a:?} was read as {b:?}");
            }
            let (a, b) = (world.camera(frame, 1.5), read.camera(frame, 1.5));
            assert!(a.eye.abs_diff_eq(b.eye, 1e-4), "{kind:?}, frame {frame}");
            assert!(a.view.abs_diff_eq(b.view, 1e-3), "{kind:?}, frame {frame}: {} {}", a.view, b.view);
            assert!(a.projection.abs_diff_eq(b.projection, 1e-3), "{} {}", a.projection, b.projection);
        }
    }
}

#[test]
fn meshes_and_roles_are_written_and_moving_meshes_refused() {
    let mut world = generated::build(SceneKind::Rooms, &SceneOptions { frames: 2, ..Default::default() });
    let mesh = Arc::new(Mesh::ball(1));
    let transform = Affine3A::from_rotation_y(0.5) * Affine3A::from_translation(Vec3::new(9.0, 2.0, 9.0));
    world.objects[0].shape = Shape::Mesh { mesh: mesh.clone(), transform };
    world.objects[0].occludes = false;
    world.objects[1].tested = false;
    let read = read_back(&mut world);
    for (a, b) in world.objects.iter().zip(&read.objects).take(2) {
        assert!(same(a, b), "{a:?} was read as {b:?}");
    }
    let moving = (0..world.objects.len()).find(|&i| world.objects[i].motion != Motion::Static).unwrap();
    world.objects.swap(0, moving);
    world.objects[0].shape = Shape::Mesh { mesh, transform };
    world.animation = Box::new(Still);
    assert!(matches!(glb(&mut world), Err(ExportError::MovingMesh(0))));
}

/// Nothing moves.
struct Still;

impl crate::world::Animation for Still {
    fn shapes(&self, _: usize, _: &mut dyn FnMut(usize, Shape)) {}

    fn camera(&self, _: usize, aspect: f32) -> Camera {
        Camera::look_at(Vec3::ONE, Vec3::ZERO, 60.0, aspect, 0.1, 10.0)
    }
}

#[test]
fn what_hides_and_from_where_is_read_back() {
    let mut world =
        generated::build(SceneKind::Rooms, &SceneOptions { scale: 0.1, ..SceneOptions::default() });
    let sides = [Sides::Front, Sides::Neither, Sides::Both, Sides::Front];
    for (i, object) in world.objects.iter_mut().take(3).enumerate() {
        let mut mesh = Mesh::cuboid(Vec3::ZERO, Vec3::ONE);
        mesh.sides = match i {
            0 => (0..12).map(|t| sides[t % 4]).collect(),
            1 => vec![Sides::Front; 12],
            _ => vec![Sides::Neither; 12],
        };
        object.shape = Shape::Mesh { mesh: mesh.into(), transform: Affine3A::IDENTITY };
        (object.occludes, object.motion) = (i < 2, Motion::Static);
    }
    let read = read_back(&mut world);
    for (written, read) in world.objects.iter().zip(&read.objects).take(3) {
        let (Shape::Mesh { mesh: a, .. }, Shape::Mesh { mesh: b, .. }) = (&written.shape, &read.shape) else {
            panic!("a mesh")
        };
        // By the corners of a triangle, which are in another order now.
        let of = |mesh: &Mesh| {
            let place = |v: u32| mesh.positions[v as usize].to_array().map(f32::to_bits);
            let all =
                (0..mesh.triangles.len()).map(|t| (mesh.triangles[t].map(place), mesh.sides_of(t) as u8));
            all.collect::<std::collections::BTreeSet<_>>()
        };
        assert_eq!(of(a), of(b));
        assert_eq!((written.occludes, written.tested), (read.occludes, read.tested));
    }
    assert!(
        read.objects[3..]
            .iter()
            .all(|o| matches!(&o.shape, Shape::Mesh { mesh, .. } if mesh.sides.is_empty()))
    );
}
