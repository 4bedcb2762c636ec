//! The occlusion of all estimators beside the processor's.

use super::*;
use crate::cells::Cells;
use crate::gpu::numeric::OCCLUSION_OFF;
use crate::occlusion::{BasePlane, Estimator, Occlusion, SetChoice, Sides};
use crate::samples::SampleSets;
use crate::slabs::{SlabGrid, SpanRule};

#[test]
fn the_unit_of_length_changes_nothing() {
    let Some(gpu) = Gpu::for_tests() else { return };
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
fn the_occlusion_is_that_of_the_processor_for_all_estimators_and_choices() {
    let Some(gpu) = Gpu::for_tests() else { return };
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
        AoOptions::places(0.3, 0.02),
        AoOptions::places(0.8, 0.005),
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
            let sides = settings.by_places().then(|| Sides::new(&lines, &cells, &samples, ao).unwrap());
            let occlusion = match (&sides, settings.by_rays()) {
                (Some(sides), _) => Occlusion::by_places(sides, &view),
                (None, true) => Occlusion::by_rays(&cells, &view, &samples, ao).unwrap(),
                (None, false) => Occlusion::new(&grid, &samples, ao).unwrap(),
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
