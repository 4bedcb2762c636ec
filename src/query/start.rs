//! Where the rays of a view start.

use glam::DVec3;
use smallvec::SmallVec;

use crate::geometry::Block;
use crate::object::Occluder;
use crate::scene::{Scene, inside_occluder, occluder_touches};
use crate::view::cut::may_start_in;
use crate::view::{Origin, View};

/// The regions where rays of a view may start beside its eye, each with its box.
#[derive(Debug)]
pub(crate) struct Starts {
    /// Between the eye and the near plane.
    cut: SmallVec<[(View, Block); 1]>,
    /// Where an eye may be that is not known exactly, or that may go elsewhere.
    unsure: Option<(View, Block)>,
}

impl Starts {
    /// The regions as far as they lie in the scene.
    pub(crate) fn of(scene: &Scene, view: &View) -> Self {
        let (min, max) = scene.extent();
        Self { cut: view.cut_regions(min, max).collect(), unsure: view.eye_region() }
    }

    /// Whether an occluder, or an opaque cell, may touch one of the regions.
    pub(crate) fn touch_occluder(&self, scene: &Scene) -> bool {
        self.regions().any(|(region, around)| occluder_touches(scene, region, around))
    }

    /// Those between the eye and the near plane.
    pub(crate) fn cut(&self) -> &[(View, Block)] {
        &self.cut
    }

    /// All regions.
    fn regions(&self) -> impl Iterator<Item = &(View, Block)> {
        self.cut.iter().chain(&self.unsure)
    }

    /// A box around an eye and the regions.
    pub(crate) fn around(&self, eye: DVec3) -> Block {
        self.regions().fold(Block { min: eye, max: eye }, |all, (_, around)| Block {
            min: all.min.min(around.min),
            max: all.max.max(around.max),
        })
    }

    /// Whether rays of the view may start inside an occluder, so that one sees through it; in
    /// doubt, yes.
    pub(crate) fn may_be_in(&self, view: &View, occluder: &Occluder) -> bool {
        may_start_in(view, &self.cut, self.unsure.as_ref(), occluder)
    }
}

/// Whether rays may start inside an occluder: at the eye, or in one of the regions. One then sees
/// through its inside, so the cells that it makes opaque hide nothing.
pub(crate) fn rays_start_in_occluder(scene: &Scene, view: &View, starts: &Starts) -> bool {
    match view.origin {
        Origin::Eye { at, .. } => inside_occluder(scene, at, view.layers()) || starts.touch_occluder(scene),
        Origin::Direction(_) => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Aabb, Sphere};
    use crate::object::ObjectDesc;
    use crate::query::Query;

    #[test]
    fn a_camera_in_its_collider_sees_through_that_one_only() {
        let block = |min: [f32; 3], max: [f32; 3]| Aabb::new(min.into(), max.into());
        let ball = |x: f32, radius| Sphere::new(glam::Vec3::new(x, 16.5, 16.5), radius);
        // The last one abuts the wall, so that cells of both are drawn together.
        let wall = block([8.0, 0.0, 0.0], [10.0, 32.0, 32.0]);
        let boxes = [block([1.1, 15.1, 15.1], [4.2, 18.3, 18.3]), block([0.0, 8.0, 8.0], [8.0, 24.0, 24.0])];
        for collider in boxes.map(Occluder::from).into_iter().chain([ball(2.5, 1.5).into()]) {
            let around = collider.block().to_aabb();
            for desc in [ObjectDesc::fixed(around), ObjectDesc::dynamic(around)] {
                let mut scene = Scene::new(1.0).unwrap();
                scene.insert(ObjectDesc::fixed(wall).occluder(wall)).unwrap();
                let own = scene.insert(desc.occluder(collider.clone())).unwrap();
                let behind = scene.insert(ObjectDesc::fixed(ball(20.0, 1.0))).unwrap();
                scene.begin_frame(0.0).unwrap();
                let mut query = Query::new();
                let view = View::omnidirectional(ball(2.5, 0.0).center).unwrap();
                let pvs = query.run(&scene, &view);
                assert!(pvs.contains(own) && pvs.stats().eye_in_occluder);
                assert!(!pvs.contains(behind), "{around:?}");
            }
        }
    }
}
