//! Empty sets and bad values.

use super::*;
use crate::gpu::error::LinesGpuError;
use crate::view::Lens;

#[test]
fn empty_sets_give_empty_pictures_and_bad_values_are_named() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let good = Settings::new(0.3, 0.01);
    let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, None, SIZE).unwrap();
    let renderer = run(&gpu, &LineSet::default(), &view, good);
    assert!(renderer.read_fragments(&gpu).unwrap().iter().all(Option::is_none));
    assert!(renderer.read_occlusion(&gpu).unwrap().iter().all(|&o| o == 0.0));
    let error = |with: Settings| Renderer::new(&gpu, COLOUR, with).err().unwrap().to_string();
    assert!(error(Settings { samples: 0, ..good }).contains("1 or more"));
    assert!(error(settings(AoOptions::rays(f32::NAN, 0.1))).contains("radius"));
    // A picture beyond the limits of the adapter, and the renderer goes on.
    let mut renderer = Renderer::new(&gpu, COLOUR, good).unwrap();
    let lines = GpuLines::new(&gpu, &set(Family::Spiral, 5), &of_margin(0.04)).unwrap();
    let (seen, clock) = (Seen::all(lines.bundles().len()), &mut Clock::off());
    let limits = gpu.device.limits();
    if limits.max_storage_buffer_binding_size.min(limits.max_buffer_size) < 8192 * 8192 * 32 {
        let large = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, None, [8192; 2]).unwrap();
        let why = renderer.update(&gpu, &large, (&lines, &seen), &[], clock).unwrap_err();
        assert!(matches!(why, LinesGpuError::Gpu(_)), "{why}");
    }
    renderer.update(&gpu, &view, (&lines, &seen), &[], clock).unwrap();
    let lens = Lens::Perspective { fov_y: 0.01 };
    let afar = View::look_at([Vec3::Z * 200.0, Vec3::ZERO, Vec3::Y], lens, [199.0, 201.0], SIZE).unwrap();
    let why = renderer.update(&gpu, &afar, (&lines, &seen), &[], clock).unwrap_err();
    assert!(why.to_string().contains("depths from 199 to 201"), "{why}");
    let more = Seen::all(lines.bundles().len() + 1);
    let unknown = renderer.update(&gpu, &view, (&lines, &more), &[], clock).unwrap_err();
    assert!(matches!(unknown, LinesGpuError::Bundle { .. }), "{unknown}");
    let mut thick = Renderer::new(&gpu, COLOUR, Settings::new(0.3, 0.05)).unwrap();
    let why = thick.update(&gpu, &view, (&lines, &seen), &[], clock).unwrap_err();
    assert!(why.to_string().contains("margin of 0.04"), "{why}");
    assert!(!lines.suits(&Settings::new(0.3, 0.05)) && lines.suits(&Settings::new(0.3, 0.0133)));
    assert!(!lines.suits(&Settings::new(0.3, 0.003)));
    // Without a frame there is the background alone.
    let (canvas, renderer) = (Canvas::new(&gpu, (8, 8)), Renderer::new(&gpu, COLOUR, good).unwrap());
    renderer.paint(&gpu, &canvas.picture(), Look::Plain, 1.0, Vec3::X, clock).unwrap();
    assert!(canvas.read_picture(&gpu).unwrap().chunks(4).all(|pixel| pixel == [255, 0, 0, 255]));
    let nan = Context::of_boxes(&[[Vec3::NAN, Vec3::ONE]]);
    assert!(matches!(Culling::new(lines.bundles(), &[nan]), Err(LinesGpuError::Scene(_))));
}
