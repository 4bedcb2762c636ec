/* Every function of casca.h, called as its comment says. */
#include "check.h"

static uint64_t add(casca_scene scene, casca_shape bounds, bool hides, uint32_t flags) {
    casca_object object = CASCA_INIT(casca_object);
    object.bounds = bounds;
    if (hides) object.occluder = bounds;
    object.flags = flags;
    object.user_data = 77;
    if (flags & CASCA_HAS_MAX_SPEED) object.max_speed = 2.0f;
    if (flags & CASCA_PLACED)
        for (int i = 0; i < 16; ++i) object.transform[i] = i % 5 == 0 ? 1.0f : 0.0f;
    uint64_t id = 0;
    OK(casca_scene_add(scene, &object, &id));
    CHECK(id != 0);
    return id;
}

static void texts(void) {
    CHECK(casca_version() == CASCA_VERSION);
    CHECK(strcmp(casca_last_error(), "") == 0 && strcmp(casca_last_error_code(), "") == 0);
    CHECK(strcmp(casca_status_name(CASCA_ERROR_BUSY), "CASCA_ERROR_BUSY") == 0);
    CHECK(strcmp(casca_status_name(-5), "unknown status") == 0);
    for (int i = 0; i <= CASCA_ERROR_PANIC; ++i) CHECK(strncmp(casca_status_name(i), "CASCA_", 6) == 0);
}

static void objects(void) {
    casca_scene scene = scene_of(32.0f);
    OK(casca_scene_reserve(scene, 100));
    uint64_t wall = add(scene, box_of(8, 0, 0, 10, 32, 32), true, 0);
    uint64_t ball = add(scene, sphere_at(20, 16, 16, 1), false, CASCA_MOVES);
    uint64_t cube = add(scene, box_of(4, 4, 4, 5, 5, 5), false, CASCA_MOVES | CASCA_HAS_MAX_SPEED);
    casca_shape turned;
    memset(&turned, 0, sizeof turned);
    turned.kind = CASCA_SHAPE_TURNED_BOX;
    turned.half[0] = turned.half[1] = turned.half[2] = 0.5f;
    turned.rotation[1] = 0.6f, turned.rotation[3] = 0.8f;
    uint64_t door = add(scene, turned, true, CASCA_MOVES | CASCA_PLACED);

    bool answer = false;
    OK(casca_scene_contains(scene, wall, &answer));
    CHECK(answer);
    float min[3], max[3];
    OK(casca_scene_get_box(scene, wall, min, max));
    CHECK(min[0] == 8.0f && max[2] == 32.0f);
    casca_shape moved = sphere_at(21, 16, 16, 1);
    OK(casca_scene_update(scene, ball, &moved, NULL));
    OK(casca_scene_set_bounds(scene, ball, &moved));
    OK(casca_scene_get_box(scene, ball, min, max));
    CHECK(min[0] > 19.9f && min[0] <= 20.0f && max[0] >= 22.0f && max[0] < 22.1f);
    casca_shape inside = box_of(8, 0, 0, 9, 32, 32);
    OK(casca_scene_set_occluder(scene, wall, &inside));
    OK(casca_scene_set_occluder(scene, wall, NULL));
    casca_shape whole = box_of(8, 0, 0, 10, 32, 32);
    OK(casca_scene_update(scene, wall, &whole, &whole));

    float spheres[4] = {22, 16, 16, 1}, boxes[6] = {4, 4, 4, 5, 6, 7};
    OK(casca_scene_move_spheres(scene, &ball, spheres, 1));
    OK(casca_scene_move_boxes(scene, &cube, boxes, 1));
    OK(casca_scene_get_box(scene, cube, min, max));
    CHECK(max[1] == 6.0f && max[2] == 7.0f);
    float rows[16] = {1, 0, 0, 20, 0, 1, 0, 9, 0, 0, 1, 5, 0, 0, 0, 1};
    float columns[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 20, 9, 5, 1};
    OK(casca_scene_set_transform(scene, door, rows, CASCA_ROW_MAJOR));
    OK(casca_scene_get_box(scene, door, min, max));
    float by_rows = min[0];
    CHECK(by_rows > 19.0f && by_rows < 20.0f && min[1] > 8.4f && min[2] < 4.6f);
    OK(casca_scene_set_transforms(scene, &door, columns, 1, 0));
    OK(casca_scene_get_box(scene, door, min, max));
    CHECK(min[0] == by_rows);
    float offset[3] = {0, 0, 1};
    OK(casca_scene_translate(scene, ball, offset));
    double origin[3] = {0, 0, 1};
    OK(casca_scene_set_origin(scene, origin));
    OK(casca_scene_get_box(scene, ball, min, max));
    CHECK(max[2] > 16.9f && max[2] < 17.1f);

    uint64_t layers = 0, numbers[2] = {0, 0}, both[2] = {wall, ball};
    OK(casca_scene_get_layers(scene, ball, &layers));
    CHECK(layers == UINT64_MAX);
    OK(casca_scene_set_layers(scene, ball, 4));
    OK(casca_scene_get_layers(scene, ball, &layers));
    CHECK(layers == 4);
    OK(casca_scene_set_user_data(scene, ball, 78));
    OK(casca_scene_get_user_data(scene, both, 2, numbers));
    CHECK(numbers[0] == 77 && numbers[1] == 78);

    uint64_t ids[4];
    size_t count = 0;
    CHECK(casca_scene_get_ids(scene, NULL, 0, &count) == CASCA_ERROR_TOO_SMALL && count == 4);
    OK(casca_scene_get_ids(scene, ids, 4, &count));
    casca_memory memory = CASCA_INIT(casca_memory);
    OK(casca_scene_get_memory(scene, &memory));
    CHECK(memory.size == sizeof memory && memory.objects > 0);
    CHECK(memory.total ==
          memory.opacity + memory.ids + memory.volumes + memory.objects + memory.shapes);
    OK(casca_scene_remove(scene, cube));
    OK(casca_scene_contains(scene, cube, &answer));
    CHECK(!answer);
    OK(casca_scene_clear(scene));
    OK(casca_scene_get_ids(scene, NULL, 0, &count));
    CHECK(count == 0);
    OK(casca_scene_free(scene));
}

static int stop_at_once(float share, void *user) {
    *(float *)user = share;
    return 1;
}

static void meshes(void) {
    /* Positions with a normal behind each, as renderers keep them. */
    float positions[4][6] = {{0}, {1}, {0, 1}, {0, 0, 1}};
    uint32_t indices[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    casca_mesh_desc desc = CASCA_INIT(casca_mesh_desc);
    desc.positions = positions[0];
    desc.position_count = 4;
    desc.position_stride = sizeof positions[0];
    desc.indices = indices;
    desc.index_count = 12;
    desc.flags = CASCA_MESH_TOLERANCE | CASCA_MESH_MIN_RADIUS | CASCA_MESH_FRONT_ONLY;
    desc.tolerance = 0.001f;
    casca_mesh mesh;
    OK(casca_mesh_create(&desc, &mesh));
    casca_mesh_info info = CASCA_INIT(casca_mesh_info);
    OK(casca_mesh_get_info(mesh, &info));
    CHECK(info.triangles == 4 && info.positions == 4 && info.is_closed && info.occludes);
    CHECK(info.bytes > 0 && info.min[0] == 0.0f && info.max[2] == 1.0f);

    size_t count = 0, written = 0;
    CHECK(casca_mesh_save(mesh, NULL, 0, &count) == CASCA_ERROR_TOO_SMALL && count > 100);
    uint8_t *bytes = malloc(count);
    OK(casca_mesh_save(mesh, bytes, count, &written));
    CHECK(written == count);
    casca_mesh loaded;
    OK(casca_mesh_load(bytes, count, &loaded));
    bytes[count / 2] ^= 1;
    casca_mesh damaged;
    CHECK(casca_mesh_load(bytes, count, &damaged) == CASCA_ERROR_DAMAGED);
    free(bytes);

    float share = 2.0f;
    desc.progress = stop_at_once;
    desc.user = &share;
    CHECK(casca_mesh_create(&desc, &damaged) == CASCA_ERROR_CANCELLED && share == 0.0f);

    casca_solid solid;
    float corners[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    OK(casca_solid_create(corners, 4, &solid));
    casca_scene scene = scene_of(16.0f);
    casca_object object = CASCA_INIT(casca_object);
    object.flags = CASCA_MOVES | CASCA_PLACED;
    for (int i = 0; i < 4; ++i) object.transform[5 * i] = 1.0f;
    object.bounds.kind = CASCA_SHAPE_MESH;
    object.bounds.mesh = mesh;
    object.occluder.kind = CASCA_SHAPE_SOLID;
    object.occluder.solid = solid;
    uint64_t id;
    OK(casca_scene_add(scene, &object, &id));
    object.occluder = object.bounds;
    object.bounds.mesh = object.occluder.mesh = loaded;
    OK(casca_scene_add(scene, &object, &id));
    /* Objects keep their shapes. */
    OK(casca_mesh_free(mesh));
    OK(casca_mesh_free(loaded));
    OK(casca_solid_free(solid));
    float away[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 9, 9, 9, 1};
    OK(casca_scene_set_transform(scene, id, away, 0));
    OK(casca_scene_free(scene));
}

static void queries(void) {
    casca_scene scene = scene_of(32.0f);
    uint64_t wall = add(scene, box_of(8, 0, 0, 10, 32, 32), true, 0);
    uint64_t far = add(scene, sphere_at(20, 16, 16, 1), false, CASCA_MOVES);
    uint64_t late = add(scene, sphere_at(22, 16, 16, 1), false,
                        CASCA_MOVES | CASCA_HAS_MAX_SPEED | CASCA_REPORTED_ON_EXPIRY);
    casca_view view = view_from(2.5f, 16.5f, 16.5f);
    for (uint32_t method = CASCA_METHOD_POINT; method <= CASCA_METHOD_FRUSTUM; ++method) {
        casca_query_options options = CASCA_INIT(casca_query_options);
        options.method = method;
        casca_query query;
        OK(casca_query_create(&options, &query));
        size_t count = 0;
        OK(casca_query_run(query, scene, &view, &count));
        bool answer = false;
        OK(casca_query_contains(query, scene, far, &answer));
        CHECK(answer == (method == CASCA_METHOD_FRUSTUM));
        OK(casca_query_contains(query, scene, wall, &answer));
        CHECK(answer);
        OK(casca_query_free(query));
    }

    casca_query query;
    OK(casca_query_create(NULL, &query));
    size_t due = 9, count = 9;
    OK(casca_scene_begin_frame(scene, 0.0, &due));
    OK(casca_query_run(query, scene, &view, &count));
    casca_frame_report report = CASCA_INIT(casca_frame_report);
    OK(casca_scene_end_frame(scene, &query, 1, &report));
    CHECK(report.hidden == 2);
    OK(casca_scene_begin_frame(scene, 1e6, &due));
    CHECK(due == 1);
    uint64_t ids[8] = {0};
    OK(casca_scene_get_due(scene, ids, 8, &count));
    CHECK(count == 1 && ids[0] == late);
    casca_shape there = sphere_at(23, 16, 16, 1);
    OK(casca_scene_update(scene, late, &there, NULL));
    OK(casca_query_run(query, scene, &view, NULL));
    OK(casca_query_get_visible(query, ids, 8, &count));
    CHECK(count == 1 && ids[0] == wall);
    bool answer = false;
    OK(casca_query_is_valid(query, scene, &view, &answer));
    CHECK(answer);
    casca_stats stats = CASCA_INIT(casca_stats);
    OK(casca_query_get_stats(query, &stats));
    CHECK(stats.objects_tested > 0 && !stats.eye_in_occluder);

    float points[6] = {6, 16, 16, 14, 16, 16}, boxes[6] = {12, 10, 10, 14, 14, 14};
    uint8_t answers[2] = {9, 9};
    OK(casca_query_may_see_points(query, scene, points, 2, answers));
    CHECK(answers[0] == 1 && answers[1] == 0);
    OK(casca_query_may_see_boxes(query, scene, boxes, 1, answers));
    CHECK(answers[0] == 0);

    casca_query light;
    OK(casca_query_create(NULL, &light));
    casca_light lamp = CASCA_INIT(casca_light);
    lamp.direction[0] = -1.0f;
    OK(casca_query_shadow_casters(light, scene, query, &lamp, &count));
    OK(casca_query_get_visible(light, ids, 8, &count));
    CHECK(count == 3);
    lamp.kind = CASCA_LIGHT_POINT;
    lamp.position[0] = 4.0f, lamp.position[1] = lamp.position[2] = 16.0f;
    OK(casca_query_shadow_casters(light, scene, query, &lamp, &count));
    CHECK(count == 1);
    lamp.kind = CASCA_LIGHT_SPOT;
    lamp.view = &view;
    OK(casca_query_shadow_casters(light, scene, query, &lamp, NULL));
    OK(casca_query_free(light));

    casca_query_options options = CASCA_INIT(casca_query_options);
    options.flags = CASCA_KEPT;
    options.reach = 0.5f;
    casca_query kept;
    OK(casca_query_create(&options, &kept));
    casca_job job, unused;
    OK(casca_query_prepare(kept, scene, &view, &job));
    OK(casca_query_prepare(kept, scene, &view, &unused));
    CHECK(casca_query_install(kept, scene, job, NULL) == CASCA_ERROR_INVALID_ARGUMENT);
    OK(casca_job_run(job));
    OK(casca_job_run(job));
    OK(casca_query_install(kept, scene, job, &answer));
    CHECK(answer);
    OK(casca_job_free(unused));
    for (int i = 0; i < 5; ++i) {
        OK(casca_query_run(kept, scene, &view, &count));
        CHECK(count >= 1);
        OK(casca_query_get_stats(kept, &stats));
        // The result of the job serves its own view, one for the way of the eye all others.
        CHECK(stats.refreshes == (i > 0));
        view.eye[0] += 0.05f;
    }
    OK(casca_query_reset(kept));
    OK(casca_query_reset(query));
    OK(casca_query_free(kept));
    OK(casca_query_free(query));
    OK(casca_scene_free(scene));
}

static void the_plane(void) {
    casca_plane_grid grid = CASCA_INIT(casca_plane_grid);
    grid.max[0] = grid.max[1] = 8.0f;
    grid.cell = 1.0f;
    casca_plane plane;
    OK(casca_plane_create(&grid, &plane));
    casca_plane_object wall = CASCA_INIT(casca_plane_object), coin = CASCA_INIT(casca_plane_object);
    wall.bounds.kind = CASCA_PLANE_SEGMENT;
    wall.bounds.a[0] = 2, wall.bounds.a[1] = 4, wall.bounds.b[0] = 6, wall.bounds.b[1] = 4;
    wall.occluder = wall.bounds;
    coin.bounds.kind = CASCA_PLANE_DISC;
    coin.bounds.radius = 0.2f, coin.bounds.a[0] = 4, coin.bounds.a[1] = 6;
    coin.user_data = 5;
    uint64_t wall_id, coin_id, number;
    OK(casca_plane_add(plane, &wall, &wall_id));
    OK(casca_plane_add(plane, &coin, &coin_id));
    OK(casca_plane_get_user_data(plane, coin_id, &number));
    CHECK(number == 5 && wall_id != coin_id);
    casca_plane_query query;
    OK(casca_plane_query_create(&query));
    casca_plane_view view = CASCA_INIT(casca_plane_view);
    view.eye[0] = 4, view.eye[1] = 2, view.direction[1] = 1, view.half_angle = 0.5f;
    size_t count;
    OK(casca_plane_query_run(query, plane, &view, &count));
    uint64_t ids[4];
    OK(casca_plane_query_get_visible(query, ids, 4, &count));
    CHECK(count == 1 && ids[0] == wall_id);
    float points[4] = {4, 4, 4, 4.1f}, corners[8];
    uint8_t answers[2];
    OK(casca_plane_query_sees_points(query, points, 2, answers));
    CHECK(answers[0] == 1 && answers[1] == 0);
    bool answer = true;
    OK(casca_plane_query_sees_shape(query, &coin.bounds, &answer));
    CHECK(!answer);
    OK(casca_plane_query_get_polygon(query, corners, 4, &count));
    CHECK(count == 3);
    casca_plane_shape here = coin.bounds;
    here.a[1] = 3;
    OK(casca_plane_update(plane, coin_id, &here, NULL));
    OK(casca_plane_query_run(query, plane, &view, &count));
    CHECK(count == 2);
    OK(casca_plane_remove(plane, coin_id));
    CHECK(casca_plane_remove(plane, coin_id) == CASCA_ERROR_UNKNOWN_OBJECT);
    OK(casca_plane_query_free(query));
    OK(casca_plane_free(plane));

    uint8_t opaque[8 * 16] = {0}, seen[8 * 16];
    for (int x = 0; x < 12; ++x) opaque[4 * 16 + x] = 1;
    OK(casca_plane_field_of_view(opaque, 16, 8, 3.5, 2.5, 0.0f, seen));
    CHECK(seen[4 * 16 + 3] == 1 && seen[6 * 16 + 3] == 0);
}

int main(void) {
    texts();
    objects();
    meshes();
    queries();
    the_plane();
    puts("all functions: ok");
    return 0;
}
