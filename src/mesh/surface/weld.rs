//! Welding: triangles as positions, not as vertices, and the edges that they share.

use glam::{DVec3, Vec3};
use smallvec::SmallVec;

use crate::mesh::surface::equal::first_of_equals;
use crate::mesh::surface::patch::NONE;
use crate::mesh::surface::split::split;

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
/// and without repetitions, and split where vertices lie on their edges.
pub(crate) struct Welded {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// The edges of all triangles, in order.
    pub(crate) edges: Vec<Edge>,
    pub(crate) topology: Topology,
    /// For each position given, the place of the first that is equal to it.
    pub(crate) first: Vec<u32>,
    /// For each position here, the place of one that is equal to it among those given.
    pub(crate) names: Vec<u32>,
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
    /// Welds positions and triangles. The topology is that of the triangles given.
    pub(crate) fn new(positions: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let first = first_of_equals(positions);
        let (names, mut triangles) = number(positions, triangles, &first);
        let positions = at(positions, &names);
        let mut edges = edges_of(positions.len(), &triangles);
        let topology = Topology::new(&edges);
        let dropped = drop_repeated(&mut triangles, &edges);
        let cut = split(&positions, &mut triangles);
        if dropped || cut {
            edges = edges_of(positions.len(), &triangles);
        }
        if cut && drop_repeated(&mut triangles, &edges) {
            edges = edges_of(positions.len(), &triangles);
        }
        Self { positions, triangles, edges, topology, first, names }
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
    /// `first` names the first position that is equal to each.
    pub(crate) fn of(positions: &[Vec3], triangles: &[[u32; 3]], first: &[u32]) -> Self {
        let (names, triangles) = number(positions, triangles, first);
        Self::new(&edges_of(names.len(), &triangles))
    }

    fn new(edges: &[Edge]) -> Self {
        let all = || edges.chunk_by(|a, b| a.ends == b.ends);
        let closed = !edges.is_empty() && all().all(|beside| beside.len() == 2);
        Self { closed, alike: closed && all().all(|beside| beside[0].run().1 != beside[1].run().1) }
    }
}

/// Numbers positions in the order in which triangles name them, and leaves out triangles with two
/// equal corners. `first` names the first position that is equal to each. Returns the place of each
/// position, and the triangles.
fn number(positions: &[Vec3], triangles: &[[u32; 3]], first: &[u32]) -> (Vec<u32>, Vec<[u32; 3]>) {
    let mut welded: Vec<u32> = Vec::with_capacity(positions.len().min(triangles.len().saturating_mul(3)));
    let mut numbers = vec![NONE; positions.len()];
    let mut number = |v: u32| {
        let number = &mut numbers[first[v as usize] as usize];
        if *number == NONE {
            *number = welded.len() as u32;
            welded.push(v);
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

/// The entries at some places.
fn at<T: Copy>(entries: &[T], places: &[u32]) -> Vec<T> {
    places.iter().map(|&place| entries[place as usize]).collect()
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
        // Their lesser ends are equal.
        let rank = |edge: &Edge| u64::from(edge.ends[1]) << 32 | u64::from(edge.run);
        match &mut edges[start..end as usize] {
            [] | [_] => {}
            [a, b] if rank(a) <= rank(b) => {}
            [a, b] => std::mem::swap(a, b),
            all => all.sort_unstable_by_key(rank),
        }
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
        // The corner beside the edge: no two of a triangle are equal.
        let tip = |edge: &Edge| {
            let [x, y, z] = triangles[edge.run().0 as usize];
            x ^ y ^ z ^ a ^ b
        };
        if let [one, two] = beside
            && tip(one) != tip(two)
        {
            continue;
        }
        third.clear();
        // Each triangle is asked at the edge of its two least corners.
        let own = beside.iter().map(|edge| (tip(edge), edge.run().0));
        third.extend(own.filter(|&(tip, _)| tip > b));
        third.sort_unstable();
        repeated.extend(third.windows(2).filter(|w| w[0].0 == w[1].0).map(|w| w[1].1));
    }
    if repeated.is_empty() {
        return false;
    }
    repeated.sort_unstable();
    let mut gone = repeated.into_iter().peekable();
    let mut number = 0;
    triangles.retain(|_| {
        let keep = gone.next_if_eq(&number).is_none();
        number += 1;
        keep
    });
    true
}
