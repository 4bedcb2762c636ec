//! Welding: triangles as positions, not as vertices, and the edges that they share.

use std::hash::BuildHasher;

use glam::{DVec3, Vec3};
use hashbrown::{DefaultHashBuilder, HashTable};
use smallvec::SmallVec;

use crate::mesh::surface::gap::{join, split_near};
use crate::mesh::surface::interior::drop_interior;
use crate::mesh::surface::patch::NONE;
use crate::mesh::surface::position::key;
use crate::mesh::surface::split::split;

/// Buckets get about so many positions, until there are as many buckets as a processor writes to at
/// a time.
const BUCKET: usize = 8192;
const MOST_BUCKETS: usize = 256;

/// Where more triangles than this share an edge, none are neighbours there.
const MOST_AROUND: usize = 8;

/// Triangles of which the normals' angle has at least this cosine lie in one plane.
const STRAIGHT: f64 = 0.9999;

/// An edge of one triangle.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Edge {
    /// The vertices at its ends, the lesser number first.
    pub(crate) ends: [u32; 2],
    /// Twice the number of the triangle, and one more if the triangle runs along the edge from the
    /// lesser end.
    run: u32,
}

impl Edge {
    /// The triangle, and whether it runs along the edge from the lesser end.
    pub(crate) fn run(&self) -> (u32, bool) {
        (self.run >> 1, self.run & 1 == 1)
    }
}

/// The triangle on the other side of an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Neighbour(u32);

impl Neighbour {
    /// The triangle, and whether both run along the edge in the same direction, if there is one.
    pub(crate) fn get(self) -> Option<(u32, bool)> {
        (self.0 != NONE).then_some((self.0 >> 1, self.0 & 1 == 1))
    }
}

/// Triangles whose corners are numbered by position, without those that have two equal corners
/// and without repetitions or faces between boxes that abut, and split where vertices lie on their
/// edges.
pub(crate) struct Welded {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// The edges of all triangles, in order.
    pub(crate) edges: Vec<Edge>,
    pub(crate) topology: Topology,
}

/// How the triangles of a mesh share edges. Edges are told apart by position, and triangles with
/// two equal corners are passed over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Topology {
    /// Whether each edge has two triangles.
    pub(crate) closed: bool,
    /// Whether, moreover, these run along it in opposite directions.
    pub(crate) alike: bool,
}

impl Welded {
    #[cfg(test)]
    pub(crate) fn new(positions: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        Self::closing(positions, triangles, 0.0, false)
    }

    /// Closes gaps up to this length, if it is not 0. The topology is that of the triangles given.
    /// `front` says whether they hide from their front only.
    pub(crate) fn closing(positions: &[Vec3], triangles: &[[u32; 3]], gap: f64, front: bool) -> Self {
        let (mut positions, mut triangles) = number(positions, triangles);
        let mut edges = edges_of(positions.len(), &triangles);
        let topology = Topology::new(&edges);
        if gap > 0.0 {
            (positions, triangles) = number(&positions, &join(&positions, &triangles, gap, front));
            edges = edges_of(positions.len(), &triangles);
        }
        let hollow = drop_interior(&positions, &mut triangles, |a, b, found| {
            let ends = [a.min(b), a.max(b)];
            let first = edges.partition_point(|edge| edge.ends < ends);
            edges[first..].iter().take_while(|edge| edge.ends == ends).for_each(|edge| found(edge.run().0));
        });
        if hollow {
            edges = edges_of(positions.len(), &triangles);
        }
        let dropped = drop_repeated(&mut triangles, &edges);
        let near = gap > 0.0 && split_near(&positions, &mut triangles, gap, front);
        let cut = split(&positions, &mut triangles) || near;
        if dropped || cut {
            edges = edges_of(positions.len(), &triangles);
        }
        if cut && drop_repeated(&mut triangles, &edges) {
            edges = edges_of(positions.len(), &triangles);
        }
        Self { positions, triangles, edges, topology }
    }

    pub(crate) fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|v| self.positions[v as usize].as_dvec3())
    }

    /// The neighbours of each triangle. The first lies beyond the edge from its first corner to its
    /// second. Where more than two share an edge, those are neighbours that go on straight.
    pub(crate) fn neighbours(&self) -> Vec<[Neighbour; 3]> {
        let mut all = vec![[Neighbour(NONE); 3]; self.triangles.len()];
        let mut join = |one: Edge, two: Edge| {
            let alike = u32::from(one.run().1 == two.run().1);
            for (own, other) in [(one, two), (two, one)] {
                let (triangle, upwards) = own.run();
                let corners = self.triangles[triangle as usize];
                let from = own.ends[usize::from(!upwards)];
                let side = corners.iter().position(|&v| v == from).unwrap_or(0);
                all[triangle as usize][side] = Neighbour(other.run & !1 | alike);
            }
        };
        for beside in self.edges.chunk_by(|a, b| a.ends == b.ends) {
            match beside {
                &[one, two] => join(one, two),
                [_, _, _, ..] if beside.len() <= MOST_AROUND => {
                    self.straight_pairs(beside).for_each(|(one, two)| join(one, two));
                }
                _ => {}
            }
        }
        all
    }

    /// Of the triangles around an edge, pairs that lie in one plane, on different sides of the
    /// edge.
    fn straight_pairs(&self, beside: &[Edge]) -> impl Iterator<Item = (Edge, Edge)> {
        let normal = |edge: &Edge| {
            let [a, b, c] = self.corners(edge.run().0 as usize);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            // As if all ran along the edge upwards: those on different sides have opposite normals.
            if edge.run().1 { normal } else { -normal }
        };
        let mut left: SmallVec<[(Edge, DVec3); MOST_AROUND]> =
            beside.iter().map(|edge| (*edge, normal(edge))).collect();
        std::iter::from_fn(move || {
            while let Some((one, own)) = left.pop() {
                if let Some(at) = left.iter().position(|(_, other)| own.dot(*other) <= -STRAIGHT) {
                    return Some((one, left.swap_remove(at).0));
                }
            }
            None
        })
    }
}

impl Topology {
    pub(crate) fn of(positions: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let (positions, triangles) = number(positions, triangles);
        Self::new(&edges_of(positions.len(), &triangles))
    }

    fn new(edges: &[Edge]) -> Self {
        let all = || edges.chunk_by(|a, b| a.ends == b.ends);
        let closed = !edges.is_empty() && all().all(|beside| beside.len() == 2);
        Self { closed, alike: closed && all().all(|beside| beside[0].run().1 != beside[1].run().1) }
    }
}

/// Numbers positions in the order in which triangles name them, and leaves out triangles with two
/// equal corners.
fn number(positions: &[Vec3], triangles: &[[u32; 3]]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let first = first_of_equals(positions);
    let mut welded: Vec<Vec3> = Vec::with_capacity(positions.len().min(triangles.len().saturating_mul(3)));
    let mut numbers = vec![NONE; positions.len()];
    let mut number = |v: u32| {
        let number = &mut numbers[first[v as usize] as usize];
        if *number == NONE {
            *number = welded.len() as u32;
            welded.push(positions[v as usize]);
        }
        *number
    };
    let mut kept = Vec::with_capacity(triangles.len());
    for t in triangles {
        let [a, b, c] = t.map(&mut number);
        if a != b && b != c && c != a {
            kept.push([a, b, c]);
        }
    }
    (welded, kept)
}

/// For each position, the place of the first that is equal to it.
///
/// Positions are dealt to buckets by a hash first, so that the table of each bucket stays in the
/// processor's cache.
fn first_of_equals(positions: &[Vec3]) -> Vec<u32> {
    let buckets = (positions.len() / BUCKET).next_power_of_two().min(MOST_BUCKETS);
    let hasher = DefaultHashBuilder::default();
    let hash = |[x, y, z]: [u32; 3]| hasher.hash_one((u64::from(x) << 32 | u64::from(y), z));
    let bucket = |p: &Vec3| hash(key(*p)) as usize & (buckets - 1);
    let mut ends = vec![0usize; buckets + 1];
    positions.iter().for_each(|p| ends[bucket(p) + 1] += 1);
    for i in 1..ends.len() {
        ends[i] += ends[i - 1];
    }
    let mut dealt = vec![([0; 3], 0u32); positions.len()];
    for (p, place) in positions.iter().zip(0..) {
        let end = &mut ends[bucket(p)];
        dealt[*end] = (key(*p), place);
        *end += 1;
    }
    let mut first = vec![0; positions.len()];
    let mut table: HashTable<([u32; 3], u32)> = HashTable::new();
    let mut start = 0;
    for &end in &ends[..buckets] {
        table.clear();
        for &(key, place) in &dealt[start..end] {
            let entry = table.entry(hash(key), |e| e.0 == key, |e| hash(e.0));
            first[place as usize] = entry.or_insert((key, place)).get().1;
        }
        start = end;
    }
    first
}

/// The edges of triangles in order: sorted by the lesser vertex by counting, then those of each
/// vertex.
fn edges_of(vertices: usize, triangles: &[[u32; 3]]) -> Vec<Edge> {
    let sides = |t: &[u32; 3]| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
    let mut ends = vec![0u32; vertices + 1];
    triangles.iter().flat_map(sides).for_each(|(a, b)| ends[a.min(b) as usize + 1] += 1);
    // Where the edges of each vertex start, and once they are written, where they end.
    for v in 1..ends.len() {
        ends[v] += ends[v - 1];
    }
    let mut edges = vec![Edge::default(); triangles.len() * 3];
    for (t, number) in triangles.iter().zip(0u32..) {
        for (a, b) in sides(t) {
            let (low, high) = (a.min(b), a.max(b));
            let end = &mut ends[low as usize];
            edges[*end as usize] = Edge { ends: [low, high], run: number << 1 | u32::from(a < b) };
            *end += 1;
        }
    }
    let mut start = 0;
    for &end in &ends[..vertices] {
        edges[start..end as usize].sort_unstable();
        start = end as usize;
    }
    edges
}

/// Drops triangles that have the corners of an earlier one; false if there are none.
fn drop_repeated(triangles: &mut Vec<[u32; 3]>, edges: &[Edge]) -> bool {
    let mut repeated: Vec<u32> = Vec::new();
    let mut third: Vec<(u32, u32)> = Vec::new();
    for beside in edges.chunk_by(|a, b| a.ends == b.ends).filter(|beside| beside.len() > 1) {
        let [a, b] = beside[0].ends;
        third.clear();
        third.extend(beside.iter().filter_map(|edge| {
            let triangle = edge.run().0;
            let other = triangles[triangle as usize].into_iter().find(|&v| v != a && v != b)?;
            // Each triangle is asked at the edge of its two least corners.
            (other > b).then_some((other, triangle))
        }));
        third.sort_unstable();
        repeated.extend(third.windows(2).filter(|w| w[0].0 == w[1].0).map(|w| w[1].1));
    }
    repeated.sort_unstable();
    let mut gone = repeated.iter().copied().peekable();
    let mut number = 0;
    triangles.retain(|_| {
        let keep = gone.next_if_eq(&number).is_none();
        number += 1;
        keep
    });
    !repeated.is_empty()
}
