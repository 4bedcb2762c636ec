//! Magnified patches: objects that only pixels drawn again hide, compared with rays against the
//! triangles. The rays share no code with the library.

use casca_truth::places::coordinates;

use crate::common::worlds::cuts_triangle;
use crate::common::*;
use crate::work::noise;

/// Quads along each side of a sheet.
const QUADS: u32 = 5;

/// A sheet of triangles: its middle, the width of a quad, its slopes, and a number that its bumps
/// and holes follow from.
type Sheet = (Vec3, f32, (f32, f32), u32);

fn some_sheet() -> impl Strategy<Value = Sheet> {
    let on = |range| coordinates(range, 1.0);
    let middle = (on(-4.0..4.0), on(-3.0..3.0), on(5.0..8.0)).prop_map(Vec3::from);
    (middle, 0.3..1.0f32, (-0.4..0.4f32, -0.4..0.4f32), any::<u32>())
}

/// The triangles of a sheet. Every eighth quad or so is a hole.
fn holed(&(middle, width, slope, seed): &Sheet) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let at = |i: u32| i as f32 - QUADS as f32 * 0.5;
    let (corners, triangles) = sheet(QUADS, QUADS, |i, j| {
        let (x, y, bump) = (at(i), at(j), 0.1 * noise(seed as usize, (j * (QUADS + 1) + i) as usize));
        middle + Vec3::new(x, y, x * slope.0 + y * slope.1 + bump) * width
    });
    let quads = triangles.chunks(2).enumerate().filter(|(q, _)| noise(!seed as usize, *q) > 0.12);
    (corners, quads.flat_map(|(_, quad)| quad).copied().collect())
}

/// The objects that a query with wide pixels finds, with this many patches drawn again.
fn found(scene: &Scene, view: &View, objects: &[ObjectId], patches: u32) -> Vec<bool> {
    let options = PointOptions::new().pixel_degrees(3.0).min_pixels(0).refine_squares(0);
    let mut query = query_by(Method::Point(options.refine_patches(patches)));
    let pvs = query.run(scene, view);
    objects.iter().map(|&id| pvs.contains(id)).collect()
}

fn check(sheets: &[Sheet], targets: &[(Vec3, f32)]) -> Result<usize, TestCaseError> {
    let mut scene = empty();
    let mut triangles = Vec::new();
    for sheet in sheets {
        let (corners, indices) = holed(sheet);
        triangles.extend(indices.iter().map(|t| t.map(|i| corners[i as usize].as_dvec3())));
        scene.solid(mesh(corners, indices));
    }
    let boxes: Vec<Aabb> = targets.iter().map(|t| Aabb::from_center(t.0, Vec3::splat(t.1))).collect();
    let ids: Vec<ObjectId> = boxes.iter().map(|b| scene.fixed(*b)).collect();
    let clip = directx::perspective(1.2, 1.3, 0.05, 60.0) * look_to_mat4(Vec3::ZERO, Vec3::Z, Vec3::Y);
    let view = View::perspective(Vec3::ZERO, clip).unwrap();
    let (coarse, fine) = (found(&scene, &view, &ids, 0), found(&scene, &view, &ids, u32::MAX));
    let mut gained = 0;
    for (i, b) in boxes.iter().enumerate() {
        prop_assert!(coarse[i] || !fine[i], "{b:?} is found in magnified pixels only");
        // Boxes outside of the view are found by neither.
        if !coarse[i] || fine[i] {
            continue;
        }
        gained += 1;
        for k in 0..200 {
            let share = |axis| f64::from(noise(k, axis));
            let inside = DVec3::new(share(0), share(1), share(2));
            let point = b.min.as_dvec3() + inside * (b.max - b.min).as_dvec3();
            // Points beside the frustum prove nothing.
            let c = clip.as_dmat4() * point.extend(1.0);
            if c.x.abs() > c.w || c.y.abs() > c.w {
                continue;
            }
            let hit = triangles.iter().any(|t| cuts_triangle(t, DVec3::ZERO, point));
            prop_assert!(hit, "{b:?} is seen at {point}");
        }
    }
    Ok(gained)
}

#[test]
fn magnified_patches_hide_only_what_rays_find_behind_triangles() {
    let targets = prop::collection::vec(
        ((-8.0..8.0f32, -6.0..6.0f32, 10.0..14.0f32).prop_map(Vec3::from), 0.02..0.25f32),
        150,
    );
    let gained = std::cell::Cell::new(0);
    let config = cases(48);
    let least = config.cases as usize * 4;
    proptest!(config, |(sheets in prop::collection::vec(some_sheet(), 3..14), targets in targets)| {
        gained.set(gained.get() + check(&sheets, &targets)?);
    });
    assert!(gained.get() > least, "magnified pixels hide only {} boxes", gained.get());
}

#[test]
fn a_patch_hides_from_the_radius_of_the_options_on() {
    let mut scene = empty();
    // Three pixels from its middle to its corners.
    let half = 10.0 * 3f32.to_radians().tan() / 2f32.sqrt();
    let (corners, triangles) = sheet(1, 1, |i, j| {
        let side = |at: u32| if at == 0 { -half } else { half };
        Vec3::new(side(i), side(j), 10.0)
    });
    scene.solid(mesh(corners, triangles));
    let behind = scene.fixed(Aabb::from_center(Vec3::Z * 12.0, Vec3::splat(0.05)));
    let clip = directx::perspective(1.2, 1.3, 0.05, 60.0) * look_to_mat4(Vec3::ZERO, Vec3::Z, Vec3::Y);
    let view = View::perspective(Vec3::ZERO, clip).unwrap();
    for (options, hides) in [
        (PointOptions::balanced().patch_radius(0.0), true),
        (PointOptions::balanced().patch_radius(2.5), true),
        (PointOptions::balanced().patch_radius(3.5), false),
        (PointOptions::fast(), false),
        (PointOptions::fast().patch_radius(2.5), true),
    ] {
        let mut query = query_by(Method::Point(options.pixel_degrees(1.0).min_pixels(0)));
        let pvs = query.run(&scene, &view);
        assert_eq!(pvs.contains(behind), !hides, "{options:?}");
        assert_eq!(pvs.stats().patches_drawn, u32::from(hides), "{options:?}");
    }
}
