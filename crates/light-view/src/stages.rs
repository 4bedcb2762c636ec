//! The time of each stage, beside the thesis' ratios.

use std::error::Error;
use std::time::Duration;

use casca_lab::command_line::say;
use casca_light::culling::{Culling, may_see};
use casca_light::picture::Layer;
use casca_light::renderer::{Renderer, Settings, Updated};
use casca_light::timing::Clock;
use casca_stage::canvas::Canvas;
use casca_stage::gpu::Gpu;

use crate::headless::told;
use crate::options::Options;
use crate::scene::Start;

/// Frames of which times are the median.
const FRAMES: usize = 5;
/// Step factors of the thesis, as shares of a cone's diameter, and its times relative to that of 0.5 (table 4.6, mean of four scenes).
const STEP_FACTORS: [(f32, f32); 4] = [(0.1, 3.99), (0.25, 1.73), (0.5, 1.0), (2.5, 0.38)];
/// What the thesis' table 4.4 gives for a doubling of the resolution, from 128 to 256 or 256 to 512.
const DOUBLINGS: [(&str, &str); 4] =
    [("mips", "5.3 to 7.9"), ("cones", "1.1"), ("bounce", "5.2 to 6.6"), ("shade", "4.8 to 6.1")];

/// Stages in the order in which they first ran, with the median over frames of their time in a frame.
fn medians(clocks: &[Clock]) -> Vec<(&'static str, Duration)> {
    let mut names: Vec<&'static str> = Vec::new();
    for (name, _) in clocks.iter().flat_map(Clock::stages) {
        if !names.contains(name) {
            names.push(name);
        }
    }
    let time_of = |name: &str, clock: &Clock| -> Duration {
        clock.stages().iter().filter(|s| s.0 == name).map(|s| s.1).sum()
    };
    let median = |name: &'static str| {
        let mut times: Vec<Duration> = clocks.iter().map(|clock| time_of(name, clock)).collect();
        times.sort_unstable();
        (name, times[times.len() / 2])
    };
    names.into_iter().map(median).collect()
}

fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// Prints the time of each stage at several resolutions, then that of the cones by step, and what culling saves.
pub fn time(gpu: &Gpu, start: &Start, options: &Options) -> Result<(), Box<dyn Error>> {
    let (width, height) = options.size;
    say(format_args!(
        "{}, {width}x{height}, {} balls move; medians of {FRAMES} frames, all light in each",
        start.scene.name,
        start.balls_at(0.0).count()
    ));
    let canvas = Canvas::new(gpu, options.size);
    let mut columns = Vec::new();
    for &resolution in &options.times {
        let mut renderer = Renderer::new(gpu, &start.scene, Settings { resolution, ..options.settings() })?;
        columns.push(medians(&frames(gpu, start, &mut renderer, &canvas, false)?.0));
    }
    let heads: Vec<String> = options.times.iter().map(|n| format!("{n:>9}")).collect();
    say(format_args!("{:<16}{} cells; ms", "", heads.concat()));
    for (i, (name, _)) in columns.first().into_iter().flatten().enumerate() {
        let times: Vec<f64> = columns.iter().map(|c| c.get(i).map_or(0.0, |s| ms(s.1))).collect();
        let row: String = times.iter().map(|t| format!("{t:9.2}")).collect();
        let ratios: Vec<String> = times.windows(2).map(|w| format!("x{:.1}", w[1] / w[0])).collect();
        let theirs =
            DOUBLINGS.iter().find(|d| d.0 == *name).map_or(String::new(), |d| format!("; thesis x{}", d.1));
        say(format_args!("{name:<16}{row}   {}{theirs}", ratios.join(" ")));
    }
    steps(gpu, start, options, &canvas)?;
    culled(gpu, start, options, &canvas)
}

/// Draws frames in which the balls move and all light changes; their clocks, and what the last update did.
fn frames(
    gpu: &Gpu,
    start: &Start,
    renderer: &mut Renderer,
    canvas: &Canvas,
    cull: bool,
) -> Result<(Vec<Clock>, Updated), Box<dyn Error>> {
    let camera = start.camera(canvas.size());
    let mut culling = Culling::new(&start.scene, renderer.volume())?;
    let mut first = Clock::on();
    renderer.update(gpu, None, &mut first)?;
    let (mut clocks, mut updated) = (Vec::new(), Updated::default());
    for frame in 0..FRAMES {
        for (ball, place) in start.balls_at(frame as f32 * 0.1) {
            renderer.move_object(gpu, ball, place)?;
            culling.move_object(ball, place)?;
        }
        renderer.set_lights(gpu, &start.scene.lights)?;
        let mut clock = Clock::on();
        let reach = if cull {
            let sight = culling.look(&camera)?.ok_or("the query has not run")?;
            Some(renderer.reach(&|b| may_see(&sight, b)))
        } else {
            None
        };
        updated = renderer.update(gpu, reach.as_ref(), &mut clock)?;
        renderer.draw(gpu, &canvas.picture(), &camera, Layer::Picture, &mut clock)?;
        clocks.push(clock);
    }
    // The layer that stays is voxelized once.
    if let Some(fixed) = first.stages().first() {
        say(format_args!(
            "{} cells: {} {:.2} ms, once",
            renderer.settings().resolution,
            fixed.0,
            ms(fixed.1)
        ));
    }
    Ok((clocks, updated))
}

fn steps(gpu: &Gpu, start: &Start, options: &Options, canvas: &Canvas) -> Result<(), Box<dyn Error>> {
    let camera = start.camera(canvas.size());
    let mut renderer = Renderer::new(gpu, &start.scene, options.settings())?;
    renderer.update(gpu, None, &mut Clock::off())?;
    let mut times = Vec::new();
    for (factor, _) in STEP_FACTORS {
        // The thesis measures steps in diameters, of two texels.
        renderer.set_settings(gpu, Settings { step: 2.0 * factor, ..options.settings() })?;
        let mut clocks = Vec::new();
        for _ in 0..FRAMES {
            let mut clock = Clock::on();
            renderer.draw(gpu, &canvas.picture(), &camera, Layer::Picture, &mut clock)?;
            clocks.push(clock);
        }
        times.push(medians(&clocks).iter().find(|s| s.0 == "cones").map_or(0.0, |s| ms(s.1)));
    }
    say(format_args!("cones at {} cells by step factor, relative to 0.5:", options.resolution));
    for (time, (factor, theirs)) in times.iter().zip(STEP_FACTORS) {
        say(format_args!("  {factor:<5} {time:9.2} ms  x{:.2}; thesis x{theirs}", time / times[2]));
    }
    Ok(())
}

fn culled(gpu: &Gpu, start: &Start, options: &Options, canvas: &Canvas) -> Result<(), Box<dyn Error>> {
    for cull in [false, true] {
        let mut renderer = Renderer::new(gpu, &start.scene, options.settings())?;
        let (clocks, updated) = frames(gpu, start, &mut renderer, canvas, cull)?;
        let stages = medians(&clocks);
        let of = |wanted: &[&str]| -> f64 {
            stages.iter().filter(|s| wanted.contains(&s.0)).map(|s| ms(s.1)).sum()
        };
        say(format_args!(
            "{}: light in voxels {:.2} ms (shade {:.2}, bounce {:.2}, writing and mips {:.2}); {}",
            if cull { "culled" } else { "all bricks" },
            of(&["shade", "bounce", "write voxels", "mips"]),
            of(&["shade"]),
            of(&["bounce"]),
            of(&["write voxels", "mips"]),
            told(&renderer, &updated)
        ));
    }
    Ok(())
}
