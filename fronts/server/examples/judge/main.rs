//! Plays matches of bots. Prints how long a tick takes, and which shares of the entities are withheld and
//! told late, beside other ways to choose.
//!
//! `cargo run --release -p casca-server --features net --example judge -- LEVEL...`; `--help` lists the options.

mod rays;

use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

use casca_server::VisibilityServer;
use casca_server::bots::{DOWN, Level, Match, Moment};
use casca_server::casca::glam::Vec3;
use casca_server::wire::{AnswerFrame, ToClient};
use casca_tools::pictures::palette::other;
use casca_tools::pictures::{Axis, Line, lines};
use casca_truth::oracle::RayOracle;
use clap::Parser;

use rays::Truth;

type Failure = Box<dyn std::error::Error + Send + Sync>;

#[derive(Parser)]
struct Arguments {
    /// Generated scenes and .glb files.
    levels: Vec<String>,
    /// Ticks that are timed.
    #[arg(long, default_value_t = 600)]
    times: u64,
    /// Ticks of all ways that rays judge.
    #[arg(long, default_value_t = 0)]
    beside: u64,
    #[arg(long, default_value_t = 100)]
    bots: usize,
    /// Sets from cell to cell of this edge come first, in metres.
    #[arg(long)]
    bake: Option<f32>,
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The SVG file of the ways.
    #[arg(long)]
    chart: Option<PathBuf>,
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::parse();
    let (bots, seed) = (arguments.bots, arguments.seed);
    // By way: the shares told late and withheld of each level, in percent.
    let mut marks: [Vec<(f64, f64)>; WAYS.len()] = Default::default();
    for name in &arguments.levels {
        if name.ends_with(".glb") && !std::path::Path::new(name).exists() {
            println!("skipped: {name} is not here");
            continue;
        }
        let mut level = Level::open(name)?;
        check(&level)?;
        if let Some(edge) = arguments.bake {
            bake(&mut level, edge)?;
        }
        if arguments.times > 0 {
            for threads in [1, 2] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
                pool.install(|| times(&level, (bots, seed), arguments.times, threads))?;
            }
        }
        if arguments.beside > 0 {
            beside(&level, (bots, seed), arguments.beside, &mut marks)?;
        }
    }
    if let Some(file) = &arguments.chart {
        chart(file, marks)?;
    }
    Ok(())
}

/// Draws the share withheld over the share told late: a mark for each level and way.
fn chart(file: &Path, marks: [Vec<(f64, f64)>; WAYS.len()]) -> Result<(), Failure> {
    let ways = WAYS.iter().zip(marks).enumerate();
    let series: Vec<Line> =
        ways.map(|(number, (way, marks))| Line::dots(*way, other(number), marks)).collect();
    let (x, y) = (Axis::linear("told late, % of the visible"), Axis::linear("withheld, % of the hidden"));
    let title = "Rays withhold more and tell late; casca-server tells nothing late";
    lines(file, title, "a mark for each level: rooms, town, sponza-parts", (&x, &y), &series)?;
    Ok(())
}

/// Finds which cells of a level see each other, as the first filter of its server.
fn bake(level: &mut Level, edge: f32) -> Result<(), Failure> {
    let begin = Instant::now();
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    let mut cells = 0;
    let file = level.bake(edge, 16, threads, &mut |_, all| {
        cells = all;
        ControlFlow::Continue(())
    })?;
    let seconds = begin.elapsed().as_secs_f64();
    println!("{}: {cells} cells of {edge} m in {seconds:.1} s, {} bytes", level.name, file.len());
    level.baked = Some(file);
    Ok(())
}

/// Bots must keep out of occluders.
fn check(level: &Level) -> Result<(), Failure> {
    let oracle = RayOracle::new(&level.objects);
    let through = |pair: &[Vec3]| oracle.occluded(pair[0].as_dvec3(), pair[1].as_dvec3(), usize::MAX);
    match level.track.path.windows(2).filter(|pair| through(pair)).count() {
        0 => Ok(()),
        some => Err(format!("the path of {} goes through something {some} times", level.name).into()),
    }
}

/// The value below which a share of sorted ones is; no number if there are none.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let at = (sorted.len().saturating_sub(1) as f64 * share).round() as usize;
    sorted.get(at).copied().unwrap_or(f64::NAN)
}

/// The bytes of all answers of a tick.
fn bytes(server: &VisibilityServer) -> usize {
    let answers = server.clients().filter_map(|(id, _)| server.answer(id).ok());
    answers.map(|answer| ToClient::Answer(AnswerFrame::of(server, answer, 0)).encode().len()).sum()
}

/// The memory of this process, in bytes; 0 where it is not known.
fn memory() -> usize {
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    text.split_whitespace().nth(1).and_then(|pages| pages.parse::<usize>().ok()).unwrap_or(0) * 4096
}

fn times(level: &Level, (bots, seed): (usize, u64), ticks: u64, threads: usize) -> Result<(), Failure> {
    let before = memory();
    let mut game = Match::new(level, bots, seed, [1.0; 2])?;
    let (mut all, mut sent, mut told) = (Vec::new(), 0, 0);
    for tick in 0..ticks {
        let taken = game.answer(|server, now| {
            let begin = Instant::now();
            let heard = server.tick(now).map(|all| all.iter().map(|answer| answer.told.len()).sum::<usize>());
            (begin.elapsed().as_secs_f64() * 1e3, heard)
        })?;
        let heard = taken.1?;
        // The first tick finds the walls.
        if tick > 0 {
            all.push(taken.0);
            (told, sent) = (told + heard, sent + bytes(&game.server));
        }
        game.advance();
    }
    let grown = (memory().saturating_sub(before)) as f64 / bots as f64 / 1024.0;
    all.sort_by(f64::total_cmp);
    let clients = (all.len() * bots) as f64;
    println!(
        "{}: {threads} threads, {} ticks: p50 {:.2} ms, p99 {:.2} ms, worst {:.2} ms; {:.1} told a client; \
         {:.0} bytes a client and tick; {grown:.0} kB of memory a client",
        level.name,
        all.len(),
        quantile(&all, 0.5),
        quantile(&all, 0.99),
        quantile(&all, 1.0),
        told as f64 / clients,
        sent as f64 / clients,
    );
    Ok(())
}

/// When an answer arrives, halfway to the next one, and just before it.
fn moments([begin, end]: [&Moment; 2]) -> [Moment; 3] {
    [begin.clone(), begin.toward(end, 0.5), begin.toward(end, 0.999)]
}

/// Ways to choose of whom a client is told.
const WAYS: [&str; 4] = ["casca-server", "all", "nine rays", "nine rays from five places"];

#[derive(Default, Clone)]
struct Tally {
    hidden: u64,
    withheld: u64,
    visible: u64,
    late: u64,
    late_clients: u64,
}

/// Plays a match with all ways at the same time.
fn beside(
    level: &Level,
    (n, seed): (usize, u64),
    ticks: u64,
    marks: &mut [Vec<(f64, f64)>],
) -> Result<(), Failure> {
    let mut game = Match::new(level, n, seed, [1.0; 2])?;
    let mut truth = Truth::new(level, game.now()[0]);
    let rays = RayOracle::new(&level.objects);
    let mut tallies = vec![Tally::default(); WAYS.len()];
    let mut queue: VecDeque<Vec<[bool; 2]>> = VecDeque::new();
    let (mut clients, mut seconds) = (0u64, [0.0f64; 3]);
    for tick in 0..ticks {
        let begin = Instant::now();
        game.answer(|server, now| server.tick(now).map(|_| ()))??;
        seconds[0] += begin.elapsed().as_secs_f64();
        queue.push_back(by_rays(&game, &rays, n, &mut seconds));
        let told = game.told();
        let mut seen = vec![vec![false; n]; told.len()];
        for moment in moments(game.now()) {
            truth.set(&moment);
            for (i, seen) in seen.iter_mut().enumerate() {
                let unseen: Vec<usize> = (0..n).filter(|&j| j != i && !seen[j]).collect();
                truth.look(moment.eyes[i], &unseen, tick, seen);
            }
        }
        if told.is_empty() {
            game.advance();
            continue;
        }
        while queue.len() > DOWN + 1 {
            queue.pop_front();
        }
        let by_rays = &queue[0];
        for i in 0..n {
            let mut any = [false; 4];
            clients += 1;
            for j in (0..n).filter(|&j| j != i) {
                let pair = i * n + j;
                let is_told = [told[i][j], true, by_rays[pair][0], by_rays[pair][1]];
                for (way, tally) in tallies.iter_mut().enumerate() {
                    tally.hidden += u64::from(!seen[i][j]);
                    tally.visible += u64::from(seen[i][j]);
                    tally.withheld += u64::from(!seen[i][j] && !is_told[way]);
                    tally.late += u64::from(seen[i][j] && !is_told[way]);
                    any[way] |= seen[i][j] && !is_told[way];
                }
            }
            if any[0] {
                println!("late: tick {tick}, client {i} at {}", game.now()[0].eyes[i]);
            }
            tallies.iter_mut().zip(any).for_each(|(tally, any)| tally.late_clients += u64::from(any));
        }
        game.advance();
    }
    println!("{}: {clients} client-ticks; visible {:.3} of all pairs", level.name, {
        let t = &tallies[0];
        t.visible as f64 / (t.visible + t.hidden) as f64
    });
    for ((way, tally), marks) in WAYS.iter().zip(&tallies).zip(marks) {
        let withheld = tally.withheld as f64 / tally.hidden as f64;
        let late = tally.late as f64 / tally.visible as f64;
        println!(
            "  {way}: {withheld:.3} of hidden withheld; {} of {} visible told late ({:.3}%), in {:.2}% of client-ticks",
            tally.late,
            tally.visible,
            late * 100.0,
            tally.late_clients as f64 / clients as f64 * 100.0
        );
        marks.push((late * 100.0, withheld * 100.0));
    }
    let [casca, nine, five] = seconds.map(|s| s * 1e3 / ticks as f64);
    println!("  ms a tick: casca-server {casca:.1}, nine rays {nine:.1}, from five places {five:.1}");
    Ok(())
}

/// What rays to boxes say from where eyes were reported, by client and bot: from the eye, and from
/// the middle and the corners of the square that it may be in.
fn by_rays(game: &Match, rays: &RayOracle, n: usize, seconds: &mut [f64; 3]) -> Vec<[bool; 2]> {
    let server = &game.server;
    let clients: Vec<_> = server.clients().map(|(id, desc)| (id, *desc)).collect();
    let boxes: Vec<_> = server.entities().map(|(_, entity)| entity.bounds).collect();
    let mut told = vec![[false; 2]; n * n];
    let begin = Instant::now();
    for (i, (_, desc)) in clients.iter().enumerate() {
        for (j, b) in boxes.iter().enumerate() {
            told[i * n + j][0] = rays.nine_rays(desc.eye, b.min, b.max);
        }
    }
    seconds[1] += begin.elapsed().as_secs_f64();
    let begin = Instant::now();
    for (i, (id, desc)) in clients.iter().enumerate() {
        let reach = server.answer(*id).map_or(0.0, |answer| answer.reach) as f32;
        let corner = |x: f32, z: f32| desc.eye + Vec3::new(x, 0.0, z) * reach;
        let places = [desc.eye, corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, 1.0), corner(-1.0, -1.0)];
        for (j, b) in boxes.iter().enumerate() {
            told[i * n + j][1] = places.iter().any(|&eye| rays.nine_rays(eye, b.min, b.max));
        }
    }
    seconds[2] += begin.elapsed().as_secs_f64();
    told
}
