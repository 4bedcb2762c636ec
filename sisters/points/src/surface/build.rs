//! Discs from points.

use super::disc::{Disc, Discs, Frame, Margins, Packed, rounded, tree};
use super::error::SurfaceError;
use super::fan::{self, SECTORS};
use super::plane::{self, Input, NEIGHBOURS, NOBODY, Near};
use super::rim;
use super::steps;
use super::stray::strays;
use crate::PointCloud;
use crate::numeric::{power_of_two_for, unit};
use crate::spacing::{Neighbours, Places, quantile};
use glam::{Vec2, Vec3, Vec3A};
use rayon::prelude::*;
use std::f32::consts::PI;

/// The spacing by all neighbours is at most so many times that by the nearest [`FEW`]: a few points
/// far from all others are no large surface.
const FEW: usize = 8;
const GROWTH: f32 = 1.5;

/// Points whose noise is measured.
const MEASURED: usize = 4096;

// Lengths in spacings, chosen on the kinds of scenes that the example `accuracy` calls tuned.
/// See [`Margins`]: without noise, and in multiples of the measured noise.
const INLIER: [f32; 2] = [0.08, 2.0];
const LAYER: [f32; 2] = [0.2, 3.0];
const BEHIND: [f32; 2] = [0.05, 2.0];
const PLATE: [f32; 2] = [0.1, 3.0];
const BETWEEN: [f32; 2] = [0.05, 3.0];
/// The noise of scans is as long everywhere, so that it is more spacings where points are dense.
/// Spacings are even, so that bends may be taken for noise, if the usual one is at most so many
/// times that of the densest part; the more it is, the more margins grow, up to this factor.
const EVEN: f32 = 1.25;
const DENSEST: f32 = 0.1;
const WIDEST: f32 = 3.0;
/// The radius of the largest circle without a point that a disc covers, and the distance of the
/// farthest neighbour that it reaches to.
const HOLE: f32 = 2.0;
const FARTHEST: f32 = 2.5;
/// How far a disc reaches where the surface seems to end: half of a spacing would be right for
/// straight ends, and is too much beside corners.
const OVERHANG: f32 = 0.4;
/// How far an edge may be from the points on both of its sides.
const EDGE: f32 = 1.5;
/// How far from a point the face that it is on may end at a side of its body, how far below the face the
/// points of that side are at most, and how far along the edge: without and with normals that are given.
const END: f32 = 2.0;
const DEEP: f32 = 0.7;
const ALONG: [f32; 2] = [1.0, 3.0];
/// The spacing of a point's own layer over that of all its neighbours, at most.
const THINNER: f32 = 2.0;

/// The least cosine between normals of one layer.
const LAYER_TURN: f32 = 0.5;

/// The plane of a point.
struct Plane {
    normal: Vec3A,
    /// How far its neighbours are from it, or the next step.
    rough: f32,
    /// It is on the rim of a plate, which the normal leads out of.
    rim: bool,
    /// It is on no surface.
    stray: bool,
}

/// The plane of a neighbour: a place relative to the point, a normal, and whether its sign tells
/// inside and outside.
type Side = (Vec3A, Vec3A, bool);

pub(super) fn build(cloud: &PointCloud) -> Result<Discs, SurfaceError> {
    let bad = cloud.positions.par_iter().position_first(|p| !p.is_finite());
    if let Some(index) = bad.or((!cloud.origin.is_finite() && !cloud.is_empty()).then_some(0)) {
        return Err(SurfaceError::PointNotFinite { index });
    }
    let first = cloud.positions.first().copied().unwrap_or_default();
    let low = cloud.positions.iter().copied().fold(first, Vec3::min).as_dvec3();
    let high = cloud.positions.iter().copied().fold(first, Vec3::max).as_dvec3();
    let (middle, half) = ((low + high) / 2.0, (high - low).max_element() / 2.0);
    let scale = if half > 0.0 { power_of_two_for(half) / 2.0 } else { 1.0 };
    let unique = Places::new(&cloud.positions);
    let place = |group: &&[u32]| (cloud.positions[group[0] as usize].as_dvec3() - middle) * scale;
    let groups: Vec<&[u32]> = unique.groups().collect();
    let places: Vec<Vec3A> = groups.iter().map(|group| place(group).as_vec3a()).collect();
    let normal = |i: &u32| cloud.normals.get(*i as usize).map_or(Vec3A::ZERO, |&n| unit(n).into());
    let given = |group: &&[u32]| {
        let sum: Vec3A = group.iter().map(normal).sum();
        // Two sheets at one place: either side will do.
        sum.try_normalize().unwrap_or_else(|| normal(&group[0]))
    };
    let normals: Vec<Vec3A> = groups.iter().map(given).collect();
    let tree_of_places = Neighbours::new(places.iter().map(|p| p.to_vec3()));
    let of = |p: &Vec3A| {
        let mut all = [NOBODY; NEIGHBOURS];
        let found = tree_of_places.of(p.to_vec3(), NEIGHBOURS as u32);
        all.iter_mut().zip(found).for_each(|(one, found)| *one = found);
        all
    };
    let nearest = places.par_iter().map(of).collect();
    drop(tree_of_places);
    let frame = Frame { middle: middle + cloud.origin, scale };
    let mut input = Input { places, normals, nearest, spacing: Vec::new() };
    let all = 0..input.places.len();
    input.spacing = all.clone().into_par_iter().map(|i| spacing(&input.near(i))).collect();
    let margins = margins(&input);
    let planes = planes(&input, &margins);
    let mut discs = all.into_par_iter().map(|i| disc(&input, &planes, &margins, i)).collect();
    drop((input, planes));
    let (tree, order) = tree(&mut discs);
    let mut disc_of = vec![0; cloud.len()];
    for (disc, &i) in order.iter().enumerate() {
        groups[i as usize].iter().for_each(|&point| disc_of[point as usize] = disc as u32);
    }
    Ok(Discs { discs, tree, disc_of, margins, frame, show_strays: true })
}

/// The side of the square that a point stands for, by its neighbours, nearest first.
fn spacing(near: &[Near]) -> f32 {
    let by = |count: usize| near[count - 1].1.length() * (PI / count as f32).sqrt();
    match near.len() {
        0 => 0.0,
        count => by(count).min(GROWTH * by(count.min(FEW))),
    }
}

/// The planes of all points: by given normals, or estimated ones where none is given.
fn planes(input: &Input, margins: &Margins) -> Vec<Plane> {
    let all = 0..input.places.len();
    let inlier = |i: usize| margins.inlier * input.spacing[i].max(margins.grain);
    let of_plane = |i: usize| {
        if input.given(i) { input.normals[i] } else { plane::normal(&input.around(i), inlier(i)) }
    };
    let mut normals: Vec<Vec3A> = all.clone().into_par_iter().map(of_plane).collect();
    let strays = strays(input, &normals, margins);
    normals.iter_mut().zip(&strays).filter(|(_, stray)| **stray).for_each(|(n, _)| *n = Vec3A::ZERO);
    let rims =
        if all.clone().all(|i| input.given(i)) { Vec::new() } else { rim::normals(input, &normals, margins) };
    let steps = steps::heights(input, &normals, |i| 2.0 * inlier(i));
    let plane = |i: usize| {
        let rim = rims.get(i).copied().flatten().filter(|_| !input.given(i) && !strays[i]);
        let normal = rounded(rim.unwrap_or(normals[i]));
        let rough = plane::rough(&input.around(i), normal, 2.0 * inlier(i)).max(steps[i]);
        Plane { normal, rough, rim: rim.is_some(), stray: strays[i] }
    };
    all.into_par_iter().map(plane).collect()
}

/// The margins for the noise of most points.
fn margins(input: &Input) -> Margins {
    let step = (input.places.len() / MEASURED).max(1);
    let some: Vec<usize> = (0..input.places.len()).step_by(step).collect();
    let noise = |i: usize| (plane::noise(&input.around(i)), input.spacing[i]);
    let all: Vec<(f32, f32)> = some.into_par_iter().map(noise).filter(|n| (n.0 / n.1).is_finite()).collect();
    let noise = quantile(all.iter().map(|n| n.0 / n.1).collect(), 0.5);
    let spacing = |part: f32| quantile(all.iter().map(|n| n.1).collect(), part);
    let wider = (spacing(0.5) / spacing(DENSEST) / EVEN).powi(2).clamp(1.0, WIDEST);
    let grain = wider * quantile(all.iter().map(|n| n.0).collect(), 0.5) / noise.max(INLIER[0] / INLIER[1]);
    let margin = |[least, by_noise]: [f32; 2]| least.max(by_noise * noise);
    let [inlier, layer, behind, plate, between] = [INLIER, LAYER, BEHIND, PLATE, BETWEEN].map(margin);
    Margins { inlier, layer, behind, plate, between, grain }
}

fn disc(input: &Input, planes: &[Plane], margins: &Margins, i: usize) -> Packed {
    let Plane { normal, rough, rim, stray } = planes[i];
    // What is on no surface is beside none.
    let all = if stray { 0.0 } else { input.spacing[i] };
    let at = input.places[i];
    let (given, reach) = (input.given(i), [0; SECTORS]);
    let mut disc = Disc { at, normal, spacing: all, rough, oriented: given, solid: rim, stray, reach };
    if normal == Vec3A::ZERO {
        return disc.pack([0.0; SECTORS]);
    }
    let neighbours = input.near(i);
    // The signs of estimated normals mean nothing.
    let alike = |j: usize| {
        let cosine = planes[j].normal.dot(normal);
        if given && input.given(j) { cosine > LAYER_TURN } else { cosine.abs() > LAYER_TURN }
    };
    let of = |j: u32| planes[j as usize].normal;
    let layer: Vec<Vec3A> = neighbours
        .iter()
        .filter(|(j, v)| {
            v.dot(normal).abs() < margins.layer * all.max(v.length()).max(margins.grain) && alike(*j as usize)
        })
        .map(|near| near.1)
        .collect();
    let own = layer.last().map_or(all, |last| last.length() * (PI / layer.len() as f32).sqrt());
    disc.spacing = own.min(THINNER * all);
    let (u, v) = normal.any_orthonormal_pair();
    let near = layer.iter().filter(|p| p.length() < FARTHEST * disc.spacing);
    let flat: Vec<Vec2> = near.map(|p| Vec2::new(p.dot(u), p.dot(v))).collect();
    let mut reaches = fan::reach(&flat, HOLE * disc.spacing);
    let across: Vec<Side> = neighbours
        .iter()
        .map(|&(j, v)| (v, of(j), input.given(j as usize) || planes[j as usize].rim))
        .filter(|(_, n, _)| n.dot(normal).abs() < LAYER_TURN)
        .collect();
    let near: Vec<Side> = across.iter().copied().filter(|(v, ..)| v.length() < EDGE * all).collect();
    let is_side = |(v, ..): &Side| {
        let depth = -v.dot(normal);
        depth < DEEP * all && depth > if given { 0.0 } else { -DEEP * all }
    };
    let sides: Vec<Side> = across.into_iter().filter(is_side).collect();
    let (along, overhang) = (ALONG[usize::from(given)] * all, OVERHANG * disc.spacing);
    for (reach, d) in reaches.iter_mut().zip(fan::DIRECTIONS) {
        let direction = u * d.x + v * d.y;
        let mut most = *reach;
        if most == 0.0 {
            *reach = edge(direction, &near, EDGE * all).unwrap_or(overhang);
            most = END * all;
        }
        *reach = match end(direction, normal, &sides, most, along) {
            None => *reach,
            Some((far, true)) => reach.min(far).min(overhang),
            Some((far, _)) => far,
        };
    }
    disc.pack(reaches)
}

/// How far it is in a direction to the first of the planes of neighbours that meets it near the neighbour.
fn edge(direction: Vec3A, across: &[Side], most: f32) -> Option<f32> {
    let meets = across.iter().filter_map(|(v, normal, _)| {
        let far = normal.dot(*v) / normal.dot(direction);
        (far > 0.0 && far < most && (direction * far).distance(*v) < most).then_some(far)
    });
    meets.min_by(f32::total_cmp)
}

/// How far it is in a direction to the first of the sides of bodies, and whether that side is known
/// to face here: then the face ended before, and the side belongs to another body beyond a gap.
fn end(direction: Vec3A, normal: Vec3A, sides: &[Side], most: f32, along: f32) -> Option<(f32, bool)> {
    let meets = sides.iter().filter_map(|(v, side, known)| {
        let facing = side.dot(direction);
        let far = side.dot(*v) / facing;
        let beside = (direction * far - *v).reject_from_normalized(normal).length();
        (far > 0.0 && far < most && beside < along).then_some((far, *known && facing < 0.0))
    });
    meets.min_by(|a, b| a.0.total_cmp(&b.0))
}
