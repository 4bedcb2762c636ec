//! Bots walk on maps of tiles, peek and lag: what exact rays from a client's true eye reach
//! was told.

use std::collections::VecDeque;

use casca_plane::maps::MapKind;
use casca_plane::{BitGrid, Error, FieldOfView, FovOptions, OpaqueTiles, TilePoint};
use casca_server::casca::glam::Vec2;
use casca_server::plane::{PlaneServer, Square};
use casca_server::{ClientDesc, ClientId, EntityDesc, EntityId, ServerError, ServerOptions};
use rand::rngs::SmallRng;
use rand::{RngExt, SeedableRng};

/// Parts of a tile that places of bots are whole numbers of, so that rays are exact.
const PARTS: i64 = 64;

/// Ticks a second.
const TICKS: f64 = 10.0;

type Place = [i64; 2];

fn vector(place: Place) -> Vec2 {
    Vec2::from(place.map(|c| c as f32 / PARTS as f32))
}

fn is_opaque(map: &BitGrid, tile: [i64; 2]) -> bool {
    matches!(tile.map(u32::try_from), [Ok(x), Ok(y)] if map.get(x, y))
}

/// The tiles that hold a place, their borders included.
fn tiles_at(map: &BitGrid, place: Place) -> Vec<[i64; 2]> {
    let on_map = |[x, y]: &[i64; 2]| {
        (0..i64::from(map.width())).contains(x) && (0..i64::from(map.height())).contains(y)
    };
    let part = |at: i64| (at - 1).div_euclid(PARTS)..=at.div_euclid(PARTS);
    part(place[1]).flat_map(|y| part(place[0]).map(move |x| [x, y])).filter(on_map).collect()
}

/// Whether the part of a segment between its ends has no point inside an opaque tile, and does not
/// pass between two that touch at a corner. Exact: ends of the part in a tile are compared as
/// fractions.
fn is_clear(map: &BitGrid, from: Place, to: Place) -> bool {
    let tiles = |axis: usize, size: u32| {
        let (low, high) = (from[axis].min(to[axis]), from[axis].max(to[axis]));
        low.div_euclid(PARTS).max(0) as u32..(high.div_euclid(PARTS) + 1).min(size.into()) as u32
    };
    let step = [to[0] - from[0], to[1] - from[1]];
    let crosses = |x: u32, y: u32| {
        // The open interval of the segment in the tile, from a to b as numerators over one
        // denominator.
        let scale = [0, 1].map(|axis| if step[axis] == 0 { 1 } else { step[axis].abs() });
        let (mut a, mut b) = (0, scale[0] * scale[1]);
        for (axis, at) in [x, y].into_iter().enumerate() {
            let (low, high) = (i64::from(at) * PARTS, (i64::from(at) + 1) * PARTS);
            let other = scale[1 - axis];
            // A way between two opaque tiles that touch is none.
            let before = [x, y].map(i64::from);
            let before = [before[0] - i64::from(axis == 0), before[1] - i64::from(axis == 1)];
            let is_seam = low == from[axis] && is_opaque(map, before);
            match step[axis] {
                0 if !(low < from[axis] && from[axis] < high || is_seam) => return false,
                0 => {}
                1.. => (a, b) = (a.max((low - from[axis]) * other), b.min((high - from[axis]) * other)),
                _ => (a, b) = (a.max((from[axis] - high) * other), b.min((from[axis] - low) * other)),
            }
        }
        a < b
    };
    let pinched = |x: u32, y: u32| {
        // The upper left corner of the tile, from the first end.
        let corner = [i64::from(x) * PARTS - from[0], i64::from(y) * PARTS - from[1]];
        let along = corner[0] * step[0] + corner[1] * step[1];
        let between = 0 < along && along < step[0] * step[0] + step[1] * step[1];
        let on_line = corner[0] * step[1] == corner[1] * step[0];
        let beside = [(-1, -1), (0, -1), (-1, 0), (0, 0)]
            .into_iter()
            .filter(|(i, j)| is_opaque(map, [i64::from(x) + i, i64::from(y) + j]));
        let sides: Vec<i64> = beside.map(|(i, j)| (2 * j + 1) * step[0] - (2 * i + 1) * step[1]).collect();
        between && on_line && sides.iter().any(|side| *side < 0) && sides.iter().any(|side| *side > 0)
    };
    let mut all = tiles(1, map.height()).flat_map(|y| tiles(0, map.width()).map(move |x| (x, y)));
    !all.any(|(x, y)| map.get(x, y) && crosses(x, y) || pinched(x, y))
}

/// One who walks from tile to tile.
struct Bot {
    place: Place,
    way: Place,
    rng: SmallRng,
    radius: f32,
    half: i64,
}

impl Bot {
    /// Whether a body of its size fits there: it may touch walls.
    fn fits(map: &BitGrid, place: Place) -> bool {
        tiles_at(map, place).into_iter().any(|tile| !is_opaque(map, tile))
    }

    /// Around its body, with a share of half its side.
    fn square(&self, share: f32) -> Square {
        Square::new(vector(self.place), self.half as f32 / PARTS as f32 * share)
    }

    fn jump(&mut self, map: &BitGrid) {
        loop {
            let size = [map.width(), map.height()];
            self.place = size.map(|size| {
                let at = self.rng.random_range(0..i64::from(size) * PARTS);
                if self.rng.random_bool(0.5) { at - at % (PARTS / 2) } else { at }
            });
            if Self::fits(map, self.place) {
                return;
            }
        }
    }

    /// Goes on for a quarter of a tick: at most 5 parts along each axis, so at most 4.5 tiles a
    /// second, and often to the border of a tile. Turns back now and then, as one who peeks around
    /// a corner, and where a wall is.
    fn step(&mut self, map: &BitGrid) {
        if self.rng.random_bool(0.1) {
            self.way = [0, 0].map(|_| self.rng.random_range(-5..=5));
        } else if self.rng.random_bool(0.05) {
            self.way = self.way.map(|c| -c);
        }
        let to = [0, 1].map(|i| {
            let (from, to) = (self.place[i], self.place[i] + self.way[i]);
            let border = (to + PARTS / 2).div_euclid(PARTS) * PARTS;
            let is_near = border != from && (border - from).abs() <= 5;
            if is_near && self.rng.random_bool(0.3) { border } else { to }
        });
        // Not through a corner between two walls either.
        if Self::fits(map, to) && is_clear(map, self.place, to) {
            self.place = to;
        } else {
            self.way = self.way.map(|c| -c);
        }
    }
}

/// Whether an eye sees a body: a ray reaches a point of it, or casca-plane's exact field of view has
/// a free tile of it.
fn sees(map: &BitGrid, fov: &FieldOfView, eye: &Bot, body: &Bot) -> bool {
    let points = [-1, 0, 1].into_iter().flat_map(|y| [-1, 0, 1].map(|x| [x, y]));
    let [x, y] = body.place;
    let mut points = points.map(|[i, j]| [x + i * body.half, y + j * body.half]);
    // The field of view of an eye in a tile, and not on its border.
    if let ([_], [[x, y]]) = (&tiles_at(map, eye.place)[..], &tiles_at(map, body.place)[..])
        && fov.seen().get(*x as u32, *y as u32)
    {
        return true;
    }
    points.any(|point| {
        let apart = [point[0] - eye.place[0], point[1] - eye.place[1]].map(|c| c as f64 / PARTS as f64);
        apart[0].hypot(apart[1]) < f64::from(eye.radius)
            && Bot::fits(map, point)
            && is_clear(map, eye.place, point)
    })
}

#[derive(Debug, Default, PartialEq)]
struct Verdict {
    late: u64,
    withheld: u64,
    seen: u64,
    told: u64,
}

/// What is told wrong to a server, to see that the test finds it.
#[derive(Clone, Copy)]
struct Truth {
    eye_speed: f32,
    speed: f32,
    latency: f32,
    radius: f32,
    half: f32,
}

const TRUE: Truth = Truth { eye_speed: 1.0, speed: 1.0, latency: 1.0, radius: 1.0, half: 1.0 };

/// Bots of a map play for some ticks; reports take a quarter of a tick to the server, and answers
/// half a tick back.
fn play(map: &BitGrid, seed: u64, ticks: usize, options: ServerOptions, truth: Truth) -> Verdict {
    const SPEED: f32 = 4.5;
    let bots = |i: u64| {
        let radius = if i.is_multiple_of(3) { 7.5 } else { f32::INFINITY };
        let rng = SmallRng::seed_from_u64(seed * 1000 + i);
        let mut bot = Bot { place: [0, 0], way: [3, 4], rng, radius, half: [0, 10, 20][i as usize % 3] };
        bot.jump(map);
        bot
    };
    let mut bots: Vec<Bot> = (0..12).map(bots).collect();
    let mut server = PlaneServer::new(OpaqueTiles::new(map.clone()), options).unwrap();
    let latency = 0.75 / TICKS as f32 * truth.latency;
    let ids: Vec<(ClientId, EntityId)> = bots
        .iter()
        .map(|bot| {
            let place = vector(bot.place);
            let client =
                ClientDesc::new(place, SPEED * truth.eye_speed, latency).radius(bot.radius * truth.radius);
            let entity = EntityDesc::new(bot.square(truth.half), SPEED * truth.speed);
            (server.add_client(client, 0.0).unwrap(), server.add_entity(entity, 0.0).unwrap())
        })
        .collect();
    let opaque = OpaqueTiles::new(map.clone());
    let mut fov = FieldOfView::new();
    let mut verdict = Verdict::default();
    let mut rng = SmallRng::seed_from_u64(seed);
    // Places that were reported a quarter ago, and answers that are under way.
    let mut reports: Vec<Place> = bots.iter().map(|bot| bot.place).collect();
    let mut on_way: VecDeque<(usize, Vec<Vec<EntityId>>)> = VecDeque::new();
    let mut told: Vec<Vec<EntityId>> = vec![Vec::new(); bots.len()];
    for quarter in 0..ticks * 4 {
        if quarter % 4 == 0 {
            let now = quarter as f64 / 4.0 / TICKS;
            for ((bot, (client, entity)), report) in bots.iter().zip(&ids).zip(&reports) {
                // A report in ten is lost; the others are as old as their way to the server.
                if quarter == 0 || !rng.random_bool(0.1) {
                    server.move_eye(*client, vector(*report), now).unwrap();
                }
                server.move_entity(*entity, bot.square(truth.half), now).unwrap();
            }
            let answers = server.tick(now).unwrap();
            on_way.push_back((quarter + 2, answers.iter().map(|answer| answer.told.clone()).collect()));
        }
        while on_way.front().is_some_and(|(at, _)| *at <= quarter) {
            told = on_way.pop_front().unwrap().1;
        }
        if quarter >= 2 {
            for (i, eye) in bots.iter().enumerate() {
                let at = eye.place.map(|c| c as f64 / PARTS as f64);
                let field = FovOptions::default().in_circle(eye.radius).unwrap();
                fov.run(&opaque, TilePoint::new(at[0], at[1]).unwrap(), &field);
                for (j, body) in bots.iter().enumerate().filter(|(j, _)| *j != i) {
                    let is_told = told[i].contains(&ids[j].1);
                    let is_seen = sees(map, &fov, eye, body);
                    verdict.late += u64::from(is_seen && !is_told);
                    verdict.withheld += u64::from(!is_seen && !is_told);
                    verdict.seen += u64::from(is_seen);
                    verdict.told += u64::from(is_told);
                }
            }
        }
        reports = bots.iter().map(|bot| bot.place).collect();
        bots.iter_mut().for_each(|bot| bot.step(map));
    }
    verdict
}

fn maps() -> Vec<BitGrid> {
    MapKind::ALL.iter().map(|kind| kind.generate(40, 24, 7)).collect()
}

#[test]
fn nothing_is_told_late() {
    for (i, map) in maps().iter().enumerate() {
        for (seed, walls_stop) in [(1, true), (2, true), (3, false)] {
            let options = ServerOptions::new().tick(1.0 / TICKS as f32).walls(walls_stop);
            let verdict = play(map, seed, 150, options, TRUE);
            println!("{:?} walls stop: {walls_stop}: {verdict:?}", MapKind::ALL[i]);
            assert_eq!(verdict.late, 0, "{verdict:?}");
            // Much is hidden in rooms, some in caves, and withheld.
            let least = [verdict.told, verdict.told / 4, 0][i];
            assert!(verdict.withheld >= least, "{verdict:?}");
            assert!(verdict.seen > 1000);
        }
    }
}

#[test]
fn what_is_told_wrong_makes_it_late() {
    let map = MapKind::Rooms.generate(40, 24, 7);
    let wrong = [
        Truth { eye_speed: 0.0, ..TRUE },
        Truth { speed: 0.0, ..TRUE },
        Truth { latency: 0.0, eye_speed: 0.5, speed: 0.5, ..TRUE },
        Truth { radius: 0.7, ..TRUE },
        // With the true half side none is late at this speed.
        Truth { half: 0.0, speed: 0.3, ..TRUE },
    ];
    for (i, truth) in wrong.into_iter().enumerate() {
        let options = ServerOptions::new().tick(1.0 / TICKS as f32);
        let late: u64 = (1..5).map(|seed| play(&map, seed, 150, options, truth).late).sum();
        assert!(late > 0, "{i}");
    }
    // Slow enough that a tile more than is in reach does not make up for it, and fast enough with
    // the true tick.
    let slow = Truth { eye_speed: 0.6, speed: 0.6, ..TRUE };
    let late = [0.001, 1.0 / TICKS as f32].map(|tick| -> u64 {
        let options = ServerOptions::new().tick(tick);
        (1..5).map(|seed| play(&map, seed, 150, options, slow).late).sum()
    });
    assert!(late[0] > 0 && late[1] == 0, "a tick that is longer than was said: {late:?}");
}

#[test]
fn answers_do_not_depend_on_threads_or_memory() {
    let map = MapKind::Rooms.generate(40, 24, 7);
    let run = |threads: usize, memory: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let options = ServerOptions::new().tick(1.0 / TICKS as f32).memory(memory);
        pool.install(|| play(&map, 5, 60, options, TRUE))
    };
    let first = run(1, 64 << 20);
    assert!([(2, 64 << 20), (3, 64 << 20), (2, 0), (1, 5000)].into_iter().all(|(t, m)| run(t, m) == first));
}

/// An entity that stands at a point.
fn point(x: f32, y: f32) -> EntityDesc<Square> {
    EntityDesc::new(Square::new(Vec2::new(x, y), 0.0), 0.0)
}

/// A map with a wall across, and one client that stands.
fn wall() -> (PlaneServer, ClientId) {
    let mut walls = BitGrid::new(16, 16);
    walls.fill(8, 0..16);
    let mut server = PlaneServer::new(OpaqueTiles::new(walls), ServerOptions::new()).unwrap();
    let client = server.add_client(ClientDesc::new(Vec2::new(4.5, 4.5), 0.0, 0.1), 0.0).unwrap();
    (server, client)
}

#[test]
fn doors_open_jumps_are_fresh_and_lost_reports_reach_farther() {
    let (mut server, client) = wall();
    let enemy = server.add_entity(point(4.5, 12.5), 0.0).unwrap();
    let mut now = 0.0;
    let mut told = |server: &mut PlaneServer| {
        now += 0.01;
        server.tick(now).unwrap();
        let answer = server.answer(client).unwrap();
        (answer.told.contains(&enemy), answer.is_fresh)
    };
    assert_eq!(told(&mut server), (false, true));
    server.set_opaque(4, 8, false).unwrap();
    assert_eq!(told(&mut server), (true, false));
    server.set_opaque(4, 8, true).unwrap();
    assert_eq!(told(&mut server), (false, false));
    server.move_eye(client, Vec2::new(4.5, 15.5), 0.03).unwrap();
    assert_eq!(told(&mut server), (true, true));
    server.tick(5.0).unwrap();
    assert!(server.answer(client).unwrap().is_stale);
    // Half a second without a report is half a second of way more.
    let walker = server.add_client(ClientDesc::new(Vec2::new(4.5, 4.5), 2.0, 0.1), 5.0).unwrap();
    for (now, way) in [(5.0, 0.0), (5.5, 1.0), (8.0, 2.0)] {
        server.tick(now).unwrap();
        let more = server.answer(walker).unwrap().reach - 2.0 * (0.1 + 1.0 / 30.0) - way;
        assert!((0.0..1e-5).contains(&more), "{more}");
    }
    // An eye that may be in too many tiles sees all, and so is an entity seen.
    let (mut server, _) = wall();
    let fast = server.add_client(ClientDesc::new(Vec2::new(4.5, 4.5), 1e5, 60.0), 0.0).unwrap();
    let slow = server.add_client(ClientDesc::new(Vec2::new(4.5, 4.5), 0.0, 60.0), 0.0).unwrap();
    let enemy = server.add_entity(point(4.5, 12.5), 0.0).unwrap();
    server.tick(0.0).unwrap();
    // 128 tiles of 256 are on its side of the wall.
    assert!(!server.answer(fast).unwrap().told.contains(&enemy));
    let mut few = PlaneServer::new(server.map().clone(), ServerOptions::new().most_tiles(127)).unwrap();
    let fast = few.add_client(ClientDesc::new(Vec2::new(4.5, 4.5), 1e5, 60.0), 0.0).unwrap();
    let enemy = few.add_entity(point(4.5, 12.5), 0.0).unwrap();
    few.tick(0.0).unwrap();
    assert_eq!(few.answer(fast).unwrap().told, [enemy]);
    assert!(server.answer(slow).is_ok());
}

#[test]
fn bad_input_is_refused() {
    let (mut server, client) = wall();
    let entity = server.add_entity(point(1.0, 1.0), 1.0).unwrap();
    for bad in [f32::NAN, f32::INFINITY, -0.1, 16.1, 1e30] {
        let place = Vec2::new(1.0, bad);
        assert!(matches!(server.move_eye(client, place, 1.0), Err(ServerError::OffMap { .. })), "{bad}");
        assert!(server.move_entity(entity, Square::new(place, 0.0), 1.0).is_err());
        assert!(server.add_client(ClientDesc::new(place, 1.0, 0.1), 1.0).is_err());
        assert!(server.add_entity(point(1.0, bad), 1.0).is_err());
    }
    let at = Vec2::new(1.0, 16.0);
    for bad in [f32::NAN, f32::INFINITY, -1.0] {
        assert!(server.move_entity(entity, Square::new(at, bad), 1.0).is_err());
        assert!(server.add_entity(EntityDesc::new(Square::new(at, bad), 1.0), 1.0).is_err());
        let tick = ServerOptions::new().tick(bad);
        assert!(PlaneServer::new(server.map().clone(), tick).is_err());
    }
    for bad in [f32::NAN, 0.0, -1.0] {
        assert!(server.add_client(ClientDesc::new(at, 1.0, 0.1).radius(bad), 1.0).is_err());
    }
    assert!(PlaneServer::new(OpaqueTiles::new(BitGrid::new(0, 4)), ServerOptions::new()).is_err());
    assert!(matches!(server.set_opaque(16, 0, true), Err(ServerError::Tiles(Error::Outside { x: 16, .. }))));
    assert!(server.tick(2.0).is_ok());
}
