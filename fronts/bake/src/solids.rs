//! The boxes along the axes in which no eye is.

use std::collections::BTreeMap;

use casca::Aabb;
use casca::glam::{Affine3A, Vec3};
use casca_scenes::world::{Mesh, Object, Shape, Sides, turn_of};

/// Triangles of a box.
const OF_A_BOX: usize = 12;

/// The solid boxes among objects that hide others. If `of_meshes` says so, these are also the parts
/// of meshes that are closed boxes, which may be hollow, such as a room that is modelled as one.
pub(crate) fn solids_of(objects: &[Object], of_meshes: bool) -> Vec<Aabb> {
    let mut solids = Vec::new();
    for object in objects.iter().filter(|object| object.occludes) {
        match &object.shape {
            Shape::Box { min, max } => solids.push(Aabb::new(*min, *max)),
            Shape::Mesh { mesh, transform } if of_meshes => solids.extend(boxes_of(mesh, transform)),
            _ => {}
        }
    }
    solids
}

/// The number that stands for all that are joined to one.
fn root(joined: &mut [u32], mut i: u32) -> u32 {
    while joined[i as usize] != i {
        joined[i as usize] = joined[joined[i as usize] as usize];
        i = joined[i as usize];
    }
    i
}

fn join(joined: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(joined, a), root(joined, b));
    joined[a.max(b) as usize] = a.min(b);
}

/// The parts of a mesh that are boxes along the axes of the world and hide from outside at least.
fn boxes_of(mesh: &Mesh, transform: &Affine3A) -> Vec<Aabb> {
    let corners: Vec<Vec3> = mesh.positions.iter().map(|&p| transform.transform_point3(p)).collect();
    let mut joined: Vec<u32> = (0..corners.len() as u32).collect();
    // Vertices are often given once for each face.
    let mut first: BTreeMap<[u32; 3], u32> = BTreeMap::new();
    for (p, v) in corners.iter().zip(0..) {
        let key = p.to_array().map(|c| (c + 0.0).to_bits());
        let earlier = *first.entry(key).or_insert(v);
        join(&mut joined, earlier, v);
    }
    let hides = |(i, t): &(usize, &[u32; 3])| {
        mesh.sides_of(*i) != Sides::Neither && t.iter().all(|&v| (v as usize) < corners.len())
    };
    let triangles: Vec<(usize, &[u32; 3])> = mesh.triangles.iter().enumerate().filter(hides).collect();
    for (_, t) in &triangles {
        join(&mut joined, t[0], t[1]);
        join(&mut joined, t[0], t[2]);
    }
    let turn = turn_of(transform) as f32;
    let mut parts: BTreeMap<u32, (Vec<[Vec3; 3]>, Vec<Vec3>)> = BTreeMap::new();
    for (i, t) in triangles {
        let (part, fronts) = parts.entry(root(&mut joined, t[0])).or_default();
        let [a, b, c] = t.map(|v| corners[v as usize]);
        part.push([a, b, c]);
        if mesh.sides_of(i) == Sides::Front {
            // The normal of its front, at the triangle.
            fronts.extend([a, (b - a).cross(c - a) * turn]);
        }
    }
    let found = parts.values().filter_map(|(part, fronts)| {
        let found = box_of(part)?;
        let outwards = |front: &[Vec3]| (front[0] - (found.min + found.max) * 0.5).dot(front[1]) > 0.0;
        fronts.chunks_exact(2).all(outwards).then_some(found)
    });
    found.collect()
}

/// The box that triangles bound, if they do.
fn box_of(triangles: &[[Vec3; 3]]) -> Option<Aabb> {
    if triangles.len() != OF_A_BOX {
        return None;
    }
    let all = triangles.iter().flatten();
    let (min, max) = all.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), &p| (a.min(p), b.max(p)));
    // Two triangles on each side, with half of its area each.
    let mut on = [[0; 2]; 3];
    for t in triangles {
        let corners = t.iter().all(|p| (p.cmpeq(min) | p.cmpeq(max)).all());
        let axis = (0..3).find(|&i| t[0][i] == t[1][i] && t[1][i] == t[2][i])?;
        let area = (t[1] - t[0]).cross(t[2] - t[0]).length();
        if !corners || area == 0.0 {
            return None;
        }
        on[axis][usize::from(t[0][axis] == max[axis])] += 1;
    }
    (min.cmplt(max).all() && on == [[2; 2]; 3] && covers(triangles, min, max)).then(|| Aabb::new(min, max))
}

/// Whether the two triangles of each side of a box are not the same half of it: they share two
/// corners.
fn covers(triangles: &[[Vec3; 3]], min: Vec3, max: Vec3) -> bool {
    (0..3).all(|axis| {
        [min, max].iter().all(|side| {
            let on: Vec<_> = triangles.iter().filter(|t| t.iter().all(|p| p[axis] == side[axis])).collect();
            let [a, b] = on[..] else { return false };
            let shared: Vec<&Vec3> = a.iter().filter(|p| b.contains(p)).collect();
            // The corners that they share are opposite ones, so each has a half.
            shared.len() == 2 && (0..3).all(|i| i == axis || shared[0][i] != shared[1][i])
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(mesh: Mesh, transform: Affine3A) -> Object {
        let shape = Shape::Mesh { mesh: mesh.into(), transform };
        let motion = casca_scenes::world::Motion::Static;
        Object { name: String::new(), shape, motion, occludes: true, tested: true }
    }

    #[test]
    fn boxes_are_found_in_meshes_and_other_shapes_are_not() {
        let mut two = Mesh::cuboid(Vec3::ZERO, Vec3::ONE);
        two.append(Mesh::cuboid(Vec3::X * 3.0, Vec3::new(4.0, 5.0, 6.0)));
        let place = Affine3A::from_scale_rotation_translation(Vec3::splat(2.0), Default::default(), Vec3::Y);
        let found = solids_of(&[mesh(two, place)], true);
        assert_eq!(found.len(), 2);
        assert_eq!((found[0].min, found[0].max), (Vec3::Y, Vec3::new(2.0, 3.0, 2.0)));
        // A ball, a box that is turned, one that is open, and one whose side has a triangle twice.
        let turned = Affine3A::from_rotation_y(0.3);
        let mut open = Mesh::cuboid(Vec3::ZERO, Vec3::ONE);
        open.triangles.pop();
        let mut twice = Mesh::cuboid(Vec3::ZERO, Vec3::ONE);
        twice.triangles[1] = twice.triangles[0];
        let bad = [
            mesh(Mesh::ball(1), Affine3A::IDENTITY),
            mesh(Mesh::cuboid(Vec3::ZERO, Vec3::ONE), turned),
            mesh(open, Affine3A::IDENTITY),
            mesh(twice, Affine3A::IDENTITY),
            mesh(
                Mesh { positions: vec![Vec3::ZERO], triangles: vec![[0, 1, 2]], ..Mesh::default() },
                Affine3A::IDENTITY,
            ),
        ];
        assert_eq!(solids_of(&bad, true).len(), 0);
    }
}
