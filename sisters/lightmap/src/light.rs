//! The light of texels and probes, by a radiosity cache.

use std::f32::consts::PI;

use casca_radiosity::lit::{LitObject, LitScene};
use casca_radiosity::{Cache, Grid, LightError, Scene, Statistics};
use glam::{Affine3A, Vec3};
use rayon::prelude::*;

use uvunwrap::Atlas;

use crate::atlas::{PADDING, Placed, texels, unwrap};
use crate::{Backs, BakeError, Probes, Settings};

/// Rays of a probe for each of its faces; of texels, where no surface in a cell answers.
const ANSWER_RAYS: u32 = 512;
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

/// A scene that is lit, and whose probes follow what moves.
pub struct Following {
    scene: LitScene,
    cache: Cache,
    /// The light in the open, as objects stand now.
    pub probes: Probes,
    /// Of states that are asked for, and of others.
    rays: (u32, u32),
}

impl Following {
    /// Lights a scene, and probes around it: [`Settings`] say how. Takes as long as a bake without texels.
    ///
    /// # Errors
    /// As [`Probes::new`], and the scene cannot be lit.
    pub fn new(scene: LitScene, settings: &Settings) -> Result<Self, BakeError> {
        let mut dark = Self::dark(scene, settings)?;
        dark.light(&[], &mut |_, _, _| {})?;
        Ok(dark)
    }

    /// Moves objects of the scene, by their numbers, and lights the probes anew. Only rays that can have
    /// changed are sent; what leaves the box of the probes lights nothing.
    ///
    /// # Errors
    /// There is no such object, or the scene cannot be lit so.
    pub fn moved(&mut self, places: &[(usize, Affine3A)]) -> Result<(), BakeError> {
        let object = |(number, place): &(usize, Affine3A)| {
            let object = self.scene.objects.get(*number);
            // The cache says that there is no such object.
            let object =
                object.map(|o| LitObject { transform: *place, ..o.clone() }.lit(&self.scene.materials));
            (*number, object.unwrap_or_default())
        };
        self.cache.set_objects(places.iter().map(object).collect())?;
        places.iter().for_each(|(number, place)| self.scene.objects[*number].transform = *place);
        self.light(&[], &mut |_, _, _| {}).map(|_| ())
    }

    /// A scene in a cache, and probes without light.
    fn dark(scene: LitScene, settings: &Settings) -> Result<Self, BakeError> {
        settings.check()?;
        let given = Scene::from(&scene);
        let grid = Grid::around(&given.objects, settings.cells);
        let probes = Probes::new((grid.min, grid.max), settings.spacing)?;
        let mut how = casca_radiosity::Settings::new(grid);
        how.answer_rays = ANSWER_RAYS;
        let cache = Cache::new(&given, how)?;
        Ok(Self { scene, cache, probes, rays: (settings.rays, settings.rays.div_ceil(FARTHER)) })
    }

    /// Finds the light of the probes and of more questions; returns the backs of solids.
    fn light(&mut self, questions: &[(Vec3, Vec3)], progress: &mut Progress) -> Result<Backs, BakeError> {
        let cubes = self.probes.questions();
        let all = questions.len() + cubes.len();
        for (i, (point, normal)) in questions.iter().chain(&cubes).enumerate() {
            if i % PART == 0 {
                progress("asking for light", i, all);
            }
            self.cache.request(*point, *normal)?;
        }
        let mut sent = 0;
        while self.cache.waiting() > 0 {
            sent += self.cache.waiting().min(PART);
            let waiting = self.cache.gather_part(self.rays, PART)?;
            progress("sending rays", sent, sent + waiting);
        }
        progress("passing light along", 0, 1);
        // Else a room whose door is shut would keep some light.
        self.cache.darken();
        self.cache.direct();
        self.cache.converge(SETTLED, MOST_PASSES);
        // Engines light what moves by lights that are no surfaces.
        self.cache.set_lights(&[])?;
        let open = answers(&self.cache, &cubes, ("lighting probes", progress));
        self.cache.set_lights(&self.scene.lights)?;
        self.probes.cubes.copy_from_slice(open?.as_chunks().0);
        let backs = Backs::new(&self.scene.triangles());
        self.probes.fill(&backs);
        Ok(backs)
    }
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
    let mut lit = Following::dark(scene.clone(), settings)?;
    progress("unwrapping meshes", 0, placed.len());
    let atlas = unwrap(placed, settings.texels, settings.side)?;
    let texels = texels(&atlas, placed);
    let questions: Vec<(Vec3, Vec3)> = texels.lit.iter().map(|t| (t.point, t.normal)).collect();
    let backs = lit.light(&questions, progress)?;
    if settings.live {
        lit.cache.set_lights(&[])?;
    }
    let found = answers(&lit.cache, &questions, ("lighting texels", progress))?;
    let Following { cache, probes, .. } = lit;
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
