// A Godot 4 extension: the class CascaCulling, which tells a scene what its camera can see.
//
//     var culling := CascaCulling.new()
//     culling.setup(AABB(Vector3(-50, 0, -50), Vector3(100, 20, 100)), 1.0)
//     var wall_box := wall.global_transform * wall.get_aabb()   # in world space
//     var id := culling.add(wall_box, true, false)              # hides; does not move
//     var tree_id := culling.add(tree.global_transform * tree.get_aabb(), false, false)
//     ...
//     var seen := culling.visible(Time.get_ticks_usec() / 1e6,
//             camera.get_camera_transform(), camera.get_camera_projection())
//
// A box that hides, hides with all of it: let only that hide which fills its box, opaque and drawn,
// such as a block whose sides lie along the axes, never the box around a house or a tree.
//
// It needs gdextension_interface.h alone, which `godot --dump-gdextension-interface` writes, of
// Godot 4.2 or newer, in single precision. Build it by the CMakeLists.txt beside it.
#include <casca.hpp>
#include <gdextension_interface.h>

#include <cstring>
#include <memory>
#include <utility>

namespace {

// Godot's types, as they lie in memory.
struct Vector3 {
    float x, y, z;
};
struct Aabb {
    Vector3 position, size;
};
struct Transform3D {
    float rows[3][3];
    Vector3 origin;
};
struct Projection {
    float columns[4][4];
};
using Ids = std::vector<std::int64_t>;
struct StringName {
    void *data = nullptr;
};
struct PackedInt64Array {
    void *data[2] = {};
};

// The functions of the engine that this extension calls.
struct Engine {
    GDExtensionClassLibraryPtr library;
    GDExtensionInterfaceStringNameNewWithLatin1Chars new_name;
    GDExtensionInterfaceClassdbConstructObject construct;
    GDExtensionInterfaceObjectSetInstance set_instance;
    GDExtensionInterfaceClassdbRegisterExtensionClass2 register_class;
    GDExtensionInterfaceClassdbUnregisterExtensionClass unregister_class;
    GDExtensionInterfaceClassdbRegisterExtensionClassMethod register_method;
    GDExtensionInterfacePrintError print_error;
    GDExtensionInterfaceVariantGetType variant_type;
    GDExtensionInterfaceVariantCanConvertStrict can_convert;
    GDExtensionInterfaceGetVariantFromTypeConstructor from_type;
    GDExtensionInterfaceGetVariantToTypeConstructor to_type;
    GDExtensionInterfaceVariantGetPtrConstructor constructor;
    GDExtensionInterfaceVariantGetPtrDestructor destructor;
    GDExtensionInterfaceVariantGetPtrBuiltinMethod builtin;
    GDExtensionInterfacePackedInt64ArrayOperatorIndex at;
} engine;

// A pointer that becomes what a function of the engine takes: headers differ in their types.
struct Any {
    const void *at;
    template <typename T> operator T *() const {
        return static_cast<T *>(const_cast<void *>(at));
    }
};

// A name of the engine's, which lives until it is let go.
class Name {
public:
    explicit Name(const char *text) { engine.new_name(Any{&name}, text, false); }
    Name(const Name &) = delete;
    Name &operator=(const Name &) = delete;
    ~Name() { engine.destructor(GDEXTENSION_VARIANT_TYPE_STRING_NAME)(Any{&name}); }
    Any get() const { return {&name}; }

private:
    StringName name;
};

// The class itself.
class Culling {
public:
    GDExtensionBool setup(Aabb region, double cell) {
        return tell([&] {
            auto grid = casca::init<casca_grid>();
            set(grid.min, region.position);
            set(grid.max, end(region));
            grid.cell = float(cell);
            scene = std::make_unique<casca::scene>(grid);
            query = std::make_unique<casca::query>();
        });
    }

    // An object in a box of the world. Returns its id, 0 if it was refused.
    std::int64_t add(Aabb bounds, GDExtensionBool hides, GDExtensionBool moves) {
        std::uint64_t id = 0;
        tell([&] {
            auto object = casca::init<casca_object>();
            object.bounds = shape(bounds);
            object.occluder = hides ? object.bounds : casca_shape{};
            object.flags = moves ? CASCA_MOVES : 0;
            id = ready().add(object);
        });
        return std::int64_t(id);
    }

    // Moves an object, with its occluder if it hides.
    GDExtensionBool move(std::int64_t id, Aabb bounds, GDExtensionBool hides) {
        return tell([&] {
            const auto to = shape(bounds);
            hides ? ready().update(std::uint64_t(id), to, to) : ready().update(std::uint64_t(id), to);
        });
    }

    GDExtensionBool remove(std::int64_t id) {
        return tell([&] { ready().remove(std::uint64_t(id)); });
    }

    // One frame: the ids of all objects that a camera can see, roughly from near to far. Of all objects,
    // if the time or the camera is refused.
    Ids visible(double seconds, Transform3D camera, Projection projection) {
        Ids found;
        const auto is_known = tell([&] {
            auto view = view_of(camera, projection);
            ready().begin_frame(seconds);
            query->run(*scene, view);
            const auto ids = query->visible();
            found.assign(ids.begin(), ids.end());
            const casca_query all[] = {query->get()};
            scene->end_frame(casca::span<const casca_query>(all, 1));
        });
        if (!is_known && scene) {
            tell([&] {
                const auto ids = scene->ids();
                found.assign(ids.begin(), ids.end());
            });
        }
        return found;
    }

private:
    std::unique_ptr<casca::scene> scene;
    std::unique_ptr<casca::query> query;

    casca::scene &ready() {
        if (!scene) throw std::logic_error("call setup first");
        return *scene;
    }

    // Runs calls of casca; what is refused becomes an error in Godot's console.
    template <typename Calls> static GDExtensionBool tell(Calls calls) {
        try {
            calls();
            return true;
        } catch (const std::exception &refused) {
            engine.print_error(refused.what(), "CascaCulling", __FILE__, __LINE__, true);
            return false;
        }
    }

    static void set(float *to, Vector3 from) { to[0] = from.x, to[1] = from.y, to[2] = from.z; }

    static Vector3 end(Aabb box) {
        return {box.position.x + box.size.x, box.position.y + box.size.y, box.position.z + box.size.z};
    }

    static casca_shape shape(Aabb box) {
        const Vector3 to = end(box);
        return casca::box(box.position.x, box.position.y, box.position.z, to.x, to.y, to.z);
    }

    // A camera's transform has axes at right angles of length 1, so that its inverse is its
    // transpose. Depth of Camera3D's projection runs from -1 to 1.
    static casca_view view_of(const Transform3D &camera, const Projection &projection) {
        auto view = casca::init<casca_view>();
        const bool is_perspective = projection.columns[2][3] != 0.0f;
        view.kind = is_perspective ? CASCA_VIEW_PERSPECTIVE : CASCA_VIEW_ORTHOGRAPHIC;
        view.flags = CASCA_DEPTH_MINUS_ONE;
        const float eye[3] = {camera.origin.x, camera.origin.y, camera.origin.z};
        double inverse[4][4] = {};  // by rows
        for (int i = 0; i < 3; ++i) {
            view.eye[i] = eye[i];
            view.forward[i] = -camera.rows[i][2];
            for (int j = 0; j < 3; ++j) {
                inverse[i][j] = camera.rows[j][i];
                inverse[i][3] -= double(camera.rows[j][i]) * double(eye[j]);
            }
        }
        inverse[3][3] = 1.0;
        for (int row = 0; row < 4; ++row) {
            for (int column = 0; column < 4; ++column) {
                double sum = 0.0;
                for (int k = 0; k < 4; ++k) sum += double(projection.columns[k][row]) * inverse[k][column];
                view.matrix[4 * column + row] = float(sum);
            }
        }
        return view;
    }
};

// How types of C++ are called in Godot.
template <typename T> constexpr GDExtensionVariantType type_of = GDEXTENSION_VARIANT_TYPE_NIL;
template <> constexpr auto type_of<GDExtensionBool> = GDEXTENSION_VARIANT_TYPE_BOOL;
template <> constexpr auto type_of<std::int64_t> = GDEXTENSION_VARIANT_TYPE_INT;
template <> constexpr auto type_of<double> = GDEXTENSION_VARIANT_TYPE_FLOAT;
template <> constexpr auto type_of<Aabb> = GDEXTENSION_VARIANT_TYPE_AABB;
template <> constexpr auto type_of<Transform3D> = GDEXTENSION_VARIANT_TYPE_TRANSFORM3D;
template <> constexpr auto type_of<Projection> = GDEXTENSION_VARIANT_TYPE_PROJECTION;
template <> constexpr auto type_of<Ids> = GDEXTENSION_VARIANT_TYPE_PACKED_INT64_ARRAY;

// Writes a result to where the engine wants it: a value that it made before.
template <typename T> void give(void *to, const T &value) { *static_cast<T *>(to) = value; }
void give(void *to, const Ids &ids) {
    static const std::int64_t hash = 848867239;  // of extension_api.json
    Name resize("resize");
    std::int64_t size = std::int64_t(ids.size()), done = 0;
    const GDExtensionConstTypePtr arguments[] = {Any{&size}};
    engine.builtin(GDEXTENSION_VARIANT_TYPE_PACKED_INT64_ARRAY, resize.get(), hash)(Any{to}, arguments, Any{&done}, 1);
    if (!ids.empty()) std::memcpy(engine.at(Any{to}, 0), ids.data(), ids.size() * sizeof ids[0]);
}

template <typename T> void give_variant(void *to, T value) { engine.from_type(type_of<T>)(Any{to}, Any{&value}); }
void give_variant(void *to, const Ids &ids) {
    const auto type = type_of<Ids>;
    PackedInt64Array array;
    engine.constructor(type, 0)(Any{&array}, nullptr);
    give(&array, ids);
    engine.from_type(type)(Any{to}, Any{&array});
    engine.destructor(type)(Any{&array});
}

// A method as the engine calls it, with typed values and with variants.
template <auto Method> struct Bound;
template <typename R, typename... A, R (Culling::*Method)(A...)> struct Bound<Method> {
    static constexpr std::size_t count = sizeof...(A);
    static constexpr GDExtensionVariantType types[] = {type_of<A>...};

    template <std::size_t... I>
    static void typed(Culling *self, const GDExtensionConstTypePtr *from, void *to, std::index_sequence<I...>) {
        give(to, (self->*Method)(*static_cast<const A *>(Any{from[I]})...));
    }
    static void ptrcall(void *, GDExtensionClassInstancePtr self, const GDExtensionConstTypePtr *from,
                        GDExtensionTypePtr to) {
        typed(Any{self}, from, Any{to}, std::make_index_sequence<count>());
    }

    template <typename T> static T read(GDExtensionConstVariantPtr from) {
        T value{};
        engine.to_type(type_of<T>)(Any{&value}, Any{from});
        return value;
    }
    template <std::size_t... I>
    static void untyped(Culling *self, const GDExtensionConstVariantPtr *from, void *to, std::index_sequence<I...>) {
        give_variant(to, (self->*Method)(read<A>(from[I])...));
    }
    static void call(void *, GDExtensionClassInstancePtr self, const GDExtensionConstVariantPtr *from,
                     GDExtensionInt given, GDExtensionVariantPtr to, GDExtensionCallError *error) {
        error->error = GDEXTENSION_CALL_OK;
        if (given != GDExtensionInt(count)) {
            error->error = given < GDExtensionInt(count) ? GDEXTENSION_CALL_ERROR_TOO_FEW_ARGUMENTS
                                                         : GDEXTENSION_CALL_ERROR_TOO_MANY_ARGUMENTS;
            error->expected = int(count);
            return;
        }
        for (std::size_t i = 0; i < count; ++i) {
            if (!engine.can_convert(engine.variant_type(from[i]), types[i])) {
                *error = {GDEXTENSION_CALL_ERROR_INVALID_ARGUMENT, int(i), int(types[i])};
                return;
            }
        }
        untyped(Any{self}, from, Any{to}, std::make_index_sequence<count>());
    }

    static void add(const char *text) {
        Name class_name("CascaCulling"), name(text), empty("");
        StringName no_hint;  // an empty String is null, too
        GDExtensionPropertyInfo result{type_of<R>, empty.get(), empty.get(), 0, Any{&no_hint}, 6};
        GDExtensionPropertyInfo arguments[count];
        GDExtensionClassMethodArgumentMetadata metadata[count] = {};
        for (std::size_t i = 0; i < count; ++i) arguments[i] = {types[i], empty.get(), empty.get(), 0, Any{&no_hint}, 6};
        GDExtensionClassMethodInfo info{};
        info.name = name.get();
        info.call_func = call;
        info.ptrcall_func = ptrcall;
        info.method_flags = GDEXTENSION_METHOD_FLAGS_DEFAULT;
        info.has_return_value = true;
        info.return_value_info = &result;
        info.argument_count = std::uint32_t(count);
        info.arguments_info = arguments;
        info.arguments_metadata = metadata;
        engine.register_method(engine.library, class_name.get(), &info);
    }
};

GDExtensionObjectPtr create(void *) {
    Name base("RefCounted"), class_name("CascaCulling");
    GDExtensionObjectPtr object = engine.construct(base.get());
    engine.set_instance(object, class_name.get(), Any{new Culling()});
    return object;
}

void destroy(void *, GDExtensionClassInstancePtr instance) {
    delete static_cast<Culling *>(Any{instance});
}

void initialize(void *, GDExtensionInitializationLevel level) {
    if (level != GDEXTENSION_INITIALIZATION_SCENE) return;
    Name class_name("CascaCulling"), base("RefCounted");
    GDExtensionClassCreationInfo2 info{};
    info.is_exposed = true;
    info.create_instance_func = create;
    info.free_instance_func = destroy;
    engine.register_class(engine.library, class_name.get(), base.get(), &info);
    Bound<&Culling::setup>::add("setup");
    Bound<&Culling::add>::add("add");
    Bound<&Culling::move>::add("move");
    Bound<&Culling::remove>::add("remove");
    Bound<&Culling::visible>::add("visible");
}

void deinitialize(void *, GDExtensionInitializationLevel level) {
    if (level != GDEXTENSION_INITIALIZATION_SCENE) return;
    Name class_name("CascaCulling");
    engine.unregister_class(engine.library, class_name.get());
}

// Finds a function of the engine; false if it has none of that name.
template <typename F> bool find(GDExtensionInterfaceGetProcAddress get, F &to, const char *name) {
    to = reinterpret_cast<F>(get(name));
    return to != nullptr;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) GDExtensionBool casca_godot_init(
    GDExtensionInterfaceGetProcAddress get, GDExtensionClassLibraryPtr library,
    GDExtensionInitialization *initialization) {
    engine.library = library;
    initialization->minimum_initialization_level = GDEXTENSION_INITIALIZATION_SCENE;
    initialization->initialize = initialize;
    initialization->deinitialize = deinitialize;
    return find(get, engine.new_name, "string_name_new_with_latin1_chars") &&
           find(get, engine.construct, "classdb_construct_object") &&
           find(get, engine.set_instance, "object_set_instance") &&
           find(get, engine.register_class, "classdb_register_extension_class2") &&
           find(get, engine.unregister_class, "classdb_unregister_extension_class") &&
           find(get, engine.register_method, "classdb_register_extension_class_method") &&
           find(get, engine.print_error, "print_error") &&
           find(get, engine.variant_type, "variant_get_type") &&
           find(get, engine.can_convert, "variant_can_convert_strict") &&
           find(get, engine.from_type, "get_variant_from_type_constructor") &&
           find(get, engine.to_type, "get_variant_to_type_constructor") &&
           find(get, engine.constructor, "variant_get_ptr_constructor") &&
           find(get, engine.destructor, "variant_get_ptr_destructor") &&
           find(get, engine.builtin, "variant_get_ptr_builtin_method") &&
           find(get, engine.at, "packed_int64_array_operator_index");
}
