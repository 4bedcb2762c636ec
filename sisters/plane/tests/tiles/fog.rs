//! Fog of war against plain sets.

use std::collections::BTreeSet;

use casca_plane::{BitGrid, Error, FieldOfView, Fog, FovOptions, OpaqueTiles, TileState};
use glam::UVec2;
use proptest::prelude::*;

use crate::cases::cases;
use crate::maps::{coordinate, map, point};

/// A map and the eyes of some frames.
fn frames() -> impl Strategy<Value = (BitGrid, Vec<Vec<[i128; 2]>>)> {
    map().prop_flat_map(|map| {
        let eye = (coordinate(map.width()), coordinate(map.height())).prop_map(|(x, y)| [x, y]);
        (Just(map), proptest::collection::vec(proptest::collection::vec(eye, 0..4), 0..5))
    })
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn fog_remembers((map, frames) in frames(), radius in 0.5..6.0_f32) {
        let options = FovOptions::default().in_circle(radius).unwrap();
        let tiles = OpaqueTiles::new(map);
        let (mut fog, mut fov) = (Fog::new(tiles.width(), tiles.height()), FieldOfView::new());
        let mut ever = BTreeSet::new();
        for eyes in frames {
            fog.begin_frame();
            let mut seen = BTreeSet::new();
            for eye in eyes {
                seen.extend(fov.run(&tiles, point(eye), &options).cells());
                fog.add(&fov).unwrap();
            }
            ever.extend(&seen);
            prop_assert_eq!(fog.seen().cells().collect::<BTreeSet<_>>(), seen.clone());
            prop_assert_eq!(fog.ever_seen().cells().collect::<BTreeSet<_>>(), ever.clone());
            for (x, y) in (0..14).flat_map(|y| (0..14).map(move |x| (x, y))) {
                let state = match (seen.contains(&(x, y)), ever.contains(&(x, y))) {
                    (true, _) => TileState::Seen,
                    (_, true) => TileState::Remembered,
                    _ => TileState::Unseen,
                };
                prop_assert_eq!(fog.state(x, y), state);
            }
        }
        let saved = Fog::with_memory(fog.ever_seen().clone());
        prop_assert_eq!(saved.ever_seen(), fog.ever_seen());
    }
}

#[test]
fn fields_of_view_of_other_maps_are_refused() {
    let mut fog = Fog::new(8, 8);
    let other = Error::Dimensions { found: UVec2::ZERO, map: UVec2::splat(8) };
    assert_eq!(fog.add(&FieldOfView::new()), Err(other));
}
