// Spectra in pieces of sixteen wavelengths: a register of AVX-512, two of AVX2.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "pipeline/render/cubic_taps.h"

namespace miebrdf::render {

/// Single precision: relative rounding of 1e-7 is far below what interpolation loses.
using Lane = Eigen::Array<float, 16, 1>;
inline constexpr std::size_t kLaneWidth = 16;

inline std::size_t lanes_for(std::size_t wavelengths) {
    return (wavelengths + kLaneWidth - 1) / kLaneWidth;
}

inline Eigen::Map<const Lane> lane_at(const float* values) {
    return Eigen::Map<const Lane>(values);
}

/// A lane of a table whose rows, `stride` apart, are spectra.
/// @param rows  the lane in the first row
inline Lane interpolate(const float* rows, std::size_t stride, const CubicTaps& taps) {
    const float* first = rows + taps.first * stride;
    return taps.weight[0] * lane_at(first) + taps.weight[1] * lane_at(first + stride) +
           taps.weight[2] * lane_at(first + 2 * stride) +
           taps.weight[3] * lane_at(first + 3 * stride);
}

}  // namespace miebrdf::render
