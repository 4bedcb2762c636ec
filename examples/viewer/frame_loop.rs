//! casca in a render loop. This is what an engine copies: tell the scene what moved, ask what can
//! be seen, draw that, and give the answer back so that hidden moving objects cost nothing.

use std::error::Error;

use casca::{Query, Scene};
use casca_harness::drive::{Driver, view_of};
use casca_harness::world::{Camera, Object};

/// Nothing, or what went wrong.
pub type Done = Result<(), Box<dyn Error>>;

/// One frame. `moved` are the objects with another shape than in the frame before, `camera` is what
/// looks, and `draw` draws the objects of [`Query::pvs`].
///
/// # Errors
/// Coordinates or a matrix that are not finite, and what `draw` returns.
pub fn frame(
    driver: &mut Driver,
    query: &mut Query,
    seconds: f64,
    (objects, moved): (&[Object], &[usize]),
    camera: &Camera,
    draw: &mut dyn FnMut(&Scene, &Query) -> Done,
) -> Done {
    driver.scene.begin_frame(seconds)?;
    // Scene::update for each of them.
    driver.update(objects, moved)?;
    query.run(&driver.scene, &view_of(camera)?);
    draw(&driver.scene, query)?;
    driver.scene.end_frame([query.pvs()])?;
    Ok(())
}
