//! Assets that the renderer was told of: what it was not told of it cannot draw with.

use bevy_asset::{Asset, AssetEvent, AssetId, AssetServer, Assets, RenderAssetUsages, UntypedAssetId};
use bevy_ecs::prelude::*;
use bevy_image::Image;
use bevy_platform::collections::HashMap;

/// The assets of a kind that the renderer was told of, and the frame in which it was.
pub(crate) type Told<A> = HashMap<AssetId<A>, u32>;

/// Reads what the renderer reads in this frame, too. Calls `removed` for what went.
pub(crate) fn hear<A: Asset>(
    told: &mut Told<A>,
    events: Option<MessageReader<AssetEvent<A>>>,
    frame: u32,
    can_be_used: impl Fn(AssetId<A>) -> bool,
    mut removed: impl FnMut(AssetId<A>),
) {
    let Some(mut events) = events else { return };
    for event in events.read() {
        let (AssetEvent::Added { id }
        | AssetEvent::Modified { id }
        | AssetEvent::Removed { id }
        | AssetEvent::Unused { id }) = *event
        else {
            continue;
        };
        if matches!(event, AssetEvent::Added { .. } | AssetEvent::Modified { .. }) && can_be_used(id) {
            told.entry(id).or_insert(frame);
        } else if told.remove(&id).is_some() {
            removed(id);
        }
    }
}

/// The images that materials may be drawn with.
#[derive(Resource, Default)]
pub(crate) struct Images {
    told: Told<Image>,
    pub(crate) frame: u32,
    /// Whether an image went in this frame.
    pub(crate) lost: bool,
}

impl Images {
    /// Whether the renderer can use an asset that a material depends on. It may prepare an image
    /// after the materials of the same frame: these wait for the next one.
    pub(crate) fn has(&self, id: UntypedAssetId, server: Option<&AssetServer>) -> bool {
        match id.try_typed::<Image>() {
            Ok(image) => self.told.get(&image).is_some_and(|told| *told != self.frame),
            // The server does not know of those that were made, not loaded.
            Err(_) => {
                server.and_then(|server| server.get_load_state(id)).is_none_or(|state| state.is_loaded())
            }
        }
    }
}

/// Follows the images that come and go.
pub(crate) fn follow_images(
    mut images: ResMut<Images>,
    assets: Option<Res<Assets<Image>>>,
    events: Option<MessageReader<AssetEvent<Image>>>,
) {
    let Images { told, frame, lost } = &mut *images;
    *frame = frame.wrapping_add(1);
    *lost = false;
    let for_renderer = |image: &Image| image.asset_usage.contains(RenderAssetUsages::RENDER_WORLD);
    let can_be_used = |id| assets.as_ref().and_then(|all| all.get(id)).is_some_and(for_renderer);
    hear(told, events, *frame, can_be_used, |_| *lost = true);
}
