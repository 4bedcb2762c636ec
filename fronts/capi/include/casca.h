/*
casca, visibility culling for dynamic 3D scenes: every frame, which objects can be seen. An object
that can be seen is never left out. This header is the manual of its C face; README.md has figures.

A FIRST QUERY

    #include <casca.h>
    #include <stdio.h>

    int main(void) {
        casca_grid grid = CASCA_INIT(casca_grid);
        grid.cell = 1.0f;
        casca_scene scene;
        casca_query query;
        if (casca_scene_create(&grid, &scene) || casca_query_create(NULL, &query)) goto failed;

        // A wall hides; a ball is tested.
        casca_object wall = CASCA_INIT(casca_object), ball = CASCA_INIT(casca_object);
        wall.bounds.kind = CASCA_SHAPE_BOX;
        wall.bounds.min[2] = 30.0f;
        wall.bounds.max[0] = 64.0f, wall.bounds.max[1] = 16.0f, wall.bounds.max[2] = 33.0f;
        wall.occluder = wall.bounds;
        ball.bounds.kind = CASCA_SHAPE_SPHERE, ball.bounds.radius = 0.5f;
        ball.bounds.center[0] = 32.0f, ball.bounds.center[1] = 4.0f, ball.bounds.center[2] = 10.0f;
        uint64_t wall_id, ball_id;
        if (casca_scene_add(scene, &wall, &wall_id) || casca_scene_add(scene, &ball, &ball_id)) goto failed;

        casca_view view = CASCA_INIT(casca_view);
        view.kind = CASCA_VIEW_OMNIDIRECTIONAL;
        view.eye[0] = 32.5f, view.eye[1] = 2.5f, view.eye[2] = 60.5f;
        uint64_t visible[16];
        size_t count;
        if (casca_query_run(query, scene, &view, NULL)) goto failed;
        if (casca_query_get_visible(query, visible, 16, &count)) goto failed;
        printf("%zu object in sight, and it is the wall: %d\n", count, visible[0] == wall_id);
        casca_query_free(query);
        casca_scene_free(scene);
        return 0;
    failed:
        fprintf(stderr, "%s\n", casca_last_error());
        return 1;
    }

CONVENTIONS

Units are those of your world, in floats; any axis may be up. Angles are in radians but where a name
says degrees. Matrices are 16 floats, column by column unless CASCA_ROW_MAJOR says otherwise, and
take columns: clip = matrix * point. Depth runs from 0 to 1, unless CASCA_DEPTH_MINUS_ONE says from
-1 to 1; it may be reversed, and the far plane may be infinite.

Structs that may grow start with their size: declare them by CASCA_INIT, which sets it and makes all
other fields 0, and 0 is the default of each field. So programs run with newer libraries as they
are; a program that sets a field which an older library does not know is refused, not misread.

ERRORS

Functions return a casca_status, 0 for success, and write results through pointers. A call that is
refused changes nothing, unless its comment says otherwise, and casca_last_error tells this thread
which argument it was and why. Null pointers, misaligned ones, sizes that cannot be, numbers that
are not finite, ids of other scenes or of removed objects, and handles that were freed, never given
out, or are of another kind are errors, and never undefined behaviour. Panics of the library, which
would be bugs, end as CASCA_ERROR_PANIC. What no library can see remains yours: a pointer that is
neither null nor misaligned must lead to as much memory as the function's comment says. Memory that
runs out ends the process.

SPANS

Where a pointer comes with a count, it leads to as many elements, and may be null if count is 0.
Spans for results have a capacity, and a pointer that gets the number of results. If there are more
than the capacity, the status is CASCA_ERROR_TOO_SMALL, the number is written, and nothing else: ask
once with capacity 0, or begin with enough room. Spans for results must not overlap others. casca
keeps no pointer of yours after a call, and gives none of its own but those of constant and error
texts.

OWNERSHIP

Handles are numbers, not pointers: copy them freely, free each once. A handle that was freed is
never given again, and refused by every call. Objects keep the meshes and solids that they consist
of, so these handles may be freed at any time. All handles belong to the process.

THREADS

Any function may be called from any thread. Calls that read a handle run side by side: any number of
threads may query one scene at the same time, each with a query of its own. A call that changes a
handle (it says so: add, set, move, run for its query, begin_frame, end_frame, free) must be alone
with that handle; if another thread uses it at the same moment, the call is refused as
CASCA_ERROR_BUSY and changes nothing. No call waits for another, so none can deadlock. Edit a scene
between its queries, or hold a lock of your own.

A FRAME

casca_scene_begin_frame; moves, additions and removals; casca_query_run for each camera, on as many
threads as you like; casca_query_shadow_casters for lights; casca_scene_end_frame with the queries.
*/

#ifndef CASCA_H
#define CASCA_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A struct with its size set and all else 0: casca_view view = CASCA_INIT(casca_view); */
#ifdef __cplusplus
template <typename T> inline T casca_init_of() {
    T value{};
    value.size = sizeof(T);
    return value;
}
#define CASCA_INIT(type) casca_init_of<type>()
#else
#define CASCA_INIT(type) {.size = sizeof(type)}
#endif

/// The version of this header: 10000 * major + 100 * minor + patch.
#define CASCA_VERSION 100

/// casca_view.kind: a perspective camera whose eye is known. Give matrix and eye.
#define CASCA_VIEW_PERSPECTIVE 0

/// casca_view.kind: an orthographic camera. Give matrix and forward.
#define CASCA_VIEW_ORTHOGRAPHIC 1

/// casca_view.kind: a camera of which only the matrix is known. Sets are larger: give the eye where
/// you have it.
#define CASCA_VIEW_MATRIX 2

/// casca_view.kind: all directions around an eye. Give eye.
#define CASCA_VIEW_OMNIDIRECTIONAL 3

/// casca_view.kind: what lies inside some half-spaces around an eye. Give eye and planes.
#define CASCA_VIEW_PLANES 4

/// casca_view.kind: all directions, for each eye in a box. Give eye, the least corner, and
/// cell_max, the greatest one.
#define CASCA_VIEW_CELL 5

/// A flag of matrices: their 16 numbers are stored row by row; without it column by column, as in
/// OpenGL, Vulkan, glm, Godot and Unity. Vectors are columns in any case: clip = matrix * point.
/// Libraries that multiply rows by matrices (point * matrix) and store them row by row, as
/// DirectXMath and Unreal do, have the same numbers in the same places: leave the flag out.
#define CASCA_ROW_MAJOR 1

/// A flag of view matrices: depth runs from -1 to 1, as in OpenGL. Without it from 0 to 1, as in
/// Vulkan, Direct3D, Metal and WebGPU. Reversed depth and infinite far planes need no flag.
#define CASCA_DEPTH_MINUS_ONE 2

/// casca_mesh_desc.flags: triangles hide from the side where their corners run counter-clockwise
/// only, as for renderers that leave out triangles seen from behind.
#define CASCA_MESH_FRONT_ONLY 1

/// casca_mesh_desc.flags: the mesh is tested and hides nothing. It is prepared faster.
#define CASCA_MESH_BOUNDS_ONLY 2

/// casca_mesh_desc.flags: the field tolerance is set.
#define CASCA_MESH_TOLERANCE 4

/// casca_mesh_desc.flags: the field min_radius is set.
#define CASCA_MESH_MIN_RADIUS 8

/// casca_shape.kind: no shape. An object without an occluder hides nothing.
#define CASCA_SHAPE_NONE 0

/// casca_shape.kind: a solid sphere. Give center and radius.
#define CASCA_SHAPE_SPHERE 1

/// casca_shape.kind: a solid box along the axes. Give min and max.
#define CASCA_SHAPE_BOX 2

/// casca_shape.kind: a solid box turned by a rotation. Give center, half and rotation.
#define CASCA_SHAPE_TURNED_BOX 3

/// casca_shape.kind: a solid convex body, as occluder only. Give solid.
#define CASCA_SHAPE_SOLID 4

/// casca_shape.kind: the triangles of a mesh. Give mesh.
#define CASCA_SHAPE_MESH 5

/// casca_object.flags: the object moves.
#define CASCA_MOVES 2

/// casca_object.flags: the object moves and keeps to max_speed.
#define CASCA_HAS_MAX_SPEED 4

/// casca_object.flags: the object's motion is reported only where casca_scene_begin_frame asks for
/// it, and while it is seen. Needs CASCA_HAS_MAX_SPEED.
#define CASCA_REPORTED_ON_EXPIRY 8

/// casca_object.flags: the shapes are in the object's own space, and transform leads to the world.
/// casca_scene_set_transform moves such an object.
#define CASCA_PLACED 16

/// casca_query_options.method: the objects that the eye can see, at pixel precision.
#define CASCA_METHOD_POINT 0

/// casca_query_options.method: the objects that can be seen from anywhere in the eye's grid cell.
#define CASCA_METHOD_CELL 1

/// casca_query_options.method: the objects in the view, hidden or not.
#define CASCA_METHOD_FRUSTUM 2

/// casca_query_options.preset: the default, between the other two.
#define CASCA_PRESET_BALANCED 0

/// casca_query_options.preset: the least time, and the largest sets.
#define CASCA_PRESET_FAST 1

/// casca_query_options.preset: the smallest sets, and the most time.
#define CASCA_PRESET_TIGHT 2

/// casca_query_options.flags: begin with the occluders of the last run. For cameras that move
/// little: 45 to 85 percent of the time, sets up to 12 percent larger.
#define CASCA_COHERENT 1

/// casca_query_options.flags: answer many frames from one result about static objects, while the
/// camera stays within reach and turn.
#define CASCA_KEPT 2

/// casca_light.kind: infinitely far away, such as the sun. Give direction.
#define CASCA_LIGHT_DIRECTIONAL 0

/// casca_light.kind: shines from a point in all directions. Give position and range.
#define CASCA_LIGHT_POINT 1

/// casca_light.kind: shines from the eye of a view on all that lies inside: the camera of a shadow
/// map. Give view.
#define CASCA_LIGHT_SPOT 2

/// casca_plane_shape.kind: no shape.
#define CASCA_PLANE_NONE 0

/// casca_plane_shape.kind: a disc around a with a radius.
#define CASCA_PLANE_DISC 1

/// casca_plane_shape.kind: a rectangle along the axes, from its least corner a to its greatest b.
#define CASCA_PLANE_RECT 2

/// casca_plane_shape.kind: a wall without thickness from a to b.
#define CASCA_PLANE_SEGMENT 3

/// casca_plane_shape.kind: the convex hull of points.
#define CASCA_PLANE_POLYGON 4

/// casca_plane_shape.kind: walls without thickness from point to point.
#define CASCA_PLANE_POLYLINE 5

/// What a call came to. All functions return it, but for those that cannot fail.
///
/// The numbers are stable. Newer versions may return numbers that this header does not list: treat
/// them as errors.
typedef enum {
    /// All went well.
    CASCA_OK = 0,
    /// A pointer is null that must not be.
    CASCA_ERROR_NULL_POINTER = 1,
    /// A span is misaligned, or longer than memory can be.
    CASCA_ERROR_BAD_SPAN = 2,
    /// The size field of a struct is wrong, or it has fields that only a newer version knows.
    CASCA_ERROR_BAD_STRUCT = 3,
    /// The handle was never given out; 0 is such a handle.
    CASCA_ERROR_INVALID_HANDLE = 4,
    /// The handle was freed. It never comes back.
    CASCA_ERROR_STALE_HANDLE = 5,
    /// The handle is of another kind: a mesh where a scene is needed.
    CASCA_ERROR_WRONG_KIND = 6,
    /// Another thread uses the handle at this moment in a way that shuts this call out, or the call
    /// was given one handle for two parts.
    CASCA_ERROR_BUSY = 7,
    /// The span for results is too small. The call wrote how many there are.
    CASCA_ERROR_TOO_SMALL = 8,
    /// The id names no object of this scene: it was removed, or belongs to another scene.
    CASCA_ERROR_UNKNOWN_OBJECT = 9,
    /// An argument is out of its range or contradicts another one.
    CASCA_ERROR_INVALID_ARGUMENT = 10,
    /// A result of one scene was given to another scene, or to a query that never ran.
    CASCA_ERROR_FOREIGN_RESULT = 11,
    /// The bytes are no prepared mesh, or are damaged.
    CASCA_ERROR_DAMAGED = 12,
    /// There is no room for more handles or objects.
    CASCA_ERROR_FULL = 13,
    /// The caller ended a preparation.
    CASCA_ERROR_CANCELLED = 14,
    /// A bug in casca. The handles that the call changed answer no more calls; free them.
    CASCA_ERROR_PANIC = 15,
} casca_status;

/// Told the share of a preparation that is done, from 0 to 1, on the thread that called. Returning
/// anything but 0 ends the preparation soon. It must return: no longjmp and no exception may leave
/// it, and it may call casca only for other handles.
typedef int32_t (*casca_progress)(float share, void *user);

/// Triangles to prepare. Fill it by CASCA_INIT, then set positions and indices.
typedef struct {
    /// sizeof(casca_mesh_desc).
    size_t size;
    /// The first position: three floats x, y, z. Read during the call only.
    const float *positions;
    /// How many positions there are.
    size_t position_count;
    /// Bytes from one position to the next, a multiple of 4; 0 for 12, which is without gaps.
    size_t position_stride;
    /// Three indices of positions for each triangle. Read during the call only.
    const uint32_t *indices;
    /// How many indices there are: a multiple of 3, up to 3 * 2^29.
    size_t index_count;
    /// 0, or some of CASCA_MESH_...
    uint32_t flags;
    /// With CASCA_MESH_TOLERANCE, how far outlines may be simplified, in world units; else a 2000th
    /// of the diagonal. More is faster and hides less near outlines.
    float tolerance;
    /// With CASCA_MESH_MIN_RADIUS, connected groups of triangles of a smaller radius hide nothing;
    /// else a 1000th of the diagonal.
    float min_radius;
    /// Told of the progress, or null.
    casca_progress progress;
    /// Passed on to progress.
    void *user;
} casca_mesh_desc;

/// A prepared mesh, shared by any number of objects of any scenes. {0} is none.
typedef struct {
    /// A number that only casca can read.
    uint64_t handle;
} casca_mesh;

/// What is known of a prepared mesh. Fill it by CASCA_INIT.
typedef struct {
    /// sizeof(casca_mesh_info).
    size_t size;
    /// How many triangles it has.
    size_t triangles;
    /// How many positions it has.
    size_t positions;
    /// The bytes that it takes on the heap.
    size_t bytes;
    /// 1 if every edge belongs to two triangles, so that it has an inside; else 0.
    uint32_t is_closed;
    /// 1 if it can hide others; else 0.
    uint32_t occludes;
    /// The least corner of the box around its triangles.
    float min[3];
    /// The greatest corner of that box.
    float max[3];
} casca_mesh_info;

/// A convex body, shared by any number of objects of any scenes. {0} is none.
typedef struct {
    /// A number that only casca can read.
    uint64_t handle;
} casca_solid;

/// The grid of a scene. It has no border. Fill it by CASCA_INIT, then set cell, or min, max and
/// objects.
typedef struct {
    /// sizeof(casca_grid).
    size_t size;
    /// If cell is 0: the least corner of the region where most objects are, in world units.
    float min[3];
    /// If cell is 0: the greatest corner of it.
    float max[3];
    /// The edge of a cell in world units; 0 lets casca choose.
    float cell;
    /// If cell is 0: about how many objects there will be.
    uint32_t objects;
} casca_grid;

/// Objects on a grid. {0} is none.
typedef struct {
    /// A number that only casca can read.
    uint64_t handle;
} casca_scene;

/// A shape, in world units; of a placed object, in the units of the object's own space.
///
/// Fields that the kind does not ask for are not read.
typedef struct {
    /// One of CASCA_SHAPE_...
    uint32_t kind;
    /// The radius of a sphere, not negative.
    float radius;
    /// The middle of a sphere or of a turned box.
    float center[3];
    /// The least corner of a box.
    float min[3];
    /// The greatest corner of a box.
    float max[3];
    /// Half the edges of a turned box, not negative.
    float half[3];
    /// The rotation of a turned box: a quaternion x, y, z, w of any length but 0.
    float rotation[4];
    /// The convex body.
    casca_solid solid;
    /// The mesh. The object keeps it: the handle may be freed at any time.
    casca_mesh mesh;
} casca_shape;

/// An object to add to a scene. Fill it by CASCA_INIT, then set bounds and what else you need.
typedef struct {
    /// sizeof(casca_object).
    size_t size;
    /// 0, or some of CASCA_MOVES, CASCA_HAS_MAX_SPEED, CASCA_REPORTED_ON_EXPIRY, CASCA_PLACED and
    /// CASCA_ROW_MAJOR.
    uint32_t flags;
    /// With CASCA_HAS_MAX_SPEED, the greatest speed of any point, in world units per second.
    float max_speed;
    /// Shown by the views that have a layer in common, a bit for each. 0 is all layers.
    uint64_t layers;
    /// A number of yours: an index into your tables, or a pointer. casca does nothing with it.
    uint64_t user_data;
    /// What is tested for visibility. All that you draw of the object must lie inside.
    casca_shape bounds;
    /// What hides other objects: it must lie inside the solid parts that you draw.
    casca_shape occluder;
    /// With CASCA_PLACED, the transform: 16 numbers, column by column unless CASCA_ROW_MAJOR is
    /// set. The last row is 0 0 0 1.
    float transform[16];
} casca_object;

/// The memory that a scene takes, in bytes. Fill it by CASCA_INIT.
typedef struct {
    /// sizeof(casca_memory).
    size_t size;
    /// Opaque cells.
    size_t opacity;
    /// The objects of each cell.
    size_t ids;
    /// Temporal bounding volumes.
    size_t volumes;
    /// Objects and lists of them.
    size_t objects;
    /// Meshes and convex bodies. One that several objects share counts once.
    size_t shapes;
    /// All of them together.
    size_t total;
} casca_memory;

/// How a query works. Fill it by CASCA_INIT; 0 is the default of each field. No option can hide
/// what can be seen: they trade time for the number of hidden objects in sets.
typedef struct {
    /// sizeof(casca_query_options).
    size_t size;
    /// One of CASCA_METHOD_...
    uint32_t method;
    /// One of CASCA_PRESET_..., for CASCA_METHOD_POINT.
    uint32_t preset;
    /// 0, or some of CASCA_COHERENT and CASCA_KEPT. Both need CASCA_METHOD_POINT.
    uint32_t flags;
    /// The width of a pixel of the occlusion buffers, in degrees from 0.03 to 11.25; 0: 0.25.
    float pixel_degrees;
    /// Of CASCA_METHOD_CELL: directions along each side, a power of two from 64 to 4096; 0: 256.
    uint32_t mask_resolution;
    /// With CASCA_KEPT, how far the eye may go, in world units; 0: 0.1.
    float reach;
    /// With CASCA_KEPT, by how much the camera may turn, in radians; 0: 0.15.
    float turn;
} casca_query_options;

/// The memory of one camera or light, and its last result. {0} is none.
typedef struct {
    /// A number that only casca can read.
    uint64_t handle;
} casca_query;

/// What can be looked at, and from where. Fill it by CASCA_INIT, then set the kind and its fields.
///
/// Units are those of the world. A view is copied by the call that takes it, and can be used again.
typedef struct {
    /// sizeof(casca_view).
    size_t size;
    /// One of CASCA_VIEW_...; 0 is CASCA_VIEW_PERSPECTIVE.
    uint32_t kind;
    /// 0, or some of CASCA_ROW_MAJOR and CASCA_DEPTH_MINUS_ONE.
    uint32_t flags;
    /// From world space to clip space: projection * view. It must be the matrix that you draw with.
    float matrix[16];
    /// The eye in world units. It must be the one of the matrix, not that of an earlier frame: the
    /// call is refused if the two differ by more than rounding (code "eye-mismatch").
    float eye[3];
    /// Of an orthographic camera, the direction in which it looks, of any length.
    float forward[3];
    /// Of CASCA_VIEW_CELL, the greatest corner of the box of eyes.
    float cell_max[3];
    /// How far the eye may go from its place, in world units: the result holds for all eyes there.
    /// 0 for CASCA_VIEW_CELL.
    float reach;
    /// By how much the camera may turn, in radians: the result holds for all such cameras.
    float turn;
    /// Of CASCA_VIEW_PLANES, plane_count planes of four numbers x, y, z, w: inside is where
    /// x * px + y * py + z * pz + w >= 0. They are read during the call only.
    const float *planes;
    /// How many planes there are, up to 32.
    size_t plane_count;
    /// The layers that are shown, a bit for each. 0 shows all.
    uint64_t layers;
} casca_view;

/// The work of the last run. Fill it by CASCA_INIT.
typedef struct {
    /// sizeof(casca_stats).
    size_t size;
    /// Objects compared with the frustum.
    uint64_t objects_tested;
    /// Comparisons of objects with the occlusion buffers.
    uint64_t occlusion_tests;
    /// Occluders drawn.
    uint64_t occluders_drawn;
    /// Cells visited, by CASCA_METHOD_CELL.
    uint64_t cells_visited;
    /// Bricks of 8x8x8 cells visited, by CASCA_METHOD_POINT.
    uint64_t bricks_visited;
    /// Of a kept query, how many runs found a new result since it was made.
    uint64_t refreshes;
    /// 1 if the eye was inside an occluder, or the near plane cut into one; else 0.
    uint32_t eye_in_occluder;
} casca_stats;

/// What casca_scene_end_frame did. Fill it by CASCA_INIT.
typedef struct {
    /// sizeof(casca_frame_report).
    size_t size;
    /// Objects that nobody saw and that were put into temporal bounding volumes.
    size_t hidden;
    /// Volumes that were seen.
    size_t revealed;
} casca_frame_report;

/// A light that casts shadows. Fill it by CASCA_INIT.
typedef struct {
    /// sizeof(casca_light).
    size_t size;
    /// One of CASCA_LIGHT_...
    uint32_t kind;
    /// Of CASCA_LIGHT_POINT: it lights nothing farther away, in world units. 0: no limit.
    float range;
    /// The direction in which light travels, of any length.
    float direction[3];
    /// The place of the lamp in world units.
    float position[3];
    /// The layers of the objects that cast its shadows, a bit for each. 0: those of the view, or
    /// all.
    uint64_t layers;
    /// Of CASCA_LIGHT_SPOT: the view, read during the call only.
    const casca_view *view;
} casca_light;

/// The work of finding a new result for a kept query, on any thread. {0} is none.
typedef struct {
    /// A number that only casca can read.
    uint64_t handle;
} casca_job;

/// The grid of a scene in the plane. Fill it by CASCA_INIT.
typedef struct {
    /// sizeof(casca_plane_grid).
    size_t size;
    /// The least corner of the region where most objects are, in world units.
    float min[2];
    /// The greatest corner of it.
    float max[2];
    /// The edge of a cell in world units.
    float cell;
} casca_plane_grid;

/// Objects in the plane. {0} is none.
typedef struct {
    /// A number that only casca can read.
    uint64_t handle;
} casca_plane;

/// A shape in the plane, in world units.
typedef struct {
    /// One of CASCA_PLANE_...
    uint32_t kind;
    /// Of a disc.
    float radius;
    /// The middle of a disc, the least corner of a rectangle, or the start of a segment.
    float a[2];
    /// The greatest corner of a rectangle, or the end of a segment.
    float b[2];
    /// Of polygons and polylines: two floats for each point. Read during the call only.
    const float *points;
    /// How many points there are.
    size_t point_count;
} casca_plane_shape;

/// An object in the plane. Fill it by CASCA_INIT.
typedef struct {
    /// sizeof(casca_plane_object).
    size_t size;
    /// A number of yours.
    uint64_t user_data;
    /// What is tested for visibility.
    casca_plane_shape bounds;
    /// What hides other objects: it must lie inside the bounds.
    casca_plane_shape occluder;
} casca_plane_object;

/// The memory of one viewer in the plane, and its last result. {0} is none.
typedef struct {
    /// A number that only casca can read.
    uint64_t handle;
} casca_plane_query;

/// A view in the plane. Fill it by CASCA_INIT.
typedef struct {
    /// sizeof(casca_plane_view).
    size_t size;
    /// The eye in world units.
    float eye[2];
    /// The direction of a sector, of any length.
    float direction[2];
    /// Half the angle of the sector in radians; 0 looks all round.
    float half_angle;
    /// How far it sees, in world units; 0: no limit.
    float range;
} casca_plane_view;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/// The version of the library that the program runs with, as CASCA_VERSION. Costs nothing.
uint32_t casca_version(void);

/// The message of the last call that failed on this thread; empty before one failed.
///
/// It says which argument was refused and why. It stays until the next call fails on this thread;
/// copy it to keep it longer. Never null; do not free it. Costs a look-up.
const char *casca_last_error(void);

/// A short, stable name of the last failure on this thread in kebab-case, such as "eye-mismatch",
/// where the library has one; else empty.
///
/// It lives as long as that of casca_last_error. Never null; do not free it.
const char *casca_last_error_code(void);

/// The name of a status, such as "CASCA_ERROR_BUSY"; of any other number "unknown status".
///
/// It lives for ever. Never null.
const char *casca_status_name(int32_t status);

/// Prepares triangles, open or closed, of any winding. The mesh serves as bounds and occluder of
/// any number of objects.
///
/// Errors: an empty mesh, indices of positions that are not there, numbers that are not finite;
/// CASCA_ERROR_CANCELLED if progress ended it. Costs 0.2 to 4 microseconds a triangle.
casca_status casca_mesh_create(const casca_mesh_desc *desc, casca_mesh *mesh);

/// Frees a mesh. Objects that consist of it keep it until they go.
casca_status casca_mesh_free(casca_mesh mesh);

/// What is known of a mesh. Costs a few sums.
casca_status casca_mesh_get_info(casca_mesh mesh, casca_mesh_info *info);

/// Writes a prepared mesh as bytes for a file, to be loaded by this version of casca.
///
/// bytes has room for capacity bytes; count gets the number that is needed. Call it with capacity 0
/// first (bytes may be null then, the status is CASCA_ERROR_TOO_SMALL), or give enough.
casca_status casca_mesh_save(casca_mesh mesh, uint8_t *bytes, size_t capacity, size_t *count);

/// Loads a mesh from count bytes that casca_mesh_save wrote. Any bytes may be given: those that no
/// prepared mesh can have are refused as CASCA_ERROR_DAMAGED. A file made by hand could hide what
/// its triangles do not hide: prepare meshes of unknown origin yourself.
///
/// Costs a copy and a checksum: far less than preparing it.
casca_status casca_mesh_load(const uint8_t *bytes, size_t count, casca_mesh *mesh);

/// A convex body inside the hull of count points of three floats, 4 to 64. Errors: points that are
/// not finite, or whose hull has no volume. Costs about count * count steps.
casca_status casca_solid_create(const float *points, size_t count, casca_solid *solid);

/// Frees a convex body. Objects that it hides with keep it until they go.
casca_status casca_solid_free(casca_solid solid);

/// Makes an empty scene on a grid. Free it by casca_scene_free.
///
/// Errors: cells that are not positive; where casca chooses them, a region that is inverted, not
/// finite or a point.
casca_status casca_scene_create(const casca_grid *grid, casca_scene *scene);

/// Frees a scene with its objects. Its handle and ids are refused from then on, and never given
/// again. Queries that ran on it stay.
casca_status casca_scene_free(casca_scene scene);

/// Adds an object and writes its id, which is never 0 and never given again.
///
/// Errors: shapes that are not finite or inverted, occluders that stick out of their bounds (code
/// "occluder-outside"), a speed of an object that does not move. Costs the cells around its
/// surfaces.
casca_status casca_scene_add(casca_scene scene, const casca_object *object, uint64_t *id);

/// Takes the memory for more objects now, before many are added.
casca_status casca_scene_reserve(casca_scene scene, size_t count);

/// Removes an object. Costs the cells that it touches.
casca_status casca_scene_remove(casca_scene scene, uint64_t id);

/// Removes all objects. The scene stays.
casca_status casca_scene_clear(casca_scene scene);

/// Gives an object other bounds and another occluder, null for none that it had: all of it, in
/// world units. This is the report of an object that is reported on expiry.
///
/// Errors: as casca_scene_add, and a missing occluder of an object that has one (code
/// "occluder-missing"). Costs a comparison while a hidden object stays in its volume; else the
/// cells that it enters and leaves.
casca_status casca_scene_update(casca_scene scene,
                                uint64_t id,
                                const casca_shape *bounds,
                                const casca_shape *occluder);

/// Gives an object other bounds; its occluder stays. Those of a placed object are in its own space:
/// for skinned meshes, the box of the pose.
casca_status casca_scene_set_bounds(casca_scene scene, uint64_t id, const casca_shape *bounds);

/// Gives an object another occluder in world units, or takes it away, if null. A placed object is
/// not placed any more.
casca_status casca_scene_set_occluder(casca_scene scene, uint64_t id, const casca_shape *occluder);

/// Puts an object on other layers, a bit for each. Here 0 is no layer: no view shows it.
casca_status casca_scene_set_layers(casca_scene scene, uint64_t id, uint64_t layers);

/// The layers of an object.
casca_status casca_scene_get_layers(casca_scene scene, uint64_t id, uint64_t *layers);

/// Gives an object another number of yours.
casca_status casca_scene_set_user_data(casca_scene scene, uint64_t id, uint64_t user_data);

/// Your numbers of count objects, in the order of their ids. Refused as a whole, with nothing
/// written, if one of them is no object of the scene. Costs a look-up for each.
casca_status casca_scene_get_user_data(casca_scene scene,
                                       const uint64_t *ids,
                                       size_t count,
                                       uint64_t *user_data);

/// Writes whether an id names an object of this scene. Costs a look-up.
casca_status casca_scene_contains(casca_scene scene, uint64_t id, bool *answer);

/// The box around the bounds of an object in world units, rounded outwards: three floats each.
/// Infinite where it ends beyond the range of a float.
casca_status casca_scene_get_box(casca_scene scene, uint64_t id, float *min, float *max);

/// The ids of all objects, in no promised order. ids has room for capacity; count gets how many
/// there are, also when that is more (CASCA_ERROR_TOO_SMALL).
casca_status casca_scene_get_ids(casca_scene scene, uint64_t *ids, size_t capacity, size_t *count);

/// The memory that a scene takes. Costs a walk over all objects.
casca_status casca_scene_get_memory(casca_scene scene, casca_memory *memory);

/// Makes a query; options may be null for the default ones. Keep one for each camera and light, and
/// run it in every frame: the second run takes next to no memory. Free it by casca_query_free.
///
/// Errors: options out of their ranges.
casca_status casca_query_create(const casca_query_options *options, casca_query *query);

/// Frees a query with its result.
casca_status casca_query_free(casca_query query);

/// Forgets earlier runs, as after a cut of the camera. The last result stays.
casca_status casca_query_reset(casca_query query);

/// Finds the objects that a view can see: all of them, and a few more. count, unless null, gets how
/// many; casca_query_get_visible gives their ids.
///
/// Reads the scene and changes the query: any number of threads may run queries of their own on one
/// scene at the same time. Errors: views that are refused; the last result then stays. Costs the
/// cells and objects in sight: tens of microseconds to some milliseconds.
casca_status casca_query_run(casca_query query,
                             casca_scene scene,
                             const casca_view *view,
                             size_t *count);

/// The ids that the last run found, roughly from near to far; after casca_query_shadow_casters the
/// casters. ids has room for capacity; count gets how many there are, also when that is more
/// (CASCA_ERROR_TOO_SMALL). Costs a copy.
casca_status casca_query_get_visible(casca_query query,
                                     uint64_t *ids,
                                     size_t capacity,
                                     size_t *count);

/// Writes whether the last run found an object. Costs a look-up.
casca_status casca_query_contains(casca_query query, casca_scene scene, uint64_t id, bool *answer);

/// Writes whether the last result holds for a view of the scene as it is now: nothing that it
/// depends on changed, and the view sees no more.
casca_status casca_query_is_valid(casca_query query,
                                  casca_scene scene,
                                  const casca_view *view,
                                  bool *answer);

/// The work of the last run.
casca_status casca_query_get_stats(casca_query query, casca_stats *stats);

/// Moves count objects to spheres: four floats x, y, z, radius for each.
///
/// All moves are made but those that are refused; the status and message are those of the first
/// refusal. For objects without an occluder. Costs 10 to 20 ns for each small object that stays in
/// its zone of 32x32x32 cells or in its volume.
casca_status casca_scene_move_spheres(casca_scene scene,
                                      const uint64_t *ids,
                                      const float *spheres,
                                      size_t count);

/// As casca_scene_move_spheres, to boxes: six floats for each, the least corner and the greatest.
casca_status casca_scene_move_boxes(casca_scene scene,
                                    const uint64_t *ids,
                                    const float *boxes,
                                    size_t count);

/// Moves count placed objects, with their occluders: 16 floats for each, column by column unless
/// flags is CASCA_ROW_MAJOR. As casca_scene_move_spheres, the others are moved where one is
/// refused.
///
/// Errors: objects that are not placed (code "not-placed"), a last row other than 0 0 0 1, numbers
/// that are not finite, spheres whose axes are scaled differently.
casca_status casca_scene_set_transforms(casca_scene scene,
                                        const uint64_t *ids,
                                        const float *transforms,
                                        size_t count,
                                        uint32_t flags);

/// Moves one placed object: casca_scene_set_transforms for one.
casca_status casca_scene_set_transform(casca_scene scene,
                                       uint64_t id,
                                       const float *transform,
                                       uint32_t flags);

/// Moves an object and its occluder by an offset of three floats, in world units. Errors: a mesh in
/// world space (code "fixed-mesh"): give CASCA_PLACED for meshes that move.
casca_status casca_scene_translate(casca_scene scene, uint64_t id, const float *offset);

/// Puts the origin of all coordinates at a place of the world, three doubles. The scene changes the
/// coordinates of its objects; give new ones relative to the new origin. The first origin is zero. For
/// levels far away, and for worlds so large that floats get coarse. Costs all objects.
casca_status casca_scene_set_origin(casca_scene scene,
                                    const double *origin);

/// Begins a frame at a time in seconds. due_count, unless null, gets how many objects reported on
/// expiry are due: read them by casca_scene_get_due and report where they are. Until then they
/// count as visible and hide nothing.
///
/// Errors: a time that is not finite. Costs the objects that are due.
casca_status casca_scene_begin_frame(casca_scene scene, double seconds, size_t *due_count);

/// The objects that were due when the frame began. ids has room for capacity; count gets how many
/// there are, also when that is more (CASCA_ERROR_TOO_SMALL).
casca_status casca_scene_get_due(casca_scene scene, uint64_t *ids, size_t capacity, size_t *count);

/// Ends a frame with the queries of its cameras, and of lights whose casters you draw: moving
/// objects that none of them found get temporal bounding volumes, so that their next moves and
/// queries cost next to nothing. report may be null. A frame that ends without this call loses no
/// object, but costs more.
///
/// Errors: a query that ran last on another scene. Queries that never ran are passed over.
casca_status casca_scene_end_frame(casca_scene scene,
                                   const casca_query *queries,
                                   size_t count,
                                   casca_frame_report *report);

/// Whether the view of the last run may see each of count boxes, which need not be objects: six
/// floats for each, the least corner and the greatest. answers has room for count bytes: 0 is
/// surely hidden, 1 may be seen. A box that is inverted or not finite may be seen.
///
/// Occluders count as long as nothing moved since the run, for CASCA_METHOD_POINT; else only the
/// frustum does. Errors: a query that did not run on this scene. Costs a comparison with the
/// occlusion buffers for each box.
casca_status casca_query_may_see_boxes(casca_query query,
                                       casca_scene scene,
                                       const float *boxes,
                                       size_t count,
                                       uint8_t *answers);

/// As casca_query_may_see_boxes, for count points of three floats.
casca_status casca_query_may_see_points(casca_query query,
                                        casca_scene scene,
                                        const float *points,
                                        size_t count,
                                        uint8_t *answers);

/// Finds the objects whose shadows may fall on what the last run of camera sees. light is another
/// query, without CASCA_KEPT, kept for this light; casca_query_get_visible gives its casters. count
/// may be null.
///
/// Every occluder is taken to cast a shadow. Call it before casca_scene_end_frame. Errors: a camera
/// that did not run on this scene, lights that are not finite or have no direction. Costs a query
/// of the light's view.
casca_status casca_query_shadow_casters(casca_query light,
                                        casca_scene scene,
                                        casca_query camera,
                                        const casca_light *lamp,
                                        size_t *count);

/// Prepares a job that finds a new result for views like this one, ahead of time. Run it on any
/// thread by casca_job_run, and give it to casca_query_install. query needs CASCA_KEPT.
///
/// The job reads a copy of the scene, so that the scene may change meanwhile. Costs that copy the
/// first time, later the static objects that changed.
casca_status casca_query_prepare(casca_query query,
                                 casca_scene scene,
                                 const casca_view *view,
                                 casca_job *job);

/// Runs a job, on the thread that calls. A job that is done stays as it is. Costs a query.
casca_status casca_job_run(casca_job job);

/// Frees a job without using it.
casca_status casca_job_free(casca_job job);

/// Gives the result of a job to the kept query; the job is freed by it. Runs answer from the result
/// as soon as it holds for their view. is_taken, unless null, gets whether it fits: not if more
/// than 2,048 static objects changed since, or if the scene is another one.
///
/// Errors: a job that has not run; it then stays.
casca_status casca_query_install(casca_query query,
                                 casca_scene scene,
                                 casca_job job,
                                 bool *is_taken);

/// Makes an empty scene in the plane. Free it by casca_plane_free.
casca_status casca_plane_create(const casca_plane_grid *grid, casca_plane *plane);

/// Frees a scene in the plane.
casca_status casca_plane_free(casca_plane plane);

/// Adds an object and writes its id, which is never 0 and never given again.
casca_status casca_plane_add(casca_plane plane, const casca_plane_object *object, uint64_t *id);

/// Moves an object or changes its shape; occluder is null for an object that has none.
casca_status casca_plane_update(casca_plane plane,
                                uint64_t id,
                                const casca_plane_shape *bounds,
                                const casca_plane_shape *occluder);

/// Removes an object.
casca_status casca_plane_remove(casca_plane plane, uint64_t id);

/// Your number of an object.
casca_status casca_plane_get_user_data(casca_plane plane, uint64_t id, uint64_t *user_data);

/// Makes a query in the plane, exact from its eye. Free it by casca_plane_query_free.
casca_status casca_plane_query_create(casca_plane_query *query);

/// Frees a query in the plane.
casca_status casca_plane_query_free(casca_plane_query query);

/// Finds the objects that a view sees, exactly. count, unless null, gets how many.
casca_status casca_plane_query_run(casca_plane_query query,
                                   casca_plane plane,
                                   const casca_plane_view *view,
                                   size_t *count);

/// The ids that the last run found, as casca_query_get_visible.
casca_status casca_plane_query_get_visible(casca_plane_query query,
                                           uint64_t *ids,
                                           size_t capacity,
                                           size_t *count);

/// Whether the view of the last run sees each of count points of two floats: answers gets 1 or 0
/// for each. Before the first run, and for points that are not finite, 0.
casca_status casca_plane_query_sees_points(casca_plane_query query,
                                           const float *points,
                                           size_t count,
                                           uint8_t *answers);

/// Writes whether the view of the last run sees any point of a shape.
casca_status casca_plane_query_sees_shape(casca_plane_query query,
                                          const casca_plane_shape *shape,
                                          bool *answer);

/// The visible region of the last run as a polygon, counterclockwise: two floats for each corner.
/// corners has room for capacity corners; count gets how many there are, also when that is more
/// (CASCA_ERROR_TOO_SMALL).
casca_status casca_plane_query_get_polygon(casca_plane_query query,
                                           float *corners,
                                           size_t capacity,
                                           size_t *count);

/// The tiles of a map that an eye sees, exactly. opaque has width * height bytes, row by row, of
/// which those that are not 0 stop sight; seen has as many and gets 1 for each tile in sight, else
/// 0. The eye is in tiles: the middle of the first is 0.5, 0.5. radius is in tiles; 0: no limit.
///
/// Errors: more than 16384 tiles along a side, an eye that is not finite. Costs a look at all tiles
/// of the map, and microseconds for those in sight.
casca_status casca_plane_field_of_view(const uint8_t *opaque,
                                       uint32_t width,
                                       uint32_t height,
                                       double eye_x,
                                       double eye_y,
                                       float radius,
                                       uint8_t *seen);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* CASCA_H */
