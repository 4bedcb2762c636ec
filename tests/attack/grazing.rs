//! The grazing form of the attack: no set lacks a tiny object that is seen closely past an
//! occluder.
//!
//! `CASCA_GRAZING_POINTS=1000000000 cargo test --release --test attack -- --ignored --nocapture grazing`
//! asks for as many points as it says, on all cores (`CASCA_GRAZING_THREADS` for fewer; results are
//! the same). `CASCA_SEED` is the seed of the first scene.

use casca_truth::attack::grazing::{Run, SHAPES, Tally, long_run};

use crate::number;

#[test]
fn what_is_seen_past_an_edge_is_found() {
    let run = Run { seed: number("CASCA_SEED").unwrap_or(1), points: 4_000_000, threads: 1, failures: 1 };
    let (tally, lost) = long_run(run, |_, _| ());
    assert!(lost.is_empty(), "{}", lost[0]);
    // The test means something: most points are decided, each shape is passed, and sets leave out
    // what is hidden.
    let total = tally.total();
    assert!(total.seen * 3 > total.tried && total.open * 20 < total.tried, "{tally}");
    for shape in SHAPES {
        assert!(tally.shape(shape).seen > 100, "{shape}: {tally}");
    }
    for way in [
        "fast",
        "balanced",
        "reach",
        "turn",
        "coherent",
        "kept, held",
        "parallel",
        "view cell",
        "cell",
        "cell of a camera",
        "casters",
    ] {
        let count = tally.way(way);
        assert!(count.seen > 100 && count.culled > 100, "{way}: {tally}");
    }
}

#[test]
#[ignore = "minutes: asks for CASCA_GRAZING_POINTS points"]
fn long() {
    let run = Run {
        seed: number("CASCA_SEED").unwrap_or(1),
        points: number("CASCA_GRAZING_POINTS").unwrap_or(10_000_000),
        threads: number("CASCA_GRAZING_THREADS").unwrap_or(0) as usize,
        failures: number("CASCA_ATTACK_FAILURES").unwrap_or(1) as usize,
    };
    let (start, mut told) = (std::time::Instant::now(), 0.0);
    let (tally, lost) = long_run(run, |tally: &Tally, lost| {
        let seconds = start.elapsed().as_secs_f64();
        if seconds > told + 10.0 {
            told = seconds;
            let points = tally.total().tried;
            eprintln!("{points} points, {:.0} a second, {} lost", points as f64 / seconds, lost.len());
        }
    });
    let seconds = start.elapsed().as_secs_f64();
    eprintln!(
        "{tally}{} scenes in {seconds:.0} s, {:.0} points a second",
        tally.scenes,
        tally.total().tried as f64 / seconds
    );
    lost.iter().for_each(|lost| eprintln!("{lost}"));
    assert!(lost.is_empty(), "{} losses", lost.len());
}
