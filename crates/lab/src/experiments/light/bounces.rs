//! The bounces by resolution, and whole pictures beside those of the path tracer.

use glam::Vec3;

use super::case::{Case, LAST, Truth, milliseconds, order_name};
use super::gather::Gather;
use super::metric::{Difference, difference, flip_map};
use super::rows::{BY_SIZE, CONES, ERROR, FLIP, Row, SIZES, WALKS, Words, chart, mean_of, table, tile};
use super::voxels::Voxels;
use crate::experiments::{Lab, LabError, Section};
use crate::pictures::palette::other;
use crate::pictures::{Line, Tile, sheet};
use casca_scenes::lit::HdrImage;
use casca_truth::oracle::path::Quantity;

/// The path tracer's pictures of all orders that are gathered.
fn truths(lab: &Lab, case: &Case) -> Result<Vec<Truth>, LabError> {
    case.orders().map(|order| case.truth(lab, &Quantity::Radiance(order..=order))).collect()
}

/// The voxels of a scene, and the milliseconds that it took to make them.
struct Made {
    voxels: Voxels,
    ms: f64,
}

/// Gathers all orders in a scene, whose voxels took some milliseconds, and compares them with the
/// truths; also gives the pictures.
fn measure(
    case: &Case,
    truths: &[Truth],
    made: &Made,
    gather: Gather,
    rows: &mut Vec<Row>,
) -> Result<Vec<HdrImage>, LabError> {
    let (voxels, mut ms) = (&made.voxels, made.ms);
    let (mut images, n) = (Vec::new(), voxels.n as u32);
    for ((order, truth), stage) in case.orders().zip(truths).zip(case.stages(voxels, gather)?) {
        let (image, gathered) = case.gathered(&stage.volume, gather)?;
        let difference = difference(&truth.image, &image)?;
        let [lit, pyramid] = stage.ms;
        let (scene, noise) = (case.scene.name.clone(), truth.noise);
        rows.push(Row { scene, order, n, gather, difference, noise, ms: [ms + lit, pyramid, gathered] });
        images.push(image);
        // Voxels are made once for all orders.
        ms = 0.0;
    }
    Ok(images)
}

/// Measures all orders in all scenes. Gives their truths.
pub(super) fn bounces(lab: &Lab, cases: &[Case], section: &mut Section) -> Result<Vec<Vec<Truth>>, LabError> {
    let sizes: &[u32] = lab.pick(&SIZES, &SIZES[..1]);
    let (mut rows, mut tiles, mut known) = (Vec::new(), Vec::new(), Vec::new());
    for case in cases {
        (lab.progress)(&case.scene.name);
        let truths = truths(lab, case)?;
        for &n in sizes {
            let (voxels, ms) = milliseconds(|| Voxels::new(&case.scene, n));
            let made = Made { voxels: voxels?, ms };
            for gather in [CONES, WALKS] {
                let images = measure(case, &truths, &made, gather, &mut rows)?;
                if gather == CONES && Some(&n) == sizes.last() {
                    tiles.push(whole(lab, case, &made.voxels, &truths, &images)?);
                }
            }
        }
        known.push(truths);
    }
    pictures(lab, section, &tiles)?;
    by_size(lab, section, &rows)?;
    section.rows("All orders by resolution, as CSV", table("light-bounces", &rows));
    Ok(known)
}

/// The sum of pictures of one size.
fn sum<'a>(images: impl Iterator<Item = &'a HdrImage>, size: (usize, usize)) -> Result<HdrImage, LabError> {
    let mut pixels = vec![Vec3::ZERO; size.0 * size.1];
    for image in images {
        pixels.iter_mut().zip(image.pixels()).for_each(|(a, b)| *a += *b);
    }
    Ok(HdrImage::new(size.0, size.1, pixels)?)
}

/// The picture of all light up to the second bounce, beside the path tracer's and their difference.
fn whole(
    lab: &Lab,
    case: &Case,
    voxels: &Voxels,
    truths: &[Truth],
    images: &[HdrImage],
) -> Result<Vec<Tile>, LabError> {
    let base = case.truth(lab, &Quantity::Radiance(0..=case.held))?;
    let truth = sum(truths.iter().map(|t| &t.image).chain([&base.image]), case.size)?;
    // Emission, and the light of lights with shadows through the voxels.
    let own = case.image(|at| {
        let material = &case.materials[at.material];
        let lit = voxels.lit(&case.scene.lights, at.point.as_vec3(), at.normal.as_vec3())?;
        Ok::<_, casca::Error>(material.emission + material.albedo * lit * std::f32::consts::FRAC_1_PI)
    })?;
    let found = sum(images.iter().chain([&own]), case.size)?;
    let Difference { rmse, flip } = difference(&truth, &found)?;
    let (exposure, name) = (truth.exposure(), &case.scene.name);
    Ok(vec![
        tile(format!("{name}: path tracer"), &truth, exposure),
        tile(format!("N = {}, {}", voxels.n, CONES.words()), &found, exposure),
        Tile {
            caption: format!("FLIP {flip:.3}, RMSE {rmse:.2}"),
            width: case.size.0,
            rgb: flip_map(&truth, &found),
        },
    ])
}

fn pictures(lab: &Lab, section: &mut Section, tiles: &[Vec<Tile>]) -> Result<(), LabError> {
    let title = "All light up to the second bounce";
    let subtitle =
        "Left the path tracer, then voxels, then FLIP: black for equal, yellow for the greatest difference.";
    sheet(&lab.folder.join("light-sheet.png"), title, subtitle, tiles)?;
    section.picture("light-sheet.png", title);
    Ok(())
}

/// Draws errors by resolution: a chart for each order and measure.
fn by_size(lab: &Lab, section: &mut Section, rows: &[Row]) -> Result<(), LabError> {
    for order in 1..=LAST {
        for (measure, label) in [("error", ERROR), ("flip", FLIP)] {
            let value = |r: &Row| r.value(measure);
            let some = || rows.iter().filter(|r| r.order == order);
            let mut all: Vec<Line> = Vec::new();
            for r in some() {
                let (kind, dashed) = match r.gather {
                    Gather::Walks(_) => ("walks", true),
                    Gather::Cones { .. } => ("cones", false),
                };
                let label = format!("{}, {kind}", r.scene);
                let point = (f64::from(r.n), value(r));
                if let Some(line) = all.iter_mut().find(|l| l.label == label) {
                    line.points.push(point);
                    continue;
                }
                // One colour a scene, wherever it is drawn.
                let mut scenes: Vec<&str> = rows.iter().map(|r| r.scene.as_str()).collect();
                scenes.dedup();
                let style = other(scenes.iter().position(|s| *s == r.scene).unwrap_or(0));
                all.push(Line::new(label, if dashed { style.dashed() } else { style }, vec![point]));
            }
            let mean = |n: Option<u32>, cones: bool| {
                let found =
                    some().filter(|r| Some(r.n) == n && matches!(r.gather, Gather::Cones { .. }) == cones);
                mean_of(found.map(value))
            };
            let (coarse, fine) = (some().map(|r| r.n).min(), some().map(|r| r.n).max());
            let title = format!(
                "{}: from N = {} to N = {} the {} of cones goes from {:.2} to {:.2}, that of walks from {:.2} to {:.2}, on average",
                order_name(order),
                coarse.unwrap_or(0),
                fine.unwrap_or(0),
                if measure == "flip" { "FLIP" } else { measure },
                mean(coarse, true),
                mean(fine, true),
                mean(coarse, false),
                mean(fine, false)
            );
            let subtitle = "16 cones with steps of half a diameter, or 64 exact walks a pixel; voxels take a quarter of that.";
            let file = format!("light-size-{}-{measure}.svg", order_name(order).replace(' ', "-"));
            chart(lab, section, &file, &Words { title: &title, subtitle, across: BY_SIZE, up: label }, &all)?;
        }
    }
    Ok(())
}
