//! The part of a scene that a camera sees, and a second camera that has all of it in its picture.

use casca_scenes::world::Camera;
use glam::{DVec3, DVec4};

/// Polygons smaller than this share of the scene are rounding.
const FLAT: f64 = 1e-9;

/// A convex solid, as the polygons that bound it.
#[derive(Debug, Clone, Default)]
pub struct Solid {
    /// The corners of each polygon, in order around it.
    pub faces: Vec<Vec<DVec3>>,
}

impl Solid {
    /// A box.
    pub fn cuboid(min: DVec3, max: DVec3) -> Self {
        let corner =
            |bits: usize| DVec3::from_array(std::array::from_fn(|axis| [min, max][bits >> axis & 1][axis]));
        let sides = [[0, 2, 6, 4], [1, 3, 7, 5], [0, 1, 5, 4], [2, 3, 7, 6], [0, 1, 3, 2], [4, 5, 7, 6]];
        Self { faces: sides.iter().map(|side| side.map(corner).to_vec()).collect() }
    }

    /// The part of a box inside the frustum of a camera, as far as the far plane.
    pub fn seen(camera: &Camera, min: DVec3, max: DVec3) -> Self {
        let matrix = camera.view_projection().as_dmat4();
        let [x, y, z, w] = std::array::from_fn(|i| matrix.row(i));
        let mut solid = Self::cuboid(min, max);
        [w + x, w - x, w + y, w - y, w - z].into_iter().for_each(|plane| _ = solid.cut(plane));
        solid
    }

    /// Cuts off all that lies behind a plane: points `p` with `plane · (p, 1) < 0`. Returns the
    /// polygon in which the plane cuts the solid, if it does.
    pub fn cut(&mut self, plane: DVec4) -> Option<Vec<DVec3>> {
        let plane = plane / plane.truncate().length();
        if !plane.is_finite() {
            return None;
        }
        let mut section = Vec::new();
        for face in &mut self.faces {
            *face = clip(face, plane, &mut section);
        }
        self.faces.retain(|face| face.len() > 2);
        let section = around(section, plane.truncate())?;
        self.faces.push(section.clone());
        Some(section)
    }

    /// All corners; those of several polygons several times.
    pub fn corners(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.faces.iter().flatten().copied()
    }
}

/// The part of a polygon before a plane. The points where its border crosses the plane go to
/// `section`.
fn clip(face: &[DVec3], plane: DVec4, section: &mut Vec<DVec3>) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(face.len() + 1);
    for (i, &a) in face.iter().enumerate() {
        let b = face[(i + 1) % face.len()];
        let [before, after] = [a, b].map(|p| plane.dot(p.extend(1.0)));
        if before >= 0.0 {
            kept.push(a);
        }
        if (before >= 0.0) != (after >= 0.0) {
            let crossing = a.lerp(b, before / (before - after));
            kept.push(crossing);
            section.push(crossing);
        }
    }
    kept
}

/// The corners of a convex polygon in order around its middle; nothing if it has no area.
fn around(mut corners: Vec<DVec3>, normal: DVec3) -> Option<Vec<DVec3>> {
    let middle = corners.iter().sum::<DVec3>() / corners.len().max(1) as f64;
    let size = corners.iter().map(|p| p.distance(middle)).fold(0.0, f64::max);
    let first = (*corners.first()? - middle).normalize_or_zero();
    let second = normal.cross(first);
    let angle = |p: &DVec3| (*p - middle).dot(second).atan2((*p - middle).dot(first));
    corners.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    corners.dedup_by(|a, b| a.distance(*b) <= FLAT * size);
    (corners.len() > 2).then_some(corners)
}

/// Distances that are tried for a camera, and the factor from one to the next.
const TRIES: i32 = 1000;
const FARTHER: f64 = 1.02;

/// A camera that looks along `forward` to the middle of some points, as near as it can be with all of
/// them in its picture and some of this free, in shares at each side, and at the top and the bottom.
/// It sees things up to `reach` behind them. `forward` must not be vertical.
pub fn fitted(
    points: &[DVec3],
    forward: DVec3,
    (fov_y_degrees, aspect): (f32, f32),
    free: [f64; 2],
    reach: f64,
) -> Camera {
    let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let middle = if points.is_empty() { DVec3::ZERO } else { (low + high) * 0.5 };
    let at = |number: i32| {
        let distance = 0.01 * reach * FARTHER.powi(number);
        let eye = (middle - forward.normalize_or(DVec3::NEG_Z) * distance).as_vec3();
        let far = (2.0 * distance + 4.0 * reach) as f32;
        Camera::look_at(eye, eye + forward.as_vec3(), fov_y_degrees, aspect, 2e-3 * reach as f32, far)
    };
    let [across, up] = free.map(|share| 1.0 - 2.0 * share);
    let holds = |camera: &Camera| {
        let matrix = camera.view_projection().as_dmat4();
        points
            .iter()
            .map(|p| matrix * p.extend(1.0))
            .all(|c| c.x.abs() <= across * c.w && c.y.abs() <= up * c.w && c.z > 0.0 && c.z < c.w)
    };
    (0..TRIES).map(at).find(holds).unwrap_or_else(|| at(TRIES))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    const MIN: DVec3 = DVec3::ZERO;
    const MAX: DVec3 = DVec3::new(40.0, 4.0, 30.0);

    fn camera(eye: Vec3, target: Vec3) -> Camera {
        Camera::look_at(eye, target, 60.0, 1.6, 0.1, 500.0)
    }

    #[test]
    fn the_seen_part_of_a_box_lies_in_the_box_and_in_the_frustum() {
        for (eye, target) in [
            (Vec3::new(5.0, 2.0, 5.0), Vec3::new(30.0, 2.0, 20.0)),
            (Vec3::new(-9.0, 3.0, 8.0), Vec3::new(30.0, 1.0, 9.0)),
            (Vec3::new(20.0, 2.0, 15.0), Vec3::new(20.5, -1.0, 15.0)),
        ] {
            let camera = camera(eye, target);
            let seen = Solid::seen(&camera, MIN, MAX);
            assert!(seen.faces.len() >= 4);
            for p in seen.corners() {
                assert!((p - p.clamp(MIN, MAX)).length() < 1e-6, "{p} is outside the box");
                let c = camera.view_projection().as_dmat4() * p.extend(1.0);
                assert!(c.x.abs() <= c.w + 1e-6 && c.y.abs() <= c.w + 1e-6, "{p} is outside the frustum");
            }
        }
    }

    #[test]
    fn a_cut_halves_a_box_and_leaves_the_section() {
        let mut solid = Solid::cuboid(MIN, MAX);
        let section = solid.cut(DVec4::new(-2.0, 0.0, 0.0, 40.0)).unwrap();
        assert_eq!((section.len(), solid.faces.len()), (4, 6));
        assert!(section.iter().all(|p| (p.x - 20.0).abs() < 1e-9));
        assert!(solid.corners().all(|p| p.x <= 20.0 + 1e-9));
        assert!(solid.cut(DVec4::new(0.0, 1.0, 0.0, 9.0)).is_none(), "nothing is cut off");
        solid.cut(DVec4::new(0.0, -1.0, 0.0, -9.0));
        assert!(solid.faces.is_empty(), "nothing is left");
        assert!(solid.cut(DVec4::ZERO).is_none());
    }

    #[test]
    fn a_fitted_camera_has_all_points_inside_and_no_more_room_than_it_must() {
        let seen = Solid::seen(&camera(Vec3::new(5.0, 2.0, 5.0), Vec3::new(30.0, 2.0, 20.0)), MIN, MAX);
        let frustum: Vec<DVec3> = seen.corners().collect();
        let whole: Vec<DVec3> = Solid::cuboid(MIN, MAX).corners().collect();
        for points in [frustum, whole, vec![DVec3::new(7.0, 1.0, 3.0)]] {
            for forward in [DVec3::new(0.0, -1.0, -0.7), DVec3::new(3.0, -9.0, 1.0), DVec3::X] {
                for lens in [(60.0, 1.6), (40.0, 0.5)] {
                    let matrix = fitted(&points, forward, lens, [0.05, 0.1], 50.0).view_projection();
                    let places: Vec<DVec3> =
                        points.iter().map(|p| matrix.as_dmat4().project_point3(*p)).collect();
                    let inside = |p: &DVec3| p.x.abs() < 0.901 && p.y.abs() < 0.801 && p.z > 0.0 && p.z < 1.0;
                    assert!(places.iter().all(inside), "{forward} {lens:?} {places:?}");
                    let touches = |p: &DVec3| p.x.abs() > 0.8 || p.y.abs() > 0.7;
                    assert!(points.len() == 1 || places.iter().any(touches), "it could be nearer");
                }
            }
        }
    }
}
