//! Occluders of a field besides walls.

use casca::Occluder;
use casca_fur::Error;
use casca_fur::skin::Pose;
use casca_fur::visibility::{base_occluder, carried_ball, inner_ball};

use crate::fur::species::Species;

/// The occluders of a field besides walls.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Hiding {
    /// Walls only.
    Walls,
    /// A ball inside all levels of detail of each animal whose meshes are closed, and walls. In a
    /// herd it is a ball that stays inside the trunk throughout the walk, of species whose trunk is
    /// known ([`Rig::trunk`](crate::fur::animals::Rig::trunk)).
    #[default]
    Balls,
    /// The finest mesh of each animal whose meshes are closed, and walls. Draw that level only. In
    /// a herd, as balls: the mesh at rest says nothing about poses.
    Meshes,
}

/// The occluder of a species, in the space of meshes at rest or, if it walks, of posed meshes.
pub(super) fn occluder(kind: &Species, hiding: Hiding, walks: bool) -> Result<Option<Occluder>, Error> {
    let levels = kind.levels();
    // One could look through the holes of an open mesh.
    if hiding == Hiding::Walls || levels.iter().any(|mesh| mesh.open_edges() > 0) {
        return Ok(None);
    }
    if walks {
        let rig = kind.walker()?;
        let Some(trunk) = rig.trunk else { return Ok(None) };
        // The walk does not move the trunk, so that the ball stays where it is in the object.
        let levels: Vec<_> = levels.iter().zip(&rig.weights).collect();
        let ball = carried_ball(&levels, &rig.skeleton, &rig.walk, trunk)?;
        return Ok(ball.map(|ball| ball.posed(&Pose::rest(&rig.skeleton)).into()));
    }
    Ok(match hiding {
        Hiding::Meshes => Some(base_occluder(&levels[0])?.into()),
        _ => inner_ball(&levels.iter().collect::<Vec<_>>())?.map(Occluder::from),
    })
}
