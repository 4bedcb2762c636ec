/* Checks of tests: a failed one prints its line and ends the program with 1. */
#ifndef CHECK_H
#define CHECK_H

#include <casca.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CHECK(what)                                                                     \
    do {                                                                                \
        if (!(what)) {                                                                  \
            fprintf(stderr, "%s:%d: %s\nlast error: %s\n", __FILE__, __LINE__, #what,   \
                    casca_last_error());                                                \
            exit(1);                                                                    \
        }                                                                               \
    } while (0)

#define OK(call) CHECK((call) == CASCA_OK)
#define REFUSED(status, call) CHECK((call) == (status) && casca_last_error()[0] != '\0')

static inline casca_scene scene_of(float size) {
    casca_grid grid = CASCA_INIT(casca_grid);
    grid.max[0] = grid.max[1] = grid.max[2] = size;
    grid.cell = 1.0f;
    casca_scene scene;
    OK(casca_scene_create(&grid, &scene));
    return scene;
}

static inline casca_shape sphere_at(float x, float y, float z, float radius) {
    casca_shape shape;
    memset(&shape, 0, sizeof shape);
    shape.kind = CASCA_SHAPE_SPHERE;
    shape.radius = radius;
    shape.center[0] = x, shape.center[1] = y, shape.center[2] = z;
    return shape;
}

static inline casca_shape box_of(float x, float y, float z, float to_x, float to_y, float to_z) {
    casca_shape shape;
    memset(&shape, 0, sizeof shape);
    shape.kind = CASCA_SHAPE_BOX;
    shape.min[0] = x, shape.min[1] = y, shape.min[2] = z;
    shape.max[0] = to_x, shape.max[1] = to_y, shape.max[2] = to_z;
    return shape;
}

static inline casca_view view_from(float x, float y, float z) {
    casca_view view = CASCA_INIT(casca_view);
    view.kind = CASCA_VIEW_OMNIDIRECTIONAL;
    view.eye[0] = x, view.eye[1] = y, view.eye[2] = z;
    return view;
}

#endif
