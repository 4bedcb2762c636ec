//! Plays arbitrary scene operations, sane and insane, and checks that nothing
//! panics, that refused calls change nothing, that ids of removed objects stay
//! errors, and that no ray reaches an object that the PVS leaves out.
#![no_main]

use arbitrary::Arbitrary;
use casca::internals::SceneInternals;
use casca::{Aabb, Bounds, Method, ObjectDesc, ObjectId, Occluder, Plane, Query, Scene, Sphere, View};
use casca_scenes::world::{Motion, Object, Shape};
use casca_truth::oracle::RayOracle;
use glam::{DVec3, Mat4};
use libfuzzer_sys::fuzz_target;

mod coordinates;
use coordinates::{Coordinate, Point};

#[derive(Debug, Clone, Copy, Arbitrary)]
enum AnyShape {
    Sphere(Point, Coordinate),
    Box(Point, Point),
    Between(Point, Point),
}

impl AnyShape {
    fn shape(self) -> Shape {
        match self {
            Self::Sphere(c, r) => Shape::Sphere { center: c.value(), radius: r.value() },
            Self::Box(a, b) => Shape::Box { min: a.value(), max: b.value() },
            Self::Between(a, b) => {
                let (a, b) = (a.value(), b.value());
                Shape::Box { min: a.min(b), max: a.max(b) }
            }
        }
    }
}

#[derive(Debug, Arbitrary)]
enum Op {
    Insert { shape: AnyShape, occludes: bool, dynamic: bool, speed: Option<Coordinate>, unreported: bool },
    Update { which: u8, shape: AnyShape },
    Translate { which: u8, by: Point },
    Remove { which: u8 },
    UseStale { which: u8, shape: AnyShape },
    Look { eye: Point, planes: Vec<(Point, Coordinate)>, frustum: bool },
    LookThrough { matrix: [f32; 16] },
    Time { to: f64 },
    EndFrame,
}

#[derive(Debug, Arbitrary)]
struct Play {
    cell: Coordinate,
    ops: Vec<Op>,
}

fn parts(shape: &Shape) -> (Bounds, Occluder) {
    match *shape {
        Shape::Sphere { center, radius } => {
            (Sphere::new(center, radius).into(), Sphere::new(center, radius).into())
        }
        Shape::Box { min, max } => (Aabb::new(min, max).into(), Aabb::new(min, max).into()),
        Shape::Mesh { .. } => unreachable!("no meshes are made here"),
    }
}

struct Known {
    id: ObjectId,
    object: Object,
    /// Its place is not known to the scene while it goes unreported.
    unreported: bool,
}

fuzz_target!(|play: Play| {
    // A grid of anything must be taken or refused; the play then goes on in a plain one.
    let _ = Scene::new(play.cell.value());
    let mut scene = Scene::new(1.0).expect("a plain grid");
    let mut query = Query::new();
    let mut known: Vec<Known> = Vec::new();
    let mut gone: Vec<ObjectId> = Vec::new();
    for op in play.ops.into_iter().take(64) {
        let count = scene.len();
        match op {
            Op::Insert { shape, occludes, dynamic, speed, unreported } => {
                let shape = shape.shape();
                let (bounds, occluder) = parts(&shape);
                let mut desc = if dynamic { ObjectDesc::dynamic(bounds) } else { ObjectDesc::fixed(bounds) };
                if occludes {
                    desc = desc.occluder(occluder);
                }
                if let (Some(v), true) = (speed, dynamic) {
                    desc = desc.max_speed(v.value());
                    if unreported {
                        desc = desc.reported_on_expiry();
                    }
                }
                match scene.insert(desc) {
                    Ok(id) => {
                        let motion =
                            if dynamic { Motion::Dynamic { max_speed: 1.0 } } else { Motion::Static };
                        let object = Object { name: String::new(), shape, motion, occludes, tested: true };
                        known.push(Known {
                            id,
                            object,
                            unreported: unreported && speed.is_some() && dynamic,
                        });
                    }
                    Err(_) => assert_eq!(scene.len(), count),
                }
            }
            Op::Update { which, shape } if !known.is_empty() => {
                let n = known.len();
                let k = &mut known[usize::from(which) % n];
                let shape = shape.shape();
                let (bounds, occluder) = parts(&shape);
                if scene.update(k.id, bounds, k.object.occludes.then_some(occluder)).is_ok() {
                    k.object.shape = shape;
                }
            }
            Op::Translate { which, by } if !known.is_empty() => {
                let n = known.len();
                let k = &mut known[usize::from(which) % n];
                if scene.translate(k.id, by.value()).is_ok() {
                    k.object.shape = match k.object.shape {
                        Shape::Sphere { center, radius } => {
                            Shape::Sphere { center: center + by.value(), radius }
                        }
                        Shape::Box { min, max } => {
                            Shape::Box { min: min + by.value(), max: max + by.value() }
                        }
                        ref mesh => mesh.clone(),
                    };
                }
            }
            Op::Remove { which } if !known.is_empty() => {
                let k = known.swap_remove(usize::from(which) % known.len());
                scene.remove(k.id).expect("a living object");
                gone.push(k.id);
            }
            Op::UseStale { which, shape } if !gone.is_empty() => {
                let id = gone[usize::from(which) % gone.len()];
                assert!(scene.remove(id).is_err() && scene.bounds(id).is_err());
                assert!(scene.update(id, parts(&shape.shape()).0, None).is_err());
                assert!(!query.pvs().contains(id) || scene.len() == count);
            }
            Op::Look { eye, planes, frustum } => {
                query
                    .set_method(if frustum {
                        Method::Frustum
                    } else if planes.len() % 2 == 0 {
                        Method::point()
                    } else {
                        Method::cell()
                    })
                    .expect("default settings");
                let planes: Vec<Plane> =
                    planes.iter().map(|(n, d)| Plane { normal: n.value(), offset: d.value() }).collect();
                let Ok(view) = View::from_planes(eye.value(), &planes) else { continue };
                let pvs = query.run(&scene, &view);
                assert!(pvs.is_valid_for(&scene, &view));
                let objects: Vec<Object> = known.iter().map(|k| k.object.clone()).collect();
                let left: Vec<usize> = (0..known.len())
                    .filter(|&i| !pvs.contains(known[i].id) && !known[i].unreported)
                    .collect();
                if planes.is_empty() && eye.value().abs().max_element() < 1e3 {
                    let eye = eye.value().as_dvec3();
                    let near = |p: DVec3| p.abs().max_element() < 1e3;
                    let report = RayOracle::new(&objects).probe(&objects, eye, &left, 24, 1, near);
                    assert!(report.seen.is_empty(), "lost {:?} of {objects:?}", report.seen[0]);
                }
            }
            Op::LookThrough { matrix } => {
                if let Ok(view) = View::from_view_projection(Mat4::from_cols_array(&matrix)) {
                    query.run(&scene, &view);
                }
            }
            Op::Time { to } => {
                let due = scene.begin_frame(to);
                assert_eq!(due.is_err(), !to.is_finite());
                for id in due.into_iter().flatten() {
                    let bounds = scene.bounds(id).expect("due objects live").clone();
                    let occluder = scene.occluder(id).expect("due objects live").cloned();
                    scene.update(id, bounds, occluder).expect("where it was");
                }
            }
            Op::EndFrame => {
                scene.end_frame([query.pvs()]).ok();
            }
            _ => {}
        }
    }
    for k in known {
        scene.remove(k.id).expect("a living object");
    }
    assert_eq!((scene.len(), scene.id_matrix().entries(), scene.tbv_matrix().volumes()), (0, 0, 0));
    assert_eq!((scene.static_opacity().count(), scene.dynamic_opacity().count()), (0, 0));
});
