//! What can be seen in the plane: queries, visible regions, and tiles.

use ::casca_plane::glam::Vec2;
use ::casca_plane::{BitGrid, FieldOfView, FovOptions, OpaqueTiles, Query, TilePoint, View};

use crate::border::{self, Out, OutList, OutSpan, give, grows};
use crate::error::{Failure, call, casca_status};
use crate::handle::Registry;
use crate::plane::{PLANES, casca_plane, casca_plane_shape};

pub(crate) static PLANE_QUERIES: Registry<Viewer> = Registry::new(7);

/// The memory of one viewer in the plane, and its last result. {0} is none.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct casca_plane_query {
    /// A number that only casca can read.
    pub handle: u64,
}

/// A view in the plane. Fill it by CASCA_INIT.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct casca_plane_view {
    /// sizeof(casca_plane_view).
    pub size: usize,
    /// The eye in world units.
    pub eye: [f32; 2],
    /// The direction of a sector, of any length.
    pub direction: [f32; 2],
    /// Half the angle of the sector in radians; 0 looks all round.
    pub half_angle: f32,
    /// How far it sees, in world units; 0: no limit.
    pub range: f32,
}

grows!(casca_plane_view: size_of::<casca_plane_view>(),);

/// A query and the ids that it found.
pub(crate) struct Viewer {
    pub(crate) query: Query,
    found: Vec<u64>,
}

/// Makes a query in the plane, exact from its eye. Free it by casca_plane_query_free.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_plane_query_create(query: *mut casca_plane_query) -> casca_status {
    give(query, "query", || {
        let viewer = Viewer { query: Query::new(), found: Vec::new() };
        Ok(casca_plane_query { handle: PLANE_QUERIES.add(viewer)? })
    })
}

/// Frees a query in the plane.
#[unsafe(no_mangle)]
pub extern "C" fn casca_plane_query_free(query: casca_plane_query) -> casca_status {
    call(|| PLANE_QUERIES.take(query.handle).map(drop))
}

/// Finds the objects that a view sees, exactly. count, unless null, gets how many.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_plane_query_run(
    query: casca_plane_query,
    plane: casca_plane,
    view: *const casca_plane_view,
    count: *mut usize,
) -> casca_status {
    call(|| {
        let out = Out::or_null(count, "count")?;
        let view = border::read(view)?;
        let [eye, direction] = [view.eye, view.direction].map(Vec2::from_array);
        let mut seen = match view.half_angle {
            0.0 => View::all_round(eye)?,
            half_angle => View::sector(eye, direction, half_angle)?,
        };
        if view.range != 0.0 {
            seen = seen.with_range(view.range)?;
        }
        let state = PLANES.shared(plane.handle)?;
        let mut viewer = PLANE_QUERIES.exclusive(query.handle)?;
        let Viewer { query, found } = &mut *viewer;
        found.clear();
        found.extend(query.run(&state.scene, &seen).iter().filter_map(|object| state.id(object)));
        out.set(found.len());
        Ok(())
    })
}

/// The ids that the last run found, as casca_query_get_visible.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_plane_query_get_visible(
    query: casca_plane_query,
    ids: *mut u64,
    capacity: usize,
    count: *mut usize,
) -> casca_status {
    call(|| OutSpan::new(ids, capacity, count, "ids")?.set(&PLANE_QUERIES.shared(query.handle)?.found))
}

/// Whether the view of the last run sees each of count points of two floats: answers gets 1 or 0
/// for each. Before the first run, and for points that are not finite, 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_plane_query_sees_points(
    query: casca_plane_query,
    points: *const f32,
    count: usize,
    answers: *mut u8,
) -> casca_status {
    call(|| {
        let out = OutList::new(answers, count, "answers")?;
        let points = border::span(points.cast::<[f32; 2]>(), count, "points")?;
        let viewer = PLANE_QUERIES.shared(query.handle)?;
        out.set(points.iter().map(|&p| viewer.query.sees_point(Vec2::from_array(p)).into()));
        Ok(())
    })
}

/// Writes whether the view of the last run sees any point of a shape.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_plane_query_sees_shape(
    query: casca_plane_query,
    shape: *const casca_plane_shape,
    answer: *mut bool,
) -> casca_status {
    give(answer, "answer", || {
        let shape = border::array(shape, "shape")?.get()?;
        let shape = shape.ok_or_else(|| Failure::argument("the shape must not be of the kind 0"))?;
        Ok(PLANE_QUERIES.shared(query.handle)?.query.sees(shape)?)
    })
}

/// The visible region of the last run as a polygon, counterclockwise: two floats for each corner.
/// corners has room for capacity corners; count gets how many there are, also when that is more
/// (CASCA_ERROR_TOO_SMALL).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_plane_query_get_polygon(
    query: casca_plane_query,
    corners: *mut f32,
    capacity: usize,
    count: *mut usize,
) -> casca_status {
    call(|| {
        let out = OutSpan::new(corners.cast::<[f32; 2]>(), capacity, count, "corners")?;
        let polygon = PLANE_QUERIES.shared(query.handle)?.query.polygon();
        out.set(&polygon.into_iter().map(|p| p.to_array()).collect::<Vec<_>>())
    })
}

/// The most tiles of a map along one side.
const MOST_TILES: u32 = 1 << 14;

/// The tiles of a map that an eye sees, exactly. opaque has width * height bytes, row by row, of
/// which those that are not 0 stop sight; seen has as many and gets 1 for each tile in sight, else
/// 0. The eye is in tiles: the middle of the first is 0.5, 0.5. radius is in tiles; 0: no limit.
///
/// Errors: more than 16384 tiles along a side, an eye that is not finite. Costs a look at all tiles
/// of the map, and microseconds for those in sight.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_plane_field_of_view(
    opaque: *const u8,
    width: u32,
    height: u32,
    eye_x: f64,
    eye_y: f64,
    radius: f32,
    seen: *mut u8,
) -> casca_status {
    call(|| {
        if width > MOST_TILES || height > MOST_TILES {
            let why = format!("a map may have 16384 tiles along a side, not {width} by {height}");
            return Err(Failure::argument(why));
        }
        let count = width as usize * height as usize;
        let out = OutList::new(seen, count, "seen")?;
        let opaque = border::span(opaque, count, "opaque")?;
        let eye = TilePoint::new(eye_x, eye_y)?;
        let mut options = FovOptions::default();
        if radius != 0.0 {
            options = options.in_circle(radius)?;
        }
        let mut walls = BitGrid::new(width, height);
        let tiles = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        for ((x, y), _) in tiles().zip(opaque).filter(|(_, tile)| **tile != 0) {
            walls.set(x, y, true);
        }
        let mut fov = FieldOfView::new();
        let found = fov.run(&OpaqueTiles::new(walls), eye, &options);
        out.set(tiles().map(|(x, y)| found.get(x, y).into()));
        Ok(())
    })
}
