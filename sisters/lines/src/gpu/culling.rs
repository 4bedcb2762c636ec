//! Bundles of lines as objects of a scene, in which context hides them.
//!
//! Lines fill a fraction of a pixel, so they hide nothing here: only context does. A pixel shows
//! lines that are at most [`Settings::reach`] away from a point that the eye sees. A bundle whose
//! bounds, inflated by that reach, are hidden holds no such line. So a picture without it is the
//! same in every pixel.
//!
//! [`Settings::reach`]: crate::gpu::settings::Settings::reach

use casca::{Aabb, ObjectDesc, ObjectId, Query, Scene, cell_for};
use glam::Vec3;

use crate::gpu::context::Context;
use crate::gpu::error::LinesGpuError;
use crate::gpu::lens::view_of_scene;
use crate::gpu::numeric::{GRID_ROOM, LEAST_EXTENT};
use crate::gpu::set::Bundle;
use crate::view::View;

/// The user data of context.
const CONTEXT: u64 = u64::MAX;

/// The bundles that a frame needs, by their numbers, ascending.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Seen {
    /// Those that a pixel may show.
    pub drawn: Vec<u32>,
}

impl Seen {
    /// All of so many bundles.
    pub fn all(bundles: usize) -> Self {
        Self { drawn: (0..bundles as u32).collect() }
    }
}

/// Follows the bundles of a set, and says which of them a view needs.
pub struct Culling {
    scene: Scene,
    query: Query,
    objects: Vec<ObjectId>,
    bounds: Vec<Aabb>,
    /// By how much the bounds of the objects are inflated; NaN if not all of them are inflated
    /// alike.
    inflated: f32,
}

impl Culling {
    /// A scene of the bundles and of context.
    ///
    /// # Errors
    /// If a box of the context or the bounds of a bundle are not finite, or all of them lie at one
    /// place so far from the origin that no grid is possible.
    pub fn new(bundles: &[Bundle], context: &[Context]) -> Result<Self, LinesGpuError> {
        let bounds: Vec<Aabb> = bundles.iter().map(|b| Aabb::new(b.bounds[0], b.bounds[1])).collect();
        let hiding = || context.iter().flat_map(Context::occluders);
        let all = bounds.iter().chain(hiding().map(|(bounds, _)| bounds));
        let joined = all.copied().reduce(|a, b| Aabb::new(a.min.min(b.min), a.max.max(b.max)));
        let region = joined.unwrap_or(Aabb::new(Vec3::ZERO, Vec3::ONE));
        let size = (region.max - region.min)
            .max_element()
            .max(region.max.abs().max_element() * LEAST_EXTENT)
            .max(LEAST_EXTENT);
        let region = inflate(&region, size * GRID_ROOM);
        let mut scene = Scene::new(cell_for(region, bounds.len() + hiding().count())?)?;
        for (bounds, occluder) in hiding() {
            scene.insert(ObjectDesc::fixed(*bounds).occluder(occluder.clone()).user_data(CONTEXT))?;
        }
        let insert = |(i, b): (usize, &Aabb)| scene.insert(ObjectDesc::dynamic(*b).user_data(i as u64));
        let objects = bounds.iter().enumerate().map(insert).collect::<Result<_, _>>()?;
        Ok(Self { scene, query: Query::new(), objects, bounds, inflated: 0.0 })
    }

    /// The bundles have moved; there may be more or fewer of them.
    ///
    /// # Errors
    /// If the bounds of a bundle are not finite.
    pub fn follow(&mut self, bundles: &[Bundle]) -> Result<(), LinesGpuError> {
        self.bounds = bundles.iter().map(|b| Aabb::new(b.bounds[0], b.bounds[1])).collect();
        // After an error, the reach of the next view decides.
        self.place(if self.inflated.is_nan() { 0.0 } else { self.inflated })
    }

    /// Puts the objects of all bundles where their bounds are, inflated by `by`. After an error no
    /// reach is that of the objects, so that the next view places them anew instead of trusting
    /// bounds that are too small.
    fn place(&mut self, by: f32) -> Result<(), LinesGpuError> {
        self.inflated = f32::NAN;
        while self.objects.len() > self.bounds.len() {
            self.objects.pop().map_or(Ok(()), |gone| self.scene.remove(gone))?;
        }
        for (i, bounds) in self.bounds.iter().enumerate() {
            let bounds = inflate(bounds, by);
            match self.objects.get(i) {
                Some(&object) => self.scene.update(object, bounds, None)?,
                None => {
                    self.objects.push(self.scene.insert(ObjectDesc::dynamic(bounds).user_data(i as u64))?)
                }
            }
        }
        self.inflated = by;
        Ok(())
    }

    /// The bundles that a view needs, if it shows lines so far from what the eye sees. Costs a
    /// query; if the reach is another than in the last call, also an update of each bundle.
    ///
    /// # Errors
    /// If the scene refuses the view, or bounds with this reach: they must be finite.
    pub fn look(&mut self, view: &View, reach: f32) -> Result<Seen, LinesGpuError> {
        if reach != self.inflated {
            self.place(reach)?;
        }
        let pvs = self.query.run(&self.scene, &view_of_scene(view)?);
        let bundle = |id| self.scene.user_data(id).ok().and_then(|data| u32::try_from(data).ok());
        let mut drawn: Vec<u32> = pvs.iter().filter_map(bundle).collect();
        drawn.sort_unstable();
        Ok(Seen { drawn })
    }
}

fn inflate(b: &Aabb, by: f32) -> Aabb {
    Aabb::new(b.min - Vec3::splat(by), b.max + Vec3::splat(by))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn after_a_refused_reach_or_motion_no_view_is_answered_from_old_bounds() {
        let bundle = |at: Vec3| Bundle { bounds: [at, at + 0.1], first: 0, segments: 1 };
        let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, None, [64, 48]).unwrap();
        let mut culling = Culling::new(&[bundle(Vec3::ZERO), bundle(Vec3::X * 0.5)], &[]).unwrap();
        assert_eq!(culling.look(&view, 0.1).unwrap().drawn, [0, 1]);
        for _ in 0..2 {
            assert!(culling.look(&view, f32::INFINITY).is_err());
        }
        assert_eq!(culling.look(&view, 0.1).unwrap().drawn, [0, 1]);
        assert!(culling.follow(&[bundle(Vec3::ZERO), bundle(Vec3::NAN), bundle(Vec3::ONE)]).is_err());
        for _ in 0..2 {
            assert!(culling.look(&view, 0.1).is_err());
        }
        culling.follow(&[bundle(Vec3::ZERO), bundle(Vec3::X * 0.5), bundle(Vec3::Y * 0.5)]).unwrap();
        assert_eq!(culling.look(&view, 0.1).unwrap().drawn, [0, 1, 2]);
    }
}
