// Functions of C that meshopt 0.7 calls and its own headers for WebAssembly lack. Rust's library
// has floorf, ceilf, log2f, cosf and ldexpf; nothing in the page calls what needs frexpf.
#pragma once
#ifdef __cplusplus
extern "C" {
#endif
float floorf(float);
float ceilf(float);
float log2f(float);
float ldexpf(float, int);
float cosf(float);
float frexpf(float, int *);
#ifdef __cplusplus
}
#endif
