//! Two real scans of one place: each scanner saw its own points, and points of the other scan are
//! hidden from it where all of its own rays around ended before them.

use crate::{Counts, RADII, count, text};
use casca_points::{AutoSettings, PointCloud, hpr, surface::Surface};
use glam::{Quat, Vec3};
use std::collections::HashMap;
use std::error::Error;

/// Cells of a degree in a radian, and by how many metres rays around must be shorter: more than scans err.
const CELLS: f32 = 57.3;
const SHORTER: f32 = 0.3;

/// Of two files with lines of `x y z`, the scanner at 0, the second turned (an axis as long as the angle)
/// and moved by six numbers.
pub fn print(args: &[String]) -> Result<(), Box<dyn Error>> {
    let [first, second, pose @ ..] = args else { return Err("give two files and six numbers".into()) };
    let numbers = |text: &str| text.split_whitespace().map(str::parse).collect::<Result<Vec<f32>, _>>();
    let read = |file| Ok::<_, Box<dyn Error>>(numbers(&std::fs::read_to_string(file)?)?);
    let pose: [f32; 6] = numbers(&pose.join(" "))?.try_into().map_err(|_| "give six numbers")?;
    let [turn, offset] = [0, 3].map(|i| Vec3::from_slice(&pose[i..]));
    let mut positions: Vec<Vec3> = read(first)?.chunks_exact(3).map(Vec3::from_slice).collect();
    let own = positions.len();
    let moved = |p: &[f32]| Quat::from_scaled_axis(turn) * Vec3::from_slice(p) + offset;
    positions.extend(read(second)?.chunks_exact(3).map(moved));
    let cloud = PointCloud { positions, ..Default::default() };
    let (surface, auto) = (Surface::new(&cloud)?, AutoSettings::new(&cloud.positions)?);
    let places: Vec<_> = cloud.world_positions().collect();
    let (mut by_surface, mut by_radius) = (Counts::default(), [Counts::default(); RADII.len()]);
    for (eye, range) in [(Vec3::ZERO, 0..own), (offset, own..cloud.len())] {
        let cell = |p: Vec3| {
            let way = (p - eye).normalize_or(Vec3::Z);
            [way.y.atan2(way.x), way.z.asin()].map(|angle| (angle * CELLS).floor() as i32)
        };
        let mut longest: HashMap<[i32; 2], f32> = HashMap::new();
        for &p in &cloud.positions[range.clone()] {
            let far = longest.entry(cell(p)).or_default();
            *far = far.max(p.distance(eye));
        }
        let truth = |(i, &p): (usize, &Vec3)| {
            let ([x, y], far) = (cell(p), p.distance(eye) - SHORTER);
            let ends = |k: i32| longest.get(&[x + k % 3 - 1, y + k / 3 - 1]).is_some_and(|most| *most < far);
            if range.contains(&i) { Some(true) } else { (0..9).all(ends).then_some(false) }
        };
        let truth: Vec<Option<bool>> = cloud.positions.iter().enumerate().map(truth).collect();
        let eye = eye.as_dvec3();
        count(&mut by_surface, &truth, surface.visible(eye)?);
        for (sum, more) in by_radius.iter_mut().zip(RADII) {
            count(sum, &truth, hpr::visible_points(&places, eye, auto.log10_radius(&places, eye) + more)?);
        }
    }
    println!("surface {}", text(by_surface));
    by_radius.iter().zip(RADII).for_each(|(sum, more)| println!("hpr {more:4} {}", text(*sum)));
    Ok(())
}
