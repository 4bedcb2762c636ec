//! The shaders beside the processor's version and exact clipping, and pictures with and without
//! culling.

use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, Gpu, GpuError};
use casca_stage::timing::Clock;
use glam::{DVec3, Vec3, vec3};
use proptest::prelude::*;

use crate::buffers::LineBuffer;
use crate::cells::Cells;
use crate::gpu::culling::{Culling, Seen};
use crate::gpu::error::LinesGpuError;
use crate::gpu::lens::{Reach, view_of_scene};
use crate::gpu::numeric::{IN_DOUBT, OCCLUSION_OFF};
use crate::gpu::renderer::{Look, Renderer};
use crate::gpu::set::GpuLines;
use crate::gpu::settings::Settings;
use crate::occlusion::{AoOptions, BasePlane, Estimator, Occlusion, SetChoice};
use crate::samples::SampleSets;
use crate::sets::LineSet;
use crate::sets::generate::{Family, Recipe};
use crate::sets::random::Random;
use crate::sets::rooms::House;
use crate::slabs::{SlabGrid, Slices, SpanRule};
use crate::testing::cases;
use crate::view::{Lens, View};

const SIZE: [u32; 2] = [64, 48];

/// A device, or `None` and a line that says so.
fn gpu() -> Option<Gpu> {
    Gpu::headless(false).map_err(|_| println!("skipped: no adapter")).ok()
}

fn set(family: Family, lines: u32) -> LineSet {
    Recipe { lines, ..Recipe::new(family, 3) }.make().unwrap()
}

/// Segments of all directions, many far longer than the picture, some steep, and dots.
fn wild(seed: u64) -> LineSet {
    let mut random = Random::new(seed);
    let mut point =
        |s: f64| Vec3::from_array(std::array::from_fn(|_| (random.within(-s, s) * random.unit()) as f32));
    let lines = (0..120).map(|i| match i % 4 {
        0 => vec![point(9.0), point(9.0)],
        1 => (0..6).map(|_| point(1.5)).collect(),
        2 => {
            let start = point(1.0);
            vec![start, start + vec3(0.3, 0.4, 1.0) * (i as f32 / 60.0) + point(0.01)]
        }
        _ => vec![point(1.2)],
    });
    LineSet::new(lines).unwrap()
}

fn views(bounds: [Vec3; 2]) -> [View; 2] {
    [None, Some(0.8)].map(|fov| View::around(bounds, vec3(0.3, 0.4, 1.0), fov, SIZE).unwrap())
}

fn settings(ao: AoOptions) -> Settings {
    Settings { samples: 60, sets: 4, coarse: 1, slices: Slices::S128, ao, ..Settings::new(0.3, 0.01) }
}

/// A frame of all lines without walls.
fn run(gpu: &Gpu, lines: &LineSet, view: &View, settings: Settings) -> Renderer {
    let on_device = GpuLines::new(gpu, lines, settings.margin()).unwrap();
    let mut renderer = Renderer::new(gpu, COLOUR, settings).unwrap();
    let seen = Seen::all(on_device.bundles().len());
    renderer.update(gpu, view, (&on_device, &seen), &[], &mut Clock::off()).unwrap();
    renderer
}

fn run_on(gpu: &Gpu, view: &View, lines: (&GpuLines, &Seen)) -> Result<(), LinesGpuError> {
    let mut renderer = Renderer::new(gpu, COLOUR, settings(AoOptions::new(0.3, 0.01)))?;
    renderer.update(gpu, view, lines, &[], &mut Clock::off())
}

/// Whether a segment enters a cell of a column: exact clipping in homogeneous coordinates, in
/// double precision. The cell is larger on each side by a part of a pixel and of a slice.
fn enters(view: &View, [a, b]: [DVec3; 2], [x, y]: [u32; 2], slice: u32, slices: u32, larger: f64) -> bool {
    let [near, far] = view.depths();
    let thick = (far - near) / f64::from(slices);
    let cell = |i: u32| (f64::from(i) - larger, f64::from(i) + 1.0 + larger);
    let ((left, right), (top, bottom), (first, last)) = (cell(x), cell(y), cell(slice));
    let depths = (near + thick * first, near + thick * last);
    let sides = |p: DVec3| {
        let q = view.project(p);
        let (x, y) = ((q.x - left * q.z, right * q.z - q.x), (q.y - top * q.z, bottom * q.z - q.y));
        [x.0, x.1, y.0, y.1, -p.z - depths.0, depths.1 + p.z]
    };
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for (at_a, at_b) in sides(a).into_iter().zip(sides(b)) {
        if at_a < 0.0 && at_b < 0.0 {
            return false;
        }
        let crossing = at_a / (at_a - at_b);
        if at_a < 0.0 {
            from = from.max(crossing);
        } else if at_b < 0.0 {
            to = to.min(crossing);
        }
    }
    from <= to
}

#[test]
fn columns_hold_the_slices_that_lines_enter_and_differ_from_the_processors_only_where_rounding_decides() {
    let Some(gpu) = gpu() else { return };
    let (mut differing, mut all) = (0, 0);
    let sets = [wild(1), wild(2), set(Family::Abc, 60), set(Family::PomPom, 150), set(Family::Parallel, 200)];
    for (number, lines) in sets.iter().enumerate() {
        // The last view is from as far away as the renderer takes.
        let from_afar =
            View::around([-Vec3::ONE, Vec3::ONE], vec3(0.3, 0.4, 1.0), Some(0.0335), SIZE).unwrap();
        for view in views([-Vec3::ONE, Vec3::ONE]).into_iter().chain([from_afar]) {
            let slices = if number % 2 == 0 { Slices::S128 } else { Slices::S256 };
            let with = Settings { slices, ..settings(AoOptions::new(0.3, 0.01)) };
            let renderer = run(&gpu, lines, &view, with);
            let words = renderer.read_columns(&gpu).unwrap();
            let grid = SlabGrid::of_lines(lines, &view, slices, SpanRule::Span);
            let points: Vec<DVec3> = lines.points().iter().map(|&p| view.to_eye(p)).collect();
            let segments: Vec<[DVec3; 2]> =
                lines.segments().map(|s| [points[s.a as usize], points[s.b as usize]]).collect();
            let count = slices.count();
            for (column, words) in words.chunks(count as usize / 32).enumerate() {
                let at = [column as u32 % SIZE[0], column as u32 / SIZE[0]];
                let expected = grid.column(at[0], at[1]);
                for slice in 0..count {
                    let found = words[slice as usize / 32] >> (slice % 32) & 1 == 1;
                    let on_processor = expected[slice as usize / 128] >> (slice % 128) & 1 == 1;
                    all += usize::from(found);
                    if found != on_processor {
                        differing += 1;
                        let larger = f64::from(IN_DOUBT) * if found { 1.0 } else { -1.0 };
                        let entered = segments.iter().any(|&s| enters(&view, s, at, slice, count, larger));
                        assert_eq!(entered, found, "set {number}, column {at:?}, slice {slice}: {view:?}");
                    }
                }
            }
            let lengths = renderer.read_lengths(&gpu).unwrap();
            let groups = slices.groups();
            let (mut off, mut sum) = (0.0, 0.0);
            for (column, found) in lengths.chunks(groups).enumerate() {
                let expected = grid.lengths(column as u32 % SIZE[0], column as u32 / SIZE[0]);
                for (found, expected) in found.iter().zip(expected) {
                    off += (found - f64::from(*expected)).abs();
                    sum += found;
                }
            }
            assert!(sum > 1.0 && off < sum * 1e-4, "set {number}: {off} of {sum}");
        }
    }
    assert!(all > 50_000 && differing * 2000 < all, "{differing} of {all} bits differ");
}

#[test]
fn lines_on_borders_of_tiles_are_in_the_columns_of_the_processor() {
    let Some(gpu) = gpu() else { return };
    let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, None, SIZE).unwrap();
    let lines = LineSet::new([[vec3(-0.5, 0.0, 0.01), vec3(0.5, 0.0, 0.01)]]).unwrap();
    let renderer = run(&gpu, &lines, &view, settings(AoOptions::new(0.3, 0.01)));
    let grid = SlabGrid::of_lines(&lines, &view, Slices::S128, SpanRule::Span);
    let pixels = || (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| [x, y]));
    let words = pixels().flat_map(|[x, y]| (0..4).map(move |i| (x, y, i)));
    let expected: Vec<u32> = words.map(|(x, y, i)| (grid.column(x, y)[0] >> (32 * i)) as u32).collect();
    assert!(renderer.read_columns(&gpu).unwrap() == expected);
    let sum: f64 = renderer.read_lengths(&gpu).unwrap().iter().sum();
    assert!((sum - 1.0).abs() < 1e-5, "{sum}");
    let shown: Vec<bool> = renderer.read_fragments(&gpu).unwrap().iter().map(Option::is_some).collect();
    let buffer = LineBuffer::new(&lines, &view);
    assert!(shown.iter().eq(buffer.fragments().iter().map(Option::is_some).collect::<Vec<_>>().iter()));
}

#[test]
fn the_unit_of_length_changes_nothing() {
    let Some(gpu) = gpu() else { return };
    for lines in [wild(1), set(Family::PomPom, 150)] {
        // Powers of 2 scale without rounding, but their squares do not fit into single precision.
        let in_unit = |unit: f32| {
            let points = |line: &[Vec3]| line.iter().map(|&p| p * unit).collect::<Vec<_>>();
            let scaled = LineSet::new(lines.iter().map(points)).unwrap();
            views([Vec3::splat(-unit), Vec3::splat(unit)]).map(|view| {
                let renderer = run(&gpu, &scaled, &view, settings(AoOptions::new(0.3 * unit, 0.02 * unit)));
                let rays = run(&gpu, &scaled, &view, settings(AoOptions::rays(0.3 * unit, 0.02 * unit)));
                let lengths = renderer.read_lengths(&gpu).unwrap();
                (
                    renderer.read_columns(&gpu).unwrap(),
                    lengths.into_iter().map(|l| l / f64::from(unit)).collect::<Vec<f64>>(),
                    [renderer, rays].map(|r| r.read_occlusion(&gpu).unwrap()),
                )
            })
        };
        let expected = in_unit(1.0);
        for unit in [2f32.powi(-80), 2f32.powi(80)] {
            for (found, expected) in in_unit(unit).into_iter().zip(&expected) {
                assert!(found.0 == expected.0, "columns in units of {unit}");
                assert!(found.1 == expected.1, "lengths in units of {unit}");
                assert!(found.2 == expected.2, "occlusion in units of {unit}");
                assert!(found.2.iter().all(|o| o.iter().sum::<f32>() > 10.0));
            }
        }
    }
}

#[test]
fn nearest_lines_are_those_of_the_processor() {
    let Some(gpu) = gpu() else { return };
    let (mut covered, mut others) = (0, 0);
    for lines in [wild(3), set(Family::Spiral, 80), set(Family::Reservoir, 100)] {
        for view in views([-Vec3::ONE, Vec3::ONE]) {
            let renderer = run(&gpu, &lines, &view, settings(AoOptions::new(0.3, 0.01)));
            let found = renderer.read_fragments(&gpu).unwrap();
            let buffer = LineBuffer::new(&lines, &view);
            for (found, expected) in found.iter().zip(buffer.fragments()) {
                covered += usize::from(expected.is_some());
                let is_same = match (found, expected) {
                    (None, None) => true,
                    (Some(a), Some(b)) if a.line == b.line => {
                        let off = a.position.distance(b.position).max(a.tangent.distance(b.tangent) * 0.1);
                        off < 1e-3 && (a.along - b.along).abs() < 1e-3
                    }
                    _ => false,
                };
                others += usize::from(!is_same);
            }
        }
    }
    assert!(covered > 2000 && others * 500 < covered, "{others} of {covered} fragments differ");
}

#[test]
fn the_occlusion_is_that_of_the_processor_for_all_estimators_and_choices() {
    let Some(gpu) = gpu() else { return };
    let base = AoOptions::new(0.3, 0.02);
    let options = [
        base,
        AoOptions { choice: SetChoice::One, ..AoOptions::new(0.8, 0.05) },
        AoOptions::thesis(0.3),
        AoOptions { plane: BasePlane::ThesisSign, by_distance: false, ..AoOptions::thesis(0.2) },
        AoOptions { estimator: Estimator::RatioOfSums { factor: 3.0 }, by_angle: false, ..base },
        AoOptions { estimator: Estimator::Extinction { k: 9.0 }, choice: SetChoice::Screen, ..base },
        AoOptions::rays(0.3, 0.02),
        AoOptions { choice: SetChoice::One, ..AoOptions::rays(0.8, 0.005) },
    ];
    for (number, ao) in options.into_iter().enumerate() {
        let lines = set(Family::ALL[number % 5], 250);
        for view in views(lines.bounds()) {
            let settings = settings(ao);
            let renderer = run(&gpu, &lines, &view, settings);
            let found = renderer.read_occlusion(&gpu).unwrap();
            // The same receivers: others are the matter of another test.
            let receivers = renderer.read_fragments(&gpu).unwrap();
            let grid = SlabGrid::of_lines(&lines, &view, settings.slices, SpanRule::Span);
            let cells = Cells::new(&lines, settings.margin());
            let make = if settings.by_rays() { SampleSets::spirals } else { SampleSets::new };
            let samples = make(settings.samples, settings.sets, settings.seed).unwrap();
            let occlusion = match settings.by_rays() {
                true => Occlusion::by_rays(&cells, &view, &samples, ao).unwrap(),
                false => Occlusion::new(&grid, &samples, ao).unwrap(),
            };
            let (mut off, mut far_off, mut covered, mut sum) = (0.0, 0, 0, 0.0);
            for (pixel, (found, fragment)) in found.iter().zip(&receivers).enumerate() {
                let at = [pixel as u32 % SIZE[0], pixel as u32 / SIZE[0]];
                let expected = fragment.as_ref().map_or(0.0, |f| occlusion.at(f, occlusion.set_of(f, at)));
                covered += usize::from(fragment.is_some());
                sum += expected;
                off += (found - expected).abs();
                far_off += usize::from((found - expected).abs() > OCCLUSION_OFF);
            }
            let mean = off / covered as f32;
            assert!(sum / covered as f32 > 0.05, "{number}: {sum} over {covered} pixels");
            assert!(
                covered > 300 && far_off * 50 <= covered && mean < OCCLUSION_OFF / 4.0,
                "{number}, {view:?}: {far_off} of {covered} pixels are off, by {mean} on average"
            );
        }
    }
}

#[test]
fn pictures_with_and_without_culling_are_the_same_in_every_pixel() {
    let Some(gpu) = gpu() else { return };
    let house = House::new(4, 120, 5, 0.0).unwrap();
    let lines = GpuLines::new(&gpu, &house.lines, 0.04).unwrap();
    let mut culling = Culling::new(lines.bundles(), &house.walls).unwrap();
    let canvas = Canvas::new(&gpu, (160, 120));
    let everything = Seen::all(lines.bundles().len());
    let thesis = Settings { slices: Slices::S128, coarse: 1, ..settings(AoOptions::thesis(0.3)) };
    let (mut drawn, mut read, mut dark) = (0, 0, 0.0);
    for (frame, with) in [Settings::new(0.35, 0.01), thesis].into_iter().cycle().take(8).enumerate() {
        let mut renderer = Renderer::new(&gpu, COLOUR, Settings { samples: 30, ..with }).unwrap();
        let [eye, target] = house.eye(frame as u32 * 2);
        let (lens, depths) = match frame {
            // Parallel rays that look down over the walls.
            7 => (Lens::Orthographic { half_height: 2.0 }, [-1.0, 6.0]),
            _ => (Lens::Perspective { fov_y: 1.1 }, [0.05, 15.0]),
        };
        let view = View::look_at([eye, target, Vec3::Y], lens, depths, [160, 120]).unwrap();
        let seen = culling.look(&view, renderer.settings().reach(&view).unwrap()).unwrap();
        let mut shot = |seen: &Seen| {
            renderer.update(&gpu, &view, (&lines, seen), &house.walls, &mut Clock::off()).unwrap();
            renderer
                .paint(&gpu, &canvas.picture(), Look::Occluded, 1.0, Vec3::ONE, &mut Clock::off())
                .unwrap();
            (canvas.read_picture(&gpu).unwrap(), renderer.read_occlusion(&gpu).unwrap())
        };
        let (all, culled) = (shot(&everything), shot(&seen));
        let differing = all.0.iter().zip(&culled.0).filter(|(a, b)| a != b).count();
        assert_eq!(differing, 0, "frame {frame}: {} of {} bundles", seen.read.len(), everything.read.len());
        assert!(all.1 == culled.1, "frame {frame}");
        dark += all.1.iter().sum::<f32>();
        drawn += seen.drawn.len();
        read += seen.read.len();
    }
    let total = 8 * lines.bundles().len();
    assert!(
        drawn * 2 < total && drawn < read && read < total && dark > 500.0,
        "{drawn} {read} {total} {dark}"
    );
}

#[test]
fn hidden_bundles_that_darken_visible_lines_are_read_and_without_the_reach_pixels_would_differ() {
    let Some(gpu) = gpu() else { return };
    // A wall before the left part of a set: beside its edge, visible lines are darkened by hidden
    // ones.
    let walls = [[vec3(-3.0, -3.0, 0.59), vec3(0.4, 3.0, 0.61)]];
    let cube = Recipe { lines: 1000, vertices: 100, ..Recipe::new(Family::Abc, 3) }.make().unwrap();
    let lines = GpuLines::new(&gpu, &cube, 0.04).unwrap();
    let mut culling = Culling::new(lines.bundles(), &walls).unwrap();
    for view in
        [None, Some(0.5)].map(|fov| View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, fov, SIZE).unwrap())
    {
        let with = Settings { samples: 40, sets: 4, coarse: 1, ..Settings::of_columns(0.15, 0.02) };
        let mut renderer = Renderer::new(&gpu, COLOUR, with).unwrap();
        let mut values = |seen: &Seen| {
            renderer.update(&gpu, &view, (&lines, seen), &walls, &mut Clock::off()).unwrap();
            (renderer.read_occlusion(&gpu).unwrap(), renderer.read_fragments(&gpu).unwrap())
        };
        let reach = with.reach(&view).unwrap();
        let seen = culling.look(&view, reach).unwrap();
        let short = culling.look(&view, Reach { read: reach.drawn, ..reach }).unwrap();
        let counts = [short.read.len(), seen.read.len(), lines.bundles().len()];
        assert!(counts.is_sorted_by(|a, b| a < b), "{counts:?}");
        let all = values(&Seen::all(lines.bundles().len()));
        assert!(all == values(&seen), "{} of {} bundles", seen.read.len(), lines.bundles().len());
        let (darkness, shown) = values(&short);
        assert!(shown == all.1 && darkness != all.0);
    }
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn views_of_scenes_hold_just_the_points_of_the_picture(
        p in [-2.0f32..2.0, -2.0f32..2.0, -2.0f32..2.0], from in [-1.0f32..1.0, -1.0f32..1.0, 0.1f32..1.0], perspective: bool
    ) {
        let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::from(from), perspective.then_some(0.7), [48, 33]).unwrap();
        let eye = view.to_eye(Vec3::from(p));
        let (place, [near, far]) = (view.project(eye), view.depths());
        // How far inside of each side, as a share of the view; negative outside.
        let inside = [place.x / place.z / 48.0, place.y / place.z / 33.0, (-eye.z - near) / (far - near)];
        let inside = inside.map(|share| share.min(1.0 - share)).into_iter().fold(f64::MAX, f64::min);
        prop_assume!(inside.abs() > 1e-4);
        let scene = casca::Scene::new(&casca::GridSpec { min: Vec3::splat(-4.0), cell: 1.0, dims: glam::UVec3::splat(8) }).unwrap();
        let mut query = casca::Query::new();
        query.run(&scene, &view_of_scene(&view).unwrap());
        let sight = query.sight(&scene).unwrap();
        prop_assert_eq!(sight.may_see_point(Vec3::from(p)), inside > 0.0, "{:?} {}", view, inside);
    }
}

#[test]
fn lines_before_walls_are_shown_those_behind_are_not_and_moved_ones_are_followed() {
    let Some(gpu) = gpu() else { return };
    let at = |z: f32| LineSet::new([[vec3(-0.5, 0.02, z), vec3(0.5, 0.02, z)]]).unwrap();
    let wall = [[vec3(-2.0, -2.0, -0.1), vec3(2.0, 2.0, 0.1)]];
    for fov in [None, Some(0.8)] {
        let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, fov, SIZE).unwrap();
        let mut renderer = Renderer::new(&gpu, COLOUR, settings(AoOptions::new(0.3, 0.01))).unwrap();
        let mut lines = GpuLines::new(&gpu, &at(0.5), 0.04).unwrap();
        let mut culling = Culling::new(lines.bundles(), &wall).unwrap();
        for z in [0.5, -0.9, 0.6] {
            lines = GpuLines::new(&gpu, &at(z), 0.04).unwrap();
            culling.follow(lines.bundles()).unwrap();
            // Without the reach of the occlusion, so that the line behind the wall is culled.
            let seen = culling.look(&view, Reach { drawn: 0.01, read: 0.01 }).unwrap();
            assert_eq!(seen.drawn.len(), usize::from(z > 0.0), "{z}");
            for seen in [&seen, &Seen::all(1)] {
                renderer.update(&gpu, &view, (&lines, seen), &wall, &mut Clock::off()).unwrap();
                let shown = renderer.read_fragments(&gpu).unwrap().iter().flatten().count();
                assert_eq!(shown > 10, z > 0.0, "{z}: {shown}");
            }
        }
        culling.follow(&[]).unwrap();
        assert_eq!(culling.look(&view, Reach { drawn: 0.0, read: 0.0 }).unwrap(), Seen::default());
        drop(lines);
    }
}

#[test]
fn empty_sets_give_empty_pictures_and_bad_values_are_named() {
    let Some(gpu) = gpu() else { return };
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
    let lines = GpuLines::new(&gpu, &set(Family::Spiral, 5), 0.04).unwrap();
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
    assert!(matches!(Culling::new(lines.bundles(), &nan), Err(LinesGpuError::Scene(_))));
    assert!(matches!(LinesGpuError::from(GpuError::NoAdapter("x".into())), LinesGpuError::Gpu(_)));
}
