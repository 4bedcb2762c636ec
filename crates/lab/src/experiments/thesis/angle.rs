//! The walk through the frustum against the angle of view (section 4.5, figure 4.6). The eye stands
//! in the middle of one face of the scene and looks inwards through a square opening; at 180 degrees
//! all of the grid lies before it. First the scene is empty, as in the thesis, then it has 5,000
//! spheres.

use casca::{Method, Plane, Query, View};
use glam::Vec3;

use super::super::stage::{Stage, Telling};
use super::super::{Lab, LabError};
use super::setting::{COARSE, FINE, Finding, cell, ratio};
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::world::{Shape, World};

/// The angles of view that are measured, in degrees: where the thesis sees the curve bend, and all
/// of the grid.
const ANGLES: [f64; 2] = [80.0, 180.0];

/// What an eye sees that looks along +x through a square opening of this many degrees, 180 at most.
fn opening(eye: Vec3, degrees: f64) -> Result<View, casca::Error> {
    let (sin, cos) = (degrees.clamp(0.0, 180.0).to_radians() * 0.5).sin_cos();
    let planes = [Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z].map(|across| {
        let normal = Vec3::X * sin as f32 - across * cos as f32;
        Plane { normal, offset: -normal.dot(eye) }
    });
    View::from_planes(eye, &planes)
}

/// How far the view along +x from the eye is free, in metres.
const FREE: f32 = 10.0;

/// A point on the face of the scene where x is least, in no object and with none close before it,
/// as near to the middle of the face as is found.
fn free_eye(world: &World) -> Vec3 {
    let (min, max) = (world.grid.min, world.grid.max);
    let middle = Vec3::new(min.x + 0.3, (min.y + max.y) * 0.5, (min.z + max.z) * 0.5);
    let free = |eye: &Vec3| {
        let ahead = |p: Vec3| Vec3::new(p.x.clamp(eye.x, eye.x + FREE), eye.y, eye.z);
        world.objects.iter().all(|o| match &o.shape {
            Shape::Sphere { center, radius } => center.distance(ahead(*center)) > radius + 0.5,
            Shape::Box { min, max } => {
                let near = ahead(eye.clamp(*min, *max));
                near.clamp(*min, *max).distance(near) > 0.5
            }
            Shape::Mesh { .. } => true,
        })
    };
    let mut offsets: Vec<(f32, f32)> =
        (-40..=40).flat_map(|y| (-80..=80).map(move |z| (y as f32 * 0.5, z as f32 * 0.5))).collect();
    offsets.sort_by(|a, b| a.0.hypot(a.1).total_cmp(&b.0.hypot(b.1)));
    offsets.into_iter().map(|(y, z)| middle + Vec3::new(0.0, y, z)).find(free).unwrap_or(middle)
}

pub(super) fn run(lab: &Lab) -> Result<Vec<Finding>, LabError> {
    (lab.progress)("angle of view");
    let full = build(SceneKind::Spheres, &SceneOptions { seed: lab.seed, ..SceneOptions::default() });
    let mut empty = build(SceneKind::Spheres, &SceneOptions { scale: 0.0, ..SceneOptions::default() });
    empty.objects.clear();
    let eye = free_eye(&full);
    let mut runs = Vec::new();
    for (world, dims, kind) in [
        (&empty, FINE, Method::cell()),
        (&full, COARSE, Method::cell()),
        (&full, COARSE, Method::point()),
        (&full, FINE, Method::cell()),
        (&full, FINE, Method::point()),
    ] {
        let stage = Stage::new(world, cell(world, dims), Method::cell(), Telling::Always)?;
        runs.push((stage, Query::with_method(kind)?));
    }
    // Milliseconds and cells visited (`cell`), by each of [`ANGLES`].
    let mut found = [[[f64::INFINITY, 0.0]; 2]; 5];
    for (i, degrees) in ANGLES.into_iter().enumerate() {
        let view = opening(eye, degrees)?;
        // All ways take turns, so that what else the machine does falls on all of them.
        for _ in 0..lab.pick(7, 3) {
            for ((stage, query), found) in runs.iter_mut().zip(&mut found) {
                found[i][0] = found[i][0].min(stage.ask(query, &view));
                found[i][1] = query.pvs().stats().cells_visited as f64;
            }
        }
    }
    let [empty, coarse, coarse_point, fine, fine_point] = found;
    let [[bend, cells_bend], [whole, cells_whole]] = fine;
    let slope = ratio(bend / ANGLES[0], (whole - bend) / (ANGLES[1] - ANGLES[0]));
    Ok(vec![
        (
            "4.5, fig. 4.6",
            "Empty scene: time rises steeply up to about 80 degrees, then less.".to_owned(),
            format!(
                "In an empty scene `cell` walks no more than {:.0} of the cells. Among spheres, 100x60x100, \
                 {:.0}% of its time at 180 degrees is there at 80, and {:.0}% of the cells walked; below 80 \
                 a degree costs {slope:.1} times as much as above.",
                empty[1][1],
                ratio(bend, whole) * 100.0,
                ratio(cells_bend, cells_whole) * 100.0
            ),
        ),
        (
            "4.5",
            "From 50x30x50 to 100x60x100 the grid has 8 times the cells; the cost grows fast.".to_owned(),
            format!(
                "Among spheres at 180 degrees, `cell` walks {:.1} times the cells in {:.1} times the time; \
                 `point` takes {:.1} times as long.",
                ratio(cells_whole, coarse[1][1]),
                ratio(whole, coarse[1][0]),
                ratio(fine_point[1][0], coarse_point[1][0])
            ),
        ),
        (
            "4.5",
            "Occluders make the walk dearer still: their extension and rasterisation add to it.".to_owned(),
            format!(
                "At 180 degrees, 100x60x100, a `cell` query takes {whole:.2} ms among spheres and {:.2} ms in \
                 the empty scene.",
                empty[1][0]
            ),
        ),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use casca::{ObjectDesc, Scene, Sphere};

    #[test]
    fn an_opening_holds_what_lies_within_its_angle() {
        let mut scene = Scene::new(1.0).unwrap();
        let at = |degrees: f32| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            ObjectDesc::fixed(Sphere::new(Vec3::new(cos, 0.0, sin) * 20.0, 0.01))
        };
        let ids: Vec<_> = [0.0, 30.0, -60.0, 89.0, 91.0].map(|d| scene.insert(at(d)).unwrap()).to_vec();
        let mut query = Query::with_method(Method::Frustum).unwrap();
        for (degrees, inside) in [(1.0, 1), (59.0, 1), (61.0, 2), (121.0, 3), (180.0, 4)] {
            let pvs = query.run(&scene, &opening(Vec3::ZERO, degrees).unwrap());
            let seen: Vec<bool> = ids.iter().map(|&id| pvs.contains(id)).collect();
            assert_eq!(seen, (0..5).map(|i| i < inside).collect::<Vec<_>>(), "{degrees} degrees");
        }
    }

    #[test]
    fn the_eye_is_in_no_sphere() {
        let world = build(SceneKind::Spheres, &SceneOptions::default());
        let eye = free_eye(&world);
        for o in &world.objects {
            let Shape::Sphere { center, radius } = &o.shape else { panic!() };
            assert!((0..=10).all(|i| center.distance(eye + Vec3::X * i as f32) > *radius));
        }
        assert!(eye.x < world.grid.min.x + 1.0);
    }
}
