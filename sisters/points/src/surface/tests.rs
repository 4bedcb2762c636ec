use super::*;
use crate::samples::sphere;
use casca_truth::cases;
use glam::Vec3;
use proptest::prelude::*;

/// Points of a rectangle about one unit apart, moved a little by a rule, with a normal.
fn rectangle(corner: Vec3, u: Vec3, v: Vec3, normal: Vec3) -> (Vec<Vec3>, Vec<Vec3>) {
    let (columns, rows) = (u.length() as usize, v.length() as usize);
    let at = |i: usize| {
        // The golden ratio spreads the shifts evenly.
        let shift = |k: f32| 0.5 + 0.3 * ((i as f32 * k).fract() - 0.5);
        let (x, y) = ((i % columns) as f32 + shift(0.618_034), (i / columns) as f32 + shift(0.754_877));
        corner + u.normalize() * x + v.normalize() * y
    };
    ((0..columns * rows).map(at).collect(), vec![normal; columns * rows])
}

fn join(parts: Vec<(Vec<Vec3>, Vec<Vec3>)>) -> PointCloud {
    let (positions, normals): (Vec<_>, Vec<_>) = parts.into_iter().unzip();
    PointCloud { positions: positions.concat(), normals: normals.concat(), ..Default::default() }
}

/// A box of 24 x 24 x `thick` units with its middle at zero.
fn plate(thick: f32) -> PointCloud {
    let half = Vec3::new(12.0, 12.0, thick / 2.0);
    let mut parts = Vec::new();
    for axis in 0..3 {
        for side in [-1.0_f32, 1.0] {
            let (mut n, mut u, mut v) = (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
            n[axis] = side;
            u[(axis + 1) % 3] = 2.0 * half[(axis + 1) % 3];
            v[(axis + 2) % 3] = 2.0 * half[(axis + 2) % 3];
            if u.length() >= 1.0 && v.length() >= 1.0 {
                parts.push(rectangle(n * half - u / 2.0 - v / 2.0, u, v, n));
            }
        }
    }
    join(parts)
}

/// Both kinds of errors over the truly visible points.
fn errors(cloud: &PointCloud, eye: DVec3, truth: impl Fn(usize) -> bool) -> f64 {
    let found = visible(cloud, eye).unwrap();
    let wrong = (0..cloud.len()).filter(|&i| found[i] != truth(i)).count();
    wrong as f64 / (0..cloud.len()).filter(|&i| truth(i)).count() as f64
}

/// Whether each point of a closed and convex body faces an eye.
fn facing(cloud: &PointCloud, eye: DVec3) -> impl Fn(usize) -> bool {
    move |i| cloud.normals[i].as_dvec3().dot(eye - cloud.positions[i].as_dvec3()) > 0.0
}

const BESIDE_BALL: DVec3 = DVec3::new(1.0, 3.0, 2.0);

fn ball(count: usize) -> PointCloud {
    let normals: Vec<Vec3> = sphere(count).iter().map(|p| p.as_vec3()).collect();
    PointCloud { positions: normals.clone(), normals, ..Default::default() }
}

fn bare(cloud: &PointCloud) -> PointCloud {
    PointCloud { normals: Vec::new(), ..cloud.clone() }
}

#[test]
fn the_far_sides_of_boxes_are_hidden() {
    // A thick box, and one whose sides are nearer to each other than its points; spheres, where
    // estimates are wrong in a band along the limb: four times the points halve its share.
    let cases = [
        (plate(24.0), DVec3::new(60.0, 45.0, 70.0), [0.01, 0.02]),
        (plate(0.6), DVec3::new(60.0, 45.0, 70.0), [0.01, 0.03]),
        (ball(4000), BESIDE_BALL, [0.01, 0.05]),
        (ball(16_000), BESIDE_BALL, [0.01, 0.03]),
    ];
    for (cloud, eye, most) in cases {
        let found = [&cloud, &bare(&cloud)].map(|given| errors(given, eye, facing(&cloud, eye)));
        assert!(found[0] < most[0] && found[1] < most[1], "{} points: {found:?}", cloud.len());
    }
}

/// A ball with other normals.
fn ball_with(normal: impl Fn(usize, Vec3) -> Vec3) -> PointCloud {
    let ball = ball(4000);
    let normals = ball.positions.iter().enumerate().map(|(i, &p)| normal(i, p)).collect();
    PointCloud { normals, ..ball }
}

#[test]
fn void_normals_are_estimated_and_others_are_used_whatever_their_length() {
    let ball = ball(4000);
    let [whole, none] = [&ball, &bare(&ball)].map(|cloud| visible(cloud, BESIDE_BALL).unwrap());
    for void in [Vec3::ZERO, Vec3::splat(f32::NAN), Vec3::new(0.0, f32::NEG_INFINITY, 1.0)] {
        assert_eq!(visible(&ball_with(|_, _| void), BESIDE_BALL).unwrap(), none, "all are {void}");
        for every in [2, 7, 100] {
            let some = ball_with(|i, p| if i % every == 0 { void } else { p });
            let wrong = errors(&some, BESIDE_BALL, facing(&ball, BESIDE_BALL));
            assert!(wrong < 0.04, "{wrong} wrong, every {every}th is {void}");
        }
    }
    for length in [1e-40, 1e-30, 0.2, 3.0, f32::MAX] {
        let found = visible(&ball_with(|_, p| p * length), BESIDE_BALL).unwrap();
        assert!((found ^ &whole).count_ones() < 5, "{length}");
    }
}

#[test]
fn a_point_takes_44_bytes() {
    let ball = ball(16_000);
    let bytes = Surface::new(&ball).unwrap().bytes();
    assert!(bytes <= 44 * ball.len(), "{bytes}");
}

#[test]
fn a_sheet_is_seen_from_both_sides() {
    let sheet = join(vec![rectangle(Vec3::ZERO, Vec3::X * 30.0, Vec3::Y * 30.0, Vec3::Z)]);
    for z in [40.0, -40.0] {
        assert!(visible(&sheet, DVec3::new(3.0, 25.0, z)).unwrap().all(), "{z}");
        assert!(visible(&bare(&sheet), DVec3::new(3.0, 25.0, z)).unwrap().all(), "{z}");
    }
}

#[test]
fn a_room_is_seen_from_within() {
    let mut room = plate(24.0);
    room.normals.iter_mut().for_each(|n| *n = -*n);
    let eye = DVec3::new(3.0, -2.0, 5.0);
    assert!(errors(&room, eye, |_| true) < 0.005);
    assert!(errors(&bare(&room), eye, |_| true) < 0.005);
}

#[test]
fn a_near_sheet_hides_what_is_behind_it_and_nothing_beside() {
    let near = rectangle(Vec3::new(-10.0, -10.0, 20.0), Vec3::X * 20.0, Vec3::Y * 20.0, Vec3::Z);
    let far = rectangle(Vec3::new(-30.0, -30.0, 0.0), Vec3::X * 60.0, Vec3::Y * 60.0, Vec3::Z);
    let cloud = bare(&join(vec![near, far]));
    // The shadow is twice as large.
    let truth = |i: usize| {
        let p = cloud.positions[i];
        p.z > 10.0 || p.x.abs().max(p.y.abs()) > 20.0
    };
    let found = errors(&cloud, DVec3::new(0.0, 0.0, 40.0), truth);
    assert!(found < 0.03, "{found}");
}

/// A board of 12 x 20 x 0.5 units, and how many of its points are on its two faces: those of the
/// rim are two units apart.
fn board() -> (PointCloud, usize) {
    let (wide, high, thick) = (Vec3::X * 12.0, Vec3::Y * 20.0, Vec3::Z * 0.5);
    let mut parts =
        vec![rectangle(Vec3::ZERO, wide, high, Vec3::Z), rectangle(-thick, wide, high, Vec3::NEG_Z)];
    let faces = parts.iter().map(|part| part.0.len()).sum();
    let sides = [
        (Vec3::ZERO, high, Vec3::NEG_X),
        (wide, high, Vec3::X),
        (Vec3::ZERO, wide, Vec3::NEG_Y),
        (high, wide, Vec3::Y),
    ];
    for (corner, along, normal) in sides {
        let count = along.length() as usize / 2;
        let at = |i: usize| {
            let depth = Vec3::Z * (0.15 + 0.1 * (i % 3) as f32);
            corner - depth + along * ((i as f32 + 0.5) / count as f32)
        };
        parts.push(((0..count).map(at).collect(), vec![normal; count]));
    }
    (join(parts), faces)
}

#[test]
fn points_of_narrow_rims_face_outwards() {
    let (cloud, faces) = board();
    let surface = Surface::new(&bare(&cloud)).unwrap();
    let normals: Vec<Vec3> = surface.normals().collect();
    let right = (faces..cloud.len()).filter(|&i| normals[i].dot(cloud.normals[i]) > 0.9).count();
    assert!(10 * right >= 9 * (cloud.len() - faces), "{right} of {}", cloud.len() - faces);
    let eye = DVec3::new(60.0, 50.0, 30.0);
    let (found, truth) = (surface.visible(eye).unwrap(), facing(&cloud, eye));
    let wrong = (0..cloud.len()).filter(|&i| found[i] != truth(i)).count();
    assert!(wrong <= 8, "{wrong} wrong");
}

#[test]
fn narrow_gaps_between_planks_stay_open() {
    // Planks two units wide and 0.6 thick with gaps of one unit, and a wall far behind them.
    let size = [Vec3::X * 2.0, Vec3::Y * 30.0];
    let mut parts = vec![rectangle(Vec3::Z * -30.0, Vec3::X * 36.0, Vec3::Y * 30.0, Vec3::Z)];
    for plank in 0..12 {
        let left = Vec3::X * (3 * plank) as f32;
        parts.push(rectangle(left, size[0], size[1], Vec3::Z));
        parts.push(rectangle(left - Vec3::Z * 0.6, size[0], size[1], Vec3::NEG_Z));
        for (x, normal) in [(0.0, Vec3::NEG_X), (2.0, Vec3::X)] {
            let at = |i: usize| left + Vec3::new(x, (i as f32 + 0.5) / 0.6, -0.1 - 0.4 * (i % 2) as f32);
            parts.push(((0..18).map(at).collect(), vec![normal; 18]));
        }
    }
    let cloud = join(parts);
    let eye = DVec3::new(18.0, 15.0, 300.0);
    let found = visible(&cloud, eye).unwrap();
    let [mut seen, mut lost, mut shown] = [0.0; 3];
    for (p, found) in cloud.positions.iter().zip(&found).filter(|(p, _)| p.z == -30.0) {
        // Where the ray passes the fronts and the backs of the planks.
        let at = |z: f64| (eye + (p.as_dvec3() - eye) * ((eye.z - z) / (eye.z + 30.0))).x;
        let open = [at(0.0), at(-0.6)].iter().all(|x| x.rem_euclid(3.0) > 2.0);
        seen += f64::from(u8::from(open));
        lost += f64::from(u8::from(open && !*found));
        shown += f64::from(u8::from(!open && *found));
    }
    assert!(lost < 0.01 * seen && shown < 0.01 * seen, "{lost} lost and {shown} shown of {seen}");
}

#[test]
fn the_answer_moves_with_the_cloud() {
    let cloud = plate(6.0);
    let eye = DVec3::new(50.0, 20.0, 30.0);
    let here = visible(&cloud, eye).unwrap();
    let shift = DVec3::new(4e6, -5e6, 3e5);
    let there = PointCloud { origin: shift, ..cloud.clone() };
    assert_eq!(visible(&there, eye + shift).unwrap(), here);
    for scale in [1e-30_f32, 1e30] {
        // Rounding moves points a little, so that a few answers may change.
        let scaled = cloud.positions.iter().map(|&p| p * scale).collect();
        let found =
            visible(&PointCloud { positions: scaled, ..cloud.clone() }, eye * f64::from(scale)).unwrap();
        assert!((found ^ &here).count_ones() < 5, "{scale}");
    }
    let far = visible(&cloud, eye * 1e9).unwrap();
    assert!((far ^ &visible(&cloud, eye * 1e3).unwrap()).count_ones() < 20);
}

#[test]
fn strays_hide_nothing_and_are_shown_or_not() {
    // A wall of one unit a point, and points of the air before it: some alone, some in threes.
    let part = rectangle(Vec3::new(-30.0, -30.0, 0.0), Vec3::X * 60.0, Vec3::Y * 60.0, Vec3::Z);
    let wall = part.0.len();
    // Multiples of roots spread them, and on no surface.
    let at = |i: usize| Vec3::new(0.414, 0.732, 0.236) * (i as f32 + 1.0);
    let place = |i: usize| (at(i).fract() - 0.5) * Vec3::new(36.0, 36.0, 16.0) + Vec3::Z * 18.0;
    let alone: Vec<Vec3> = (0..40).map(place).collect();
    let group = |p: &Vec3| [*p, *p + Vec3::new(0.3, 0.1, -0.2), *p + Vec3::new(-0.1, 0.2, 0.3)];
    let air: Vec<Vec3> = alone[..30].iter().copied().chain(alone[30..].iter().flat_map(group)).collect();
    let normals = vec![Vec3::Z; air.len()];
    let cloud = join(vec![part, (air, normals)]);
    let eye = DVec3::new(1.0, 2.0, 90.0);
    for cloud in [bare(&cloud), cloud] {
        let surface = Surface::new(&cloud).unwrap();
        let strays = surface.strays();
        let found = strays[wall..].count_ones();
        assert!(!strays[..wall].any() && 10 * found >= 9 * (cloud.len() - wall), "{found} found");
        let (shown, not) = (surface.visible(eye).unwrap(), surface.clone().with_strays(false));
        assert!(shown[..wall].count_zeros() < 36, "{} hidden", shown[..wall].count_zeros());
        assert_eq!(not.visible(eye).unwrap(), shown & !strays);
        // The wall hides them.
        assert!(!surface.visible(-eye).unwrap()[wall..].any());
    }
}

#[test]
fn a_thin_board_has_no_strays_and_hides() {
    let (mut cloud, _) = board();
    let count = cloud.len();
    let eye = DVec3::new(6.0, 10.0, 60.0);
    let behind = rectangle(Vec3::new(2.0, 2.0, -20.0), Vec3::X * 8.0, Vec3::Y * 16.0, Vec3::Z);
    cloud = join(vec![(cloud.positions, cloud.normals), behind]);
    for cloud in [bare(&cloud), cloud] {
        let surface = Surface::new(&cloud).unwrap();
        let strays = surface.strays().count_ones();
        let seen = surface.visible(eye).unwrap()[count..].count_ones();
        assert!(strays == 0 && seen == 0, "{strays} strays, {seen} seen through the board");
    }
}

#[test]
fn noise_and_steps_hide_nothing_where_a_scan_is_dense() {
    // A wall at a distance of 8 from a scanner that moves points by 0.03 towards itself or away, and from one
    // that rounds ranges.
    for step in [0.0, 0.1] {
        let at = |i: usize| {
            let (y, x) = (i as f32 * 2.399_963).sin_cos();
            let far = 16.0 * (i as f32 / 6000.0).powi(2);
            let noise = 0.06 * ((i as f32 * 0.618_034).fract() - 0.5);
            let place = Vec3::new(x * far, y * far, 8.0);
            let range = place.length() * (1.0 + noise / 8.0);
            place.normalize() * if step > 0.0 { (range / step).round() * step } else { range }
        };
        let cloud = PointCloud { positions: (0..6000).map(at).collect(), ..Default::default() };
        let found = visible(&cloud, DVec3::new(1.0, 0.0, 0.0)).unwrap().count_zeros();
        assert!(found < 300, "{found} of 6000 hidden, steps of {step}");
    }
}

#[test]
fn bad_input_is_an_error() {
    let cloud = PointCloud { positions: vec![Vec3::ZERO, Vec3::NAN], ..Default::default() };
    assert_eq!(Surface::new(&cloud).unwrap_err(), SurfaceError::PointNotFinite { index: 1 });
    let cloud = PointCloud { positions: vec![Vec3::ZERO], normals: vec![Vec3::X; 2], ..Default::default() };
    assert!(matches!(Surface::new(&cloud), Err(SurfaceError::Length(_))));
    let one = PointCloud { positions: vec![Vec3::ZERO], ..Default::default() };
    assert_eq!(visible(&one, DVec3::NAN), Err(SurfaceError::EyeNotFinite));
    assert!(visible(&one, DVec3::ZERO).unwrap().all());
    assert!(visible(&PointCloud::default(), DVec3::X).unwrap().is_empty());
    // The cloud is made larger by so much that the eye's place is infinite there.
    let tiny = PointCloud { positions: [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| p * 1e-40).into(), ..one };
    assert!(visible(&tiny, DVec3::new(0.0, f64::MAX, f64::MAX)).unwrap().any());
}

proptest! {
    #![proptest_config(cases(200))]

    /// Flat, collinear, equal and wild points and normals make no panic, and points at one place
    /// have one answer.
    #[test]
    fn no_cloud_is_refused_but_by_an_error(
        points in prop::collection::vec(prop::array::uniform3(prop_oneof![-3..3_i8, -120..120_i8]), 0..80),
        scale in prop_oneof![Just(1.0), Just(1e-40), Just(2e36_f32)],
        normals in any::<bool>(),
        eye in prop::array::uniform3(prop_oneof![
            4 => (-3..3_i8).prop_map(f64::from),
            4 => -3.0..3.0_f64,
            1 => Just(f64::MAX),
        ]),
    ) {
        let positions: Vec<Vec3> = points.iter().map(|p| Vec3::from(p.map(f32::from)) * scale).collect();
        let odd = [Vec3::X, Vec3::ZERO, Vec3::splat(f32::NAN), Vec3::Y * f32::MAX];
        let normals = if normals { (0..points.len()).map(|i| odd[i % 4]).collect() } else { Vec::new() };
        let cloud = PointCloud { positions, normals, ..Default::default() };
        let found = visible(&cloud, DVec3::from(eye)).unwrap();
        prop_assert_eq!(found.len(), cloud.len());
        for i in 0..cloud.len() {
            for j in 0..i {
                prop_assert!(cloud.positions[i] != cloud.positions[j] || found[i] == found[j]);
            }
        }
    }
}
