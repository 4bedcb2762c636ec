//! `casca doctor LEVEL`: what of a level hides, what does not and why, which settings suit it, and
//! what culling saves in it.
//!
//! - `parts`: the surfaces that hide and those that do not, by reasons.
//! - `views`: where one may look from.
//! - `trial`: settings, tried there.
//! - `above`: a picture from above.

mod above;
mod parts;
mod trial;
mod views;

use std::path::{Path, PathBuf};
use std::slice::from_ref;

use casca::{Method, Query};
use casca_scenes::drive::{Driver, view_of};
use casca_scenes::generated::SceneOptions;
use casca_scenes::import::{ImportError, Trouble};
use casca_scenes::name::SceneName;
use casca_scenes::world::{Camera, Object, World};
use casca_tools::command_line::{EXIT_CODES, Outcome, say, try_writing};
use casca_truth::oracle::{Oracle, OracleOptions, Seen};
use clap::Args;

use above::Fate;
use parts::Parts;
use trial::Trials;
use views::{FRAMES, Views};

/// What an object may cost, in microseconds.
const WORTHS: [f64; 3] = [1.0, 10.0, 100.0];
/// Culling that leaves out a smaller share of the frustum is of no use.
const LEAST_HIDDEN: f64 = 0.05;
/// A level with no more objects leaves nothing to leave out.
const FEW: usize = 10;
/// Views that are compared with exact visibility.
const CHECKED: usize = 8;

/// Says what of a level hides, what does not and why, and what culling saves in it
///
/// Times are of this machine, so use a release build. Views come from the camera of the file if that
/// moves, else from places on its floors. What moves stands still where it is at first.
#[derive(Debug, Clone, Args)]
#[command(after_help = EXIT_CODES)]
pub struct Options {
    /// A glTF 2.0 file (.glb, .gltf), or a generated scene such as city
    pub level: SceneName,
    /// Where the picture from above goes [default: target/doctor and the name of the level]
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Also compares some views with exact visibility, and exits with 1 if a visible object is lost
    #[arg(long)]
    pub check: bool,
    /// Seed of places
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

/// Why a level cannot be examined.
pub type Failed = Box<dyn std::error::Error>;

/// Examines a level, and prints what it finds.
///
/// # Errors
/// The level cannot be read, is refused, or the picture cannot be written.
pub fn run(options: &Options) -> Result<Outcome, Failed> {
    let world = options.level.open(&SceneOptions::default()).map_err(advised)?;
    let own = || PathBuf::from(format!("target/doctor/{}.png", world.name));
    let out = options.out.clone().unwrap_or_else(own);
    try_writing(&out)?;
    let parts = Parts::of(&world);
    say_parts(&world, &parts);
    let (world, views) = Views::of(world, options.seed);
    let trials = Trials::of(&world, &views).map_err(|why| refused(&world, why))?;
    say_trials(&views, &trials, world.objects.len());
    say(format_args!("\n{}", verdict(&trials, world.objects.len())));
    picture(&out, &world, &views, &trials)?;
    say(format_args!("A picture from above: {}", out.display()));
    if options.check { check(&world, &views, &trials, options.seed) } else { Ok(Outcome::Well) }
}

/// A failure with what to do about it.
fn advised(why: ImportError) -> Failed {
    match &why.why {
        Trouble::Extensions(_) => format!("{why}: export the level without them").into(),
        _ => why.into(),
    }
}

/// The error, with the object that the library refuses.
fn refused(world: &World, why: casca::Error) -> Failed {
    let is_refused =
        |object: &&Object| Driver::with(from_ref(object), 1.0, None, |_, desc| desc, |_| ()).is_err();
    match world.objects.iter().find(is_refused) {
        Some(object) => format!("casca refuses the object {:?}: {why}", object.name).into(),
        None => why.into(),
    }
}

fn say_parts(world: &World, parts: &Parts) {
    let size = world.grid.max - world.grid.min;
    let all = &parts.all;
    say(format_args!(
        "{}: {} objects ({} move), {} triangles, {:.3} x {:.3} x {:.3} m",
        world.name, all.objects, parts.moving, all.triangles, size.x, size.y, size.z
    ));
    let row = |name: &str, part: &parts::Part| {
        let share = 100.0 * part.area / all.area.max(f64::MIN_POSITIVE);
        let (objects, triangles, names) = (part.objects, part.triangles, part.names());
        say(format_args!("{objects:>9}{triangles:>11}{share:>9.1}%  {name}{names}"));
    };
    say(format_args!(
        "\nWhat hides: {:.1}% of all surfaces\n  objects  triangles   surface",
        100.0 * parts.share()
    ));
    parts.hide.iter().for_each(|(sides, part)| row(sides, part));
    if !parts.clear.is_empty() {
        say("\nWhat hides nothing, and why");
        parts.clear.iter().for_each(|(why, part)| row(why, part));
    }
    if !world.source.warnings.is_empty() {
        say("\nWhat the reader says of the file");
        world.source.warnings.iter().for_each(|line| say(format_args!("  {line}")));
    }
}

fn say_trials(views: &Views, trials: &Trials, objects: usize) {
    let (frustum, cell) = (&trials.frustum, trials.settings.first().map_or(0.0, |s| s.cell));
    say(format_args!("\n{} views {}", frustum.times.len(), views.from));
    if cfg!(debug_assertions) {
        say("This build is not optimised: its times mean nothing.");
    }
    say(format_args!("Cells of {cell:.3} m are what `cell_for` advises for {objects} objects\n"));
    say("   median       99%   objects   cell  setting");
    for tried in std::iter::once(frustum).chain(&trials.settings) {
        let (median, most) = (tried.within(0.5), tried.within(0.99));
        let (set, cell, setting) = (tried.set(), tried.cell, &tried.setting);
        say(format_args!("{median:>6.3} ms {most:>6.3} ms {set:>9.1} {cell:>6.3}  {setting}"));
    }
    say("\nMilliseconds of a mean frame, query and objects");
    for worth in WORTHS {
        let (best, alone) = (trials.best(worth), frustum.cost(worth));
        let saved = alone - best.cost(worth);
        say(format_args!(
            "  {worth:>3} us an object: frustum culling alone {alone:.3}, casca {:.3}: {} {:.3} ({}, cells of {:.3} m)",
            best.cost(worth),
            if saved < 0.0 { "costs" } else { "saves" },
            saved.abs(),
            best.setting,
            best.cell
        ));
    }
}

/// What to do, in a sentence.
fn verdict(trials: &Trials, objects: usize) -> String {
    if objects <= FEW {
        return format!(
            "casca leaves out whole objects, and all of this level is {objects}: \
             make rooms and things objects of their own, or cull nothing."
        );
    }
    let (frustum, best) = (trials.frustum.set(), trials.best(WORTHS[1]).set());
    let (hidden, from) = (1.0 - best / frustum.max(1.0), trials.pays_from());
    if hidden < LEAST_HIDDEN {
        return format!(
            "Hardly anything hides anything else here: of {frustum:.1} objects in the frustum {best:.1} may be seen. \
             Frustum culling is enough."
        );
    }
    let share = format!("casca leaves out {:.0}% of the objects in the frustum here", 100.0 * hidden);
    match from {
        from if from <= WORTHS[0] => {
            format!("{share}, and saves more than it costs from {from:.2} us an object on.")
        }
        from if from <= WORTHS[2] => format!(
            "{share}. At {} us an object it costs more than it saves; it pays from {from:.1} us on.",
            WORTHS[0]
        ),
        _ => format!("{share}, but even at {} us an object it costs more than it saves.", WORTHS[2]),
    }
}

/// Draws the view that leaves out the median number of objects.
fn picture(out: &Path, world: &World, views: &Views, trials: &Trials) -> Result<(), Failed> {
    let (mut frustum, mut point) = (Query::with_method(Method::Frustum)?, Query::new());
    let mut seen = |camera: &Camera| -> Result<Vec<Fate>, casca::Error> {
        let view = view_of(camera)?;
        let (all, found) = (frustum.run(&trials.driver.scene, &view), point.run(&trials.driver.scene, &view));
        let fate = |i: usize| match (trials.driver.sees(found, i), trials.driver.sees(all, i)) {
            (true, _) => Fate::Drawn,
            (false, true) => Fate::Hidden,
            (false, false) => Fate::Outside,
        };
        Ok((0..world.objects.len()).map(fate).collect())
    };
    let mut frames = Vec::new();
    for camera in views.cameras.iter().skip(FRAMES / 2).step_by(FRAMES) {
        let fates = seen(camera)?;
        frames.push((fates.iter().filter(|f| **f == Fate::Hidden).count(), camera, fates));
    }
    frames.sort_by_key(|frame| frame.0);
    let Some((_, camera, fates)) = frames.get(frames.len() / 2) else { return Ok(()) };
    let eyes: Vec<_> = views.cameras.iter().map(|camera| camera.eye).collect();
    above::draw(out, world, camera, (fates, &eyes, !views.indoors))?;
    Ok(())
}

/// Compares some views with exact visibility.
fn check(world: &World, views: &Views, trials: &Trials, seed: u64) -> Result<Outcome, Failed> {
    let seen = Seen::of(world);
    let objects = seen.objects(&world.objects);
    let mut oracle =
        Oracle::new(objects, OracleOptions { width: 960, height: 540, seed, ..OracleOptions::default() });
    let mut query = Query::new();
    let (mut lost, mut visible, mut found, mut rays) = (0, 0, 0, 0);
    let cameras: Vec<_> = views.cameras.iter().step_by((views.cameras.len() / CHECKED).max(1)).collect();
    for camera in &cameras {
        let pvs = query.run(&trials.driver.scene, &view_of(camera)?);
        let verdict = oracle.frame(objects, &[], camera, &|i| trials.driver.sees(pvs, i));
        (lost, visible) = (lost + verdict.false_negatives.len(), visible + verdict.exact.len());
        (found, rays) = (found + trials.driver.count(pvs, objects), rays + verdict.rays + verdict.item_rays);
    }
    say(format_args!(
        "Checked in {} views by {:.1} M rays: {lost} visible objects are lost; {found} objects were found for {visible} visible ones",
        cameras.len(),
        rays as f64 / 1e6
    ));
    Ok(if lost > 0 { Outcome::Lost } else { Outcome::Well })
}
