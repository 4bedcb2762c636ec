//! The looks of a tile, in letters and colours.

use casca_plane::TileState;

use crate::game::{Game, Kind, Tile};

pub type Color = [u8; 3];

pub struct Look {
    pub letter: char,
    pub ink: Color,
    pub ground: Color,
}

const UNKNOWN: Color = [12, 12, 16];
const GROUND: Color = [86, 92, 104];
const WALL: Color = [226, 200, 150];
const DOOR: Color = [186, 112, 50];
const WALKER: Color = [110, 230, 255];
const GUARD: Color = [255, 196, 40];
const ALERT: Color = [255, 70, 50];
const WATCHED: Color = [120, 84, 90];

/// What the walker sees or remembers at a tile.
pub fn look(game: &Game, at: Tile) -> Look {
    let state = game.fog.state(at.0, at.1);
    let seen = state == TileState::Seen;
    let plain = |letter, ink, ground| Look { letter, ink, ground };
    let mut look = match game.known(at) {
        None => return plain(' ', UNKNOWN, UNKNOWN),
        Some(Kind::Wall) => plain('#', WALL.map(|part| part / 2), WALL),
        Some(Kind::Door { open: false }) => plain('+', DOOR.map(|part| part / 2), DOOR),
        Some(Kind::Door { open: true }) => plain('/', DOOR, GROUND),
        Some(Kind::Ground) => plain('.', GROUND.map(|part| part + 20), GROUND),
    };
    if !seen {
        // Remembered tiles are dark.
        look.ink = look.ink.map(|part| part / 5 * 2);
        look.ground = look.ground.map(|part| part / 5 * 2);
        return look;
    }
    if look.letter != '#' && game.watched.seen().get(at.0, at.1) {
        look.ground = WATCHED;
    }
    let guard = game.guards.iter().find(|guard| guard.at == at);
    match guard {
        _ if at == game.walker => Look { letter: '@', ink: WALKER, ..look },
        Some(guard) if guard.alert => Look { letter: 'G', ink: ALERT, ..look },
        Some(_) => Look { letter: 'g', ink: GUARD, ..look },
        None => look,
    }
}
