//! Plays that attack the library: whatever is done to a scene, in whatever order, no set lacks an
//! object that a ray reaches, and no kept set is said to hold where it does.
//!
//! `CASCA_ATTACK_OPS=10000000 cargo test --release --test attack -- --ignored --nocapture plays` plays as
//! many operations as it says. `CASCA_SEED` is the first seed, `CASCA_ATTACK_FAILURES` how many
//! failures end the run.

use casca_truth::attack::{Run, Tally, long_run, play_seed};

use crate::common::*;
use crate::number;

/// Operations of one case.
const OPS: usize = 300;

/// The cases; what fails is reduced by the attack itself.
fn plays() -> ProptestConfig {
    ProptestConfig { max_shrink_iters: 0, ..cases(384) }
}

proptest! {
    #![proptest_config(plays())]

    #[test]
    fn no_play_loses_what_is_seen(seed in any::<u64>()) {
        let mut tally = Tally::default();
        if let Err(report) = play_seed(seed, OPS, &mut tally) {
            prop_assert!(false, "{report}");
        }
        prop_assert!(tally.checks > 10, "{} sets were compared", tally.checks);
    }
}

#[test]
#[ignore = "minutes: plays CASCA_ATTACK_OPS operations"]
fn long() {
    let run = Run {
        seed: number("CASCA_SEED").unwrap_or(1),
        ops: number("CASCA_ATTACK_OPS").unwrap_or(1_000_000),
        failures: number("CASCA_ATTACK_FAILURES").unwrap_or(1) as usize,
    };
    let (mut told, mut shown) = (0.0, 0);
    let (tally, found) = long_run(run, |tally, found, seconds| {
        found[shown..].iter().for_each(|report| eprintln!("{report}"));
        shown = found.len();
        if seconds > told + 5.0 {
            told = seconds;
            let rate = tally.ops as f64 / seconds;
            eprintln!("{tally:?} of {}, {rate:.0} operations a second, {} failures", run.ops, found.len());
        }
    });
    eprintln!("{tally:?}, {} failures", found.len());
    assert!(found.is_empty(), "{} failures, the first of which is\n{}", found.len(), found[0]);
}
