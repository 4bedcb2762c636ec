//! The rig of an animal: a skeleton, the weights of its levels of detail, and a walk.

use std::f32::consts::{PI, TAU};

use crate::error::Error;
use crate::mesh::Mesh;
use crate::skin::{Channel, Clip, Interpolation, Joint, PER_VERTEX, Skeleton, SkinBounds, Track, Weights};
use glam::{Quat, Vec3};

use super::body::{Body, LEGS, Limb};

/// Joints: the trunk, for each leg hip and knee, the neck, and the root and the middle of the tail.
const JOINTS: usize = 2 * LEGS + 4;
const NECK: usize = 2 * LEGS + 1;
const TAIL: usize = 2 * LEGS + 2;

/// Where the knee is on the way from hip to foot, and over which share of it skin bends.
const KNEE: f32 = 0.55;
const KNEE_SOFT: f32 = 0.12;

/// How softly limbs go over into each other, in units.
const SOFT: f32 = 0.035;

/// Keys of the walk.
const KEYS: usize = 16;

/// How far hips swing, knees bend, the neck nods and the tail wags, in radians.
const SWING: f32 = 0.45;
const BEND: f32 = 0.7;
const NOD: f32 = 0.08;
const WAG: f32 = 0.25;

/// The skeleton, weights and walk of an animal.
#[derive(Debug, Clone)]
pub struct Rig {
    /// The joints.
    pub skeleton: Skeleton,
    /// For each level of detail the weights of its vertices.
    pub weights: Vec<Weights>,
    /// One round of steps, which takes a second: a trot, in which legs across from each other go
    /// together.
    pub walk: Clip,
    /// The bounds of poses, for all levels.
    pub bounds: SkinBounds,
    /// The way of the trunk in one round of the walk, in units: feet then slide least.
    pub stride: f32,
}

impl Rig {
    /// The rig of a body whose levels of detail are moved by `-middle`.
    pub(super) fn new(body: &Body, middle: Vec3, levels: &[Mesh]) -> Result<Self, Error> {
        let skeleton = skeleton(body, middle)?;
        let finest = &levels[0];
        let rows: Vec<_> = finest.vertices().iter().map(|v| row(body, v.position + middle)).collect();
        let (joints, shares): (Vec<_>, Vec<_>) = rows.into_iter().unzip();
        let own = Weights::new(&joints, &shares, &skeleton)?;
        let weights = levels.iter().map(|level| own.carried(finest, level)).collect::<Result<_, _>>()?;
        let walk = walk(&skeleton)?;
        let long = body.legs.iter().map(|[hip, foot]| hip.distance(*foot)).sum::<f32>() / LEGS as f32;
        // From the rearmost to the foremost place and back.
        let stride = 4.0 * long * SWING.sin();
        Ok(Self { bounds: SkinBounds::new(finest, &own)?, skeleton, weights, walk, stride })
    }
}

fn hip(leg: usize) -> usize {
    1 + 2 * leg
}

fn skeleton(body: &Body, middle: Vec3) -> Result<Skeleton, Error> {
    let mut joints = vec![Joint::at(None, Vec3::ZERO)];
    for [hip, foot] in body.legs {
        joints.push(Joint::at(Some(0), hip - middle));
        joints.push(Joint::at(Some(joints.len() - 1), (foot - hip) * KNEE));
    }
    joints.push(Joint::at(Some(0), body.neck - middle));
    joints.push(Joint::at(Some(0), body.tail[0] - middle));
    joints.push(Joint::at(Some(TAIL), body.tail[1] - body.tail[0]));
    Skeleton::new(joints)
}

/// The joints that a place on the skin follows, and how much: by its nearness to the limbs.
fn row(body: &Body, p: Vec3) -> ([u32; PER_VERTEX], [f32; PER_VERTEX]) {
    let near = body.nearness(p, SOFT);
    let mut shares = [0.0f32; JOINTS];
    for (limb, share) in near {
        match limb {
            Limb::Trunk => shares[0] += share,
            Limb::Head => shares[NECK] += share,
            Limb::Tail(piece) => shares[TAIL + piece] += share,
            Limb::Leg(leg) => {
                let [hip_at, foot] = body.legs[leg];
                let way = foot - hip_at;
                let along = (p - hip_at).dot(way) / way.length_squared();
                let lower = ((along - KNEE) / KNEE_SOFT * 0.5 + 0.5).clamp(0.0, 1.0);
                shares[hip(leg)] += share * (1.0 - lower);
                shares[hip(leg) + 1] += share * lower;
            }
        }
    }
    let mut order: [usize; JOINTS] = std::array::from_fn(|i| i);
    order.sort_by(|&a, &b| shares[b].total_cmp(&shares[a]));
    (std::array::from_fn(|i| order[i] as u32), std::array::from_fn(|i| shares[order[i]]))
}

fn walk(skeleton: &Skeleton) -> Result<Clip, Error> {
    let keyed = |turn: &dyn Fn(f32) -> Quat| {
        let times = (0..=KEYS).map(|key| key as f32 / KEYS as f32);
        let turns = times.clone().map(|time| turn(time * TAU)).collect();
        Track::new(times.collect(), turns, Interpolation::Linear).map(Channel::Rotation)
    };
    let mut channels = Vec::new();
    for leg in 0..LEGS {
        // The first of each side behind, the second before; those across go together.
        let start = if leg == 0 || leg == 3 { 0.0 } else { PI };
        channels.push((hip(leg), keyed(&|t| Quat::from_rotation_z(SWING * (t + start).sin()))?));
        // A knee bends while its leg swings forwards.
        channels.push((hip(leg) + 1, keyed(&|t| Quat::from_rotation_z(-BEND * (t + start).cos().max(0.0)))?));
    }
    channels.push((NECK, keyed(&|t| Quat::from_rotation_z(NOD * (2.0 * t).sin()))?));
    channels.push((TAIL, keyed(&|t| Quat::from_rotation_y(WAG * t.sin()))?));
    channels.push((TAIL + 1, keyed(&|t| Quat::from_rotation_y(WAG * (t - 1.0).sin()))?));
    Clip::new(channels, skeleton)
}

#[cfg(test)]
mod tests {
    use crate::skin::Pose;

    use super::super::animal::Animal;

    #[test]
    fn legs_walk_and_the_trunk_does_not() {
        for seed in 0..4 {
            let animal = Animal::new(seed, 32).unwrap();
            let (rig, mesh) = (animal.rig(), &animal.levels()[0]);
            assert_eq!((rig.walk.seconds(), rig.weights.len()), (1.0, animal.levels().len()));
            let mut ways = vec![0f32; mesh.vertices().len()];
            let mut pose = Pose::rest(&rig.skeleton);
            for (v, vertex) in mesh.vertices().iter().enumerate() {
                let rested = rig.weights[0].blend(v, &pose).transform_point3(vertex.position);
                assert!(rested.distance(vertex.position) < 1e-5);
            }
            for step in 0..12 {
                pose.set(&rig.skeleton, &rig.walk, f64::from(step) / 12.0);
                for (v, vertex) in mesh.vertices().iter().enumerate() {
                    let there = rig.weights[0].blend(v, &pose).transform_point3(vertex.position);
                    ways[v] = ways[v].max(there.distance(vertex.position));
                }
            }
            let low = animal.aabb().min.y;
            let feet = || mesh.vertices().iter().zip(&ways).filter(|(v, _)| v.position.y < low + 0.05);
            assert!(feet().count() > 20 && feet().all(|(_, way)| (0.1..0.5).contains(way)), "seed {seed}");
            let still = ways.iter().filter(|way| **way < 0.01).count();
            println!("seed {seed}: {still} of {} vertices stand still", ways.len());
            assert!(still * 5 > ways.len() && still * 5 < ways.len() * 4, "seed {seed}");
        }
    }
}
