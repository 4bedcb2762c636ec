/* A first query in C: a wall hides a bird, until the bird flies over it.
 *
 *     cargo build --release --manifest-path fronts/Cargo.toml -p casca-capi
 *     cc -std=c11 -I fronts/capi/include fronts/capi/examples/first_query.c \
 *         fronts/target/release/libcasca_c.a -lpthread -ldl -lm -o first_query && ./first_query
 */
#include <casca.h>
#include <stdio.h>
#include <stdlib.h>

/* Ends the program if a call was refused. */
static void check(casca_status status) {
    if (status != CASCA_OK) {
        fprintf(stderr, "%s: %s\n", casca_status_name(status), casca_last_error());
        exit(1);
    }
}

int main(void) {
    /* A grid with cells of one metre. */
    casca_grid grid = CASCA_INIT(casca_grid);
    grid.cell = 1.0f;
    casca_scene scene;
    check(casca_scene_create(&grid, &scene));

    /* A wall across the level, 8 metres high. It is tested and hides. */
    casca_object wall = CASCA_INIT(casca_object);
    wall.bounds.kind = CASCA_SHAPE_BOX;
    wall.bounds.min[2] = 30.0f;
    wall.bounds.max[0] = 64.0f, wall.bounds.max[1] = 8.0f, wall.bounds.max[2] = 33.0f;
    wall.occluder = wall.bounds;
    wall.user_data = 1;
    uint64_t wall_id;
    check(casca_scene_add(scene, &wall, &wall_id));

    /* A bird. */
    casca_object bird = CASCA_INIT(casca_object);
    bird.flags = CASCA_MOVES | CASCA_HAS_MAX_SPEED;
    bird.max_speed = 12.0f;
    bird.bounds.kind = CASCA_SHAPE_SPHERE;
    bird.bounds.radius = 0.3f;
    bird.bounds.center[0] = 32.0f, bird.bounds.center[1] = 4.0f, bird.bounds.center[2] = 10.0f;
    bird.user_data = 2;
    uint64_t bird_id;
    check(casca_scene_add(scene, &bird, &bird_id));

    casca_query query;
    check(casca_query_create(NULL, &query));

    /* A camera at (32.5, 2.5, 60.5) that looks along -z: 60 degrees high, 16:9, with reversed depth
     * from 0.1 m on. Renderers have this matrix; here it is written by hand, column by column. */
    const float eye[3] = {32.5f, 2.5f, 60.5f};
    const float right = 0.974f, up = 1.732f, near = 0.1f;
    casca_view view = CASCA_INIT(casca_view);
    const float matrix[16] = {
        right, 0.0f, 0.0f, 0.0f,                       /* x */
        0.0f, up, 0.0f, 0.0f,                          /* y */
        0.0f, 0.0f, 0.0f, -1.0f,                       /* z */
        -right * eye[0], -up * eye[1], near, eye[2],   /* the translation to the eye */
    };
    for (int i = 0; i < 16; ++i) view.matrix[i] = matrix[i];
    for (int i = 0; i < 3; ++i) view.eye[i] = eye[i];

    for (int frame = 0; frame < 4; ++frame) {
        check(casca_scene_begin_frame(scene, frame / 60.0, NULL));
        const float sphere[4] = {32.0f, 4.0f + 4.0f * (float)frame, 10.0f, 0.3f};
        check(casca_scene_move_spheres(scene, &bird_id, sphere, 1));

        check(casca_query_run(query, scene, &view, NULL));
        uint64_t ids[2], objects[2];
        size_t count;
        check(casca_query_get_visible(query, ids, 2, &count));
        check(casca_scene_get_user_data(scene, ids, count, objects));
        printf("frame %d, the bird is %2.0f m high; in sight:", frame, (double)sphere[1]);
        for (size_t i = 0; i < count; ++i) printf(" %s", objects[i] == 1 ? "wall" : "bird");
        printf("\n");
        check(casca_scene_end_frame(scene, &query, 1, NULL));
    }
    check(casca_query_free(query));
    check(casca_scene_free(scene));
    return 0;
}
