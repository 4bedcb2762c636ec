//! Settings tried on the views of a level.

use casca::{Error, KeptQuery, Method, PointOptions, Query};
use casca_scenes::drive::{Driver, fitted_cell, view_of};
use casca_scenes::measure::timed;
use casca_scenes::world::World;

use super::views::{FRAMES, SETTLE, Views};

/// Occluders are tried without those whose diagonal is a smaller share of that of the level.
const SMALL: f32 = 0.03;
/// Each frame is timed so often, and the least time counts.
const ROUNDS: usize = 2;

/// A setting, and what frames take with it.
#[derive(Debug, Clone)]
pub struct Tried {
    /// In the words of the library's options.
    pub setting: String,
    /// The edge of a cell in metres.
    pub cell: f32,
    /// Milliseconds of queries, ascending.
    pub times: Vec<f64>,
    /// Objects found, by frame.
    pub found: Vec<usize>,
}

impl Tried {
    /// Objects found in the mean frame.
    pub fn set(&self) -> f64 {
        self.found.iter().sum::<usize>() as f64 / self.found.len().max(1) as f64
    }

    /// Milliseconds of the mean query.
    pub fn mean(&self) -> f64 {
        self.times.iter().sum::<f64>() / self.times.len().max(1) as f64
    }

    /// The milliseconds within which this share of queries is.
    pub fn within(&self, share: f64) -> f64 {
        self.times
            .get((self.times.len().saturating_sub(1) as f64 * share).round() as usize)
            .copied()
            .unwrap_or(0.0)
    }

    /// Milliseconds of the mean frame, if an object costs so many microseconds.
    pub fn cost(&self, worth: f64) -> f64 {
        self.mean() + self.set() * worth / 1e3
    }
}

/// What answers.
enum Engine {
    Fresh(Box<Query>),
    Kept(Box<KeptQuery>),
}

/// What is tried: frustum culling alone, then settings.
pub struct Trials {
    /// What frustum culling alone takes.
    pub frustum: Tried,
    /// The settings of the library.
    pub settings: Vec<Tried>,
    /// The scene with cells as the library advises.
    pub driver: Driver,
}

impl Trials {
    /// Tries all settings.
    ///
    /// # Errors
    /// The library refuses the level.
    pub fn of(world: &World, views: &Views) -> Result<Self, Error> {
        let cell = fitted_cell(world)?;
        let driver = Driver::new(world, cell, |_| ())?;
        let point =
            |name: &str, options: PointOptions| (format!("PointOptions::{name}"), Method::Point(options));
        let run = |driver: &Driver, cell: f32, (setting, method): (String, Method)| {
            let query = || Ok(Engine::Fresh(Box::new(Query::with_method(method)?)));
            tried(world, driver, views, (setting, cell), query)
        };
        let frustum = run(&driver, cell, ("frustum culling alone".to_owned(), Method::Frustum))?;
        let mut settings = Vec::new();
        for way in [
            point("fast()", PointOptions::fast()),
            point("balanced()", PointOptions::balanced()),
            point("balanced().coherent(true)", PointOptions::balanced().coherent(true)),
        ] {
            settings.push(run(&driver, cell, way)?);
        }
        let kept = || Ok(Engine::Kept(Box::default()));
        settings.push(tried(world, &driver, views, ("KeptQuery".to_owned(), cell), kept)?);
        for other in [cell * 2.0, cell / 2.0] {
            let driver = Driver::new(world, other, |_| ())?;
            settings.push(run(&driver, other, point("balanced()", PointOptions::balanced()))?);
        }
        let least = (world.grid.max - world.grid.min).length() * SMALL;
        let mut objects = world.objects.clone();
        for object in &mut objects {
            let (min, max) = object.shape.bounds();
            object.occludes &= (max - min).length() >= least;
        }
        let large = Driver::with(&objects, cell, None, |_, desc| desc, |_| ())?;
        let (name, method) = point("balanced()", PointOptions::balanced());
        settings.push(run(&large, cell, (format!("{name}, if nothing below {least:.2} m hides"), method))?);
        Ok(Self { frustum, settings, driver })
    }

    /// The cheapest setting if an object costs so many microseconds.
    pub fn best(&self, worth: f64) -> &Tried {
        let cheaper = |a: &&Tried, b: &&Tried| a.cost(worth).total_cmp(&b.cost(worth));
        self.settings.iter().min_by(cheaper).unwrap_or(&self.frustum)
    }

    /// From how many microseconds an object on a setting costs less than frustum culling alone;
    /// infinite if none does.
    pub fn pays_from(&self) -> f64 {
        let pays = |tried: &Tried| {
            let (time, objects) = (tried.mean() - self.frustum.mean(), self.frustum.set() - tried.set());
            if objects > 0.0 { (time * 1e3 / objects).max(0.0) } else { f64::INFINITY }
        };
        self.settings.iter().map(pays).fold(f64::INFINITY, f64::min)
    }
}

fn tried(
    world: &World,
    driver: &Driver,
    views: &Views,
    (setting, cell): (String, f32),
    engine: impl Fn() -> Result<Engine, Error>,
) -> Result<Tried, Error> {
    let mut least = vec![f64::INFINITY; views.cameras.len()];
    let mut found = Vec::new();
    for _ in 0..ROUNDS {
        let mut engine = engine()?;
        found.clear();
        for (camera, least) in views.cameras.iter().zip(&mut least) {
            let view = view_of(camera)?;
            let (pvs, time) = timed(|| match &mut engine {
                Engine::Fresh(query) => query.run(&driver.scene, &view),
                Engine::Kept(query) => query.run(&driver.scene, &view),
            });
            *least = least.min(time.as_secs_f64() * 1e3);
            found.push(driver.count(pvs, &world.objects));
        }
    }
    let counts = |frame: &usize| frame % FRAMES >= SETTLE;
    let mut times: Vec<f64> = (0..least.len()).filter(counts).map(|i| least[i]).collect();
    times.sort_by(f64::total_cmp);
    Ok(Tried { setting, cell, times, found: (0..found.len()).filter(counts).map(|i| found[i]).collect() })
}
