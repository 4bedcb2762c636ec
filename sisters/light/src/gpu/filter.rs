//! Smoother light on the device: see [`Cache::smooth`].

use wgpu::{Buffer, BufferUsages, CommandEncoder, Device};

use super::{Filter, GpuCache, GpuError, bind, filled, number, pipeline};
use crate::cache::Cache;
use crate::numeric::MOST_LINKS;
use crate::voxels::NONE;

impl GpuCache {
    /// Uploads which states may be averaged, for [`GpuCache::smooth`]: once for each upload of the
    /// cache, since links change only with the states. Costs a short ray for each link, unless
    /// [`Cache::link`] found them.
    ///
    /// # Errors
    /// If the cache was gathered since, or the device's buffers are too small.
    pub fn link(&mut self, device: &Device, cache: &Cache) -> Result<(), GpuError> {
        let (now, then) = (cache.gathered.len(), self.states);
        if now != then {
            return Err(GpuError::Changed { now, then });
        }
        let links = filled(device, "links", &cache.found_links(), BufferUsages::STORAGE)?;
        let none = vec![[0.0_f32; 4]; cache.glow.len()];
        let means = [0, 1].map(|_| filled(device, "smoothed light", &none, BufferUsages::STORAGE));
        let [first, second] = means;
        let means = [first?, second?];
        let made = || {
            let constants = format!("const MOST_LINKS = {MOST_LINKS};\nconst NONE = {NONE}u;\n");
            pipeline(device, constants + include_str!("filter.wgsl"), "smoothed")
        };
        let pipeline = self.pipelines.smoothed.get_or_insert_with(made);
        let layout = pipeline.get_bind_group_layout(0);
        let group = |from: &Buffer, to: &Buffer| {
            bind(device, &layout, &number(&[&self.count, &self.blocks, &links, from, to]))
        };
        let groups =
            [group(&self.indirect, &means[0]), group(&means[0], &means[1]), group(&means[1], &means[0])];
        self.filter = Some(Filter { means, groups });
        self.shown = 0;
        Ok(())
    }

    /// Averages the indirect light of pictures over neighbouring states, so many times, as
    /// [`Cache::smooth`] does: after passes. Pictures are of the smoothed light until the next
    /// pass. Does nothing before [`GpuCache::link`].
    pub fn smooth(&mut self, encoder: &mut CommandEncoder, times: u32) {
        self.shown = 0;
        for _ in 0..times {
            let (Some(filter), Some(pipeline)) = (&self.filter, &self.pipelines.smoothed) else { return };
            self.dispatch(encoder, pipeline, &filter.groups[self.shown]);
            self.shown = if self.shown == 1 { 2 } else { 1 };
        }
    }

    /// The light that pictures show.
    pub(super) fn answers(&self) -> &Buffer {
        match (&self.filter, self.shown) {
            (Some(filter), 1 | 2) => &filter.means[self.shown - 1],
            _ => &self.indirect,
        }
    }
}
