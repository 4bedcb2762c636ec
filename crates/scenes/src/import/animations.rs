//! Animations of files, as tracks of nodes.

use glam::{Quat, Vec3};
use gltf::animation::{Interpolation, Property};

use super::accessors::{Buffers, Components, unfit};
use super::error::Trouble;
use super::nodes::{Nodes, unit, wrong};
use super::track::Track;

/// Reads all animations onto their nodes; gives the length of the longest that is used. All play at
/// once; what two of them animate follows the first.
pub fn animate(document: &gltf::Document, buffers: &Buffers, nodes: &mut Nodes) -> Result<f32, Trouble> {
    let mut places = vec![None; document.nodes().len()];
    for (place, node) in nodes.0.iter().enumerate() {
        places[node.index] = Some(place);
    }
    let mut clip = 0f32;
    for animation in document.animations() {
        for channel in animation.channels() {
            let target = channel.target();
            let Some(place) = places[target.node().index()] else { continue };
            let node = &mut nodes.0[place];
            if target.property() == Property::MorphTargetWeights {
                node.morphs = true;
                continue;
            }
            if node.matrix.is_some() {
                return Err(wrong(&target.node(), "is animated, but given as a matrix"));
            }
            let tracks = &mut node.tracks;
            let end = match keys_of(buffers, &channel)? {
                Keys::Rotation(track) => put(&mut tracks.rotation, track, |q| q.as_dquat()),
                Keys::Translation(track) => put(&mut tracks.translation, track, |v| v.as_dvec3()),
                Keys::Scale(track) => put(&mut tracks.scale, track, |v| v.as_dvec3()),
            };
            clip = clip.max(end);
            node.moves = true;
        }
    }
    Ok(clip)
}

const VALUES: &str = "animation values";

/// The keys of a channel.
pub enum Keys {
    /// Of places.
    Translation(Track<Vec3>),
    /// Of turns.
    Rotation(Track<Quat>),
    /// Of sizes.
    Scale(Track<Vec3>),
}

/// Reads the keys of a channel, which moves, turns or scales its node.
pub fn keys_of(buffers: &Buffers, channel: &gltf::animation::Channel) -> Result<Keys, Trouble> {
    let sampler = channel.sampler();
    let (output, interpolation) = (sampler.output(), sampler.interpolation());
    let times = times_of(buffers, &sampler.input())?;
    let per_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
    if times.len().checked_mul(per_key) != Some(output.count()) {
        return Err(unfit(&output, VALUES, "not as long as its times"));
    }
    Ok(match channel.target().property() {
        Property::Rotation => {
            let values = rotations_of(buffers, &output, interpolation)?;
            Keys::Rotation(Track { times, values, interpolation })
        }
        Property::Translation => {
            Keys::Translation(Track { times, values: buffers.vectors(&output, VALUES)?, interpolation })
        }
        _ => Keys::Scale(Track { times, values: buffers.vectors(&output, VALUES)?, interpolation }),
    })
}

/// Fills a place that is empty, and returns the time of the last key; returns 0 if the place was taken.
fn put<T, U>(place: &mut Option<Track<U>>, track: Track<T>, exact: impl Fn(T) -> U) -> f32 {
    if place.is_some() {
        return 0.0;
    }
    let end = track.times.last().copied().unwrap_or(0.0);
    *place = Some(track.map(exact));
    end
}

fn times_of(buffers: &Buffers, accessor: &gltf::Accessor) -> Result<Vec<f32>, Trouble> {
    let what = "animation times";
    let times = buffers.floats::<1>(accessor, what, Components::Floats)?;
    let times: Vec<f32> = times.into_iter().map(|[t]| t).collect();
    if times.iter().any(|t| !t.is_finite()) || !times.is_sorted() {
        return Err(unfit(accessor, what, "not finite, or not in ascending order"));
    }
    Ok(times)
}

fn rotations_of(
    buffers: &Buffers,
    accessor: &gltf::Accessor,
    interpolation: Interpolation,
) -> Result<Vec<Quat>, Trouble> {
    let values = buffers.floats(accessor, VALUES, Components::Normalized)?;
    let mut values: Vec<Quat> = values.into_iter().map(Quat::from_array).collect();
    if values.iter().any(|q| !q.is_finite()) {
        return Err(unfit(accessor, VALUES, "not finite"));
    }
    let cubic = interpolation == Interpolation::CubicSpline;
    for (i, value) in values.iter_mut().enumerate() {
        // Between the tangents of splines, which are no rotations.
        if cubic && i % 3 != 1 {
            continue;
        }
        let one = unit(value.as_dquat())
            .ok_or_else(|| unfit(accessor, VALUES, "with a rotation of no or great length"))?;
        // A spline is normalised where it has been evaluated.
        if !cubic {
            *value = one.as_quat();
        }
    }
    Ok(values)
}
