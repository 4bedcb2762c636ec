//! The command `walk`.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use casca::{Aabb, GridSpec, Method, ObjectDesc, Pvs, Query, Scene, View};
use casca_points::Camera;
use casca_points::bricks::{Bricks, Loader, Want};
use casca_points::splat::{Bias, Filter, Radius, SplatOptions, visible_points};
use casca_stage::window::Done;
use casca_tools::command_line::say;
use clap::Args;
use glam::{DVec3, Vec3, vec3};

use crate::points::large::picture;

/// Walk through a file of bricks and print the bricks and points that frames take.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub struct Walk {
    /// A file of bricks. Up is +y.
    bricks: PathBuf,
    /// Boxes that hide what is behind them: a text file with six numbers on each line, as
    /// `generate` writes it.
    #[arg(long)]
    walls: Option<PathBuf>,
    /// The number of frames
    #[arg(long, default_value_t = 300)]
    frames: u32,
    /// Draws the last frame into a PNG file: the points that are loaded without and with occlusion
    /// culling, from the eye and from above.
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
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

/// How far behind squares points count as visible, as in the thesis, beside what surfaces slant: in
/// a generated town of 4 million points 7.6% of the visible points are falsely hidden (commit
/// 787d77b2 has a check by rays).
const BIAS: Bias = Bias::Window(0.05);

const COLUMNS: [&str; 9] = [
    "bricks in frustum",
    "bricks in PVS",
    "points wanted, frustum",
    "points wanted, PVS",
    "points loaded",
    "points visible",
    "ms frustum",
    "ms PVS",
    "ms refine",
];

impl Walk {
    pub fn run(&self) -> Done {
        let bricks = Arc::new(Bricks::open(&self.bricks)?);
        let walls = self.walls.as_deref().map_or(Ok(Vec::new()), |path| read_walls(path, bricks.origin()))?;
        say(format_args!("{} points in {} bricks, {} walls", bricks.points(), bricks.len(), walls.len()));
        let mut scene = Scene::new(&GridSpec::fit(bricks.bounds(), bricks.len() + walls.len())?)?;
        bricks.insert_into(&mut scene)?;
        for wall in &walls {
            scene.insert(ObjectDesc::fixed(*wall).occluder(*wall).user_data(u64::MAX))?;
        }
        let loader = Loader::new(bricks.clone(), MEMORY)?;
        let mut queries = [Query::with_method(Method::Frustum)?, Query::new()];
        let mut rows: Vec<[f64; 9]> = Vec::new();
        for frame in 0..self.frames {
            let start = Instant::now();
            rows.push(self.frame(frame, &bricks, &scene, &loader, &mut queries)?);
            thread::sleep(Duration::from_secs_f32(1.0 / RATE).saturating_sub(start.elapsed()));
        }
        if let Some(path) = &self.picture {
            let camera = self.camera(self.frames.saturating_sub(1), bricks.bounds())?;
            let wants = self.wants(&bricks, &scene, &camera, &mut queries)?.map(|(wants, _)| wants);
            picture::draw(path, &loader, &camera, &wants)?;
            say(path.display());
        }
        if let Some(error) = loader.take_error() {
            return Err(error.into());
        }
        summary(&rows);
        Ok(())
    }

    /// The columns of a frame.
    fn frame(
        &self,
        frame: u32,
        bricks: &Bricks,
        scene: &Scene,
        loader: &Loader,
        queries: &mut [Query; 2],
    ) -> Result<[f64; 9], Box<dyn std::error::Error>> {
        let camera = self.camera(frame, bricks.bounds())?;
        let [frustum, point] = self.wants(bricks, scene, &camera, queries)?;
        loader.want(&point.0);
        let cloud = loader.gather(&point.0);
        let start = Instant::now();
        let options = SplatOptions {
            radius: Radius::Each(&cloud.radii),
            bias: BIAS,
            filter: Filter::Max,
            slopes: true,
        };
        let visible = visible_points(&cloud.positions, &camera, &options)?;
        let refined = start.elapsed();
        let points = |wants: &[Want]| wants.iter().map(|want| f64::from(want.points)).sum();
        let ms = |time: Duration| time.as_secs_f64() * 1e3;
        Ok([
            frustum.0.len() as f64,
            point.0.len() as f64,
            points(&frustum.0),
            points(&point.0),
            cloud.len() as f64,
            visible.count_ones() as f64,
            ms(frustum.1),
            ms(point.1),
            ms(refined),
        ])
    }

    /// The bricks that a picture needs by each query, and the time of both.
    fn wants(
        &self,
        bricks: &Bricks,
        scene: &Scene,
        camera: &Camera,
        queries: &mut [Query; 2],
    ) -> Result<[(Vec<Want>, Duration); 2], casca::Error> {
        let view = View::perspective(camera.eye(), camera.view_projection())?;
        let wants = |pvs: &Pvs| {
            let numbers = pvs.iter().filter_map(|id| u32::try_from(scene.user_data(id).ok()?).ok());
            bricks.wants(numbers, camera, PIXELS)
        };
        Ok(queries.each_mut().map(|query| {
            let start = Instant::now();
            let wants = wants(query.run(scene, &view));
            (wants, start.elapsed())
        }))
    }

    /// The eye goes around the square; the gaze sweeps 40 degrees to both sides.
    fn camera(&self, frame: u32, bounds: Aabb) -> Result<Camera, casca_points::CameraError> {
        let time = frame as f32 / RATE;
        let way = time * SPEED / SIDE;
        let (corner, along) = (way.floor() as i64 % 4, way.fract() * SIDE);
        let directions = [Vec3::X, Vec3::Z, -Vec3::X, -Vec3::Z];
        let corners = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Z, Vec3::Z];
        let direction = directions[corner as usize % 4];
        let middle = bounds.center();
        let start = vec3(middle.x, bounds.min.y + HEIGHT, middle.z) + corners[corner as usize % 4] * SIDE;
        let eye = start + direction * along;
        let turn = 0.7 * (time * 1.5).sin();
        let target = eye + direction * turn.cos() + direction.cross(Vec3::Y) * turn.sin();
        Camera::look_at(eye, target, Vec3::Y, 0.9, SIZE, 0.1, (bounds.max - bounds.min).length().max(1.0))
    }
}

/// Medians and the largest values of all frames, and how far the loader was behind.
fn summary(rows: &[[f64; 9]]) {
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
    let sum = |column: usize| rows.iter().map(|row| row[column]).sum::<f64>();
    let late = rows.iter().filter(|row| row[4] < row[3]).count();
    let [wanted, late_points] =
        [sum(3) / sum(2).max(1.0), 1.0 - sum(4) / sum(3).max(1.0)].map(|share| 100.0 * share);
    say(format_args!("the PVS wants {wanted:.1} % of the points of the frustum"));
    say(format_args!("{late_points:.2} % of the wanted points came late, in {late} frames"));
}

/// Boxes in the coordinates of the bricks.
fn read_walls(path: &Path, origin: DVec3) -> Result<Vec<Aabb>, Box<dyn std::error::Error>> {
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
