//! A walker that goes to the nearest place from which the map is not known yet.

use std::collections::{HashMap, VecDeque};

use crate::game::{Game, Kind, STEPS, Tile};

/// The first step on the way to unknown tiles, around guards; none if all that can be reached is
/// known.
pub fn next_step(game: &Game) -> Option<(i32, i32)> {
    let guarded = |at: Tile| {
        let (x, y) = at;
        game.fog.seen().get(x, y) && game.guards.iter().any(|guard| guard.at == at)
    };
    let mut first_steps: HashMap<Tile, (i32, i32)> = HashMap::new();
    let mut open = VecDeque::from([game.walker]);
    while let Some(at) = open.pop_front() {
        let first = first_steps.get(&at).copied();
        for step in STEPS {
            let Some(to) = game.beside(at, step) else { continue };
            let first = first.unwrap_or(step);
            match game.known(to) {
                None if at != game.walker => return Some(first),
                // An unknown tile beside the walker lies behind a corner of walls.
                None | Some(Kind::Wall) => {}
                Some(_) if to == game.walker || guarded(to) || first_steps.contains_key(&to) => {}
                Some(_) => {
                    first_steps.insert(to, first);
                    open.push_back(to);
                }
            }
        }
    }
    None
}
