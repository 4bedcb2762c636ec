//! The times of the nearest lines with and without the lines that are behind others.

use casca_lines::gpu::culling::Seen;
use casca_lines::gpu::hidden::LineCulling;
use casca_lines::gpu::renderer::Renderer;
use casca_lines::gpu::set::GpuLines;
use casca_lines::gpu::settings::Settings;
use casca_stage::gpu::COLOUR;
use casca_stage::timing::Clock;
use casca_stage::window::Done;
use casca_tools::command_line::say;
use glam::Quat;

use crate::lines::times::Bench;

/// Frames of a camera that turns; the first ones are not counted.
const TURNS: usize = 20;
const UNCOUNTED: usize = 2;

impl Bench<'_> {
    /// Prints them for cameras that turn by some degrees a frame. The two take turns, so that other
    /// programs disturb both alike.
    pub(super) fn behind(&self, settings: Settings, lines: &GpuLines) -> Done {
        let size = <[u32; 2]>::from(self.options.common.drawing.size);
        // The occlusion costs both the same, and is no part of this.
        let settings = Settings { samples: 1, ..settings };
        let seen = Seen::all(lines.bundles().len());
        let [eye, middle] = self.source.start(self.options, size, 0)?;
        for degrees in [0.0, 0.2, 1.0, 10.0] {
            let mut renderers =
                [Renderer::new(self.gpu, COLOUR, settings)?, Renderer::new(self.gpu, COLOUR, settings)?];
            for (renderer, culling) in renderers.iter_mut().zip([LineCulling::Never, LineCulling::Always]) {
                renderer.cull_lines(culling);
            }
            let (mut times, mut segments) = ([Vec::new(), Vec::new()], [0.0; 2]);
            for i in 0..UNCOUNTED + TURNS {
                let turn = Quat::from_rotation_y((degrees * i as f32).to_radians());
                let view = self.source.view(self.options, [middle + turn * (eye - middle), middle], size)?;
                for (which, renderer) in renderers.iter_mut().enumerate() {
                    let mut clock = Clock::on();
                    renderer.update(self.gpu, &view, (lines, &seen), &self.context, &mut clock)?;
                    if i >= UNCOUNTED {
                        let stages = clock.stages().iter().filter(|(name, _)| *name == "nearest lines");
                        times[which].push(stages.map(|(_, time)| time.as_secs_f64() * 1e3).sum::<f64>());
                        segments[which] += f64::from(renderer.read_drawn(self.gpu)?.segments);
                    }
                }
            }
            let middle = |times: &mut Vec<f64>| {
                times.sort_by(f64::total_cmp);
                times[times.len() / 2]
            };
            let [all, culled] = times.each_mut().map(middle);
            say(format_args!(
                "nearest lines, turned by {degrees} degrees a frame, medians of {TURNS}: {all:.3} for all, {culled:.3} without those behind others: {:.1}% of {:.0} segments drawn",
                100.0 * segments[1] / segments[0].max(1.0),
                segments[0] / TURNS as f64
            ));
        }
        Ok(())
    }
}
