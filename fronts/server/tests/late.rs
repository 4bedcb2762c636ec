//! Bots run, peek, strafe, jump and lag: what exact rays from a client's true eye see was told.

#[path = "../examples/judge/rays.rs"]
mod rays;

use std::ops::ControlFlow;

use casca_baked::{Baked, Writer};
use casca_server::bots::{Level, Match};
use casca_truth::oracle::RayOracle;
use rays::Truth;

/// What was found in a match.
#[derive(Debug, Default, PartialEq)]
struct Verdict {
    /// Visible bots that were not told, over clients and times.
    late: u64,
    /// Pairs of a client and a bot that it was not told of.
    withheld: u64,
    pairs: u64,
}

const BOTS: usize = 24;

/// Plays a match, and looks at each tick from each eye at all that was not told.
fn play(level: &Level, seed: u64, told: [f32; 2], ticks: u64) -> Verdict {
    let mut game = Match::new(level, BOTS, seed, told).unwrap();
    let mut truth = Truth::new(level, game.now()[0]);
    let mut verdict = Verdict::default();
    for tick in 0..ticks {
        game.answer(|server, now| server.tick(now).map(|_| ())).unwrap().unwrap();
        let [begin, end] = game.now();
        // When an answer arrives, and just before the next one does.
        for moment in [begin.clone(), begin.toward(end, 0.999)] {
            truth.set(&moment);
            for (i, told) in game.told().iter().enumerate() {
                let hidden: Vec<usize> = (0..BOTS).filter(|&j| !told[j] && j != i).collect();
                let mut seen = vec![false; BOTS];
                truth.look(moment.eyes[i], &hidden, tick, &mut seen);
                verdict.pairs += BOTS as u64 - 1;
                verdict.withheld += hidden.len() as u64;
                verdict.late += seen.iter().filter(|seen| **seen).count() as u64;
            }
        }
        game.advance();
    }
    verdict
}

#[test]
fn nothing_is_told_late_in_rooms() {
    let verdict = play(&Level::open("rooms").unwrap(), 1, [1.0; 2], 200);
    assert_eq!(verdict.late, 0, "{verdict:?}");
    let share = verdict.withheld as f64 / verdict.pairs as f64;
    assert!(share > 0.3, "{share} of all pairs are withheld");
}

#[test]
fn lies_about_the_reach_and_the_growth_are_found_out() {
    let level = Level::open("rooms").unwrap();
    let still = play(&level, 1, [0.0, 1.0], 200);
    assert!(still.late > 10, "{still:?}");
    let prompt = play(&level, 1, [1.0, 0.0], 200);
    assert!(prompt.late > 0, "{prompt:?}");
}

#[test]
fn nothing_is_told_late_by_baked_sets() {
    let mut level = Level::open("rooms").unwrap();
    let file = level.bake(2.0, 16, 2, &mut |_, _| ControlFlow::Continue(())).unwrap();
    level.baked = Some(file);
    let verdict = play(&level, 2, [1.0; 2], 100);
    assert_eq!(verdict.late, 0, "{verdict:?}");
    let share = verdict.withheld as f64 / verdict.pairs as f64;
    assert!(share > 0.3, "{share} of all pairs are withheld");
    // Sets in which a cell sees itself only are found out.
    let baked = Baked::read(level.baked.as_ref().unwrap()).unwrap();
    let mut writer = Writer::like(&baked).unwrap();
    let cells = (0..baked.objects()).filter(|cell| baked.set(*cell).is_some());
    cells.for_each(|cell| writer.put(cell, &[cell]).unwrap());
    level.baked = Some(writer.finish().unwrap());
    assert!(play(&level, 1, [1.0; 2], 20).late > 10);
}

#[test]
fn bots_keep_to_their_speed_and_out_of_walls() {
    let level = Level::open("rooms").unwrap();
    let oracle = RayOracle::new(&level.objects);
    let mut game = Match::new(&level, 40, 1, [1.0; 2]).unwrap();
    let (mut jumps, mut aside) = (0, 0.0f32);
    for _ in 0..600 {
        game.answer(|_, _| ()).unwrap();
        let [begin, end] = game.now();
        for i in 0..40 {
            let (from, to) = (begin.eyes[i], end.eyes[i]);
            if end.jumped[i] {
                jumps += 1;
                continue;
            }
            assert!(from.distance(to) <= 5.0 / 30.0);
            // Corners of bodies go through nothing either.
            let offset = begin.bodies[i].min - from;
            for corner in [offset, offset.with_y(0.0), -offset.with_y(0.0)] {
                let [a, b] = [from + corner, to + corner].map(|p| p.as_dvec3());
                assert!(!oracle.occluded(a, b, usize::MAX), "{a} {b}");
                assert!(!oracle.occluded(from.as_dvec3(), a, usize::MAX), "{from} {a}");
            }
            let near = level.track.path.iter().map(|p| p.distance(from)).fold(f32::INFINITY, f32::min);
            aside = aside.max(near);
        }
        game.advance();
    }
    assert!(jumps > 10 && (0.1..0.6).contains(&aside), "{jumps} {aside}");
}
