//! The strands of a mesh, one by one.

use glam::{DVec3, IVec3, Vec3};

use super::fur::Fur;
use crate::error::Error;
use crate::mesh::Mesh;
use crate::numeric::{HALF_SLAB, MAX_COORDINATE, MAX_EDGE_CELLS, MAX_STRANDS, ON_EDGE, SAME_FOOT, SETTLED};

/// A strand of fur on a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Root {
    /// Where it stands, on the base mesh.
    pub position: Vec3,
    /// The unit normal there: the strand's direction at its root.
    pub direction: Vec3,
    /// How high it reaches, as a share of [`Fur::height`]: 0 to 1.
    pub share: f32,
    /// Its random byte, for its colour.
    pub id: u32,
    /// The colour of the coat at its root.
    pub color: Vec3,
}

impl Root {
    /// Its length before it bends, in units.
    pub fn length(&self, fur: &Fur) -> f32 {
        fur.height * self.share
    }

    /// The middle of the strand at a place along it: 0 is the root, 1 the tip.
    pub fn point(&self, fur: &Fur, along: f32) -> Vec3 {
        let height = self.share * along;
        fur.extruded(self.position, self.direction, height) + self.aside(fur, height)
    }

    /// How far its tuft takes it along the skin at a height.
    fn aside(&self, fur: &Fur, height: f32) -> Vec3 {
        // The place on the skin whose sway leads there: ways change by less than their length.
        (0..SWAYS).fold(Vec3::ZERO, |aside, _| {
            let [way, _] = fur.sway(self.position + aside, height);
            (way - self.direction * way.dot(self.direction)) * fur.height
        })
    }

    /// The fur as it is bent at a height of this strand.
    pub fn bent(&self, fur: &Fur, height: f32) -> Fur {
        let [_, bend] = fur.sway(self.position + self.aside(fur, height), height);
        Fur { bend: fur.bend + bend, ..*fur }
    }
}

/// One point of a cell, and where its foot is on a triangle.
struct Foot {
    cell: IVec3,
    k: u32,
    position: DVec3,
    root: Root,
}

/// All strands of a mesh, in the order of their cells. Normals are interpolated within triangles,
/// as shaders do it; vertices without normals have no fur. Costs about the cells that the surface
/// touches.
///
/// # Errors
/// Refuses parameters out of range, and more than 16,777,216 strands.
pub fn roots(mesh: &Mesh, fur: &Fur) -> Result<Vec<Root>, Error> {
    let magnitude = mesh.vertices().iter().map(|v| v.position.abs().max_element()).fold(0.0, f32::max);
    fur.check(magnitude.min(MAX_COORDINATE))?;
    let estimate = mesh.area() * fur.strands_per_area();
    if estimate > MAX_STRANDS as f64 {
        return Err(Error::TooMany { what: "strands", count: estimate, max: MAX_STRANDS });
    }
    let at = |v: u32| mesh.vertices()[v as usize].position.as_dvec3();
    let edges = |t: &[u32; 3]| (0..3).map(|i| at(t[i]).distance(at(t[(i + 1) % 3]))).sum::<f64>();
    let lines = mesh.triangles().iter().map(edges).sum::<f64>() / f64::from(fur.spacing);
    if lines > MAX_EDGE_CELLS {
        return Err(Error::TooMany { what: "cells along edges", count: lines, max: MAX_EDGE_CELLS as usize });
    }
    let mut feet = Vec::new();
    for triangle in 0..mesh.triangles().len() {
        if let Some(patch) = Patch::new(mesh, fur, triangle) {
            patch.visit(patch.lo, patch.hi, &mut feet);
        }
    }
    // A point above an edge has a foot on both triangles.
    feet.sort_by_key(|f| (f.cell.to_array(), f.k));
    let near = SAME_FOOT * f64::from(fur.spacing);
    let mut roots = Vec::with_capacity(feet.len());
    for same in feet.chunk_by(|a, b| a.cell == b.cell && a.k == b.k) {
        for (i, foot) in same.iter().enumerate() {
            if same[..i].iter().all(|other| other.position.distance(foot.position) > near) {
                roots.push(foot.root);
            }
        }
    }
    Ok(roots)
}

/// A triangle with its normals, in units of cells.
struct Patch<'a> {
    mesh: &'a Mesh,
    fur: &'a Fur,
    corners: [u32; 3],
    origin: DVec3,
    edges: [DVec3; 2],
    /// The unit normal of the plane.
    plane: DVec3,
    normals: [DVec3; 3],
    /// The cells that may hold roots, both included.
    lo: IVec3,
    hi: IVec3,
}

/// How often the place whose sway leads to a strand is improved. Each step halves its error.
const SWAYS: usize = 8;

/// Boxes of at most so many cells along each edge are searched cell by cell.
const SMALL: i32 = 3;

/// How often a foot is improved. Each step gains the factor of the slab's thickness to the radius
/// of curvature.
const STEPS: usize = 12;

impl<'a> Patch<'a> {
    fn new(mesh: &'a Mesh, fur: &'a Fur, triangle: usize) -> Option<Self> {
        let corners = mesh.triangles()[triangle];
        let [a, b, c] =
            corners.map(|v| mesh.vertices()[v as usize].position.as_dvec3() / f64::from(fur.spacing));
        let plane = (b - a).cross(c - a).try_normalize()?;
        let normals = corners.map(|v| mesh.vertices()[v as usize].normal.as_dvec3());
        let slab = DVec3::splat(f64::from(HALF_SLAB));
        Some(Self {
            mesh,
            fur,
            corners,
            origin: a,
            edges: [b - a, c - a],
            plane,
            normals,
            lo: (a.min(b).min(c) - slab).floor().as_ivec3(),
            hi: (a.max(b).max(c) + slab).floor().as_ivec3(),
        })
    }

    /// Finds the roots in a box of cells; parts of it away from the triangle are skipped.
    fn visit(&self, lo: IVec3, hi: IVec3, out: &mut Vec<Foot>) {
        let size = hi - lo + 1;
        let half = size.as_dvec3() * 0.5;
        let middle = lo.as_dvec3() + half;
        let beyond =
            |from: DVec3, way: DVec3| (middle - from).dot(way) > half.dot(way.abs()) + f64::from(HALF_SLAB);
        let corners = [self.origin, self.origin + self.edges[0], self.origin + self.edges[1]];
        let outside = (0..3).any(|i| {
            let edge = corners[(i + 1) % 3] - corners[i];
            beyond(corners[i], edge.cross(self.plane).normalize_or_zero())
        });
        if outside || beyond(self.origin, self.plane) || beyond(self.origin, -self.plane) {
            return;
        }
        if size.max_element() > SMALL {
            let axis = usize::from(size.y > size.x.max(size.z))
                + 2 * usize::from(size.z > size.x && size.z >= size.y);
            let (mut left, mut right) = (hi, lo);
            left[axis] = lo[axis] + size[axis] / 2 - 1;
            right[axis] = left[axis] + 1;
            self.visit(lo, left, out);
            self.visit(right, hi, out);
            return;
        }
        for z in lo.z..=hi.z {
            for y in lo.y..=hi.y {
                for x in lo.x..=hi.x {
                    let cell = IVec3::new(x, y, z);
                    out.extend((0..self.fur.per_cell).filter_map(|k| self.foot(cell, k)));
                }
            }
        }
    }

    /// The point of the triangle whose interpolated normal leads to a point of a cell, if it is
    /// near enough.
    fn foot(&self, cell: IVec3, k: u32) -> Option<Foot> {
        let (inside, id) = self.fur.point(cell, k);
        let point = cell.as_dvec3() + inside.as_dvec3();
        if (point - self.origin).dot(self.plane).abs() >= f64::from(HALF_SLAB) {
            return None;
        }
        let [mut u, mut v] = self.weights(point);
        let (mut normal, mut above) = (DVec3::ZERO, 0.0);
        for _ in 0..STEPS {
            // Outside of the triangle the nearest normal is good enough to come back.
            let (s, t) = (u.clamp(-0.5, 1.5), v.clamp(-0.5, 1.5));
            let sum = self.normals[0] * (1.0 - s - t) + self.normals[1] * s + self.normals[2] * t;
            normal = sum.try_normalize()?;
            let slope = normal.dot(self.plane);
            // Normals that hardly point out of the triangle belong to another surface.
            if slope < 0.1 {
                return None;
            }
            above = (point - self.origin).dot(self.plane) / slope;
            let next = self.weights(point - normal * above);
            let change = (next[0] - u).abs() + (next[1] - v).abs();
            [u, v] = next;
            if change < SETTLED {
                break;
            }
        }
        let inside = u >= -ON_EDGE && v >= -ON_EDGE && u + v <= 1.0 + ON_EDGE;
        if !(inside && above.abs() < f64::from(HALF_SLAB)) {
            return None;
        }
        let weights = [1.0 - u - v, u, v];
        let coats = self.corners.map(|v| self.mesh.coats()[v as usize]);
        let length: f64 = (0..3).map(|i| weights[i] * f64::from(coats[i].length)).sum();
        let color: Vec3 = (0..3).map(|i| coats[i].color * weights[i] as f32).sum();
        let share = length.clamp(0.0, 1.0) as f32 * self.fur.share(id);
        let spacing = f64::from(self.fur.spacing);
        let position = (self.origin + self.edges[0] * u + self.edges[1] * v) * spacing;
        let root = Root { position: position.as_vec3(), direction: normal.as_vec3(), share, id, color };
        (share > 0.0).then_some(Foot { cell, k, position, root })
    }

    /// The weights of the second and the third corner, for a point of the plane.
    fn weights(&self, point: DVec3) -> [f64; 2] {
        let way = point - self.origin;
        let [e, f] = self.edges;
        let (ee, ef, ff) = (e.dot(e), e.dot(f), f.dot(f));
        let (we, wf) = (way.dot(e), way.dot(f));
        let scale = 1.0 / (ee * ff - ef * ef);
        [(ff * we - ef * wf) * scale, (ee * wf - ef * we) * scale]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Vertex, weld};
    use crate::samples::{ball, cube, torus_mesh};

    #[test]
    fn strands_are_equally_dense_on_any_surface() {
        // Faces along cells, off them, and turned.
        let flat = weld(&cube(2.0), &[]).unwrap();
        let turn = glam::Quat::from_euler(glam::EulerRot::XYZ, 0.4, 0.7, 0.2);
        let turned = |v: &Vertex| Vertex { position: turn * v.position + 0.013, normal: turn * v.normal };
        let turned = flat.vertices().iter().map(turned).collect();
        let turned = Mesh::new(turned, Vec::new(), flat.triangles().to_vec()).unwrap();
        for mesh in [flat, turned, ball(4), torus_mesh(96)] {
            for per_cell in [1, 3] {
                let fur = Fur { spacing: 0.05, per_cell, ..Fur::for_radius(1.0, 0.05, 0.1).unwrap() };
                let found = roots(&mesh, &fur).unwrap();
                let expected = mesh.area() * fur.strands_per_area();
                println!(
                    "{} triangles: {} strands, {expected:.0} expected",
                    mesh.triangles().len(),
                    found.len()
                );
                assert!((found.len() as f64 / expected - 1.0).abs() < 0.04);
                let place = |r: &Root| (r.id, r.position.to_array().map(f32::to_bits));
                let once: std::collections::HashSet<_> = found.iter().map(place).collect();
                assert_eq!(once.len(), found.len(), "each strand once");
            }
        }
    }

    #[test]
    fn roots_stand_on_the_surface_and_bad_parameters_are_refused() {
        let (mesh, fur) = (ball(4), Fur::for_radius(1.0, 0.1, 0.2).unwrap());
        for root in roots(&mesh, &fur).unwrap() {
            assert!(
                (root.position.length() - 1.0).abs() < 3e-3
                    && (1.0 - fur.variation..=1.0).contains(&root.share)
            );
            assert!(root.direction.dot(root.position.normalize()) > 0.999);
            assert!((root.point(&fur, 1.0).distance(root.position) - root.length(&fur)).abs() < 1e-5);
        }
        let dense = Fur { spacing: 1e-5, ..fur };
        assert!(matches!(roots(&mesh, &dense), Err(Error::TooMany { what: "strands", .. })));
        // A triangle as long as 100,000 cells and much thinner than one takes no time, and one a
        // billion long an error.
        let thin = |long: f32| {
            let corners = [Vec3::ZERO, Vec3::splat(long), Vec3::splat(long) + Vec3::X * 1e-3];
            let corners = corners.map(|position| Vertex { position, normal: Vec3::Y }).to_vec();
            Mesh::new(corners, Vec::new(), vec![[0, 1, 2]; 4]).unwrap()
        };
        assert!(roots(&thin(1e3), &fur).is_ok());
        assert!(matches!(roots(&thin(1e6), &Fur { spacing: 0.3, ..fur }), Err(Error::TooMany { .. })));
        let wrong = [
            Fur { spacing: 0.0, ..fur },
            Fur { spacing: f32::NAN, ..fur },
            Fur { height: -1.0, ..fur },
            Fur { bend: Vec3::splat(f32::INFINITY), ..fur },
            Fur { radius: 0.5, ..fur },
            Fur { per_cell: 0, ..fur },
            Fur { taper: 1.1, ..fur },
            Fur { variation: -0.1, ..fur },
            Fur { clump: f32::NAN, ..fur },
            Fur { curl: 2.0, ..fur },
        ];
        for fur in wrong {
            assert!(matches!(roots(&mesh, &fur), Err(Error::Range { .. })), "{fur:?}");
            // Tables have no errors, but no panic either.
            fur.table();
        }
        for (radius, height, density) in
            [(0.0, 0.1, 0.1), (1.0, f32::NAN, 0.1), (1.0, 0.1, 2.0), (1.0, 0.1, 0.0)]
        {
            assert!(Fur::for_radius(radius, height, density).is_err());
        }
    }
}
