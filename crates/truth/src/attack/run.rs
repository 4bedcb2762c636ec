//! Runs plays, and reduces those that fail to few operations.

use std::cell::Cell;
use std::fmt::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use super::dice::Dice;
use super::make::{Habits, Maker};
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

/// A failure, reduced.
#[derive(Debug, Clone)]
pub struct Report {
    /// The scene.
    pub config: Config,
    /// The operations that are needed.
    pub ops: Vec<Op>,
    /// How it fails.
    pub failure: Failure,
    /// After how many operations it came up.
    pub after: u64,
    /// For people.
    pub transcript: String,
}

/// How long a run plays.
#[derive(Debug, Clone, Copy)]
pub struct Run {
    /// The seed of the first scene; the next have the next seeds.
    pub seed: u64,
    /// Operations in all.
    pub ops: u64,
    /// What is played.
    pub habits: Habits,
    /// Ends after this many failures.
    pub failures: usize,
}

/// Plays operations from the start; a thorough play looks at more points.
///
/// # Errors
/// Says how library and truth disagree.
pub fn play(config: &Config, ops: &[Op], thorough: bool, tally: &mut Tally) -> Result<(), Failure> {
    play_with(config, ops, thorough, tally, &mut None)
}

fn play_with(
    config: &Config,
    ops: &[Op],
    thorough: bool,
    tally: &mut Tally,
    notes: &mut Option<Vec<Vec<String>>>,
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

/// Leaves out operations as long as the play fails in the same way. Whole frames stay as they are
/// where each must have its end: another defect would come up instead.
fn reduce(config: &Config, mut ops: Vec<Op>, failure: Failure, frames: bool) -> (Vec<Op>, Failure) {
    ops.truncate(failure.at + 1);
    let mut tally = Tally::default();
    let mut best = failure;
    let mut replays = 0;
    let mut fails = |ops: &[Op], thorough: bool, kind: Kind| {
        replays += 1;
        let failed = play(config, ops, thorough, &mut tally).err().filter(|f| f.kind == kind);
        (failed, replays > REPLAYS)
    };
    // More points find the same with less; if they do not, few points must do.
    let thorough = fails(&ops, true, best.kind).0.is_some();
    let mut chunk = ops.len().div_ceil(2);
    while chunk > 0 {
        let (mut i, before) = (0, ops.len());
        while i < ops.len() {
            let part = i..(i + chunk).min(ops.len());
            let stays = |op: &Op| frames && matches!(op, Op::Begin { .. } | Op::Look { .. } | Op::End { .. });
            let mut fewer = ops.clone();
            let kept: Vec<Op> = fewer[part.clone()].iter().filter(|op| stays(op)).cloned().collect();
            if kept.len() == part.len() {
                i += chunk;
                continue;
            }
            fewer.splice(part, kept);
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
    let mut notes = Some(Vec::new());
    let _ = play_with(config, ops, true, &mut Tally::default(), &mut notes);
    let notes = notes.unwrap_or_default();
    for (i, op) in ops.iter().enumerate() {
        // A `String` takes all that is written.
        let _ = writeln!(text, "{i:3}. {op:?}");
        for note in notes.get(i).into_iter().flatten() {
            let _ = writeln!(text, "       {note}");
        }
    }
    text
}

fn report(config: Config, ops: Vec<Op>, failure: Failure, after: u64, habits: Habits) -> Report {
    // While it is reduced, a panic comes again and again; its message is in the transcript.
    let silent = (failure.kind == Kind::Panic).then(std::panic::take_hook);
    if silent.is_some() {
        std::panic::set_hook(Box::new(|_| ()));
    }
    let frames = !habits.skipped_ends && matches!(failure.kind, Kind::Lost | Kind::Held | Kind::Volume);
    let (ops, failure) = reduce(&config, ops, failure, frames);
    let transcript = transcript(&config, &ops, &failure);
    if let Some(hook) = silent {
        std::panic::set_hook(hook);
    }
    Report { config, ops, failure, after, transcript }
}

/// Plays the scene of a seed, of about as many operations as asked for.
///
/// # Errors
/// The reduced failure.
pub fn play_seed(seed: u64, ops: usize, habits: Habits, tally: &mut Tally) -> Result<(), Box<Report>> {
    let (config, ops) = Maker::new(Dice::new(seed), habits).ops(ops);
    let played = play(&config, &ops, false, tally);
    played.map_err(|failure| Box::new(report(config, ops, failure, tally.ops, habits)))
}

/// Plays the scene that bytes tell, of up to this many operations.
///
/// # Errors
/// The reduced failure.
pub fn play_bytes(bytes: &[u8], ops: usize, habits: Habits) -> Result<(), Box<Report>> {
    let (config, ops) = Maker::new(Dice::Bytes(bytes), habits).ops(ops);
    let played = play(&config, &ops, false, &mut Tally::default());
    played.map_err(|failure| Box::new(report(config, ops, failure, 0, habits)))
}

/// Plays scene after scene; `progress` is told what was done and found so far, after each.
pub fn long_run(run: Run, mut progress: impl FnMut(&Tally, &[Report], f64)) -> (Tally, Vec<Report>) {
    let start = Instant::now();
    let (mut tally, mut found) = (Tally::default(), Vec::new());
    let mut seed = run.seed;
    while tally.ops < run.ops && found.len() < run.failures {
        if let Err(mut report) = play_seed(seed, SCENE_OPS, run.habits, &mut tally) {
            report.transcript = format!("seed {seed}, after {} operations\n{}", tally.ops, report.transcript);
            found.push(*report);
        }
        seed += 1;
        progress(&tally, &found, start.elapsed().as_secs_f64());
    }
    (tally, found)
}
