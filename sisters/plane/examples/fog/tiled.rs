//! Maps of the editor Tiled.

use std::error::Error;

use casca_plane::maps::Drawing;
use casca_plane::tmx::TmxImport;
use casca_plane::{BitGrid, Role};
use glam::IVec2;

/// A map with its doors; objects of the class `guard` are guards, one of the class `start` is where
/// the walk begins. What is amiss with it is printed.
pub fn tiled(file: &str) -> Result<Drawing, Box<dyn Error>> {
    let map = TmxImport::default().read_map(file)?;
    map.warnings.iter().for_each(|warning| eprintln!("{file}: {warning}"));
    let mut drawing = Drawing { walls: map.walls, ..Drawing::default() };
    let free = |walls: &BitGrid, tile: IVec2| {
        let [Ok(x), Ok(y)] = (tile - map.origin).to_array().map(u32::try_from) else { return None };
        (x < walls.width() && y < walls.height() && !walls.get(x, y)).then_some((x, y))
    };
    for tile in map.tiles.iter().filter(|tile| tile.role == Role::Door) {
        drawing.doors.extend(free(&drawing.walls, tile.place.floor().as_ivec2()));
    }
    for object in &map.objects {
        let around = object.shape.bounds();
        let tile = ((around.min + around.max) / 2.0).floor();
        let Some((x, y)) = free(&drawing.walls, tile.as_ivec2()) else { continue };
        match &*object.class {
            _ if object.role == Role::Door => drawing.doors.push((x, y)),
            "guard" => drawing.guards.push((x, y)),
            "start" => drawing.start = Some((x, y)),
            _ => {}
        }
    }
    Ok(drawing)
}
