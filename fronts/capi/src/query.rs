//! Queries, fresh and kept, under one kind of handle.

use casca::{CameraQuery, CellOptions, KeptOptions, KeptQuery, Method, PointOptions, Pvs, Query, Sight};

use crate::border::{self, Out, OutSpan, give, give_struct, grows};
use crate::error::{Failure, call, casca_status};
use crate::handle::Registry;
use crate::scene::{SCENES, SceneState, casca_scene};
use crate::view::{self, casca_view};

pub(crate) static QUERIES: Registry<Camera> = Registry::new(2);

/// The memory of one camera or light, and its last result. {0} is none.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct casca_query {
    /// A number that only casca can read.
    pub handle: u64,
}

/// casca_query_options.method: the objects that the eye can see, at pixel precision.
pub const CASCA_METHOD_POINT: u32 = 0;
/// casca_query_options.method: the objects that can be seen from anywhere in the eye's grid cell.
pub const CASCA_METHOD_CELL: u32 = 1;
/// casca_query_options.method: the objects in the view, hidden or not.
pub const CASCA_METHOD_FRUSTUM: u32 = 2;

/// casca_query_options.preset: the default, between the other two.
pub const CASCA_PRESET_BALANCED: u32 = 0;
/// casca_query_options.preset: the least time, and the largest sets.
pub const CASCA_PRESET_FAST: u32 = 1;
/// casca_query_options.preset: the smallest sets, and the most time.
pub const CASCA_PRESET_TIGHT: u32 = 2;

/// casca_query_options.flags: begin with the occluders of the last run. For cameras that move
/// little: 45 to 85 percent of the time, sets up to 12 percent larger.
pub const CASCA_COHERENT: u32 = 1;
/// casca_query_options.flags: answer many frames from one result about static objects, while the
/// camera stays within reach and turn.
pub const CASCA_KEPT: u32 = 2;

/// How a query works. Fill it by CASCA_INIT; 0 is the default of each field. No option can hide
/// what can be seen: they trade time for the number of hidden objects in sets.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct casca_query_options {
    /// sizeof(casca_query_options).
    pub size: usize,
    /// One of CASCA_METHOD_...
    pub method: u32,
    /// One of CASCA_PRESET_..., for CASCA_METHOD_POINT.
    pub preset: u32,
    /// 0, or some of CASCA_COHERENT and CASCA_KEPT. Both need CASCA_METHOD_POINT.
    pub flags: u32,
    /// The width of a pixel of the occlusion buffers, in degrees from 0.03 to 11.25; 0: 0.25.
    pub pixel_degrees: f32,
    /// Of CASCA_METHOD_CELL: directions along each side, a power of two from 64 to 4096; 0: 256.
    pub mask_resolution: u32,
    /// With CASCA_KEPT, how far the eye may go, in world units; 0: 0.1.
    pub reach: f32,
    /// With CASCA_KEPT, by how much the camera may turn, in radians; 0: 0.15.
    pub turn: f32,
}

/// The work of the last run. Fill it by CASCA_INIT.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct casca_stats {
    /// sizeof(casca_stats).
    pub size: usize,
    /// Objects compared with the frustum.
    pub objects_tested: u64,
    /// Comparisons of objects with the occlusion buffers.
    pub occlusion_tests: u64,
    /// Occluders drawn.
    pub occluders_drawn: u64,
    /// Cells visited, by CASCA_METHOD_CELL.
    pub cells_visited: u64,
    /// Bricks of 8x8x8 cells visited, by CASCA_METHOD_POINT.
    pub bricks_visited: u64,
    /// Of a kept query, how many runs found a new result since it was made.
    pub refreshes: u64,
    /// 1 if the eye was inside an occluder, or the near plane cut into one; else 0.
    pub eye_in_occluder: u32,
}

grows!(
    casca_query_options: size_of::<casca_query_options>(),
    casca_stats: size_of::<casca_stats>(),
);

/// A query of either sort.
pub(crate) enum Way {
    Fresh(Box<Query>),
    Kept(Box<KeptQuery>),
}

/// A query and the ids that it found.
pub(crate) struct Camera {
    pub(crate) way: Way,
    pub(crate) found: Vec<u64>,
}

impl Camera {
    pub(crate) fn pvs(&self) -> &Pvs {
        match &self.way {
            Way::Fresh(query) => query.pvs(),
            Way::Kept(query) => query.pvs(),
        }
    }

    pub(crate) fn sight(&self, state: &SceneState) -> Result<Sight<'_>, Failure> {
        let sight = match &self.way {
            Way::Fresh(query) => CameraQuery::sight(&**query, &state.scene),
            Way::Kept(query) => CameraQuery::sight(&**query, &state.scene),
        };
        sight.ok_or_else(|| {
            Failure::new(casca_status::CASCA_ERROR_FOREIGN_RESULT, "the query has not run on this scene")
        })
    }

    pub(crate) fn kept(&mut self) -> Result<&mut KeptQuery, Failure> {
        match &mut self.way {
            Way::Kept(query) => Ok(query),
            Way::Fresh(_) => Err(Failure::argument("the query was made without CASCA_KEPT")),
        }
    }
}

fn point_options(options: &casca_query_options) -> Result<PointOptions, Failure> {
    let mut point = match options.preset {
        CASCA_PRESET_BALANCED => PointOptions::balanced(),
        CASCA_PRESET_FAST => PointOptions::fast(),
        CASCA_PRESET_TIGHT => PointOptions::tight(),
        other => return Err(Failure::unknown("casca_query_options.preset", other)),
    };
    if options.pixel_degrees != 0.0 {
        point = point.pixel_degrees(options.pixel_degrees);
    }
    let coherent = options.flags & (CASCA_COHERENT | CASCA_KEPT) != 0;
    Ok(point.coherent(coherent))
}

fn make(options: &casca_query_options) -> Result<Way, Failure> {
    view::check_flags(options.flags, CASCA_COHERENT | CASCA_KEPT, "casca_query_options.flags")?;
    let method = match options.method {
        CASCA_METHOD_POINT => Method::Point(point_options(options)?),
        _ if options.flags != 0 => {
            return Err(Failure::argument("CASCA_COHERENT and CASCA_KEPT need CASCA_METHOD_POINT"));
        }
        CASCA_METHOD_CELL => {
            let resolution = if options.mask_resolution == 0 { 256 } else { options.mask_resolution };
            Method::Cell(CellOptions::new().mask_resolution(resolution))
        }
        CASCA_METHOD_FRUSTUM => Method::Frustum,
        other => return Err(Failure::unknown("casca_query_options.method", other)),
    };
    let Method::Point(point) = method else {
        return Ok(Way::Fresh(Box::new(Query::with_method(method)?)));
    };
    if options.flags & CASCA_KEPT == 0 {
        return Ok(Way::Fresh(Box::new(Query::with_method(method)?)));
    }
    let mut kept = KeptOptions::new();
    if options.reach != 0.0 {
        kept = kept.reach(options.reach);
    }
    if options.turn != 0.0 {
        kept = kept.turn(options.turn);
    }
    let mut query = KeptQuery::with_options(kept)?;
    query.set_point_options(point)?;
    Ok(Way::Kept(Box::new(query)))
}

/// Makes a query; options may be null for the default ones. Keep one for each camera and light, and
/// run it in every frame: the second run takes next to no memory. Free it by casca_query_free.
///
/// Errors: options out of their ranges.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_query_create(
    options: *const casca_query_options,
    query: *mut casca_query,
) -> casca_status {
    give(query, "query", || {
        let way = make(&border::read_or_default(options)?)?;
        Ok(casca_query { handle: QUERIES.add(Camera { way, found: Vec::new() })? })
    })
}

/// Frees a query with its result.
#[unsafe(no_mangle)]
pub extern "C" fn casca_query_free(query: casca_query) -> casca_status {
    call(|| QUERIES.take(query.handle).map(drop))
}

/// Forgets earlier runs, as after a cut of the camera. The last result stays.
#[unsafe(no_mangle)]
pub extern "C" fn casca_query_reset(query: casca_query) -> casca_status {
    call(|| {
        match &mut QUERIES.exclusive(query.handle)?.way {
            Way::Fresh(query) => query.reset(),
            Way::Kept(query) => query.reset(),
        }
        Ok(())
    })
}

/// Finds the objects that a view can see: all of them, and a few more. count, unless null, gets how
/// many; casca_query_get_visible gives their ids.
///
/// Reads the scene and changes the query: any number of threads may run queries of their own on one
/// scene at the same time. Errors: views that are refused; the last result then stays. Costs the
/// cells and objects in sight: tens of microseconds to some milliseconds.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_query_run(
    query: casca_query,
    scene: casca_scene,
    view: *const casca_view,
    count: *mut usize,
) -> casca_status {
    call(|| {
        let out = Out::or_null(count, "count")?;
        let view = view::read(view)?;
        let state = SCENES.shared(scene.handle)?;
        let mut camera = QUERIES.exclusive(query.handle)?;
        let Camera { way, found } = &mut *camera;
        let pvs = match way {
            Way::Fresh(query) => query.run(&state.scene, &view),
            Way::Kept(query) => query.run(&state.scene, &view),
        };
        found.clear();
        found.extend(state.ids(pvs.iter()));
        out.set(found.len());
        Ok(())
    })
}

/// The ids that the last run found, roughly from near to far; after casca_query_shadow_casters the
/// casters. ids has room for capacity; count gets how many there are, also when that is more
/// (CASCA_ERROR_TOO_SMALL). Costs a copy.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_query_get_visible(
    query: casca_query,
    ids: *mut u64,
    capacity: usize,
    count: *mut usize,
) -> casca_status {
    call(|| OutSpan::new(ids, capacity, count, "ids")?.set(&QUERIES.shared(query.handle)?.found))
}

/// Writes whether the last run found an object. Costs a look-up.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_query_contains(
    query: casca_query,
    scene: casca_scene,
    id: u64,
    answer: *mut bool,
) -> casca_status {
    give(answer, "answer", || {
        let (state, camera) = (SCENES.shared(scene.handle)?, QUERIES.shared(query.handle)?);
        Ok(camera.pvs().contains(state.find(id)?))
    })
}

/// Writes whether the last result holds for a view of the scene as it is now: nothing that it
/// depends on changed, and the view sees no more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_query_is_valid(
    query: casca_query,
    scene: casca_scene,
    view: *const casca_view,
    answer: *mut bool,
) -> casca_status {
    give(answer, "answer", || {
        let view = view::read(view)?;
        let (state, camera) = (SCENES.shared(scene.handle)?, QUERIES.shared(query.handle)?);
        Ok(camera.pvs().is_valid_for(&state.scene, &view))
    })
}

/// The work of the last run.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_query_get_stats(query: casca_query, stats: *mut casca_stats) -> casca_status {
    give_struct(stats, || {
        let camera = QUERIES.shared(query.handle)?;
        let (of_run, refreshes) = match &camera.way {
            Way::Fresh(query) => (*query.pvs().stats(), 0),
            Way::Kept(query) => (*query.pvs().stats(), query.refreshes()),
        };
        Ok(casca_stats {
            size: 0,
            objects_tested: of_run.objects_tested.into(),
            occlusion_tests: of_run.occlusion_tests.into(),
            occluders_drawn: of_run.occluders_drawn.into(),
            cells_visited: of_run.cells_visited,
            bricks_visited: of_run.bricks_visited,
            refreshes,
            eye_in_occluder: of_run.eye_in_occluder.into(),
        })
    })
}
