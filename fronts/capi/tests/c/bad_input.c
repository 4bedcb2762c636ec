/* Bad input: each call must be refused with the status that its comment says, and change nothing. */
#include "check.h"

#include <math.h>

#define NULL_POINTER CASCA_ERROR_NULL_POINTER

static casca_scene scene;
static casca_query query;
static uint64_t ball;
static casca_view view;

static void pointers(void) {
    casca_grid grid = CASCA_INIT(casca_grid);
    casca_scene made;
    uint64_t id, ids[2];
    size_t count;
    bool answer;
    float numbers[16] = {0};
    casca_object object = CASCA_INIT(casca_object);
    object.bounds = sphere_at(1, 1, 1, 1);
    REFUSED(NULL_POINTER, casca_scene_create(NULL, &made));
    REFUSED(NULL_POINTER, casca_scene_create(&grid, NULL));
    REFUSED(NULL_POINTER, casca_scene_add(scene, NULL, &id));
    REFUSED(NULL_POINTER, casca_scene_add(scene, &object, NULL));
    REFUSED(NULL_POINTER, casca_scene_update(scene, ball, NULL, NULL));
    REFUSED(NULL_POINTER, casca_scene_contains(scene, ball, NULL));
    REFUSED(NULL_POINTER, casca_scene_get_box(scene, ball, numbers, NULL));
    REFUSED(NULL_POINTER, casca_scene_get_ids(scene, NULL, 1, &count));
    REFUSED(NULL_POINTER, casca_scene_get_ids(scene, ids, 2, NULL));
    REFUSED(NULL_POINTER, casca_scene_move_spheres(scene, NULL, numbers, 1));
    REFUSED(NULL_POINTER, casca_scene_move_spheres(scene, &ball, NULL, 1));
    REFUSED(NULL_POINTER, casca_scene_set_transform(scene, ball, NULL, 0));
    REFUSED(NULL_POINTER, casca_scene_translate(scene, ball, NULL));
    REFUSED(NULL_POINTER, casca_scene_end_frame(scene, NULL, 1, NULL));
    REFUSED(NULL_POINTER, casca_scene_get_memory(scene, NULL));
    REFUSED(NULL_POINTER, casca_query_create(NULL, NULL));
    REFUSED(NULL_POINTER, casca_query_run(query, scene, NULL, NULL));
    REFUSED(NULL_POINTER, casca_query_contains(query, scene, ball, NULL));
    REFUSED(NULL_POINTER, casca_query_shadow_casters(query, scene, query, NULL, NULL));
    REFUSED(NULL_POINTER, casca_mesh_create(NULL, NULL));
    REFUSED(NULL_POINTER, casca_mesh_load(NULL, 5, NULL));
    REFUSED(NULL_POINTER, casca_solid_create(NULL, 4, NULL));
    REFUSED(NULL_POINTER, casca_plane_create(NULL, NULL));
    REFUSED(NULL_POINTER, casca_plane_query_create(NULL));
    REFUSED(NULL_POINTER, casca_plane_field_of_view(NULL, 4, 4, 1, 1, 0, NULL));

    /* Misaligned, and longer than memory. */
    char *bytes = (char *)numbers;
    REFUSED(CASCA_ERROR_BAD_SPAN, casca_scene_add(scene, &object, (uint64_t *)(void *)(bytes + 1)));
    REFUSED(CASCA_ERROR_BAD_SPAN,
            casca_scene_move_spheres(scene, &ball, (float *)(void *)(bytes + 2), 1));
    REFUSED(CASCA_ERROR_BAD_SPAN, casca_scene_move_spheres(scene, &ball, numbers, SIZE_MAX / 2));
    REFUSED(CASCA_ERROR_BAD_SPAN, casca_scene_move_boxes(scene, ids, numbers, SIZE_MAX));
    REFUSED(CASCA_ERROR_BAD_SPAN, casca_scene_get_ids(scene, ids, SIZE_MAX, &count));
    REFUSED(CASCA_ERROR_BAD_SPAN, casca_mesh_load((uint8_t *)bytes, SIZE_MAX, &(casca_mesh){0}));
    REFUSED(CASCA_ERROR_BAD_SPAN, casca_query_may_see_points(query, scene, numbers, SIZE_MAX / 12,
                                                             (uint8_t *)bytes));
    /* Null is a span of nothing. */
    OK(casca_scene_move_spheres(scene, NULL, NULL, 0));
    OK(casca_scene_end_frame(scene, NULL, 0, NULL));
    OK(casca_query_may_see_points(query, scene, NULL, 0, NULL));
    OK(casca_scene_contains(scene, ball, &answer));
    CHECK(answer);
}

/* A caller with a newer header: a struct that is longer. */
typedef struct {
    casca_grid old;
    uint64_t new_field;
} newer_grid;

static void sizes(void) {
    casca_scene made;
    casca_grid grid;
    memset(&grid, 0, sizeof grid);
    grid.max[0] = grid.max[1] = grid.max[2] = grid.cell = 1.0f;
    size_t wrong[] = {0, 1, sizeof grid - 1, 4097, SIZE_MAX};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        grid.size = wrong[i];
        REFUSED(CASCA_ERROR_BAD_STRUCT, casca_scene_create(&grid, &made));
    }
    newer_grid newer;
    memset(&newer, 0, sizeof newer);
    newer.old = grid;
    newer.old.size = sizeof newer;
    OK(casca_scene_create(&newer.old, &made));
    OK(casca_scene_free(made));
    newer.new_field = 1;
    REFUSED(CASCA_ERROR_BAD_STRUCT, casca_scene_create(&newer.old, &made));
    struct {
        casca_memory old;
        uint64_t new_field;
    } memory;
    memset(&memory, 0xff, sizeof memory);
    memory.old.size = sizeof memory;
    OK(casca_scene_get_memory(scene, &memory.old));
    CHECK(memory.new_field == 0 && memory.old.size == sizeof memory && memory.old.total > 0);
    memory.old.size = 8;
    REFUSED(CASCA_ERROR_BAD_STRUCT, casca_scene_get_memory(scene, &memory.old));
}

static void handles(void) {
    casca_scene none = {0}, forged = {scene.handle + 1}, odd = {UINT64_MAX};
    casca_scene as_scene = {query.handle};
    casca_query as_query = {scene.handle};
    uint64_t before = scene.handle;
    size_t count;
    REFUSED(CASCA_ERROR_INVALID_HANDLE, casca_scene_clear(none));
    REFUSED(CASCA_ERROR_INVALID_HANDLE, casca_scene_clear(forged));
    REFUSED(CASCA_ERROR_INVALID_HANDLE, casca_scene_clear(odd));
    REFUSED(CASCA_ERROR_INVALID_HANDLE, casca_scene_free(none));
    REFUSED(CASCA_ERROR_WRONG_KIND, casca_scene_clear(as_scene));
    REFUSED(CASCA_ERROR_WRONG_KIND, casca_scene_free(as_scene));
    REFUSED(CASCA_ERROR_WRONG_KIND, casca_query_run(as_query, scene, &view, NULL));
    REFUSED(CASCA_ERROR_WRONG_KIND, casca_query_run(query, as_scene, &view, NULL));
    REFUSED(CASCA_ERROR_WRONG_KIND, casca_scene_end_frame(scene, &as_query, 1, NULL));
    REFUSED(CASCA_ERROR_WRONG_KIND, casca_mesh_free((casca_mesh){scene.handle}));
    REFUSED(CASCA_ERROR_WRONG_KIND, casca_solid_free((casca_solid){scene.handle}));
    REFUSED(CASCA_ERROR_WRONG_KIND, casca_job_run((casca_job){scene.handle}));
    REFUSED(CASCA_ERROR_WRONG_KIND, casca_plane_free((casca_plane){scene.handle}));
    REFUSED(CASCA_ERROR_WRONG_KIND, casca_plane_query_free((casca_plane_query){scene.handle}));

    /* Use after free, also when the place is used again. */
    casca_scene other = scene_of(8.0f);
    casca_query foreign;
    OK(casca_query_create(NULL, &foreign));
    OK(casca_query_run(foreign, other, &view, NULL));
    REFUSED(CASCA_ERROR_FOREIGN_RESULT, casca_scene_end_frame(scene, &foreign, 1, NULL));
    casca_light lamp = CASCA_INIT(casca_light);
    lamp.direction[1] = -1.0f;
    REFUSED(CASCA_ERROR_FOREIGN_RESULT, casca_query_shadow_casters(query, scene, foreign, &lamp, NULL));
    REFUSED(CASCA_ERROR_BUSY, casca_query_shadow_casters(query, scene, query, &lamp, NULL));
    casca_query unused;
    OK(casca_query_create(NULL, &unused));
    REFUSED(CASCA_ERROR_FOREIGN_RESULT,
            casca_query_may_see_points(unused, scene, view.eye, 1, &(uint8_t){0}));
    OK(casca_query_free(unused));
    OK(casca_scene_free(other));
    for (int i = 0; i < 100; ++i) {
        REFUSED(CASCA_ERROR_STALE_HANDLE, casca_scene_free(other));
        REFUSED(CASCA_ERROR_STALE_HANDLE, casca_query_run(foreign, other, &view, NULL));
        casca_scene next = scene_of(8.0f);
        CHECK(next.handle != other.handle && next.handle != before);
        REFUSED(CASCA_ERROR_STALE_HANDLE, casca_scene_clear(other));
        OK(casca_scene_free(next));
        other = next;
    }
    OK(casca_query_get_visible(foreign, NULL, 0, &count));
    OK(casca_query_free(foreign));
    REFUSED(CASCA_ERROR_STALE_HANDLE, casca_query_free(foreign));
    REFUSED(CASCA_ERROR_STALE_HANDLE, casca_scene_end_frame(scene, &foreign, 1, NULL));
}

static void ids(void) {
    casca_scene other = scene_of(8.0f);
    casca_object object = CASCA_INIT(casca_object);
    object.bounds = sphere_at(1, 1, 1, 1);
    uint64_t theirs, mine, number;
    bool answer;
    for (int i = 0; i < 200; ++i) {
        OK(casca_scene_add(other, &object, &theirs));
        OK(casca_scene_contains(scene, theirs, &answer));
        CHECK(!answer);
        REFUSED(CASCA_ERROR_UNKNOWN_OBJECT, casca_scene_remove(scene, theirs));
    }
    REFUSED(CASCA_ERROR_UNKNOWN_OBJECT, casca_scene_remove(other, ball));
    REFUSED(CASCA_ERROR_UNKNOWN_OBJECT, casca_scene_remove(scene, 0));
    OK(casca_scene_add(scene, &object, &mine));
    OK(casca_scene_remove(scene, mine));
    REFUSED(CASCA_ERROR_UNKNOWN_OBJECT, casca_scene_remove(scene, mine));
    REFUSED(CASCA_ERROR_UNKNOWN_OBJECT, casca_scene_set_layers(scene, mine, 1));
    REFUSED(CASCA_ERROR_UNKNOWN_OBJECT, casca_query_contains(query, scene, mine, &answer));
    uint64_t both[2] = {ball, mine}, numbers[2] = {3, 3};
    REFUSED(CASCA_ERROR_UNKNOWN_OBJECT, casca_scene_get_user_data(scene, both, 2, numbers));
    CHECK(numbers[0] == 3 && strstr(casca_last_error(), "element 1: ") != NULL);
    OK(casca_scene_add(scene, &object, &number));
    CHECK(number != mine);
    /* All moves are made but the refused ones. */
    float spheres[8] = {5, 5, 5, 1, 6, 6, 6, 1}, min[3], max[3];
    uint64_t moved[2] = {mine, number};
    REFUSED(CASCA_ERROR_UNKNOWN_OBJECT, casca_scene_move_spheres(scene, moved, spheres, 2));
    OK(casca_scene_get_box(scene, number, min, max));
    CHECK(min[0] > 4.9f);
    OK(casca_scene_remove(scene, number));
    OK(casca_scene_free(other));
}

static void arguments(void) {
    casca_object object = CASCA_INIT(casca_object);
    uint64_t id = 4;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_scene_add(scene, &object, &id));
    float bad[] = {NAN, INFINITY, -INFINITY, -1.0f};
    for (int i = 0; i < 4; ++i) {
        object.bounds = sphere_at(1, 1, 1, bad[i]);
        REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_scene_add(scene, &object, &id));
    }
    object.bounds = box_of(1, 1, 1, 0, 2, 2);
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_scene_add(scene, &object, &id));
    CHECK(strcmp(casca_last_error_code(), "inverted-box") == 0);
    object.bounds.kind = 99;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_scene_add(scene, &object, &id));
    object.bounds = sphere_at(1, 1, 1, 1);
    object.occluder = sphere_at(1, 1, 1, 2);
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_scene_add(scene, &object, &id));
    CHECK(strcmp(casca_last_error_code(), "occluder-outside") == 0);
    object.occluder.kind = CASCA_SHAPE_MESH;
    REFUSED(CASCA_ERROR_INVALID_HANDLE, casca_scene_add(scene, &object, &id));
    object.occluder.kind = CASCA_SHAPE_NONE;
    object.flags = 1u << 30;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_scene_add(scene, &object, &id));
    object.flags = CASCA_PLACED;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_scene_add(scene, &object, &id));
    object.flags = CASCA_HAS_MAX_SPEED;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_scene_add(scene, &object, &id));
    CHECK(strstr(casca_last_error(), "CASCA_MOVES") != NULL && id == 4);

    casca_view bad_view = view;
    for (int i = 0; i < 3; ++i) {
        bad_view = view;
        bad_view.eye[i] = NAN;
        REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_query_run(query, scene, &bad_view, NULL));
    }
    bad_view = view;
    bad_view.kind = CASCA_VIEW_PERSPECTIVE;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_query_run(query, scene, &bad_view, NULL));
    bad_view.kind = 77;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_query_run(query, scene, &bad_view, NULL));
    bad_view = view;
    bad_view.flags = 64;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_query_run(query, scene, &bad_view, NULL));
    bad_view = view;
    bad_view.reach = -1.0f;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_query_run(query, scene, &bad_view, NULL));
    bad_view = view;
    bad_view.kind = CASCA_VIEW_CELL;
    for (int i = 0; i < 3; ++i) bad_view.cell_max[i] = view.eye[i] + 1.0f;
    OK(casca_query_run(query, scene, &bad_view, NULL));
    bad_view.reach = 0.1f;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_query_run(query, scene, &bad_view, NULL));
    bad_view = view;
    bad_view.kind = CASCA_VIEW_PLANES;
    bad_view.plane_count = SIZE_MAX;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_query_run(query, scene, &bad_view, NULL));
    bad_view.plane_count = 1;
    REFUSED(NULL_POINTER, casca_query_run(query, scene, &bad_view, NULL));

    casca_query_options options = CASCA_INIT(casca_query_options);
    casca_query made;
    options.method = 9;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_query_create(&options, &made));
    options.method = CASCA_METHOD_CELL;
    options.mask_resolution = 100;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_query_create(&options, &made));
    options.mask_resolution = 0;
    options.flags = CASCA_KEPT;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_query_create(&options, &made));
    options.method = CASCA_METHOD_POINT;
    options.preset = 8;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_query_create(&options, &made));
    options.preset = 0;
    options.pixel_degrees = NAN;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_query_create(&options, &made));
    casca_job job;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_query_prepare(query, scene, &view, &job));

    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_scene_begin_frame(scene, NAN, NULL));
    casca_light lamp = CASCA_INIT(casca_light);
    casca_query light;
    OK(casca_query_create(NULL, &light));
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_query_shadow_casters(light, scene, query, &lamp, NULL));
    lamp.kind = CASCA_LIGHT_SPOT;
    REFUSED(NULL_POINTER, casca_query_shadow_casters(light, scene, query, &lamp, NULL));
    OK(casca_query_free(light));

    casca_mesh_desc desc = CASCA_INIT(casca_mesh_desc);
    casca_mesh mesh = {42};
    float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    uint32_t indices[3] = {0, 1, 2};
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_mesh_create(&desc, &mesh));
    desc.positions = corners, desc.position_count = 3;
    desc.indices = indices, desc.index_count = 2;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_mesh_create(&desc, &mesh));
    desc.index_count = SIZE_MAX - SIZE_MAX % 3;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_mesh_create(&desc, &mesh));
    desc.index_count = 3;
    indices[2] = 3;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_mesh_create(&desc, &mesh));
    indices[2] = 2;
    desc.position_stride = 13;
    REFUSED(CASCA_ERROR_BAD_SPAN, casca_mesh_create(&desc, &mesh));
    desc.position_stride = 0;
    desc.position_count = SIZE_MAX / 2;
    REFUSED(CASCA_ERROR_BAD_SPAN, casca_mesh_create(&desc, &mesh));
    desc.position_count = 3;
    corners[4] = NAN;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_mesh_create(&desc, &mesh));
    CHECK(mesh.handle == 42);
    REFUSED(CASCA_ERROR_DAMAGED, casca_mesh_load(NULL, 0, &mesh));
    REFUSED(CASCA_ERROR_DAMAGED, casca_mesh_load((const uint8_t *)"casca? no.", 10, &mesh));
    casca_solid solid;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_solid_create(corners, 3, &solid));
    uint8_t tile = 0;
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT,
            casca_plane_field_of_view(&tile, UINT32_MAX, UINT32_MAX, 0, 0, 0, &tile));
    REFUSED(CASCA_ERROR_INVALID_ARGUMENT, casca_plane_field_of_view(&tile, 1, 1, NAN, 0, 0, &tile));
}

int main(void) {
    scene = scene_of(32.0f);
    view = view_from(2.5f, 16.5f, 16.5f);
    OK(casca_query_create(NULL, &query));
    casca_object object = CASCA_INIT(casca_object);
    object.bounds = sphere_at(9, 9, 9, 1);
    OK(casca_scene_add(scene, &object, &ball));
    OK(casca_query_run(query, scene, &view, NULL));
    pointers();
    sizes();
    handles();
    ids();
    arguments();
    /* After all of that, the scene and the query are as they were. */
    uint64_t seen[2];
    size_t count;
    OK(casca_scene_get_ids(scene, seen, 2, &count));
    CHECK(count == 1 && seen[0] == ball);
    OK(casca_query_get_visible(query, seen, 2, &count));
    CHECK(count == 1 && seen[0] == ball);
    OK(casca_query_free(query));
    OK(casca_scene_free(scene));
    puts("bad input: refused");
    return 0;
}
