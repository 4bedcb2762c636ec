//! Whether a result still holds.

use crate::pvs::Pvs;
use crate::scene::Scene;
use crate::view::View;

impl Pvs {
    /// Whether it is the set that a query would find now: no object of the scene came, went or
    /// changed since, none became due for a report, and the view is the same. `false` before the
    /// first run.
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
        self.scene == scene.tag() && self.revision == scene.revision() && self.view.as_ref() == Some(view)
    }
}
