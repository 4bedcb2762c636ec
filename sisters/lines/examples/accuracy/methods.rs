//! The methods that are compared, at the program's settings.

use std::time::Instant;

use casca_lines::buffers::{Fragment, LineBuffer};
use casca_lines::cells::Cells;
use casca_lines::glam::Vec3;
use casca_lines::numeric::{USUAL_RAYS, USUAL_SIDE_RAYS};
use casca_lines::occlusion::{AoOptions, Occlusion, Sides};
use casca_lines::samples::SampleSets;
use casca_lines::slabs::{SlabGrid, Slices, SpanRule};
use casca_lines::view::View;

use crate::Case;

/// Sets of samples.
const SETS: u32 = 16;

/// What all methods are told, in units of the scene.
#[derive(Clone, Copy)]
pub struct Setting {
    pub radius: f32,
    pub tube: f32,
}

/// A method with its name.
pub struct Method {
    pub name: &'static str,
    way: Way,
}

#[derive(Clone, Copy)]
enum Way {
    /// No occlusion.
    Plain,
    /// A depth buffer alone.
    DepthBuffer,
    /// The thesis' own: columns of a pixel, 128 slices, 150 samples.
    Thesis,
    /// Optical depth of columns of 2 x 2 pixels, 256 slices, 150 samples.
    Columns,
    /// So many rays.
    Rays(u32),
    /// Rays from places along the lines.
    Places,
}

pub const METHODS: [Method; 8] = [
    Method { name: "plain lines", way: Way::Plain },
    Method { name: "depth buffer", way: Way::DepthBuffer },
    Method { name: "thesis", way: Way::Thesis },
    Method { name: "columns", way: Way::Columns },
    Method { name: "16 rays", way: Way::Rays(16) },
    Method { name: "24 rays (default)", way: Way::Rays(USUAL_RAYS) },
    Method { name: "64 rays", way: Way::Rays(64) },
    Method { name: "places", way: Way::Places },
];

/// A method after the work that it does before the first pixel.
pub enum Prepared<'a> {
    Plain,
    DepthBuffer(&'a Case, Box<LineBuffer>, SampleSets),
    Columns(SlabGrid, SampleSets, AoOptions),
    Rays(Box<Cells>, View, SampleSets, AoOptions),
    Places(&'a Case, Box<Cells>, View, SampleSets, AoOptions),
}

impl Method {
    pub fn prepared<'a>(&self, case: &'a Case, view: &View) -> Prepared<'a> {
        let Setting { radius, tube } = case.setting;
        let columns = |side, slices, options| {
            let grid =
                view.with_columns(side).map(|v| SlabGrid::of_lines(&case.lines, &v, slices, SpanRule::Span));
            Prepared::Columns(grid.expect("a grid"), SampleSets::new(150, SETS, 1).expect("sets"), options)
        };
        match self.way {
            Way::Plain => Prepared::Plain,
            Way::DepthBuffer => {
                let buffer =
                    if *view == case.view { case.buffer.clone() } else { LineBuffer::new(&case.lines, view) };
                Prepared::DepthBuffer(case, Box::new(buffer), SampleSets::spirals(32, SETS, 1).expect("sets"))
            }
            Way::Thesis => columns(1, Slices::S128, AoOptions::thesis(radius)),
            Way::Columns => columns(2, Slices::S256, AoOptions::new(radius, tube)),
            Way::Places => {
                let options = AoOptions::places(radius, tube);
                Prepared::Places(
                    case,
                    Box::new(Cells::new(&case.lines, options.margin())),
                    *view,
                    SampleSets::spirals(USUAL_SIDE_RAYS, SETS, 1).expect("sets"),
                    options,
                )
            }
            Way::Rays(rays) => {
                let options = AoOptions::rays(radius, tube);
                Prepared::Rays(
                    Box::new(Cells::new(&case.lines, options.margin())),
                    *view,
                    SampleSets::spirals(rays, SETS, 1).expect("sets"),
                    options,
                )
            }
        }
    }

    /// Milliseconds to prepare, and microseconds a pixel on one thread: the least of three.
    pub fn times(&self, case: &Case) -> (f64, f64) {
        let mut least = (f64::INFINITY, f64::INFINITY);
        for _ in 0..3 {
            let start = Instant::now();
            let prepared = self.prepared(case, &case.view);
            least.0 = least.0.min(start.elapsed().as_secs_f64() * 1e3);
            let start = Instant::now();
            let count = prepared.values(&case.block).len();
            least.1 = least.1.min(start.elapsed().as_secs_f64() * 1e6 / count as f64);
        }
        least
    }
}

impl Prepared<'_> {
    /// The occlusion at receivers.
    pub fn values(&self, receivers: &[([u32; 2], Fragment)]) -> Vec<f64> {
        let by = |occlusion: Occlusion<'_>| {
            let at =
                |(pixel, f): &([u32; 2], Fragment)| f64::from(occlusion.at(f, occlusion.set_of(f, *pixel)));
            receivers.iter().map(at).collect()
        };
        match self {
            Self::Plain => vec![0.0; receivers.len()],
            Self::DepthBuffer(case, buffer, samples) => {
                receivers.iter().map(|(pixel, f)| behind(case, buffer, samples, *pixel, f)).collect()
            }
            Self::Columns(grid, samples, options) => {
                by(Occlusion::new(grid, samples, *options).expect("options"))
            }
            Self::Places(case, cells, view, samples, options) => {
                let sides = Sides::new(&case.lines, cells, samples, *options).expect("options");
                by(Occlusion::by_places(&sides, view))
            }
            Self::Rays(cells, view, samples, options) => {
                by(Occlusion::by_rays(cells, view, samples, *options).expect("options"))
            }
        }
    }
}

/// The share of points in the hemisphere that lie behind the nearest line of their pixel, if that
/// is within the radius (Mittring 2007, "Finding next gen: CryEngine 2", with a hemisphere and a
/// check of the range). A depth buffer knows no more.
fn behind(case: &Case, buffer: &LineBuffer, samples: &SampleSets, pixel: [u32; 2], f: &Fragment) -> f64 {
    let view = buffer.view();
    let away = view.away(f.position);
    let pole = (f.tangent * f.tangent.dot(away) - away).normalize_or(-away);
    let (x, y) = pole.any_orthonormal_pair();
    let set = samples.set((pixel[0] * 7 + pixel[1] * 13) as usize);
    let (mut hidden, mut count) = (0.0, 0.0);
    for (i, sample) in set.iter().enumerate() {
        let way = x * sample.at.x + y * sample.at.y + pole * (1.0 - sample.at.length_squared()).sqrt();
        // Denser near the receiver.
        let share = ((i as f32 * 0.618_034).fract() * 0.95 + 0.05).powi(2);
        let place = f.position + way * (share * case.setting.radius);
        let Some([px, py]) = view.pixel(place) else { continue };
        count += 1.0;
        let nearest: Option<Vec3> =
            buffer.fragments()[(py * view.size()[0] + px) as usize].map(|n| n.position);
        let before = |n: Vec3| n.z > place.z && (n.z - f.position.z).abs() < case.setting.radius;
        hidden += if nearest.is_some_and(before) { 1.0 } else { 0.0 };
    }
    if count > 0.0 { hidden / count } else { 0.0 }
}
