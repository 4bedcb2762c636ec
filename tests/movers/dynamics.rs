//! What is in the frustum, and what moving objects leave behind in the cells. That none is lost that
//! an eye sees is what `tests/attack` tries.

use casca::internals::SceneInternals;

use crate::common::*;

const SIZE: f32 = 24.0;

/// More than the planes of a matrix are moved outwards for its rounding, in these scenes.
const WIDENED: f64 = 1e-4;

fn place() -> impl Strategy<Value = Vec3> {
    // Mostly in the grid, sometimes outside, sometimes on cell faces.
    let near = points(0.0..SIZE, 1.0);
    let faces = prop::array::uniform3(0..24u8).prop_map(|p| Vec3::from_array(p.map(f32::from)));
    let far = points(-2.0 * SIZE..3.0 * SIZE, 1.0);
    prop_oneof![8 => near, 1 => faces, 1 => far]
}

/// An object, by what it is made of.
#[derive(Debug)]
struct Thing {
    id: ObjectId,
    center: Vec3,
    radius: f32,
    boxy: bool,
}

/// The camera: its field of view and aspect, and the distances of its planes.
const LENS: [f32; 4] = [1.2, 1.3, 0.05, 60.0];

proptest! {
    #![proptest_config(cases(128))]

    #[test]
    fn the_frustum_holds_what_meets_it(
        objects in prop::collection::vec((place(), 0.01..3.0f32, any::<bool>()), 1..60),
        eye in place(), direction in direction(),
    ) {
        let mut scene = empty();
        let things: Vec<Thing> = objects.iter().map(|&(center, radius, boxy)| {
            let id = if boxy {
                scene.fixed(Aabb::from_center(center, Vec3::splat(radius)))
            } else {
                scene.fixed(Sphere::new(center, radius))
            };
            Thing { id, center, radius, boxy }
        }).collect();
        let mut query = query_by(Method::Frustum);
        let pvs = query.run(&scene, &looking(eye, direction, LENS));
        // Brute force on the clip volume: points of each object against it, and its planes one by
        // one.
        let clip = lens(eye, direction, LENS).as_dmat4();
        for m in &things {
            let (c, r) = (m.center.as_dvec3(), f64::from(m.radius));
            let mut touches = false;
            let (mut sides, mut points) = ([0; 6], 0);
            for i in 0..7 * 7 * 7 {
                let t = DVec3::new(f64::from(i % 7), f64::from(i / 7 % 7), f64::from(i / 49)) / 3.0 - 1.0;
                let offset = if m.boxy { t } else { t.normalize_or_zero() };
                let q = clip * (c + offset * r).extend(1.0);
                let out = [q.w + q.x, q.w - q.x, q.w + q.y, q.w - q.y, q.z, q.w - q.z];
                touches |= out.iter().all(|&d| d >= 1e-9);
                points += 1;
                sides.iter_mut().zip(out).for_each(|(n, d)| *n += i32::from(d < -WIDENED));
            }
            let found = pvs.contains(m.id);
            prop_assert!(found || !touches, "{m:?}");
            let holds_eye = (eye - m.center).abs().max_element() <= m.radius;
            if m.boxy && sides.contains(&points) && !holds_eye {
                prop_assert!(!found, "all corners of {m:?} are outside one plane");
            }
        }
    }
}

#[test]
fn hidden_objects_leave_no_trace_in_the_cells() {
    let mut scene = empty();
    scene.solid(Aabb::new(Vec3::new(10.0, 0.0, 0.0), Vec3::new(12.0, SIZE, SIZE)));
    let before = scene.id_matrix().entries();
    let ids: Vec<_> = (0..50)
        .map(|i| {
            let at = Vec3::new(18.0, 2.0 + (i % 7) as f32 * 3.0, 2.0 + (i / 7) as f32 * 2.5);
            scene.insert(ObjectDesc::dynamic(Sphere::new(at, 0.4)).max_speed(1.0)).unwrap()
        })
        .collect();
    let mut query = Query::new();
    let view = around(Vec3::new(2.5, 12.5, 12.5));
    for _ in 0..3 {
        look(&mut scene, &mut query, &view);
    }
    assert_eq!(query.pvs().len(), 1);
    assert_eq!((scene.id_matrix().entries(), scene.tbv_matrix().volumes()), (before, 50));
    ids.iter().for_each(|&id| scene.remove(id).unwrap());
    assert_eq!((scene.len(), scene.tbv_matrix().volumes()), (1, 0));
}

#[test]
fn overlapping_solids_leave_no_opaque_cells_behind() {
    // Corners of cells lie on these spheres but for the last digits.
    let spheres = [
        (Vec3::new(17.0, 11.0, 5.0), 22.0),
        (Vec3::new(14.625, 7.446_777, 22.0), 22.0),
        (Vec3::new(24.0, 7.446_777, 22.0), 10.505_371),
        (Vec3::new(17.0, 11.0, 5.0), 22.0),
        (Vec3::new(1.515_072_8e-13, 11.0, 5.0), 22.0),
        (Vec3::new(24.0, 16.0, 22.0), 10.505_371),
    ];
    for first in 0..spheres.len() {
        let mut scene = empty();
        let mut ids: Vec<ObjectId> = Vec::new();
        for (center, radius) in spheres {
            let ball = Sphere::new(center, radius);
            ids.push(scene.insert(ObjectDesc::dynamic(ball).occluder(ball)).unwrap());
        }
        assert!(scene.dynamic_opacity().count() > 1000);
        ids.rotate_left(first);
        ids.into_iter().for_each(|id| scene.remove(id).unwrap());
        assert_eq!(scene.dynamic_opacity().count(), 0);
    }
}
