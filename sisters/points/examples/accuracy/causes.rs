//! Why points are falsely visible or hidden.

use crate::scenes::Scene;
use crate::truth::Samples;
use bitvec::vec::BitVec;
use casca_points::surface::Answer;
use glam::Vec3;
use std::collections::{BTreeMap, HashMap};

/// Distances in spacings: beside an edge, and near a disc.
const BESIDE: f32 = 1.0;
const NEAR: f32 = 3.0;
/// Cosines: of a wrong normal, of grazing rays and of an edge between triangles.
const RIGHT: f32 = 0.94;
const GRAZING: f32 = 0.2;
const SMOOTH: f32 = 0.7;

/// The sharp edges of each triangle and of the triangles that share an edge with it.
pub struct Edges(Vec<Vec<[Vec3; 2]>>);

impl Edges {
    pub fn new(scene: &Scene) -> Self {
        let key = |a: Vec3, b: Vec3| {
            let [a, b] = [a, b].map(|p| (p * 1e4).round().as_ivec3().to_array());
            (a.min(b), a.max(b))
        };
        let sides = |[a, b, c]: [Vec3; 3]| [[a, b], [b, c], [c, a]];
        let normal = |i: usize| {
            let [a, b, c] = scene.triangles[i];
            (b - a).cross(c - a).normalize()
        };
        let mut shared: HashMap<_, Vec<usize>> = HashMap::new();
        for (i, triangle) in scene.triangles.iter().enumerate() {
            sides(*triangle).iter().for_each(|&[a, b]| shared.entry(key(a, b)).or_default().push(i));
        }
        let beside = |i: usize, [a, b]: [Vec3; 2]| {
            shared[&key(a, b)].iter().copied().find(|&j| j != i && normal(i).dot(normal(j)) > SMOOTH)
        };
        let of = |i: usize| {
            let mut sharp = Vec::new();
            for side in sides(scene.triangles[i]) {
                match beside(i, side) {
                    None => sharp.push(side),
                    Some(j) => sharp.extend(
                        sides(scene.triangles[j]).into_iter().filter(|side| beside(j, *side).is_none()),
                    ),
                }
            }
            sharp
        };
        Self((0..scene.triangles.len()).map(of).collect())
    }

    fn distance(&self, triangle: u32, p: Vec3) -> f32 {
        let of = |[a, b]: &[Vec3; 2]| {
            let t = (p - a).dot(b - a) / (b - a).length_squared();
            p.distance(a.lerp(*b, t.clamp(0.0, 1.0)))
        };
        self.0[triangle as usize].iter().map(of).fold(f32::INFINITY, f32::min)
    }
}

/// How many points are wrong for each cause.
#[derive(Default)]
pub struct Causes {
    visible: usize,
    counts: BTreeMap<String, usize>,
}

impl Causes {
    /// Adds the wrong answers from one eye.
    pub fn add(
        &mut self,
        (edges, samples, eye): (&Edges, &Samples, Vec3),
        normals: &[Vec3],
        truth: &BitVec,
        answers: &[Answer],
    ) {
        self.visible += truth.count_ones();
        let right = |i: usize| normals[i].dot(samples.normals[i]).abs() > RIGHT;
        let edge =
            |i: usize| edges.distance(samples.triangle[i], samples.points[i]) < BESIDE * samples.spacing;
        for (i, answer) in answers.iter().enumerate().filter(|(i, answer)| answer.is_visible() != truth[*i]) {
            let to = (eye - samples.points[i]).normalize().dot(samples.normals[i]);
            let mut causes = vec![if truth[i] { "hidden" } else { "visible" }];
            causes.push(if to.abs() < GRAZING { "grazing" } else { "" });
            match answer {
                Answer::Behind(j) => {
                    let near = samples.points[i].distance(samples.points[*j]) < NEAR * samples.spacing;
                    causes.push(if near { "by a near disc" } else { "by a far disc" });
                    causes.push(if right(*j) { "" } else { "of a wrong normal" });
                    causes.push(if edge(*j) { "beside an edge" } else { "" });
                }
                Answer::Visible => causes.push(if to < 0.0 { "faces away" } else { "leak" }),
                Answer::VisibleAsNeighbours => causes.push("as neighbours"),
                Answer::FacesAway => causes.push("faces away"),
                Answer::FarSideOfPlate => causes.push("in a plate"),
                _ => causes.push("as neighbours"),
            }
            causes.push(if right(i) { "" } else { "| own normal wrong" });
            causes.push(if edge(i) { "| at an edge" } else { "" });
            causes.retain(|cause| !cause.is_empty());
            *self.counts.entry(causes.join(" ")).or_default() += 1;
        }
    }

    /// Prints the causes, the most frequent first.
    pub fn print(&self, what: &str, normals: &[Vec3], samples: &Samples) {
        let wrong = (0..normals.len()).filter(|&i| normals[i].dot(samples.normals[i]).abs() <= RIGHT).count();
        println!("  {what}: wrong normals of {:.1}% of all", 100.0 * wrong as f64 / normals.len() as f64);
        let mut all: Vec<_> = self.counts.iter().collect();
        all.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
        for (cause, &count) in all {
            let share = 100.0 * count as f64 / self.visible as f64;
            if share >= 0.2 {
                println!("    {share:5.1}  {cause}");
            }
        }
    }
}
