//! Centring, and two radii.

use glam::{DMat3, DVec3, Vec3};

use super::types::{Vertex, check_vertices};
use crate::error::Error;
use crate::numeric::OUTSIDE_BALL;

/// Where a mesh was, and how large it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placing {
    /// The centre of the box around the vertices, before centring: add it to get the old positions.
    pub center: Vec3,
    /// Half the diagonal of that box. The thesis calls it the radius of the smallest enclosing
    /// sphere, which it is for a box only.
    pub aabb_radius: f32,
    /// The centre of the smallest enclosing ball, after centring.
    pub ball_center: Vec3,
    /// The radius of the smallest enclosing ball; all vertices lie within it.
    pub ball_radius: f32,
}

/// Moves the middle of the box around all vertices to the origin (thesis, algorithm 1), and
/// measures the mesh. Lookups by direction ([`crate::maps`]) need that; strands do not. Costs a few
/// passes.
///
/// # Errors
/// Refuses no vertices, and coordinates that are not finite or above 1e9.
pub fn center(vertices: &mut [Vertex]) -> Result<Placing, Error> {
    check_vertices(vertices)?;
    let all = vertices.iter().map(|v| v.position.as_dvec3());
    let Some((lo, hi)) = all.map(|p| (p, p)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))) else {
        return Err(Error::Empty);
    };
    let middle = ((lo + hi) * 0.5).as_vec3();
    for v in &mut *vertices {
        v.position -= middle;
    }
    let points: Vec<DVec3> = vertices.iter().map(|v| v.position.as_dvec3()).collect();
    let (ball, _) = smallest_ball(&points);
    let ball_center = ball.as_vec3();
    let farthest = points.iter().map(|p| p.distance(ball_center.as_dvec3())).fold(0.0, f64::max);
    Ok(Placing {
        center: middle,
        aabb_radius: ((hi - lo).length() * 0.5) as f32,
        ball_center,
        ball_radius: (farthest as f32).next_up(),
    })
}

/// The smallest ball around points: the farthest point outside joins the support, the smallest ball
/// of that (at most five points) is found by trying all subsets, and so on. The radius grows with
/// each step, so that it ends; ten steps are usual.
fn smallest_ball(points: &[DVec3]) -> (DVec3, f64) {
    let mut support = vec![points[0]];
    let mut ball = (points[0], 0.0);
    // Far more than any mesh needs; the caller measures the radius anew.
    for _ in 0..1000 {
        let far = |p: &&DVec3| p.distance_squared(ball.0);
        let Some(&farthest) = points.iter().max_by(|a, b| far(a).total_cmp(&far(b))) else { break };
        if farthest.distance(ball.0) <= ball.1 * (1.0 + OUTSIDE_BALL) {
            break;
        }
        support.push(farthest);
        let Some((next, kept)) = ball_of_few(&support) else { break };
        if next.1 <= ball.1 {
            break;
        }
        (ball, support) = (next, kept);
    }
    ball
}

/// The smallest ball of at most five points, and those on its surface that carry it.
fn ball_of_few(points: &[DVec3]) -> Option<((DVec3, f64), Vec<DVec3>)> {
    let subsets = (1_u32..1 << points.len()).filter(|s| (2..=4).contains(&s.count_ones()));
    let balls = subsets.filter_map(|subset| {
        let on: Vec<DVec3> = (0..points.len()).filter(|i| subset >> i & 1 == 1).map(|i| points[i]).collect();
        let center = circumcenter(&on)?;
        let radius = on.iter().map(|p| p.distance(center)).fold(0.0, f64::max);
        let inside = points.iter().all(|p| p.distance(center) <= radius * (1.0 + OUTSIDE_BALL));
        (inside && radius.is_finite()).then_some(((center, radius), on))
    });
    balls.min_by(|a, b| a.0.1.total_cmp(&b.0.1))
}

/// The point of the flat through two to four points that is as far from each.
fn circumcenter(on: &[DVec3]) -> Option<DVec3> {
    let edge = |i: usize| on[i] - on[0];
    let offset = match on.len() {
        2 => edge(1) * 0.5,
        3 => {
            let (a, b) = (edge(1), edge(2));
            let n = a.cross(b);
            (b.length_squared() * n.cross(a) - a.length_squared() * n.cross(b)) / (2.0 * n.length_squared())
        }
        _ => {
            let rows = DMat3::from_cols(edge(1), edge(2), edge(3)).transpose();
            let squares =
                DVec3::new(edge(1).length_squared(), edge(2).length_squared(), edge(3).length_squared());
            if rows.determinant() == 0.0 {
                return None;
            }
            rows.inverse() * squares * 0.5
        }
    };
    offset.is_finite().then_some(on[0] + offset)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::{cube, dice, torus};

    #[test]
    fn the_radii_of_the_thesis() {
        let mut soup = cube(10.0);
        soup.iter_mut().for_each(|v| v.position += Vec3::new(3.0, -2.0, 7.0));
        let placing = center(&mut soup).unwrap();
        assert_eq!(placing.center, Vec3::new(3.0, -2.0, 7.0));
        // Table 7.1: 8.66.
        assert!((placing.aabb_radius - 75f32.sqrt()).abs() < 1e-5);
        assert!((placing.ball_radius - 75f32.sqrt()).abs() < 1e-5);
        // Half the diagonal of its box is not the radius of a torus.
        let placing = center(&mut torus(2.0, 0.7, 24, 8)).unwrap();
        assert!((placing.ball_radius - 2.7).abs() < 1e-5, "{placing:?}");
        assert!((placing.aabb_radius - 3.882).abs() < 1e-3, "{placing:?}");
    }

    #[test]
    fn balls_contain_all_points_and_are_no_larger_than_needed() {
        let mut random = dice(5);
        for case in 0..200 {
            let count = 1 + case % 40;
            let mut points: Vec<Vertex> = (0..count).map(|_| Vertex::at(random.point())).collect();
            if case % 3 == 0 {
                points.iter_mut().for_each(|v| v.position.z = 0.25 * v.position.x);
            }
            let placing = center(&mut points).unwrap();
            let away = |c: Vec3| points.iter().map(|v| v.position.distance(c)).fold(0.0, f32::max);
            assert!(away(placing.ball_center) <= placing.ball_radius);
            for _ in 0..20 {
                let other = placing.ball_center + random.point() * 0.02;
                assert!(away(other) >= placing.ball_radius * (1.0 - 1e-5), "case {case}");
            }
        }
    }

    #[test]
    fn refuses_no_points_and_points_that_are_not_finite() {
        assert_eq!(center(&mut []), Err(Error::Empty));
        for x in [f32::NAN, f32::INFINITY, 1e10] {
            assert!(matches!(center(&mut [Vertex::at(Vec3::new(0.0, x, 0.0))]), Err(Error::Vertex { .. })));
        }
        let point = center(&mut [Vertex::at(Vec3::ONE); 4]).unwrap();
        assert!(point.ball_radius < 1e-30 && point.aabb_radius == 0.0);
    }
}
