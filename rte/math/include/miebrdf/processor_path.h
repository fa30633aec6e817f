// For which processors the arithmetic was compiled. docs/dependencies.md#processors
#pragma once

#include <string_view>

#pragma GCC visibility push(default)
namespace miebrdf {

/// The path in use: "x86-64", or its levels "x86-64-v2" (SSE4.2), "x86-64-v3" (AVX2, FMA) and
/// "x86-64-v4" (AVX-512); "aarch64", whose NEON every such processor has; "generic" elsewhere. A
/// build for the machine at hand (-march=native) has the name of the highest level that it
/// contains.
///
/// Results have the same bits wherever the path is the same; between paths they differ by rounding,
/// far within the tolerance.
std::string_view processor_path();

}  // namespace miebrdf
#pragma GCC visibility pop
