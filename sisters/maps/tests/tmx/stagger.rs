//! Staggered maps and maps of hexagons, against where the editor's manual has the pixels of tiles.

use casca_plane::{GridSpec, Query, Scene, View};
use glam::{IVec2, UVec2, Vec2Swizzles};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::*;

const SIZE: [i32; 2] = [7, 6];
const EDGE: f32 = 1e-3; // So near to the border of a tile, rounding decides.

/// A map as its attributes say.
struct Sample {
    columns: bool,
    even: bool,
    /// The length of a hexagon's side in pixels; `None` for diamonds.
    side: Option<f32>,
    tile: Vec2,
    /// The tile in the first corner, and the pixels by which the layer is shifted.
    first: [i32; 2],
    shift: Vec2,
    walls: Vec<bool>,
}

impl Sample {
    fn new(random: &mut Pcg64Mcg) -> Self {
        let (columns, even) = (random.random(), random.random());
        let side = random.random::<bool>().then(|| random.random_range(0..12) as f32);
        let mut pair = |range: std::ops::Range<i32>| [0; 2].map(|_| random.random_range(range.clone()));
        let (tile, steps) = (IVec2::from(pair(8..20)).as_vec2() * 2.0, IVec2::from(pair(-3..4)).as_vec2());
        // Any shift for hexagons; for diamonds one that lays them on others.
        let (first, shift) = (pair(-9..9), if side.is_some() { steps * 5.25 } else { steps * tile });
        let walls = (0..SIZE[0] * SIZE[1]).map(|_| random.random_range(0..3) == 0).collect();
        Self { columns, even, side, tile, first, shift, walls }
    }

    /// Numbers across and along the axis on which every other column or row is shifted.
    fn swap(&self, v: Vec2) -> Vec2 {
        if self.columns { v.yx() } else { v }
    }

    /// How long a slanted side is along the axis that is shifted: whole pixels.
    fn slant(&self) -> f32 {
        ((self.swap(self.tile).y - self.side.unwrap_or(0.0)) / 2.0).floor()
    }

    /// The middle of a tile in pixels.
    fn middle(&self, tile: [i32; 2]) -> Vec2 {
        let (at, size) = (self.swap(IVec2::from(tile).as_vec2()), self.swap(self.tile));
        let is_shifted = at.y.rem_euclid(2.0) == f32::from(!self.even);
        let across = (at.x + 0.5 * f32::from(is_shifted)) * size.x;
        let along = at.y * (self.slant() + self.side.unwrap_or(0.0));
        self.shift + self.tile / 2.0 + self.swap(Vec2::new(across, along))
    }

    /// How far a place is from the middle of a tile: 1 on its border.
    fn away(&self, tile: [i32; 2], place: Vec2) -> f32 {
        let from = self.swap((place - self.middle(tile)).abs() / self.tile * 2.0);
        // Where a slanted side begins, from the middle.
        let flat = 1.0 - 2.0 * self.slant() / self.swap(self.tile).y;
        from.max_element().max(from.x * (1.0 - flat) + from.y)
    }

    fn tiles(&self) -> impl Iterator<Item = ([i32; 2], bool)> {
        let at = |i: i32| [self.first[0] + i % SIZE[0], self.first[1] + i / SIZE[0]];
        (0..).map(at).zip(self.walls.iter().copied())
    }

    /// The map, whose walls are turned and mirrored, with an object at each place.
    fn text(&self, places: &[Vec2]) -> String {
        let Self { tile: Vec2 { x: w, y: h }, shift: Vec2 { x: right, y: down }, first: [x, y], .. } = self;
        let (kind, axis) = (if self.side.is_some() { "hexagonal" } else { "staggered" }, ["y", "x"]);
        let (axis, index) = (axis[usize::from(self.columns)], ["odd", "even"][usize::from(self.even)]);
        let (side, [columns, rows]) = (self.side.unwrap_or(0.0), SIZE);
        let ids: String = self.walls.iter().map(|wall| if *wall { "4026531841," } else { "0," }).collect();
        let point = |p: &Vec2| format!("<object x=\"{}\" y=\"{}\"><point/></object>", p.x, p.y);
        let points: String = places.iter().map(point).collect();
        format!(
            "<map orientation=\"{kind}\" staggeraxis=\"{axis}\" staggerindex=\"{index}\" hexsidelength=\"{side}\" infinite=\"1\" \
             tilewidth=\"{w}\" tileheight=\"{h}\"><tileset firstgid=\"1\" tilecount=\"1\"/><layer name=\"walls\" offsetx=\"{right}\" \
             offsety=\"{down}\"><data encoding=\"csv\"><chunk x=\"{x}\" y=\"{y}\" width=\"{columns}\" height=\"{rows}\">{ids}\
             </chunk></data></layer><objectgroup>{points}</objectgroup></map>"
        )
    }
}

/// Whether a convex polygon has a place inside.
fn holds(corners: &[Vec2], place: Vec2) -> bool {
    let ends = corners.iter().zip(corners.iter().cycle().skip(1));
    ends.into_iter().all(|(a, b)| (*b - *a).perp_dot(place - *a) > 0.0)
}

#[test]
fn walls_hide_where_their_pixels_are() {
    let (mut random, mut seen) = (Pcg64Mcg::seed_from_u64(3), [0; 3]);
    for _ in 0..400 {
        let sample = Sample::new(&mut random);
        let places: Vec<Vec2> = (0..40)
            .map(|_| {
                let tile = [0, 1].map(|axis| sample.first[axis] + random.random_range(-1..=SIZE[axis]));
                sample.middle(tile) + sample.tile * Vec2::new(random.random(), random.random())
            })
            .collect();
        let found = map(&sample.text(&places)).unwrap();
        let (walls, points): (Vec<_>, Vec<_>) = found.objects.iter().partition(|o| o.role == Role::Wall);
        assert_eq!(points.len(), places.len());
        for (point, place) in points.iter().zip(places) {
            let all = sample.tiles().filter(|(_, wall)| *wall).map(|(tile, _)| sample.away(tile, place));
            let away = all.fold(f32::INFINITY, f32::min);
            if (away - 1.0).abs() < EDGE {
                continue;
            }
            let at = point.bounds.bounds().min;
            let hides = match sample.side {
                None => {
                    let at = at.floor().as_ivec2() - found.origin;
                    at.min_element() >= 0
                        && found.walls.cells().any(|(x, y)| at.as_uvec2() == UVec2::new(x, y))
                }
                Some(_) => walls.iter().any(|wall| {
                    let Shape::Polygon(polygon) = &wall.bounds else { panic!() };
                    holds(polygon.corners(), at)
                }),
            };
            assert_eq!(hides, away < 1.0, "{at} {away} {}", sample.text(&[]));
            seen[usize::from(hides) + usize::from(hides && sample.side.is_some())] += 1;
        }
    }
    assert!(seen.iter().all(|&seen| seen > 500), "{seen:?}");
}

/// Neighbours share their corners, so that no ray passes between them.
#[test]
fn a_ring_of_hexagons_lets_nothing_through() {
    let ring = [[1, 0], [2, 0], [0, 1], [2, 1], [1, 2], [2, 2]];
    let walls = (0..SIZE[0] * SIZE[1]).map(|i| ring.contains(&[i % SIZE[0], i / SIZE[0]])).collect();
    let tile = Vec2::new(14.0, 18.0);
    let (columns, even, side, first, shift) = (false, false, Some(7.0), [0, 0], Vec2::ZERO);
    let sample = Sample { columns, even, side, tile, first, shift, walls };
    let found = map(&sample.text(&[])).unwrap();
    assert_eq!(found.objects.len(), 6);
    let mut scene = Scene::new(&GridSpec { min: Vec2::ZERO, cell: 1.0, dims: UVec2::splat(8) }).unwrap();
    found.objects.iter().for_each(|object| _ = scene.insert(object.desc()).unwrap());
    let mut query = Query::new();
    query.run(&scene, &View::all_round(sample.middle([1, 1]) / tile).unwrap());
    let outside = sample.tiles().filter(|(tile, wall)| !wall && *tile != [1, 1]);
    assert!(outside.into_iter().all(|(tile, _)| !query.sees_point(sample.middle(tile) / sample.tile)));
    assert!(query.sees_point((sample.middle([1, 1]) + 1.0) / tile));
}

#[test]
fn maps_of_too_many_or_too_far_hexagons_are_refused() {
    let text = |orientation: &str, at: i32, ids: &str, width: usize| {
        format!(
            "<map orientation=\"{orientation}\" infinite=\"1\" tilewidth=\"8\" tileheight=\"8\"><tileset firstgid=\"1\"/>\
             <layer name=\"walls\"><data encoding=\"csv\"><chunk x=\"{at}\" y=\"0\" width=\"{width}\" height=\"1\">{ids}</chunk>\
             </data></layer></map>"
        )
    };
    assert!(why(&text("hexagonal", 0, &"1,".repeat(65_537), 65_537)).contains("more than 65536 hexagons"));
    assert_eq!(map(&text("hexagonal", 0, &"0,".repeat(65_537), 65_537)).unwrap().objects.len(), 0);
    assert!(why(&text("hexagonal", i32::MAX, "1", 1)).contains("too far away"));
    assert!(why(&text("staggered", i32::MAX, "1", 1)).contains("spread"));
    assert!(why(&text("staggered", 0, "1", 1).replace("=\"8\"", "=\"1\"")).contains("tiles of no size"));
}
