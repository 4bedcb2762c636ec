//! Exact visibility between two cells of a grid, by whole numbers. It shares no code with the
//! library.
//!
//! One cell sees another if some line crosses the insides of both and no opaque cell between them.
//! Such lines form an open set. Each of its pieces has a corner: a line through two corners of the
//! cells (move a line until it touches one, and turn it around that until it touches another). So
//! it is enough to look at the lines through two corners, moved a little: at each such line, the
//! corners on it go to either side as a line does, with at most one change of side from one end to
//! the other.

use glam::IVec2;

/// Corners of a cell.
fn corners(cell: IVec2) -> [IVec2; 4] {
    [IVec2::ZERO, IVec2::X, IVec2::Y, IVec2::ONE].map(|d| cell + d)
}

/// Whether some point of one cell sees some point of another past opaque cells. Those two block
/// nothing themselves.
pub fn is_visible(opaque: &[IVec2], from: IVec2, to: IVec2) -> bool {
    let (lo, hi) = (from.min(to), from.max(to));
    // A way between the cells stays in the block around both, and passes each of its cells between
    // them.
    let between: Vec<IVec2> = opaque
        .iter()
        .copied()
        .filter(|&c| c.cmpge(lo).all() && c.cmple(hi).all() && c != from && c != to)
        .collect();
    let mut points: Vec<IVec2> = between.iter().chain([&from, &to]).flat_map(|&cell| corners(cell)).collect();
    points.sort_unstable_by_key(|p| p.to_array());
    points.dedup();
    let some_line_is_free =
        |i: usize| points[i + 1..].iter().any(|&b| is_free_near(&points, points[i], b, &between, from, to));
    (0..points.len()).any(some_line_is_free)
}

/// Whether a line near the one through two corners is free.
fn is_free_near(points: &[IVec2], a: IVec2, b: IVec2, between: &[IVec2], from: IVec2, to: IVec2) -> bool {
    let side = |p: IVec2| (b - a).perp_dot(p - a);
    // Each cell on one side of the line for certain leaves no choice; those that it cuts for
    // certain end the search.
    let surely_cut = |&cell: &IVec2| {
        let sides = corners(cell).map(side);
        sides.iter().any(|&s| s > 0) && sides.iter().any(|&s| s < 0)
    };
    if between.iter().any(surely_cut) {
        return false;
    }
    let along = |p: IVec2| (b - a).dot(p - a);
    let mut places: Vec<i32> = points.iter().filter(|&&p| side(p) == 0).map(|&p| along(p)).collect();
    places.sort_unstable();
    places.dedup();
    // The corners on the line before the change of side go to one side, those from there on to the
    // other.
    let changes = places.iter().copied().chain([i32::MAX]);
    changes.flat_map(|change| [(change, 1), (change, -1)]).any(|(change, sign)| {
        let moved = |p: IVec2| match side(p) {
            0 if along(p) < change => sign,
            0 => -sign,
            s => s.signum(),
        };
        let is_cut = |cell: IVec2| {
            let sides = corners(cell).map(moved);
            sides.contains(&1) && sides.contains(&-1)
        };
        is_cut(from) && is_cut(to) && !between.iter().any(|&cell| is_cut(cell))
    })
}

#[test]
fn known_maps() {
    let at = IVec2::new;
    // A single cell hides the one straight behind it only.
    assert!(!is_visible(&[at(2, 0)], at(0, 0), at(4, 0)));
    assert!(is_visible(&[at(2, 0)], at(0, 0), at(4, 1)));
    // Cells that touch in a corner let nothing through there.
    assert!(!is_visible(&[at(1, 0), at(0, 1)], at(0, 0), at(1, 1)));
    // A gap of one cell.
    let wall = |gap: i32| (-9..10).filter(move |&y| y != gap).map(|y| at(3, y)).collect::<Vec<_>>();
    assert!(is_visible(&wall(0), at(0, 0), at(6, 1)) && is_visible(&wall(1), at(0, 0), at(6, 3)));
    assert!(!is_visible(&wall(5), at(0, 0), at(6, 0)));
    assert!(is_visible(&[], at(0, 0), at(0, 1)) && is_visible(&[], at(0, 0), at(1, 1)));
}
