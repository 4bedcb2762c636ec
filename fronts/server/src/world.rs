//! What servers in space and on maps of tiles do each in their own way.

use std::fmt::Debug;

use crate::describe::ClientDesc;
use crate::error::ServerError;
use crate::options::ServerOptions;

/// Where the eyes and entities of a server are: [`Space`](crate::Space), or tiles.
pub trait World: Debug + Sync {
    /// Where an eye is.
    type Eye: Debug + Copy + Send + Sync + 'static;
    /// Around all that can be seen of an entity.
    type Bounds: Debug + Copy + Send + Sync;
    /// What is kept about the eye of a client from tick to tick.
    type Kept: Debug + Default + Send + 'static;
    /// Where an entity may be.
    type Reached: Send + Sync;
    /// What a client may see.
    type Look<'a>
    where
        Self: 'a;

    /// Refuses places where no eye can be.
    fn check_eye(&self, eye: &Self::Eye) -> Result<(), ServerError>;

    /// Refuses places where no entity can be.
    fn check_bounds(&self, bounds: &Self::Bounds) -> Result<(), ServerError>;

    /// How far an eye went.
    fn apart(from: &Self::Eye, to: &Self::Eye) -> f64;

    /// Begins a tick: gets to know all that `place` and `look` need. Each client comes with how far
    /// its eye may be from where it was reported.
    fn begin<'c>(
        &mut self,
        clients: impl Iterator<Item = (&'c ClientDesc<Self::Eye>, f64, &'c mut Self::Kept)>,
        tick: u64,
        options: &ServerOptions,
    ) -> Result<(), ServerError>;

    /// Where an entity may be that went `reach` at most.
    fn place(&self, bounds: &Self::Bounds, reach: f64) -> Self::Reached;

    /// What eyes see that went `reach` at most.
    fn look<'a>(&'a self, eye: &Self::Eye, reach: f64, kept: &'a mut Self::Kept) -> Self::Look<'a>;

    /// Whether one of these eyes may see a point of an entity, by its slot and where it may be; in
    /// doubt, yes.
    fn may_see(look: &mut Self::Look<'_>, slot: usize, place: &Self::Reached) -> bool;
}
