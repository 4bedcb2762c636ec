//! Levels of the editor LDtk.

use std::error::Error;

use casca_plane::Role;
use casca_plane::ldtk::LdtkImport;
use casca_plane::maps::Drawing;

/// The first level in which something blocks, with its doors; entities `Guard` are guards, one
/// `Start` or `Player` is where the walk begins. What was passed over is printed.
pub fn ldtk(file: &str) -> Result<Drawing, Box<dyn Error>> {
    let mut levels = LdtkImport::default().read(file)?.into_iter();
    let (level, tile) = levels
        .find_map(|level| level.tile.map(|tile| (level, tile)))
        .ok_or_else(|| format!("{file} has no level with walls"))?;
    level.warnings.iter().for_each(|warning| eprintln!("{file}, {}: {warning}", level.name));
    let mut drawing = Drawing { walls: level.walls, ..Drawing::default() };
    for entity in &level.entities {
        let middle = (entity.rect.min + entity.rect.max) / (2.0 * tile as f32);
        let [Ok(x), Ok(y)] = middle.floor().as_ivec2().to_array().map(u32::try_from) else { continue };
        if x >= drawing.walls.width() || y >= drawing.walls.height() || drawing.walls.get(x, y) {
            continue;
        }
        match entity.name.to_ascii_lowercase().as_str() {
            _ if entity.role == Role::Door => drawing.doors.push((x, y)),
            "guard" => drawing.guards.push((x, y)),
            "start" | "player" => drawing.start = Some((x, y)),
            _ => {}
        }
    }
    Ok(drawing)
}
