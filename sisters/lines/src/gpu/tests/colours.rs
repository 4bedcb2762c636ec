//! Lines in colours of their vertices.

use super::*;
use crate::gpu::error::LinesGpuError;
use crate::view::Lens;

/// The picture of lines in plain colours, white behind.
fn plain(gpu: &Gpu, renderer: &mut Renderer, lines: &GpuLines, view: &View) -> Vec<[u8; 4]> {
    let canvas = Canvas::new(gpu, SIZE.into());
    draw(gpu, renderer, lines, view);
    renderer.paint(gpu, &canvas.picture(), Look::Plain, 1.0, Vec3::ONE, &mut Clock::off()).unwrap();
    canvas.read_picture(gpu).unwrap().as_chunks::<4>().0.to_vec()
}

#[test]
fn segments_run_from_the_colour_of_one_end_to_that_of_the_other() {
    let Some(gpu) = Gpu::for_tests() else { return };
    // Along the middles of a row of pixels each, from the left border to the right one; and a dot.
    let row = |y: f32| y - 0.5;
    let lines = [
        vec![vec3(-32.0, row(10.0), 0.0), vec3(0.0, row(10.0), 0.0), vec3(32.0, row(10.0), 0.0)],
        vec![vec3(-32.0, row(-5.0), 0.0), vec3(32.0, row(-5.0), 0.0)],
        vec![vec3(0.5, row(0.0), 0.0)],
    ];
    let set = LineSet::new(lines).unwrap();
    let lens = Lens::Orthographic { half_height: 24.0 };
    let view = View::look_at([Vec3::Z * 5.0, Vec3::ZERO, Vec3::Y], lens, [1.0, 9.0], SIZE).unwrap();
    let settings = Settings::new(5.0, 0.5);
    let mut renderer = Renderer::new(&gpu, COLOUR, settings).unwrap();
    let mut on_device = GpuLines::new(&gpu, &set, &settings).unwrap();
    let pale = plain(&gpu, &mut renderer, &on_device, &view);
    let (red, green, blue) = ([255, 0, 0], [0, 255, 0], [0, 0, 255]);
    let colours = [red, green, blue, blue, red, [10, 20, 30]];
    on_device.paint(&gpu, &set, Some(&colours)).unwrap();
    let painted = plain(&gpu, &mut renderer, &on_device, &view);
    let at = |x: usize, y: i32| painted[(24 - y) as usize * 64 + x];
    let mixed = |a: [u8; 3], b: [u8; 3], t: f32| {
        [0, 1, 2].map(|c| (f32::from(a[c]) + (f32::from(b[c]) - f32::from(a[c])) * t).round() as u8)
    };
    let mut most = 0;
    for x in 0..64 {
        let t = (x as f32 + 0.5) / 64.0;
        let bent = if t < 0.5 { mixed(red, green, 2.0 * t) } else { mixed(green, blue, 2.0 * t - 1.0) };
        for (y, wanted) in [(10, bent), (-5, mixed(blue, red, t))] {
            most = (0..3).map(|c| at(x, y)[c].abs_diff(wanted[c])).fold(most, u8::max);
        }
    }
    // Where two segments touch a pixel it shows an end of one of them: half a pixel of 8 a pixel.
    assert!(most <= 4, "{most}");
    assert_eq!(at(32, 0), [10, 20, 30, 255]);
    assert_eq!(at(0, 0), [255; 4], "the background");
    let short = on_device.paint(&gpu, &set, Some(&colours[1..]));
    assert!(matches!(short, Err(LinesGpuError::Colours { colours: 5, vertices: 6 })));
    on_device.paint(&gpu, &set, None).unwrap();
    assert!(plain(&gpu, &mut renderer, &on_device, &view) == pale && pale != painted);
}
