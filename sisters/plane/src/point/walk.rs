//! The walk from the eye outwards: finds the objects in cells in sight, and the sides of their
//! occluders.

use std::f64::consts::PI;

use casca_slots::Slot;
use glam::{DVec2, IVec2};

use crate::geometry::{Block, Segment, Shape, orient};
use crate::point::arcs::{Arc, Arcs, Circle, between};
use crate::point::covers::Covers;
use crate::point::shells::Shells;
use crate::point::wall::{NOBODY, Wall};
use crate::pvs::Stats;
use crate::scene::{Object, Scene};
use crate::view::View;

/// Where so many times as many objects are left as were found, and the view is still wide open,
/// the walk goes on to all of them: that costs less than to close directions. Any number gives the
/// same set.
const MOST_LEFT: usize = 8;

/// Up to so many objects, whose occluders have as many sides together, are all looked at by a view
/// all round: that costs less than to walk to them. Any number gives the same set.
const FEW: f64 = 100.0;

/// The memory and the result of a walk.
#[derive(Debug, Clone, Default)]
pub(crate) struct Walk {
    /// The slots of the objects in cells in sight, those of near shells first.
    pub(crate) found: Vec<Slot>,
    /// By place in `found`: the wall that is all of the object, or [`NOBODY`].
    pub(crate) own: Vec<u32>,
    /// The sides of their occluders.
    pub(crate) walls: Vec<Wall>,
    /// The directions into solids whose border the eye is on.
    pub(crate) blocked: Vec<Arc>,
    covers: Covers,
    /// By slot: whether it is in `found`.
    marks: Vec<bool>,
}

impl Walk {
    /// Forgets the objects and walls of the last walk. There are so many slots then.
    fn clear(&mut self, slots: usize) {
        self.found.drain(..).for_each(|slot| self.marks[slot.index()] = false);
        self.marks.resize(slots, false);
        self.own.clear();
        self.walls.clear();
        self.blocked.clear();
    }

    /// Walks through a scene in the arcs of a view.
    pub(crate) fn run(
        &mut self,
        scene: &Scene,
        view: &View,
        circle: &Circle,
        arcs: &[Arc],
        stats: &mut Stats,
    ) {
        self.clear(scene.slot_count());
        let eye = circle.eye;
        scene.outer.iter().for_each(|&slot| self.find(slot, scene, circle, stats));
        let Some(shells) = Shells::new(&scene.grid, eye).filter(|_| !are_few(scene, view)) else {
            // An occluder may stick out of its bounds.
            let is_near = |object: &Object| {
                let mut shapes = [Some(&object.bounds), object.occluder.as_ref()].into_iter().flatten();
                view.range().is_none() || shapes.any(|shape| view.reaches(&shape.block()))
            };
            let near = scene.living().filter(|(_, object)| is_near(object));
            return near.for_each(|(slot, _)| self.find(slot, scene, circle, stats));
        };
        self.covers.reset(eye, arcs);
        let cell = scene.grid.cell;
        let (first, last) = shells.numbers();
        // The nearest points of a shell are one cell less away than its number says.
        let end = view.range().map_or(f64::INFINITY, |range| range / cell + 2.0);
        let marks = &scene.lists.occupied;
        let (mut noticed, mut closing, mut check) = (0, true, scene.len() / MOST_LEFT);
        for shell in first..=last {
            if f64::from(shell) > end || self.covers.open.is_empty() {
                break;
            }
            if shell == 0 {
                self.visit(scene, scene.grid.cell_of(eye), circle, stats);
                self.covers.closed.extend_from_slice(&self.blocked);
            } else {
                let covers = std::mem::take(&mut self.covers);
                let visit = &mut |cell| self.visit(scene, cell, circle, stats);
                shells.cells(shell, if closing { &covers.open } else { &covers.view }, marks, visit);
                self.covers = covers;
            }
            if !closing {
                continue;
            }
            self.keep_shown(circle, &shells, noticed);
            noticed = self.walls.len();
            self.covers.close(circle, &self.walls, &shells, shell);
            if self.found.len() > check {
                closing = !self.covers.is_wide();
                check = 2 * self.found.len();
            }
        }
    }

    /// Takes the walls within the range of a view from a list.
    pub(crate) fn take(&mut self, walls: &[Segment], view: &View) {
        self.clear(0);
        self.walls.reserve(walls.len());
        let near = |wall: &&Segment| view.reaches(&Block::around(&[wall.a, wall.b]));
        let sides = walls.iter().filter(near).map(|wall| [wall.a, wall.b].map(|p| p.as_dvec2()));
        self.walls.extend(sides.filter_map(|[a, b]| Wall::new(view.eye(), a, b, NOBODY)));
    }

    /// Drops the walls from number `first` on that lie in closed directions, where nearer ones hide
    /// them.
    fn keep_shown(&mut self, circle: &Circle, shells: &Shells, first: usize) {
        let mut kept = first;
        for i in first..self.walls.len() {
            let wall = self.walls[i];
            let shows = self.covers.may_show(circle, &wall);
            if let Some(own) = self.own.get_mut(wall.owner as usize).filter(|own| **own == i as u32) {
                *own = if shows { kept as u32 } else { NOBODY };
            }
            if shows {
                self.covers.wait(shells, kept as u32, &wall);
                self.walls[kept] = wall;
                kept += 1;
            }
        }
        self.walls.truncate(kept);
    }

    /// Finds the objects in a cell.
    fn visit(&mut self, scene: &Scene, cell: IVec2, circle: &Circle, stats: &mut Stats) {
        scene.lists.get(cell).iter().for_each(|&slot| self.find(slot, scene, circle, stats));
    }

    /// Takes notice of an object, once, and of its occluder.
    fn find(&mut self, slot: Slot, scene: &Scene, circle: &Circle, stats: &mut Stats) {
        let Some(object) = scene.object(slot) else { return };
        if std::mem::replace(&mut self.marks[slot.index()], true) {
            return;
        }
        self.found.push(slot);
        self.own.push(NOBODY);
        let Some(occluder) = &object.occluder else { return };
        let owner = if object.bounds == *occluder { self.found.len() as u32 - 1 } else { NOBODY };
        if occluder.surrounds(circle.eye) {
            stats.eye_in_occluder = true;
        } else {
            let first = self.walls.len();
            if occluder.contains(circle.eye) {
                self.blocked.extend(into_solid(occluder, circle));
            }
            let eye = circle.eye;
            occluder.front_sides(eye, |a, b| self.walls.extend(Wall::new(eye, a, b, owner)));
            if owner != NOBODY && matches!(occluder, Shape::Segment(_)) && first < self.walls.len() {
                self.own[owner as usize] = first as u32;
            }
        }
    }
}

/// Whether a scene has few objects for a view, and few sides that hide: the narrower the view, the
/// fewer.
fn are_few(scene: &Scene, view: &View) -> bool {
    let most = (FEW * (view.half_angle() / PI)) as usize;
    let sides = |object: &Object| object.occluder.as_ref().map_or(0, Shape::sides);
    scene.len() <= most && scene.living().map(|(_, object)| sides(object)).sum::<usize>() <= most
}

/// The directions from an eye on the border of a solid into it; nothing for discs, which hide
/// nothing from eyes that may be inside.
fn into_solid(shape: &Shape, circle: &Circle) -> Arcs {
    // Counterclockwise.
    let corners: Vec<DVec2> = match shape {
        Shape::Rect(rect) if rect.min.cmplt(rect.max).all() => rect.corners().map(|p| p.as_dvec2()).into(),
        Shape::Polygon(polygon) => polygon.corners().iter().map(|p| p.as_dvec2()).collect(),
        _ => return Arcs::new(),
    };
    let (eye, count) = (circle.eye, corners.len());
    for i in 0..count {
        let (before, at, after) = (corners[(i + count - 1) % count], corners[i], corners[(i + 1) % count]);
        if at == eye {
            return between(circle, after, before).collect();
        }
        let on_side = orient(at, after, eye) == 0.0 && (eye - at).dot(after - eye) > 0.0;
        if on_side {
            return between(circle, after, at).collect();
        }
    }
    Arcs::new()
}
