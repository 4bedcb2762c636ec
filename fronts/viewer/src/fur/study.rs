//! Shells beside ray-traced strands: the error by layers, height and density.

use std::error::Error;

use casca_fur::gpu::error::FurGpuError;
use casca_fur::gpu::look::{Look, sky_pixel};
use casca_fur::gpu::records::Sun;
use casca_fur::gpu::reference::{Reference, Tint};
use casca_fur::gpu::renderer::Renderer;
use casca_fur::shading::Material;
use casca_fur::strands::Fur;
use casca_scenes::world::Camera;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_tools::command_line::{PathError, say};
use casca_tools::image::write_png;
use casca_tools::pictures::palette::OTHERS;
use casca_tools::pictures::{Axis, Line, lines};
use glam::Vec3;

use crate::fur::choices::{Choices, Subject};
use crate::fur::one::{self, TO_SUN};
use crate::fur::shots::{Picture, Shooter, sheet};

const LAYERS: [u32; 5] = [4, 8, 16, 32, 64];
/// Heights as shares of the radius: the two of the thesis, and a taller one.
const HEIGHTS: [f32; 3] = [0.02, 0.05, 0.1];
const DENSITIES: [f32; 2] = [0.3, 0.1];
/// Both pictures sample each pixel at the same 2x2 places, as most pictures of this program do...
const SMOOTH: u32 = 1;
/// ...and at 8x8 places, so that samples alone hardly change a picture: for the first density and
/// up to so many layers, since that costs sixteen times as much.
const FINE: u32 = 3;
const FINE_LAYERS: u32 = 8;
const SIZE: (u32, u32) = (240, 180);

/// Layers at which gaps are measured: those that the thesis finds enough for fur of 2%.
const GAP_LAYERS: u32 = 8;
/// Layers of the shells shown beside the strands, and whether their rays are followed.
const SHOWN: [(u32, bool); 3] = [(8, true), (32, true), (8, false)];
/// Light from everywhere and nothing else.
const SHINING: Material =
    Material { ambient: 1.0, diffuse: 0.0, specular: 0.0, exponent: 1.0, wrap: 0.0, root: 1.0 };

/// One picture of shells: its parameters and its error.
struct Row {
    height: f32,
    density: f32,
    layers: u32,
    marched: bool,
    rmse: f64,
    /// The error away from outlines, see [`inside`].
    inside: f64,
    /// Both with more samples; not numbers where they were not measured.
    fine: [f64; 2],
    /// See [`gaps`]; not a number where it was not measured.
    gaps: f64,
}

/// Looks at the shoulder and the head from so near that strands are some pixels wide.
pub fn close(radius: f32, (width, height): (u32, u32)) -> Camera {
    let aspect = width as f32 / height as f32;
    let (eye, at) = (Vec3::new(0.75, 0.55, 1.0) * radius, Vec3::new(0.35, 0.2, 0.15) * radius);
    Camera::look_at(eye, at, 38.0, aspect, 0.01 * radius, 20.0 * radius)
}

/// The error of a picture over the pixels in which either picture shows the object, 0 to 1.
pub fn rmse(want: &[u8], got: &[u8], sky: &[u8]) -> f64 {
    let pixels = || want.chunks(4).zip(got.chunks(4)).filter(|(a, b)| *a != sky || *b != sky);
    let square = |(a, b): (&[u8], &[u8])| {
        (0..3).map(|i| (f64::from(a[i]) - f64::from(b[i])).powi(2)).sum::<f64>() / 3.0
    };
    (pixels().map(square).sum::<f64>() / pixels().count().max(1) as f64).sqrt() / 255.0
}

/// Pixels nearer than this to one of the sky belong to an outline.
const OUTLINE: i64 = 4;

/// The error over the pixels that are no part of an outline, 0 to 1.
fn inside(want: &[u8], got: &[u8], sky: &[u8]) -> f64 {
    let (width, height) = (i64::from(SIZE.0), i64::from(SIZE.1));
    let is_sky = |x: i64, y: i64| {
        let at = 4 * (y * width + x) as usize;
        [want, got].iter().any(|p| p.get(at..at + 4) == Some(sky))
    };
    let mut masked = [want.to_vec(), got.to_vec()];
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let (left, right) = ((x - OUTLINE).max(0), (x + OUTLINE).min(width - 1));
        let mut near = (y - OUTLINE).max(0)..=(y + OUTLINE).min(height - 1);
        if near.any(|v| (left..=right).any(|u| is_sky(u, v))) {
            let at = 4 * (y * width + x) as usize;
            masked.iter_mut().filter_map(|p| p.get_mut(at..at + 4)).for_each(|p| p.copy_from_slice(sky));
        }
    }
    rmse(&masked[0], &masked[1], sky)
}

/// The strands and the shells of one height and density.
struct Case<'a> {
    gpu: &'a Gpu,
    subject: &'a Subject,
    camera: Camera,
    sun: Sun,
    height: f32,
    density: f32,
    look: Look,
    reference: Reference<'a>,
    renderer: Renderer,
}

impl<'a> Case<'a> {
    fn new(
        gpu: &'a Gpu,
        choices: &Choices,
        subject: &'a Subject,
        (height, density): (f32, f32),
    ) -> Result<Self, Box<dyn Error>> {
        let mut look = Look::new(Fur::for_radius(subject.radius, height, density)?);
        look.fur.bend = choices.fur(subject.radius)?.bend;
        let reference = Reference::new(&subject.levels[0], &look)?.with_images(&subject.images);
        let mut renderer = Renderer::new(gpu, COLOUR, &subject.levels[..1], &look)?;
        renderer.set_images(gpu, &[0], &subject.images)?;
        let (camera, sun) = (close(subject.radius, SIZE), one::sun(subject.radius, false));
        Ok(Self { gpu, subject, camera, sun, height, density, look, reference, renderer })
    }

    /// The strands, sampled at `side * side` places of each pixel.
    fn strands(&self, side: u32) -> Vec<u8> {
        let tint: Tint = [one::ROOT, one::TIP].map(Vec3::from_array);
        self.reference.picture(&self.camera, SIZE, side, &tint, TO_SUN.normalize())
    }

    fn shells(&mut self, shooter: &Shooter, layers: u32, marched: bool) -> Result<Vec<u8>, FurGpuError> {
        self.renderer.set_look(self.gpu, &Look { marched, ..self.look });
        let list = one::list(self.subject, layers, false);
        Ok(shooter.shoot(&mut self.renderer, &self.camera, &list, &self.sun)?.pixels)
    }

    /// See [`gaps`]. Strands shine by themselves, the more the nearer to the tip; skin and roots
    /// are black.
    fn gaps(&mut self, shooter: &Shooter, marched: bool) -> Result<f64, Box<dyn Error>> {
        let shining = Look { material: SHINING, vary: 0.0, marched, ..self.look };
        let ends = [Vec3::ZERO, Vec3::ONE];
        let tips = Reference::new(&self.subject.levels[0], &shining)?.picture(
            &self.camera,
            SIZE,
            1 << SMOOTH,
            &ends,
            TO_SUN.normalize(),
        );
        self.renderer.set_look(self.gpu, &shining);
        let list = one::tinted(GAP_LAYERS, ([0.0; 3], [1.0; 3]));
        let shells = shooter.shoot(&mut self.renderer, &self.camera, &list, &self.sun)?.pixels;
        Ok(gaps(&tips, &shells, &sky_pixel()))
    }
}

/// The error and that away from outlines.
fn errors(want: &[u8], got: &[u8]) -> [f64; 2] {
    let sky = sky_pixel();
    [rmse(want, got, &sky), inside(want, got, &sky)]
}

/// Compares all cases, writes them, and prints what follows.
pub fn study(gpu: &Gpu, choices: &Choices, subject: &Subject) -> Result<(), Box<dyn Error>> {
    let [shooter, finest] = [SMOOTH, FINE].map(|smooth| Shooter::new(gpu, SIZE, smooth));
    let mut rows: Vec<Row> = Vec::new();
    for (density, height) in DENSITIES.into_iter().flat_map(|d| HEIGHTS.map(|h| (d, h))) {
        let mut case = Case::new(gpu, choices, subject, (height, density))?;
        say(format_args!("height {height}, density {density}: {} strands", case.reference.strands()));
        let [truth, fine] = [SMOOTH, FINE].map(|smooth| case.strands(1 << smooth));
        // The same strands, seen by other rays in the same pixels: what samples alone do.
        for (picture, side, other) in [(&truth, 1 << SMOOTH, 3), (&fine, 1 << FINE, (1 << FINE) - 1)] {
            let [all, inside] = errors(picture, &case.strands(other));
            say(format_args!(
                "  strands at {other}x{other} instead of {side}x{side} places of a pixel: RMSE {all:.4}, away from \
                 outlines {inside:.4}"
            ));
        }
        let mut shown = vec![Picture { size: SIZE, pixels: truth.clone() }];
        for (marched, layers) in [true, false].into_iter().flat_map(|m| LAYERS.map(|l| (m, l))) {
            let pixels = case.shells(&shooter, layers, marched)?;
            let [rmse, inside] = errors(&truth, &pixels);
            let fine = match marched && layers <= FINE_LAYERS && density == DENSITIES[0] {
                true => errors(&fine, &case.shells(&finest, layers, marched)?),
                false => [f64::NAN; 2],
            };
            let gaps = if layers == GAP_LAYERS { case.gaps(&shooter, marched)? } else { f64::NAN };
            let way = if marched { "followed" } else { "plain" };
            let finer = match fine[0].is_nan() {
                true => String::new(),
                false => format!("; with 8x8 samples {:.4}, {:.4}", fine[0], fine[1]),
            };
            say(format_args!(
                "  {way:<9}{layers:>3} layers: RMSE {rmse:.4}, away from outlines {inside:.4}{finer}"
            ));
            if SHOWN.contains(&(layers, marched)) {
                shown.push(Picture { size: SIZE, pixels });
            }
            rows.push(Row { height, density, layers, marched, rmse, inside, fine, gaps });
        }
        let beside = sheet(&shown, shown.len());
        let name = format!("study-{:.0}-{:.0}.png", case.height * 100.0, case.density * 100.0);
        write_png(&choices.out().join(name), beside.size, &beside.pixels)?;
    }
    write(choices, &rows)?;
    conclude(&rows);
    Ok(())
}

fn write(choices: &Choices, rows: &[Row]) -> Result<(), Box<dyn Error>> {
    let mut csv = String::from(
        "height,density,layers,rays followed,RMSE,RMSE away from outlines,RMSE of 8x8 samples,away from outlines,light of tips lost\n",
    );
    for r in rows {
        let [fine, fine_inside, gaps] = [r.fine[0], r.fine[1], r.gaps]
            .map(|x| if x.is_nan() { String::new() } else { format!("{x:.5}") });
        csv += &format!(
            "{},{},{},{},{:.5},{:.5},{fine},{fine_inside},{gaps}\n",
            r.height, r.density, r.layers, r.marched, r.rmse, r.inside
        );
    }
    let path = choices.out().join("study.csv");
    std::fs::write(&path, csv).map_err(PathError::write(&path))?;
    let mut curves = Vec::new();
    for marched in [true, false] {
        for (height, style) in HEIGHTS.into_iter().zip(OTHERS) {
            let of = |r: &&Row| r.height == height && r.marched == marched && r.density == DENSITIES[0];
            let points = rows.iter().filter(of).map(|r| (f64::from(r.layers), r.rmse)).collect();
            let way = if marched { "rays followed" } else { "plain shells" };
            let label = format!("{}% high, {way}", height * 100.0);
            curves.push(Line::new(label, if marched { style } else { style.dashed() }, points));
        }
    }
    let title = "Shells come nearer to strands with more layers, and tall fur needs more of them";
    let subtitle =
        format!("Error against ray-traced strands, density {}, {}x{} pixels", DENSITIES[0], SIZE.0, SIZE.1);
    let axes = (&Axis::log("layers"), &Axis::linear("RMSE of pixel values, 0 to 1"));
    let path = choices.out().join("study.svg");
    lines(&path, title, &subtitle, axes, &curves)?;
    say(path.display());
    Ok(())
}

/// Prints the trends that the thesis saw by eye.
fn conclude(rows: &[Row]) {
    let curve = |height: f32, density: f32, marched: bool| -> Vec<(f64, f64)> {
        let same = |r: &&Row| (r.height, r.density, r.marched) == (height, density, marched);
        rows.iter().filter(same).map(|r| (f64::from(r.layers), r.rmse)).collect()
    };
    for marched in [false, true] {
        say(if marched { "rays followed:" } else { "plain shells:" });
        for density in DENSITIES {
            let short = curve(HEIGHTS[0], density, marched);
            let Some(&(_, goal)) = short.iter().find(|p| p.0 == f64::from(GAP_LAYERS)) else { continue };
            for height in &HEIGHTS[1..] {
                let needed = layers_for_error(&curve(*height, density, marched), goal);
                let needed =
                    needed.map_or(format!("more than {}", LAYERS[LAYERS.len() - 1]), |n| format!("{n:.0}"));
                say(format_args!(
                    "  density {density}: fur {}% high needs {needed} layers for the error of fur {}% high with {GAP_LAYERS}",
                    height * 100.0,
                    HEIGHTS[0] * 100.0
                ));
            }
        }
    }
    say(format_args!("light of tips that gaps swallow, with {GAP_LAYERS} layers:"));
    for r in rows.iter().filter(|r| r.layers == GAP_LAYERS) {
        let way = if r.marched { "followed" } else { "plain" };
        say(format_args!("  height {:<4} density {}: {way:<9}{:.3}", r.height, r.density, r.gaps));
    }
}

/// Where a falling curve of errors, with the logarithm of the layers between its points, first
/// reaches an error: its first point, if that is below already.
fn layers_for_error(curve: &[(f64, f64)], goal: f64) -> Option<f64> {
    let &(first, error) = curve.first()?;
    if error <= goal {
        return Some(first);
    }
    let pair = curve.windows(2).find(|w| w[0].1 >= goal && w[1].1 < goal)?;
    let share = (pair[0].1 - goal) / (pair[0].1 - pair[1].1);
    Some((pair[0].0.ln() * (1.0 - share) + pair[1].0.ln() * share).exp())
}

/// How much less of the tips a picture shows than another: the sums of the light in pixels that
/// show the object.
fn gaps(want: &[u8], got: &[u8], sky: &[u8]) -> f64 {
    let sum = |pixels: &[u8]| -> f64 {
        let shown = pixels.chunks(4).filter(|p| *p != sky);
        // Stored values are not linear in light.
        shown.flat_map(|p| &p[..3]).map(|v| (f64::from(*v) / 255.0).powf(2.2)).sum()
    };
    1.0 - sum(got) / sum(want).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_taken_over_the_object_and_curves_are_read_between_their_points() {
        let (sky, fur, dark) = ([9, 9, 9, 255], [200, 200, 200, 255], [100, 100, 100, 255]);
        let want = [sky, fur, fur, sky].concat();
        assert_eq!(rmse(&want, &want, &sky), 0.0);
        let got = [sky, fur, dark, sky].concat();
        assert!((rmse(&want, &got, &sky) - (0.5f64 * (100.0f64 / 255.0).powi(2)).sqrt()).abs() < 1e-12);
        assert!((gaps(&want, &got, &sky) - 0.5 * (1.0 - 0.5f64.powf(2.2))).abs() < 1e-12);
        // A picture of fur with a single pixel of sky and one that differs next to it, or far away.
        let full = fur.repeat((SIZE.0 * SIZE.1) as usize);
        let with = |at: usize| {
            let mut picture = full.clone();
            picture[..4].copy_from_slice(&sky);
            picture[4 * at..4 * at + 4].copy_from_slice(&dark);
            picture
        };
        let mut truth = full.clone();
        truth[..4].copy_from_slice(&sky);
        assert_eq!(inside(&truth, &with(4), &sky), 0.0);
        assert!(inside(&truth, &with(5), &sky) > 0.0);
        let curve = [(4.0, 0.4), (16.0, 0.2), (64.0, 0.1)];
        assert!((layers_for_error(&curve, 0.3).unwrap() - 8.0).abs() < 1e-9);
        assert_eq!(layers_for_error(&curve, 0.05), None);
    }
}
