//! Clips: what moves which joint.

use glam::{Quat, Vec3};

use super::skeleton::Skeleton;
use super::track::Track;
use crate::error::Error;

/// The translation, rotation or scale of a joint over time. It replaces that at rest.
#[derive(Debug, Clone, PartialEq)]
pub enum Channel {
    /// Its translation.
    Translation(Track<Vec3>),
    /// Its rotation.
    Rotation(Track<Quat>),
    /// Its scale.
    Scale(Track<Vec3>),
}

impl Channel {
    fn end(&self) -> f32 {
        match self {
            Self::Translation(track) | Self::Scale(track) => track.end(),
            Self::Rotation(track) => track.end(),
        }
    }
}

/// Joints over time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Clip {
    channels: Vec<(usize, Channel)>,
    seconds: f32,
}

impl Clip {
    /// A clip of channels and the joints that they move; of two for one property of a joint the
    /// later counts. It lasts from time 0 to its last key.
    ///
    /// # Errors
    /// Refuses joints that the skeleton lacks.
    pub fn new(channels: Vec<(usize, Channel)>, skeleton: &Skeleton) -> Result<Self, Error> {
        let joints = skeleton.joints().len();
        if let Some((joint, _)) = channels.iter().find(|(joint, _)| *joint >= joints) {
            return Err(Error::Foreign { joint: *joint, joints });
        }
        let seconds = channels.iter().map(|(_, channel)| channel.end()).fold(0.0, f32::max);
        Ok(Self { channels, seconds })
    }

    /// Its channels, and the joints that they move.
    pub fn channels(&self) -> &[(usize, Channel)] {
        &self.channels
    }

    /// How long it lasts, in seconds.
    pub fn seconds(&self) -> f32 {
        self.seconds
    }
}
