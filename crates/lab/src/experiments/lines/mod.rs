//! Ambient occlusion of lines by columns (`casca-lines`) against rays: agreement, noise, times,
//! stability.

mod agreement;
mod case;
mod clock;
mod cost;
mod parallel;
mod samples;
mod score;
mod stability;
mod truth;

use casca_lines::sets::generate::Family;

use super::{Lab, LabError, Section};
use case::{Case, Sampling};

/// The title and introduction of the page.
pub const HEAD: &str = "# Ambient occlusion of lines by columns\n\n\
    How near the occlusion that `casca-lines` estimates from a grid of bits along the view (`Estimator::Columns`) comes to that of rays at \
    capsules around the lines, and in which time, on one thread of the processor. The source is Benevides, PUC-Rio 2015. Occlusion is from 0 to 1; \
    errors are those of visible pixels.\n\n\
    Columns are not the default: rays through a grid of the lines, and places that keep their values, come nearer and change less. Their accuracy \
    and cost, and lines that hide lines, are in [the README of the crate](../../sisters/lines/README.md).\n";

/// The later experiments take every third of the receivers: they compare estimates with each other,
/// many times.
const THIN: usize = 3;

/// All comparisons, as a section.
///
/// # Errors
/// If the library refuses a value, or a chart cannot be written.
pub fn lines(lab: &Lab) -> Result<Section, LabError> {
    let sampling = Sampling {
        canvas: lab.pick(512, 96),
        receivers: lab.pick(3000, 150),
        rays: lab.pick(20, 4),
        seconds: lab.pick(0.6, 0.0),
        seed: lab.seed,
    };
    let mut section = Section::new("Ambient occlusion of lines by columns");
    let (mut rows, mut kept) = (Vec::new(), Vec::new());
    for family in agreement::FAMILIES {
        (lab.progress)(family.name());
        let case = Case::new(family, &sampling)?;
        rows.extend(agreement::compare(family, &case, &sampling)?);
        if [Family::Spiral, Family::Parallel].contains(&family) {
            kept.push(case.thinned(THIN));
        }
    }
    section.text(agreement::finding(&rows, &sampling));
    section.table(agreement::table(&rows));
    if let [spiral, parallel] = &kept[..] {
        (lab.progress)("rows of the grid");
        parallel::by_rows(lab, [parallel, spiral], &sampling, &mut section)?;
        (lab.progress)("samples");
        samples::by_samples(lab, spiral, &sampling, &mut section)?;
        (lab.progress)("stability");
        stability::stability(lab, spiral, &sampling, &mut section)?;
    }
    cost::costs(lab, &sampling, &mut section)?;
    Ok(section)
}

#[cfg(test)]
mod tests {
    use casca_lines::slabs::Slices;

    use super::agreement::compare;
    use super::case::Way;
    use super::score::Score;
    use super::*;

    #[test]
    fn the_optical_depth_is_near_to_rays_and_nearer_than_the_thesis() {
        let sampling = Sampling { canvas: 160, receivers: 300, rays: 12, seconds: 0.0, seed: 2 };
        let case = Case::new(Family::PomPom, &sampling).unwrap();
        let rows = compare(Family::PomPom, &case, &sampling).unwrap();
        let of = |way: Way| rows.iter().filter(move |r| r.way == way.name());
        let thesis = of(Way::MeanOfRatios).next().unwrap();
        // Each grid that the optical depth reads, not the best of all rows.
        assert_eq!(of(Way::OpticalDepth).count(), 4);
        for row in of(Way::OpticalDepth).filter(|r| r.grid.0 == sampling.canvas) {
            assert!(row.score.pearson > 0.85 && row.score.rmse < 0.12, "{row:?}");
            assert!(row.score.rmse < thesis.score.rmse, "{row:?} {thesis:?}");
        }
    }

    #[test]
    fn lines_along_the_view_fail_in_columns_of_a_pixel_and_are_mended_by_wide_ones() {
        let sampling = Sampling { canvas: 160, receivers: 300, rays: 12, seconds: 0.0, seed: 2 };
        let case = Case::new(Family::Parallel, &sampling).unwrap();
        let samples = Case::samples(case::SAMPLES, 1).unwrap();
        let score = |way: Way, rows: u32| {
            let grid = case.grid(rows, Slices::S128).unwrap();
            let options = case.fitted(&grid, &samples, way).unwrap();
            let (values, _) = Case::estimate(&grid, &samples, options, &case.receivers, 0.0).unwrap();
            Score::of(&values, &case.truth)
        };
        let (fails, mended) = (score(Way::MeanOfRatios, 160), score(Way::OpticalDepth, 20));
        assert!(fails.pearson < 0.5 && mended.pearson > 0.7, "{fails:?} {mended:?}");
        assert!(mended.rmse < 0.7 * fails.rmse, "{fails:?} {mended:?}");
    }
}
