//! The operator beside squares that are drawn one by one, and beside analytic truth.

use super::*;
use crate::samples::sphere;
use casca_truth::{cases, places::coordinates};
use proptest::prelude::*;

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn a_depth_image_has_the_nearest_square_of_each_pixel(
        size in (1..40_u32, 1..40_u32),
        squares in prop::collection::vec((coordinates(-1.0..1.0, 1.0), coordinates(-1.0..1.0, 1.0), 0..13_u32, 0..10_000_i32, 1..50_u8), 0..30),
    ) {
        let drawn = Squares::new(size);
        let mut image = vec![f32::INFINITY; (size.0 * size.1) as usize];
        for (x, y, magnitude, half, depth) in squares {
            let side = |at: f32, size: u32| ((f64::from(at) + 1.0) * f64::from(size * 128)) as i32;
            // A farther one that begins at the same pixel is a pixel wider.
            for (more, depth) in [(0, f32::from(depth)), (128, f32::from(depth) + 0.5)] {
                let (x, y) = (side(x, size.0) + more, side(y, size.1) + more);
                let half = (half >> magnitude) + more;
                drawn.draw(&[x], &[y], &[half], &[depth]);
                let covers = |pixel: u32, at: i32| (-half - 255..=half).contains(&(pixel as i32 * 256 - at));
                for (i, pixel) in (0..).zip(&mut image) {
                    if covers(i % size.0, x) && covers(i / size.0, y) {
                        *pixel = pixel.min(depth);
                    }
                }
            }
        }
        prop_assert_eq!(drawn.into_image().depths, image);
    }
}

/// How far each point is before its limit of depth, by the definition; negative if hidden.
fn rooms(points: &[Vec3], camera: &Camera, options: &SplatOptions) -> Vec<f64> {
    let round = |x: f32| (f64::from(x) * 256.0).round_ties_even();
    let (width, height) = camera.size();
    let place = |&p: &Vec3| {
        let at = camera.place(p);
        let (x, y) = (round(at.x), round(at.y));
        let inside = x >= 0.0 && x < f64::from(width) * 256.0 && y >= 0.0 && y < f64::from(height) * 256.0;
        (inside && (1.0..=9.0).contains(&at.depth)).then_some((x, y, at.depth))
    };
    let at: Vec<Option<(f64, f64, f32)>> = points.iter().map(place).collect();
    let nearest = |x: i64, y: i64| {
        let covers = |i: usize, (px, py, depth): (f64, f64, f32)| {
            let radius = match options.radius {
                Radius::Same(radius) => radius,
                Radius::Each(radii) => radii[i],
            };
            let half = (f64::from(radius * camera.pixels_per_tangent() / depth) - 0.5).clamp(0.0, 512.0);
            let half = round(half as f32);
            let covers = |pixel: i64, at: f64| {
                (at - half..at + half + 256.0).contains(&(pixel as f64 * 256.0 + 255.0))
            };
            covers(x, px) && covers(y, py)
        };
        let depths =
            at.iter().enumerate().filter_map(|(i, at)| at.filter(|&at| covers(i, at)).map(|at| at.2));
        depths.fold(f32::INFINITY, f32::min)
    };
    let filtered = |x: i64, y: i64| {
        let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy)));
        let inside =
            around.filter(|&(x, y)| (0..width.into()).contains(&x) && (0..height.into()).contains(&y));
        let depths: Vec<f32> = inside.map(|(x, y)| nearest(x, y)).collect();
        let (most, least) = (depths.iter().copied().reduce(f32::max), depths.into_iter().reduce(f32::min));
        match options.filter {
            Filter::Max if most < Some(f32::INFINITY) => most.unwrap(),
            Filter::Min if most < Some(f32::INFINITY) => least.unwrap(),
            _ => nearest(x, y),
        }
    };
    let window = |depth: f32| {
        let clip = camera.view_projection() * (camera.eye() + camera.axes()[2] * depth).extend(1.0);
        f64::from(clip.z) / f64::from(clip.w)
    };
    let room = |&(x, y, depth): &(f64, f64, f32)| {
        let limit = filtered((x / 256.0).floor() as i64, (y / 256.0).floor() as i64);
        match options.bias {
            Bias::World(length) => f64::from(limit + length - depth),
            Bias::Window(_) if limit == f32::INFINITY => 1.0,
            Bias::Window(part) => window(limit) + (1.0 - window(limit)) * f64::from(part) - window(depth),
        }
    };
    at.iter().map(|at| at.as_ref().map_or(-1.0, room)).collect()
}

const SAME: SplatOptions<'static> =
    SplatOptions { radius: Radius::Same(0.0), bias: Bias::World(0.1), filter: Filter::Max, slopes: false };

fn camera(size: (u32, u32), fov_y: f32) -> Camera {
    Camera::look_at(Vec3::new(0.5, -0.3, 4.0), Vec3::ZERO, Vec3::Y, fov_y, size, 1.0, 9.0).unwrap()
}

proptest! {
    #![proptest_config(cases(150))]

    #[test]
    fn answers_are_those_of_the_definition(
        points in prop::collection::vec(prop::array::uniform4(coordinates(-2.0..2.0, 2.0)), 0..80),
        size in (1..14_u32, 1..14_u32),
        fov_y in 0.3..2.0_f32,
        (filter, each, bias) in (0..3_usize, any::<bool>(), prop_oneof![
            (0.0..0.4_f32).prop_map(Bias::Window), (0.0..0.6_f32).prop_map(Bias::World), Just(Bias::World(0.0)),
        ]),
    ) {
        let radii: Vec<f32> = points.iter().map(|p| p[3].max(0.0).powi(3)).collect();
        let radius = if each { Radius::Each(&radii) } else { Radius::Same(radii.first().copied().unwrap_or(0.1)) };
        let filter = [Filter::None, Filter::Max, Filter::Min][filter];
        let options = SplatOptions { radius, bias, filter, slopes: false };
        let points: Vec<Vec3> = points.iter().map(|p| Vec3::new(p[0], p[1], p[2])).collect();
        let camera = camera(size, fov_y);
        let found = visible_points(&points, &camera, &options).unwrap();
        prop_assert_eq!(found.len(), points.len());
        for (found, room) in found.iter().zip(rooms(&points, &camera, &options)) {
            // The matrix of the definition rounds window depths otherwise.
            let in_doubt = room.abs() < 1e-5 && matches!(bias, Bias::Window(_));
            prop_assert!(in_doubt || *found == (room >= 0.0), "{found} {room}");
        }
    }

    #[test]
    fn any_floats_have_an_answer(bits in prop::collection::vec(prop::array::uniform4(any::<u32>()), 0..80)) {
        let floats: Vec<[f32; 4]> = bits.iter().map(|p| p.map(f32::from_bits)).collect();
        let radii: Vec<f32> = floats.iter().map(|p| p[3].abs()).collect();
        let points: Vec<Vec3> = floats.iter().map(|p| Vec3::new(p[0], p[1], p[2])).collect();
        let options = SplatOptions { radius: Radius::Each(&radii), ..SAME };
        let found = visible_points(&points, &camera((30, 20), 1.0), &options);
        let bad_radius = radii.iter().position(|r| !r.is_finite());
        let bad_point = points.iter().position(|p| !p.is_finite());
        match found {
            Err(SplatError::Radius { index, .. }) => prop_assert_eq!(Some(index), bad_radius),
            Err(SplatError::PointNotFinite { index }) => prop_assert_eq!((bad_radius, Some(index)), (None, bad_point)),
            found => prop_assert!(found.is_ok() && bad_radius.or(bad_point).is_none()),
        }
    }
}

#[test]
fn answers_do_not_depend_on_the_number_of_threads() {
    let points: Vec<Vec3> = sphere(60_001).iter().map(|p| p.as_vec3()).collect();
    let options = SplatOptions { radius: Radius::Same(0.02), bias: Bias::Window(0.05), ..SAME };
    let found = [1, 2, 7].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| visible_points(&points, &camera((320, 240), 0.6), &options).unwrap())
    });
    assert!(found[0] == found[1] && found[0] == found[2]);
    assert!((20_000..35_000).contains(&found[0].count_ones()));
}

#[test]
fn errors_name_the_cause() {
    let find = |radius, bias| {
        let options = SplatOptions { radius, bias, ..SAME };
        visible_points(&[Vec3::ZERO; 2], &camera((4, 4), 1.0), &options).map(|found| found.count_ones())
    };
    let world = Bias::World(0.0);
    assert_eq!([0.0, f32::MAX].map(|radius| find(Radius::Same(radius), world)), [Ok(2); 2]);
    assert_eq!(find(Radius::Same(-1.0), world), Err(SplatError::Radius { index: 0, radius: -1.0 }));
    assert_eq!(find(Radius::Each(&[1.0]), world), Err(SplatError::Radii { radii: 1, points: 2 }));
    let part = Bias::Window(1.0);
    assert_eq!(find(Radius::Same(0.0), part), Err(SplatError::Bias { bias: part }));
}

/// A floor, and a cellar a metre below it, up to 50 m away, have a point in each cell of 0.2 m. Of those in
/// the picture, the part of the floor that is hidden and the part of the cellar that is visible.
fn errors_of_floor(slopes: bool) -> [f64; 2] {
    let random = |i: u32| f32::from((i.wrapping_mul(2_654_435_761) >> 16) as u16) / 65536.0;
    let cell = |i: u32| Vec3::new((i % 100) as f32 + random(i), 0.0, (i / 100) as f32 + random(i + 7)) * 0.2;
    let level = |y: f32| (0..25_000).map(move |i| cell(i) - Vec3::new(10.0, y, 50.0));
    let points: Vec<Vec3> = level(0.0).chain(level(1.0)).collect();
    let eye = Vec3::new(0.0, 1.7, 0.0);
    let camera = Camera::look_at(eye, eye - Vec3::Z, Vec3::Y, 0.9, (1920, 1080), 0.1, 100.0).unwrap();
    let options = SplatOptions { radius: Radius::Same(0.12), slopes, ..SAME };
    let visible = visible_points(&points, &camera, &options).unwrap();
    [true, false].map(|floor| {
        let fits = |i: &usize| (*i < 25_000) == floor && camera.project(points[*i]).is_some();
        let of = (0..points.len()).filter(fits);
        of.clone().filter(|i| visible[*i] != floor).count() as f64 / of.count() as f64
    })
}

#[test]
fn slopes_keep_the_points_of_a_floor_seen_at_a_grazing_angle() {
    let [without, with] = [false, true].map(errors_of_floor);
    assert!(without[0] > 0.4 && without[1] < 0.01, "{without:?}");
    assert!(with[0] < 0.02 && with[1] < 0.02, "{with:?}");
}

/// A picture of a plane of which inverse depths rise by these on both axes, from 1/8 in the middle.
fn plane([x, y]: [f32; 2]) -> DepthImage {
    let depth = |i: usize| 1.0 / (0.125 + (i % 33) as f32 * x - 16.0 * x + (i / 33) as f32 * y - 16.0 * y);
    DepthImage { width: 33, depths: (0..33 * 33).map(depth).collect() }
}

#[test]
fn a_slope_is_what_a_plane_rises_within_half_a_square() {
    for slope in [[0.0, 0.0], [1e-3, 0.0], [-2e-3, 1e-3], [1e-3, 3e-3], [-1e-3, -1e-3]] {
        let (plane, both) = (plane(slope), slope[0].abs() + slope[1].abs());
        // In the middle, and at a corner, where each axis has one side.
        for (at, half) in [(16, 0), (16, 128), (16, 700), (0, 300), (32, 1000)] {
            let own = 1.0 / plane.depths[(33 * at + at) as usize];
            let expected = own - (half as f32 / 256.0 + 0.5) * both;
            let found = plane.slanted(at, at, half);
            assert!((found - expected).abs() < 1e-5, "{slope:?} {at} {half}: {found} {expected}");
        }
    }
    // The rim of a near thing, and a ridge, are no slopes.
    for rim in [|x: usize| if x < 16 { 2.0 } else { 8.0 }, |x: usize| 3.0 + x.abs_diff(16) as f32 / 100.0] {
        let depths = (0..33 * 33).map(|i| rim(i % 33)).collect();
        let image = DepthImage { width: 33, depths };
        assert_eq!(image.slanted(16, 16, 500), 1.0 / rim(16));
    }
}
