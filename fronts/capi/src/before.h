#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A struct with its size set and all else 0: casca_view view = CASCA_INIT(casca_view); */
#ifdef __cplusplus
template <typename T> inline T casca_init_of() {
    T value{};
    value.size = sizeof(T);
    return value;
}
#define CASCA_INIT(type) casca_init_of<type>()
#else
#define CASCA_INIT(type) {.size = sizeof(type)}
#endif
