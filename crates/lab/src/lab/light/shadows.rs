//! Soft shadows of a ball of light, and ambient occlusion, by the library's marches.

use std::time::Instant;

use casca::soft::{Cone, March};
use glam::Vec3;

use super::voxels::OFF;
use super::{Case, Difference, Voxels, difference, digits, tile};
use crate::lab::{Lab, LabError, Section, Table};
use crate::lit::{HdrImage, Kind};
use crate::oracle::path::{Quantity, Surface};
use crate::pictures::palette::other;
use crate::pictures::{Axis, Line, Tile, lines, sheet};

const SIZES: [u32; 3] = [32, 64, 128];
/// Least tangent of a cone that the library takes.
const NARROWEST: f32 = 0.001;

/// The ways to follow a cone, with their names.
fn marches() -> [(&'static str, March); 4] {
    [
        ("samples, rule of 2016", March::OLD),
        ("samples, corrected", March::Samples { step: 0.5, start: 0.0, first: 1.0, corrected: true }),
        ("slabs", March::Slabs),
        ("64 exact rays", March::Rays(64)),
    ]
}

/// The share of the first light that a cone lets through to a surface.
fn shadow(case: &Case, voxels: &Voxels, at: &Surface, march: &March) -> Result<f32, LabError> {
    let (point, normal) = (at.point.as_vec3(), at.normal.as_vec3());
    let Some(light) = case.scene.lights.first().and_then(|l| l.incident(point)) else { return Ok(0.0) };
    if light.direction.dot(normal) <= 0.0 {
        return Ok(0.0);
    }
    let cos = light.cos_half_angle.max(0.05);
    let cone = Cone {
        apex: point + normal * (OFF * voxels.cell),
        direction: light.direction,
        tan: ((1.0 - cos * cos).max(0.0).sqrt() / cos).max(NARROWEST),
        reach: light.distance,
    };
    Ok(voxels.soft.cone(&cone, march)?.transmittance)
}

fn ambient(voxels: &Voxels, at: &Surface, reach: f32, march: &March) -> Result<f32, LabError> {
    let hidden = voxels.soft.ambient_occlusion(at.point.as_vec3(), at.normal.as_vec3(), reach, march)?;
    Ok(1.0 - hidden)
}

/// Measures both by resolution and march.
pub(super) fn shadows(lab: &Lab, section: &mut Section) -> Result<(), LabError> {
    let size = lab.pick((128, 96), (16, 12));
    let reach = 2.0;
    let questions = [
        ("soft shadow", Case::new(Kind::Plane.build(), size)?, Quantity::Shadow(0)),
        ("ambient occlusion", Case::new(Kind::Cornell.build(), size)?, Quantity::Ambient(reach)),
    ];
    let mut table = Table::new("light-shadows", &["quantity", "N", "march", "RMSE", "FLIP", "ms"]);
    let (mut all, mut rows): (Vec<Line>, Vec<Vec<Tile>>) = (Vec::new(), Vec::new());
    for (what, case, quantity) in &questions {
        (lab.progress)(what);
        // Where nothing is seen both are black.
        let truth = case.truth(lab, quantity)?;
        let seen =
            case.surfaces.iter().zip(truth.pixels()).map(|(s, p)| if s.is_some() { *p } else { Vec3::ZERO });
        let truth = HdrImage::new(size.0, size.1, seen.collect())?;
        let mut tiles = vec![tile(format!("{what}: path tracer"), &truth, 1.0)];
        for (name, march) in marches() {
            let label = format!("{what}, {name}");
            let style = other(all.len() % 4);
            let mut line = Line::new(label, if all.len() < 4 { style } else { style.dashed() }, Vec::new());
            for n in lab.pick(&SIZES[..], &SIZES[..1]) {
                let voxels = Voxels::new(&case.scene, *n)?;
                let start = Instant::now();
                let image = case.image(|at| {
                    let share = match quantity {
                        Quantity::Ambient(reach) => ambient(&voxels, at, *reach, &march),
                        _ => shadow(case, &voxels, at, &march),
                    };
                    // Not a number where the library refuses: it shows as the worst error.
                    Vec3::splat(share.unwrap_or(f32::NAN))
                })?;
                let ms = start.elapsed().as_secs_f64() * 1e3;
                let Difference { rmse, flip } = difference(&truth, &image)?;
                line.points.push((f64::from(*n), rmse));
                table.row([
                    (*what).to_owned(),
                    n.to_string(),
                    name.to_owned(),
                    digits(rmse),
                    digits(flip),
                    format!("{ms:.1}"),
                ]);
                if *n == lab.pick(64, 32) {
                    tiles.push(tile(format!("N = {n}, {name}"), &image, 1.0));
                }
            }
            all.push(line);
        }
        rows.push(tiles);
    }
    let at = |i: usize| all[i].points.last().map_or(0.0, |p| 100.0 * p.1);
    let title = format!(
        "Soft shadows at the finest voxels err by {:.0}% with the rule of 2016, by {:.0}% with slabs, by {:.0}% with exact rays",
        at(0),
        at(2),
        at(3)
    );
    let subtitle = format!(
        "Share of the light, and of the directions without anything in {reach} m, that are not hidden. N: voxels along an axis."
    );
    let axes = (&Axis::log("N: voxels along an axis (logarithmic)"), &Axis::linear("RMSE over the mean"));
    lines(&lab.folder.join("light-shadows.svg"), &title, &subtitle, axes, &all)?;
    section.picture("light-shadows.svg", &title);
    sheet(&lab.folder.join("light-shadows.png"), &title, &subtitle, &rows)?;
    section.picture("light-shadows.png", &title);
    section.table(table);
    Ok(())
}
