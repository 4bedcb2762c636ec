// The C++ wrapper: owners, spans, exceptions.
#include <array>
#include <casca.hpp>
#include <cstdio>

#include "check.h"

int main() {
    auto grid = casca::init<casca_grid>();
    grid.max[0] = grid.max[1] = grid.max[2] = 32.0f;
    grid.cell = 1.0f;
    casca::scene scene(grid);
    scene.reserve(10);
    auto wall_box = casca::box(8, 0, 0, 10, 32, 32);
    auto wall = scene.add_fixed(wall_box, wall_box);
    auto ball = casca::init<casca_object>();
    ball.bounds = casca::sphere(20, 16, 16, 1);
    ball.flags = CASCA_MOVES;
    ball.user_data = 3;
    auto far = scene.add(ball);
    CHECK(scene.contains(wall) && scene.ids().size() == 2);

    casca::query query, light;
    auto view = casca::omnidirectional(2.5f, 16.5f, 16.5f);
    CHECK(scene.begin_frame(0.0).empty());
    CHECK(query.run(scene, view) == 1 && query.visible() == std::vector<std::uint64_t>{wall});
    CHECK(!query.contains(scene, far) && query.is_valid(scene, view));
    CHECK(query.may_see_points(scene, std::array<float, 3>{20, 16, 16})[0] == 0);
    CHECK(query.may_see_boxes(scene, std::vector<float>{1, 1, 1, 2, 2, 2})[0] == 1);
    auto sun = casca::init<casca_light>();
    sun.direction[0] = -1.0f;
    CHECK(light.shadow_casters(scene, query, sun) == 2);
    CHECK(query.stats().objects_tested > 0);
    std::array queries{query.get(), light.get()};
    scene.end_frame(queries);
    scene.move_spheres(std::array{far}, std::array<float, 4>{3, 16, 16, 1});
    CHECK(query.run(scene, view) == 2);
    CHECK(scene.user_data(query.visible()).size() == 2 && scene.memory().total > 0);

    auto kept_options = casca::init<casca_query_options>();
    kept_options.flags = CASCA_KEPT;
    casca::query kept(kept_options);
    casca::job job(kept, scene, view);
    job.run();
    CHECK(job.install(kept, scene) && !job);
    CHECK(kept.run(scene, view) == 2 && kept.stats().refreshes == 0);

    casca::mesh mesh(std::array<float, 9>{0, 0, 0, 1, 0, 0, 0, 1, 0},
                     std::vector<std::uint32_t>{0, 1, 2});
    auto again = casca::mesh::load(mesh.save());
    CHECK(again.info().triangles == 1);
    scene.add_fixed(again.shape(), mesh.shape());
    casca::solid solid(std::array<float, 12>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
    scene.add_fixed(casca::box(0, 0, 0, 1, 1, 1), solid.shape());

    bool thrown = false;
    try {
        scene.remove(17);
    } catch (const casca::error &refused) {
        thrown = refused.status() == CASCA_ERROR_UNKNOWN_OBJECT && refused.what()[0] != '\0';
    }
    CHECK(thrown);
    // Moved from: the handle is empty, and the calls are refused.
    casca::scene other(std::move(scene));
    CHECK(!scene && other.ids().size() == 4);
    scene = std::move(other);
    other.reset();
    scene.clear();

    auto plane_grid = casca::init<casca_plane_grid>();
    plane_grid.max[0] = plane_grid.max[1] = 8.0f;
    plane_grid.cell = 1.0f;
    casca::plane plane(plane_grid);
    auto coin = casca::init<casca_plane_object>();
    coin.bounds.kind = CASCA_PLANE_DISC;
    coin.bounds.radius = 0.5f;
    auto coin_id = plane.add(coin);
    casca::plane_query viewer;
    CHECK(viewer.run(plane, casca::init<casca_plane_view>()) == std::vector<std::uint64_t>{coin_id});
    std::puts("wrapper: ok");
}
