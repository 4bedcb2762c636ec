//! The occlusion in perspective beside rays: tubes around lines in the laboratory's hierarchy, and
//! cosine-weighted rays.

use std::f64::consts::TAU;
use std::sync::Arc;

use casca_lines::buffers::Fragment;
use casca_lines::gpu::culling::Seen;
use casca_lines::gpu::renderer::Renderer;
use casca_lines::gpu::set::GpuLines;
use casca_lines::gpu::settings::Settings;
use casca_lines::sets::LineSet;
use casca_lines::sets::generate::{Family, Recipe};
use casca_lines::sets::random::Random;
use casca_lines::view::View;
use casca_scenes::world::{Mesh, Motion, Object, Shape};
use casca_stage::gpu::{COLOUR, Gpu};
use casca_stage::timing::Clock;
use casca_truth::oracle::RayOracle;
use glam::{Affine3A, DVec3, Vec3, vec3};

/// The radius of the occlusion.
const RADIUS: f64 = 0.26;
/// The square root of the rays of a pixel.
const RAYS: u32 = 12;

/// Tubes with three sides, whose mean width over all directions is twice the radius: that of a
/// convex outline is its length over pi.
fn tubes(lines: &LineSet, radius: f32) -> RayOracle {
    let corner = std::f32::consts::TAU * radius / 27f32.sqrt();
    let mut all = Mesh { positions: Vec::new(), triangles: Vec::new(), ..Mesh::default() };
    for ends in lines.iter().flat_map(|line| line.windows(2)) {
        let Some(axis) = (ends[1] - ends[0]).try_normalize() else { continue };
        let (side, up) = axis.any_orthonormal_pair();
        let ring = |end: Vec3| {
            (0..3).map(move |i| {
                let (sine, cosine) = (i as f32 * std::f32::consts::TAU / 3.0).sin_cos();
                end + (side * cosine + up * sine) * corner
            })
        };
        let positions = ring(ends[0]).chain(ring(ends[1])).collect();
        let triangles = (0..3).flat_map(|i| [[i, (i + 1) % 3, i + 3], [(i + 1) % 3, (i + 1) % 3 + 3, i + 3]]);
        all.append(Mesh { positions, triangles: triangles.collect(), ..Mesh::default() });
    }
    RayOracle::new(&[Object {
        name: String::new(),
        shape: Shape::Mesh { mesh: Arc::new(all), transform: Affine3A::IDENTITY },
        motion: Motion::Static,
        occludes: true,
        tested: false,
    }])
}

/// The share of cosine-weighted rays that tubes of a radius stop.
fn occlusion(tubes: &RayOracle, radius: f64, view: &View, at: &Fragment, random: &mut Random) -> f64 {
    let to_world = view.eye_from_world().matrix3.transpose();
    let (tangent, viewer) = (at.tangent.as_dvec3(), -view.away(at.position).as_dvec3());
    let pole = to_world * (viewer - tangent * tangent.dot(viewer)).normalize_or(viewer);
    // Corners of the receiver's own tube are 1.21 radii from its middle.
    let start = view.to_world(at.position) + pole * radius * 1.25;
    let (right, up) = pole.any_orthonormal_pair();
    let mut stopped = 0;
    for i in 0..RAYS * RAYS {
        let u = (f64::from(i % RAYS) + random.unit()) / f64::from(RAYS);
        let (sine, cosine) = ((f64::from(i / RAYS) + random.unit()) / f64::from(RAYS) * TAU).sin_cos();
        let way: DVec3 = (right * cosine + up * sine) * u.sqrt() + pole * (1.0 - u).sqrt();
        stopped += u32::from(tubes.occluded(start, start + way * RADIUS, usize::MAX));
    }
    f64::from(stopped) / f64::from(RAYS * RAYS)
}

#[test]
fn the_occlusion_in_perspective_agrees_with_rays() {
    let Some(gpu) = Gpu::for_tests() else { return };
    // Bounds just beside the values of Mesa's software adapter, which docs/lines/trends.md quotes.
    let sets = [
        (Family::Spiral, 150, false, [0.915, 0.115]),
        (Family::PomPom, 500, false, [0.93, 0.077]),
        (Family::Spiral, 150, true, [0.935, 0.098]),
        (Family::PomPom, 500, true, [0.97, 0.05]),
    ];
    for (family, lines, by_rays, [least, most]) in sets {
        let set = Recipe { lines, ..Recipe::new(family, 3) }.make().unwrap();
        let view = View::around(set.bounds(), vec3(0.5, 0.6, 1.0), Some(0.9), [192, 144]).unwrap();
        let [near, far] = view.depths();
        let tube = view.pixel_size((near + far) / 2.0) as f32 / 2.0;
        let settings = match by_rays {
            true => Settings::new(RADIUS as f32, tube),
            false => Settings { coarse: 1, ..Settings::of_columns(RADIUS as f32, tube) },
        };
        let on_device = GpuLines::new(&gpu, &set, &settings).unwrap();
        let mut renderer = Renderer::new(&gpu, COLOUR, settings).unwrap();
        let seen = Seen::all(on_device.bundles().len());
        renderer.update(&gpu, &view, (&on_device, &seen), &[], &mut Clock::off()).unwrap();
        let (found, fragments) =
            (renderer.read_occlusion(&gpu).unwrap(), renderer.read_fragments(&gpu).unwrap());
        let (rays, mut random) = (tubes(&set, tube), Random::new(1));
        let receivers = fragments.iter().zip(found).filter_map(|(f, o)| Some((f.as_ref()?, f64::from(o))));
        let pairs: Vec<[f64; 2]> = receivers
            .step_by(12)
            .map(|(f, o)| [o, occlusion(&rays, f64::from(tube), &view, f, &mut random)])
            .collect();
        let count = pairs.len() as f64;
        let mean = |of: &dyn Fn(&[f64; 2]) -> f64| pairs.iter().map(of).sum::<f64>() / count;
        let (a, b) = (mean(&|p| p[0]), mean(&|p| p[1]));
        let (aa, bb) = (mean(&|p| (p[0] - a).powi(2)), mean(&|p| (p[1] - b).powi(2)));
        let pearson = mean(&|p| (p[0] - a) * (p[1] - b)) / (aa * bb).sqrt();
        let rmse = mean(&|p| (p[0] - p[1]).powi(2)).sqrt();
        println!(
            "{}, by rays {by_rays}: {count} pixels, means {a:.3} and {b:.3}, Pearson {pearson:.3}, RMSE {rmse:.3}",
            family.name()
        );
        assert!(count > 200.0 && pearson > least && rmse < most, "{family:?}, {by_rays}: {pearson} {rmse}");
    }
}
