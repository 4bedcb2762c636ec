//! The experiments of Tavares 2009 ("Aproximação Eficiente de Visibilidade para Nuvem de Pontos
//! utilizando a GPU"): hidden point removal (HPR), HPR of clusters (chapter 3), and splats with
//! filters (chapter 5). The points are the vertices of a hare instead of the Stanford bunny, and the
//! truth comes from rays at its triangles.
//!
//! E is half of the false visible and false hidden points over the truly visible ones, in percent.

use crate::truth::Mesh;
use crate::{Counts, count, gauss};
use bitvec::vec::BitVec;
use casca_points::splat::{Bias, Filter, Radius, SplatOptions, visible_points};
use casca_points::{Camera, hpr};
use glam::{DVec3, UVec3, Vec3};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use std::collections::{BTreeMap, HashMap};
use std::error::Error;

/// Cells along the height of the hare: 30,114 vertices.
const CELLS: f32 = 128.0;

/// The deviation of the noise along each axis, as a share of the size of the cloud.
const NOISE: f64 = 1e-3;
const EYE: Vec3 = Vec3::new(3.6, 3.3, 4.2);
const MIDDLE: Vec3 = Vec3::new(0.05, 1.4, 0.0);
/// The best radius of HPR here.
const BEST: f64 = 3.25;
/// Cells of the grid along each axis, and the most points of a leaf of the octree.
const GRID: f64 = 37.0;
const LEAF: usize = 17;

/// E, and a line with both kinds of errors.
fn errors(truth: &[Option<bool>], found: BitVec) -> (f64, String) {
    let mut sum = Counts::default();
    count(&mut sum, truth, found);
    let [visible, shown, lost] = sum;
    let (found, e) = (visible + shown - lost, 50.0 * (shown + lost) / visible);
    (e, format!("{found:6} found | {shown:6} false visible | {lost:6} false hidden | E {e:6.2} %"))
}

pub fn print() -> Result<(), Box<dyn Error>> {
    let (points, triangles) = hare();
    let corners: Vec<[Vec3; 3]> = triangles.iter().map(|t| t.map(|i| points[i as usize])).collect();
    // The triangles around a vertex do not hide it.
    let own = |i: usize, t: u32| triangles[t as usize].contains(&(i as u32));
    let truth: Vec<_> = Mesh::new(&corners).seen(&points, EYE, own).into_iter().map(Some).collect();
    let area: f32 = corners.iter().map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0).sum();
    let spacing = (area / points.len() as f32).sqrt();
    let visible = truth.iter().filter(|t| **t == Some(true)).count();
    println!("{} points, {visible} truly visible, {spacing:.4} apart", points.len());
    let places: Vec<DVec3> = points.iter().map(|p| p.as_dvec3()).collect();
    let eye = EYE.as_dvec3();
    let low = places.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = places.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    println!("HPR, log10 R = {BEST} | {}", errors(&truth, hpr::visible_points(&places, eye, BEST)?).1);
    let noise = NOISE * low.distance(high);
    let mut random = Pcg64Mcg::seed_from_u64(5);
    let mut moved = |p: &DVec3| *p + DVec3::from_array([(); 3].map(|()| gauss(&mut random).into())) * noise;
    let moved: Vec<DVec3> = places.iter().map(&mut moved).collect();
    println!("noise of 0.1% of the size | {}", errors(&truth, hpr::visible_points(&moved, eye, BEST)?).1);
    clusters(&places, [low, high], &truth)?;
    splats(&points, spacing, &truth)
}

/// HPR of one centroid for each cell, whose points have its answer: with the radius for all points,
/// as in the thesis, and with one that is divided by the points for each cell, for a point is hidden
/// behind a gap of the angle a if it is more than R a^2 / 4 farther away.
fn clusters(points: &[DVec3], [low, high]: [DVec3; 2], truth: &[Option<bool>]) -> Result<(), Box<dyn Error>> {
    println!("HPR of clusters, log10 R = {BEST}");
    let mut grid: BTreeMap<[u32; 3], Vec<usize>> = BTreeMap::new();
    for (i, &p) in points.iter().enumerate() {
        let cell = ((p - low) / (high - low) * GRID).min(DVec3::splat(GRID - 1.0));
        grid.entry(cell.as_uvec3().to_array()).or_default().push(i);
    }
    let mut leaves: Vec<Vec<usize>> = Vec::new();
    let mut boxes = vec![((0..points.len()).collect::<Vec<_>>(), low, high)];
    while let Some((of, low, high)) = boxes.pop() {
        if of.len() <= LEAF {
            leaves.push(of);
            continue;
        }
        let middle = (low + high) / 2.0;
        let mut parts: [Vec<usize>; 8] = Default::default();
        of.into_iter().for_each(|i| parts[points[i].cmpge(middle).bitmask() as usize].push(i));
        for (part, of) in parts.into_iter().enumerate().filter(|(_, of)| !of.is_empty()) {
            let upper = glam::BVec3::new(part & 1 > 0, part & 2 > 0, part & 4 > 0);
            boxes.push((of, DVec3::select(upper, middle, low), DVec3::select(upper, high, middle)));
        }
    }
    for (name, cells) in [("grid 37^3", grid.into_values().collect()), ("octree 17", leaves)] {
        let centroid = |cell: &Vec<usize>| cell.iter().map(|&i| points[i]).sum::<DVec3>() / cell.len() as f64;
        let centroids: Vec<DVec3> = cells.iter().map(centroid).collect();
        let share = points.len() as f64 / cells.len() as f64;
        for (way, log10) in [("as given", BEST), ("rescaled", BEST - share.log10())] {
            let found = hpr::visible_points(&centroids, EYE.as_dvec3(), log10)?;
            let mut visible = BitVec::repeat(false, points.len());
            for (cell, _) in cells.iter().zip(&found).filter(|(_, found)| **found) {
                cell.iter().for_each(|&i| visible.set(i, true));
            }
            println!("  {name}, {:5} cells, R {way} | {}", cells.len(), errors(truth, visible).1);
        }
    }
    Ok(())
}

/// Squares with the thesis' tolerance of 0.05, the best of 29 radii for each filter.
fn splats(points: &[Vec3], spacing: f32, truth: &[Option<bool>]) -> Result<(), Box<dyn Error>> {
    println!("splats, each point judged, the best radius in spacings");
    let (far, size) = (EYE.distance(MIDDLE), (640, 480));
    let camera = Camera::look_at(EYE, MIDDLE, Vec3::Y, 45_f32.to_radians(), size, far / 2.0, far * 2.0)?;
    for filter in [Filter::None, Filter::Max, Filter::Min] {
        let mut best = (f64::INFINITY, String::new());
        for step in 0..29 {
            let part = 0.25 * 1.0905_f32.powi(step);
            let radius = Radius::Same(part * spacing);
            let options = SplatOptions { radius, bias: Bias::Window(0.05), filter, slopes: false };
            let (e, text) = errors(truth, visible_points(points, &camera, &options)?);
            if e < best.0 {
                best = (e, format!("{part:4.2} | {text}"));
            }
        }
        println!("  {size:?}, filter {filter:?} | {}", best.1);
    }
    Ok(())
}

/// How far apart parts are when the surface begins to flow from one to the other.
const BLEND: f32 = 0.14;
/// Bounds of the hare, with some room.
const LOW: Vec3 = Vec3::new(-1.6, -0.25, -1.0);
const HIGH: Vec3 = Vec3::new(1.75, 3.25, 1.0);

/// Parts: from, to and radius. The other side mirrors z.
const PARTS: [([f32; 3], [f32; 3], f32); 10] = [
    // Rump, chest, head, snout and tail.
    ([-0.45, 0.72, 0.0], [-0.1, 0.8, 0.0], 0.62),
    ([0.1, 0.85, 0.0], [0.45, 1.0, 0.0], 0.46),
    ([0.8, 1.55, 0.0], [0.95, 1.52, 0.0], 0.37),
    ([1.15, 1.42, 0.0], [1.3, 1.38, 0.0], 0.2),
    ([-1.12, 0.72, 0.0], [-1.2, 0.8, 0.0], 0.22),
    // Ears, upper arms, paws, thighs and feet.
    ([0.85, 1.85, 0.16], [0.35, 2.9, 0.36], 0.13),
    ([0.45, 0.75, 0.35], [0.75, 0.15, 0.35], 0.16),
    ([0.7, 0.05, 0.35], [1.05, 0.03, 0.35], 0.13),
    ([-0.55, 0.55, 0.42], [-0.3, 0.4, 0.5], 0.36),
    ([-0.5, 0.05, 0.5], [0.1, 0.0, 0.52], 0.16),
];

/// The distance from the hare's surface, negative inside; exact but where parts flow into each other.
fn distance(p: Vec3) -> f32 {
    let p = Vec3::new(p.x, p.y, p.z.abs());
    let part = |(from, to, radius): ([f32; 3], [f32; 3], f32)| {
        let (from, to) = (Vec3::from(from), Vec3::from(to));
        let along = ((p - from).dot(to - from) / (to - from).length_squared()).clamp(0.0, 1.0);
        p.distance(from + (to - from) * along) - radius
    };
    PARTS.map(part).into_iter().fold(f32::INFINITY, |a, b| {
        let share = (BLEND - (a - b).abs()).max(0.0) / BLEND;
        a.min(b) - share * share * BLEND / 4.0
    })
}

/// A closed surface with ears, legs and hollows: vertices and triangles where the distance is 0, by
/// naive surface nets (Gibson 1998, "Constrained Elastic Surface Nets"). Each cell that the surface
/// passes has a vertex, and each edge that it crosses gives a square of the vertices around it.
fn hare() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let cell = (HIGH.y - LOW.y) / CELLS;
    let size = ((HIGH - LOW) / cell).ceil().as_uvec3() + 1;
    let place = |at: UVec3| LOW + at.as_vec3() * cell;
    let lattice = |size: UVec3| {
        (0..size.z)
            .flat_map(move |z| (0..size.y).flat_map(move |y| (0..size.x).map(move |x| UVec3::new(x, y, z))))
    };
    let values: Vec<f32> = lattice(size).map(|at| distance(place(at))).collect();
    let value = |at: UVec3| values[((at.z * size.y + at.y) * size.x + at.x) as usize];
    let inside = |at: UVec3| value(at) < 0.0;
    let axes = |axis: usize| [0, 1, 2].map(|i| UVec3::AXES[(axis + i) % 3]);
    let (mut points, mut triangles, mut vertices) = (Vec::new(), Vec::new(), HashMap::new());
    for at in lattice(size - 1) {
        let mut crossings = Vec::new();
        for [x, y, z] in (0..3).map(axes) {
            for from in [at, at + y, at + z, at + y + z].into_iter().filter(|&a| inside(a) != inside(a + x)) {
                let part = value(from) / (value(from) - value(from + x));
                crossings.push(place(from).lerp(place(from + x), part));
            }
        }
        if !crossings.is_empty() {
            vertices.insert(at, points.len() as u32);
            points.push(crossings.iter().sum::<Vec3>() / crossings.len() as f32);
        }
    }
    for at in lattice(size - 1) {
        for [x, y, z] in (0..3).map(axes) {
            let corner = |back: UVec3| vertices.get(&at.checked_sub(back)?).copied();
            let around = [UVec3::ZERO, y, y + z, z].map(corner);
            let [Some(a), Some(b), Some(c), Some(d)] = around else { continue };
            if inside(at) != inside(at + x) {
                let [a, b, c, d] = if inside(at) { [a, b, c, d] } else { [d, c, b, a] };
                // Cut along the shorter diagonal.
                let length = |p: u32, q: u32| points[p as usize].distance_squared(points[q as usize]);
                let halves = [[[a, b, c], [a, c, d]], [[a, b, d], [b, c, d]]];
                triangles.extend(halves[usize::from(length(a, c) > length(b, d))]);
            }
        }
    }
    (points, triangles)
}
