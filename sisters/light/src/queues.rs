//! Which states wait: for rays, and for direct light.

use std::collections::VecDeque;

use crate::numeric::HIT_TURN;

/// Why a state waits for rays. Those that a question asked for come first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Wish {
    /// It does not wait.
    None,
    /// A ray of another state hit it.
    Hit,
    /// A question will read it.
    Asked,
}

/// The states that wait for rays, each once.
#[derive(Debug, Clone, Default)]
pub(crate) struct Waiting {
    /// By state.
    wishes: Vec<Wish>,
    asked: VecDeque<u32>,
    /// Some of them may have been asked for since.
    hit: VecDeque<u32>,
    count: usize,
    /// Counts parts: see [`HIT_TURN`].
    turn: u32,
}

impl Waiting {
    /// None of so many states waits.
    pub(crate) fn new(states: usize) -> Self {
        Self { wishes: vec![Wish::None; states], ..Self::default() }
    }

    /// None of so many other states waits, and turns go on.
    pub(crate) fn renewed(&self, states: usize) -> Self {
        Self { turn: self.turn, ..Self::new(states) }
    }

    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Lets a state wait; a stronger wish replaces a weaker one.
    pub(crate) fn add(&mut self, state: u32, wish: Wish) {
        let before = &mut self.wishes[state as usize];
        if wish <= *before {
            return;
        }
        self.count += usize::from(*before == Wish::None);
        *before = wish;
        let queue = if wish == Wish::Asked { &mut self.asked } else { &mut self.hit };
        queue.push_back(state);
    }

    /// Takes up to so many states that wait for the same reason, the strongest, oldest first; each
    /// time out of some those that were hit, so that they have their turn however much is asked.
    pub(crate) fn take(&mut self, most: usize) -> (Wish, Vec<u32>) {
        self.turn = (self.turn + 1) % HIT_TURN;
        let is_hit = self.asked.is_empty() || self.turn == 0 && !self.hit.is_empty();
        let wish = if is_hit { Wish::Hit } else { Wish::Asked };
        let queue = if wish == Wish::Asked { &mut self.asked } else { &mut self.hit };
        let mut taken = Vec::new();
        while taken.len() < most
            && let Some(state) = queue.pop_front()
        {
            let now = &mut self.wishes[state as usize];
            if *now == wish {
                *now = Wish::None;
                taken.push(state);
            }
        }
        self.count -= taken.len();
        (wish, taken)
    }

    /// All with their wishes, oldest first.
    pub(crate) fn all(&self) -> impl Iterator<Item = (u32, Wish)> + '_ {
        let hit = self.hit.iter().filter(|s| self.wishes[**s as usize] == Wish::Hit);
        self.asked.iter().map(|s| (*s, Wish::Asked)).chain(hit.map(|s| (*s, Wish::Hit)))
    }
}

/// Gathered states whose direct light is none yet, or old: the next comes first.
#[derive(Debug, Clone, Default)]
pub(crate) struct Unlit(VecDeque<u32>);

impl Unlit {
    pub(crate) fn count(&self) -> usize {
        self.0.len()
    }

    /// States that have no direct light yet come before those that have an old one.
    pub(crate) fn add_new(&mut self, states: &[u32]) {
        states.iter().rev().for_each(|s| self.0.push_front(*s));
    }

    /// The light of all gathered states is old now. Those that waited stay in front, so that each
    /// has its turn however often the light changes.
    pub(crate) fn add_all(&mut self, gathered: &[u32], states: usize) {
        let mut waits = vec![false; states];
        self.0.iter().for_each(|s| waits[*s as usize] = true);
        self.0.extend(gathered.iter().filter(|s| !waits[**s as usize]));
    }

    pub(crate) fn take(&mut self, most: usize) -> Vec<u32> {
        let count = most.min(self.0.len());
        self.0.drain(..count).collect()
    }

    /// The same states by other numbers; those without one are none any more.
    pub(crate) fn renumbered(&self, number: impl Fn(u32) -> Option<u32>) -> Self {
        Self(self.0.iter().filter_map(|s| number(*s)).collect())
    }

    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_wait_once_and_those_asked_for_come_first() {
        let mut waiting = Waiting::new(10);
        for (state, wish) in [
            (7, Wish::Hit),
            (3, Wish::Hit),
            (5, Wish::Asked),
            (3, Wish::Asked),
            (5, Wish::Hit),
            (7, Wish::Hit),
        ] {
            waiting.add(state, wish);
        }
        assert_eq!(waiting.count(), 3);
        let all: Vec<_> = waiting.all().collect();
        assert_eq!(all, [(5, Wish::Asked), (3, Wish::Asked), (7, Wish::Hit)]);
        assert_eq!(waiting.take(1), (Wish::Asked, vec![5]));
        waiting.add(5, Wish::Hit);
        assert_eq!(waiting.take(9), (Wish::Asked, vec![3]));
        assert_eq!(waiting.take(9), (Wish::Hit, vec![7, 5]));
        assert_eq!((waiting.count(), waiting.take(9)), (0, (Wish::Hit, vec![])));
    }

    #[test]
    fn each_state_has_its_turn_although_the_light_changes_all_the_time() {
        let gathered: Vec<u32> = (0..6).collect();
        let (mut unlit, mut turns) = (Unlit::default(), [0; 6]);
        for _ in 0..9 {
            unlit.add_all(&gathered, 6);
            unlit.take(2).into_iter().for_each(|s| turns[s as usize] += 1);
        }
        assert_eq!(turns, [3; 6]);
        unlit.add_new(&[5, 4]);
        assert_eq!(unlit.take(3)[..2], [5, 4]);
        assert_eq!(unlit.renumbered(|s| (s != 1).then_some(s + 10)).0, [12, 13]);
    }
}
