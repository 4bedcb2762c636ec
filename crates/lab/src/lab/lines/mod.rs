//! Ambient occlusion of lines (`casca-lines`) against rays: agreement, noise, times, stability.

mod agreement;
mod case;
mod cost;
mod parallel;
mod samples;
mod score;
mod stability;
mod truth;

use casca_lines::sets::generate::Family;

use super::{Lab, LabError, Section};
use case::{Case, Effort};

/// The title and introduction of the page.
pub const HEAD: &str = "# Ambient occlusion of lines\n\n\
    How near the occlusion that `casca-lines` estimates from a grid of bits comes to that of rays at capsules around the lines, and in which \
    time. The source is Benevides, PUC-Rio 2015. Occlusion is from 0 to 1; errors are those of visible pixels.\n";

/// All comparisons, as a section.
///
/// # Errors
/// If the library refuses a value, or a chart cannot be written.
pub fn lines(lab: &Lab) -> Result<Section, LabError> {
    let effort = Effort {
        canvas: lab.pick(512, 96),
        receivers: lab.pick(3000, 150),
        rays: lab.pick(20, 4),
        repeats: lab.pick(5, 1),
        seed: lab.seed,
    };
    let mut section = Section::new("Ambient occlusion of lines");
    let (mut rows, mut spiral) = (Vec::new(), None);
    for family in agreement::FAMILIES {
        (lab.progress)(family.name());
        let case = Case::new(family, &effort)?;
        rows.extend(agreement::compare(family, &case, &effort)?);
        if family == Family::Spiral {
            spiral = Some(case);
        }
    }
    section.text(agreement::finding(&rows, &effort));
    section.table(agreement::table(&rows));
    if let Some(case) = spiral {
        (lab.progress)("samples");
        samples::by_samples(lab, &case, &effort, &mut section)?;
        (lab.progress)("stability");
        stability::stability(&case, &effort, &mut section)?;
    }
    cost::costs(lab, &effort, &mut section)?;
    Ok(section)
}

#[cfg(test)]
mod tests {
    use super::agreement::compare;
    use super::*;

    #[test]
    fn the_optical_depth_is_near_to_rays_and_nearer_than_the_thesis() {
        let effort = Effort { canvas: 160, receivers: 300, rays: 12, repeats: 1, seed: 2 };
        let case = Case::new(Family::PomPom, &effort).unwrap();
        let rows = compare(Family::PomPom, &case, &effort).unwrap();
        let best = rows.iter().min_by(|a, b| a.score.rmse.total_cmp(&b.score.rmse)).unwrap();
        let thesis = rows.iter().find(|r| r.way == "mean of ratios (thesis)").unwrap();
        assert!(best.score.pearson > 0.85 && best.score.rmse < 0.12, "{best:?}");
        assert!(best.score.rmse < thesis.score.rmse, "{best:?} {thesis:?}");
    }
}
