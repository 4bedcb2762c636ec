//! Small moving objects, of which there may be very many in sight.
//!
//! They hide nothing, so that nothing is gained by testing them before all occluders are drawn.
//! Their zones are tested then: most are out of sight, hidden, or where nothing was drawn, with all
//! that is in them. In the others, most objects are found visible by the tile or the pixel of the
//! middle of their box, which lies in them. None of that looks at the object itself, only at its box in the scene's
//! array ([`crate::scene::Scene::boxes`]).

use casca_slots::Slot;
use glam::{DVec3, Vec3A, Vec4};
use smallvec::SmallVec;

use crate::geometry::Block;
use crate::geometry::plane::HalfSpace;
use crate::id::ObjectId;
use crate::numeric::query::SINGLE_FRUSTUM;
use crate::query::point::decide::Candidate;
use crate::query::point::finder::ObjectFinder;
use crate::query::point::run::Run;
use crate::scene::Zone;
use crate::view::View;

/// A zone with fewer objects is not tested itself.
const WORTH_TESTING: usize = 3;

/// Lists the small moving objects that may be in sight. `order` is memory that is used again.
pub(super) fn find_movers(finder: &mut ObjectFinder, order: &mut Vec<(f64, u32)>) {
    let Run { scene, view, fixed_only, coherent, .. } = finder.drawing.run;
    let zones = scene.movers().zones();
    if fixed_only || view.layers() == 0 || zones.is_empty() {
        return;
    }
    // A coherent run asks nothing of tiles.
    if !coherent {
        finder.drawing.buffers_mut().note_untouched();
    }
    let planes = Planes::new(view, scene.extent());
    order.clear();
    for (index, zone) in zones.iter().enumerate() {
        if zone.plain().len() + zone.others().len() > 0 && view.may_see_volume(zone.room()) {
            order.push((finder.distance(zone.room()), index as u32));
        }
    }
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    for zone in order.iter().map(|&(_, index)| &zones[index as usize]) {
        let room = zone.room();
        let is_worth = zone.plain().len() + zone.others().len() >= WORTH_TESTING;
        if is_worth && finder.drawing.hides(room) {
            continue;
        }
        // Layers, forms with holes in their middles.
        zone.others().iter().for_each(|&slot| finder.find(slot));
        let around = Block { min: room.min - view.eye_box(), max: room.max + view.eye_box() };
        let side = planes.side_of(room);
        // A coherent run asks more of its objects.
        if coherent || view.eye().is_some_and(|eye| around.contains_point(eye)) {
            zone.plain().iter().for_each(|id| finder.find(id.slot()));
        } else {
            let is_open = is_worth && finder.drawing.buffers().is_untouched(room);
            test_boxes(finder, zone, (side, is_open), &planes);
        }
    }
    finder.settle();
}

/// Lists the objects of a zone whose boxes may be in sight of the view.
fn test_boxes(
    finder: &mut ObjectFinder,
    zone: &Zone,
    (zone_side, is_open): (BoxSide, bool),
    planes: &Planes,
) {
    let Run { scene, view, .. } = finder.drawing.run;
    let (buffers, mut tested) = (finder.drawing.buffers(), 0);
    let origin = buffers.origin();
    // Those that are overdue were found as such.
    let any_overdue = scene.any_overdue();
    for &id in zone.plain() {
        if any_overdue && finder.marks.is_decided(id.slot()) {
            continue;
        }
        let own = scene.boxes().of(id.slot());
        let (min, max) = own.corners();
        let (middle, half) = ((min + max) * 0.5, (max - min) * 0.5);
        let side = if zone_side == BoxSide::Inside { zone_side } else { planes.side(middle, half) };
        let sees = |slot: Slot| view.may_see(scene.object(slot).bounds());
        if side == BoxSide::Outside || side == BoxSide::Crosses && !sees(id.slot()) {
            continue;
        }
        tested += 1;
        if is_open || buffers.is_untouched_at(middle.as_dvec3() - origin) {
            finder.found.in_the_open.push(ObjectId(id));
            continue;
        }
        let (slot, block) = (id.slot(), Some(own.block()));
        let candidate = Candidate { slot, block, is_centered: true, occludes: false };
        finder.found.candidates.push(candidate);
    }
    finder.drawing.stats.objects_tested += tested;
}

/// Where a box is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum BoxSide {
    /// Inside of all planes.
    Inside,
    /// Outside of one.
    Outside,
    /// Neither is certain.
    Crosses,
}

/// Four planes: the points `p` with `x * p.x + y * p.y + z * p.z + w >= 0` are inside.
#[derive(Debug, Clone, Copy)]
struct Four {
    x: Vec4,
    y: Vec4,
    z: Vec4,
    w: Vec4,
    /// Values nearer to 0 decide nothing.
    margin: Vec4,
}

/// The planes of a view, in single precision by fours.
#[derive(Debug, Clone)]
struct Planes<'v> {
    exact: &'v [HalfSpace],
    fours: SmallVec<[Four; 2]>,
}

impl<'v> Planes<'v> {
    /// For boxes between two corners.
    fn new(view: &'v View, (min, max): (DVec3, DVec3)) -> Self {
        let largest = min.abs().max(max.abs()).max_element();
        let four = |planes: &[HalfSpace]| {
            // A missing plane has everything far inside.
            let of = |value: &dyn Fn(&HalfSpace) -> f64, none: f64| {
                Vec4::from_array(std::array::from_fn(|i| planes.get(i).map_or(none, value) as f32))
            };
            Four {
                x: of(&|plane| plane.normal.x, 0.0),
                y: of(&|plane| plane.normal.y, 0.0),
                z: of(&|plane| plane.normal.z, 0.0),
                w: of(&|plane| plane.offset, 1.0),
                margin: of(&|plane| SINGLE_FRUSTUM * (largest + plane.offset.abs()), 0.0),
            }
        };
        Self { exact: &view.planes, fours: view.planes.chunks(4).map(four).collect() }
    }

    /// Where a box is; in doubt, it crosses.
    #[inline]
    fn side(&self, middle: Vec3A, half: Vec3A) -> BoxSide {
        let mut side = BoxSide::Inside;
        for four in &self.fours {
            let at = four.x * middle.x + four.y * middle.y + four.z * middle.z + four.w;
            let reach = four.x.abs() * half.x + four.y.abs() * half.y + four.z.abs() * half.z + four.margin;
            if at.cmplt(-reach).any() {
                return BoxSide::Outside;
            }
            // Not written the other way round, so that a value that is not a number is doubt.
            if !at.cmpgt(reach).all() {
                side = BoxSide::Crosses;
            }
        }
        side
    }

    /// Whether a box is inside of all planes, or may cross one; asked in double precision.
    fn side_of(&self, block: &Block) -> BoxSide {
        let (middle, half) = ((block.min + block.max) * 0.5, (block.max - block.min) * 0.5);
        let largest = block.min.abs().max(block.max.abs()).max(DVec3::ZERO).max_element();
        let inside = self.exact.iter().all(|plane| {
            plane.distance(middle) >= plane.normal.abs().dot(half) + 2.0 * plane.margin(largest)
        });
        if inside { BoxSide::Inside } else { BoxSide::Crosses }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::random::Random;

    #[test]
    fn sides_agree_with_double_precision_or_are_doubtful() {
        let mut random = Random::new(8);
        let mut doubtful = 0;
        for size in [1.0, 4096.0f32] {
            let corner = DVec3::splat(f64::from(size));
            for _ in 0..60 {
                let planes: Vec<_> = (0..7)
                    .map(|_| crate::Plane {
                        normal: random.point(1.0).as_vec3(),
                        offset: (random.next() * 0.4 * f64::from(size)) as f32,
                    })
                    .collect();
                let view = View::from_planes(Vec3::ZERO, &planes).unwrap();
                let planes = Planes::new(&view, (-corner, corner));
                for _ in 0..60 {
                    let middle = random.point(f64::from(size)).as_vec3a();
                    let half = random.point(f64::from(size) * 0.05).as_vec3a().abs();
                    let (m, h) = (middle.as_dvec3(), half.as_dvec3());
                    let reach = |plane: &HalfSpace| plane.normal.abs().dot(h);
                    let outside = view.planes.iter().any(|p| p.distance(m) < -reach(p));
                    let inside = view.planes.iter().all(|p| p.distance(m) > reach(p));
                    match planes.side(middle, half) {
                        BoxSide::Inside => assert!(inside),
                        BoxSide::Outside => assert!(outside),
                        BoxSide::Crosses => doubtful += usize::from(inside || outside),
                    }
                }
            }
        }
        assert!(doubtful < 20, "{doubtful}");
        let everything = View::omnidirectional(Vec3::ZERO).unwrap();
        let planes = Planes::new(&everything, (DVec3::ZERO, DVec3::splat(8.0)));
        assert_eq!(planes.side(Vec3A::ONE, Vec3A::ONE), BoxSide::Inside);
    }
}
