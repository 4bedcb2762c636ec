//! Answers of the library beside the truth.

use casca::{CameraQuery, Pvs};
use glam::DVec3;

use super::super::super::solid::Answer;
use super::super::tally::Count;
use super::super::walls::SHAPES;
use super::{Stage, Target, Witness};

/// Losses of one scene that are told.
const MOST_LOST: usize = 4;

impl Stage<'_> {
    /// The walls that hide in a view of these layers, a bit for each.
    pub fn hiding(&self, mask: u64) -> u64 {
        let walls = self.walls.iter().enumerate();
        walls.filter(|(_, w)| w.id.is_some() && w.layers & mask != 0).map(|(i, _)| 1 << i).sum()
    }

    /// Whether nothing is between two points but what is seen through for certain.
    pub fn free(&self, from: DVec3, to: DVec3, mask: u64) -> Answer {
        let walls = self.walls.iter().filter(|w| w.id.is_some() && w.layers & mask != 0);
        walls.map(|w| w.wall.solid.answer(from, to)).max().unwrap_or(Answer::Free)
    }

    /// Compares a set with the truth: it must hold each target that one of the places sees a point
    /// of.
    pub fn check(&mut self, way: &'static str, mask: u64, places: impl Fn(&Witness) -> bool, pvs: &Pvs) {
        let holds = |w: &Witness, targets: &[Target]| {
            let target = &targets[w.target?];
            target.id.filter(|_| target.layers & mask != 0).map(|id| pvs.contains(id))
        };
        let answers = self.witnesses.iter().map(|w| holds(w, &self.targets)).collect::<Vec<_>>();
        self.compare(way, mask, places, &answers);
    }

    /// Asks for all points, and compares the answers with the truth.
    pub fn ask(
        &mut self,
        way: &'static str,
        mask: u64,
        places: impl Fn(&Witness) -> bool,
        query: &impl CameraQuery,
    ) {
        let Some(sight) = query.sight(&self.scene) else { return };
        let answer = |w: &Witness| match w.target {
            None => sight.may_see_point(w.point.as_vec3()),
            Some(target) => {
                let bounds = &self.targets[target].bounds;
                sight.may_see_bounds(bounds) && sight.may_see_box(&bounds.aabb())
            }
        };
        let answers: Vec<_> = self.witnesses.iter().map(|w| places(w).then(|| answer(w))).collect();
        self.compare(way, mask, places, &answers);
    }

    /// Compares the answers about witnesses with the truth.
    fn compare(
        &mut self,
        way: &'static str,
        mask: u64,
        places: impl Fn(&Witness) -> bool,
        answers: &[Option<bool>],
    ) {
        let hiding = self.hiding(mask);
        let mut counts = [Count::default(); SHAPES.len()];
        for (i, held) in answers.iter().enumerate() {
            let (witness, Some(held)) = (&self.witnesses[i], *held) else { continue };
            if !places(witness) {
                continue;
            }
            let answer = match (witness.cut & hiding, witness.doubt & hiding) {
                (0, 0) => Answer::Free,
                (0, _) => Answer::Doubt,
                _ => Answer::Cut,
            };
            counts[witness.shape].note(answer, held);
            if answer == Answer::Free && !held {
                let bounds = witness.target.map(|t| (&self.targets[t].bounds, self.targets[t].id));
                let text = format!(
                    "{bounds:?}, of which {} is seen from {:?} ({:?}), mask {mask:#x}",
                    witness.point, witness.start, witness.place
                );
                self.tell(way, &text);
            }
        }
        for (shape, count) in counts.iter().enumerate().filter(|(_, count)| count.tried > 0) {
            self.tally.of(way, SHAPES[shape]).add(count);
        }
    }

    /// Counts one answer of the library about a point, beside the truth.
    pub fn count(
        &mut self,
        way: &'static str,
        shape: usize,
        answer: Answer,
        held: bool,
        text: impl FnOnce() -> String,
    ) {
        self.tally.of(way, SHAPES[shape]).note(answer, held);
        if answer == Answer::Free && !held {
            self.tell(way, &text());
        }
    }

    /// Tells of a loss.
    fn tell(&mut self, way: &'static str, text: &str) {
        if self.lost.len() < MOST_LOST {
            let walls = self.walls.iter().filter(|w| w.id.is_some());
            let walls: Vec<String> =
                walls.map(|w| format!("{} (layers {:#x})", w.wall.text, w.layers)).collect();
            let walls = walls.join("\n  ");
            let text = format!("{way} of scene {} lacks {text}; past\n  {walls}", self.seed);
            self.lost.push(text);
        }
    }
}
