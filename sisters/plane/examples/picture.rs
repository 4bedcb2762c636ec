//! A picture of one view: the visible region of an eye, the tiles that it does not see, the guards
//! that it sees, and the hidden ones.
//!
//! ```sh
//! cargo run --release -p casca-plane --example picture -- ../docs/plane.svg
//! ```

use std::error::Error;

use casca_maps::{Drawing, HARBOUR};
use casca_plane::{
    Disc, FieldOfView, FovOptions, GridSpec, ObjectDesc, Query, Scene, TileLayer, TilePoint, View,
};
use glam::{UVec2, Vec2};

/// Pixels of a tile.
const TILE: f32 = 14.0;
/// The radius of guards, in tiles.
const RADIUS: f32 = 0.4;

const HIDDEN: &str = "#20242e";
const SEEN: &str = "#3d4658";
const REGION: &str = "#ffe9a8";
const HIDDEN_WALL: &str = "#59503f";
const SEEN_WALL: &str = "#e2c896";
const VISIBLE: &str = "#ff8c1a";
const CULLED: &str = "#5aa2ff";

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).ok_or("name the file for the picture, as in: picture plane.svg")?;
    let mut map = Drawing::read(HARBOUR);
    // Some doors are closed.
    for &(x, y) in map.doors.iter().step_by(3) {
        map.walls.set(x, y, true);
    }
    let dims = UVec2::new(map.walls.width(), map.walls.height());
    let layer = TileLayer::new(Vec2::ZERO, 1.0, map.walls)?;
    let center = |(x, y): (u32, u32)| Vec2::new(x as f32, y as f32) + 0.5;
    let eye = center(map.start.ok_or("the map has no start")?);

    let mut scene = Scene::new(&GridSpec { min: Vec2::ZERO, cell: 1.0, dims })?;
    scene.insert_tiles(&layer)?;
    let mut guards = Vec::new();
    for at in map.guards.into_iter().map(center) {
        guards.push((at, scene.insert(ObjectDesc::new(Disc::new(at, RADIUS)))?));
    }
    let mut query = Query::new();
    query.run(&scene, &View::all_round(eye)?);

    let mut fov = FieldOfView::new();
    let at = TilePoint::new(eye.x.into(), eye.y.into())?;
    let seen = fov.run(layer.opaque(), at, &FovOptions::default());

    // Squares inside tiles, smaller by a margin at each side.
    let squares = |tiles: &mut dyn Iterator<Item = (u32, u32)>, color: &str| {
        const MARGIN: f32 = 0.3;
        let side = TILE - 2.0 * MARGIN;
        let corners = tiles.map(|(x, y)| UVec2::new(x, y).as_vec2() * TILE + MARGIN);
        let path: String = corners.map(|at| format!("M{} {}h{side}v{side}h-{side}z", at.x, at.y)).collect();
        format!("<path d=\"{path}\" fill=\"{color}\"/>\n")
    };
    let disc = |at: Vec2, radius: f32, color: &str| {
        let (x, y, radius) = (at.x * TILE, at.y * TILE, radius * TILE);
        let circle = format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{color}\"");
        circle + " stroke=\"#111\" stroke-width=\"1\"/>\n"
    };
    let Vec2 { x, y } = dims.as_vec2() * TILE;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {x} {y}\">\n\
         <rect width=\"{x}\" height=\"{y}\" fill=\"{HIDDEN}\"/>\n"
    );
    svg += &squares(&mut seen.cells().filter(|&(x, y)| !layer.opaque().get(x, y)), SEEN);
    let corner = |at: Vec2| format!("{:.2},{:.2}", at.x * TILE, at.y * TILE);
    let region = query.polygon().into_iter().map(corner).collect::<Vec<_>>().join(" ");
    svg += &format!("<polygon points=\"{region}\" fill=\"{REGION}\" fill-opacity=\"0.85\"/>\n");
    let walls = || layer.opaque().bits().cells();
    svg += &squares(&mut walls().filter(|&(x, y)| seen.get(x, y)), SEEN_WALL);
    svg += &squares(&mut walls().filter(|&(x, y)| !seen.get(x, y)), HIDDEN_WALL);
    for (at, id) in guards {
        svg += &disc(at, RADIUS, if query.pvs().contains(id) { VISIBLE } else { CULLED });
    }
    svg += &disc(eye, 0.5, "#d02060");
    std::fs::write(file, svg + "</svg>\n")?;
    Ok(())
}
