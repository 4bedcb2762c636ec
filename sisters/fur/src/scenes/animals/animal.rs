//! Generated animals.

use casca::Aabb;
use glam::IVec3;

use super::body::Body;
use super::polygons::surface;
use super::rig::Rig;
use crate::error::{Error, range};
use crate::mesh::{Mesh, Vertex};
use crate::numeric::COARSER;

/// Levels of detail of an animal.
pub const LEVELS: usize = 4;

/// A furry animal: closed two-manifold meshes with coats, at several levels of detail. The centre
/// of the finest level's box is the origin; it looks along x, and y is up. It is about a unit long.
#[derive(Debug, Clone)]
pub struct Animal {
    levels: Vec<Mesh>,
    /// The box of the finest level: finding it takes a pass over its vertices.
    aabb: Aabb,
    rig: Rig,
}

impl Animal {
    /// The animal of a seed: its proportions and colours differ, its parts (body, head, ears, legs,
    /// tail) do not. Nose and eyes are bald, feet have short fur. `detail` is the number of grid
    /// cells along its longest side, 24 to 256: the finest level has about 3 `detail`² triangles.
    /// Costs `detail`³ distances to some twenty parts: a quarter of a second at 64.
    ///
    /// # Errors
    /// Refuses a detail out of range.
    pub fn new(seed: u64, detail: u32) -> Result<Self, Error> {
        range("the detail of an animal", detail.into(), 24.0, 256.0)?;
        let body = Body::new(seed);
        let (lo, hi) = body.bounds();
        let cell = (hi - lo).max_element() / detail as f32;
        // A layer of cells around, so that the surface stays off the border.
        let dims = ((hi - lo) / cell).ceil().as_ivec3() + IVec3::splat(2);
        let (positions, triangles) = surface(|p| body.field(p), lo - cell, cell, dims);
        let coats = positions.iter().map(|&p| body.coat(p)).collect();
        let vertices = positions.iter().map(|&p| Vertex { position: p, normal: body.normal(p) }).collect();
        let raw = Mesh::new(vertices, coats, triangles)?;
        // Marching tetrahedra leave slivers; half of the triangles show no more.
        let finest = raw.coarser(raw.triangles().len() / 2);
        let middle = finest.aabb().center();
        let centered = |v: &Vertex| Vertex { position: v.position - middle, ..*v };
        let vertices = finest.vertices().iter().map(centered).collect();
        let finest = Mesh::new(vertices, finest.coats().to_vec(), finest.triangles().to_vec())?;
        let mut levels = vec![finest];
        for level in 1..LEVELS {
            levels.push(levels[0].coarser(levels[0].triangles().len() / COARSER.pow(level as u32)));
        }
        let rig = Rig::new(&body, middle, &levels)?;
        Ok(Self { aabb: levels[0].aabb(), levels, rig })
    }

    /// The meshes, finest first: [`LEVELS`] of them, each with about a quarter of the triangles of
    /// the one before.
    pub fn levels(&self) -> &[Mesh] {
        &self.levels
    }

    /// Its skeleton, weights and walk.
    pub fn rig(&self) -> &Rig {
        &self.rig
    }

    /// The box of the finest level, which contains the others; its centre is the origin.
    pub fn aabb(&self) -> Aabb {
        self.aabb
    }

    /// Half the diagonal of the box: the radius by which the thesis measures fur.
    pub fn radius(&self) -> f32 {
        let aabb = self.aabb();
        (aabb.max - aabb.min).length() * 0.5
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn animals_are_closed_and_face_outwards_at_all_levels() {
        for seed in 0..4 {
            let animal = Animal::new(seed, 40).unwrap();
            assert_eq!(animal.levels().len(), LEVELS);
            for (level, mesh) in animal.levels().iter().enumerate() {
                let at = |v: u32| mesh.vertices()[v as usize].position.as_dvec3();
                let volume: f64 =
                    mesh.triangles().iter().map(|t| at(t[0]).dot(at(t[1]).cross(at(t[2]))) / 6.0).sum();
                let count = mesh.triangles().len();
                assert!((0.05..0.3).contains(&volume), "{volume}");
                // One body without holes: Euler.
                assert_eq!(
                    (mesh.open_edges(), mesh.vertices().len() - count / 2),
                    (0, 2),
                    "seed {seed}, level {level}"
                );
                assert!(level == 0 || 2 * count < animal.levels()[level - 1].triangles().len());
                assert!(animal.aabb().contains(mesh.aabb().min));
            }
            assert!(animal.aabb().center().length() < 1e-5);
        }
    }

    #[test]
    fn normals_point_outwards_and_coats_have_bald_and_furry_parts() {
        let animal = Animal::new(2, 48).unwrap();
        let mesh = &animal.levels()[0];
        let against = mesh.triangles().iter().filter(|t| {
            let [a, b, c] = t.map(|v| mesh.vertices()[v as usize]);
            let flat = (b.position - a.position).cross(c.position - a.position);
            flat.dot(a.normal + b.normal + c.normal) <= 0.0
        });
        assert!(against.count() * 200 < mesh.triangles().len());
        assert!(mesh.vertices().iter().all(|v| (v.normal.length() - 1.0).abs() < 1e-5));
        let share = |most: f32| {
            mesh.coats().iter().filter(|c| c.length <= most).count() as f64 / mesh.coats().len() as f64
        };
        println!("bald {:.4}, short {:.4}, below nine tenths {:.4}", share(0.05), share(0.3), share(0.9));
        assert!(share(0.05) > 0.005 && share(0.3) > 0.03 && share(0.9) < 0.75);
    }

    #[test]
    fn seeds_repeat_and_differ() {
        let first = |seed| Animal::new(seed, 24).unwrap().levels()[0].clone();
        assert_eq!(first(5), first(5));
        assert_ne!(first(5), first(6));
        assert!([23, 257].iter().all(|&d| matches!(Animal::new(0, d), Err(Error::Range { .. }))));
    }
}
