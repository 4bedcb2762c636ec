//! What the device gets: cells, states, triangles and lights, in single precision.

use std::collections::HashMap;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::cache::Cache;
use crate::input::{Light, Sky};
use crate::numeric::GRIDS;
use crate::surfaces::Surface;

/// The number of a triangle is split at this power of two.
pub(super) const LOW: u32 = 1 << 12;

/// The middle of a state's starts, and the range of these.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
pub(super) struct State {
    middle: [f32; 3],
    first: u32,
    count: u32,
    covered: u32,
    unused: [u32; 2],
}

/// `CascaGrid` of the shader.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(super) struct Grid {
    low: [f32; 3],
    cell: f32,
    dims: [i32; 3],
    heads: u32,
    tree: u32,
    list: u32,
    parts: u32,
    count: u32,
    holes: u32,
    unused: [u32; 3],
    levels: [Level; GRIDS],
}

/// `CascaLevel` of the shader.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
struct Level {
    low: [i32; 3],
    fine: f32,
    dims: [i32; 3],
    brick: u32,
}

/// A vector with a fourth component.
pub(super) fn four(v: Vec3, last: f32) -> [f32; 4] {
    v.extend(last).to_array()
}

/// The cells as numbers, and where the parts start.
pub(super) fn cells(cache: &Cache) -> (Grid, Vec<u32>) {
    let voxels = &cache.voxels;
    let (ranks, heads) = voxels.tables();
    let masks = voxels.masks.iter().zip(ranks);
    let mut all: Vec<u32> = masks.flat_map(|(m, rank)| [*m as u32, (*m >> 32) as u32, *rank]).collect();
    let at_heads = all.len() as u32;
    all.extend(heads);
    let (parts, triangles) = voxels.tree.flat();
    let tree = all.len() as u32;
    all.extend(parts.as_flattened());
    let list = all.len() as u32;
    all.extend(triangles);
    let holes = add_holes(&voxels.surfaces, &mut all);
    let lattice = &voxels.lattice;
    let mut levels = [Level::default(); GRIDS];
    for (level, of) in levels.iter_mut().zip(lattice.levels()) {
        let (low, dims) = (of.low.to_array(), of.dims.to_array());
        *level = Level { low, fine: of.fine as f32, dims, brick: of.first_brick };
    }
    let grid = Grid {
        low: lattice.min.as_vec3().to_array(),
        cell: lattice.cell as f32,
        dims: lattice.dims.to_array(),
        heads: at_heads,
        tree,
        list,
        parts: parts.len() as u32,
        count: lattice.levels().len() as u32,
        holes,
        unused: [0; 3],
        levels,
    };
    (grid, all)
}

/// Adds the holes of triangles, and returns where they start, or 0 if there are none: by triangle 0 or a
/// place; there where its corners lie in a texture, the size of that, and where its bits start: 1 is solid.
fn add_holes(surfaces: &[Surface], all: &mut Vec<u32>) -> u32 {
    let skin = |s: &Surface| s.skin.clone().filter(|skin| skin.texture.has_holes());
    if !surfaces.iter().any(|s| skin(s).is_some()) {
        return 0;
    }
    let start = all.len();
    all.resize(start + surfaces.len(), 0);
    let mut bits = HashMap::new();
    for (number, skin) in surfaces.iter().enumerate().filter_map(|(i, s)| Some((i, skin(s)?))) {
        let texels = skin.texture.texels();
        let bits = *bits.entry(texels.as_ptr()).or_insert_with(|| {
            let bit = |(i, t): (u32, &[u8; 4])| u32::from(t[3] > 0) << i;
            all.extend(texels.chunks(32).map(|word| (0..).zip(word).map(bit).sum::<u32>()));
            (all.len() - texels.len().div_ceil(32)) as u32
        });
        all[start + number] = all.len() as u32;
        let (width, height) = skin.texture.size();
        all.extend(skin.uv.iter().flat_map(|p| p.to_array().map(f32::to_bits)).chain([width, height, bits]));
    }
    start as u32
}

/// The gathered states and their starts.
pub(super) fn states(cache: &Cache) -> (Vec<State>, Vec<[f32; 4]>) {
    let mut states = vec![State::default(); cache.glow.len()];
    let mut starts = Vec::new();
    for &state in &cache.gathered {
        let of_state = cache.starts(state);
        if of_state.is_empty() {
            continue;
        }
        let middle = of_state.iter().map(|s| s.at).sum::<Vec3>() / of_state.len() as f32;
        let (first, count) = (starts.len() as u32, of_state.len() as u32);
        states[state as usize] = State {
            middle: middle.to_array(),
            first,
            count,
            covered: of_state[0].covered.into(),
            unused: [0; 2],
        };
        starts.extend(of_state.iter().map(|s| four(s.at, 0.0)));
    }
    (states, starts)
}

/// A corner and two edges of each triangle, with the slack of the three coordinates.
pub(super) fn triangles(cache: &Cache) -> Vec<[[f32; 4]; 3]> {
    let of = |s: &Surface| {
        let [a, b, c] = s.corners;
        let slack = s.slack().map(|s| s as f32);
        [four(a.as_vec3(), slack[0]), four((b - a).as_vec3(), slack[1]), four((c - a).as_vec3(), slack[2])]
    };
    cache.voxels.surfaces.iter().map(of).collect()
}

/// By triangle: the share that it scatters by steradian, its emission, and its normal.
pub(super) fn skins(cache: &Cache) -> Vec<[[f32; 4]; 3]> {
    let of = |s: &Surface| {
        let m = &cache.materials[s.material as usize];
        [four(s.mean().0 / std::f32::consts::PI, 0.0), four(m.emission, 0.0), four(s.normal.as_vec3(), 0.0)]
    };
    cache.voxels.surfaces.iter().map(of).collect()
}

/// Up, and the radiance at the zenith, at the horizon and at the nadir.
pub(super) fn open_sky(cache: &Cache) -> [[f32; 4]; 4] {
    let (up, zenith, horizon, nadir) = match cache.sky {
        Sky::Even(radiance) => (Vec3::Y, radiance, radiance, radiance),
        Sky::Gradient { up, zenith, horizon, nadir } => (up, zenith, horizon, nadir),
    };
    let up = up.as_dvec3().normalize_or_zero().as_vec3();
    [up, zenith, horizon, nadir].map(|v| four(v, 0.0))
}

/// `CascaCounts` of the shader.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(super) struct Counts {
    lights: u32,
    lamps: u32,
    light_rays: u32,
    lamp_points: u32,
    lamp_rays: u32,
    power: f32,
    unused: [u32; 2],
}

/// Lights of four vectors each, and lamps of two: the mean radiance and the share of the power up
/// to it, the triangle's number in two halves and the luminance.
pub(super) fn sources(cache: &Cache) -> (Counts, Vec<[f32; 4]>) {
    let mut all: Vec<[f32; 4]> = cache.lights.iter().flat_map(|light| vectors(cache, light)).collect();
    let (lamps, power) = cache.lamps.described(&cache.voxels);
    for (number, radiance, bright, share) in &lamps {
        // Halves of the number are exact in single precision.
        let [low, high] = [number % LOW, number / LOW].map(|n| n as f32);
        all.extend([four(*radiance, *share as f32), [low, *bright as f32, high, 0.0]]);
    }
    let settings = &cache.settings;
    let counts = Counts {
        lights: cache.lights.len() as u32,
        lamps: lamps.len() as u32,
        light_rays: settings.light_rays,
        lamp_points: settings.lamp_points,
        lamp_rays: settings.lamp_rays,
        power: power as f32,
        unused: [0; 2],
    };
    (counts, all)
}

fn vectors(cache: &Cache, light: &Light) -> [[f32; 4]; 4] {
    let lattice = &cache.voxels.lattice;
    let cells = |p| lattice.cells(p).as_vec3();
    let cell = lattice.cell as f32;
    let unit = |v: Vec3| v.as_dvec3().normalize_or_zero().as_vec3();
    let none = [0.0; 4];
    match *light {
        Light::Point { position, intensity, radius } => {
            [four(cells(position), 0.0), four(intensity, radius / cell), none, none]
        }
        Light::Spot { position, direction, intensity, inner, outer, radius } => [
            four(cells(position), 1.0),
            four(intensity, radius / cell),
            four(unit(direction), outer.cos()),
            [0.0, 0.0, 0.0, inner.cos()],
        ],
        Light::Sun { direction, irradiance, half_angle } => {
            [four(-unit(direction), 2.0), four(irradiance, half_angle.tan()), none, none]
        }
    }
}
