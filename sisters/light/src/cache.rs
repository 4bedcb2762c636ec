//! The cache: which states are gathered, their rays, their direct light, and the passes.

use std::f32::consts::PI;
use std::sync::OnceLock;

use glam::Vec3;
use rayon::prelude::*;

use crate::direct::{Lamps, Sources, Spot};
use crate::error::{LightError, some_rays};
use crate::input::{Light, Material, Object, Scene, Settings, Sky, check_lights};
use crate::lattice::Lattice;
use crate::numeric::{MEANS, MOST_LINKS, MOST_STORED};
use crate::queues::{Unlit, Waiting, Wish};
use crate::spread::mix;
use crate::states::{Bundle, DARK, Ray, SKY, Start};
use crate::surfaces::{Skipped, surfaces};
use crate::texture::Texture;
use crate::voxels::Voxels;

/// The rays of a state: a range of [`Cache::rays`], empty if it is not gathered.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Block {
    pub(crate) first: u32,
    pub(crate) count: u32,
}

impl Block {
    pub(crate) fn range(&self) -> std::ops::Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }
}

/// The light of one state: irradiances, and the radiance that it sends out.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Glow {
    pub(crate) direct: Vec3,
    pub(crate) indirect: Vec3,
    /// The sum over rays to the sky.
    pub(crate) sky: Vec3,
    pub(crate) out: Vec3,
}

/// The states that one is averaged with, [`crate::voxels::NONE`] where there are fewer.
pub(crate) type Links = [u32; MOST_LINKS];

/// The starts of each state, found when they are first asked for.
#[derive(Debug, Clone, Default)]
pub(crate) struct StartTable(pub(crate) Vec<OnceLock<Box<[Start]>>>);

impl StartTable {
    pub(crate) fn new(states: u32) -> Self {
        Self((0..states).map(|_| OnceLock::new()).collect())
    }

    pub(crate) fn of(&self, voxels: &Voxels, state: u32) -> &[Start] {
        self.0[state as usize].get_or_init(|| voxels.starts(state).into_vec().into())
    }
}

/// What has been counted.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Statistics {
    /// Cells of the grid along each axis, with one around the box on each side.
    pub dims: [i32; 3],
    /// Triangles that were left out or cut.
    pub skipped: Skipped,
    /// Surfaces in cells; each has two states.
    pub entries: usize,
    /// States with rays.
    pub gathered: usize,
    /// Stored rays.
    pub rays: usize,
    /// Those of them that hit a surface for which no state can stand: they carry no light.
    pub dark_rays: usize,
    /// Bytes of the cache.
    pub bytes: usize,
}

/// Diffuse light on the surfaces of a scene, with all of its bounces.
#[derive(Debug, Clone)]
pub struct Cache {
    pub(crate) settings: Settings,
    pub(crate) objects: Vec<Object>,
    pub(crate) materials: Vec<Material>,
    pub(crate) textures: Vec<Texture>,
    pub(crate) lights: Vec<Light>,
    pub(crate) sky: Sky,
    pub(crate) skipped: Skipped,
    pub(crate) voxels: Voxels,
    pub(crate) lamps: Lamps,
    pub(crate) starts: StartTable,
    pub(crate) blocks: Vec<Block>,
    pub(crate) rays: Vec<Ray>,
    pub(crate) glow: Vec<Glow>,
    /// States with rays, in order.
    pub(crate) gathered: Vec<u32>,
    /// By state: its links, if they are known.
    pub(crate) links: Vec<Option<Links>>,
    /// By state; empty if nothing was smoothed since the light changed.
    pub(crate) smoothed: Vec<Vec3>,
    pub(crate) waiting: Waiting,
    pub(crate) unlit: Unlit,
    /// Passes in place so far: they run forwards and backwards in turn.
    pub(crate) passes: u32,
}

impl Cache {
    /// Puts the surfaces of a scene into cells. No state is gathered yet: see [`Cache::request`].
    ///
    /// Costs the touched cells times their logarithm.
    ///
    /// # Errors
    /// If settings, materials, lights or sky are out of range, a triangle names no material, or
    /// the triangles touch too many cells. Triangles that cannot be lit are left out and counted.
    pub fn new(scene: &Scene, settings: Settings) -> Result<Self, LightError> {
        settings.check()?;
        scene.check()?;
        let lattice = Lattice::new(&settings.grid, &settings.windows);
        let mut skipped = Skipped::default();
        let all = surfaces(&scene.objects, (&scene.materials, &scene.textures), &lattice, &mut skipped);
        let voxels = Voxels::new(lattice, all)?;
        let states = voxels.states() as usize;
        Ok(Self {
            settings,
            objects: scene.objects.clone(),
            lights: scene.lights.clone(),
            sky: scene.sky,
            skipped,
            lamps: Lamps::new(&voxels, &scene.materials),
            materials: scene.materials.clone(),
            textures: scene.textures.clone(),
            starts: StartTable::new(voxels.states()),
            voxels,
            blocks: vec![Block::default(); states],
            rays: Vec::new(),
            glow: vec![Glow::default(); states],
            gathered: Vec::new(),
            links: vec![None; states],
            smoothed: Vec::new(),
            waiting: Waiting::new(states),
            unlit: Unlit::default(),
            passes: 0,
        })
    }

    pub(crate) fn starts(&self, state: u32) -> &[Start] {
        self.starts.of(&self.voxels, state)
    }

    /// Asks for a state, if it has no rays.
    pub(crate) fn want(&mut self, state: u32, wish: Wish) {
        if self.blocks[state as usize].count == 0 {
            self.waiting.add(state, wish);
        }
    }

    /// Asks for the states of all surfaces, also of those that nobody sees.
    pub fn request_all(&mut self) {
        (0..self.voxels.states()).for_each(|s| self.want(s, Wish::Asked));
    }

    /// Sends rays from so many of the states that wait, and lets the states wait that they hit;
    /// returns how many wait now. States that questions asked for come first and send `rays.0` each.
    /// When there are none, and each fourth time, those that were hit come, oldest first, and send
    /// `rays.1`: they are farther from what is seen, and need fewer.
    ///
    /// A state sends the same rays whenever its turn comes.
    ///
    /// # Errors
    /// If no state has so many rays, or too many rays would be stored; then all of them wait on.
    pub fn gather_part(&mut self, rays: (u32, u32), states: usize) -> Result<usize, LightError> {
        let most = states.min(self.waiting.count());
        self.check_room(rays.0, most)?;
        self.check_room(rays.1, most)?;
        let (wish, mut part) = self.waiting.take(most);
        part.sort_unstable();
        self.gather_states(&part, if wish == Wish::Asked { rays.0 } else { rays.1 });
        Ok(self.waiting.count())
    }

    /// How many states wait for rays: see [`Cache::gather_part`].
    pub fn waiting(&self) -> usize {
        self.waiting.count()
    }

    /// Whether so many states may store so many rays each.
    pub(crate) fn check_room(&self, rays: u32, states: usize) -> Result<(), LightError> {
        some_rays("rays", rays)?;
        let needed = self.rays.len().saturating_add(states.saturating_mul(rays as usize));
        if needed >= MOST_STORED { Err(LightError::TooManyRays { rays: needed }) } else { Ok(()) }
    }

    /// Sends rays from states that have none, and lets the states wait that they hit.
    pub(crate) fn gather_states(&mut self, ring: &[u32], rays: u32) {
        let found: Vec<_> = ring.par_iter().map(|&state| self.trace(state, rays)).collect();
        for (&state, mut of_state) in ring.iter().zip(found) {
            let first = self.rays.len() as u32;
            self.blocks[state as usize] = Block { first, count: rays };
            self.gathered.push(state);
            self.rays.append(&mut of_state);
        }
        for &state in ring {
            for i in self.blocks[state as usize].range() {
                let target = self.rays[i].target;
                if target < DARK {
                    self.want(target, Wish::Hit);
                }
            }
            self.sum_sky(state);
        }
        self.gathered.sort_unstable();
        self.unlit.add_new(ring);
        self.unlink(ring);
    }

    /// Gathers until no state waits. Rays are sent once: they are stored, and need not be sent again
    /// while nothing moves.
    ///
    /// # Errors
    /// See [`Cache::gather_part`].
    pub fn gather(&mut self, rays: u32) -> Result<(), LightError> {
        while self.gather_part((rays, rays), usize::MAX)? > 0 {}
        Ok(())
    }

    /// The rays of a state. A state that is buried sees nothing.
    fn trace(&self, state: u32, rays: u32) -> Vec<Ray> {
        let starts = self.starts(state);
        if starts.is_empty() {
            return vec![Ray::BURIED; rays as usize];
        }
        let bundle = Bundle::new(starts, rays, self.voxels.key(state));
        let of = |i| {
            let (start, direction) = bundle.ray(i);
            self.voxels.trace(start, direction, &|s| self.starts(s))
        };
        (0..rays).map(of).collect()
    }

    /// Adds up what the rays of a state see of the sky.
    pub(crate) fn sum_sky(&mut self, state: u32) {
        let block = self.blocks[state as usize];
        let rays = &self.rays[block.range()];
        let mut sum = Vec3::ZERO;
        if rays.iter().any(|r| r.target == SKY) {
            let key = self.voxels.key(state);
            let bundle = Bundle::new(self.starts(state), block.count, key);
            let sky = (0..).zip(rays).filter(|(_, r)| r.target == SKY);
            sum = sky.map(|(i, _)| self.sky.radiance(bundle.ray(i).1.as_vec3())).sum();
        }
        self.glow[state as usize].sky = sum;
    }

    pub(crate) fn sources(&self) -> Sources<'_> {
        Sources { voxels: &self.voxels, lights: &self.lights, lamps: &self.lamps, settings: &self.settings }
    }

    /// Finds the direct light of all gathered states anew, by shadow rays.
    pub fn direct(&mut self) {
        let all = std::mem::take(&mut self.gathered);
        self.light(&all);
        self.gathered = all;
        self.unlit.clear();
    }

    /// As [`Cache::direct`], but for so many states; returns how many have none or an old light
    /// now. Those that have none come first, and then those whose light is the oldest. It is old
    /// after [`Cache::set_lights`] or [`Cache::set_objects`].
    pub fn direct_part(&mut self, states: usize) -> usize {
        let part = self.unlit.take(states);
        self.light(&part);
        self.unlit.count()
    }

    /// Finds the direct light of some states.
    pub(crate) fn light(&mut self, states: &[u32]) {
        let found: Vec<_> = states.par_iter().map(|&state| self.direct_of(state)).collect();
        for (&state, direct) in states.iter().zip(found) {
            self.glow[state as usize].direct = direct;
            self.send(state);
        }
    }

    /// The mean over the starts of a state.
    pub(crate) fn direct_of(&self, state: u32) -> Vec3 {
        let starts = self.starts(state);
        let count = starts.len().max(1) as u32;
        let sources = self.sources();
        let key = self.voxels.key(state);
        let of = |(i, s): (u64, &Start)| {
            let (at, normal) = (s.at.as_dvec3(), s.normal.as_dvec3());
            sources.irradiance(&Spot { at, normal, key: mix(key ^ mix(i)) }, count)
        };
        (0..).zip(starts).map(of).sum::<Vec3>() / count as f32
    }

    /// Computes the radiance that a state scatters from its irradiance.
    pub(crate) fn send(&mut self, state: u32) {
        let albedo = self.voxels.entries[state as usize / 2].albedo;
        let glow = &mut self.glow[state as usize];
        glow.out = albedo / PI * (glow.direct + glow.indirect);
    }

    /// One pass: each gathered state takes in what its rays read, and sends it on at once, forwards
    /// and backwards in turn (Gauss and Seidel). Returns the sum of changes of the indirect
    /// irradiance over its sum, which falls about as the mean albedo to the power of passes.
    ///
    /// Costs one look-up for each stored ray.
    pub fn pass(&mut self) -> f64 {
        let (mut change, mut sum) = (0.0_f64, 0.0_f64);
        let count = self.gathered.len();
        let is_back = self.passes % 2 == 1;
        self.passes += 1;
        self.smoothed.clear();
        for i in 0..count {
            let state = self.gathered[if is_back { count - 1 - i } else { i }];
            let block = self.blocks[state as usize];
            let mut light = self.glow[state as usize].sky;
            for ray in &self.rays[block.range()] {
                if ray.target < DARK {
                    light += self.glow[ray.target as usize].out;
                }
            }
            light *= PI / block.count as f32;
            let glow = &mut self.glow[state as usize];
            change += f64::from((light - glow.indirect).abs().element_sum());
            sum += f64::from(light.element_sum());
            glow.indirect = light;
            self.send(state);
        }
        if sum > 0.0 { change / sum } else { 0.0 }
    }

    /// Passes until a pass changes less than a share, `most` at most; returns their number. Answers
    /// are smoothed then, twice; [`Cache::smooth`] with 0 gives them as rays found them.
    pub fn converge(&mut self, share: f64, most: u32) -> u32 {
        let passes = (1..=most).find(|_| self.pass() < share).unwrap_or(most);
        self.smooth(MEANS);
        passes
    }

    /// Replaces the lights. No ray is sent again: call [`Cache::direct`] and then passes.
    ///
    /// # Errors
    /// If a light is out of range; then the old ones stay.
    pub fn set_lights(&mut self, lights: &[Light]) -> Result<(), LightError> {
        check_lights(lights)?;
        self.lights = lights.to_vec();
        self.unlit.add_all(&self.gathered, self.glow.len());
        Ok(())
    }

    /// Forgets all indirect light, but no rays: passes start anew.
    pub fn darken(&mut self) {
        self.passes = 0;
        self.smoothed.clear();
        for state in 0..self.voxels.states() {
            self.glow[state as usize].indirect = Vec3::ZERO;
            self.send(state);
        }
    }

    /// What there is. O(rays).
    pub fn statistics(&self) -> Statistics {
        let starts = self.starts.0.iter().filter_map(|s| s.get());
        let bytes = self.voxels.bytes()
            + size_of_val(&self.starts.0[..])
            + starts.map(|s| size_of_val(&s[..])).sum::<usize>()
            + size_of_val(&self.blocks[..])
            + size_of_val(&self.rays[..])
            + size_of_val(&self.glow[..])
            + size_of_val(&self.gathered[..])
            + size_of_val(&self.links[..])
            + size_of_val(&self.smoothed[..]);
        Statistics {
            dims: self.voxels.lattice.dims.to_array(),
            skipped: self.skipped,
            entries: self.voxels.entries.len(),
            gathered: self.gathered.len(),
            rays: self.rays.len(),
            dark_rays: self.rays.iter().filter(|r| r.target == DARK).count(),
            bytes,
        }
    }
}
