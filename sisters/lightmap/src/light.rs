//! The light of texels and probes, by a radiosity cache.

use std::f32::consts::PI;

use casca_radiosity::lit::LitScene;
use casca_radiosity::{Cache, Grid, LightError, Scene, Statistics};
use glam::Vec3;
use rayon::{current_num_threads, prelude::*};

use uvunwrap::Atlas;

use crate::atlas::{PADDING, Placed, texels, unwrap};
use crate::probes::{FACES, Probes};
use crate::{Backs, BakeError, Settings};

/// Rays of a probe for each of its faces; of texels, where no surface in a cell answers.
const ANSWER_RAYS: u32 = 128;
/// States that send their rays between two calls of the progress.
const PART: usize = 4096;
/// The share of rays of states that no texel reads.
const FARTHER: u32 = 4;
/// Light is settled if a pass changes less than this share of it; it would take so many at most.
const SETTLED: f64 = 1e-4;
const MOST_PASSES: u32 = 64;

/// What is told of the work: what is done, how much of it, and of how much.
pub type Progress<'a> = dyn FnMut(&str, usize, usize) + 'a;

/// The light of a level.
#[derive(Debug, Clone)]
pub struct Light {
    /// Where each mesh lies in the pages.
    pub atlas: Atlas,
    /// The texels of all pages, row by row: what a matt white surface there scatters.
    pub texels: Vec<Vec3>,
    /// Texels that were lit; others repeat them, or lie beside all charts.
    pub lit: usize,
    /// The light in the open: all but what comes straight from lights that are no surfaces.
    pub probes: Probes,
    /// What the cache held.
    pub statistics: Statistics,
}

/// Lights the texels of meshes, and probes around the scene that these stand in, by the threads of the
/// current pool of `rayon`, on which results do not depend.
///
/// # Errors
/// As [`unwrap`] and [`Probes::new`], and the scene cannot be lit.
pub fn light(
    scene: &LitScene,
    placed: &[Placed],
    settings: &Settings,
    progress: &mut Progress,
) -> Result<Light, BakeError> {
    settings.check()?;
    let given = Scene::from(scene);
    let grid = Grid::around(&given.objects, settings.cells);
    let mut probes = Probes::new((grid.min, grid.max), settings.spacing)?;
    progress("unwrapping meshes", 0, placed.len());
    let atlas = unwrap(placed, settings.texels, settings.side)?;
    let texels = texels(&atlas, placed);
    let questions: Vec<(Vec3, Vec3)> = texels.lit.iter().map(|t| (t.point, t.normal)).collect();
    let places = (0..probes.cubes.len()).map(|i| probes.place(i));
    let cubes: Vec<(Vec3, Vec3)> = places.flat_map(|p| FACES.map(|face| (p, face))).collect();

    let mut how = casca_radiosity::Settings::new(grid);
    (how.threads, how.answer_rays) = (current_num_threads() as u32, ANSWER_RAYS);
    let mut cache = Cache::new(&given, how)?;
    let all = questions.len() + cubes.len();
    for (i, (point, normal)) in questions.iter().chain(&cubes).enumerate() {
        if i % PART == 0 {
            progress("asking for light", i, all);
        }
        cache.request(*point, *normal)?;
    }
    let rays = (settings.rays, settings.rays.div_ceil(FARTHER));
    let mut sent = 0;
    while cache.waiting() > 0 {
        sent += cache.waiting().min(PART);
        let waiting = cache.gather_part(rays, PART)?;
        progress("sending rays", sent, sent + waiting);
    }
    progress("passing light along", 0, 1);
    cache.direct();
    cache.converge(SETTLED, MOST_PASSES);
    if settings.live {
        cache.set_lights(&[])?;
    }
    let found = answers(&cache, &questions, ("lighting texels", progress))?;
    // Engines light what moves themselves.
    cache.set_lights(&[])?;
    let open = answers(&cache, &cubes, ("lighting probes", progress))?;
    probes.cubes.copy_from_slice(open.as_chunks().0);
    let backs = Backs::new(&scene.triangles());
    probes.fill(&backs);

    let mut pages = vec![None; (atlas.page_count * atlas.width * atlas.height) as usize];
    // Else walls would have dark lines at their feet: there surfaces go on within them.
    let mut buried = Vec::new();
    for (t, color) in texels.lit.iter().zip(&found) {
        if *color == Vec3::ZERO && backs.is_buried(t.point, Some(t.normal)) {
            buried.push(t.number as usize);
        } else {
            pages[t.number as usize] = Some(*color);
        }
    }
    buried.sort_unstable();
    let row = atlas.width as usize;
    let around = |at: usize| {
        [at.wrapping_sub(row), at, at + row].into_iter().flat_map(|at| [at.wrapping_sub(1), at, at + 1])
    };
    for _ in 0..PADDING {
        // Only texels of the same chart are so near.
        let mean = |&at: &usize| {
            let near: Vec<Vec3> = around(at).filter_map(|at| *pages.get(at)?).collect();
            (!near.is_empty()).then(|| (at, near.iter().sum::<Vec3>() / near.len() as f32))
        };
        let filled: Vec<(usize, Vec3)> = buried.iter().filter_map(mean).collect();
        buried.retain(|at| filled.binary_search_by_key(at, |f| f.0).is_err());
        filled.into_iter().for_each(|(at, color)| pages[at] = Some(color));
    }
    for (to, from) in &texels.repeated {
        pages[*to as usize] = pages[*from as usize];
    }
    let pages = pages.into_iter().map(Option::unwrap_or_default).collect();
    Ok(Light { atlas, texels: pages, lit: found.len(), probes, statistics: cache.statistics() })
}

/// What matt white surfaces scatter at points with normals, in order.
fn answers(
    cache: &Cache,
    questions: &[(Vec3, Vec3)],
    (what, progress): (&str, &mut Progress),
) -> Result<Vec<Vec3>, LightError> {
    let of = |(point, normal): &(Vec3, Vec3)| {
        let light = cache.irradiance(*point, *normal)?;
        Ok((light.direct + light.indirect) / PI)
    };
    let mut found = Vec::with_capacity(questions.len());
    for part in questions.chunks(PART) {
        progress(what, found.len(), questions.len());
        found.extend(part.par_iter().map(of).collect::<Result<Vec<_>, LightError>>()?);
    }
    Ok(found)
}
