//! Ways to know the visible objects of every frame.

use casca::{KeptJob, KeptOptions, KeptQuery, KeptResult, Method, PointOptions, Pvs, Query, Scene, View};

use super::super::LabError;

/// A way to know the visible objects of every frame. It has a scene of its own, which is kept up to
/// date and gets its results back ([`Scene::end_frame`]).
pub trait Way {
    /// Its name in tables.
    fn name(&self) -> String;

    /// Answers a frame; its time is measured.
    ///
    /// # Errors
    /// Those of the library.
    fn frame(&mut self, scene: &Scene, view: &View) -> Result<(), LabError>;

    /// Does the work of another thread until the next frame; its time is not measured.
    fn work_aside(&mut self) {}

    /// The answer of the last frame.
    fn pvs(&self) -> &Pvs;
}

/// The ways that are compared; the others are measured against the first.
///
/// # Errors
/// If the library refuses the options of one.
pub fn ways() -> Result<Vec<Box<dyn Way>>, LabError> {
    let options = PointOptions::default();
    let mut all: Vec<Box<dyn Way>> = vec![
        Box::new(EachFrame::new("fresh", options)?),
        Box::new(EachFrame::new("coherent", options.coherent(true))?),
    ];
    for (reach, turn) in [(0.05, 5.0), (0.1, 6.0), (0.2, 10.0)] {
        all.push(Box::new(Kept::new(reach, turn)?));
    }
    for (reach, turn) in [(0.02, 3.0), (0.05, 5.0)] {
        all.push(Box::new(KeptAside { kept: Kept::new(reach, turn)?, job: None, found: None }));
    }
    Ok(all)
}

/// A query that runs in every frame.
struct EachFrame {
    name: &'static str,
    query: Query,
}

impl EachFrame {
    fn new(name: &'static str, options: PointOptions) -> Result<Self, LabError> {
        Ok(Self { name, query: Query::with_method(Method::Point(options))? })
    }
}

impl Way for EachFrame {
    fn name(&self) -> String {
        self.name.to_owned()
    }

    fn frame(&mut self, scene: &Scene, view: &View) -> Result<(), LabError> {
        self.query.run(scene, view);
        Ok(())
    }

    fn pvs(&self) -> &Pvs {
        self.query.pvs()
    }
}

/// A query that answers frames from one result about static objects while that holds.
struct Kept {
    query: KeptQuery,
    options: KeptOptions,
}

impl Kept {
    fn new(reach: f32, turn: f32) -> Result<Self, LabError> {
        let options = KeptOptions::new().reach(reach).turn(turn.to_radians());
        Ok(Self { query: KeptQuery::with_options(options)?, options })
    }
}

impl Way for Kept {
    fn name(&self) -> String {
        format!("kept, {} m, {:.0} degrees", self.options.reach, self.options.turn.to_degrees())
    }

    fn frame(&mut self, scene: &Scene, view: &View) -> Result<(), LabError> {
        self.query.run(scene, view);
        Ok(())
    }

    fn pvs(&self) -> &Pvs {
        self.query.pvs()
    }
}

/// A kept query whose results are found by another thread: one job after the other, each of which
/// is done when the next frame begins.
struct KeptAside {
    kept: Kept,
    job: Option<KeptJob>,
    found: Option<KeptResult>,
}

impl Way for KeptAside {
    fn name(&self) -> String {
        format!("{}, another thread", self.kept.name())
    }

    fn frame(&mut self, scene: &Scene, view: &View) -> Result<(), LabError> {
        if let Some(found) = self.found.take() {
            self.kept.query.install(found, scene);
        }
        self.kept.query.run(scene, view);
        self.job = Some(self.kept.query.prepare(scene, view));
        Ok(())
    }

    fn work_aside(&mut self) {
        self.found = self.job.take().map(KeptJob::run);
    }

    fn pvs(&self) -> &Pvs {
        self.kept.pvs()
    }
}
