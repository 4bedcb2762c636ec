//! The methods, each behind the same face.

use std::cell::RefCell;
use std::collections::HashSet;

use bracket_pathfinding::prelude::{Algorithm2D, BaseMap, FieldOfViewAlg, Point};
use casca_plane::{BitGrid, FieldOfView, FovOptions, OpaqueTiles, TilePoint};
use doryen_fov::{FovAlgorithm, FovRecursiveShadowCasting, FovRestrictive, MapData};

/// A map in the form of each crate.
pub struct Map {
    pub opaque: OpaqueTiles,
    bytes: Bytes,
    /// Its `fov` is written by each run.
    doryen: RefCell<MapData>,
}

/// A byte for each tile.
struct Bytes {
    width: i32,
    height: i32,
    opaque: Vec<bool>,
}

impl Map {
    pub fn new(opaque: BitGrid) -> Self {
        let (width, height) = (opaque.width(), opaque.height());
        let tiles = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let bytes: Vec<_> = tiles().map(|(x, y)| opaque.get(x, y)).collect();
        let mut doryen = MapData::new(width as usize, height as usize);
        doryen.transparent = bytes.iter().map(|opaque| !opaque).collect();
        let bytes = Bytes { width: width as i32, height: height as i32, opaque: bytes };
        Self { opaque: OpaqueTiles::new(opaque), bytes, doryen: RefCell::new(doryen) }
    }
}

impl BaseMap for Bytes {
    fn is_opaque(&self, index: usize) -> bool {
        self.opaque[index]
    }
}

impl Algorithm2D for Bytes {
    fn dimensions(&self) -> Point {
        Point::new(self.width, self.height)
    }

    /// Also for places outside, which the crate asks for at borders; the one given in the crate
    /// panics there.
    fn point2d_to_index(&self, at: Point) -> usize {
        (i64::from(at.y) * i64::from(self.width) + i64::from(at.x)).max(0) as usize
    }
}

/// The methods that are compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    Casca,
    Symmetric,
    DoryenRecursive,
    DoryenRestrictive,
    BracketRecursive,
    BracketSymmetric,
}

impl Method {
    pub const ALL: [Self; 6] = [
        Self::Casca,
        Self::Symmetric,
        Self::DoryenRecursive,
        Self::DoryenRestrictive,
        Self::BracketRecursive,
        Self::BracketSymmetric,
    ];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Casca => "casca-plane",
            Self::Symmetric => "symmetric-shadowcasting 0.2.0",
            Self::DoryenRecursive => "doryen-fov 0.1.1 recursive",
            Self::DoryenRestrictive => "doryen-fov 0.1.1 restrictive",
            Self::BracketRecursive => "bracket-pathfinding 0.8.7 recursive",
            Self::BracketSymmetric => "bracket-pathfinding 0.8.7 symmetric",
        }
    }

    /// The method at work on a map, with a range or, if that is 0, none. `None` if the method
    /// cannot do it.
    pub fn runner(self, map: &Map, range: u32) -> Option<Box<dyn Runner + '_>> {
        Some(match self {
            Self::Casca => {
                let options = FovOptions::default();
                let radius = if range == 0 { f32::INFINITY } else { range as f32 };
                let options = options.in_circle(radius).expect("radii are positive");
                Box::new(Casca { map: &map.opaque, options, fov: FieldOfView::new() })
            }
            Self::Symmetric => {
                Box::new(Symmetric { map: &map.bytes, range: range as isize, seen: Vec::new() })
            }
            Self::DoryenRecursive => {
                Box::new(Doryen { map: &map.doryen, range, method: FovRecursiveShadowCasting::new() })
            }
            Self::DoryenRestrictive => {
                Box::new(Doryen { map: &map.doryen, range, method: FovRestrictive::new() })
            }
            Self::BracketRecursive | Self::BracketSymmetric => {
                // It knows no view without a range, and makes room for 4 * range^2 tiles first.
                if range == 0 && map.bytes.width > 256 {
                    return None;
                }
                let range = if range == 0 { map.bytes.width * 3 / 2 } else { range as i32 };
                let method = match self {
                    Self::BracketRecursive => FieldOfViewAlg::RecursiveShadowcasting,
                    _ => FieldOfViewAlg::SymmetricShadowcasting,
                };
                Box::new(Bracket { map: &map.bytes, range, method, seen: HashSet::new() })
            }
        })
    }
}

/// A method at work on a map.
pub trait Runner {
    /// Finds the tiles that are seen from the centre of a tile, with all that has to be cleared
    /// first.
    fn run(&mut self, eye: (u32, u32));

    /// The tiles that the last run found.
    fn seen(&self) -> Vec<(u32, u32)>;
}

struct Casca<'a> {
    map: &'a OpaqueTiles,
    options: FovOptions,
    fov: FieldOfView,
}

impl Runner for Casca<'_> {
    fn run(&mut self, eye: (u32, u32)) {
        self.fov.run(self.map, TilePoint::center_of(eye.0, eye.1), &self.options);
    }

    fn seen(&self) -> Vec<(u32, u32)> {
        self.fov.seen().cells().collect()
    }
}

struct Symmetric<'a> {
    map: &'a Bytes,
    range: isize,
    /// Some of them more than once.
    seen: Vec<(isize, isize)>,
}

impl Runner for Symmetric<'_> {
    fn run(&mut self, eye: (u32, u32)) {
        let (map, range) = (self.map, self.range);
        let (eye_x, eye_y) = (eye.0 as isize, eye.1 as isize);
        let index = |(x, y): (isize, isize)| {
            let inside = x >= 0 && y >= 0 && x < map.width as isize && y < map.height as isize;
            inside.then(|| y as usize * map.width as usize + x as usize)
        };
        // The crate has no range: tiles beyond it block.
        let far =
            |(x, y): (isize, isize)| range != 0 && (x - eye_x).pow(2) + (y - eye_y).pow(2) > range * range;
        let mut blocks = |at| far(at) || index(at).is_none_or(|index| map.opaque[index]);
        self.seen.clear();
        let seen = &mut self.seen;
        let mut mark = |at| seen.push(at);
        symmetric_shadowcasting::compute_fov((eye_x, eye_y), &mut blocks, &mut mark);
    }

    fn seen(&self) -> Vec<(u32, u32)> {
        let inside = |&&(x, y): &&(isize, isize)| {
            (0..self.map.width as isize).contains(&x) && (0..self.map.height as isize).contains(&y)
        };
        self.seen.iter().filter(inside).map(|&(x, y)| (x as u32, y as u32)).collect()
    }
}

struct Doryen<'a, M> {
    map: &'a RefCell<MapData>,
    range: u32,
    method: M,
}

impl<M: FovAlgorithm> Runner for Doryen<'_, M> {
    fn run(&mut self, eye: (u32, u32)) {
        let map = &mut *self.map.borrow_mut();
        map.clear_fov();
        self.method.compute_fov(map, eye.0 as usize, eye.1 as usize, self.range as usize, true);
    }

    fn seen(&self) -> Vec<(u32, u32)> {
        let map = self.map.borrow();
        set_bytes(&map.fov, map.width as u32)
    }
}

struct Bracket<'a> {
    map: &'a Bytes,
    range: i32,
    method: FieldOfViewAlg,
    seen: HashSet<Point>,
}

impl Runner for Bracket<'_> {
    fn run(&mut self, eye: (u32, u32)) {
        let eye = Point::new(eye.0 as i32, eye.1 as i32);
        self.seen = self.method.field_of_view_set(eye, self.range, self.map);
    }

    fn seen(&self) -> Vec<(u32, u32)> {
        self.seen.iter().map(|at| (at.x as u32, at.y as u32)).collect()
    }
}

/// The tiles whose bytes are set.
fn set_bytes(bytes: &[bool], width: u32) -> Vec<(u32, u32)> {
    let set = (0..).zip(bytes).filter(|&(_, &set)| set);
    set.map(|(index, _): (u32, _)| (index % width, index / width)).collect()
}
