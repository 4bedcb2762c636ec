//! A scene of the library, kept up to date as an application does it, with the time that takes.

use std::time::Duration;

use casca::{Method, ObjectDesc, ObjectId, Query, View};

use super::LabError;
use casca_scenes::drive::Driver;
use casca_scenes::measure::{ThreadTime, timed};
use casca_scenes::world::{Motion, Object, World};

/// How the motion of hidden objects is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Telling {
    /// Every motion in every frame.
    Always,
    /// That of visible objects in every frame, of hidden ones when their volume expires: the
    /// thesis' way.
    OnExpiry,
}

/// A scene with one query that is fed back to it.
pub(super) struct Stage {
    driver: Driver,
    query: Query,
    /// By the ids' indices: the object of the world.
    objects: Vec<usize>,
    telling: Telling,
}

/// The frame of a step: `settle` steps of `stride` frames each from frame 0, then single frames.
pub(super) fn frame_of(step: usize, settle: usize, stride: usize) -> usize {
    let settled = step.min(settle.saturating_sub(1));
    settled * stride + (step - settled)
}

/// Milliseconds of a duration.
pub(super) fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

impl Stage {
    /// Inserts all objects of a world as they are now.
    ///
    /// # Errors
    /// As [`Driver::with`] and [`Query::with_method`].
    pub(super) fn new(world: &World, cell: f32, method: Method, telling: Telling) -> Result<Self, LabError> {
        let unreported = |o: &Object| telling == Telling::OnExpiry && o.motion != Motion::Static;
        let adapt =
            |o: &Object, desc: ObjectDesc| if unreported(o) { desc.reported_on_expiry() } else { desc };
        let mut driver = Driver::with(&world.objects, cell, None, adapt, |_| ())?;
        let mut objects = Vec::new();
        for i in 0..world.objects.len() {
            let slot = driver.id(i).index();
            objects.resize(objects.len().max(slot + 1), usize::MAX);
            objects[slot] = i;
        }
        driver.scene.begin_frame(0.0)?;
        Ok(Self { driver, query: Query::with_method(method)?, objects, telling })
    }

    /// Sets the clock and reports what moved; returns the milliseconds that took. The shapes that
    /// are reported are made before.
    ///
    /// # Errors
    /// As [`casca::Scene::begin_frame`] and [`casca::Scene::update`].
    pub(super) fn upkeep(&mut self, now: f64, all: &[Object], moved: &[usize]) -> Result<f64, LabError> {
        let start = ThreadTime::now();
        let mut due = self.driver.scene.begin_frame(now)?;
        let mut clock = start.elapsed();
        let reports = match self.telling {
            Telling::Always => self.driver.reports(all, moved)?,
            Telling::OnExpiry => {
                let start = ThreadTime::now();
                due.extend_from_slice(self.query.pvs().visible());
                // Reports are cheapest in the order of slots.
                due.sort_unstable_by_key(|id| id.index());
                clock += start.elapsed();
                let mut which: Vec<usize> = due.iter().map(|id| self.objects[id.index()]).collect();
                which.retain(|&i| all.get(i).is_some_and(|o| o.motion != Motion::Static));
                self.driver.reports(all, &which)?
            }
        };
        let start = ThreadTime::now();
        self.driver.tell(reports)?;
        Ok(ms(clock + start.elapsed()))
    }

    /// As [`Stage::upkeep`], telling everything: the milliseconds for objects that no volume
    /// holds, and for those that one holds.
    ///
    /// # Errors
    /// As [`Stage::upkeep`].
    pub(super) fn upkeep_split(
        &mut self,
        now: f64,
        all: &[Object],
        moved: &[usize],
    ) -> Result<(f64, f64), LabError> {
        let start = ThreadTime::now();
        self.driver.scene.begin_frame(now)?;
        let clock = ms(start.elapsed());
        let (held, free): (Vec<usize>, Vec<usize>) =
            moved.iter().partition(|&&i| self.is_held(self.driver.id(i)));
        let mut report = |which: &[usize]| -> Result<f64, LabError> {
            let reports = self.driver.reports(all, which)?;
            let start = ThreadTime::now();
            self.driver.tell(reports)?;
            Ok(ms(start.elapsed()))
        };
        Ok((report(&free)?, report(&held)? + clock))
    }

    fn is_held(&self, id: ObjectId) -> bool {
        matches!(self.driver.scene.tbv(id), Ok(Some(_)))
    }

    /// Runs the query this many times, at least once, and returns the least milliseconds.
    pub(super) fn look(&mut self, view: &View, times: usize) -> f64 {
        let mut least = f64::INFINITY;
        for _ in 0..times.max(1) {
            least = least.min(ms(timed(|| self.query.run(&self.driver.scene, view)).1));
        }
        least
    }

    /// Runs another query on the scene; returns the milliseconds that took.
    pub(super) fn ask(&self, query: &mut Query, view: &View) -> f64 {
        ms(timed(|| query.run(&self.driver.scene, view)).1)
    }

    /// Feeds the last result back; returns the milliseconds that took.
    ///
    /// # Errors
    /// As [`casca::Scene::end_frame`].
    pub(super) fn end(&mut self) -> Result<f64, LabError> {
        let start = ThreadTime::now();
        self.driver.scene.end_frame([self.query.pvs()])?;
        Ok(ms(start.elapsed()))
    }

    /// Whether the last result holds an object of the world.
    pub(super) fn sees(&self, object: usize) -> bool {
        self.driver.sees(self.query.pvs(), object)
    }

    /// The objects of the world in the last result, in its order.
    pub(super) fn found(&self) -> impl Iterator<Item = usize> + '_ {
        self.query.pvs().visible().iter().map(|id| self.objects[id.index()])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_measured_follows_the_last_step_of_settling_by_a_frame() {
        let frames = |settle| (0..6).map(|s| frame_of(s, settle, 10)).collect::<Vec<_>>();
        assert_eq!(frames(3), [0, 10, 20, 21, 22, 23]);
        assert_eq!(frames(0), [0, 1, 2, 3, 4, 5]);
    }
}
