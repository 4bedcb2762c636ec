//! Questions after a run: boxes and points in sight, and the casters of shadows.

use casca::glam::Vec3;
use casca::{Aabb, Light, Sight};

use crate::border::{self, Out, OutList, grows};
use crate::error::{Failure, call, casca_status};
use crate::query::{QUERIES, Way, casca_query};
use crate::scene::{SCENES, casca_scene};
use crate::view::{self, casca_view};

/// casca_light.kind: infinitely far away, such as the sun. Give direction.
pub const CASCA_LIGHT_DIRECTIONAL: u32 = 0;
/// casca_light.kind: shines from a point in all directions. Give position and range.
pub const CASCA_LIGHT_POINT: u32 = 1;
/// casca_light.kind: shines from the eye of a view on all that lies inside: the camera of a shadow
/// map. Give view.
pub const CASCA_LIGHT_SPOT: u32 = 2;

/// A light that casts shadows. Fill it by CASCA_INIT.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct casca_light {
    /// sizeof(casca_light).
    pub size: usize,
    /// One of CASCA_LIGHT_...
    pub kind: u32,
    /// Of CASCA_LIGHT_POINT: it lights nothing farther away, in world units. 0: no limit.
    pub range: f32,
    /// The direction in which light travels, of any length.
    pub direction: [f32; 3],
    /// The place of the lamp in world units.
    pub position: [f32; 3],
    /// The layers of the objects that cast its shadows, a bit for each. 0: those of the view, or
    /// all.
    pub layers: u64,
    /// Of CASCA_LIGHT_SPOT: the view, read during the call only.
    pub view: *const casca_view,
}

grows!(casca_light: size_of::<casca_light>(),);

impl casca_light {
    fn get(&self) -> Result<Light, Failure> {
        let light = match self.kind {
            CASCA_LIGHT_DIRECTIONAL => Light::directional(Vec3::from_array(self.direction)),
            CASCA_LIGHT_POINT => {
                let range = if self.range == 0.0 { f32::INFINITY } else { self.range };
                Light::point(Vec3::from_array(self.position), range)
            }
            CASCA_LIGHT_SPOT => Light::spot(view::read(self.view)?),
            other => return Err(Failure::unknown("casca_light.kind", other)),
        };
        Ok(if self.layers == 0 { light } else { light.with_layers(self.layers) })
    }
}

/// Asks the last run of a query about many places.
fn ask<T: border::Plain>(
    (query, scene): (casca_query, casca_scene),
    (places, count, what): (*const T, usize, &str),
    answers: *mut u8,
    may_see: impl Fn(&Sight, &T) -> bool,
) -> Result<(), Failure> {
    let out = OutList::new(answers, count, "answers")?;
    let places = border::span(places, count, what)?;
    let (state, camera) = (SCENES.shared(scene.handle)?, QUERIES.shared(query.handle)?);
    let sight = camera.sight(&state)?;
    out.set(places.iter().map(|place| may_see(&sight, place).into()));
    Ok(())
}

/// Whether the view of the last run may see each of count boxes, which need not be objects: six
/// floats for each, the least corner and the greatest. answers has room for count bytes: 0 is
/// surely hidden, 1 may be seen. A box that is inverted or not finite may be seen.
///
/// Occluders count as long as nothing moved since the run, for CASCA_METHOD_POINT; else only the
/// frustum does. Errors: a query that did not run on this scene. Costs a comparison with the
/// occlusion buffers for each box.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_query_may_see_boxes(
    query: casca_query,
    scene: casca_scene,
    boxes: *const f32,
    count: usize,
    answers: *mut u8,
) -> casca_status {
    call(|| {
        let boxes = boxes.cast::<[f32; 6]>();
        ask((query, scene), (boxes, count, "boxes"), answers, |sight, &[x, y, z, to_x, to_y, to_z]| {
            sight.may_see_box(&Aabb::new(Vec3::new(x, y, z), Vec3::new(to_x, to_y, to_z)))
        })
    })
}

/// As casca_query_may_see_boxes, for count points of three floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_query_may_see_points(
    query: casca_query,
    scene: casca_scene,
    points: *const f32,
    count: usize,
    answers: *mut u8,
) -> casca_status {
    call(|| {
        let points = points.cast::<[f32; 3]>();
        ask((query, scene), (points, count, "points"), answers, |sight, point| {
            sight.may_see_point(Vec3::from_array(*point))
        })
    })
}

/// Finds the objects whose shadows may fall on what the last run of camera sees. light is another
/// query, without CASCA_KEPT, kept for this light; casca_query_get_visible gives its casters. count
/// may be null.
///
/// Every occluder is taken to cast a shadow. Call it before casca_scene_end_frame. Errors: a camera
/// that did not run on this scene, lights that are not finite or have no direction. Costs a query
/// of the light's view.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_query_shadow_casters(
    light: casca_query,
    scene: casca_scene,
    camera: casca_query,
    lamp: *const casca_light,
    count: *mut usize,
) -> casca_status {
    call(|| {
        let out = Out::or_null(count, "count")?;
        let lamp = border::read(lamp)?.get()?;
        let (state, camera) = (SCENES.shared(scene.handle)?, QUERIES.shared(camera.handle)?);
        let mut light = QUERIES.exclusive(light.handle)?;
        let Way::Fresh(query) = &mut light.way else {
            return Err(Failure::argument("the query of a light must be made without CASCA_KEPT"));
        };
        let mut casters = Vec::new();
        match &camera.way {
            Way::Fresh(camera) => query.shadow_casters(&state.scene, &**camera, &lamp, &mut casters)?,
            Way::Kept(camera) => query.shadow_casters(&state.scene, &**camera, &lamp, &mut casters)?,
        }
        light.found = state.ids(casters.into_iter()).collect();
        out.set(light.found.len());
        Ok(())
    })
}
