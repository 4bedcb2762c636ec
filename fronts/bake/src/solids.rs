//! The solid boxes of a level, and the walls that they make together.

use std::collections::BTreeMap;

use casca::Aabb;
use casca::glam::{Affine3A, Vec3};
use casca_scenes::world::{Mesh, Object, Shape, Sides, turn_of};

/// A box that touches more others than this is left out of unions: the ground would join all houses
/// of a town to one wall, in which each window opens a bit of all others.
const MOST_TOUCHED: usize = 64;

/// Triangles of a box.
const OF_A_BOX: usize = 12;

/// The boxes along the axes among objects that hide others: solid ones, and parts of meshes that
/// are closed boxes. Those may be hollow, such as a room that is modelled as one.
pub(crate) struct Boxes {
    pub(crate) solid: Vec<Aabb>,
    pub(crate) of_meshes: Vec<Aabb>,
    /// Those of meshes that hide from outside only.
    pub(crate) from_outside: Vec<Aabb>,
}

impl Boxes {
    pub(crate) fn of(objects: &[Object]) -> Self {
        let mut boxes = Self { solid: Vec::new(), of_meshes: Vec::new(), from_outside: Vec::new() };
        for object in objects.iter().filter(|object| object.occludes) {
            match &object.shape {
                Shape::Box { min, max } => boxes.solid.push(Aabb::new(*min, *max)),
                Shape::Mesh { mesh, transform } => {
                    for (found, from_both) in boxes_of(mesh, transform) {
                        let all = if from_both { &mut boxes.of_meshes } else { &mut boxes.from_outside };
                        all.push(found);
                    }
                }
                Shape::Sphere { .. } => {}
            }
        }
        boxes
    }
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

/// The parts of a mesh that are boxes along the axes of the world and hide from outside at least,
/// and whether they hide from both sides.
fn boxes_of(mesh: &Mesh, transform: &Affine3A) -> Vec<(Aabb, bool)> {
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
        fronts.chunks_exact(2).all(outwards).then_some((found, fronts.is_empty()))
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

/// Groups of two or more boxes that touch.
pub(crate) fn groups(boxes: &[Aabb]) -> Vec<Vec<Aabb>> {
    let pairs = touching(boxes);
    let mut touched = vec![0; boxes.len()];
    for pair in &pairs {
        pair.iter().for_each(|&i| touched[i as usize] += 1);
    }
    let mut joined: Vec<u32> = (0..boxes.len() as u32).collect();
    for &[a, b] in &pairs {
        if touched[a as usize].max(touched[b as usize]) <= MOST_TOUCHED {
            join(&mut joined, a, b);
        }
    }
    let mut groups: BTreeMap<u32, Vec<Aabb>> = BTreeMap::new();
    for (b, i) in boxes.iter().zip(0..) {
        groups.entry(root(&mut joined, i)).or_default().push(*b);
    }
    groups.into_values().filter(|group| group.len() > 1).collect()
}

/// The pairs of boxes that touch.
fn touching(boxes: &[Aabb]) -> Vec<[u32; 2]> {
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    let at = |i: u32| &boxes[i as usize];
    order.sort_by(|&a, &b| at(a).min.x.total_cmp(&at(b).min.x).then(a.cmp(&b)));
    let mut pairs = Vec::new();
    let mut open: Vec<u32> = Vec::new();
    for &i in &order {
        open.retain(|&j| at(j).max.x >= at(i).min.x);
        let touches = |&&j: &&u32| at(j).min.cmple(at(i).max).all() && at(i).min.cmple(at(j).max).all();
        pairs.extend(open.iter().filter(touches).map(|&j| [i.min(j), i.max(j)]));
        open.push(i);
    }
    pairs
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
        let found = Boxes::of(&[mesh(two, place)]).of_meshes;
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
        assert_eq!(Boxes::of(&bad).of_meshes.len(), 0);
    }

    #[test]
    fn boxes_that_touch_are_grouped_unless_they_touch_too_many() {
        let at =
            |x: f32, y: f32, size: f32| Aabb::new(Vec3::new(x, y, 0.0), Vec3::new(x + size, y + 1.0, 1.0));
        let row: Vec<Aabb> = (0..3u8).map(|i| at(f32::from(i), 0.0, 1.0)).collect();
        let apart = at(9.0, 0.0, 1.0);
        let sizes = |boxes: &[Aabb]| groups(boxes).iter().map(Vec::len).collect::<Vec<_>>();
        assert_eq!(sizes(&[&row[..], &[apart]].concat()), [3]);
        assert_eq!(sizes(&[&row[..], &[apart, at(9.5, 0.5, 1.0)]].concat()), [3, 2]);
        // Houses on a ground.
        let houses: Vec<Aabb> = (0..80u8).map(|i| at(2.0 * f32::from(i), 0.0, 1.0)).collect();
        assert_eq!(sizes(&[&houses[..], &[at(0.0, -1.0, 200.0)]].concat()), [0usize; 0]);
    }
}
