//! The frames of a world: pages that come and go, and an origin that follows the eye.

use glam::DVec3;

use crate::error::Error;
use crate::id::ObjectId;
use crate::pvs::Pvs;
use crate::scene::origin::check_place;
use crate::scene::{FrameReport, Scene};
use crate::world::World;
use crate::world::page::{PageId, PageObjects};
use crate::world::succession::NextScene;
use crate::world::task::Task;

/// The changes that [`World::begin_frame`] made.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct WorldFrame {
    /// The objects that are due for a report: see [`Scene::begin_frame`]. After a shift, these are
    /// all that are [reported on expiry](crate::Reports::OnExpiry) and were not in sight.
    pub due: Vec<ObjectId>,
    /// The pages whose objects are all in the scene now, in the order of the calls of
    /// [`World::load`].
    pub loaded: Vec<PageId>,
    /// The pages whose objects are all gone now, in the order of the calls of
    /// [`World::drop_page`]. Until then draw those that are in the sets.
    pub dropped: Vec<PageId>,
    /// Whether the origin moved: the scene is another one, in other coordinates
    /// ([`World::origin`]), with the same ids.
    pub shifted: bool,
}

impl World {
    /// Hands over the objects of a page. The next frames take them into the scene, in order, as
    /// many as the [budget](crate::WorldOptions::budget) allows; [`WorldFrame::loaded`] tells when
    /// all are there. A page may be handed over in several parts.
    ///
    /// Costs nothing yet.
    ///
    /// # Errors
    /// Refuses a page that is more than 2^28 pages from the origin ([`Error::TooFar`]).
    pub fn load(&mut self, page: PageId, objects: PageObjects) -> Result<(), Error> {
        page.check()?;
        self.tasks.push_back(Task::Load(page, objects.0.into_iter()));
        Ok(())
    }

    /// Takes the objects of a page out of the scene in the next frames, as many as the
    /// [budget](crate::WorldOptions::budget) allows; [`WorldFrame::dropped`] tells when all are
    /// gone. Objects that wait to be taken in are dropped at once. So the page may be loaded again
    /// right away.
    ///
    /// # Errors
    /// Refuses a page of which nothing is loaded or waits for it ([`Error::UnknownPage`]).
    pub fn drop_page(&mut self, page: PageId) -> Result<(), Error> {
        let before = self.tasks.len();
        self.tasks.retain(|task| !matches!(task, Task::Load(own, _) if *own == page));
        let ids = self.pages.remove(&page);
        if ids.is_none() && self.tasks.len() == before {
            return Err(Error::UnknownPage { x: page.x, y: page.y, z: page.z });
        }
        self.tasks.push_back(Task::Drop(page, ids.unwrap_or_default().into_iter()));
        Ok(())
    }

    /// Begins a frame at a time, in seconds, with the eye at a place: takes objects of pages into
    /// the scene and out of it, lets the origin follow an eye that is far from it, and lists the
    /// objects that are due for a report, as [`Scene::begin_frame`] does.
    ///
    /// Costs the budget, or one object that alone costs more; where the origin moves, three times
    /// that; and what [`Scene::begin_frame`] costs.
    ///
    /// # Errors
    /// Refuses a time or a place that is not finite, and an eye beyond the last page: then nothing
    /// changes. [`Error::SceneFull`] if there are 2^31 objects: the one that would have come next
    /// is left out.
    pub fn begin_frame(&mut self, now: f64, eye: DVec3) -> Result<WorldFrame, Error> {
        if !now.is_finite() {
            return Err(Error::NotFinite { what: "the time", value: DVec3::splat(now) });
        }
        let mut frame = WorldFrame::default();
        self.work(eye, self.options.budget, &mut frame)?;
        frame.due = self.scene.begin_frame(now)?;
        if let Some(next) = &mut self.next {
            // Nothing is hidden there, and what is due here is due there.
            next.scene_mut().begin_frame(now)?;
        }
        Ok(frame)
    }

    /// Does all at once that the next frames would do: takes in and out what waits, and moves the
    /// origin to the eye. For the first frame, and for cuts.
    ///
    /// Call [`World::begin_frame`] after it as in any frame: nothing is listed as due here.
    ///
    /// # Errors
    /// As [`World::begin_frame`].
    pub fn settle(&mut self, eye: DVec3) -> Result<WorldFrame, Error> {
        let mut frame = WorldFrame::default();
        loop {
            self.work(eye, usize::MAX, &mut frame)?;
            if self.next.is_none() && self.options.next_origin(self.origin_page, self.page_at(eye)?).is_none()
            {
                return Ok(frame);
            }
        }
    }

    /// Ends a frame, as [`Scene::end_frame`] does. Results from before the last shift are passed
    /// over.
    ///
    /// # Errors
    /// Refuses a result of another world or scene; then nothing changes.
    pub fn end_frame<'a>(&mut self, views: impl IntoIterator<Item = &'a Pvs>) -> Result<FrameReport, Error> {
        let former = &self.former;
        self.scene.end_frame(views.into_iter().filter(|pvs| !former.contains(&pvs.scene)))
    }

    /// The scene that the last shift replaced, to be dropped on another thread: that costs about a
    /// tenth of what its objects cost to insert. The next frame drops it otherwise.
    pub fn take_retired(&mut self) -> Option<Scene> {
        self.retired.take()
    }

    fn work(&mut self, eye: DVec3, budget: usize, frame: &mut WorldFrame) -> Result<(), Error> {
        check_place("the eye", eye)?;
        let page = self.page_at(eye)?;
        self.retired = None;
        if self.next.is_none()
            && let Some(origin) = self.options.next_origin(self.origin_page, page)
        {
            self.next = Some(NextScene::new(&self.scene, origin, &self.options)?);
        }
        self.work_off(budget, frame)?;
        let (scene, sources) = (&self.scene, &self.sources);
        if self.next.as_mut().is_some_and(|next| next.step(scene, sources, budget)) {
            self.replace();
            frame.shifted = true;
        }
        Ok(())
    }

    /// Takes objects of pages in and out.
    fn work_off(&mut self, mut budget: usize, frame: &mut WorldFrame) -> Result<(), Error> {
        while budget > 0
            && let Some(task) = self.tasks.front_mut()
        {
            let cost = match task {
                Task::Load(page, objects) => {
                    let (page, desc) = (*page, objects.next());
                    let ids = self.pages.entry(page).or_default();
                    match desc {
                        Some(desc) => {
                            let id = self.commit(desc, self.corner(page), Some(page))?;
                            self.pages.entry(page).or_default().push(id);
                            self.scene.bricks_around(id)
                        }
                        None => {
                            ids.shrink_to_fit();
                            self.tasks.pop_front();
                            frame.loaded.push(page);
                            0
                        }
                    }
                }
                Task::Drop(page, ids) => match ids.next() {
                    Some(id) => {
                        let cost = self.scene.bricks_around(id);
                        // Some were removed one by one.
                        let _ = self.remove(id);
                        cost
                    }
                    None => {
                        frame.dropped.push(*page);
                        self.tasks.pop_front();
                        0
                    }
                },
            };
            budget = budget.saturating_sub(cost);
        }
        Ok(())
    }

    /// Puts the next scene in the place of this one.
    fn replace(&mut self) {
        let Some(next) = self.next.take() else { return };
        let (scene, origin_page) = next.finish(&mut self.scene);
        self.former.push(self.scene.tag());
        self.retired = Some(std::mem::replace(&mut self.scene, scene));
        self.origin_page = origin_page;
    }
}
