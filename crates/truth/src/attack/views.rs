//! Views: as the library takes them, and as they truly are.

use casca::{Aabb, Error, Plane, View};
use glam::camera::rh::proj::{directx, opengl};
use glam::camera::rh::view::look_to_mat4;
use glam::{DMat3, DQuat, DVec3, DVec4, Mat4, Vec3};

use super::dice::{Dice, turned, way};
use crate::numeric::attack::{ALONG_PLANE, INSIDE, LAST_PLACE, NO_PLANE, THROUGH_EYE, WITHIN_TURN};

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Depth {
    /// 0 at the near plane, 1 at the far one.
    Usual,
    /// 1 at the near plane, 0 at the far one.
    Reversed,
    /// 0 at the near plane, without a far one.
    Infinite,
    /// -1 at the near plane, 1 at the far one.
    Gl,
}

/// What bounds a view.
#[derive(Debug, Clone, PartialEq)]
pub enum Limits {
    Around,
    /// Planes: a normal each, and how far behind the eye the plane is, in lengths of the normal.
    Planes(Vec<(Vec3, f32)>),
    /// A perspective matrix: height in radians, width over height, whether left and right change
    /// places, and whether the library is told the eye.
    Camera {
        fov: f32,
        aspect: f32,
        near: f32,
        far: f32,
        mirrored: bool,
        depth: Depth,
        exact: bool,
    },
    /// An orthographic matrix: half the height; `near` may be negative. It may be told at which end
    /// the rays start.
    Parallel {
        half: f32,
        aspect: f32,
        near: f32,
        far: f32,
        mirrored: bool,
        depth: Depth,
        told: bool,
    },
}

/// The other cameras that a view stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Roams {
    Not,
    /// The eye goes so far, and the camera turns by such an angle.
    Ball {
        reach: f32,
        turn: f32,
    },
    /// The eye is anywhere in a box with these halves of edges, and looks all round.
    Box(Vec3),
}

/// A view as it truly is.
#[derive(Debug, Clone)]
pub struct TrueView {
    pub eye: Option<DVec3>,
    pub layers: u64,
    direction: DVec3,
    /// Unit normals inwards, offsets, and whether the plane may cut off what is close to the eye.
    planes: Vec<(DVec3, f64, bool)>,
}

/// A straight line of sight, from where it enters the view.
#[derive(Debug, Clone, Copy)]
pub struct Sight {
    pub from: DVec3,
    pub to: DVec3,
}

fn perspective(fov: f32, aspect: f32, near: f32, far: f32, depth: Depth) -> Mat4 {
    match depth {
        Depth::Usual => directx::perspective(fov, aspect, near, far),
        Depth::Reversed => directx::perspective(fov, aspect, far, near),
        Depth::Infinite => directx::perspective_infinite(fov, aspect, near),
        Depth::Gl => opengl::perspective(fov, aspect, near, far),
    }
}

fn orthographic(half: f32, aspect: f32, near: f32, far: f32, depth: Depth) -> Mat4 {
    let across = half * aspect;
    match depth {
        Depth::Usual | Depth::Infinite => directx::orthographic(-across, across, -half, half, near, far),
        Depth::Reversed => directx::orthographic(-across, across, -half, half, far, near),
        Depth::Gl => opengl::orthographic(-across, across, -half, half, near, far),
    }
}

/// The view of an eye that looks along `forward`, for the library and as it truly is.
pub fn look(eye: Vec3, forward: Vec3, limits: &Limits) -> Result<(View, TrueView), Error> {
    let forward = forward.normalize_or(Vec3::X);
    let up = if forward.y.abs() > 0.9 { Vec3::Z } else { Vec3::Y };
    look_upright(eye, forward, up, limits)
}

/// As [`look`], for a direction of length 1, and with the direction that is up in the picture.
pub fn look_upright(eye: Vec3, forward: Vec3, up: Vec3, limits: &Limits) -> Result<(View, TrueView), Error> {
    let around = TrueView {
        eye: Some(eye.as_dvec3()),
        layers: u64::MAX,
        direction: forward.as_dvec3(),
        planes: Vec::new(),
    };
    let mirror = |mirrored: bool| Mat4::from_scale(Vec3::new(if mirrored { -1.0 } else { 1.0 }, 1.0, 1.0));
    match limits {
        Limits::Around => Ok((View::omnidirectional(eye)?, around)),
        Limits::Planes(planes) => {
            let planes: Vec<Plane> = planes
                .iter()
                .map(|&(normal, back)| Plane { normal, offset: back * normal.length() - normal.dot(eye) })
                .collect();
            let exact = |p: &Plane| {
                let n = p.normal.as_dvec3();
                let length = n.length();
                (n / length, f64::from(p.offset) / length, true)
            };
            let truth = TrueView { planes: planes.iter().map(exact).collect(), ..around };
            Ok((View::from_planes(eye, &planes)?, truth))
        }
        &Limits::Camera { fov, aspect, near, far, mirrored, depth, exact } => {
            let matrix = mirror(mirrored) * perspective(fov, aspect, near, far, depth);
            let matrix = matrix * look_to_mat4(eye, forward, up);
            let mut truth = TrueView { planes: planes_of(matrix, depth == Depth::Gl), ..around };
            if !exact || depth == Depth::Gl {
                truth.eye = eye_of(matrix);
            }
            let view = match (depth, exact) {
                (Depth::Gl, _) => View::from_view_projection_gl(matrix),
                (_, true) => View::perspective(eye, matrix),
                (_, false) => View::from_view_projection(matrix),
            };
            Ok((view?, truth))
        }
        &Limits::Parallel { half, aspect, near, far, mirrored, depth, told } => {
            let matrix = mirror(mirrored) * orthographic(half, aspect, near, far, depth);
            let matrix = matrix * look_to_mat4(eye, forward, up);
            let m = matrix.as_dmat4();
            let across = m.row(0).truncate().cross(m.row(1).truncate()).normalize_or_zero();
            let direction = across * across.dot(forward.as_dvec3()).signum();
            let planes = planes_of(matrix, depth == Depth::Gl);
            let view = match (depth, told) {
                (Depth::Gl, _) => View::from_view_projection_gl(matrix),
                (_, true) => View::orthographic(forward, matrix),
                (_, false) => View::from_view_projection(matrix),
            };
            Ok((view?, TrueView { eye: None, layers: u64::MAX, direction, planes }))
        }
    }
}

/// The eye that is as far as may be from another, in a direction.
pub fn outermost(eye: DVec3, way: DVec3, reach: f64) -> DVec3 {
    // Rounding may take it out by a little: some units in the last place are taken off, then more
    // and more.
    let shares =
        std::iter::once(1.0).chain((0..50).map(|i| 1.0 - LAST_PLACE * f64::from(1 << (i / 2)).powi(2)));
    let places = shares.map(|share| eye + way * (reach * share));
    places.into_iter().find(|at| (*at - eye).length() <= reach).unwrap_or(eye)
}

/// The planes of clip space, in world space.
fn planes_of(matrix: Mat4, gl: bool) -> Vec<(DVec3, f64, bool)> {
    let m = matrix.as_dmat4();
    let [x, y, z, w] = [m.row(0), m.row(1), m.row(2), m.row(3)];
    let near = if gl { w + z } else { z };
    let rows = [(w + x, x, false), (w - x, x, false), (w + y, y, false), (w - y, y, false)];
    let all = rows.into_iter().chain([(near, z, true), (w - z, z, true)]);
    all.filter_map(|(row, part, cuts): (DVec4, DVec4, bool)| {
        let length = row.truncate().length();
        let size = part.truncate().length() + w.truncate().length();
        (length > NO_PLANE * size).then(|| (row.truncate() / length, row.w / length, cuts))
    })
    .collect()
}

/// The eye of a perspective matrix.
fn eye_of(matrix: Mat4) -> Option<DVec3> {
    let m = matrix.as_dmat4();
    let [x, y, w] = [m.row(0), m.row(1), m.row(3)];
    let rows = DMat3::from_cols(x.truncate(), y.truncate(), w.truncate()).transpose();
    let eye = rows.inverse() * -DVec3::new(x.w, y.w, w.w);
    eye.is_finite().then_some(eye)
}

impl Roams {
    /// The view that stands for the cameras.
    pub fn open(self, view: View) -> Result<View, Error> {
        let eye = view.eye().unwrap_or_default();
        match self {
            Self::Not => Ok(view),
            Self::Ball { reach, turn } => view.with_reach(reach)?.with_turn(turn),
            Self::Box(half) => {
                let middle = eye.as_vec3();
                View::of_cell(Aabb::new(middle - half, middle + half))
            }
        }
    }

    /// One of the cameras, mostly an outermost one.
    pub fn camera(self, truth: &TrueView, dice: &mut Dice) -> TrueView {
        let Some(eye) = truth.eye else { return truth.clone() };
        let way = way(dice);
        match self {
            Self::Not => truth.clone(),
            Self::Ball { reach, turn } => {
                let share = if dice.once_in(3) { dice.real() } else { 1.0 };
                let turn = turned(dice, f64::from(turn) * WITHIN_TURN * share);
                truth.at(outermost(eye, way, f64::from(reach)), turn)
            }
            Self::Box(half) => {
                let (low, high) = (eye.as_vec3() - half, eye.as_vec3() + half);
                let far = (eye + way * half.as_dvec3() * 2.0).clamp(low.as_dvec3(), high.as_dvec3());
                truth.at(far, DQuat::IDENTITY)
            }
        }
    }
}

impl TrueView {
    /// The view of the same camera at another eye, turned about that.
    pub fn at(&self, eye: DVec3, turn: DQuat) -> Self {
        let old = self.eye.unwrap_or(eye);
        let moved = |&(n, h, cuts): &(DVec3, f64, bool)| {
            let normal = turn * n;
            (normal, n.dot(old) + h - normal.dot(eye), cuts)
        };
        Self { eye: Some(eye), planes: self.planes.iter().map(moved).collect(), ..*self }
    }

    /// What another eye sees of the half-spaces, which stay where they are and cut nothing off.
    pub fn from(&self, eye: DVec3) -> Self {
        let planes = self.planes.iter().map(|&(n, h, _)| (n, h, false)).collect();
        Self { eye: Some(eye), planes, ..*self }
    }

    /// The inward normals of the four sides of a camera's picture; fewer of other views.
    pub fn sides(&self) -> impl Iterator<Item = DVec3> {
        self.planes.iter().take(4).map(|p| p.0)
    }

    pub fn direction(&self) -> DVec3 {
        self.direction
    }

    /// From a point towards the viewer (of length 1), and how far that is.
    pub fn towards(&self, p: DVec3) -> (DVec3, f64) {
        match self.eye {
            Some(eye) => ((eye - p).normalize_or(DVec3::X), (eye - p).length()),
            None => (-self.direction, f64::INFINITY),
        }
    }

    /// The sight of a point that is surely in the view.
    pub fn sight(&self, p: DVec3) -> Option<Sight> {
        let reach = p.abs().max_element() + self.eye.map_or(0.0, |e| e.abs().max_element());
        let inside = |&(n, h, _): &(DVec3, f64, bool)| n.dot(p) + h > INSIDE * (reach + 1.0);
        if !self.planes.iter().all(inside) {
            return None;
        }
        match self.eye {
            Some(eye) => {
                let way = p - eye;
                if way.length() <= INSIDE * (reach + 1.0) {
                    return None;
                }
                let cut = |&(n, h, _): &(DVec3, f64, bool)| {
                    let behind = -(n.dot(eye) + h);
                    if behind > THROUGH_EYE * (reach + h.abs()) {
                        behind / (n.dot(p) + h + behind)
                    } else {
                        0.0
                    }
                };
                let cutting = self.planes.iter().filter(|p| p.2);
                Some(Sight { from: eye + way * cutting.map(cut).fold(0.0, f64::max), to: p })
            }
            None => {
                // From where the rays enter the half-spaces.
                let back = |&(n, h, _): &(DVec3, f64, bool)| (n.dot(p) + h) / n.dot(self.direction);
                let entered = |p: &&(DVec3, f64, bool)| p.0.dot(self.direction) > ALONG_PLANE;
                let far = self.planes.iter().filter(entered).map(back).fold(f64::INFINITY, f64::min);
                (far.is_finite() && far > 0.0).then(|| Sight { from: p - self.direction * far, to: p })
            }
        }
    }
}
