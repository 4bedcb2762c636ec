// Threads: queries on one scene run side by side and find the same; whoever edits meanwhile is
// refused as busy or is alone; handles that other threads free are refused and never crash.
#include <atomic>
#include <casca.hpp>
#include <chrono>
#include <mutex>
#include <set>
#include <thread>

#include "check.h"

static casca::scene filled() {
    auto grid = casca::init<casca_grid>();
    grid.max[0] = grid.max[1] = grid.max[2] = 64.0f;
    grid.cell = 1.0f;
    casca::scene scene(grid);
    std::uint32_t seed = 7;
    auto next = [&seed] { return float((seed = seed * 1664525u + 1013904223u) >> 8) / 16777216.0f; };
    for (int i = 0; i < 400; ++i) {
        float x = next() * 60, y = next() * 60, z = next() * 60, size = 0.3f + 3 * next();
        auto box = casca::box(x, y, z, x + size, y + size, z + size);
        scene.add_fixed(box, box);
    }
    return scene;
}

static void side_by_side(const casca::scene &scene) {
    auto view = casca::omnidirectional(32.1f, 32.2f, 32.3f);
    casca::query alone;
    alone.run(scene, view);
    const auto expected = alone.visible();
    std::atomic<int> inside{0}, most{0}, refused{0};
    auto work = [&] {
        casca::query query;
        for (int i = 0; i < 10; ++i) {
            int now = ++inside, seen = most;
            while (now > seen && !most.compare_exchange_weak(seen, now)) {
            }
            if (casca_query_run(query.get(), scene.get(), &view, nullptr) != CASCA_OK) ++refused;
            --inside;
            CHECK(query.visible() == expected);
        }
    };
    std::thread threads[4] = {std::thread(work), std::thread(work), std::thread(work), std::thread(work)};
    for (auto &thread : threads) thread.join();
    CHECK(refused == 0 && most > 1 && expected.size() > 10);
}

static void edits_meanwhile(casca::scene &scene) {
    auto view = casca::omnidirectional(32.1f, 32.2f, 32.3f);
    std::atomic<bool> done{false};
    std::atomic<int> queries{0}, busy{0}, edits{0};
    std::thread reader([&] {
        casca::query query;
        while (!done) {
            auto status = casca_query_run(query.get(), scene.get(), &view, nullptr);
            CHECK(status == CASCA_OK || status == CASCA_ERROR_BUSY);
            (status == CASCA_OK ? queries : busy)++;
            // Room for the edits: a machine with one core runs one thread at a time.
            std::this_thread::sleep_for(std::chrono::microseconds(300));
        }
    });
    auto ball = casca::init<casca_object>();
    ball.bounds = casca::sphere(30, 30, 30, 0.5f);
    std::uint64_t id = 0;
    while (edits < 50 || queries < 5) {
        auto status = casca_scene_add(scene.get(), &ball, &id);
        CHECK(status == CASCA_OK || status == CASCA_ERROR_BUSY);
        if (status == CASCA_OK) {
            ++edits;
            while (casca_scene_remove(scene.get(), id) == CASCA_ERROR_BUSY) std::this_thread::yield();
        }
        std::this_thread::yield();
    }
    done = true;
    reader.join();
    CHECK(scene.ids().size() == 400);
}

static void freed_by_others() {
    auto view = casca::omnidirectional(1, 1, 1);
    for (int round = 0; round < 50; ++round) {
        auto grid = casca::init<casca_grid>();
        grid.max[0] = grid.max[1] = grid.max[2] = grid.cell = 8.0f;
        casca_scene scene;
        OK(casca_scene_create(&grid, &scene));
        std::atomic<int> freed{0};
        auto work = [&] {
            casca::query query;
            for (;;) {
                auto status = casca_query_run(query.get(), scene, &view, nullptr);
                CHECK(status == CASCA_OK || status == CASCA_ERROR_BUSY || status == CASCA_ERROR_STALE_HANDLE);
                if (status == CASCA_ERROR_STALE_HANDLE) return;
                if (casca_scene_free(scene) == CASCA_OK) ++freed;
            }
        };
        std::thread one(work), two(work);
        one.join();
        two.join();
        CHECK(freed == 1);
    }
    // Handles made by many threads are all different.
    std::mutex lock;
    std::set<std::uint64_t> handles;
    auto make = [&] {
        for (int i = 0; i < 300; ++i) {
            casca_query query;
            OK(casca_query_create(nullptr, &query));
            if (i % 2 == 0) OK(casca_query_free(query));
            std::lock_guard guard(lock);
            CHECK(handles.insert(query.handle).second);
        }
    };
    std::thread threads[3] = {std::thread(make), std::thread(make), std::thread(make)};
    for (auto &thread : threads) thread.join();
    for (auto handle : handles) casca_query_free({handle});
}

int main() {
    auto scene = filled();
    side_by_side(scene);
    edits_meanwhile(scene);
    freed_by_others();
    std::puts("threads: ok");
}
