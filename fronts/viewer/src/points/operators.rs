//! Clouds, cameras and operators as the command line gives them.

use std::error::Error;
use std::path::Path;
use std::time::Duration;

use bitvec::vec::BitVec;
use casca_points::PointCloud;
use casca_points::files::{self, Report};
use casca_points::surface::Surface;
use casca_points::{AutoSettings, Camera, hpr, splat};
use casca_stage::timing::Instant;
use casca_tools::command_line::{direction, point};
use clap::{Args, ValueEnum};
use glam::{DVec3, Quat, Vec3};

use crate::common::number;
use crate::points::house;

/// The distance between the house's points, in metres: so large that rooms show through the walls.
const HOUSE_SPACING: f32 = 0.055;
/// Where the house is seen from, and the place that is looked at.
const HOUSE_VIEW: [Vec3; 2] = [Vec3::new(4.6, 3.4, 13.6), Vec3::new(0.0, 3.1, 0.0)];

/// The vertical angle of pictures: 45 degrees.
const FOV_Y: f32 = std::f32::consts::FRAC_PI_4;

/// A way to find the visible points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Operator {
    /// Rays between discs around the points, by their normals or estimated ones
    Discs,
    /// Hidden point removal by a convex hull
    Hpr,
    /// Squares in a depth image
    Splat,
}

/// A cloud and a camera.
#[derive(Debug, Args)]
pub struct Look {
    /// Position of the eye, such as 1.5,2,-3 [default: before the cloud]
    #[arg(long, value_parser = point)]
    pub eye: Option<DVec3>,
    /// The place that the eye looks at [default: the middle of the cloud]
    #[arg(long, value_parser = point)]
    pub target: Option<DVec3>,
    /// The direction upwards; 0,0,1 for most surveys
    #[arg(long, default_value = "0,1,0", value_parser = direction)]
    pub up: Vec3,
    /// The distance between the points of the house in metres, 0.02 to 1
    #[arg(long, default_value_t = HOUSE_SPACING, value_parser = |text: &str| number(text, 0.02..=1.0f32))]
    pub spacing: f32,
}

/// A cloud with y upwards, and the way that it is looked at.
pub struct Looked {
    pub name: String,
    /// What is wrong with the file.
    pub warnings: Vec<String>,
    /// As it was read.
    pub cloud: PointCloud,
    /// Turned so that y is up.
    pub positions: Vec<Vec3>,
    pub normals: Vec<Vec3>,
    /// Half the side of a point's square, and what else suits the distances between points.
    pub auto: AutoSettings,
    pub eye: Vec3,
    pub target: Vec3,
    /// The length of the cloud.
    pub length: f32,
}

impl Look {
    /// Reads the cloud of a file; without one it is a house.
    pub fn open(&self, file: Option<&Path>) -> Result<Looked, Box<dyn Error>> {
        let (cloud, warnings) = match file {
            Some(path) => {
                let (cloud, report) = files::read(path)?;
                (cloud, warned(report))
            }
            None => (house::scan(self.spacing), Vec::new()),
        };
        if cloud.is_empty() {
            let name = file.map_or("the house".into(), |path| path.display().to_string());
            return Err(format!("{name} has no points").into());
        }
        let turn = Quat::from_rotation_arc(self.up, Vec3::Y);
        let turned = |all: &[Vec3]| all.iter().map(|&v| turn * v).collect::<Vec<_>>();
        let positions = turned(&cloud.positions);
        let low = positions.iter().copied().fold(Vec3::INFINITY, Vec3::min);
        let high = positions.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        if low == high && self.eye.is_none() {
            return Err(
                "all points are at one place, so the cloud has no size to place the eye by: give --eye"
                    .into(),
            );
        }
        let length = (high - low).length().max(f32::MIN_POSITIVE);
        let placed = |place: DVec3| turn * (place - cloud.origin).as_vec3();
        let house = file.is_none().then_some(HOUSE_VIEW);
        let target =
            self.target.map(placed).or(house.map(|view| view[1])).unwrap_or(low + (high - low) / 2.0);
        let before = || target + Vec3::new(0.5, 0.4, 1.0).normalize() * length * 1.2;
        let eye = self.eye.map(placed).or(house.map(|view| view[0])).unwrap_or_else(before);
        let auto = AutoSettings::new(&positions)?;
        let name = file.and_then(Path::file_stem).map_or("house".into(), |n| n.to_string_lossy());
        Ok(Looked {
            name: name.into_owned(),
            warnings,
            normals: turned(&cloud.normals),
            positions,
            auto,
            eye,
            target,
            length,
            cloud,
        })
    }
}

impl Looked {
    /// A camera for pictures of `size`.
    pub fn camera(&self, eye: Vec3, target: Vec3, size: (u32, u32)) -> Result<Camera, Box<dyn Error>> {
        let far = 2.0 * (self.length + eye.distance(self.target));
        Ok(Camera::look_at(eye, target, Vec3::Y, FOV_Y, size, 1e-4 * far, far)?)
    }

    /// The points that a camera sees, and the time that it took to find them.
    pub fn visible(&self, operator: Operator, camera: &Camera) -> Result<(BitVec, Duration), Box<dyn Error>> {
        let start = Instant::now();
        let visible = match operator {
            Operator::Discs => {
                let (positions, normals) = (self.positions.clone(), self.normals.clone());
                let turned = PointCloud { positions, normals, ..Default::default() };
                Surface::new(&turned)?.visible(camera.eye().as_dvec3())?
            }
            Operator::Splat => splat::visible_points(&self.positions, camera, &self.auto.splats())?,
            Operator::Hpr => {
                let points: Vec<DVec3> = self.positions.iter().map(|p| p.as_dvec3()).collect();
                let eye = camera.eye().as_dvec3();
                hpr::visible_points(&points, eye, self.auto.log10_radius(&points, eye))?
            }
        };
        Ok((visible, start.elapsed()))
    }
}

/// Says on standard error what is wrong with a file.
pub fn warned(report: Report) -> Vec<String> {
    report.warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
    report.warnings
}
