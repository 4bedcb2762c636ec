//! Directions of planes: sets that are spread evenly over a ball or a box, in frames in which the
//! mesh is about as large along all axes.

use glam::{DMat3, DQuat, DVec3};

/// Volume, middle and spread of the inside of a closed mesh.
pub(super) struct Moments {
    pub(super) volume: f64,
    pub(super) center: DVec3,
    /// The mean of the products of coordinates relative to the middle.
    spread: DMat3,
}

impl Moments {
    /// `None` if the mesh is flat or leaves the range of numbers.
    pub(super) fn of(triangles: impl Iterator<Item = [DVec3; 3]>) -> Option<Self> {
        let mut origin = None;
        let (mut volume, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
        for t in triangles {
            let origin = *origin.get_or_insert(t[0]);
            let [a, b, c] = t.map(|p| p - origin);
            // Six times the volume of the tetrahedron with the origin.
            let v = a.dot(b.cross(c));
            let sum = a + b + c;
            volume += v;
            first += sum * v;
            second += (outer(a) + outer(b) + outer(c) + outer(sum)) * v;
        }
        let middle = first / (4.0 * volume);
        let spread = second * (1.0 / (20.0 * volume)) - outer(middle);
        let center = origin? + middle;
        (center.is_finite() && spread.is_finite() && volume != 0.0).then_some(Self {
            volume: volume.abs() / 6.0,
            center,
            spread,
        })
    }
}

fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}

/// A frame and directions in it.
pub(super) struct Frame {
    /// From the frame to the space of the mesh.
    pub(super) axes: DMat3,
    pub(super) directions: Vec<DVec3>,
}

/// Turns of the directions that are tried.
const TURNS: [(f64, f64, f64); 2] = [(0.0, 0.0, 0.0), (0.3, 0.2, 0.1)];

/// The frames that are tried for a mesh with these corners.
pub(super) fn frames(moments: &Moments, corners: &[DVec3]) -> impl Iterator<Item = Frame> {
    let round = root(&moments.spread).into_iter().flat_map(|axes| {
        TURNS.into_iter().map(move |(x, y, z)| {
            let turn = DQuat::from_euler(glam::EulerRot::XYZ, x, y, z);
            Frame { axes, directions: round().into_iter().map(|d| turn * d).collect() }
        })
    });
    let half = corners.iter().map(|&p| (p - moments.center).abs()).fold(DVec3::ZERO, DVec3::max);
    let boxed =
        (half.min_element() > 0.0).then(|| Frame { axes: DMat3::from_diagonal(half), directions: boxed() });
    round.chain(boxed)
}

/// A lower triangular root of a symmetric matrix (Cholesky); `None` if it has none.
fn root(m: &DMat3) -> Option<DMat3> {
    let xx = m.x_axis.x.sqrt();
    let (xy, xz) = (m.x_axis.y / xx, m.x_axis.z / xx);
    let yy = (m.y_axis.y - xy * xy).sqrt();
    let yz = (m.y_axis.z - xy * xz) / yy;
    let zz = (m.z_axis.z - xz * xz - yz * yz).sqrt();
    let root = DMat3::from_cols(DVec3::new(xx, xy, xz), DVec3::new(0.0, yy, yz), DVec3::new(0.0, 0.0, zz));
    (root.is_finite() && xx > 0.0 && yy > 0.0 && zz > 0.0).then_some(root)
}

/// The normals of a truncated icosahedron: the corners of an icosahedron and of a dodecahedron.
fn round() -> Vec<DVec3> {
    let g = (1.0 + 5f64.sqrt()) * 0.5;
    let signs = [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)];
    let turned = |a: f64, b: f64| [DVec3::new(0.0, a, b), DVec3::new(a, b, 0.0), DVec3::new(b, 0.0, a)];
    let icosahedron = signs.into_iter().flat_map(|(s, t)| turned(s, t * g));
    let dodecahedron = signs.into_iter().flat_map(|(s, t)| turned(s * g, t / g));
    icosahedron.chain(dodecahedron).chain(cube()).map(DVec3::normalize).collect()
}

/// The corners of a cube.
fn cube() -> impl Iterator<Item = DVec3> {
    let sign = |i: u32, bit: u32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
    (0..8).map(move |i| DVec3::new(sign(i, 0), sign(i, 1), sign(i, 2)))
}

/// The directions of the faces, edges and corners of a cube.
fn boxed() -> Vec<DVec3> {
    let steps = || [-1.0, 0.0, 1.0].into_iter();
    let all = steps().flat_map(|x| steps().flat_map(move |y| steps().map(move |z| DVec3::new(x, y, z))));
    all.filter(|&d| d != DVec3::ZERO).map(DVec3::normalize).collect()
}
