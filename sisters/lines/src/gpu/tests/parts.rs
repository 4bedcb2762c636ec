//! Cells in parts give what cells in one buffer give.

use casca_stage::gpu::GpuError;

use super::*;
use crate::cells::Cells;
use crate::gpu::grid::GpuCells;
use crate::gpu::moving::MovingLines;

/// The least parts that hold the cells of lines: words of segments and of lists.
fn least_parts(cells: &Cells) -> u32 {
    let words = [(cells.lists().len(), 6), (cells.ends().len() * 8, 2)];
    (3..32).find(|&bits| words.iter().all(|(words, most)| words.div_ceil(1 << bits) <= *most)).unwrap()
}

#[test]
fn cells_in_parts_give_the_same_occlusion_bit_for_bit() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let mut most = 0;
    // Long segments are named by many cells, so that lists lie in many parts.
    for (family, lines, vertices) in [(Family::Spiral, 500, 60), (Family::PomPom, 90, 60)] {
        let set = Recipe { lines, vertices, ..Recipe::new(family, 3) }.make().unwrap();
        let [view, _] = views(set.bounds());
        for settings in [Settings::new(0.3, 0.017), Settings::of_places(0.3, 0.017)] {
            let mut lines = GpuLines::new(&gpu, &set, &settings).unwrap();
            let seen = Seen::all(lines.bundles().len());
            let mut renderer = Renderer::new(&gpu, COLOUR, settings).unwrap();
            let mut frame = |lines: &GpuLines| {
                lines.forget();
                renderer.update(&gpu, &view, (lines, &seen), &[], &mut Clock::off()).unwrap();
                renderer.read_occlusion(&gpu).unwrap()
            };
            let whole = frame(&lines);
            assert!(!lines.cells.is_split() && whole.iter().any(|o| *o > 0.3));
            let cells = Cells::new(&set, settings.margin());
            let bits = least_parts(&cells);
            most = most.max(cells.lists().len().div_ceil(1 << bits));
            let bytes = lines.cells.bytes();
            lines.cells = GpuCells::of_parts(&gpu, &cells, bits).unwrap();
            assert!(lines.cells.is_split() && lines.cells.bytes() == bytes, "{bits}");
            assert!(frame(&lines) == whole, "{family:?}");
            let few = GpuCells::of_parts(&gpu, &cells, bits - 1);
            assert!(matches!(few.err(), Some(GpuError::NoRoom { .. })));
            lines.cells = GpuCells::new(&gpu, &cells).unwrap();
            assert!(!lines.cells.is_split() && frame(&lines) == whole);
        }
    }
    assert!(most > 3, "{most}");
}

#[test]
fn lines_in_parts_may_move() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let set = set(Family::Spiral, 60);
    let settings = Settings::of_places(0.3, 0.01);
    let [view, _] = views(set.bounds());
    let moved = |(i, line): (usize, &[Vec3])| {
        let by = if i == 7 { Vec3::Y * 0.05 } else { Vec3::ZERO };
        line.iter().map(|p| *p + by).collect::<Vec<_>>()
    };
    let to = LineSet::new(set.iter().enumerate().map(moved)).unwrap();
    let frames = [false, true].map(|is_split| {
        let mut moving = MovingLines::new(&gpu, set.clone(), &settings).unwrap();
        let mut renderer = Renderer::new(&gpu, COLOUR, settings).unwrap();
        let seen = Seen::all(moving.lines().bundles().len());
        if is_split {
            moving.split_cells(&gpu, least_parts(&Cells::new(&set, settings.margin())));
            assert!(moving.lines().cells.is_split());
        }
        let mut frame = |moving: &MovingLines| {
            renderer.update(&gpu, &view, (moving.lines(), &seen), &[], &mut Clock::off()).unwrap();
            renderer.read_occlusion(&gpu).unwrap()
        };
        let before = frame(&moving);
        assert!(!moving.update(&gpu, to.clone()).unwrap().new_lines);
        (before, frame(&moving))
    });
    assert!(frames[0] == frames[1] && frames[0].0 != frames[0].1);
}
