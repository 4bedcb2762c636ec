//! A scene of the library, kept up to date as an application does it, with the time that takes.

use std::time::{Duration, Instant};

use casca::{Aabb, Bounds, GridSpec, ObjectDesc, ObjectId, Occluder, Query, Scene, Settings, Sphere, View};

use super::LabError;
use crate::world::{Motion, Object, Shape, World};

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
    scene: Scene,
    query: Query,
    ids: Vec<ObjectId>,
    /// By the ids' indices: the object of the world.
    objects: Vec<usize>,
    telling: Telling,
}

/// The frame of a step: `settle` steps of so many frames each, from frame 0, then one frame a step.
pub(super) fn frame_of(step: usize, settle: usize, stride: usize) -> usize {
    let settled = step.min(settle.saturating_sub(1));
    settled * stride + (step - settled)
}

/// Milliseconds of a duration.
pub(super) fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

fn shapes(object: &Object) -> Result<(Bounds, Option<Occluder>), LabError> {
    let (bounds, occluder): (Bounds, Occluder) = match &object.shape {
        Shape::Sphere { center, radius } => {
            let s = Sphere::new(*center, *radius);
            (s.into(), s.into())
        }
        Shape::Box { min, max } => {
            let b = Aabb::new(*min, *max);
            (b.into(), b.into())
        }
        Shape::Mesh { .. } => return Err("stages take spheres and boxes only".into()),
    };
    Ok((bounds, Some(occluder).filter(|_| object.occludes)))
}

impl Stage {
    /// Inserts all objects of a world, which are spheres and boxes, as they are now.
    ///
    /// # Errors
    /// Refuses meshes; else as [`Scene::insert`] and [`Query::with_settings`].
    pub(super) fn new(
        world: &World,
        grid: &GridSpec,
        settings: Settings,
        telling: Telling,
    ) -> Result<Self, LabError> {
        let mut scene = Scene::new(grid)?;
        let mut ids = Vec::with_capacity(world.objects.len());
        let mut objects = Vec::new();
        for (i, object) in world.objects.iter().enumerate() {
            let (bounds, occluder) = shapes(object)?;
            let mut desc = match object.motion {
                Motion::Static => ObjectDesc::fixed(bounds),
                Motion::Dynamic { max_speed } => ObjectDesc::dynamic(bounds).max_speed(max_speed),
            };
            if telling == Telling::OnExpiry && object.motion != Motion::Static {
                desc = desc.reported_on_expiry();
            }
            if let Some(occluder) = occluder {
                desc = desc.occluder(occluder);
            }
            let id = scene.insert(desc)?;
            objects.resize(objects.len().max(id.index() + 1), usize::MAX);
            objects[id.index()] = i;
            ids.push(id);
        }
        scene.begin_frame(0.0)?;
        Ok(Self { scene, query: Query::with_settings(settings)?, ids, objects, telling })
    }

    fn report(&mut self, all: &[Object], object: usize) -> Result<(), LabError> {
        let (Some(&id), Some(o)) = (self.ids.get(object), all.get(object)) else { return Ok(()) };
        let (bounds, occluder) = shapes(o)?;
        Ok(self.scene.update(id, bounds, occluder)?)
    }

    /// Sets the clock and reports what moved; returns the milliseconds that took.
    ///
    /// # Errors
    /// As [`Scene::begin_frame`] and [`Scene::update`].
    pub(super) fn upkeep(&mut self, now: f64, all: &[Object], moved: &[usize]) -> Result<f64, LabError> {
        let start = Instant::now();
        let mut due = self.scene.begin_frame(now)?;
        match self.telling {
            Telling::Always => moved.iter().try_for_each(|&i| self.report(all, i))?,
            Telling::OnExpiry => {
                due.extend_from_slice(self.query.pvs().visible());
                for id in due {
                    let object = self.objects[id.index()];
                    if all.get(object).is_some_and(|o| o.motion != Motion::Static) {
                        self.report(all, object)?;
                    }
                }
            }
        }
        Ok(ms(start.elapsed()))
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
        let start = Instant::now();
        self.scene.begin_frame(now)?;
        let clock = ms(start.elapsed());
        let (held, free): (Vec<usize>, Vec<usize>) =
            moved.iter().partition(|&&i| self.ids.get(i).is_some_and(|&id| self.is_held(id)));
        let mut report = |which: &[usize]| -> Result<f64, LabError> {
            let start = Instant::now();
            which.iter().try_for_each(|&i| self.report(all, i))?;
            Ok(ms(start.elapsed()))
        };
        Ok((report(&free)?, report(&held)? + clock))
    }

    fn is_held(&self, id: ObjectId) -> bool {
        matches!(self.scene.tbv(id), Ok(Some(_)))
    }

    /// Runs the query so many times, at least once, and returns the least milliseconds.
    pub(super) fn look(&mut self, view: &View, times: usize) -> f64 {
        let mut least = f64::INFINITY;
        for _ in 0..times.max(1) {
            least = least.min(ms(self.query.run(&self.scene, view).stats().elapsed));
        }
        least
    }

    /// Runs another query on the scene; returns the least milliseconds of so many runs.
    pub(super) fn ask(&self, query: &mut Query, view: &View, times: usize) -> f64 {
        let runs = (0..times.max(1)).map(|_| ms(query.run(&self.scene, view).stats().elapsed));
        runs.fold(f64::INFINITY, f64::min)
    }

    /// Feeds the last result back; returns the milliseconds that took.
    ///
    /// # Errors
    /// As [`Scene::end_frame`].
    pub(super) fn end(&mut self) -> Result<f64, LabError> {
        let start = Instant::now();
        self.scene.end_frame([self.query.pvs()])?;
        Ok(ms(start.elapsed()))
    }

    /// Whether the last result holds an object of the world.
    pub(super) fn sees(&self, object: usize) -> bool {
        self.ids.get(object).is_some_and(|&id| self.query.pvs().contains(id))
    }

    /// The objects of the world in the last result, in its order.
    pub(super) fn found(&self) -> impl Iterator<Item = usize> + '_ {
        self.query.pvs().visible().iter().map(|id| self.objects[id.index()])
    }

    /// The query, for its settings and statistics.
    pub(super) fn query(&self) -> &Query {
        &self.query
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
