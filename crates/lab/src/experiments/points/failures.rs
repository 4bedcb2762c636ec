//! Where operators fail: noise, changes of density, an eye among the points, tiny and huge radii.

use bitvec::vec::BitVec;
use casca_points::spacing::automatic_radius;
use casca_points::splat::{Bias, Filter, Radius, SplatOptions};
use glam::Vec3;

use super::cloud::{Cloud, Look, MIDDLE};
use super::judge::{COLUMNS, Confusion};
use super::splat::thinned;
use super::study::{ByClusters, RADII, SIZE, Study, by_clusters, by_hull, by_splats, spherical};
use crate::experiments::{LabError, Table};
use crate::pictures::{CloudPanel, CloudView, Fate, cloud as draw};
use casca_scenes::world::Camera;

/// A cloud under stress.
struct Case {
    file: &'static str,
    name: &'static str,
    title: &'static str,
    cloud: Cloud,
    radius: Changed,
}

/// How the radii differ from the usual ones.
#[derive(Clone, Copy)]
struct Changed {
    /// What is added to log10 R.
    log10: f64,
    /// The factor of the splats' radius.
    splats: f32,
}

/// The usual radii.
const SAME: Changed = Changed { log10: 0.0, splats: 1.0 };

fn cases(study: &Study) -> Result<Vec<Case>, LabError> {
    let (lab, calm) = (study.lab, study.hare());
    let inside = Look {
        eye: Vec3::new(-0.3, 0.8, 0.0),
        target: Vec3::new(0.9, 1.5, 0.0),
        fov: 100.0,
        depths: (0.02, 10.0),
    };
    let among = Cloud::hare_from(calm.points.len(), inside);
    let case = |file, name, title, cloud, radius| Case { file, name, title, cloud, radius };
    Ok(vec![
        case("calm", "none", "Without stress", calm.clone(), SAME),
        case(
            "noise",
            "noise of 0.3% of the diagonal",
            "Noise of 0.3% of the diagonal",
            calm.noisy(3e-3, lab.seed),
            SAME,
        ),
        case(
            "density",
            "one half thinned to a tenth of its points",
            "One half thinned to a tenth",
            calm.filtered(lab.seed, thinned),
            SAME,
        ),
        case("inside", "the eye inside the body", "The eye inside the body", among, SAME),
        case(
            "tiny",
            "tiny radius: 10^-2.5 of the best for HPR, a fifth for splats",
            "Tiny radius (HPR: 1/300 of the best, splats: a fifth)",
            calm.clone(),
            Changed { log10: -2.5, splats: 0.2 },
        ),
        case(
            "huge",
            "huge radius: 10^2 of the best for HPR, ten times for splats",
            "Huge radius (HPR: 100 times the best, splats: 10 times)",
            calm.clone(),
            Changed { log10: 2.0, splats: 10.0 },
        ),
    ])
}

/// The names of the operators in the table.
const OPERATORS: [&str; 3] = ["HPR", "clusters (octree 17, rescaled)", "splats (automatic radius, max)"];

fn answers(case: &Case, log: f64) -> Result<[BitVec; 3], LabError> {
    let cloud = &case.cloud;
    let kernel = spherical((log + case.radius.log10).max(0.0));
    let size = automatic_radius(&cloud.points)?;
    let splats = SplatOptions {
        radius: Radius::Same(size * case.radius.splats),
        bias: Bias::World(RADII * size),
        filter: Filter::Max,
        slopes: false,
    };
    Ok([
        by_hull(cloud, kernel)?,
        by_clusters(cloud, kernel, ByClusters::OCTREE)?,
        by_splats(cloud, SIZE, &splats)?,
    ])
}

/// One table, and one picture for each case.
pub(super) fn failures(study: &mut Study, radius: f64) -> Result<(), LabError> {
    let heads: Vec<&str> = ["stress", "operator"].into_iter().chain(COLUMNS).collect();
    let mut table = Table::new("points-failures", &heads);
    let mut pictures = Vec::new();
    for case in cases(study)? {
        (study.lab.progress)(&format!("failures: {}", case.name));
        let cloud = &case.cloud;
        // Splats are judged by the points in the picture.
        let camera = cloud.look.camera(SIZE)?;
        let in_view: BitVec = cloud.points.iter().map(|&p| camera.project(p).is_some()).collect();
        let (mut panels, mut errors) = (Vec::new(), Vec::new());
        for (i, (name, found)) in OPERATORS.into_iter().zip(answers(&case, radius)?).enumerate() {
            let truth = if i == 2 { cloud.truth.clone() & &in_view } else { cloud.truth.clone() };
            let counts = Confusion::of(&truth, &found);
            table.row([case.name.to_owned(), name.to_owned()].into_iter().chain(counts.cells()));
            let fates =
                truth.iter().by_vals().zip(found.iter().by_vals()).map(|(t, f)| Fate::of(t, f)).collect();
            let short = name.split(" (").next().unwrap_or(name);
            let caption = format!(
                "{short}: {} false visible, {} false hidden",
                counts.false_visible, counts.false_hidden
            );
            panels.push(CloudPanel { caption, fates });
            errors.push(format!("{:.0}% for {short}", counts.error()));
        }
        let file = format!("points-failure-{}.png", case.file);
        let title = format!("{}: E is {}", case.title, errors.join(", "));
        // From the side, so that both halves show: the one that the eye sees and the other.
        let camera = Camera::look_at(MIDDLE + Vec3::new(5.2, 1.4, -3.6), MIDDLE, 34.0, 1.0, 0.1, 50.0);
        let view =
            CloudView { points: &cloud.points, size: cloud.spacing * 1.15, eye: cloud.look.eye, camera };
        let subtitle = format!(
            "{} points of a hare, {} of them visible from the eye; looked at from the side.",
            cloud.points.len(),
            cloud.truth.count_ones()
        );
        draw(&study.lab.folder.join(&file), &title, &subtitle, &view, &panels)?;
        pictures.push((file, title));
    }
    study.section.text(format!(
        "### Where operators fail\n\nThe hare under stress: log10 R = {radius:.2}, splats with the automatic radius, the max filter and a tolerance of {RADII} automatic radii, \
         640x480. Splats answer for the picture only, so points beside it count as hidden for them. E can exceed 100%: there may be more false visible points than visible ones."
    ));
    study.section.table(table);
    for (file, title) in pictures {
        study.section.picture(&file, &title);
    }
    Ok(())
}
