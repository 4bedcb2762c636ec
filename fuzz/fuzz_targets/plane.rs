//! Plays arbitrary operations on a scene in the plane, sane and insane, and checks that nothing panics, that refused calls change
//! nothing, and that no query leaves out an object that a segment from the eye reaches with room to spare.
#![no_main]

use arbitrary::Arbitrary;
use casca_plane::{Disc, GridSpec, ObjectDesc, ObjectId, Query, Rect, Scene, Segment, Shape, View};
use glam::{DVec2, UVec2, Vec2};
use libfuzzer_sys::fuzz_target;

#[allow(dead_code, reason = "this target needs no points of space")]
mod coordinates;
use coordinates::Coordinate;

/// A segment that keeps this far from all occluders, in units of the grid, sees its end.
const ROOM: f64 = 1e-3;

#[derive(Debug, Clone, Copy, Arbitrary)]
struct Place(Coordinate, Coordinate);

impl Place {
    fn value(self) -> Vec2 {
        Vec2::new(self.0.value(), self.1.value())
    }
}

#[derive(Debug, Clone, Copy, Arbitrary)]
enum AnyShape {
    Disc(Place, Coordinate),
    Rect(Place, Place),
    Between(Place, Place),
    Segment(Place, Place),
}

impl AnyShape {
    fn shape(self) -> Shape {
        match self {
            Self::Disc(center, radius) => Disc::new(center.value(), radius.value()).into(),
            Self::Rect(a, b) => Rect::new(a.value(), b.value()).into(),
            Self::Between(a, b) => {
                let (a, b) = (a.value(), b.value());
                Rect::new(a.min(b), a.max(b)).into()
            }
            Self::Segment(a, b) => Segment::new(a.value(), b.value()).into(),
        }
    }
}

#[derive(Debug, Arbitrary)]
enum Op {
    Insert { shape: AnyShape, occludes: bool },
    Update { which: u8, shape: AnyShape },
    Remove { which: u8 },
    UseStale { which: u8, shape: AnyShape },
    Look { eye: Place, sector: Option<(Place, Coordinate)>, range: Option<Coordinate> },
}

#[derive(Debug, Arbitrary)]
struct Play {
    grid: (Place, Coordinate, [u16; 2]),
    ops: Vec<Op>,
}

struct Known {
    id: ObjectId,
    shape: Shape,
    occludes: bool,
}

/// Corners of a shape, and its middle.
fn corners(shape: &Shape) -> Vec<DVec2> {
    match shape {
        Shape::Disc(d) => vec![d.center.as_dvec2()],
        Shape::Rect(r) => r.corners().map(|p| p.as_dvec2()).to_vec(),
        Shape::Segment(s) => vec![s.a.as_dvec2(), s.b.as_dvec2()],
        _ => Vec::new(),
    }
}

fn to_segment(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let way = b - a;
    let share = ((p - a).dot(way) / way.length_squared()).clamp(0.0, 1.0);
    p.distance(if share.is_nan() { a } else { a + way * share })
}

/// The distance of two segments.
fn between([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> f64 {
    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
    if side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0 {
        return 0.0;
    }
    let ends = [to_segment(a, c, d), to_segment(b, c, d), to_segment(c, a, b), to_segment(d, a, b)];
    ends.into_iter().fold(f64::INFINITY, f64::min)
}

/// How far a segment keeps from a shape.
fn clearance(segment: [DVec2; 2], shape: &Shape) -> f64 {
    match shape {
        Shape::Disc(d) => to_segment(d.center.as_dvec2(), segment[0], segment[1]) - f64::from(d.radius),
        Shape::Rect(r) => {
            let [a, b, c, d] = r.corners().map(|p| p.as_dvec2());
            let inside = |p: DVec2| p.cmpge(r.min.as_dvec2()).all() && p.cmple(r.max.as_dvec2()).all();
            let sides = [[a, b], [b, c], [c, d], [d, a]].map(|side| between(segment, side));
            if segment.into_iter().any(inside) {
                0.0
            } else {
                sides.into_iter().fold(f64::INFINITY, f64::min)
            }
        }
        Shape::Segment(s) => between(segment, [s.a.as_dvec2(), s.b.as_dvec2()]),
        _ => 0.0,
    }
}

fn look(scene: &Scene, known: &[Known], view: &View, query: &mut Query) {
    let eye = view.eye();
    let sees = |p: DVec2| {
        let way = p - eye;
        let inside = view.direction().is_none_or(|d| way.angle_to(d).abs() < view.half_angle() - ROOM);
        inside && view.range().is_none_or(|range| way.length() < range - ROOM) && way.length() < 1e4
    };
    let visible = |object: &Known| {
        corners(&object.shape).into_iter().filter(|&p| sees(p)).any(|p| {
            let others = known.iter().filter(|k| k.occludes && k.id != object.id);
            // Its own occluder comes before it, but at the near side.
            let own = object.occludes && clearance([eye, p.lerp(eye, 1e-2)], &object.shape) < ROOM;
            !own && others.map(|k| clearance([eye, p], &k.shape)).all(|room| room > ROOM)
        })
    };
    let pvs = query.run(scene, view);
    assert!(pvs.iter().all(|id| scene.contains(id)));
    for object in known {
        assert!(pvs.contains(object.id) || !visible(object), "it lacks {:?} from {eye}", object.shape);
    }
}

fuzz_target!(|play: Play| {
    // A grid of anything must be taken or refused; the play then goes on in a plain one.
    let (min, cell, dims) = play.grid;
    let dims = UVec2::from_array(dims.map(|n| u32::from(n) % 100));
    let _ = Scene::new(&GridSpec { min: min.value(), cell: cell.value(), dims });
    let mut scene =
        Scene::new(&GridSpec { min: Vec2::ZERO, cell: 1.0, dims: UVec2::splat(24) }).expect("a plain grid");
    let mut query = Query::new();
    let mut known: Vec<Known> = Vec::new();
    let mut gone: Vec<ObjectId> = Vec::new();
    for op in play.ops.into_iter().take(64) {
        let count = scene.len();
        match op {
            Op::Insert { shape, occludes } => {
                let shape = shape.shape();
                let mut desc = ObjectDesc::new(shape.clone());
                if occludes {
                    desc = desc.occluder(shape.clone());
                }
                match scene.insert(desc) {
                    Ok(id) => known.push(Known { id, shape, occludes }),
                    Err(_) => assert_eq!(scene.len(), count),
                }
            }
            Op::Update { which, shape } if !known.is_empty() => {
                let index = usize::from(which) % known.len();
                let object = &mut known[index];
                let shape = shape.shape();
                let occluder = object.occludes.then(|| shape.clone());
                if scene.update(object.id, shape.clone(), occluder).is_ok() {
                    object.shape = shape;
                }
            }
            Op::Remove { which } if !known.is_empty() => {
                let object = known.swap_remove(usize::from(which) % known.len());
                scene.remove(object.id).expect("it is there");
                gone.push(object.id);
            }
            Op::UseStale { which, shape } if !gone.is_empty() => {
                let id = gone[usize::from(which) % gone.len()];
                assert!(scene.update(id, shape.shape(), None).is_err() && scene.remove(id).is_err());
            }
            Op::Look { eye, sector, range } => {
                let view = match sector {
                    Some((toward, angle)) => View::sector(eye.value(), toward.value(), angle.value()),
                    None => View::all_round(eye.value()),
                };
                let view = view.and_then(|view| match range {
                    Some(range) => view.with_range(range.value()),
                    None => Ok(view),
                });
                if let Ok(view) = view {
                    look(&scene, &known, &view, &mut query);
                }
            }
            _ => {}
        }
    }
});
