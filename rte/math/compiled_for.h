// The processors that this source file is compiled for, by the macros of the compiler.
#pragma once

namespace miebrdf {

// The linkage is internal: libraries and programs may be compiled for different ones.
#if defined(__AVX512F__) && defined(__AVX512BW__) && defined(__AVX512CD__) && \
    defined(__AVX512DQ__) && defined(__AVX512VL__)
static constexpr char kCompiledFor[] = "x86-64-v4";
#elif defined(__AVX2__) && defined(__FMA__) && defined(__BMI2__)
static constexpr char kCompiledFor[] = "x86-64-v3";
#elif defined(__SSE4_2__) && defined(__POPCNT__)
static constexpr char kCompiledFor[] = "x86-64-v2";
#elif defined(__x86_64__)
static constexpr char kCompiledFor[] = "x86-64";
#elif defined(__aarch64__)
static constexpr char kCompiledFor[] = "aarch64";
#else
static constexpr char kCompiledFor[] = "generic";
#endif

}  // namespace miebrdf
