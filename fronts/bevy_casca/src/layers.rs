//! Layers: which occluders count in which view.
//!
//! An entity hides others only in views that draw it. Cameras draw what shares a render layer with
//! them; lights draw of that what casts shadows. So casca's 64 layers are two halves: one bit for
//! each of the first 31 render layers and one for all others, as cameras see them, and the same
//! again as lights see them.

use bevy_camera::visibility::RenderLayers;

/// The bit of all render layers that have none of their own.
const OTHERS: u64 = 1 << 31;

/// From the bits of cameras to those of lights.
const LIGHTS: u32 = 32;

/// The render layers by 32 bits; the last one stands for all from 31 on.
pub(crate) fn of_camera(layers: Option<&RenderLayers>) -> u64 {
    let Some(layers) = layers else { return 1 };
    let blocks = layers.bits();
    let first = blocks.first().copied().unwrap_or(0);
    let others = first >= OTHERS || blocks.iter().skip(1).any(|&block| block != 0);
    first & (OTHERS - 1) | if others { OTHERS } else { 0 }
}

/// The layers of an entity that is drawn where it should be: nowhere if it is hidden.
pub(crate) fn of_entity(layers: Option<&RenderLayers>, hidden: bool, casts_shadows: bool) -> u64 {
    if hidden {
        return 0;
    }
    let bits = of_camera(layers);
    bits | if casts_shadows { bits << LIGHTS } else { 0 }
}

/// Whether an entity on these layers is drawn by all views that share a bit with it.
pub(crate) fn may_hide(layers: u64) -> bool {
    layers & OTHERS == 0
}

pub(crate) fn of_light(layers: Option<&RenderLayers>) -> u64 {
    of_camera(layers) << LIGHTS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entities_share_a_bit_with_all_views_that_draw_them() {
        let sets: [&[usize]; 7] = [&[], &[0], &[1, 3], &[30], &[31], &[40, 2], &[64, 200]];
        let sets = sets.map(RenderLayers::from_layers);
        // Of another place: Bevy takes a set to intersect itself even if it is empty.
        let others = sets.clone();
        for a in sets.iter().map(Some).chain([None]) {
            for b in others.iter().map(Some).chain([None]) {
                let drawn =
                    a.unwrap_or(&RenderLayers::default()).intersects(b.unwrap_or(&RenderLayers::default()));
                let entity = of_entity(a, false, true);
                let (camera, light) = (of_camera(b) & entity != 0, of_light(b) & entity != 0);
                assert!(!drawn || camera && light, "{a:?} {b:?}");
                assert!(drawn || !(camera || light) || !may_hide(entity), "{a:?} hides in {b:?}");
                assert_eq!(of_light(b) & of_entity(a, false, false), 0, "it casts no shadow");
                assert_eq!(of_camera(b) & of_entity(a, true, true), 0, "it is hidden");
            }
        }
    }
}
