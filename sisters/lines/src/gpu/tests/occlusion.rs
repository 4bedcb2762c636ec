//! The occlusion beside the processor's.

use super::*;
use crate::cells::Cells;
use crate::gpu::numeric::OCCLUSION_OFF;
use crate::occlusion::{Occlusion, Sides};
use crate::samples::SampleSets;
use crate::testing::moved;

#[test]
fn the_unit_of_length_changes_nothing() {
    let Some(gpu) = Gpu::for_tests() else { return };
    for lines in [wild(1), set(Family::PomPom, 150)] {
        // Powers of 2 scale without rounding, but their squares do not fit into single precision.
        let in_unit = |unit: f32| {
            let scaled = moved(&lines, |p| p * unit);
            views([Vec3::splat(-unit), Vec3::splat(unit)]).map(|view| {
                let rays = run(&gpu, &scaled, &view, settings(AoOptions::rays(0.3 * unit, 0.02 * unit)));
                rays.read_occlusion(&gpu).unwrap()
            })
        };
        let expected = in_unit(1.0);
        assert!(expected.iter().all(|o| o.iter().sum::<f32>() > 10.0));
        for unit in [2f32.powi(-80), 2f32.powi(80)] {
            assert!(in_unit(unit) == expected, "in units of {unit}");
        }
    }
}

#[test]
fn the_occlusion_is_that_of_the_processor() {
    let Some(gpu) = Gpu::for_tests() else { return };
    for (number, family) in Family::ALL.into_iter().enumerate() {
        let [radius, tube] = [[0.3, 0.02], [0.8, 0.005]][number % 2];
        let lines = set(family, 250);
        for (turn, view) in views(lines.bounds()).into_iter().enumerate() {
            let by_places = (number / 2 + turn) % 2 == 0;
            let make = if by_places { AoOptions::places } else { AoOptions::rays };
            let solid = number >= 3;
            let settings = settings(AoOptions { solid, ..make(radius, tube) });
            let renderer = run(&gpu, &lines, &view, settings);
            let found = renderer.read_occlusion(&gpu).unwrap();
            // The same receivers: others are the matter of another test.
            let receivers = renderer.read_fragments(&gpu).unwrap();
            let cells = Cells::new(&lines, settings.ao.margin());
            let samples = SampleSets::spirals(settings.samples, settings.sets).unwrap();
            let sides = by_places.then(|| Sides::new(&lines, &cells, &samples, settings.ao).unwrap());
            let occlusion = match &sides {
                Some(sides) => Occlusion::by_places(sides, &view),
                None => Occlusion::by_rays(&cells, &view, &samples, settings.ao).unwrap(),
            };
            let (mut off, mut far_off, mut covered, mut sum) = (0.0, 0, 0, 0.0);
            for (found, fragment) in found.iter().zip(&receivers) {
                let Some(fragment) = fragment else { continue };
                let expected = occlusion.at(fragment);
                covered += 1;
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
