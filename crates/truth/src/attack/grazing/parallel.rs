//! Views of parallel rays.

use super::super::ops::direction;
use super::super::views::{Depth, Limits, look};
use super::solid::Start;
use super::stage::{Place, Stage};
use super::views::presets;

/// Plays a scene with an orthographic view.
pub fn play(mut stage: Stage) -> Stage {
    let (eye, forward, mask) = (stage.eye(), direction(&mut stage.dice), stage.mask());
    let dice = &mut stage.dice;
    let limits = Limits::Parallel {
        half: stage.unit * dice.between(4.0, 20.0),
        aspect: dice.between(0.7, 1.6),
        near: stage.unit * -60.0,
        far: stage.unit * 60.0,
        mirrored: dice.once_in(4),
        depth: dice.pick(&[Depth::Usual, Depth::Reversed]),
        told: true,
    };
    let walls = 8 + dice.below(24);
    let Ok((view, truth)) = look(eye, forward, &limits) else { return stage };
    let view = view.with_layers(mask);
    stage.build(walls, |_| true);
    let start = Start::Before(truth.direction(), f64::from(stage.unit) * 500.0);
    for _ in 0..400 {
        stage.aim(start, Place::View(0), |p| truth.sight(p).is_some());
    }
    for _ in 0..4000 {
        stage.aim_point(start, Place::View(0), |p| truth.sight(p).is_some());
    }
    stage.insert_targets();
    for (_, query) in &mut presets(&mut stage.dice) {
        let pvs = query.run(&stage.scene, &view).clone();
        stage.check("parallel", mask, |_| true, &pvs);
        stage.ask("parallel, sight", mask, |_| true, query);
    }
    stage
}
