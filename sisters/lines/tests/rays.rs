//! The occlusion of the shaders in perspective beside rays in double precision.

use casca_lines::gpu::culling::Seen;
use casca_lines::gpu::renderer::Renderer;
use casca_lines::gpu::set::GpuLines;
use casca_lines::gpu::settings::Settings;
use casca_lines::occlusion::AoOptions;
use casca_lines::sets::generate::{Family, Recipe};
use casca_lines::sets::random::Random;
use casca_lines::view::View;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_stage::timing::Clock;
use glam::vec3;
use truth::Tubes;

mod truth;

/// The radius of the occlusion.
const RADIUS: f32 = 0.26;

#[test]
fn the_occlusion_in_perspective_agrees_with_rays() {
    let Some(gpu) = Gpu::for_tests() else { return };
    // Bounds just beside the values of Mesa's software adapter.
    for (family, lines, solid, [least, most]) in [
        (Family::Spiral, 150, false, [0.935, 0.098]),
        (Family::PomPom, 500, false, [0.97, 0.05]),
        // Bundles whose strands lie within a pixel.
        (Family::Reservoir, 2500, true, [0.95, 0.09]),
    ] {
        let set = Recipe { lines, ..Recipe::new(family, 3) }.make().unwrap();
        let view = View::around(set.bounds(), vec3(0.5, 0.6, 1.0), Some(0.9), [192, 144]).unwrap();
        let [near, far] = view.depths();
        let tube = view.pixel_size((near + far) / 2.0) as f32 / 2.0;
        let (tubes, mut random) = (Tubes::new(&set, f64::from(tube), solid), Random::new(1));
        for settings in [Settings::new(RADIUS, tube), Settings::of_places(RADIUS, tube)] {
            let settings = Settings { ao: AoOptions { solid, ..settings.ao }, ..settings };
            let on_device = GpuLines::new(&gpu, &set, &settings).unwrap();
            let mut renderer = Renderer::new(&gpu, COLOUR, settings).unwrap();
            let seen = Seen::all(on_device.bundles().len());
            renderer.update(&gpu, &view, (&on_device, &seen), &[], &mut Clock::off()).unwrap();
            let fragments = renderer.read_fragments(&gpu).unwrap();
            let found = renderer.read_occlusion(&gpu).unwrap();
            let receivers = fragments.iter().zip(found).filter_map(|(f, o)| Some((f.as_ref()?, o)));
            let (found, wanted): (Vec<f64>, Vec<f64>) = receivers
                .step_by(12)
                .map(|(f, o)| (f64::from(o), tubes.occlusion(&view, f, f64::from(RADIUS), 12, &mut random)))
                .unzip();
            let [pearson, rmse] = truth::agreement(&found, &wanted);
            println!("{}, {:?}: {pearson:.3}, {rmse:.3}", family.name(), settings.ao);
            assert!(found.len() > 200 && pearson > least && rmse < most, "{family:?}: {pearson} {rmse}");
        }
    }
}
