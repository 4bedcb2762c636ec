// Stands in for Godot: gives the extension the functions that it asks for, makes an object of its
// class and calls its methods as the engine does. It needs gdextension_interface.h.
#include "../../examples/godot/casca_godot.cpp"

#include <cstdio>
#include <map>
#include <string>

#include "check.h"

namespace host {

// Variants of this host: a type, and the value in a buffer.
struct Variant {
    GDExtensionVariantType type = GDEXTENSION_VARIANT_TYPE_NIL;
    std::vector<char> value;
};

struct Method {
    GDExtensionClassMethodCall call;
    GDExtensionClassMethodPtrCall ptrcall;
};

std::map<std::string, Method> methods;
GDExtensionClassCreationInfo2 made_class;
void *instance = nullptr;
int errors = 0, names = 0, arrays = 0;

std::string *&name_at(const void *at) { return *static_cast<std::string **>(const_cast<void *>(at)); }
std::vector<std::int64_t> *&array_at(const void *at) {
    return *static_cast<std::vector<std::int64_t> **>(const_cast<void *>(at));
}
// The pointer that a function of the engine is given, whatever its header calls the type.
template <typename P> void *plain(P *at) { return const_cast<void *>(static_cast<const void *>(at)); }

std::size_t size_of(GDExtensionVariantType type) {
    switch (type) {
    case GDEXTENSION_VARIANT_TYPE_BOOL: return 1;
    case GDEXTENSION_VARIANT_TYPE_INT:
    case GDEXTENSION_VARIANT_TYPE_FLOAT: return 8;
    case GDEXTENSION_VARIANT_TYPE_AABB: return 24;
    case GDEXTENSION_VARIANT_TYPE_TRANSFORM3D: return 48;
    case GDEXTENSION_VARIANT_TYPE_PROJECTION: return 64;
    default: return 16;
    }
}

template <GDExtensionVariantType T> GDExtensionVariantFromTypeConstructorFunc from() {
    return [](GDExtensionUninitializedVariantPtr to, GDExtensionTypePtr value) {
        auto &variant = *static_cast<Variant *>(plain(to));
        variant.type = T;
        const char *bytes = static_cast<char *>(plain(value));
        if (T == GDEXTENSION_VARIANT_TYPE_PACKED_INT64_ARRAY) {
            auto *copy = new std::vector<std::int64_t>(*array_at(bytes));
            ++arrays;
            variant.value.resize(sizeof copy);
            std::memcpy(variant.value.data(), &copy, sizeof copy);
        } else {
            variant.value.assign(bytes, bytes + size_of(T));
        }
    };
}

GDExtensionVariantFromTypeConstructorFunc from_type(GDExtensionVariantType type) {
    switch (type) {
    case GDEXTENSION_VARIANT_TYPE_BOOL: return from<GDEXTENSION_VARIANT_TYPE_BOOL>();
    case GDEXTENSION_VARIANT_TYPE_INT: return from<GDEXTENSION_VARIANT_TYPE_INT>();
    default: return from<GDEXTENSION_VARIANT_TYPE_PACKED_INT64_ARRAY>();
    }
}

GDExtensionTypeFromVariantConstructorFunc to_type(GDExtensionVariantType) {
    return [](GDExtensionUninitializedTypePtr to, GDExtensionVariantPtr from) {
        const auto &variant = *static_cast<Variant *>(plain(from));
        std::memcpy(plain(to), variant.value.data(), variant.value.size());
    };
}

GDExtensionPtrConstructor constructor(GDExtensionVariantType, std::int32_t) {
    return [](GDExtensionUninitializedTypePtr to, const GDExtensionConstTypePtr *) {
        array_at(plain(to)) = new std::vector<std::int64_t>();
        ++arrays;
    };
}

GDExtensionPtrDestructor destructor(GDExtensionVariantType type) {
    if (type == GDEXTENSION_VARIANT_TYPE_STRING_NAME) {
        return [](GDExtensionTypePtr at) { delete name_at(plain(at)), --names; };
    }
    return [](GDExtensionTypePtr at) { delete array_at(plain(at)), --arrays; };
}

GDExtensionPtrBuiltInMethod builtin(GDExtensionVariantType, GDExtensionConstStringNamePtr name, GDExtensionInt hash) {
    CHECK(*name_at(plain(name)) == "resize" && hash == 848867239);
    return [](GDExtensionTypePtr base, const GDExtensionConstTypePtr *from, GDExtensionTypePtr, int count) {
        CHECK(count == 1);
        array_at(plain(base))->resize(std::size_t(*static_cast<std::int64_t *>(plain(from[0]))));
    };
}

template <typename F> GDExtensionInterfaceFunctionPtr function(F f) {
    return reinterpret_cast<GDExtensionInterfaceFunctionPtr>(f);
}

GDExtensionInterfaceFunctionPtr get(const char *asked) {
    const std::string name = asked;
    if (name == "string_name_new_with_latin1_chars") {
        return function(+[](GDExtensionUninitializedStringNamePtr to, const char *text, GDExtensionBool) {
            name_at(plain(to)) = new std::string(text);
            ++names;
        });
    }
    if (name == "classdb_construct_object") {
        return function(+[](GDExtensionConstStringNamePtr of) -> GDExtensionObjectPtr {
            CHECK(*name_at(plain(of)) == "RefCounted");
            return nullptr;
        });
    }
    if (name == "object_set_instance") {
        return function(+[](GDExtensionObjectPtr, GDExtensionConstStringNamePtr of, GDExtensionClassInstancePtr at) {
            CHECK(*name_at(plain(of)) == "CascaCulling");
            instance = plain(at);
        });
    }
    if (name == "classdb_register_extension_class2") {
        return function(+[](GDExtensionClassLibraryPtr, GDExtensionConstStringNamePtr, GDExtensionConstStringNamePtr,
                            const GDExtensionClassCreationInfo2 *info) { made_class = *info; });
    }
    if (name == "classdb_unregister_extension_class") {
        return function(+[](GDExtensionClassLibraryPtr, GDExtensionConstStringNamePtr) { methods.clear(); });
    }
    if (name == "classdb_register_extension_class_method") {
        return function(+[](GDExtensionClassLibraryPtr, GDExtensionConstStringNamePtr,
                            const GDExtensionClassMethodInfo *info) {
            methods[*name_at(plain(info->name))] = {info->call_func, info->ptrcall_func};
        });
    }
    if (name == "print_error") {
        return function(+[](const char *, const char *, const char *, std::int32_t, GDExtensionBool) { ++errors; });
    }
    if (name == "variant_get_type") {
        return function(+[](GDExtensionConstVariantPtr at) { return static_cast<Variant *>(plain(at))->type; });
    }
    if (name == "variant_can_convert_strict") {
        return function(+[](GDExtensionVariantType a, GDExtensionVariantType b) -> GDExtensionBool { return a == b; });
    }
    if (name == "get_variant_from_type_constructor") return function(from_type);
    if (name == "get_variant_to_type_constructor") return function(to_type);
    if (name == "variant_get_ptr_constructor") return function(constructor);
    if (name == "variant_get_ptr_destructor") return function(destructor);
    if (name == "variant_get_ptr_builtin_method") return function(builtin);
    if (name == "packed_int64_array_operator_index") {
        return function(+[](GDExtensionTypePtr at, GDExtensionInt i) {
            return array_at(plain(at))->data() + i;
        });
    }
    return nullptr;
}

// Calls a method with typed values.
template <typename R, typename... A> R ptrcall(const char *name, R result, A... values) {
    const GDExtensionConstTypePtr from[] = {Any{&values}...};
    methods.at(name).ptrcall(nullptr, Any{instance}, from, Any{&result});
    return result;
}

}  // namespace host

int main() {
    using host::ptrcall;
    GDExtensionInitialization how{};
    CHECK(!casca_godot_init([](const char *) -> GDExtensionInterfaceFunctionPtr { return nullptr; }, nullptr, &how));
    CHECK(casca_godot_init(host::get, nullptr, &how));
    for (int level = 0; level < GDEXTENSION_MAX_INITIALIZATION_LEVEL; ++level) {
        how.initialize(nullptr, GDExtensionInitializationLevel(level));
    }
    CHECK(host::methods.size() == 5);
    host::made_class.create_instance_func(nullptr);
    const GDExtensionBool no = 0, yes = 1;
    const std::int64_t none = 0;

    // A wall at z = -10 before a ball at z = -20; the camera looks along -z.
    CHECK(ptrcall("add", none, Aabb{{0, 0, 0}, {1, 1, 1}}, no, no) == 0 && host::errors == 1);
    CHECK(ptrcall("setup", no, Aabb{{-32, -32, -32}, {64, 64, 64}}, 1.0) == yes);
    const Aabb wall{{-20, -20, -11}, {40, 40, 1}}, ball{{-1, -1, -21}, {2, 2, 2}};
    const auto wall_id = ptrcall("add", none, wall, yes, no);
    const auto ball_id = ptrcall("add", none, ball, no, yes);
    CHECK(wall_id != 0 && ball_id != 0);
    const Transform3D camera{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0.5f, 0.5f, 3.5f}};
    // 90 degrees, near 0.1, far 100, depth from -1 to 1, as Camera3D has it.
    const float near = 0.1f, far = 100.0f;
    const Projection projection{{{1, 0, 0, 0},
                                 {0, 1, 0, 0},
                                 {0, 0, -(far + near) / (far - near), -1},
                                 {0, 0, -2 * far * near / (far - near), 0}}};
    PackedInt64Array seen;
    host::array_at(&seen) = new std::vector<std::int64_t>();
    const GDExtensionConstTypePtr from[] = {Any{new double(0.0)}, Any{&camera}, Any{&projection}};
    host::methods.at("visible").ptrcall(nullptr, Any{host::instance}, from, Any{&seen});
    CHECK(*host::array_at(&seen) == std::vector<std::int64_t>{wall_id});
    // What is refused hides nothing.
    const Transform3D nowhere{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0.0f / 0.0f, 0, 0}};
    const GDExtensionConstTypePtr lost[] = {from[0], Any{&nowhere}, from[2]};
    host::methods.at("visible").ptrcall(nullptr, Any{host::instance}, lost, Any{&seen});
    CHECK(host::array_at(&seen)->size() == 2 && host::errors == 2);
    CHECK(ptrcall("move", no, ball_id, Aabb{{-1, -1, -6}, {2, 2, 2}}, no) == yes);
    host::methods.at("visible").ptrcall(nullptr, Any{host::instance}, from, Any{&seen});
    CHECK(host::array_at(&seen)->size() == 2 && host::array_at(&seen)->back() == ball_id);
    delete static_cast<double *>(host::plain(from[0]));
    delete host::array_at(&seen);
    CHECK(ptrcall("remove", no, ball_id) == yes && ptrcall("remove", no, ball_id) == no);
    CHECK(host::errors == 3);

    // The same by variants, and calls with wrong arguments.
    std::vector<host::Variant> values(3);
    const double now = 1.0;
    auto value = [&](std::size_t i, GDExtensionVariantType type, const void *at) {
        const char *bytes = static_cast<const char *>(at);
        values[i].type = type;
        values[i].value.assign(bytes, bytes + host::size_of(type));
    };
    value(0, GDEXTENSION_VARIANT_TYPE_FLOAT, &now);
    value(1, GDEXTENSION_VARIANT_TYPE_TRANSFORM3D, &camera);
    value(2, GDEXTENSION_VARIANT_TYPE_PROJECTION, &projection);
    const GDExtensionConstVariantPtr variants[] = {Any{&values[0]}, Any{&values[1]}, Any{&values[2]}};
    host::Variant result;
    GDExtensionCallError error{};
    const auto call = host::methods.at("visible").call;
    call(nullptr, Any{host::instance}, variants, 3, Any{&result}, &error);
    CHECK(error.error == GDEXTENSION_CALL_OK && host::array_at(result.value.data())->size() == 1);
    delete host::array_at(result.value.data()), --host::arrays;
    call(nullptr, Any{host::instance}, variants, 2, Any{&result}, &error);
    CHECK(error.error == GDEXTENSION_CALL_ERROR_TOO_FEW_ARGUMENTS && error.expected == 3);
    std::swap(values[0], values[1]);
    call(nullptr, Any{host::instance}, variants, 3, Any{&result}, &error);
    CHECK(error.error == GDEXTENSION_CALL_ERROR_INVALID_ARGUMENT && error.argument == 0);

    host::made_class.free_instance_func(nullptr, Any{host::instance});
    for (int level = GDEXTENSION_MAX_INITIALIZATION_LEVEL; level-- > 0;) {
        how.deinitialize(nullptr, GDExtensionInitializationLevel(level));
    }
    CHECK(host::methods.empty() && host::names == 0 && host::arrays == 0);
    std::puts("the extension for Godot: ok");
}
