//! The lines of the program, at any time, and views of them.

use std::path::Path;

use casca_lines::gpu::context::{Context, GREY, GpuContext};
use casca_lines::gpu::numeric::FARTHEST;
use casca_lines::gpu::set::GpuLines;
use casca_lines::gpu::settings::Settings;
use casca_lines::mesh::Mesh;
use casca_lines::occlusion::AoOptions;
use casca_lines::sets::colour::{Colouring, Legend};
use casca_lines::sets::generate::Recipe;
use casca_lines::sets::region::Region;
use casca_lines::sets::rooms::House;
use casca_lines::sets::{LineSet, files};
use casca_lines::view::{Lens, View, ViewError};
use casca_scenes::import;
use casca_scenes::world::Shape;
use casca_stage::gpu::Gpu;
use glam::{Vec3, Vec3A, vec3};

use crate::common::Failed;
use crate::lines::options::Options;

/// Lines of a room, unless the command line says otherwise.
const ROOM_LINES: u32 = 400;
/// How far vertices of generated sets may sway, and lines be thick, as a share of the extent.
const ROOM: f32 = 0.07;
/// The vertical angle of view: 40 degrees.
const FOV_Y: f64 = 2.0 * std::f64::consts::PI / 9.0;
/// The least depth in perspective, as a share of the extent.
const NEAREST: f32 = 2e-3;
/// The extents of lines, and their greatest distance from the origin: squares of longer and of
/// shorter ways do not fit into single precision, so that pictures would be empty.
const SIZES: std::ops::RangeInclusive<f32> = 1e-15..=1e18;

enum Kind {
    File(LineSet),
    Generated(Recipe),
    /// The side of the house and the lines of a room.
    Rooms(u32, u32),
}

/// Where lines come from.
pub struct Source {
    /// For titles and files.
    pub name: String,
    kind: Kind,
    seed: u64,
    /// The regions that generated lines must cross, and those that they must not.
    regions: [Vec<Region>; 2],
    colouring: Colouring,
    /// The bounds at time 0, and some room for the motion.
    pub bounds: [Vec3; 2],
    /// The meshes and walls that hide lines.
    pub context: Vec<Context>,
}

impl Source {
    /// Reads or makes the lines that the command line asks for.
    pub fn open(options: &Options) -> Result<Self, Failed> {
        let (name, kind) = match (&options.common.file, options.rooms) {
            (Some(path), _) => {
                let name = path.file_stem().map_or("file".into(), |n| n.to_string_lossy());
                let all = files::open(Path::new(path))?;
                (name.into_owned(), Kind::File(all.within(&options.include, &options.exclude)))
            }
            (None, Some(side)) => {
                ("rooms".to_owned(), Kind::Rooms(side, options.lines.unwrap_or(ROOM_LINES)))
            }
            (None, None) => {
                let usual = Recipe::new(options.set, options.seed);
                let lines = options.lines.unwrap_or(usual.lines);
                (options.set.name().to_owned(), Kind::Generated(Recipe { lines, ..usual }))
            }
        };
        let mut source = Self {
            name,
            kind,
            seed: options.seed,
            regions: [options.include.clone(), options.exclude.clone()],
            colouring: options.colour.clone(),
            bounds: [Vec3::ZERO; 2],
            context: Vec::new(),
        };
        let lines = source.at(0.0)?;
        if lines.points().is_empty() {
            let why = match (source.regions.iter().all(Vec::is_empty), &source.kind) {
                (false, _) => "--include and --exclude leave no line",
                (true, Kind::File(_)) => "there is no line in this file (--context takes triangles)",
                (true, _) => "there is no line in this set",
            };
            return Err(format!("{}: {why}", options.common.name().unwrap_or(source.name)).into());
        }
        lines.colours(&source.colouring)?;
        source.bounds = lines.bounds();
        if let Kind::Rooms(side, _) = source.kind {
            source.context.push(Context::of_boxes(&House::new(side, 0, source.seed, 0.0)?.walls));
        }
        for path in &options.context {
            source.context.push(Context::new(open_context(path)?, GREY)?);
        }
        let corners = || source.context.iter().flat_map(|c| &c.mesh().positions);
        source.bounds = corners().fold(source.bounds, |[min, max], c| [min.min(*c), max.max(*c)]);
        source.check_size()?;
        Ok(source)
    }

    /// Refuses lines that would not be seen.
    fn check_size(&self) -> Result<(), Failed> {
        let (extent, [low, high]) = (self.extent(), [SIZES.start(), SIZES.end()]);
        let far = self.bounds.map(|c| c.abs().max_element()).into_iter().fold(0.0, f32::max);
        if SIZES.contains(&extent) && far <= *high {
            return Ok(());
        }
        let why = format!("pictures take {low:e} to {high:e} units: scale the lines");
        Err(format!("{}: {extent:e} units wide, up to {far:e} from the origin: {why}", self.name).into())
    }

    /// Whether lines are others at other times: those of files stand still.
    pub fn moves(&self) -> bool {
        !matches!(self.kind, Kind::File(_))
    }

    /// The lines at a time in seconds.
    pub fn at(&self, time: f64) -> Result<LineSet, Failed> {
        let chosen = |lines: LineSet| match self.regions.iter().all(Vec::is_empty) {
            true => lines,
            false => lines.within(&self.regions[0], &self.regions[1]),
        };
        Ok(match &self.kind {
            Kind::Generated(recipe) => chosen(Recipe { time, ..*recipe }.make()?),
            Kind::Rooms(side, lines) => chosen(House::new(*side, *lines, self.seed, time)?.lines),
            Kind::File(lines) => lines.clone(),
        })
    }

    /// Copies the context to a device.
    pub fn context_on_device(&self, gpu: &Gpu) -> Result<Vec<GpuContext>, Failed> {
        Ok(self.context.iter().map(|context| GpuContext::new(gpu, context)).collect::<Result<_, _>>()?)
    }

    /// Copies lines to a device and paints them, and says what their colours mean.
    pub fn on_device(
        &self,
        gpu: &Gpu,
        lines: &LineSet,
        settings: &Settings,
    ) -> Result<(GpuLines, Legend), Failed> {
        let mut on_device = GpuLines::new(gpu, lines, settings)?;
        let Some(colours) = lines.colours(&self.colouring)? else { return Ok((on_device, Legend::Own)) };
        on_device.paint(gpu, lines, Some(&colours.of_vertices))?;
        Ok((on_device, colours.legend))
    }

    /// The longest side of the bounds of a set, or of a room.
    pub fn extent(&self) -> f32 {
        match self.kind {
            Kind::Rooms(..) => 2.0,
            _ => {
                let size = (self.bounds[1] - self.bounds[0]).max_element();
                let distance = self.bounds.map(|c| c.abs().max_element()).into_iter().fold(0.0, f32::max);
                // A set of one point has the size of what is around it.
                [size, distance * 1e-3, 1.0].into_iter().find(|s| *s > 0.0).unwrap_or(1.0)
            }
        }
    }

    /// What is computed in a view.
    pub fn settings(&self, options: &Options, view: &View) -> Settings {
        let [near, far] = view.depths();
        let tube = view.pixel_size((near + far) / 2.0) as f32 * options.tube;
        let radius = options.radius * self.extent();
        let estimator = options.estimator.estimator([radius, tube]);
        let ao = AoOptions { radius, estimator, solid: options.solid };
        let samples = options.samples();
        let (sets, antialiasing) = (sets(samples), options.antialiasing());
        Settings { ao, samples, sets, antialiasing }
    }

    /// Where the eye starts, and the place that it looks at. In a house it is in the first room.
    pub fn start(&self, options: &Options, size: [u32; 2]) -> Result<[Vec3; 2], Failed> {
        if let Kind::Rooms(side, _) = self.kind {
            return Ok(House::new(side, 0, self.seed, 0.0)?.eye(0));
        }
        let around = View::around(self.bounds, options.from, Some(FOV_Y), size)?;
        let eye = around.to_world(Vec3::ZERO).as_vec3();
        Ok([eye, self.bounds[0] * 0.5 + self.bounds[1] * 0.5])
    }

    /// A view from an eye, with depths that hold all lines.
    pub fn view(
        &self,
        options: &Options,
        [eye, target]: [Vec3; 2],
        size: [u32; 2],
    ) -> Result<View, ViewError> {
        let forward = (target - eye).normalize_or(Vec3::NEG_Z);
        let up = if forward.y.abs() < 0.999 { Vec3::Y } else { Vec3::Z };
        let room = self.extent() * ROOM;
        let [min, max] = [self.bounds[0] - room, self.bounds[1] + room];
        let corner = |i: u32| {
            let pick = |bit: u32, low: f32, high: f32| if i >> bit & 1 == 0 { low } else { high };
            vec3(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z))
        };
        let depths = (0..8).map(|i| f64::from((corner(i) - eye).dot(forward)));
        let (near, far) = depths.fold((f64::MAX, f64::MIN), |(n, f), d| (n.min(d), f.max(d)));
        // The renderer refuses depths that are nearer to each other, seen from here.
        let near = near.min(far - far.abs() * 1.05 / FARTHEST);
        let least = f64::from(self.extent() * NEAREST);
        let zoom = f64::from(options.zoom);
        let lens = Lens::Perspective { fov_y: 2.0 * ((FOV_Y / 2.0).tan() / zoom).atan() };
        let near = near.max(least);
        View::look_at([eye, eye + forward * self.extent(), up], lens, [near, far.max(near + least)], size)
    }
}

/// The triangles of a file: those of all objects of glTF, or of OBJ or PLY.
fn open_context(path: &Path) -> Result<Mesh, Failed> {
    let ending = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    if !ending.is_some_and(|e| e == "glb" || e == "gltf") {
        return Ok(files::open_mesh(path)?);
    }
    let mut all = Mesh::default();
    let world = import::load(path)?;
    for object in world.objects {
        let Shape::Mesh { mesh, mut transform } = object.shape else { continue };
        // Lines have the coordinates of their files.
        transform.translation += Vec3A::from(world.source.origin.as_vec3());
        let first = all.positions.len() as u32;
        all.positions.extend(mesh.positions.iter().map(|&p| transform.transform_point3(p)));
        all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    Ok(all)
}

/// So many sets that making them takes less than a second.
fn sets(samples: u32) -> u32 {
    (8192 / samples.max(1)).clamp(1, 16)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::parsed;

    #[test]
    fn views_from_afar_have_depths_that_the_renderer_takes() {
        let options = parsed::<Options>(&["--lines", "20"]).unwrap();
        let source = Source::open(&options).unwrap();
        for eye in [vec3(0.0, 0.0, 3.0), vec3(0.0, 0.0, 1e4), vec3(0.0, 0.0, -1e4)] {
            let view = source.view(&options, [eye, eye - Vec3::Z], [32, 24]).unwrap();
            let [near, far] = view.depths();
            assert!(near.abs().max(far.abs()) < FARTHEST * (far - near), "{eye}: {near} {far}");
        }
    }
}
