//! Runs plays, and reduces those that fail to few operations.

use std::cell::Cell;
use std::fmt::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use super::dice::Dice;
use super::make::Maker;
use super::ops::{Config, Op};
use super::player::{Failure, Kind, Player};

/// Operations of one scene of a long run.
const SCENE_OPS: usize = 400;
/// Replays while a failure is reduced, at most.
const REPLAYS: u32 = 3000;

/// What plays did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Tally {
    /// Operations.
    pub ops: u64,
    /// Sets compared with the truth.
    pub checks: u64,
}

/// How long a run plays.
#[derive(Debug, Clone, Copy)]
pub struct Run {
    /// The seed of the first scene; the next have the next seeds.
    pub seed: u64,
    /// Operations in all.
    pub ops: u64,
    /// Ends after this many failures.
    pub failures: usize,
}

/// Plays operations from the start; a thorough play looks at more points. `notes` are taken of each
/// operation, if they are wanted.
fn play(
    config: &Config,
    ops: &[Op],
    thorough: bool,
    tally: &mut Tally,
    mut notes: Option<&mut Vec<Vec<String>>>,
) -> Result<(), Failure> {
    let at = Cell::new(0);
    let mut player = match Player::new(config, thorough) {
        Ok(player) => player,
        Err(error) => {
            let text = format!("the scene is refused: {error}");
            return Err(Failure { kind: Kind::Answer, at: 0, text });
        }
    };
    player.notes = notes.as_ref().map(|_| Vec::new());
    let played = catch_unwind(AssertUnwindSafe(|| {
        for (i, op) in ops.iter().enumerate() {
            at.set(i);
            let played = player.play(op);
            if let (Some(notes), Some(new)) = (notes.as_mut(), player.notes.as_mut()) {
                notes.push(std::mem::take(new));
            }
            played?;
        }
        player.finish()
    }));
    tally.ops += at.get() as u64 + 1;
    tally.checks += player.checks;
    match played {
        Ok(Ok(())) => Ok(()),
        Ok(Err((kind, text))) => Err(Failure { kind, at: at.get(), text }),
        Err(panic) => {
            let text = panic.downcast_ref::<String>().cloned();
            let text = text.or_else(|| panic.downcast_ref::<&str>().map(|s| (*s).to_owned()));
            let text = format!("a panic: {}", text.as_deref().unwrap_or("of another kind"));
            Err(Failure { kind: Kind::Panic, at: at.get(), text })
        }
    }
}

/// Leaves out operations as long as the play fails in the same way.
fn reduce(config: &Config, mut ops: Vec<Op>, failure: Failure) -> (Vec<Op>, Failure) {
    ops.truncate(failure.at + 1);
    let mut tally = Tally::default();
    let mut best = failure;
    let mut replays = 0;
    let mut fails = |ops: &[Op], thorough: bool, kind: Kind| {
        replays += 1;
        let failed = play(config, ops, thorough, &mut tally, None).err().filter(|f| f.kind == kind);
        (failed, replays > REPLAYS)
    };
    // More points find the same with less; if they do not, few points must do.
    let thorough = fails(&ops, true, best.kind).0.is_some();
    let mut chunk = ops.len().div_ceil(2);
    while chunk > 0 {
        let (mut i, before) = (0, ops.len());
        while i < ops.len() {
            let part = i..(i + chunk).min(ops.len());
            let mut fewer = ops.clone();
            fewer.drain(part);
            let (failed, over) = fails(&fewer, thorough, best.kind);
            if let Some(failed) = failed {
                fewer.truncate(failed.at + 1);
                (ops, best) = (fewer, failed);
            } else {
                i += chunk;
            }
            if over {
                return (ops, best);
            }
        }
        // The last round is played again while it helps.
        if chunk > 1 || ops.len() == before {
            chunk /= 2;
        }
    }
    (ops, best)
}

fn transcript(config: &Config, ops: &[Op], failure: &Failure) -> String {
    let mut text = format!("{:?}: {}\n{config:?}\n", failure.kind, failure.text);
    let mut notes = Vec::new();
    let _ = play(config, ops, true, &mut Tally::default(), Some(&mut notes));
    for (i, op) in ops.iter().enumerate() {
        // A `String` takes all that is written.
        let _ = writeln!(text, "{i:3}. {op:?}");
        for note in notes.get(i).into_iter().flatten() {
            let _ = writeln!(text, "       {note}");
        }
    }
    text
}

/// A failure with the operations that are needed for it, for people.
fn report(config: &Config, ops: Vec<Op>, failure: Failure) -> String {
    // While it is reduced, a panic comes again and again; its message is in the transcript.
    let silent = (failure.kind == Kind::Panic).then(std::panic::take_hook);
    if silent.is_some() {
        std::panic::set_hook(Box::new(|_| ()));
    }
    let (ops, failure) = reduce(config, ops, failure);
    let text = transcript(config, &ops, &failure);
    if let Some(hook) = silent {
        std::panic::set_hook(hook);
    }
    text
}

/// Plays the scene of a seed, of about as many operations as asked for.
///
/// # Errors
/// The reduced failure, for people.
pub fn play_seed(seed: u64, ops: usize, tally: &mut Tally) -> Result<(), String> {
    play_dice(Dice::new(seed), ops, tally)
}

/// Plays the scene that bytes tell, of up to this many operations.
///
/// # Errors
/// The reduced failure, for people.
pub fn play_bytes(bytes: &[u8], ops: usize) -> Result<(), String> {
    play_dice(Dice::Bytes(bytes), ops, &mut Tally::default())
}

fn play_dice(dice: Dice, ops: usize, tally: &mut Tally) -> Result<(), String> {
    let (config, ops) = Maker::new(dice).ops(ops);
    let played = play(&config, &ops, false, tally, None);
    played.map_err(|failure| report(&config, ops, failure))
}

/// Plays scene after scene; `progress` is told what was done and found so far, after each.
pub fn long_run(run: Run, mut progress: impl FnMut(&Tally, &[String], f64)) -> (Tally, Vec<String>) {
    let start = Instant::now();
    let (mut tally, mut found) = (Tally::default(), Vec::new());
    let mut seed = run.seed;
    while tally.ops < run.ops && found.len() < run.failures {
        if let Err(text) = play_seed(seed, SCENE_OPS, &mut tally) {
            found.push(format!("seed {seed}, after {} operations\n{text}", tally.ops));
        }
        seed += 1;
        progress(&tally, &found, start.elapsed().as_secs_f64());
    }
    (tally, found)
}
