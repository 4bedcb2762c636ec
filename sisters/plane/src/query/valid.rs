//! Whether a result still holds.

use crate::cell::is_in_occluder;
use crate::method::Method;
use crate::pvs::Pvs;
use crate::scene::Scene;
use crate::view::View;

impl Pvs {
    /// Whether it is the set that a query would find now: no object of the scene came, went or
    /// changed since, none became due for a report, and the view is the same. `false` before the
    /// first run.
    ///
    /// A set of a view with a [reach](View::with_reach) also holds for the views of eyes within its
    /// reach, in the same layers, that look where it does and no farther: it has all objects that a
    /// query would find for these now, and may have more.
    ///
    /// ```
    /// use casca_plane::{Disc, GridSpec, ObjectDesc, Query, Scene, View};
    /// use glam::{UVec2, Vec2};
    ///
    /// # fn main() -> Result<(), casca_plane::Error> {
    /// let mut scene = Scene::new(&GridSpec { min: Vec2::ZERO, cell: 1.0, dims: UVec2::splat(16) })?;
    /// let (view, mut query) = (View::all_round(Vec2::splat(2.5))?, Query::new());
    /// let kept = query.run(&scene, &view).clone();
    /// assert!(kept.is_valid_for(&scene, &view));
    /// scene.insert(ObjectDesc::fixed(Disc::new(Vec2::splat(9.5), 1.0)))?;
    /// assert!(!kept.is_valid_for(&scene, &view));
    /// # Ok(())
    /// # }
    /// ```
    pub fn is_valid_for(&self, scene: &Scene, view: &View) -> bool {
        let fresh = self.scene == scene.tag() && self.revision == scene.revision();
        let Some(own) = self.view.as_ref().filter(|_| fresh) else { return false };
        // For other eyes of a cell, one in a solid does not count.
        let in_solid = || is_in_occluder(scene, view.eye(), scene.grid().cell_of(view.eye()));
        let counts = || self.method != Method::Cell || self.stats.eye_in_occluder || !in_solid();
        own == view || own.reach() > 0.0 && own.holds(view) && counts()
    }
}
