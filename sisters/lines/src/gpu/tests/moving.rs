//! Lines of which some move: most values stay, and are those that are computed anew.

use super::*;
use crate::gpu::moving::{Moved, MovingLines};

/// The set with every so-many-th line moved.
fn shifted(set: &LineSet, every: usize, by: Vec3) -> LineSet {
    let lines = set.iter().enumerate().map(|(i, line)| {
        let by = if i % every == 0 { by } else { Vec3::ZERO };
        line.iter().map(|p| *p + by).collect::<Vec<_>>()
    });
    LineSet::new(lines).unwrap()
}

fn frame(gpu: &Gpu, renderer: &mut Renderer, lines: &GpuLines, view: &View) -> (Vec<f32>, u32) {
    let seen = Seen::all(lines.bundles().len());
    renderer.update(gpu, view, (lines, &seen), &[], &mut Clock::off()).unwrap();
    (renderer.read_occlusion(gpu).unwrap(), renderer.read_computed(gpu).unwrap())
}

#[test]
fn values_that_stay_are_those_that_are_computed_anew_and_most_stay() {
    let Some(gpu) = Gpu::for_tests() else { return };
    for (family, lines, every) in [(Family::Spiral, 300, 100), (Family::PomPom, 400, 133)] {
        let set = set(family, lines);
        let settings = Settings::of_places(0.15, 0.008);
        let [view, near] = views(set.bounds());
        let mut renderer = Renderer::new(&gpu, COLOUR, settings).unwrap();
        let mut moving = MovingLines::new(&gpu, set.clone(), &settings).unwrap();
        frame(&gpu, &mut renderer, moving.lines(), &near);
        let (_, all) = frame(&gpu, &mut renderer, moving.lines(), &view);
        let mut least = u32::MAX;
        // There, twice before the next frame, back, and nowhere.
        for ways in [&[0.05][..], &[0.1, 0.14], &[0.0], &[0.0]] {
            let mut found = Moved::default();
            for way in ways {
                found = moving.update(&gpu, shifted(&set, every, vec3(*way, 0.02 * way, 0.0))).unwrap();
                assert!(!found.new_lines, "{found:?}");
            }
            let (kept, anew) = frame(&gpu, &mut renderer, moving.lines(), &view);
            let (other, _) = frame(&gpu, &mut renderer, moving.lines(), &near);
            moving.lines().forget();
            let (whole, every_one) = frame(&gpu, &mut renderer, moving.lines(), &view);
            let differ = kept.iter().zip(&whole).filter(|(a, b)| a != b).count();
            println!("{family:?}: {anew} of {every_one} values anew, {found:?}");
            assert_eq!(differ, 0, "{family:?} {ways:?}");
            assert!(other == frame(&gpu, &mut renderer, moving.lines(), &near).0, "{family:?} {ways:?}");
            assert!(found.lines > 0 || anew == 0, "{anew}");
            least = least.min(if anew > 0 { anew } else { u32::MAX });
            // And what lines say that were made for this set, but for other cells and segments.
            let alone = GpuLines::new(&gpu, moving.set(), &settings).unwrap();
            let (fresh, _) = frame(&gpu, &mut renderer, &alone, &view);
            let off = kept.iter().zip(&fresh).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(off <= 1.01 / 255.0, "{family:?}: {off}");
        }
        assert!(least * 2 < all, "{family:?}: {least} of {all} values were computed anew");
    }
}

#[test]
fn lines_that_leave_the_grid_keep_values_and_others_are_made_anew_with_their_colours() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let set = set(Family::Spiral, 60);
    let settings = Settings::of_places(0.15, 0.008);
    let [view, _] = views(set.bounds());
    let mut renderer = Renderer::new(&gpu, COLOUR, settings).unwrap();
    let mut moving = MovingLines::new(&gpu, set.clone(), &settings).unwrap();
    moving.paint(&gpu, Some(vec![[255, 0, 0]; set.points().len()])).unwrap();
    let canvas = Canvas::new(&gpu, SIZE.into());
    let mut update = |moving: &mut MovingLines, to: LineSet| {
        let old = frame(&gpu, &mut renderer, moving.lines(), &view).0;
        let found = moving.update(&gpu, to).unwrap();
        let (kept, anew) = frame(&gpu, &mut renderer, moving.lines(), &view);
        moving.lines().forget();
        let (whole, all) = frame(&gpu, &mut renderer, moving.lines(), &view);
        // Other cells, other borders: a value may be rounded to the next of 256.
        let off = kept.iter().zip(&whole).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off <= 1.01 / 255.0 && kept != old, "{found:?}: {off}");
        renderer.paint(&gpu, &canvas.picture(), Look::Plain, 1.0, Vec3::ONE, &mut Clock::off()).unwrap();
        let picture = canvas.read_picture(&gpu).unwrap();
        let is_red = picture.chunks(4).any(|p| p == [255, 0, 0, 255]);
        (found, anew, all, is_red)
    };
    let (found, anew, all, is_red) = update(&mut moving, shifted(&set, 59, Vec3::Y * 0.8));
    assert!(found.new_cells && !found.new_lines && anew * 2 < all && is_red, "{found:?} {anew} {all}");
    let bounds = |moving: &MovingLines| {
        let start = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        let all = moving.lines().bundles().iter().map(|b| b.bounds);
        all.fold(start, |[min, max], b| [min.min(b[0]), max.max(b[1])])
    };
    assert_eq!(bounds(&moving), moving.set().bounds());
    // A line of three times the length, back, many lines, and other lines.
    let grown =
        |(i, l): (usize, &[Vec3])| l.iter().map(|p| *p * if i == 7 { 3.0 } else { 1.0 }).collect::<Vec<_>>();
    let (found, anew, all, is_red) =
        update(&mut moving, LineSet::new(set.iter().enumerate().map(grown)).unwrap());
    assert!(found.new_lines && anew == all && is_red, "{found:?}");
    assert!(update(&mut moving, set.clone()).0.new_lines);
    // Eight lines of 60, and five.
    assert!(update(&mut moving, shifted(&set, 8, Vec3::Y * 0.1)).0.new_lines);
    let few = shifted(moving.set(), 12, Vec3::Y * 0.1);
    assert!(!update(&mut moving, few).0.new_lines);
    let (found, _, _, is_red) =
        update(&mut moving, LineSet::new(set.iter().take(40).map(<[Vec3]>::to_vec)).unwrap());
    assert!(found.new_lines && !is_red, "{found:?}");
    assert!(moving.update(&gpu, LineSet::default()).unwrap().new_lines);
    assert_eq!(moving.update(&gpu, LineSet::default()).unwrap(), Moved::default());
}
