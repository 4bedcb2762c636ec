//! Ways to know the visible objects of every frame.

use casca::{KeptJob, KeptOptions, KeptQuery, KeptResult, Method, PointOptions, Pvs, Query, Scene, View};

use super::super::LabError;

/// A way to know the visible objects of every frame. It has a scene of its own, which is kept up to
/// date and gets its results back ([`Scene::end_frame`]).
pub struct Way {
    /// Its name in tables.
    pub name: String,
    engine: Engine,
}

enum Engine {
    /// A query that runs in every frame.
    EachFrame(Box<Query>),
    /// A query that answers frames from one result about static objects while that holds.
    Kept(Box<KeptQuery>),
    /// The same, with results that another thread finds: one job after the other, each of which is
    /// done when the next frame begins.
    Aside(Box<KeptQuery>, Option<Box<KeptJob>>, Option<Box<KeptResult>>),
}

impl Way {
    /// Answers a frame; its time is measured.
    pub fn frame(&mut self, scene: &Scene, view: &View) {
        match &mut self.engine {
            Engine::EachFrame(query) => _ = query.run(scene, view),
            Engine::Kept(query) => _ = query.run(scene, view),
            Engine::Aside(query, job, found) => {
                if let Some(found) = found.take() {
                    query.install(*found, scene);
                }
                query.run(scene, view);
                *job = Some(Box::new(query.prepare(scene, view)));
            }
        }
    }

    /// Does the work of another thread until the next frame; its time is not measured.
    pub fn work_aside(&mut self) {
        if let Engine::Aside(_, job, found) = &mut self.engine {
            *found = job.take().map(|job| Box::new(job.run()));
        }
    }

    /// The answer of the last frame.
    pub fn pvs(&self) -> &Pvs {
        match &self.engine {
            Engine::EachFrame(query) => query.pvs(),
            Engine::Kept(query) | Engine::Aside(query, ..) => query.pvs(),
        }
    }
}

/// The ways that are compared; the others are measured against the first.
///
/// # Errors
/// If the library refuses the options of one.
pub fn ways() -> Result<Vec<Way>, LabError> {
    let options = PointOptions::default();
    let mut all = Vec::new();
    for (name, options) in [("fresh", options), ("coherent", options.coherent(true))] {
        let query = Query::with_method(Method::Point(options))?;
        all.push(Way { name: name.to_owned(), engine: Engine::EachFrame(Box::new(query)) });
    }
    let (usual, small) = (KeptOptions::new(), KeptOptions::new().reach(0.06).turn(f32::to_radians(5.0)));
    for (options, aside) in [(usual, false), (small, true), (usual, true)] {
        let query = Box::new(KeptQuery::with_options(options)?);
        let name = format!("kept, {} m, {:.0} degrees", options.reach, options.turn.to_degrees());
        all.push(match aside {
            true => Way { name: name + ", another thread", engine: Engine::Aside(query, None, None) },
            false => Way { name, engine: Engine::Kept(query) },
        });
    }
    Ok(all)
}
