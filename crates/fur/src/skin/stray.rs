//! How far joints stray from where they are in the middle of a stretch of time.

use glam::{Mat3, Vec3};

use super::clip::{Channel, Clip};
use super::pose::{Ending, Pose};
use super::skeleton::Skeleton;
use crate::numeric::{CLIP_ERROR, CLIP_PIECES};

/// For a joint, how far a point that it carries strays: the image of a point at a distance `r` from
/// the joint is never farther than `fixed + turning * r` from where it is in the middle.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Stray {
    fixed: f64,
    turning: f64,
    /// The greatest distance of the joint from the origin, and the greatest factor by which it
    /// scales.
    away: f64,
    scale: f64,
}

impl Stray {
    /// How far the image of a point at a distance from the joint strays. `magnitude` is the
    /// greatest sum of magnitudes that went into its place relative to the joint, for its rounding.
    fn at(&self, distance: f64, magnitude: f64) -> f64 {
        let far = self.fixed + self.turning * distance + CLIP_ERROR * self.scale * magnitude;
        if far.is_nan() { f64::INFINITY } else { far }
    }
}

/// How far a point of the mesh at rest strays that follows a joint; nothing for a joint that does
/// not exist, which stays at rest.
pub(crate) fn stray(strays: &[Stray], skeleton: &Skeleton, joint: usize, point: Vec3, reach: f64) -> f64 {
    let (Some(stray), Some(of)) = (strays.get(joint), skeleton.joints().get(joint)) else { return 0.0 };
    let bind = of.inverse_bind;
    let norm =
        Mat3::from(bind.matrix3).to_cols_array().iter().map(|c| f64::from(*c).powi(2)).sum::<f64>().sqrt();
    let distance = f64::from(bind.transform_point3(point).length()) + norm * reach;
    stray.at(distance, norm * (f64::from(point.length()) + reach) + f64::from(bind.translation.length()))
}

/// How far the translation, the rotation (in radians) and the scale of a joint stray.
#[derive(Clone, Copy, Default)]
struct Change {
    moved: f64,
    turned: f64,
    scaled: f64,
}

/// Calls `visit` for each piece of a clip, with the pose in its middle and the strays of all
/// joints. Costs the keys of the clip, and for each piece all joints and channels.
///
/// A joint at the time t takes a point x to G(t) x, with G = P L, where P is its parent's and L its
/// own translation T, rotation R and scale S; c is the middle. |P(t) L(t) x - P(c) L(c) x| is at
/// most |P(t) (L(t) x - L(c) x)| + |P(t) y - P(c) y| with y = L(c) x. The first is at most the
/// greatest scale of P times |T(t) - T(c)| + |S(t) - S(c)| |x| + |R(t) - R(c)| |S(c)| |x|, as no
/// rotation lengthens; the second is what the parent's stray says of |y|, at most
/// |T(c)| + |S(c)| |x|.
pub(crate) fn pieces(skeleton: &Skeleton, clip: &Clip, mut visit: impl FnMut(&Pose, &[Stray])) {
    let long = clip.seconds();
    let count = if long > 0.0 { CLIP_PIECES } else { 1 };
    let at = |piece: u32| (f64::from(long) * f64::from(piece) / f64::from(count)) as f32;
    let mut pose = Pose::rest(skeleton);
    let mut changes = vec![Change::default(); skeleton.joints().len()];
    let mut strays: Vec<Stray> = Vec::with_capacity(changes.len());
    for piece in 0..count {
        let stretch = [at(piece), at(piece + 1)];
        let middle = 0.5 * stretch[0] + 0.5 * stretch[1];
        pose.set(skeleton, clip, middle.into(), Ending::Clamp);
        changes.fill(Change::default());
        for (joint, channel) in clip.channels() {
            let Some(change) = changes.get_mut(*joint) else { continue };
            // As in poses, of two channels the later counts.
            match channel {
                Channel::Translation(track) => change.moved = track.spread(stretch, middle),
                Channel::Rotation(track) => change.turned = track.spread(stretch, middle),
                Channel::Scale(track) => change.scaled = track.spread(stretch, middle),
            }
        }
        strays.clear();
        for ((joint, local), change) in skeleton.joints().iter().zip(pose.locals()).zip(&changes) {
            let still = Stray { scale: 1.0, ..Stray::default() };
            let parent = joint.parent.map_or(still, |parent| strays[parent]);
            let offset = f64::from(local.translation.length());
            let scale = f64::from(local.scale.abs().max_element());
            let chord = 2.0 * (0.5 * change.turned.min(std::f64::consts::PI)).sin();
            let away = parent.away + parent.scale * (offset + change.moved);
            let most = parent.scale * (scale + change.scaled);
            strays.push(Stray {
                fixed: parent.fixed
                    + parent.scale * change.moved
                    + parent.turning * offset
                    + CLIP_ERROR * away,
                turning: parent.turning * scale
                    + parent.scale * (change.scaled + chord * scale)
                    + CLIP_ERROR * most,
                away,
                scale: most,
            });
        }
        visit(&pose, &strays);
    }
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;
    use crate::mesh::Mesh;
    use crate::numeric::SKINNING_ERROR;
    use crate::samples::{Dice, ball, dice};
    use crate::skin::{Interpolation, Joint, Local, SkinBounds, Track, Weights};
    use crate::strands::Fur;

    /// A track of few keys, some at one time and some before 0.
    fn track<T: crate::skin::Keyed>(
        random: &mut Dice,
        how: Interpolation,
        value: impl Fn(&mut Dice) -> T,
        tangent: impl Fn(&mut Dice) -> T,
    ) -> Track<T> {
        let mut times: Vec<f32> = (0..6).map(|_| (random.next() * 2.2 - 0.2) as f32).collect();
        times.sort_by(f32::total_cmp);
        times[3] = times[2];
        let cubic = how == Interpolation::CubicSpline;
        let count = times.len() * if cubic { 3 } else { 1 };
        let values = (0..count).map(|i| if cubic && i % 3 != 1 { tangent(random) } else { value(random) });
        let values = values.collect();
        Track::new(times, values, how).unwrap()
    }

    /// `wild`: how far its joints move, as a share of what makes no sense.
    fn creature(random: &mut Dice, joints: usize, wild: f32) -> (Skeleton, Clip) {
        let turn =
            |random: &mut Dice| Quat::from_axis_angle(random.direction(), random.next() as f32 * 6.3 * wild);
        let made = (0..joints).map(|i| {
            let rest = Local { translation: random.point() * 2.0, rotation: turn(random), ..Local::IDENTITY };
            let parent = (i > 0).then(|| (random.next() * i as f64) as usize);
            Joint { rest, ..Joint::at(parent, Vec3::ZERO) }
        });
        let skeleton = Skeleton::new(made.collect()).unwrap();
        let mut channels = Vec::new();
        for joint in 0..joints {
            let hows = [Interpolation::Step, Interpolation::Linear, Interpolation::CubicSpline];
            let mut how = || hows[(random.next() * 3.0) as usize];
            let [a, b, c] = [how(), how(), how()];
            let small = |random: &mut Dice| Quat::from_vec4(random.point().extend(0.3) * wild);
            let place = |random: &mut Dice| Vec3::X * 3.0 + random.point() * wild;
            let speed = |random: &mut Dice| random.point() * wild;
            let scale = |random: &mut Dice| Vec3::ONE + random.point() * 0.5 * wild;
            channels.push((joint, Channel::Translation(track(random, a, place, speed))));
            channels.push((joint, Channel::Rotation(track(random, b, turn, small))));
            channels.push((joint, Channel::Scale(track(random, c, scale, speed))));
        }
        let clip = Clip::new(channels, &skeleton).unwrap();
        (skeleton, clip)
    }

    fn weights(random: &mut Dice, mesh: &Mesh, skeleton: &Skeleton) -> Weights {
        let count = skeleton.joints().len() as f64;
        let joints: Vec<[u32; 4]> =
            mesh.vertices().iter().map(|_| [0; 4].map(|_| (random.next() * count) as u32)).collect();
        Weights::new(&joints, &vec![[0.4, 0.3, 0.2, 0.1]; joints.len()], skeleton).unwrap()
    }

    #[test]
    fn bounds_of_clips_hold_all_their_poses() {
        let mut random = dice(23);
        let (mut poses, mut tightest, mut calm) = (0, 0f32, true);
        for case in 0..60 {
            let mesh = ball(2);
            let (skeleton, clip) = creature(&mut random, 1 + case % 5, if case % 2 == 0 { 0.1 } else { 1.0 });
            let weights = weights(&mut random, &mesh, &skeleton);
            let fur = Fur::for_radius(1.0, 0.1 * random.next() as f32, 0.2).unwrap();
            let bounds = SkinBounds::new(&mesh, &weights).unwrap();
            let whole = bounds.over(&skeleton, &clip, &fur);
            let mut pose = Pose::rest(&skeleton);
            let mut need = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            for step in 0..400 {
                let time = f64::from(clip.seconds()) * (f64::from(step) + random.next()) / 400.0;
                pose.set(&skeleton, &clip, time, Ending::Loop);
                let posed = bounds.posed(&pose, &fur);
                // The bounds of a pose are wider than it by the same rounding.
                let slack = 2.0 * SKINNING_ERROR * posed.min.abs().max(posed.max.abs()).max_element();
                assert!(
                    posed.min.cmpge(whole.min - slack).all() && posed.max.cmple(whole.max + slack).all(),
                    "case {case}, {time}: {posed:?} is not in {whole:?}"
                );
                need = (need.0.min(posed.min), need.1.max(posed.max));
                poses += 1;
            }
            let share = (need.1 - need.0) / (whole.max - whole.min);
            tightest = tightest.max(share.min_element());
            calm &= case % 2 == 1 || share.min_element() > 0.15;
        }
        println!("{poses} poses held; the best box is {:.3} times too wide", 1.0 / tightest);
        assert!(poses == 24_000 && calm && tightest > 0.8, "{tightest}");
    }

    #[test]
    fn points_stray_no_farther_within_any_piece() {
        let mut random = dice(29);
        let (mut checked, mut nearest) = (0, 0f64);
        for case in 0..40 {
            let (skeleton, clip) = creature(&mut random, 1 + case % 5, if case % 2 == 0 { 0.1 } else { 1.0 });
            let (mut pose, mut piece) = (Pose::rest(&skeleton), 0);
            pieces(&skeleton, &clip, |middle, strays| {
                let joint = (random.next() * skeleton.joints().len() as f64) as usize;
                let point = random.point();
                let most = stray(strays, &skeleton, joint, point, 0.0);
                for _ in 0..8 {
                    let share = (f64::from(piece) + random.next()) / f64::from(CLIP_PIECES);
                    pose.set(&skeleton, &clip, f64::from(clip.seconds()) * share, Ending::Clamp);
                    let at = |pose: &Pose| pose.matrices()[joint].transform_point3(point);
                    let way = f64::from(at(&pose).distance(at(middle)));
                    assert!(way <= most, "case {case}, piece {piece}: {way} {most}");
                    nearest = nearest.max(if most.is_finite() { way / most } else { 0.0 });
                    checked += 1;
                }
                piece += 1;
            });
        }
        println!("{checked} places; the farthest strays {nearest:.3} of what is allowed");
        assert!(checked == 40 * 8 * CLIP_PIECES && nearest > 0.9, "{checked} {nearest}");
    }

    #[test]
    fn nothing_strays_without_motion_and_absurd_clips_give_boxes_that_scenes_refuse() {
        let skeleton = Skeleton::new(vec![Joint::at(None, Vec3::ONE), Joint::at(Some(0), Vec3::X)]).unwrap();
        let mesh = ball(3);
        let count = mesh.vertices().len();
        let weights = Weights::new(&vec![[0, 1, 1, 1]; count], &vec![[0.5, 0.5, 0.0, 0.0]; count], &skeleton);
        let bounds = SkinBounds::new(&mesh, &weights.unwrap()).unwrap();
        let fur = Fur::for_radius(1.0, 0.1, 0.2).unwrap();
        let still = bounds.over(&skeleton, &Clip::default(), &fur);
        let rest = bounds.posed(&Pose::rest(&skeleton), &fur);
        assert!(still.min.distance(rest.min) < 3e-4 && still.max.distance(rest.max) < 3e-4);
        let far = Track::new(vec![0.0, 1.0], vec![Vec3::ZERO, Vec3::splat(1e9)], Interpolation::Linear);
        let wide = Track::new(vec![0.0, 1.0], vec![Vec3::ONE, Vec3::splat(1e9)], Interpolation::Linear);
        let (far, wide) = (far.unwrap(), wide.unwrap());
        let channels = vec![
            (0, Channel::Scale(wide.clone())),
            (1, Channel::Scale(wide)),
            (1, Channel::Translation(far)),
        ];
        let clip = Clip::new(channels, &skeleton).unwrap();
        let absurd = bounds.over(&skeleton, &clip, &fur);
        assert!(!absurd.min.is_finite() || absurd.max.max_element() > 1e17, "{absurd:?}");
    }
}
