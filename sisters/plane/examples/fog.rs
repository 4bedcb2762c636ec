//! A walk on a map that nobody knows: the fog lifts where the walker looks, and doors in its way are
//! opened. Prints what the walker knows in the end: tiles in sight, tiles that it remembers (`,`), and
//! the guards that it sees. Takes a map (`harbour`, `rooms`, or a file) and the number of steps.

use std::collections::{HashMap, VecDeque};
use std::error::Error;

use casca_maps::{Drawing, HARBOUR};
use casca_plane::{FieldOfView, Fog, FovOptions, OpaqueTiles, TilePoint, TileState};

/// A tile, column and row.
type Tile = (u32, u32);

/// How far the walker sees, in tiles.
const SIGHT: f32 = 24.0;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let map = match words.next().as_deref() {
        None | Some("harbour") => Drawing::read(HARBOUR),
        Some("rooms") => Drawing::rooms(96, 54, 1),
        Some(file) => Drawing::open(file)?,
    };
    let steps: u32 = words.next().as_deref().unwrap_or("240").parse()?;
    map.warnings.iter().for_each(|warning| eprintln!("{warning}"));
    let (width, height) = (map.walls.width(), map.walls.height());
    let mut tiles = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let free = tiles.find(|&(x, y)| !map.walls.get(x, y));
    let mut walker: Tile = map.start.or(free).ok_or("the map has no free tile")?;
    let mut opaque = OpaqueTiles::new(map.walls);
    map.doors.iter().for_each(|&(x, y)| opaque.set(x, y, true));

    let (mut fog, mut fov) = (Fog::new(width, height), FieldOfView::new());
    let options = FovOptions::default().in_circle(SIGHT)?;
    for step in 0..=steps {
        fog.begin_frame();
        fov.run(&opaque, TilePoint::center_of(walker.0, walker.1), &options);
        fog.add(&fov)?;
        let is_wall = |at: Tile| opaque.get(at.0, at.1) && !map.doors.contains(&at);
        let Some(to) = next_tile(&fog, walker, is_wall).filter(|_| step < steps) else { break };
        if opaque.get(to.0, to.1) {
            opaque.set(to.0, to.1, false);
        } else {
            walker = to;
        }
    }

    let letter = |at: Tile| match (fog.state(at.0, at.1), opaque.get(at.0, at.1)) {
        (TileState::Unseen, _) => ' ',
        _ if at == walker => '@',
        (TileState::Seen, _) if map.guards.contains(&at) => 'g',
        (_, true) if map.doors.contains(&at) => '+',
        (_, false) if map.doors.contains(&at) => '/',
        (_, true) => '#',
        (TileState::Seen, false) => '.',
        (TileState::Remembered, false) => ',',
    };
    for y in 0..height {
        println!("{}", (0..width).map(|x| letter((x, y))).collect::<String>().trim_end());
    }
    Ok(())
}

/// The first tile on the shortest way to a tile that is unknown; none if all that can be reached is
/// known.
fn next_tile(fog: &Fog, walker: Tile, is_wall: impl Fn(Tile) -> bool) -> Option<Tile> {
    let (width, height) = (fog.ever_seen().width(), fog.ever_seen().height());
    let mut first: HashMap<Tile, Tile> = HashMap::new();
    let mut open = VecDeque::from([walker]);
    while let Some(at) = open.pop_front() {
        for (right, down) in [(1, 0), (0, 1), (-1, 0), (0, -1)] {
            let to = (at.0.wrapping_add_signed(right), at.1.wrapping_add_signed(down));
            let begins = first.get(&at).copied().unwrap_or(to);
            let inside = to.0 < width && to.1 < height && to != walker;
            // An unknown tile beside the walker lies behind a corner of walls.
            if inside && !fog.ever_seen().get(to.0, to.1) && at != walker {
                return Some(begins);
            }
            let known = inside && fog.ever_seen().get(to.0, to.1) && !is_wall(to);
            if known && !first.contains_key(&to) {
                first.insert(to, begins);
                open.push_back(to);
            }
        }
    }
    None
}
