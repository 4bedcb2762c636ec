//! Values of places, which stay from frame to frame.

use super::*;

/// A frame of all lines, and the values that it computed.
fn frame(gpu: &Gpu, renderer: &mut Renderer, lines: &GpuLines, view: &View) -> (Vec<f32>, u32) {
    draw(gpu, renderer, lines, view);
    (renderer.read_occlusion(gpu).unwrap(), renderer.read_computed(gpu).unwrap())
}

#[test]
fn a_still_picture_computes_nothing_anew_and_a_moved_one_little() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let set = set(Family::Spiral, 120);
    // Places about as far apart as pixels.
    let settings = Settings::of_places(0.3, 0.02);
    let lines = GpuLines::new(&gpu, &set, &settings).unwrap();
    let mut renderer = Renderer::new(&gpu, COLOUR, settings).unwrap();
    for view in views(set.bounds()) {
        lines.forget();
        let (first, all) = frame(&gpu, &mut renderer, &lines, &view);
        let (again, none) = frame(&gpu, &mut renderer, &lines, &view);
        assert!(all > 1000 && none == 0 && again == first, "{all} {none}");
        let (_, some) = frame(&gpu, &mut renderer, &lines, &view.turned(0.1f64.to_radians()));
        assert!(some > 0 && some * 2 < all, "{some} of {all}");
        // What was computed in other views is what this one computes.
        let (back, none) = frame(&gpu, &mut renderer, &lines, &view);
        assert!(none == 0 && back == first);
        lines.forget();
        assert!(frame(&gpu, &mut renderer, &lines, &view) == (first, all));
    }
}

#[test]
fn other_settings_and_other_lines_are_computed_anew() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let (first, second) = (set(Family::Spiral, 60), set(Family::PomPom, 100));
    let settings = Settings::of_places(0.3, 0.01);
    let view = views(first.bounds())[1];
    let changed = [
        Settings { samples: 8, ..settings },
        Settings { sets: 3, ..settings },
        Settings { ao: AoOptions { radius: 0.2, ..settings.ao }, ..settings },
        Settings { ao: AoOptions { solid: true, ..settings.ao }, ..settings },
        Settings {
            ao: AoOptions { estimator: Settings::of_places(0.3, 0.009).ao.estimator, ..settings.ao },
            ..settings
        },
    ];
    for other in changed {
        let lines = GpuLines::new(&gpu, &first, &settings).unwrap();
        let mut renderer = Renderer::new(&gpu, COLOUR, settings).unwrap();
        let usual = frame(&gpu, &mut renderer, &lines, &view);
        renderer.set_settings(&gpu, other).unwrap();
        let after = frame(&gpu, &mut renderer, &lines, &view);
        let alone = frame(
            &gpu,
            &mut Renderer::new(&gpu, COLOUR, other).unwrap(),
            &GpuLines::new(&gpu, &first, &settings).unwrap(),
            &view,
        );
        assert!(after == alone && after.0 != usual.0, "{other:?}");
        let moved = GpuLines::new(&gpu, &second, &other).unwrap();
        let after = frame(&gpu, &mut renderer, &moved, &view);
        let mut alone = Renderer::new(&gpu, COLOUR, other).unwrap();
        moved.forget();
        assert!(after == frame(&gpu, &mut alone, &moved, &view));
    }
}

#[test]
fn lines_without_places_are_refused_and_empty_ones_are_not() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let settings = Settings::of_places(0.3, 0.01);
    let set = set(Family::Spiral, 5);
    let view = views(set.bounds())[0];
    let mut renderer = Renderer::new(&gpu, COLOUR, settings).unwrap();
    let lines = GpuLines::new(&gpu, &set, &Settings::new(0.3, 0.01)).unwrap();
    assert!(!lines.suits(&settings) && lines.places() == 0);
    let seen = Seen::all(lines.bundles().len());
    let why = renderer.update(&gpu, &view, (&lines, &seen), &[], &mut Clock::off()).unwrap_err();
    assert!(why.to_string().contains("no places"), "{why}");
    for odd in [LineSet::default(), LineSet::new([vec![], vec![Vec3::ZERO], vec![]]).unwrap()] {
        let lines = GpuLines::new(&gpu, &odd, &settings).unwrap();
        assert!(lines.suits(&settings) && !lines.suits(&Settings::of_places(2.0, 0.01)));
        let (occlusion, computed) = frame(&gpu, &mut renderer, &lines, &view);
        assert!(occlusion.iter().all(|&o| o == 0.0) && computed <= 4, "{computed}");
    }
}
