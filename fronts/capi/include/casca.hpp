// casca for C++17: the functions of casca.h with handles that free themselves, spans, and errors as
// exceptions. Everything is in this header; casca.h is the manual.
//
// Calls that are refused throw casca::error, and then changed nothing; of moves in bulk, those that
// are not refused are made. Handles can be moved and not copied. Spans are made of anything with
// data() and size(): vectors, arrays, std::span.
#ifndef CASCA_HPP
#define CASCA_HPP

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "casca.h"

namespace casca {

// Why a call was refused.
class error : public std::runtime_error {
public:
    explicit error(casca_status status)
        : std::runtime_error(casca_last_error()), status_(status), code_(casca_last_error_code()) {}

    casca_status status() const noexcept { return status_; }

    // The library's short name of the reason, such as "eye-mismatch"; may be empty.
    const std::string &code() const noexcept { return code_; }

private:
    casca_status status_;
    std::string code_;
};

// Throws unless all went well.
inline void check(casca_status status) {
    if (status != CASCA_OK) {
        throw error(status);
    }
}

// Elements that lie one behind the other, and belong to somebody else.
template <typename T> class span {
public:
    span() = default;
    span(T *data, std::size_t size) : data_(data), size_(size) {}

    template <typename C, typename = std::enable_if_t<std::is_convertible_v<
                              decltype(std::declval<C &>().data()), T *>>>
    span(C &&container) : data_(container.data()), size_(container.size()) {}

    T *data() const noexcept { return data_; }
    std::size_t size() const noexcept { return size_; }

private:
    T *data_ = nullptr;
    std::size_t size_ = 0;
};

// A handle with an owner.
template <typename H, casca_status (*Free)(H)> class handle {
public:
    handle() = default;
    explicit handle(H of) noexcept : handle_(of) {}
    handle(handle &&other) noexcept : handle_(other.release()) {}
    handle &operator=(handle &&other) noexcept {
        if (this != &other) {
            reset();
            handle_ = other.release();
        }
        return *this;
    }
    handle(const handle &) = delete;
    handle &operator=(const handle &) = delete;
    ~handle() { reset(); }

    // The handle, for functions of casca.h.
    H get() const noexcept { return handle_; }
    explicit operator bool() const noexcept { return handle_.handle != 0; }

    // Gives the handle away: whoever takes it frees it.
    H release() noexcept { return std::exchange(handle_, H{}); }

    void reset() noexcept {
        if (handle_.handle != 0) {
            Free(release());
        }
    }

private:
    H handle_{};
};

// A struct of casca.h with its size set and all else 0.
template <typename T> T init() { return CASCA_INIT(T); }

// Shapes.
inline casca_shape sphere(float x, float y, float z, float radius) {
    casca_shape shape{};
    shape.kind = CASCA_SHAPE_SPHERE;
    shape.radius = radius;
    shape.center[0] = x, shape.center[1] = y, shape.center[2] = z;
    return shape;
}

inline casca_shape box(float x, float y, float z, float to_x, float to_y, float to_z) {
    casca_shape shape{};
    shape.kind = CASCA_SHAPE_BOX;
    shape.min[0] = x, shape.min[1] = y, shape.min[2] = z;
    shape.max[0] = to_x, shape.max[1] = to_y, shape.max[2] = to_z;
    return shape;
}

// A view from an eye in all directions.
inline casca_view omnidirectional(float x, float y, float z) {
    auto view = init<casca_view>();
    view.kind = CASCA_VIEW_OMNIDIRECTIONAL;
    view.eye[0] = x, view.eye[1] = y, view.eye[2] = z;
    return view;
}

// A perspective camera: an eye of three floats, a matrix of 16.
inline casca_view perspective(const float *eye, const float *matrix, std::uint32_t flags = 0) {
    auto view = init<casca_view>();
    view.kind = CASCA_VIEW_PERSPECTIVE;
    view.flags = flags;
    for (int i = 0; i < 3; ++i) {
        view.eye[i] = eye[i];
    }
    for (int i = 0; i < 16; ++i) {
        view.matrix[i] = matrix[i];
    }
    return view;
}

// A prepared mesh.
class mesh : public handle<casca_mesh, casca_mesh_free> {
public:
    explicit mesh(const casca_mesh_desc &desc) : handle(make(desc)) {}

    // A mesh of positions of three floats and triangles of three indices.
    mesh(span<const float> positions, span<const std::uint32_t> indices, std::uint32_t flags = 0)
        : handle(make(describe(positions, indices, flags))) {}

    static mesh load(span<const std::uint8_t> bytes) {
        casca_mesh loaded{};
        check(casca_mesh_load(bytes.data(), bytes.size(), &loaded));
        return mesh(loaded);
    }

    std::vector<std::uint8_t> save() const {
        std::size_t count = 0;
        casca_mesh_save(get(), nullptr, 0, &count);
        std::vector<std::uint8_t> bytes(count);
        check(casca_mesh_save(get(), bytes.data(), bytes.size(), &count));
        return bytes;
    }

    casca_mesh_info info() const {
        auto known = init<casca_mesh_info>();
        check(casca_mesh_get_info(get(), &known));
        return known;
    }

    // The mesh as a shape of an object.
    casca_shape shape() const {
        casca_shape shape{};
        shape.kind = CASCA_SHAPE_MESH;
        shape.mesh = get();
        return shape;
    }

private:
    explicit mesh(casca_mesh of) : handle(of) {}

    static casca_mesh make(const casca_mesh_desc &desc) {
        casca_mesh made{};
        check(casca_mesh_create(&desc, &made));
        return made;
    }

    static casca_mesh_desc describe(span<const float> positions, span<const std::uint32_t> indices,
                                    std::uint32_t flags) {
        auto desc = init<casca_mesh_desc>();
        desc.positions = positions.data();
        desc.position_count = positions.size() / 3;
        desc.indices = indices.data();
        desc.index_count = indices.size();
        desc.flags = flags;
        return desc;
    }
};

// A convex body from points of three floats.
class solid : public handle<casca_solid, casca_solid_free> {
public:
    explicit solid(span<const float> points) {
        casca_solid made{};
        check(casca_solid_create(points.data(), points.size() / 3, &made));
        static_cast<handle &>(*this) = handle(made);
    }

    casca_shape shape() const {
        casca_shape shape{};
        shape.kind = CASCA_SHAPE_SOLID;
        shape.solid = get();
        return shape;
    }
};

class query;

// Objects on a grid.
class scene : public handle<casca_scene, casca_scene_free> {
public:
    explicit scene(const casca_grid &grid) {
        casca_scene made{};
        check(casca_scene_create(&grid, &made));
        static_cast<handle &>(*this) = handle(made);
    }

    std::uint64_t add(const casca_object &object) {
        std::uint64_t id = 0;
        check(casca_scene_add(get(), &object, &id));
        return id;
    }

    // An object that stays where it is, and hides others where an occluder is given.
    std::uint64_t add_fixed(const casca_shape &bounds, const casca_shape &occluder = casca_shape{}) {
        auto object = init<casca_object>();
        object.bounds = bounds;
        object.occluder = occluder;
        return add(object);
    }

    void remove(std::uint64_t id) { check(casca_scene_remove(get(), id)); }
    void clear() { check(casca_scene_clear(get())); }
    void reserve(std::size_t count) { check(casca_scene_reserve(get(), count)); }

    void update(std::uint64_t id, const casca_shape &bounds) {
        check(casca_scene_update(get(), id, &bounds, nullptr));
    }
    void update(std::uint64_t id, const casca_shape &bounds, const casca_shape &occluder) {
        check(casca_scene_update(get(), id, &bounds, &occluder));
    }

    // Four floats x, y, z, radius for each id.
    void move_spheres(span<const std::uint64_t> ids, span<const float> spheres) {
        same(ids.size(), spheres.size(), 4);
        check(casca_scene_move_spheres(get(), ids.data(), spheres.data(), ids.size()));
    }
    // Six floats for each id.
    void move_boxes(span<const std::uint64_t> ids, span<const float> boxes) {
        same(ids.size(), boxes.size(), 6);
        check(casca_scene_move_boxes(get(), ids.data(), boxes.data(), ids.size()));
    }
    // Sixteen floats for each id.
    void set_transforms(span<const std::uint64_t> ids, span<const float> transforms,
                        std::uint32_t flags = 0) {
        same(ids.size(), transforms.size(), 16);
        check(casca_scene_set_transforms(get(), ids.data(), transforms.data(), ids.size(), flags));
    }

    bool contains(std::uint64_t id) const {
        bool answer = false;
        check(casca_scene_contains(get(), id, &answer));
        return answer;
    }

    std::vector<std::uint64_t> ids() const {
        return list([this](std::uint64_t *to, std::size_t capacity, std::size_t *count) {
            return casca_scene_get_ids(get(), to, capacity, count);
        });
    }

    std::vector<std::uint64_t> user_data(span<const std::uint64_t> ids) const {
        std::vector<std::uint64_t> found(ids.size());
        check(casca_scene_get_user_data(get(), ids.data(), ids.size(), found.data()));
        return found;
    }

    // Begins a frame and gives the objects that are due for a report.
    std::vector<std::uint64_t> begin_frame(double seconds) {
        check(casca_scene_begin_frame(get(), seconds, nullptr));
        return list([this](std::uint64_t *to, std::size_t capacity, std::size_t *count) {
            return casca_scene_get_due(get(), to, capacity, count);
        });
    }

    casca_frame_report end_frame(span<const casca_query> queries) {
        auto report = init<casca_frame_report>();
        check(casca_scene_end_frame(get(), queries.data(), queries.size(), &report));
        return report;
    }

    casca_memory memory() const {
        auto used = init<casca_memory>();
        check(casca_scene_get_memory(get(), &used));
        return used;
    }

    // Calls a function that fills a span of ids until there is room for all.
    template <typename Fill> static std::vector<std::uint64_t> list(Fill fill) {
        std::vector<std::uint64_t> found(256);
        std::size_t count = 0;
        casca_status status = fill(found.data(), found.size(), &count);
        while (status == CASCA_ERROR_TOO_SMALL) {
            found.resize(count);
            status = fill(found.data(), found.size(), &count);
        }
        check(status);
        found.resize(count);
        return found;
    }

private:
    static void same(std::size_t ids, std::size_t floats, std::size_t each) {
        if (floats / each != ids || floats % each != 0) {
            throw std::invalid_argument("casca: one shape is needed for each id");
        }
    }
};

// Finds what one camera or light can see.
class query : public handle<casca_query, casca_query_free> {
public:
    query() : query(init<casca_query_options>()) {}
    explicit query(const casca_query_options &options) {
        casca_query made{};
        check(casca_query_create(&options, &made));
        static_cast<handle &>(*this) = handle(made);
    }

    // Finds what a view can see, and returns how many objects that are.
    std::size_t run(const scene &in, const casca_view &view) {
        std::size_t count = 0;
        check(casca_query_run(get(), in.get(), &view, &count));
        return count;
    }

    // The casters of the shadows of a light onto what a camera saw last.
    std::size_t shadow_casters(const scene &in, const query &camera, const casca_light &light) {
        std::size_t count = 0;
        check(casca_query_shadow_casters(get(), in.get(), camera.get(), &light, &count));
        return count;
    }

    // The ids that the last run found.
    std::vector<std::uint64_t> visible() const {
        return scene::list([this](std::uint64_t *to, std::size_t capacity, std::size_t *count) {
            return casca_query_get_visible(get(), to, capacity, count);
        });
    }

    bool contains(const scene &in, std::uint64_t id) const {
        bool answer = false;
        check(casca_query_contains(get(), in.get(), id, &answer));
        return answer;
    }

    bool is_valid(const scene &in, const casca_view &view) const {
        bool answer = false;
        check(casca_query_is_valid(get(), in.get(), &view, &answer));
        return answer;
    }

    // One answer for each point of three floats: 0 is surely hidden.
    std::vector<std::uint8_t> may_see_points(const scene &in, span<const float> points) const {
        std::vector<std::uint8_t> answers(points.size() / 3);
        check(casca_query_may_see_points(get(), in.get(), points.data(), answers.size(),
                                         answers.data()));
        return answers;
    }

    // One answer for each box of six floats.
    std::vector<std::uint8_t> may_see_boxes(const scene &in, span<const float> boxes) const {
        std::vector<std::uint8_t> answers(boxes.size() / 6);
        check(casca_query_may_see_boxes(get(), in.get(), boxes.data(), answers.size(),
                                        answers.data()));
        return answers;
    }

    casca_stats stats() const {
        auto work = init<casca_stats>();
        check(casca_query_get_stats(get(), &work));
        return work;
    }

    void reset_runs() { check(casca_query_reset(get())); }
};

// The work of finding a new result for a kept query, on any thread.
class job : public handle<casca_job, casca_job_free> {
public:
    job(query &of, const scene &in, const casca_view &view) {
        casca_job made{};
        check(casca_query_prepare(of.get(), in.get(), &view, &made));
        static_cast<handle &>(*this) = handle(made);
    }

    void run() { check(casca_job_run(get())); }

    // Gives the result to the query; the job is empty then.
    bool install(query &to, const scene &in) {
        bool taken = false;
        check(casca_query_install(to.get(), in.get(), get(), &taken));
        release();
        return taken;
    }
};

// Objects in the plane, and queries there; for the rest call casca.h.
class plane : public handle<casca_plane, casca_plane_free> {
public:
    explicit plane(const casca_plane_grid &grid) {
        casca_plane made{};
        check(casca_plane_create(&grid, &made));
        static_cast<handle &>(*this) = handle(made);
    }

    std::uint64_t add(const casca_plane_object &object) {
        std::uint64_t id = 0;
        check(casca_plane_add(get(), &object, &id));
        return id;
    }
};

class plane_query : public handle<casca_plane_query, casca_plane_query_free> {
public:
    plane_query() {
        casca_plane_query made{};
        check(casca_plane_query_create(&made));
        static_cast<handle &>(*this) = handle(made);
    }

    std::vector<std::uint64_t> run(const plane &in, const casca_plane_view &view) {
        check(casca_plane_query_run(get(), in.get(), &view, nullptr));
        return scene::list([this](std::uint64_t *to, std::size_t capacity, std::size_t *count) {
            return casca_plane_query_get_visible(get(), to, capacity, count);
        });
    }
};

}  // namespace casca

#endif  // CASCA_HPP
