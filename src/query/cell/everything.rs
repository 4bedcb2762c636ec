//! Views from which nothing is taken to be hidden: objects are compared with the frustum, and no
//! cells are visited.

use casca_slots::Slot;

use crate::grid::cell_box::CellBox;
use crate::query::cell::finder::Finder;

/// An entry of the list of all that the frustum meets, in the order in which it is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Found {
    Volume,
    Object,
}

/// Finds the volumes and objects in the frustum, in the order of the shells in which their boxes
/// begin. The cost follows the number of objects, wherever they are.
pub(super) fn find_everything(finder: &mut Finder) {
    let (scene, view, shells) = (finder.scene, finder.view, finder.shells);
    let may_see_volume_of = |slot: Slot| {
        let in_frustum =
            |cells: &CellBox| shells.frustum.meets(cells.lo - shells.cell, cells.hi - shells.cell);
        view.may_see_volume(&scene.volume_block(slot)) || scene.volume_cells(slot).is_some_and(in_frustum)
    };
    let mut found = Vec::new();
    for (slot, object) in scene.living().filter(|(_, object)| object.is_shown(view)) {
        let mut first = 0;
        if object.is_hidden() {
            if !may_see_volume_of(slot) {
                continue;
            }
            first = shells.begin_of(&scene.volume_block(slot));
            found.push((first, slot, Found::Volume));
            if object.on_expiry() {
                continue;
            }
        } else {
            finder.marks.decide(slot);
        }
        if finder.is_in_view(slot) {
            found.push((shells.begin_of(&object.bounds().block()).max(first), slot, Found::Object));
        }
    }
    found.sort_unstable();
    for (_, slot, what) in found {
        match what {
            Found::Volume => _ = finder.uncover(slot),
            Found::Object => finder.add(slot),
        }
    }
}
