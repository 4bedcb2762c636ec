//! casca in a render loop. This is what an engine copies: tell the scene what moved, ask what can
//! be seen, draw that, and give the answer back so that queries test no hidden moving objects.

use std::time::Duration;

use casca::{Query, Scene};
use casca_scenes::drive::{Driver, view_of};
use casca_scenes::world::{Camera, Object};
use casca_stage::timing::Instant;
use casca_stage::window::Done;

/// One frame. `moved` are the objects with another shape than in the frame before, `camera` is what
/// looks, and `draw` draws the objects of [`Query::pvs`]; it is told the time of the query.
///
/// # Errors
/// Coordinates or a matrix that are not finite, and what `draw` returns.
pub fn frame(
    driver: &mut Driver,
    query: &mut Query,
    seconds: f64,
    (objects, moved): (&[Object], &[usize]),
    camera: &Camera,
    draw: &mut dyn FnMut(&Scene, &Query, Duration) -> Done,
) -> Done {
    driver.scene.begin_frame(seconds)?;
    // Scene::update for each of them.
    driver.update(objects, moved)?;
    let view = view_of(camera)?;
    let start = Instant::now();
    query.run(&driver.scene, &view);
    draw(&driver.scene, query, start.elapsed())?;
    driver.scene.end_frame([query.pvs()])?;
    Ok(())
}
