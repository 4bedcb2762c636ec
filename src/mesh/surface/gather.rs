//! Patches gathered from grown triangles and straight edges: the tree of groups, outlines and their
//! sides.

use crate::error::Error;
use crate::mesh::lists::Lists;
use crate::mesh::preparation::Progress;
use crate::mesh::surface::chain::Straight;
use crate::mesh::surface::groups::SharedBorder;
use crate::mesh::surface::grow::Patches;
use crate::mesh::surface::index::PatchIndex;
use crate::mesh::surface::patch::{Beyond, EDGE, NONE, Patch, PatchSide, Rules, Surface, slack};
use crate::mesh::surface::tree::{PatchNode, Tree};
use crate::mesh::surface::weld::Welded;

/// Progress is told once for this many patches.
const TOLD: usize = 64;

/// The directed edges of patches: the number of the patch, and twice that of the edge, and one if
/// the patch runs against it.
fn directed(straight: &[Straight]) -> impl Iterator<Item = (u32, u32)> + Clone {
    straight.iter().zip(0u32..).flat_map(|(edge, i)| {
        edge.runs.iter().flat_map(move |&(patch, steps)| {
            let directed = 2 * i + u32::from(steps < 0);
            (0..steps.abs()).map(move |_| (patch, directed))
        })
    })
}

/// The patches that run along an edge.
enum Beside {
    One,
    /// Two of them, and whether they run in opposite directions.
    Two([u32; 2], bool),
    /// None, more than two, or one several times.
    More,
}

impl Beside {
    /// `number` gives the number of a patch, or `NONE` if it is left out.
    fn new(edge: &Straight, number: impl Fn(u32) -> u32) -> Self {
        let mut kept = edge.runs.iter().map(|r| (number(r.0), r.1)).filter(|r| r.0 != NONE);
        match (kept.next(), kept.next(), kept.next()) {
            (Some((_, x)), None, None) if x.abs() == 1 => Self::One,
            (Some((p, x)), Some((q, y)), None) if x.abs() == 1 && y.abs() == 1 => Self::Two([p, q], x == -y),
            _ => Self::More,
        }
    }
}

/// Patches with their slabs, boxes and outlines, in a tree.
///
/// # Errors
/// Only [`Error::Cancelled`].
pub(crate) fn gather(
    mesh: &Welded,
    grown: &Patches,
    straight: &[Straight],
    rules: &Rules,
    progress: &mut Progress,
) -> Result<Surface, Error> {
    let count = grown.seeds.len();
    let outlines = Lists::new(count, directed(straight));
    let all = |patch: u32| patch;
    let borders: Vec<SharedBorder> =
        straight.iter().filter_map(|edge| border(mesh, edge, &Beside::new(edge, all))).collect();
    let tree = Tree::new(mesh, grown, borders, rules, &mut progress.part(0.0, 0.6))?;
    let order = tree.in_order();
    let mut number = vec![NONE; count];
    for (&node, new) in order.iter().zip(0..) {
        if tree.parts(node).is_empty() {
            number[node as usize] = new;
        }
    }
    let mut surface = Surface { front: rules.front, ..Surface::default() };
    surface.patches.reserve_exact(order.len());
    surface.sides.reserve(outlines.len());
    for (at, &node) in order.iter().enumerate() {
        if at % TOLD == 0 {
            progress.tell(0.6 + 0.4 * at as f32 / order.len() as f32)?;
        }
        let first = surface.sides.len() as u32;
        if tree.parts(node).is_empty() {
            let patch = number[node as usize];
            for &directed in outlines.of(node) {
                let edge = &straight[(directed >> 1) as usize];
                let beside = Beside::new(edge, |patch| number[patch as usize]);
                surface.push_side(mesh, edge, directed & 1 == 1, &beside, patch);
            }
        }
        let PatchNode { normal, slab: (lo, hi), sine, min, max, .. } = tree.nodes[node as usize];
        let last = surface.sides.len() as u32;
        let slack = slack(&surface.sides[first as usize..]);
        surface.patches.push(Patch {
            first,
            last,
            next: PatchIndex::FIRST,
            sine,
            normal,
            lo,
            hi,
            min,
            max,
            slack,
        });
    }
    close_ranges(&mut surface.patches, &tree, &order);
    surface.find_group_outlines();
    surface.shrink();
    Ok(surface)
}

/// The border between the two patches that an edge separates, if they run along it in opposite
/// directions.
fn border(mesh: &Welded, edge: &Straight, beside: &Beside) -> Option<SharedBorder> {
    let &Beside::Two([p, q], true) = beside else { return None };
    let [a, b] = edge.ends.map(|v| mesh.positions[v as usize].as_dvec3());
    Some((p, q, a.distance(b)))
}

/// Tells each patch where its last part ends.
fn close_ranges(patches: &mut [Patch], tree: &Tree, order: &[u32]) {
    let mut place = vec![0u32; tree.nodes.len()];
    for (at, &node) in order.iter().enumerate().rev() {
        place[node as usize] = at as u32;
        patches[at].next = match tree.parts(node).last() {
            Some(&last) => patches[place[last as usize] as usize].next,
            None => PatchIndex::new(at as u32 + 1),
        };
    }
}

impl Surface {
    /// Appends a side of a patch: an edge, passed in its direction or against it.
    fn push_side(&mut self, mesh: &Welded, edge: &Straight, against: bool, beside: &Beside, patch: u32) {
        let [a, b] = edge.ends.map(|v| mesh.names[v as usize]);
        let beyond = match *beside {
            Beside::Two([p, q], opposite) => {
                Beyond::Patch(PatchIndex::new(if p == patch { q } else { p }), opposite)
            }
            Beside::One => Beyond::Open,
            Beside::More => Beyond::More,
        };
        if beyond == Beyond::Open && edge.chain != EDGE {
            self.chains.push((self.sides.len() as u32, edge.chain));
        }
        let slack = if edge.slack > 0.0 { (edge.slack as f32).next_up() } else { 0.0 };
        self.sides.push(PatchSide::new(if against { [b, a] } else { [a, b] }, slack, beyond));
    }
}
