//! Reflections by single cones and by walks, by gloss.

use glam::Vec3;

use super::case::{Case, generated, size};
use super::metric::{Difference, difference, less_noise};
use super::rows::{CONES, ERROR, SIZES, WALKS, digits};
use super::voxels::Voxels;
use crate::experiments::{Lab, LabError, Section, Table};
use crate::pictures::palette::other;
use crate::pictures::{Axis, Line, lines};
use casca_scenes::lit::{ASPECT, Kind, LitScene, Material};
use casca_scenes::world::Camera;
use casca_truth::oracle::path::Quantity;

const GLOSSES: [f32; 5] = [0.0, 0.2, 0.4, 0.6, 0.8];
/// Light of the lamp that the room scattered once, and the floor once more.
const REFLECTED: u32 = 2;

/// The Cornell box without blocks, with a black floor that reflects eight tenths in a lobe. The
/// camera sees the floor alone.
pub(super) fn scene(gloss: f32) -> LitScene {
    let mut scene = generated(Kind::Cornell);
    scene.objects.retain(|o| !o.name.contains("block"));
    let floor = Material { specular: Vec3::splat(0.8), gloss, ..Material::matt(Vec3::ZERO) };
    let number = scene.materials.len() as u32;
    scene.materials.push(floor);
    for object in scene.objects.iter_mut().filter(|o| o.name == "floor") {
        object.materials = vec![number; object.mesh.triangles.len()].into();
    }
    let (eye, target) = (Vec3::new(2.76, 2.0, 1.2), Vec3::new(2.76, 0.0, 2.4));
    scene.camera = Camera::look_at(eye, target, 45.0, ASPECT, 0.1, 100.0);
    scene
}

/// Measures reflections by gloss, resolution and way of gathering.
pub(super) fn gloss(lab: &Lab, section: &mut Section) -> Result<(), LabError> {
    let (sizes, glosses) = lab.pick((&SIZES[1..], &GLOSSES[..]), (&SIZES[..1], &GLOSSES[1..3]));
    let columns = ["gloss", "N", "gathered by", "error", "RMSE", "noise", "FLIP", "ms"];
    let mut table = Table::new("light-gloss", &columns);
    let mut cases = Vec::new();
    for &gloss in glosses {
        (lab.progress)(&format!("reflections, gloss {gloss}"));
        let case = Case::new(scene(gloss), size(lab))?;
        let truth = case.truth(lab, &Quantity::Radiance(REFLECTED..=REFLECTED))?;
        cases.push((gloss, case, truth));
    }
    let mut all: Vec<Line> = Vec::new();
    for (i, &n) in sizes.iter().enumerate() {
        let Some((_, any, _)) = cases.first() else { continue };
        // Voxels do not know of gloss. Walks light them for both ways, so that only the reflection
        // differs.
        let voxels = Voxels::new(&any.scene, n)?;
        let stages = any.stages(&voxels, WALKS)?;
        let Some(stage) = stages.get((REFLECTED - 1) as usize) else { continue };
        for (name, gather) in [("a cone", CONES), ("64 walks", WALKS)] {
            let mut points = Vec::new();
            for (gloss, case, truth) in &cases {
                let (image, ms) = case.gathered(&stage.volume, gather)?;
                let Difference { rmse, flip } = difference(&truth.image, &image)?;
                let error = less_noise(rmse, truth.noise);
                points.push((f64::from(*gloss), error));
                let first = [gloss.to_string(), n.to_string(), name.to_owned()];
                let last = [error, rmse, truth.noise, flip].map(digits);
                table.row(first.into_iter().chain(last).chain([format!("{ms:.1}")]));
            }
            let style = if gather == WALKS { other(i).dashed() } else { other(i) };
            all.push(Line::new(format!("{name}, N = {n}"), style, points));
        }
    }
    let worst = |start: &str| {
        let some = all.iter().filter(|l| l.label.starts_with(start)).flat_map(|l| &l.points);
        some.map(|p| p.1).fold(0.0, f64::max)
    };
    let title = format!(
        "Reflections in a glossy floor err by up to {:.2} with a cone, by up to {:.2} with walks",
        worst("a cone"),
        worst("64")
    );
    let subtitle =
        "The lit walls and ceiling in a black floor. The cone is as wide as the lobe of the floor's gloss.";
    let axes = (&Axis::linear("gloss: 0 for matt, 1 for a mirror"), &Axis::linear(ERROR));
    lines(&lab.folder.join("light-gloss.svg"), &title, subtitle, axes, &all)?;
    section.picture("light-gloss.svg", &title);
    section.rows("Reflections, as CSV", table);
    Ok(())
}
