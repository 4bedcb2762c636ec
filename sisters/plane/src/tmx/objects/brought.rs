//! The shapes that tiles bring to the places of layers on which they stand.

use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

use glam::DVec2;

use super::draft::{Draft, Form};
use super::drawn::Drawn;
use super::fault::TmxFault;
use super::role::Roles;
use super::shape::{Frame, Outline, TmxShape};
use super::template::Templates;
use crate::editor::Role;
use crate::geometry::Rect;
use crate::tmx::space::Space;
use crate::tmx::tileset::Opaque;

/// The shapes of a tile that hide, in tiles from the corner of its cell on.
#[derive(Debug)]
pub(in crate::tmx) struct Brought {
    pub walls: Shapes,
    pub doors: Shapes,
    /// Whether a wall covers the cell.
    pub covers: bool,
    /// Whether no wall leaves it.
    pub inside: bool,
}

/// Some shapes of a tile.
#[derive(Debug)]
pub(in crate::tmx) struct Shapes {
    pub all: Arc<[TmxShape]>,
    /// Counted once, and not wherever the tile stands.
    pub corners: u64,
}

impl From<Vec<TmxShape>> for Shapes {
    fn from(all: Vec<TmxShape>) -> Self {
        let of = |shape: &TmxShape| match shape {
            TmxShape::Polygon(points) | TmxShape::Polyline(points) => points.len(),
            _ => 1,
        };
        let corners = all.iter().map(|shape| of(shape) as u64).sum();
        Self { all: all.into(), corners }
    }
}

/// The tile at a place: its tileset, its number there, its id, and what decides on roles there.
#[derive(Clone, Copy)]
pub(in crate::tmx) struct Standing<'t> {
    pub set: &'t Rc<Opaque>,
    pub number: u32,
    pub id: u32,
    pub roles: Roles<'t>,
}

/// The tiles with shapes that were met. Each is turned in eight ways at most, and takes four roles
/// in each, so that at most 32 copies of what the files draw are kept.
pub(in crate::tmx) struct DrawnTiles {
    space: Space,
    known: HashMap<(*const Opaque, u32), Known>,
}

/// The bits of an id that turn a tile of squares.
const TURNS: u32 = 0xe000_0000;

/// A tile with shapes.
struct Known {
    /// Kept, so that no other tileset gets its address.
    set: Rc<Opaque>,
    objects: Vec<Object>,
    /// By the bits that turn the tile, and the role that the layer gives.
    brought: HashMap<(u32, Option<Role>), Rc<Brought>>,
}

/// An object on a tile.
struct Object {
    id: u32,
    /// With the parts of its template.
    draft: Draft,
    /// Whether its faults were told.
    told: bool,
}

/// Takes the number of an object on a tile, and its fault.
type Tell<'f> = &'f mut dyn FnMut(u32, TmxFault);

impl DrawnTiles {
    pub fn new(space: Space) -> Self {
        Self { space, known: HashMap::new() }
    }

    /// The shapes that a tile brings. Faults of its objects are told once for each.
    pub fn at(&mut self, tile: Standing<'_>, templates: &mut Templates<'_>, tell: Tell<'_>) -> Rc<Brought> {
        let Standing { set, number, id, roles } = tile;
        let known = self.known.entry((Rc::as_ptr(set), number)).or_insert_with(|| {
            let drawn = set.drawn(number).iter();
            let objects = drawn.filter_map(|drawn| object(drawn, templates, tell)).collect();
            Known { set: set.clone(), objects, brought: HashMap::new() }
        });
        let Known { set, objects, brought } = known;
        let made = brought.entry((id & TURNS, roles.layer));
        made.or_insert_with(|| Rc::new(bring(&self.space, Standing { set, ..tile }, objects, tell))).clone()
    }
}

/// An object as the file draws it, completed. `None` if nothing can hide.
fn object(drawn: &Drawn, templates: &mut Templates<'_>, tell: Tell<'_>) -> Option<Object> {
    let complete = |mut draft: Draft| {
        let template = match draft.template.take() {
            Some(path) => Some(templates.complete(&mut draft, &path)?),
            None => None,
        };
        match draft.tile.is_some() || template.is_some_and(|template| template.tile().is_some()) {
            true => Err(TmxFault::Picture),
            false => Ok(draft),
        }
    };
    match drawn.draft.clone().and_then(complete) {
        Ok(draft) if matches!(draft.form, Some(Form::Text)) => None,
        Ok(mut draft) => {
            draft.faults.drain(..).for_each(|fault| tell(drawn.id, fault));
            Some(Object { id: drawn.id, draft, told: false })
        }
        Err(fault) => {
            tell(drawn.id, fault);
            None
        }
    }
}

fn bring(space: &Space, tile: Standing<'_>, objects: &mut [Object], tell: Tell<'_>) -> Brought {
    let (mut walls, mut doors) = (Vec::new(), Vec::new());
    for Object { id, draft, told } in objects {
        let mut faults = Vec::new();
        let of_tile = tile.set.says(tile.number, draft.class.is_empty());
        let role = tile.roles.role(&draft.properties, &draft.class, of_tile, &mut faults);
        if role != Role::Plain {
            match shape(space, &tile, draft) {
                Ok(TmxShape::Point(_)) => faults.push(TmxFault::NoSize),
                Ok(shape) => {
                    // The check costs the square of the corners.
                    faults.extend(if *told { None } else { shape.fault() });
                    if role == Role::Door { &mut doors } else { &mut walls }.push(shape);
                }
                Err(fault) => faults.push(fault),
            }
        }
        if !*told {
            *told = role != Role::Plain || !faults.is_empty();
            faults.into_iter().for_each(|fault| tell(*id, fault));
        }
    }
    let bounds = || walls.iter().map(|wall: &TmxShape| (wall, wall.bounds()));
    let holds = |min: f32, max: f32| min <= 0.0 && max >= 1.0;
    let covers = |r: Rect| holds(r.min.x, r.max.x) && holds(r.min.y, r.max.y);
    Brought {
        covers: bounds().any(|(wall, r)| matches!(wall, TmxShape::Rect(_)) && covers(r)),
        inside: bounds().all(|(_, r)| r.min.min_element() >= 0.0 && r.max.max_element() <= 1.0),
        walls: walls.into(),
        doors: doors.into(),
    }
}

fn shape(space: &Space, tile: &Standing<'_>, draft: &Draft) -> Result<TmxShape, TmxFault> {
    let picture = tile.set.on_layers(tile.number);
    let (drawing, on_screen) = (picture.drawing(), picture.on_screen(space, tile.id));
    let at = on_screen.transform_point2(drawing.transform_point2(draft.at));
    let turn = on_screen.matrix2 * draft.turn() * drawing.matrix2;
    let size = DVec2::from(draft.size.map(|length| length.unwrap_or(0.0)));
    let outline = match &draft.form {
        Some(Form::Outline(outline)) => outline,
        _ => &Outline::Box,
    };
    Frame { space, at, turn, least: DVec2::ZERO, size }.shape(outline)
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;

    #[test]
    fn corners_of_all_forms_count() {
        let corners = |shape: TmxShape| Shapes::from(vec![shape]).corners;
        assert_eq!(corners(TmxShape::Polygon(vec![Vec2::ZERO; 7])), 7);
        assert_eq!(corners(TmxShape::Polyline(vec![Vec2::ZERO; 9])), 9);
        assert_eq!(corners(TmxShape::Point(Vec2::ZERO)), 1);
    }
}
