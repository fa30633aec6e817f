// What a SCATFUN Fourier file holds, read without trusting it.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "pipeline/formats/readers/byte_reader.h"

namespace miebrdf::exports {

/// A pair's Fourier series: `length` numbers for each channel from `offset` on.
struct ScatfunSeries {
    std::uint32_t offset = 0;
    std::uint32_t length = 0;
};

struct ScatfunTables {
    std::vector<float> nodes;  ///< cosines, ascending
    RealView<float> cdf;       ///< these two where they are in the file
    RealView<float> coefficients;
    std::vector<ScatfunSeries> series;  ///< row = camera, column = light
    std::uint32_t longest = 0;
    std::uint32_t channels = 0;
};

inline constexpr std::string_view kScatfunMagic("SCATFUN\x01", 8);

/// @param content  outlives the result
/// @throws InputError  for anything that pbrt-v3 would refuse or misread
ScatfunTables read_scatfun_tables(std::string_view content);

}  // namespace miebrdf::exports
