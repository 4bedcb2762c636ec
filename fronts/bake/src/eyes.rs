//! The boxes of cells in single precision.

use casca::Aabb;
use casca::glam::Vec3;
use casca_baked::Cells;

/// The box of eyes of a cell, rounded outwards to single precision; `None` if there is no such
/// cell.
pub fn eyes_of(cells: &Cells, cell: u32) -> Option<Aabb> {
    let (low, high) = cells.room(cell)?;
    let down = |v: f64| if f64::from(v as f32) > v { (v as f32).next_down() } else { v as f32 };
    let up = |v: f64| if f64::from(v as f32) < v { (v as f32).next_up() } else { v as f32 };
    Some(Aabb::new(Vec3::from_array(low.map(down)), Vec3::from_array(high.map(up))))
}
