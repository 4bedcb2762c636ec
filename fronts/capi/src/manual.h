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
