//! Which triangles of a mesh share edges.

use glam::Vec3;

/// Whether each edge, by position, has two triangles. Triangles with two equal
/// corners are passed over.
pub(crate) fn is_closed(positions: &[Vec3], triangles: &[[u32; 3]]) -> bool {
    let key = |v: u32| positions[v as usize].to_array().map(|c| (c + 0.0).to_bits());
    let mut edges = Vec::with_capacity(triangles.len() * 3);
    for t in triangles {
        let [a, b, c] = t.map(key);
        if a == b || b == c || c == a {
            continue;
        }
        edges.extend([(a.min(b), a.max(b)), (b.min(c), b.max(c)), (c.min(a), c.max(a))]);
    }
    edges.sort_unstable();
    !edges.is_empty() && edges.chunk_by(|a, b| a == b).all(|same| same.len() == 2)
}

/// Whether the two triangles at each edge of a closed mesh run along it in opposite directions.
pub(crate) fn is_wound_alike(positions: &[Vec3], triangles: &[[u32; 3]]) -> bool {
    let key = |v: u32| positions[v as usize].to_array().map(|c| (c + 0.0).to_bits());
    let mut edges = Vec::with_capacity(triangles.len() * 3);
    for t in triangles {
        let [a, b, c] = t.map(key);
        if a != b && b != c && c != a {
            edges.extend([(a, b), (b, c), (c, a)]);
        }
    }
    edges.sort_unstable();
    edges.windows(2).all(|w| w[0] != w[1])
}
