//! Levels of detail of any mesh, which keep its colours and lengths.

use std::collections::{BTreeMap, HashMap, HashSet};

use glam::Vec3;
use meshopt::{SimplifyOptions, VertexDataAdapter};

use super::types::Mesh;
use crate::error::{Error, range};
use crate::numeric::{COARSER, COLOR_WEIGHT, LEAST_LEVEL, LENGTH_WEIGHT, MAX_COORDINATE};

/// Numbers of a vertex that levels keep: colour and length.
const KEPT: usize = 4;

/// Targets that are tried for a level of a closed mesh, until one leaves it closed.
const TRIES: usize = 16;

impl Mesh {
    /// At most `count` levels of detail, the mesh itself first, each with about a quarter of the
    /// triangles of the one before; fewer where the mesh cannot become simpler. Their vertices are
    /// vertices of the mesh.
    ///
    /// Edges collapse by quadrics of places, colours and lengths of coats (Hoppe 1999, by
    /// meshoptimizer). Six vertices on the border of each bald part stay, so that eyes do: of the 32
    /// parts with the longest borders. Levels of closed meshes are closed, which
    /// [`inner_ball`](crate::visibility::inner_ball) needs. Costs up to 16 simplifications of the
    /// finest mesh a level.
    ///
    /// # Errors
    /// Refuses 0 levels and more than 16.
    pub fn levels(&self, count: usize) -> Result<Vec<Mesh>, Error> {
        range("the number of levels", count as f64, 1.0, 16.0)?;
        let simplifier = Simplifier::new(self);
        let is_closed = self.open_edges() == 0;
        let mut levels = vec![self.clone()];
        let mut target = self.triangles().len();
        for _ in 1..count {
            target = (target / COARSER).max(LEAST_LEVEL);
            let finer = levels.last().map_or(0, |level| level.triangles().len());
            let Some(level) = simplifier.level(target, is_closed) else { break };
            // A level must save a quarter.
            if 4 * level.triangles().len() > 3 * finer {
                break;
            }
            levels.push(level);
        }
        Ok(levels)
    }

    /// A closed level of about so many triangles of a closed mesh, or the mesh itself if none can be
    /// had.
    #[cfg(feature = "scenes")]
    pub(crate) fn coarser(&self, triangles: usize) -> Mesh {
        Simplifier::new(self).level(triangles.max(LEAST_LEVEL), true).unwrap_or_else(|| self.clone())
    }
}

/// A mesh as meshoptimizer takes it.
struct Simplifier<'a> {
    mesh: &'a Mesh,
    positions: Vec<u8>,
    kept: Vec<f32>,
    locks: Vec<bool>,
}

impl<'a> Simplifier<'a> {
    fn new(mesh: &'a Mesh) -> Self {
        let positions = mesh.vertices().iter().flat_map(|v| v.position.to_array().map(f32::to_ne_bytes));
        let kept = mesh.coats().iter().flat_map(|coat| {
            // As pictures store it: differences are then as large as they look.
            let color = coat.color.powf(1.0 / 2.2);
            [color.x, color.y, color.z, coat.length]
        });
        Self {
            mesh,
            positions: positions.flatten().collect(),
            kept: kept.collect(),
            locks: corner_stones(mesh),
        }
    }

    /// A level of about so many triangles; `None` if none can be had.
    fn level(&self, triangles: usize, is_closed: bool) -> Option<Mesh> {
        let mut target = triangles;
        for _ in 0..TRIES {
            if target >= self.mesh.triangles().len() {
                return None;
            }
            let level = self.simplified(target)?;
            if !is_closed || level.open_edges() == 0 {
                return Some(level);
            }
            // Collapses may pinch a mesh; another target takes another way.
            target += 2 + target / 32;
        }
        None
    }

    fn simplified(&self, triangles: usize) -> Option<Mesh> {
        let adapter = VertexDataAdapter::new(&self.positions, 12, 0).ok()?;
        let (c, l) = (COLOR_WEIGHT, LENGTH_WEIGHT);
        let left = meshopt::simplify_with_attributes_and_locks(
            self.mesh.triangles().as_flattened(),
            &adapter,
            &self.kept,
            &[c, c, c, l],
            KEPT * size_of::<f32>(),
            &self.locks,
            3 * triangles,
            MAX_COORDINATE,
            // Regular triangles, since layers of thin ones would show their edges.
            SimplifyOptions::ErrorAbsolute | SimplifyOptions::RegularizeLight,
            None,
        );
        let left = without_fins(left.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect());
        let left = meshopt::optimize_vertex_cache(left.as_flattened(), self.mesh.vertices().len());
        (!left.is_empty()).then(|| self.mesh.used(&left))
    }
}

/// The triangles without pairs of the same three vertices in opposite orders. Edge collapses leave
/// such pairs: they enclose nothing, but their edges would belong to four triangles.
fn without_fins(mut triangles: Vec<[u32; 3]>) -> Vec<[u32; 3]> {
    for t in &mut triangles {
        let first = (0..3).min_by_key(|&i| t[i]).unwrap_or(0);
        t.rotate_left(first);
    }
    let all: HashSet<[u32; 3]> = triangles.iter().copied().collect();
    triangles.retain(|&[a, b, c]| !all.contains(&[a, c, b]));
    triangles
}

/// Vertices that stay: some on the border of each bald part, as far from each other as they can be.
/// Without them a part that is small beside the triangles of a level would go away.
fn corner_stones(mesh: &Mesh) -> Vec<bool> {
    let mut places: HashMap<[u32; 3], usize> = HashMap::new();
    let place_of: Vec<usize> = mesh
        .vertices()
        .iter()
        .map(|v| {
            let next = places.len();
            *places.entry(v.position.to_array().map(|c| (c + 0.0).to_bits())).or_insert(next)
        })
        .collect();
    let of = |t: &[u32; 3]| t.map(|v| place_of[v as usize]);
    let is_bald = |t: &&[u32; 3]| t.iter().all(|&v| mesh.coats()[v as usize].length < BALD);
    let (bald, furry): (Vec<_>, Vec<_>) = mesh.triangles().iter().partition(is_bald);
    let mut at_fur = vec![false; places.len()];
    furry.iter().flat_map(of).for_each(|place| at_fur[place] = true);

    // Parts: places that bald triangles connect.
    let mut parent: Vec<usize> = (0..places.len()).collect();
    fn root(parent: &mut [usize], mut at: usize) -> usize {
        while parent[at] != at {
            parent[at] = parent[parent[at]];
            at = parent[at];
        }
        at
    }
    for t in &bald {
        let [a, b, c] = of(t).map(|place| root(&mut parent, place));
        let least = a.min(b).min(c);
        [a, b, c].into_iter().for_each(|part| parent[part] = least);
    }
    let mut seen = vec![false; places.len()];
    let mut parts: BTreeMap<usize, Vec<(usize, Vec3)>> = BTreeMap::new();
    for &v in bald.iter().flat_map(|t| t.iter()) {
        let place = place_of[v as usize];
        if at_fur[place] && !std::mem::replace(&mut seen[place], true) {
            let part = root(&mut parent, place);
            parts.entry(part).or_default().push((place, mesh.vertices()[v as usize].position));
        }
    }
    let mut parts: Vec<Vec<(usize, Vec3)>> = parts.into_values().collect();
    parts.sort_by_key(|part| std::cmp::Reverse(part.len()));
    let mut kept = vec![false; places.len()];
    for part in parts.iter().take(PARTS) {
        for place in spread(part) {
            kept[place] = true;
        }
    }
    place_of.into_iter().map(|place| kept[place]).collect()
}

/// At most [`STONES`] of some places, each as far from those before as it can be.
fn spread(places: &[(usize, Vec3)]) -> Vec<usize> {
    let mut chosen: Vec<(usize, Vec3)> = places.first().copied().into_iter().collect();
    while chosen.len() < STONES.min(places.len()) {
        let away = |p: &Vec3| chosen.iter().map(|c| c.1.distance_squared(*p)).fold(f32::INFINITY, f32::min);
        match places.iter().max_by(|a, b| away(&a.1).total_cmp(&away(&b.1))) {
            Some(&place) => chosen.push(place),
            None => break,
        }
    }
    chosen.into_iter().map(|c| c.0).collect()
}

/// Fur shorter than this share of the greatest is bald: a tenth of the length that is full.
const BALD: f32 = 0.1;

/// Corners that a bald part keeps: a hexagon has 83% of the area of its circle.
const STONES: usize = 6;

/// Bald parts that keep corners, those with the longest borders first: others may go away.
const PARTS: usize = 32;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Vertex;
    use crate::samples::ball;

    #[test]
    fn levels_have_vertices_of_the_finest() {
        let mesh = ball(4);
        let levels = mesh.levels(4).unwrap();
        assert_eq!((levels.len(), &levels[0]), (4, &mesh));
        for (level, target) in levels[1..].iter().zip([1280, 320, 80]) {
            assert!(level.triangles().len() <= target && level.triangles().len() * 10 > target * 9);
            assert!(level.vertices().iter().all(|v| mesh.vertices().contains(v)));
            assert_eq!(level.open_edges(), 0);
        }
        assert!([0, 17].iter().all(|&n| matches!(mesh.levels(n), Err(Error::Range { .. }))));
        // A flat mesh, and a vertex that no triangle uses.
        let flat = Mesh::new(vec![Vertex::default(); 4], Vec::new(), vec![[0, 1, 2], [0, 0, 0]]).unwrap();
        let _ = (flat.levels(3), flat.acmr(16));
        assert_eq!(flat.ordered().vertices().len(), 3);
        // Two triangles back to back go away, others stay.
        let left = without_fins(vec![[0, 1, 2], [5, 3, 4], [2, 1, 0], [3, 4, 6]]);
        assert_eq!(left, [[3, 4, 5], [3, 4, 6]]);
    }
}
