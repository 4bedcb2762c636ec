//! The chain rule, written down plainly: for each cell all pairs of blocking neighbours, in whole
//! numbers.

use glam::IVec2;

/// The cells that the rule does not hide from a viewer's cell inside the grid. Cells outside of the
/// grid block.
pub(super) fn chain_rule(dims: IVec2, opaque: &[IVec2], v: IVec2) -> Vec<IVec2> {
    let inside = |c: IVec2| c.cmpge(IVec2::ZERO).all() && c.cmplt(dims).all();
    let mut hidden: Vec<IVec2> = Vec::new();
    let mut cells: Vec<IVec2> =
        (-1..=dims.y).flat_map(|y| (-1..=dims.x).map(move |x| IVec2::new(x, y))).collect();
    cells.sort_by_key(|&c| (c - v).abs().max_element());
    let mut blocking: Vec<IVec2> = Vec::new();
    let mut next = 0;
    for m in 1..=dims.max_element() {
        while next < cells.len() && (cells[next] - v).abs().max_element() < m {
            let c = cells[next];
            next += 1;
            if !inside(c) || opaque.contains(&c) || hidden.contains(&c) {
                blocking.push(c - v);
            }
        }
        let shell = cells[next..].iter().filter(|&&c| (c - v).abs().max_element() == m && inside(c));
        // Pairs may reach from the shell before into this one, to a cell that is opaque.
        let found: Vec<IVec2> = shell.copied().filter(|&c| is_behind(&blocking, c - v)).collect();
        hidden.extend(found);
    }
    (0..dims.y)
        .flat_map(|y| (0..dims.x).map(move |x| IVec2::new(x, y)))
        .filter(|c| !hidden.contains(c))
        .collect()
}

/// Whether the way from the origin to a cell meets a chain of blocking cells before it gets there.
fn is_behind(blocking: &[IVec2], c: IVec2) -> bool {
    blocking.iter().any(|&a| {
        let meets = |b: IVec2| {
            // The way meets the line from a to b: they are on different sides of it, or it passes
            // one, in front of c.
            let (s, t) = (c.perp_dot(a), c.perp_dot(b));
            let before = |p: IVec2| p.dot(c) > 0 && p != c;
            s.signum() * t.signum() <= 0 && before(a) && before(b) && (s != t || a == b)
        };
        [IVec2::ZERO, IVec2::X, IVec2::Y].iter().any(|&d| {
            let b = a + d;
            blocking.contains(&b) && meets(b)
        })
    })
}
