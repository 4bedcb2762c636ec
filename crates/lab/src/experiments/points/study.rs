//! The state that the experiments share.

use bitvec::vec::BitVec;
use casca_points::cluster::{Clustering, Passes, Radius as ClusterRadius, visible_clusters};
use casca_points::hpr::{Kernel, visible_points};
use casca_points::splat::{Bias, SplatOptions};

use super::cloud::Cloud;
use super::hare::hare;
use super::judge::Confusion;
use crate::experiments::{Lab, LabError, Section, Table};

/// The tolerance of splats in spacings: near the best for the hare.
pub(super) const TOLERANCE: f32 = 3.0;

/// The same in automatic radii, for clouds whose spacing is not known.
pub(super) const RADII: f32 = 3.5;

/// The usual size of pictures.
pub(super) const SIZE: (u32, u32) = (640, 480);

/// The tolerance of the thesis.
pub(super) const THESIS_BIAS: Bias = Bias::Window(0.05);

/// The lab, its clouds and the section that is written.
pub(super) struct Study<'a> {
    pub lab: &'a Lab<'a>,
    pub clouds: Vec<Cloud>,
    pub section: Section,
    targets: Table,
}

impl<'a> Study<'a> {
    pub fn new(lab: &'a Lab<'a>) -> Result<Self, LabError> {
        let clouds = clouds(lab)?;
        let mut section = Section::new("Points");
        let mut table = Table::new("points-clouds", &["cloud", "points", "truly visible", "truth"]);
        for (i, cloud) in clouds.iter().enumerate() {
            let truth = if (2..5).contains(&i) { "formula" } else { "rays at the triangles" };
            let counts = [cloud.points.len(), cloud.truth.count_ones()].map(|n| n.to_string());
            table.row([cloud.name.clone()].into_iter().chain(counts).chain([truth.to_owned()]));
        }
        section.text(
            "### Clouds\n\nThe hare is a mesh of this project, with ears, legs and hollows. The points of *hare* are its vertices, as in the thesis: a vertex at the limb \
             is visible if any of its triangles faces the eye. Those of *hare, sampled* are places in its triangles that keep a distance from each other; there a point \
             just beyond the limb is hidden, though no operator can know it. So are the points of the other meshes. Scenes from files are seen from inside.",
        );
        section.table(table);
        let targets = Table::new("points-targets", &["figure", "measured", "target", "met"]);
        Ok(Self { lab, clouds, section, targets })
    }

    /// The cloud that most experiments are about.
    pub fn hare(&self) -> &Cloud {
        &self.clouds[0]
    }

    /// Notes a figure that should be at most a bound.
    pub fn target(&mut self, figure: &str, measured: f64, most: f64, unit: &str) {
        let met = if measured <= most { "yes" } else { "no" };
        let row = [
            figure.to_owned(),
            format!("{measured:.2}{unit}"),
            format!("at most {most:.2}{unit}"),
            met.to_owned(),
        ];
        self.targets.row(row);
    }

    /// The section, with the targets at its end.
    pub fn finish(mut self) -> Section {
        self.section.text("### Targets");
        self.section.table(self.targets);
        self.section
    }
}

/// The clouds: the hare, shapes with formulas, and the lab's files.
fn clouds(lab: &Lab) -> Result<Vec<Cloud>, LabError> {
    let count = lab.pick(20_000, 2000);
    let vertices = Cloud::hare(lab.pick(30_000, 3000));
    let mesh = hare(lab.pick(110, 40));
    let sampled = Cloud::of_mesh("hare, sampled", mesh, vertices.points.len(), lab.seed, vertices.look)?;
    let mut clouds = vec![
        vertices,
        sampled,
        Cloud::sphere(count),
        Cloud::cube(count, lab.seed)?,
        Cloud::sheets(count, lab.seed)?,
    ];
    for file in &lab.files {
        (lab.progress)(&format!("rays at {}", file.display()));
        clouds.push(Cloud::of_file(file, lab.pick(200_000, 3000), lab.seed)?);
    }
    Ok(clouds)
}

/// Hidden point removal of a cloud.
pub(super) fn by_hull(cloud: &Cloud, kernel: Kernel) -> Result<BitVec, LabError> {
    Ok(visible_points(&cloud.places(), cloud.look.eye.as_dvec3(), kernel)?)
}

/// A way to remove hidden points by clusters.
#[derive(Debug, Clone, Copy)]
pub(super) struct ByClusters {
    pub clustering: Clustering,
    pub radius: ClusterRadius,
    pub passes: Passes,
}

impl ByClusters {
    /// The one of the thesis with the radius that suits clusters: leaves of an octree with at most
    /// 17 points, once.
    pub const OCTREE: Self = Self {
        clustering: Clustering::Octree { max_points: 17 },
        radius: ClusterRadius::Rescaled,
        passes: Passes::One,
    };
}

/// The same by clusters.
pub(super) fn by_clusters(cloud: &Cloud, kernel: Kernel, how: ByClusters) -> Result<BitVec, LabError> {
    let ByClusters { clustering, radius, passes } = how;
    Ok(visible_clusters(&cloud.places(), cloud.look.eye.as_dvec3(), kernel, clustering, radius, passes)?)
}

/// The splat operator.
pub(super) fn by_splats(cloud: &Cloud, size: (u32, u32), options: &SplatOptions) -> Result<BitVec, LabError> {
    Ok(casca_points::splat::visible_points(&cloud.points, &cloud.look.camera(size)?, options)?.visible)
}

/// The spherical kernel with a radius that is told by its logarithm.
pub(super) fn spherical(log10_radius: f64) -> Kernel {
    Kernel::Relative { log10_radius }
}

/// Errors by the value of a parameter.
pub(super) type Sweep = Vec<(f64, Confusion)>;

/// Measures each value.
pub(super) fn sweep(
    cloud: &Cloud,
    values: &[f64],
    mut answer: impl FnMut(f64) -> Result<BitVec, LabError>,
) -> Result<Sweep, LabError> {
    values.iter().map(|&value| Ok((value, Confusion::of(&cloud.truth, &answer(value)?)))).collect()
}

/// The value of the least error.
pub(super) fn best(sweep: &Sweep) -> (f64, Confusion) {
    let least = sweep.iter().min_by(|a, b| a.1.error().total_cmp(&b.1.error()));
    least.copied().unwrap_or_default()
}

/// Values from `first` in even steps to `last`.
pub(super) fn steps(first: f64, last: f64, step: f64) -> Vec<f64> {
    let count = ((last - first) / step).round() as usize;
    (0..=count).map(|i| first + i as f64 * step).collect()
}

/// The points of a line.
pub(super) fn line(sweep: &Sweep, value: impl Fn(&Confusion) -> f64) -> Vec<(f64, f64)> {
    sweep.iter().map(|(x, counts)| (*x, value(counts))).collect()
}
