//! Empty sets and bad values.

use casca_stage::canvas::Canvas;
use casca_stage::gpu::GpuError;

use super::*;
use crate::gpu::context::Context;
use crate::gpu::culling::Culling;
use crate::gpu::error::LinesGpuError;
use crate::gpu::renderer::Look;
use crate::view::Lens;

fn run_on(gpu: &Gpu, view: &View, lines: (&GpuLines, &Seen)) -> Result<(), LinesGpuError> {
    let mut renderer = Renderer::new(gpu, COLOUR, settings(AoOptions::new(0.3, 0.01)))?;
    renderer.update(gpu, view, lines, &[], &mut Clock::off())
}

#[test]
fn empty_sets_give_empty_pictures_and_bad_values_are_named() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let good = settings(AoOptions::new(0.3, 0.01));
    let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, None, SIZE).unwrap();
    let renderer = run(&gpu, &LineSet::default(), &view, good);
    assert!(renderer.read_fragments(&gpu).unwrap().iter().all(Option::is_none));
    assert!(renderer.read_occlusion(&gpu).unwrap().iter().all(|&o| o == 0.0));
    let error = |with: Settings| Renderer::new(&gpu, COLOUR, with).err().unwrap().to_string();
    assert!(error(Settings { coarse: 0, ..good }).contains("1 to 64 pixels"));
    assert!(error(Settings { samples: 0, ..good }).contains("1 or more"));
    assert!(error(settings(AoOptions::new(f32::NAN, 0.1))).contains("radius"));
    // A picture beyond the limits of the adapter, and the renderer goes on.
    let mut renderer = Renderer::new(&gpu, COLOUR, Settings { slices: Slices::S256, ..good }).unwrap();
    let lines = GpuLines::new(&gpu, &set(Family::Spiral, 5), &of_margin(0.04)).unwrap();
    let mut update = |size: [u32; 2], seen: &Seen| {
        let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, None, size).unwrap();
        renderer.update(&gpu, &view, (&lines, seen), &[], &mut Clock::off())
    };
    let limits = gpu.device.limits();
    let needed = 8192 * 8192 * 128;
    if limits.max_storage_buffer_binding_size.min(limits.max_buffer_size) < needed {
        let why = update([8192; 2], &Seen::all(1)).unwrap_err();
        assert!(matches!(why, LinesGpuError::TooLarge { width: 8192, .. }), "{why}");
    }
    update(SIZE, &Seen::all(lines.bundles().len())).unwrap();
    let lens = Lens::Perspective { fov_y: 0.01 };
    let afar = View::look_at([Vec3::Z * 200.0, Vec3::ZERO, Vec3::Y], lens, [199.0, 201.0], SIZE).unwrap();
    let seen = Seen::all(lines.bundles().len());
    let why = run_on(&gpu, &afar, (&lines, &seen)).unwrap_err();
    assert!(why.to_string().contains("depths from 199 to 201"), "{why}");
    let unknown = update(SIZE, &Seen::all(lines.bundles().len() + 1)).unwrap_err();
    assert!(matches!(unknown, LinesGpuError::Bundle { .. }), "{unknown}");
    assert!(Settings { coarse: 0, ..good }.reach(&view).is_err());
    let mut thick = Renderer::new(&gpu, COLOUR, Settings::new(0.3, 0.05)).unwrap();
    let why = thick.update(&gpu, &view, (&lines, &seen), &[], &mut Clock::off()).unwrap_err();
    assert!(why.to_string().contains("margin of 0.04"), "{why}");
    assert!(!lines.suits(&Settings::new(0.3, 0.05)) && lines.suits(&Settings::new(0.3, 0.0133)));
    assert!(!lines.suits(&Settings::new(0.3, 0.003)) && lines.suits(&Settings::of_columns(0.3, 0.003)));
    // Without a frame there is the background alone.
    let (canvas, renderer) = (Canvas::new(&gpu, (8, 8)), Renderer::new(&gpu, COLOUR, good).unwrap());
    let paint = |look| renderer.paint(&gpu, &canvas.picture(), look, 1.0, Vec3::X, &mut Clock::off());
    paint(Look::Plain).unwrap();
    assert!(canvas.read_picture(&gpu).unwrap().chunks(4).all(|pixel| pixel == [255, 0, 0, 255]));
    let nan = [[Vec3::NAN, Vec3::ONE]];
    assert!(matches!(
        Culling::new(lines.bundles(), &[Context::of_boxes(&nan)]),
        Err(LinesGpuError::Scene(_))
    ));
    assert!(matches!(LinesGpuError::from(GpuError::NoAdapter("x".into())), LinesGpuError::Gpu(_)));
}
