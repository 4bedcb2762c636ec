//! Several threads test candidates again, with the answers of one.
//!
//! Threads look ahead: they examine candidates in portions, from the first on, with patches drawn
//! again as long as the budget holds them in any order. What a thread finds follows from the
//! candidate, the buffers, and for each group of magnified pixels that it asks for, from whether
//! patches were drawn there. Afterwards one thread goes through the answers in the order of
//! candidates. It accepts each that it would find itself with the budget that is left then, and
//! pays for it. From the first other one on it examines some candidates itself, and lets the rest
//! be looked at again: that happens where a budget ends.

use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use casca_slots::Slot;
use smallvec::SmallVec;

use crate::occlusion::magnify::Request;
use crate::occlusion::magnify::budget::{Budget, Purse};
use crate::query::point::decide::{Candidate, SecondTest, count, examine};
use crate::query::point::drawing::Drawing;

/// Candidates that a thread takes at once: some hundred thousand instructions.
const PORTION: usize = 8;

/// Fewer candidates are examined faster than another thread awakes.
const WORTH_SHARING: usize = 4 * PORTION;

/// Candidates that one thread examines after an answer that it does not accept. Each further time
/// they are twice as many: so little is looked at in vain.
const ALONE: usize = 2 * PORTION;

/// What a thread that looks ahead finds about a candidate.
struct Answer {
    hidden: bool,
    /// Squares examined.
    spent: u64,
    requests: SmallVec<[Request; 4]>,
    compared: SmallVec<[Slot; 2]>,
}

/// The first candidate of a portion, and the answers for it.
type Portion = (usize, Vec<Answer>);

impl SecondTest {
    /// Looks at candidates by several threads, and accepts answers as far as they hold.
    pub(super) fn share(&mut self, drawing: &mut Drawing, candidates: &[Candidate], left: &mut Budget) {
        let mut alone = ALONE;
        while candidates.len() - self.hidden.len() >= WORTH_SHARING {
            let portions = self.look_ahead(drawing, &candidates[self.hidden.len()..], left);
            self.accept(drawing, candidates, &portions, left);
            if self.hidden.len() == candidates.len() {
                return;
            }
            self.magnifier.drop_unasked(&mut self.hands);
            let end = candidates.len().min(self.hidden.len() + alone);
            self.examine_rest(drawing, &candidates[..end], left);
            alone *= 2;
        }
        self.examine_rest(drawing, candidates, left);
    }

    /// Examines candidates by several threads. Returns the answers in portions, in order; there are
    /// none for the last portions if the budget ends before them.
    fn look_ahead(&mut self, drawing: &Drawing, candidates: &[Candidate], left: &Budget) -> Vec<Portion> {
        let hands = Mutex::new(std::mem::take(&mut self.hands));
        let (found, next) = (Mutex::new(Vec::new()), AtomicUsize::new(0));
        let purse = AtomicU32::new(left.patches.left());
        let has_patches = left.patches.left() > 0;
        let squares = if left.squares > 0 { u64::from(u32::MAX) << 16 } else { 0 };
        let magnifier = &self.magnifier;
        let work = || {
            let mut hand = lock(&hands).pop().unwrap_or_default();
            let mut own: Vec<Portion> = Vec::new();
            loop {
                let first = next.fetch_add(PORTION, Ordering::Relaxed);
                let spent = has_patches && purse.load(Ordering::Relaxed) == 0;
                if first >= candidates.len() || spent {
                    break;
                }
                let portion = &candidates[first..candidates.len().min(first + PORTION)];
                let answers = portion.iter().map(|candidate| {
                    let mut budget = Budget { squares, patches: Purse::Shared(&purse) };
                    let hidden = examine(drawing, candidate, (magnifier, &mut hand), &mut budget);
                    Answer {
                        hidden,
                        spent: squares - budget.squares,
                        requests: hand.requests.drain(..).collect(),
                        compared: hand.compared.drain(..).collect(),
                    }
                });
                own.push((first, answers.collect()));
            }
            lock(&hands).push(hand);
            lock(&found).append(&mut own);
        };
        rayon::in_place_scope(|scope| {
            let portions = candidates.len().div_ceil(PORTION);
            for _ in 1..rayon::current_num_threads().min(portions) {
                scope.spawn(|_| work());
            }
            work();
        });
        self.hands = hands.into_inner().unwrap_or_else(PoisonError::into_inner);
        let mut portions = found.into_inner().unwrap_or_else(PoisonError::into_inner);
        portions.sort_unstable_by_key(|portion| portion.0);
        portions
    }

    /// Accepts answers, from the first candidate on that none is accepted for, to the first one
    /// that does not hold.
    fn accept(
        &mut self,
        drawing: &mut Drawing,
        candidates: &[Candidate],
        portions: &[Portion],
        left: &mut Budget,
    ) {
        let start = self.hidden.len();
        for (first, answers) in portions {
            if start + first != self.hidden.len() {
                return;
            }
            for answer in answers {
                let before = left.patches.left();
                // Then no limit stopped the examination.
                let enough = answer.spent == 0 || answer.spent < left.squares;
                if !enough || !answer.requests.iter().all(|r| self.magnifier.accept(r, &mut left.patches)) {
                    return;
                }
                left.squares -= answer.spent;
                self.used.solids.extend(&answer.compared);
                let refined = answer.spent > 0 || left.patches.left() != before;
                count(drawing, &candidates[self.hidden.len()], answer.hidden, refined);
                self.hidden.push(answer.hidden);
            }
        }
    }
}

/// What a lock guards. No thread panics while it holds one.
fn lock<T>(guarded: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    guarded.lock().unwrap_or_else(PoisonError::into_inner)
}
