//! Commands for clouds larger than memory: `bricks` cuts a file, `walk` goes through it.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use casca::{Aabb, Method, ObjectDesc, Query, Scene, View, cell_for};
use casca_points::Camera;
use casca_points::bricks::{Bricks, BuildOptions, Builder, Loader};
use casca_points::files::read_chunks;
use casca_stage::timing::Instant;
use casca_stage::window::Done;
use casca_tools::command_line::say;
use clap::Args;
use glam::{DVec3, Vec3, vec3};

use crate::common::Failed;
use crate::points::operators::warned;

/// Cut a file into bricks, which `walk` reads.
#[derive(Debug, Args)]
pub struct Cut {
    /// A PLY, LAS, LAZ or E57 file.
    file: PathBuf,
    /// The file of bricks to write.
    out: PathBuf,
}

impl Cut {
    pub fn run(&self) -> Done {
        let mut builder = Builder::create(&self.out, BuildOptions::default())?;
        let report = read_chunks::<Failed>(&self.file, 1 << 20, |cloud| Ok(builder.push(&cloud)?))?;
        let skipped = report.skipped;
        warned(report);
        builder.finish(|_, _| ())?;
        let bricks = Bricks::open(&self.out)?;
        let (points, count) = (bricks.points(), bricks.len());
        say(format_args!(
            "{points} points in {count} bricks; {skipped} points without valid coordinates skipped"
        ));
        Ok(())
    }
}

/// Walk through a file of bricks and print the bricks and points that frames take.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub struct Walk {
    /// A file of bricks. Up is +y.
    bricks: PathBuf,
    /// Boxes that hide what is behind them: a text file with six numbers on each line, the least and
    /// the greatest x, y and z.
    #[arg(long)]
    walls: Option<PathBuf>,
    /// The number of frames
    #[arg(long, default_value_t = 300)]
    frames: u32,
}

/// Frames in a second. A frame that is done earlier waits, so that the loader has the time that it
/// would have.
const RATE: f32 = 60.0;
const SIZE: (u32, u32) = (1280, 720);
/// Metres per second, around a square in the middle of the cloud, and the side of the square.
const SPEED: f32 = 10.0;
const SIDE: f32 = 100.0;
/// The height of the eye above the lowest point, in metres.
const HEIGHT: f32 = 1.7;
/// The distance between points in the picture, in pixels.
const PIXELS: f32 = 1.0;
/// Bytes of memory for loaded points.
const MEMORY: usize = 512 << 20;

const COLUMNS: [&str; 7] = [
    "bricks in frustum",
    "bricks in PVS",
    "points wanted, frustum",
    "points wanted, PVS",
    "points loaded",
    "ms frustum",
    "ms PVS",
];

impl Walk {
    pub fn run(&self) -> Done {
        let bricks = Arc::new(Bricks::open(&self.bricks)?);
        let walls = self.walls.as_deref().map_or(Ok(Vec::new()), |path| read_walls(path, bricks.origin()))?;
        say(format_args!("{} points in {} bricks, {} walls", bricks.points(), bricks.len(), walls.len()));
        let mut scene = Scene::new(cell_for(bricks.bounds(), bricks.len() + walls.len())?)?;
        bricks.insert_into(&mut scene)?;
        for wall in &walls {
            scene.insert(ObjectDesc::fixed(*wall).occluder(*wall).user_data(u64::MAX))?;
        }
        let loader = Loader::new(bricks.clone(), MEMORY)?;
        let mut queries = [Query::with_method(Method::Frustum)?, Query::new()];
        let mut rows: Vec<[f64; 7]> = Vec::new();
        for number in 0..self.frames {
            let begun = Instant::now();
            rows.push(frame(number, &bricks, &scene, &loader, &mut queries)?);
            thread::sleep(Duration::from_secs_f32(1.0 / RATE).saturating_sub(begun.elapsed()));
        }
        if let Some(error) = loader.take_error() {
            return Err(error.into());
        }
        summary(&rows);
        Ok(())
    }
}

/// The columns of a frame.
fn frame(
    number: u32,
    bricks: &Bricks,
    scene: &Scene,
    loader: &Loader,
    queries: &mut [Query; 2],
) -> Result<[f64; 7], Failed> {
    let camera = camera(number, bricks.bounds())?;
    let view = View::perspective(camera.eye(), camera.view_projection())?;
    let ms = |since: Instant| since.elapsed().as_secs_f64() * 1e3;
    // The bricks that a picture needs by each query, and the time of both.
    let [frustum, point] = queries.each_mut().map(|query| {
        let start = Instant::now();
        let found = query.run(scene, &view).iter();
        let numbers = found.filter_map(|id| u32::try_from(scene.user_data(id).ok()?).ok());
        (bricks.wants(numbers, &camera, PIXELS), ms(start))
    });
    loader.want(&point.0);
    let loaded = loader.gather(&point.0).len() as f64;
    let [all, wanted] =
        [&frustum.0, &point.0].map(|wants| wants.iter().map(|want| f64::from(want.points)).sum());
    let bricks = [&frustum.0, &point.0].map(|wants| wants.len() as f64);
    Ok([bricks[0], bricks[1], all, wanted, loaded, frustum.1, point.1])
}

/// The eye goes around the square; the gaze sweeps 40 degrees to both sides.
fn camera(frame: u32, bounds: Aabb) -> Result<Camera, casca_points::CameraError> {
    let time = frame as f32 / RATE;
    let way = time * SPEED / SIDE;
    let side = way.floor() as usize % 4;
    let direction = [Vec3::X, Vec3::Z, -Vec3::X, -Vec3::Z][side];
    let corner = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Z, Vec3::Z][side];
    let middle = bounds.center();
    let start = vec3(middle.x, bounds.min.y + HEIGHT, middle.z) + corner * SIDE;
    let eye = start + direction * (way.fract() * SIDE);
    let turn = 0.7 * (time * 1.5).sin();
    let target = eye + direction * turn.cos() + direction.cross(Vec3::Y) * turn.sin();
    Camera::look_at(eye, target, Vec3::Y, 0.9, SIZE, 0.1, (bounds.max - bounds.min).length().max(1.0))
}

/// Medians and the largest values of all frames, and how far the loader was behind.
fn summary(rows: &[[f64; 7]]) {
    if rows.is_empty() {
        return;
    }
    say(format_args!("{:24} {:>12} {:>12}", format!("{} frames", rows.len()), "median", "largest"));
    for (column, name) in COLUMNS.iter().enumerate() {
        let mut values: Vec<f64> = rows.iter().map(|row| row[column]).collect();
        values.sort_by(f64::total_cmp);
        let (median, largest) = (values[values.len() / 2], values[values.len() - 1]);
        say(format_args!("{name:24} {median:>12.2} {largest:>12.2}"));
    }
    let late = rows.iter().filter(|row| row[4] < row[3]).count();
    say(format_args!("{late} frames had fewer points than they wanted: these came late"));
}

/// Boxes in the coordinates of the bricks.
fn read_walls(path: &Path, origin: DVec3) -> Result<Vec<Aabb>, Failed> {
    let text = fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    lines
        .map(|(i, line)| {
            wall(line, origin).ok_or_else(|| {
                let cause = "a wall is six finite numbers, the least and the greatest x y z";
                format!("{}, line {}: {cause}", path.display(), i + 1).into()
            })
        })
        .collect()
}

fn wall(line: &str, origin: DVec3) -> Option<Aabb> {
    let numbers = line.split_whitespace().map(|word| word.parse().ok().filter(|n: &f64| n.is_finite()));
    let numbers = numbers.collect::<Option<Vec<f64>>>()?;
    let [x0, y0, z0, x1, y1, z1] = <[f64; 6]>::try_from(numbers).ok()?;
    let corner = |x, y, z| (DVec3::new(x, y, z) - origin).as_vec3();
    let (low, high) = (corner(x0, y0, z0), corner(x1, y1, z1));
    (low.is_finite() && high.is_finite() && low.cmple(high).all()).then(|| Aabb::new(low, high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wall_is_six_numbers_in_order() {
        let read = |line| wall(line, DVec3::ONE);
        assert_eq!(read("1 2 3  4 5 6"), Some(Aabb::new(vec3(0.0, 1.0, 2.0), vec3(3.0, 4.0, 5.0))));
        for bad in [
            "0 0 x 0 10 10 10",
            "0 0 0 1 1",
            "0 0 0 1 1 1 1",
            "0 0 nan 1 1 1",
            "0 0 0 1 1 inf",
            "0 0 0 1 1 1e99",
            "0 2 0 1 1 1",
        ] {
            assert_eq!(read(bad), None, "{bad}");
        }
    }
}
