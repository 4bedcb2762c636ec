//! Ways to know the visible objects of every frame.

use casca::{KeptOptions, KeptQuery, Method, PointOptions, Pvs, Query, Scene, View};

use super::super::LabError;
use crate::world::Camera;

/// A frame, as all ways get it.
#[derive(Debug, Clone, Copy)]
pub struct FrameView<'a> {
    /// The view of the camera.
    pub view: &'a View,
    /// The camera.
    pub camera: &'a Camera,
}

/// A way to know the visible objects of every frame. It has a scene of its own, which is kept up to date and gets its
/// results back ([`Scene::end_frame`]).
pub trait Way {
    /// Its name in tables.
    fn name(&self) -> String;

    /// Answers a frame; its time is measured.
    ///
    /// # Errors
    /// Those of the library.
    fn frame(&mut self, scene: &Scene, frame: &FrameView) -> Result<(), LabError>;

    /// The answer of the last frame.
    fn pvs(&self) -> &Pvs;
}

/// The ways that are compared; the others are measured against the first. `movers` tells how many objects move.
///
/// # Errors
/// If the library refuses the options of one.
pub fn ways(movers: usize) -> Result<Vec<Box<dyn Way>>, LabError> {
    let options = PointOptions::default();
    let mut all: Vec<Box<dyn Way>> = vec![
        Box::new(EachFrame::new("fresh", options)?),
        Box::new(EachFrame::new("coherent", options.coherent(true))?),
    ];
    for (reach, turn) in [(0.05, 5.0), (0.1, 6.0), (0.2, 10.0)] {
        all.push(Box::new(Kept::new(reach, turn, false)?));
        all.push(Box::new(Kept::new(reach, turn, true)?));
    }
    // A visible object that moves ends the validity of any set.
    if movers == 0 {
        for (reach, turn) in [(0.05, 3.0), (0.1, 6.0), (0.25, 15.0)] {
            all.push(Box::new(Reuse::new(reach, turn)?));
        }
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

    fn frame(&mut self, scene: &Scene, frame: &FrameView) -> Result<(), LabError> {
        self.query.run(scene, frame.view);
        Ok(())
    }

    fn pvs(&self) -> &Pvs {
        self.query.pvs()
    }
}

/// A query for all eyes within a reach and all turns up to an angle, run again once its set is no longer valid.
struct Reuse {
    query: Query,
    reach: f32,
    /// In degrees.
    turn: f32,
}

impl Reuse {
    fn new(reach: f32, turn: f32) -> Result<Self, LabError> {
        Ok(Self { query: Query::with_method(Method::point())?, reach, turn })
    }
}

impl Way for Reuse {
    fn name(&self) -> String {
        format!("reuse, {} m, {} degrees", self.reach, self.turn)
    }

    fn frame(&mut self, scene: &Scene, frame: &FrameView) -> Result<(), LabError> {
        if !self.query.pvs().is_valid_for(scene, frame.view) {
            let view = frame.view.clone().with_reach(self.reach)?.with_turn(self.turn.to_radians())?;
            self.query.run(scene, &view);
        }
        Ok(())
    }

    fn pvs(&self) -> &Pvs {
        self.query.pvs()
    }
}

/// A query that keeps what it found about static objects.
struct Kept {
    query: KeptQuery,
    options: KeptOptions,
    coherent: bool,
}

impl Kept {
    fn new(reach: f32, turn: f32, coherent: bool) -> Result<Self, LabError> {
        let options = KeptOptions::new().reach(reach).turn(turn.to_radians());
        let mut query = KeptQuery::with_options(options)?;
        query.set_point_options(PointOptions::default().coherent(coherent))?;
        Ok(Self { query, options, coherent })
    }
}

impl Way for Kept {
    fn name(&self) -> String {
        format!(
            "kept{}, {} m, {:.0} degrees",
            if self.coherent { " coherent" } else { "" },
            self.options.reach,
            self.options.turn.to_degrees()
        )
    }

    fn frame(&mut self, scene: &Scene, frame: &FrameView) -> Result<(), LabError> {
        self.query.run(scene, frame.view);
        Ok(())
    }

    fn pvs(&self) -> &Pvs {
        self.query.pvs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use casca::{GridSpec, ObjectDesc, Sphere};
    use glam::{UVec3, Vec3};

    use crate::drive::view_of;

    #[test]
    fn a_set_is_reused_until_the_camera_has_gone_or_turned_too_far() {
        let mut scene = Scene::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(32) }).unwrap();
        scene.insert(ObjectDesc::fixed(Sphere::new(Vec3::splat(16.0), 1.0))).unwrap();
        let camera = |step: f32, turn: f32| {
            let eye = Vec3::new(16.0, 16.0, 4.0 + step);
            let (sin, cos) = turn.to_radians().sin_cos();
            Camera::look_at(eye, eye + Vec3::new(sin, 0.0, cos), 60.0, 1.5, 0.1, 100.0)
        };
        let mut reuse = Reuse::new(0.25, 15.0).unwrap();
        for (step, turn, valid) in [
            (0.0, 0.0, false),
            (0.2, 10.0, true),
            (-0.2, -14.0, true),
            (0.0, 20.0, false),
            (0.3, 20.0, false),
        ] {
            let camera = camera(step, turn);
            let view = view_of(&camera).unwrap();
            assert_eq!(reuse.pvs().is_valid_for(&scene, &view), valid, "{step} {turn}");
            reuse.frame(&scene, &FrameView { view: &view, camera: &camera }).unwrap();
            assert!(reuse.pvs().is_valid_for(&scene, &view));
        }
    }
}
