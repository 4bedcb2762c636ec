//! Welding: triangles as positions, not as vertices.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

/// Triangles whose corners are numbered by position, without those that have two equal corners
/// and without repetitions.
pub(crate) struct Welded {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Edges as (lesser vertex, greater vertex, triangle, whether the triangle runs it upwards), in order.
    pub(crate) edges: Vec<(u32, u32, u32, bool)>,
    /// For each triangle the start of each side's edge in `edges`.
    pub(crate) sides: Vec<[u32; 3]>,
}

/// A position as a key: equal positions, the zeros included, have equal keys.
pub(crate) fn key(p: Vec3) -> [u32; 3] {
    p.to_array().map(|c| (c + 0.0).to_bits())
}

impl Welded {
    pub(crate) fn new(positions: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let mut numbers: HashMap<[u32; 3], u32> = HashMap::with_capacity(positions.len());
        let mut welded: Vec<Vec3> = Vec::new();
        let mut number = |v: u32| {
            let p = positions[v as usize];
            *numbers.entry(key(p)).or_insert_with(|| {
                welded.push(p);
                welded.len() as u32 - 1
            })
        };
        let mut seen: HashMap<[u32; 3], ()> = HashMap::with_capacity(triangles.len());
        let mut kept = Vec::with_capacity(triangles.len());
        for t in triangles {
            let t = t.map(&mut number);
            if t[0] == t[1] || t[1] == t[2] || t[2] == t[0] {
                continue;
            }
            let mut sorted = t;
            sorted.sort_unstable();
            if seen.insert(sorted, ()).is_none() {
                kept.push(t);
            }
        }
        let mut edges = Vec::with_capacity(kept.len() * 3);
        for (i, t) in kept.iter().enumerate() {
            for side in 0..3 {
                let (a, b) = (t[side], t[(side + 1) % 3]);
                edges.push((a.min(b), a.max(b), i as u32, a < b));
            }
        }
        edges.sort_unstable();
        let mut sides = vec![[0; 3]; kept.len()];
        let mut start = 0;
        for i in 0..edges.len() {
            let (a, b, t, up) = edges[i];
            if (edges[start].0, edges[start].1) != (a, b) {
                start = i;
            }
            let corners = kept[t as usize];
            let from = if up { a } else { b };
            let side = corners.iter().position(|&v| v == from).unwrap_or(0);
            sides[t as usize][side] = start as u32;
        }
        Self { positions: welded, triangles: kept, edges, sides }
    }

    pub(crate) fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|v| self.positions[v as usize].as_dvec3())
    }

    /// The triangles at the edge that starts at a place in the list, with their directions: three
    /// of them, if there are more.
    pub(crate) fn at_edge(&self, start: u32) -> &[(u32, u32, u32, bool)] {
        let start = start as usize;
        let (a, b, ..) = self.edges[start];
        let count = self.edges[start..].iter().take(3).take_while(|e| (e.0, e.1) == (a, b)).count();
        &self.edges[start..start + count]
    }
}
