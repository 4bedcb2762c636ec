//! Balls that stay inside meshes that move.

use casca::Sphere;
use glam::{DVec3, Vec3};

use super::objects::{deepest, depth_among};
use crate::error::Error;
use crate::mesh::Mesh;
use crate::numeric::{CARRIED_CENTERS, INNER_ROUNDING};
use crate::skin::{Clip, Pose, Skeleton, Weights, pieces, stray};

/// A ball that a joint carries: inside the posed mesh at all times of a clip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarriedBall {
    /// The joint.
    pub joint: usize,
    /// The middle at rest, in the space of the mesh.
    pub center: Vec3,
    /// The radius, in the space of the posed mesh, whatever the joint's scale is.
    pub radius: f32,
}

impl CarriedBall {
    /// Where it is in a pose, in the space of the posed mesh. It hides others as an occluder of the
    /// animal's object. Where the clip moves no joint from the first one to this one it stays where
    /// it is, and the object needs no other occluder from frame to frame.
    pub fn posed(&self, pose: &Pose) -> Sphere {
        let center = pose.matrices().get(self.joint).map_or(self.center, |m| m.transform_point3(self.center));
        Sphere::new(center, self.radius)
    }
}

/// A large ball that a joint carries and that lies inside all levels of a mesh at all times of a
/// clip; `None` if none was found. `levels` are meshes with their weights.
///
/// The ball hides things behind it in each pose, whatever other joints do, and even where skin
/// folds. The clip is cut into 64 pieces. In the middle of each, all triangles of the posed skin
/// are farther from the ball than they and the ball stray within the piece, so that no triangle
/// meets it there; and the skin winds around its middle at least once. How often a closed surface
/// winds around a point changes only when it crosses the point, so that it winds around all points
/// of the ball at all times of the piece. A ray from where it does not wind to a point of the ball
/// enters skin more often than it leaves it, so that the eye sees skin before the ball. For an eye
/// within the skin, the skin behind the ball hides as much: both sides of skin are drawn.
///
/// Costs the triangles of the coarsest level times 1,728 and then times 48 for each piece, and once
/// the other levels for each piece.
///
/// # Errors
/// Refuses no levels, meshes that are not closed, weights of another mesh, and a joint that does
/// not exist.
pub fn carried_ball(
    levels: &[(&Mesh, &Weights)],
    skeleton: &Skeleton,
    clip: &Clip,
    joint: usize,
) -> Result<Option<CarriedBall>, Error> {
    for (mesh, weights) in levels {
        weights.check(mesh.vertices().len())?;
        match mesh.open_edges() {
            0 => {}
            edges => return Err(Error::Open { edges }),
        }
    }
    let joints = skeleton.joints().len();
    if joint >= joints {
        return Err(Error::Foreign { joint, joints });
    }
    let coarsest = levels.iter().min_by_key(|(mesh, _)| mesh.triangles().len()).ok_or(Error::Empty)?;
    let mut centers: Vec<Vec3> = deepest(coarsest.0).0.iter().map(|(p, _)| p.as_vec3()).collect();
    // Those that the joint may carry.
    let follow = followers(coarsest, joint);
    centers.retain(|p| follow.is_some_and(|(min, max)| p.cmpge(min).all() && p.cmple(max).all()));
    centers.truncate(CARRIED_CENTERS);
    let search = Search { skeleton, clip, joint };
    let depths = search.depths(std::slice::from_ref(coarsest), &centers);
    let best = centers.iter().zip(depths).max_by(|a, b| a.1.total_cmp(&b.1));
    let Some((&center, _)) = best.filter(|(_, depth)| *depth > 0.0) else { return Ok(None) };
    let radius = (search.depths(levels, &[center])[0] as f32).next_down();
    Ok((radius > 0.0).then_some(CarriedBall { joint, center, radius }))
}

/// The box of the vertices that follow a joint.
fn followers((mesh, weights): &(&Mesh, &Weights), joint: usize) -> Option<(Vec3, Vec3)> {
    let rows = mesh.vertices().iter().zip(weights.joints().iter().zip(weights.shares()));
    rows.filter(|(_, (joints, shares))| {
        joints.iter().zip(*shares).any(|(j, share)| usize::from(*j) == joint && *share > 0.0)
    })
    .map(|(vertex, _)| (vertex.position, vertex.position))
    .reduce(|(min, max), (p, _)| (min.min(p), max.max(p)))
}

struct Search<'a> {
    skeleton: &'a Skeleton,
    clip: &'a Clip,
    joint: usize,
}

impl Search<'_> {
    /// How deep in all levels points are that the joint carries, at all times: 0 or less for those
    /// that are outside at any.
    fn depths(&self, levels: &[(&Mesh, &Weights)], centers: &[Vec3]) -> Vec<f64> {
        let mut depths = vec![f64::INFINITY; centers.len()];
        let mut posed: Vec<(DVec3, f64)> = Vec::new();
        pieces(self.skeleton, self.clip, |pose, strays| {
            for (mesh, weights) in levels {
                posed.clear();
                let mut greatest = 0f64;
                for (v, vertex) in mesh.vertices().iter().enumerate() {
                    let at = weights.blend(v, pose).transform_point3(vertex.position).as_dvec3();
                    greatest = greatest.max(at.length()).max(vertex.position.length().into());
                    // A mean of images strays no farther than the mean of their ways.
                    let rows = weights.joints()[v].iter().zip(weights.shares()[v]).filter(|(_, s)| *s > 0.0);
                    let far = rows.map(|(&joint, share)| {
                        let way = stray(strays, self.skeleton, joint.into(), vertex.position, 0.0);
                        f64::from(share) * way
                    });
                    posed.push((at, far.sum()));
                }
                let margin = INNER_ROUNDING * greatest;
                for (center, depth) in centers.iter().zip(&mut depths).filter(|(_, depth)| **depth > 0.0) {
                    let there = pose.matrices()[self.joint].transform_point3(*center).as_dvec3();
                    let triangles = mesh.triangles().iter().map(|t| {
                        let [a, b, c] = t.map(|v| posed[v as usize]);
                        ([a.0, b.0, c.0], a.1.max(b.1).max(c.1))
                    });
                    let own = stray(strays, self.skeleton, self.joint, *center, 0.0);
                    let found = depth_among(triangles, there) - own - margin;
                    // NaN counts as outside.
                    *depth = if found.is_nan() { f64::NEG_INFINITY } else { depth.min(found) };
                }
            }
        });
        depths
    }
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;
    use crate::samples::{Dice, ball, dice};
    use crate::skin::{Channel, Ending, Interpolation, Joint, Track};

    /// The share of a joint that hardly moves a vertex, which then still counts as following it.
    const HARDLY: f32 = 1e-6;

    /// A ball whose halves swing against each other, its middle softly, and grow and move.
    fn swinger(random: &mut Dice, how: Interpolation) -> (Mesh, Weights, Skeleton, Clip) {
        let mesh = ball(5);
        let joints = vec![
            Joint::at(None, Vec3::ZERO),
            Joint::at(Some(0), Vec3::X * 0.3),
            Joint::at(Some(1), Vec3::X * 0.3),
        ];
        let skeleton = Skeleton::new(joints).unwrap();
        let share = |p: Vec3| (p.x * 2.0).clamp(0.0, 1.0);
        let shares: Vec<[f32; 4]> = mesh
            .vertices()
            .iter()
            .map(|v| [1.0 - share(v.position), share(v.position) * 0.5, share(v.position) * 0.5, 0.0])
            .collect();
        let weights = Weights::new(&vec![[0, 1, 2, 0]; shares.len()], &shares, &skeleton).unwrap();
        let keys = 6;
        let times: Vec<f32> = (0..keys).map(|i| i as f32 * 0.2).collect();
        let per_key = if how == Interpolation::CubicSpline { 3 } else { 1 };
        let mut turn = |most: f64| {
            Quat::from_axis_angle(random.direction(), ((2.0 * random.next() - 1.0) * most) as f32)
        };
        let mut channels = Vec::new();
        for joint in 0..3 {
            let turns = (0..keys * per_key).map(|i| match per_key == 3 && i % 3 != 1 {
                true => Quat::from_xyzw(0.3, -0.2, 0.1, 0.0),
                false => turn(if joint == 0 { 1.0 } else { 0.5 }),
            });
            let track = Track::new(times.clone(), turns.collect(), how).unwrap();
            channels.push((joint, Channel::Rotation(track)));
        }
        let values: Vec<Vec3> = (0..keys * per_key).map(|_| random.point() * 0.3).collect();
        channels.push((0, Channel::Translation(Track::new(times.clone(), values, how).unwrap())));
        let scales = (0..keys * per_key).map(|i| match per_key == 3 && i % 3 != 1 {
            true => Vec3::splat(0.4),
            false => Vec3::ONE + random.point() * 0.3,
        });
        channels.push((2, Channel::Scale(Track::new(times, scales.collect(), how).unwrap())));
        let clip = Clip::new(channels, &skeleton).unwrap();
        (mesh, weights, skeleton, clip)
    }

    #[test]
    fn carried_balls_are_inside_the_skin_at_all_times() {
        let mut random = dice(17);
        let (mut found, mut tightest, mut at_rest) = (0, f64::INFINITY, 0.0f64);
        for case in 0..12 {
            let how = [Interpolation::Linear, Interpolation::CubicSpline, Interpolation::Step][case % 3];
            let (mesh, weights, skeleton, clip) = swinger(&mut random, how);
            let coarse = mesh.simplified(120).unwrap().0;
            let carried = weights.carried(&mesh, &coarse).unwrap();
            let levels = [(&mesh, &weights), (&coarse, &carried)];
            let Some(ball) = carried_ball(&levels, &skeleton, &clip, case / 3 % 2).unwrap() else { continue };
            found += 1;
            at_rest += f64::from(ball.radius);
            let mut pose = Pose::rest(&skeleton);
            for step in 0..1500 {
                pose.set(&skeleton, &clip, f64::from(step) / 1500.0, Ending::Loop);
                let sphere = ball.posed(&pose);
                for (mesh, weights) in levels {
                    let at = |v: u32| {
                        let p = mesh.vertices()[v as usize].position;
                        weights.blend(v as usize, &pose).transform_point3(p).as_dvec3()
                    };
                    let triangles = mesh.triangles().iter().map(|t| (t.map(at), 0.0));
                    let deep = depth_among(triangles, sphere.center.as_dvec3());
                    assert!(deep >= f64::from(sphere.radius), "case {case}, step {step}: {deep} {sphere:?}");
                    tightest = tightest.min(deep / f64::from(sphere.radius));
                }
            }
        }
        println!(
            "{found} balls of mean radius {:.3}; the skin comes as near as {tightest:.3}",
            at_rest / f64::from(found)
        );
        assert!(found >= 8 && tightest < 1.5, "{found} {tightest}");
    }

    #[test]
    fn skin_that_passes_through_itself_carries_no_ball_there() {
        // All of the mesh but the joint's own place runs away.
        let (mesh, skeleton) = (
            ball(4),
            Skeleton::new(vec![Joint::at(None, Vec3::ZERO), Joint::at(Some(0), Vec3::ZERO)]).unwrap(),
        );
        let count = mesh.vertices().len();
        let weights = |joint| {
            let shares = vec![[HARDLY, 1.0, 0.0, 0.0]; count];
            Weights::new(&vec![[joint, 1, 0, 0]; count], &shares, &skeleton).unwrap()
        };
        let away = |most: f32| {
            let places = vec![Vec3::ZERO, Vec3::X * most, Vec3::ZERO];
            let track = Track::new(vec![0.0, 0.5, 1.0], places, Interpolation::Linear).unwrap();
            Clip::new(vec![(1, Channel::Translation(track))], &skeleton).unwrap()
        };
        let own = weights(0);
        let radius =
            |most: f32| carried_ball(&[(&mesh, &own)], &skeleton, &away(most), 0).unwrap().map(|b| b.radius);
        let (still, near) = (radius(0.0).unwrap(), radius(0.4).unwrap());
        assert!(still > 0.8 && near < still - 0.1 && near > 0.5, "{still} {near}");
        assert_eq!(radius(3.0), None);
        // Vertices that joint 1 carries run with it.
        let along = carried_ball(&[(&mesh, &own)], &skeleton, &away(3.0), 1).unwrap().unwrap();
        assert!(along.radius > 0.6, "{along:?}");
        let refused = carried_ball(&[(&mesh, &own)], &skeleton, &away(1.0), 2);
        assert_eq!(refused, Err(Error::Foreign { joint: 2, joints: 2 }));
        assert_eq!(carried_ball(&[], &skeleton, &away(1.0), 0), Err(Error::Empty));
    }

    #[test]
    fn what_happens_between_the_middles_of_pieces_counts() {
        let joint = || Joint::at(None, Vec3::ZERO);
        let (mesh, skeleton) = (ball(4), Skeleton::new(vec![joint(), joint()]).unwrap());
        let count = mesh.vertices().len();
        // The skin follows joint 1, the ball joint 0; one of them leaps and comes back.
        let shares = vec![[HARDLY, 1.0, 0.0, 0.0]; count];
        let weights = Weights::new(&vec![[0, 1, 0, 0]; count], &shares, &skeleton).unwrap();
        let radius = |joint: usize, leap: f32, how: Interpolation| {
            let (mut times, mut values) = (vec![0.0, 0.5001, 0.5002, 0.5003, 1.0], [0.0; 5].to_vec());
            values[2] = leap;
            if how == Interpolation::CubicSpline {
                // Back at the next key, and away between: an eighth of the time and of both speeds.
                let (key, speed) = (0.0, 4.0 * leap / 0.0002);
                times = vec![0.0, 0.5001, 0.5003, 1.0];
                values = vec![0.0, key, 0.0, 0.0, key, speed, -speed, key, 0.0, 0.0, key, 0.0];
            }
            let places = values.iter().map(|x| Vec3::X * *x).collect();
            let track = Track::new(times, places, how).unwrap();
            let clip = Clip::new(vec![(joint, Channel::Translation(track))], &skeleton).unwrap();
            carried_ball(&[(&mesh, &weights)], &skeleton, &clip, 0).unwrap().map(|ball| ball.radius)
        };
        let hows = [Interpolation::Linear, Interpolation::Step, Interpolation::CubicSpline];
        for (joint, how) in [0, 1].into_iter().flat_map(|joint| hows.map(|how| (joint, how))) {
            let (still, leapt) = (radius(joint, 0.0, how).unwrap(), radius(joint, 0.2, how).unwrap());
            // A spline may take twice its way.
            assert!(leapt < still - 0.19 && leapt > still - 0.5, "joint {joint}, {how:?}: {still} {leapt}");
            assert_eq!(radius(joint, 2.0, how), None);
        }
    }
}
