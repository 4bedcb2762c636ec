// Several cameras on a job system in C++: threads take cameras from a list and query one scene side
// by side; between frames one thread edits the scene.
//
//     cargo build --release --manifest-path fronts/Cargo.toml -p casca-capi
//     c++ -std=c++17 -O2 -I fronts/capi/include fronts/capi/examples/jobs.cpp
//         fronts/target/release/libcasca_c.a -lpthread -ldl -lm -o jobs && ./jobs
#include <atomic>
#include <casca.hpp>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

// A small job system: a fixed number of threads, and one list of jobs at a time.
class Jobs {
public:
    explicit Jobs(unsigned count) {
        for (unsigned i = 0; i < count; ++i) threads.emplace_back([this] { work(); });
    }
    ~Jobs() {
        {
            std::lock_guard guard(lock);
            ended = true;
        }
        wake.notify_all();
        for (auto &thread : threads) thread.join();
    }

    // Runs job(0) to job(count - 1) on all threads, and returns when all are done.
    void run(std::size_t count, std::function<void(std::size_t)> job) {
        std::unique_lock guard(lock);
        todo = std::move(job), next = 0, end = count, left = count;
        wake.notify_all();
        done.wait(guard, [this] { return left == 0; });
    }

private:
    void work() {
        std::unique_lock guard(lock);
        for (;;) {
            wake.wait(guard, [this] { return ended || next < end; });
            if (ended) return;
            const std::size_t mine = next++;
            guard.unlock();
            todo(mine);
            guard.lock();
            if (--left == 0) done.notify_all();
        }
    }

    std::mutex lock;
    std::condition_variable wake, done;
    std::function<void(std::size_t)> todo;
    std::size_t next = 0, end = 0, left = 0;
    bool ended = false;
    std::vector<std::thread> threads;
};

int main() try {
    auto grid = casca::init<casca_grid>();
    grid.cell = 1.0f;
    casca::scene scene(grid);
    // Houses along streets, and people in them.
    for (int x = 0; x < 10; ++x) {
        for (int z = 0; z < 10; ++z) {
            const float at_x = 12.0f * float(x) + 2.0f, at_z = 12.0f * float(z) + 2.0f;
            auto house = casca::box(at_x, 0, at_z, at_x + 8, 6 + float((7 * x + 3 * z) % 9), at_z + 8);
            scene.add_fixed(house, house);
        }
    }
    std::vector<std::uint64_t> people;
    std::vector<float> places;
    for (int i = 0; i < 2000; ++i) {
        auto person = casca::init<casca_object>();
        person.flags = CASCA_MOVES;
        person.bounds = casca::sphere(float(i % 120), 1, 12.0f * float(i % 10), 0.5f);
        person.user_data = std::uint64_t(i);
        people.push_back(scene.add(person));
        for (float number : {person.bounds.center[0], 1.0f, person.bounds.center[2], 0.5f}) {
            places.push_back(number);
        }
    }

    // A query for each camera: each is used by one thread at a time.
    const std::size_t cameras = 6;
    std::vector<casca::query> queries(cameras);
    Jobs jobs(4);
    for (int frame = 0; frame < 10; ++frame) {
        // One thread edits.
        scene.begin_frame(frame / 60.0);
        for (std::size_t i = 0; i < people.size(); ++i) {
            places[4 * i] = std::fmod(places[4 * i] + 0.05f, 120.0f);
        }
        scene.move_spheres(people, places);
        // All threads query.
        std::vector<std::size_t> counts(cameras);
        jobs.run(cameras, [&](std::size_t i) {
            auto view = casca::omnidirectional(20.0f * float(i) + 0.5f, 1.7f, 60.5f);
            counts[i] = queries[i].run(scene, view);
        });
        // One thread ends the frame, with what all cameras saw.
        std::vector<casca_query> all;
        for (const auto &query : queries) all.push_back(query.get());
        const auto report = scene.end_frame(all);
        std::printf("frame %d: in sight", frame);
        for (auto count : counts) std::printf(" %4zu", count);
        std::printf(" of %zu; %zu put into volumes\n", people.size() + 100, report.hidden);
    }
    return 0;
} catch (const casca::error &refused) {
    std::fprintf(stderr, "%s: %s\n", casca_status_name(refused.status()), refused.what());
    return 1;
}
