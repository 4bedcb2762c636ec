//! Maps of the editor Tiled.

use std::error::Error;

use casca_plane::Role;
use casca_plane::maps::Drawing;
use casca_plane::tmx::TmxImport;

/// A map with its doors; objects of the class `guard` are guards, one of the class `start` is where
/// the walk begins. What is amiss with it is printed.
pub fn tiled(file: &str) -> Result<Drawing, Box<dyn Error>> {
    let map = TmxImport::default().read_map(file)?;
    map.warnings.iter().for_each(|warning| eprintln!("{file}: {warning}"));
    let mut drawing = Drawing { walls: map.walls, ..Drawing::default() };
    for object in &map.objects {
        let around = object.shape.bounds();
        let tile = ((around.min + around.max) / 2.0).floor();
        let tile = (tile.as_ivec2() - map.origin).to_array().map(u32::try_from);
        let [Ok(x), Ok(y)] = tile else { continue };
        if x >= drawing.walls.width() || y >= drawing.walls.height() || drawing.walls.get(x, y) {
            continue;
        }
        match &*object.class {
            _ if object.role == Role::Door => drawing.doors.push((x, y)),
            "guard" => drawing.guards.push((x, y)),
            "start" => drawing.start = Some((x, y)),
            _ => {}
        }
    }
    Ok(drawing)
}
