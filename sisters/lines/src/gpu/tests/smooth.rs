//! Antialiasing, beside larger pictures and samples by the processor.

use glam::{DVec2, DVec3};

use super::*;
use crate::gpu::antialiasing::Antialiasing;
use crate::testing::rmse;

/// How much larger pictures are that stand for the truth.
const LARGER: u32 = 8;
const ONE: Antialiasing = Antialiasing::None;

/// A picture, in shares of white.
fn painted(gpu: &Gpu, set: &LineSet, view: &View, antialiasing: Antialiasing, look: Look) -> Vec<f32> {
    let settings = Settings { samples: 8, antialiasing, ..Settings::new(0.3, 0.01) };
    let renderer = run(gpu, set, view, settings);
    let canvas = Canvas::new(gpu, view.size().into());
    renderer.paint(gpu, &canvas.picture(), look, 1.0, Vec3::ONE, &mut Clock::off()).unwrap();
    let bytes = canvas.read_picture(gpu).unwrap();
    bytes.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).map(|b| f32::from(b) / 255.0).collect()
}

/// The means of squares of pixels.
fn scaled_down(large: &[f32], width: usize, side: usize) -> Vec<f32> {
    let mut sums = vec![0.0; large.len() / (side * side)];
    for (i, value) in large.iter().enumerate() {
        let (pixel, channel) = (i / 3, i % 3);
        let (x, y) = (pixel % width / side, pixel / width / side);
        sums[(y * (width / side) + x) * 3 + channel] += value / (side * side) as f32;
    }
    sums
}

#[test]
fn smooth_pictures_are_near_larger_ones_that_are_scaled_down() {
    let Some(gpu) = Gpu::for_tests() else { return };
    for (name, lines) in [
        ("spiral", set(Family::Spiral, 40)),
        ("hair", set(Family::PomPom, 90)),
        ("reservoir", set(Family::Reservoir, 150)),
        ("segments of all directions and dots", wild(3)),
    ] {
        let small = views([-Vec3::ONE, Vec3::ONE]).map(|v| v.with_height(24).unwrap());
        for (view, look) in small.iter().zip([Look::Plain, Look::Occluded]) {
            let large = view.with_height(view.size()[1] * LARGER).unwrap();
            let thick = Antialiasing::Four { thickness: LARGER as f32 };
            let truth = painted(&gpu, &lines, &large, thick, look);
            let truth = scaled_down(&truth, large.size()[0] as usize, LARGER as usize);
            let [one, four] =
                [ONE, Antialiasing::SMOOTH].map(|a| rmse(&painted(&gpu, &lines, view, a, look), &truth));
            println!("{name}, {look:?}: {one:.4} without, {four:.4} with");
            assert!(four < 0.04 && four < one * 0.5, "{name}: {four} of {one}");
        }
    }
}

/// The lines that samples of a pixel show, on a turned square: `None` if rounding may decide.
fn shown(lines: &LineSet, view: &View, [x, y]: [usize; 2]) -> Option<Vec<u32>> {
    // In pixels and in depth: rounding decides between lines that are nearer to each other.
    const DOUBT: f64 = 1.0 / 32.0;
    const SAME_DEPTH: f64 = 1e-4;
    let mut found = Vec::new();
    for place in [[0.375, 0.125], [0.875, 0.375], [0.125, 0.625], [0.625, 0.875]] {
        let place = DVec2::new(x as f64, y as f64) + DVec2::from_array(place);
        let mut all = Vec::new();
        for (line, points) in lines.iter().enumerate() {
            for pair in points.windows(2) {
                let [a, b] = [pair[0], pair[1]].map(|p| view.to_eye(p));
                let on = |eye: DVec3| {
                    let p = view.project(eye);
                    p.truncate() / p.z
                };
                let (from, way) = (on(a), on(b) - on(a));
                let share = ((place - from).dot(way) / way.length_squared()).clamp(0.0, 1.0);
                let distance = place.distance(from + way * share);
                // The place of the share in space: depths are means of inverses in perspective.
                let (wa, wb) = (view.project(a).z, view.project(b).z);
                let depth = -a.lerp(b, share * wa / (share * wa + (1.0 - share) * wb)).z;
                if distance < 0.5 + DOUBT {
                    all.push((depth, line as u32, distance > 0.5 - DOUBT));
                }
            }
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Those that may lie before the first one that is sure.
        let Some(&(nearest, line, _)) = all.iter().find(|a| !a.2).or(all.first()) else { continue };
        let is_beside = |&(depth, other, doubt): &(f64, u32, bool)| {
            depth < nearest + SAME_DEPTH && (doubt && depth < nearest || other != line)
        };
        if all.iter().any(is_beside) || all.iter().all(|a| a.2) {
            return None;
        }
        if !found.contains(&line) {
            found.push(line);
        }
    }
    Some(found)
}

#[test]
fn samples_show_the_nearest_line_within_half_a_pixel() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let lines = set(Family::Spiral, 25);
    for view in views(lines.bounds()) {
        let settings =
            Settings { antialiasing: Antialiasing::SMOOTH, samples: 1, ..Settings::new(0.3, 0.01) };
        let fragments = run(&gpu, &lines, &view, settings).read_fragments(&gpu).unwrap();
        let pixels = (SIZE[0] * SIZE[1]) as usize;
        assert_eq!(fragments.len(), 4 * pixels);
        let (mut sure, mut several) = (0, 0);
        for (i, nearest) in fragments[..pixels].iter().enumerate() {
            let at = [i % SIZE[0] as usize, i / SIZE[0] as usize];
            let Some(wanted) = shown(&lines, &view, at) else { continue };
            let layers = || (0..4).filter_map(|layer| fragments[layer * pixels + i]);
            let mut seen: Vec<u32> = Vec::new();
            for line in layers().map(|f| f.line) {
                if !seen.contains(&line) {
                    seen.push(line);
                }
            }
            assert_eq!((&seen, nearest.map(|f| f.line)), (&wanted, wanted.first().copied()), "{at:?}");
            // Their places are those of lines that pass by the pixel.
            for fragment in layers() {
                let p = view.project(fragment.position.as_dvec3());
                let off = p.truncate() / p.z - DVec2::new(at[0] as f64 + 0.5, at[1] as f64 + 0.5);
                assert!(off.abs().max_element() < 1.0, "{at:?}: {off}");
            }
            (sure, several) = (sure + usize::from(!seen.is_empty()), several + usize::from(seen.len() > 1));
        }
        assert!(sure > 250 && several > 60, "{sure} {several}");
    }
}

/// The share of a pixel that a stadium around a segment covers, by 64 x 64 points.
fn covered([a, b]: [DVec2; 2], half: f64, corner: DVec2) -> f64 {
    let way = b - a;
    let distance = |p: DVec2| {
        let share = ((p - a).dot(way) / way.length_squared()).clamp(0.0, 1.0);
        p.distance(a + way * share)
    };
    if distance(corner + 0.5) > half + 0.75 {
        return 0.0;
    }
    let point = |i: u32| corner + (DVec2::new(f64::from(i % 64), f64::from(i / 64)) + 0.5) / 64.0;
    (0..64 * 64).filter(|i| distance(point(*i)) <= half).count() as f64 / 4096.0
}

/// The greatest error of the area of a segment in the picture, wherever it lies in a pixel, and
/// the root of the mean square of the errors of pixels at its borders.
fn area_off(
    gpu: &Gpu,
    (ends, lines): ([Vec3; 2], &GpuLines),
    view: &View,
    (antialiasing, thickness): (Antialiasing, f64),
) -> [f64; 2] {
    let settings = Settings { antialiasing, samples: 1, ..Settings::new(0.3, 0.01) };
    let mut renderer = Renderer::new(gpu, COLOUR, settings).unwrap();
    let canvas = Canvas::new(gpu, SIZE.into());
    // No place puts samples onto the border of a line: rounding would decide.
    let (mut most, mut squares) = (0.0f64, Vec::new());
    for part in (0..8).map(|i| 0.03 + 0.107 * f64::from(i)) {
        let moved = view.moved_by_pixels(part, part * 0.5);
        draw(gpu, &mut renderer, lines, &moved);
        // White lines before black.
        let (target, look) = (canvas.picture(), Look::Occlusion);
        renderer.paint(gpu, &target, look, 0.0, Vec3::ZERO, &mut Clock::off()).unwrap();
        let bytes = canvas.read_picture(gpu).unwrap();
        let on = ends.map(|p| {
            let p = moved.project(moved.to_eye(p));
            p.truncate() / p.z
        });
        let [mut sum, mut area] = [0.0; 2];
        for (i, p) in bytes.chunks_exact(4).enumerate() {
            let corner = DVec2::new((i as u32 % SIZE[0]).into(), (i as u32 / SIZE[0]).into());
            let (found, wanted) = (f64::from(p[0]) / 255.0, covered(on, thickness / 2.0, corner));
            (sum, area) = (sum + found, area + wanted);
            squares.extend(Some((found - wanted).powi(2)).filter(|_| found != wanted));
        }
        most = most.max((sum / area - 1.0).abs());
    }
    [most, (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()]
}

#[test]
fn lines_of_any_direction_keep_their_width_wherever_they_lie_in_a_pixel() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, None, SIZE).unwrap();
    // On a diagonal two samples of four lie beside each other.
    let angles = (0..12).map(|i| i as f32 * 15.0).chain([87.0, 20.0, 26.6, 33.7, 116.6]);
    let mut worst = [[0.0f64; 2]; 3];
    for angle in angles {
        let way = Vec3::new(angle.to_radians().cos(), angle.to_radians().sin(), 0.0);
        let ends = [-way, way];
        let lines = GpuLines::new(&gpu, &LineSet::new([ends]).unwrap(), &of_margin(0.03)).unwrap();
        for (i, thickness) in [0.0, 1.0, 2.5].into_iter().enumerate() {
            let antialiasing = if i > 0 { Antialiasing::Four { thickness } } else { ONE };
            let off = area_off(&gpu, (ends, &lines), &view, (antialiasing, f64::from(thickness).max(1.0)));
            println!("{angle} degrees, {antialiasing:?}: {off:.3?}");
            worst[i] = [worst[i][0].max(off[0]), worst[i][1].max(off[1])];
        }
    }
    println!("{worst:.3?}");
    let [without, one, thick] = worst;
    // By samples alone 0.29 and 0.13, 0.12 and 0.12.
    assert!(one[0] < 0.11 && one[1] < 0.08 && thick[0] < 0.06 && thick[1] < 0.08, "{worst:?}");
    assert!(without[0] > 0.4, "{worst:?}");
}

#[test]
fn thin_and_very_thick_lines_are_refused() {
    let Some(gpu) = Gpu::for_tests() else { return };
    for thickness in [0.5, 17.0, f32::NAN, f32::INFINITY] {
        let antialiasing = Antialiasing::Four { thickness };
        let why = Renderer::new(&gpu, COLOUR, Settings { antialiasing, ..Settings::new(0.3, 0.01) });
        let why = why.err().unwrap().to_string();
        assert!(why.contains("1 to 16 pixels thick"), "{why}");
    }
    let settings = Settings { antialiasing: Antialiasing::SMOOTH, ..Settings::of_places(0.3, 0.01) };
    for odd in [LineSet::default(), LineSet::new([vec![], vec![Vec3::ZERO], vec![]]).unwrap()] {
        for view in views([-Vec3::ONE, Vec3::ONE]) {
            let found = run(&gpu, &odd, &view, settings).read_fragments(&gpu).unwrap();
            let count = found.iter().flatten().count();
            assert!(if odd.is_empty() { count == 0 } else { (1..=4).contains(&count) }, "{count}");
        }
    }
}
