//! How much of a set is put into place anew when a share of its lines moves: cells, values of
//! places, and the time of the update and of the next frame, beside making everything anew.
//!
//! `cargo run --release -p casca-lines --features gpu --example moving -- [--software] [percents...]`
//!
//! Without percents a hundredth moves. Beyond `numeric::MOST_MOVED` all is made anew.

use std::error::Error;
use std::time::{Duration, Instant};

use casca_lines::glam::{Vec3, vec3};
use casca_lines::gpu::culling::Seen;
use casca_lines::gpu::moving::MovingLines;
use casca_lines::gpu::renderer::Renderer;
use casca_lines::gpu::set::GpuLines;
use casca_lines::gpu::settings::Settings;
use casca_lines::sets::LineSet;
use casca_lines::sets::generate::{Family, Recipe};
use casca_lines::view::View;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_stage::timing::Clock;

/// Pixels of a frame.
const SIZE: [u32; 2] = [240, 180];
/// The radius of the occlusion and the way that lines move, as shares of the extent.
const RADIUS: f32 = 0.13;
const WAY: f32 = 0.01;
/// Rounds of each kind; the least time counts.
const ROUNDS: usize = 3;

/// Which lines move.
#[derive(Clone, Copy, Debug)]
enum Which {
    /// Evenly spread over the numbers of the lines.
    Spread,
    /// Those whose middle vertices are nearest to that of the first line.
    Together,
}

/// The numbers of the lines that move, ascending.
fn chosen(set: &LineSet, which: Which, percent: f64) -> Vec<usize> {
    let share = percent / 100.0;
    let middles: Vec<Vec3> = set.iter().map(|l| l.get(l.len() / 2).copied().unwrap_or_default()).collect();
    let mut order: Vec<usize> = (0..set.len()).collect();
    match which {
        // One each time that the sum of the shares passes a whole number.
        Which::Spread => order.retain(|&i| (i as f64 * share).floor() != ((i + 1) as f64 * share).floor()),
        Which::Together => {
            order.sort_by(|a, b| {
                let far = |i: &usize| middles[*i].distance(middles[0]);
                far(a).total_cmp(&far(b))
            });
            order.truncate((set.len() as f64 * share) as usize);
            order.sort_unstable();
        }
    }
    order
}

/// A frame: the values that it computed, and the time of its places.
fn frame(
    gpu: &Gpu,
    renderer: &mut Renderer,
    lines: &GpuLines,
    view: &View,
) -> Result<(u32, Duration), Box<dyn Error>> {
    let mut clock = Clock::on();
    renderer.update(gpu, view, (lines, &Seen::all(lines.bundles().len())), &[], &mut clock)?;
    let of_places = clock.stages().iter().filter(|(name, _)| name.contains("places"));
    Ok((renderer.read_computed(gpu)?, of_places.map(|(_, time)| *time).sum()))
}

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let gpu = Gpu::headless(words.iter().any(|word| word == "--software"))?;
    let mut percents: Vec<f64> = words.iter().filter_map(|word| word.parse().ok()).collect();
    if percents.is_empty() {
        percents.push(1.0);
    }
    println!("{}, {} x {} pixels\n", gpu.name, SIZE[0], SIZE[1]);
    println!(
        "| set | moved | segments | cells changed | values anew | update, its frame (ms) | all anew, its frame (ms) |"
    );
    println!("|---|---|---:|---:|---:|---:|---:|");
    for family in [Family::Spiral, Family::Reservoir, Family::Abc] {
        let set = Recipe::new(family, 1).make()?;
        let [min, max] = set.bounds();
        let extent = (max - min).max_element();
        let view = View::around([min, max], vec3(0.5, 0.6, 1.0), Some(0.7), SIZE)?;
        let [near, far] = view.depths();
        let settings = Settings::of_places(RADIUS * extent, view.pixel_size((near + far) / 2.0) as f32 / 2.0);
        let mut renderer = Renderer::new(&gpu, COLOUR, settings)?;
        let ways = percents.iter().flat_map(|&p| [(Which::Spread, p), (Which::Together, p)]);
        for (which, percent) in ways {
            let lines = chosen(&set, which, percent);
            let mut moving = MovingLines::new(&gpu, set.clone(), &settings)?;
            let mut least = [Duration::MAX; 4];
            let mut row = String::new();
            for round in 0..ROUNDS {
                frame(&gpu, &mut renderer, moving.lines(), &view)?;
                let by = vec3(0.6, 0.64, 0.48) * (WAY * extent * (round + 1) as f32);
                let to = set.iter().enumerate().map(|(i, line)| {
                    let by = if lines.binary_search(&i).is_ok() { by } else { Vec3::ZERO };
                    line.iter().map(|p| *p + by).collect::<Vec<_>>()
                });
                let to = LineSet::new(to)?;
                let start = Instant::now();
                let found = moving.update(&gpu, to)?;
                gpu.wait()?;
                let update = start.elapsed();
                let (anew, its_frame) = frame(&gpu, &mut renderer, moving.lines(), &view)?;
                let start = Instant::now();
                let whole = GpuLines::new(&gpu, moving.set(), &settings)?;
                gpu.wait()?;
                let made = start.elapsed();
                let (all, whole_frame) = frame(&gpu, &mut renderer, &whole, &view)?;
                for (least, now) in least.iter_mut().zip([update, its_frame, made, whole_frame]) {
                    *least = now.min(*least);
                }
                let cells = if found.new_lines {
                    "all, and all values".to_string()
                } else if found.new_cells {
                    "all".to_string()
                } else {
                    found.cells.to_string()
                };
                row = format!("{} | {cells} | {anew} of {all}", found.segments);
            }
            let [a, b, c, d] = least.map(|time| time.as_secs_f64() * 1e3);
            println!(
                "| {}, {} lines | {percent}%, {which:?} | {row} | {a:.1}, {b:.1} | {c:.1}, {d:.1} |",
                family.name(),
                set.len()
            );
        }
    }
    Ok(())
}
