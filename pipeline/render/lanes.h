// Spectra in pieces of eight wavelengths: what a processor computes at once.
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace miebrdf::render {

/// Single precision: relative rounding of 1e-7 is far below what interpolation loses.
using Lane = Eigen::Array<float, 8, 1>;
inline constexpr std::size_t kLaneWidth = 8;

inline std::size_t lanes_for(std::size_t wavelengths) {
    return (wavelengths + kLaneWidth - 1) / kLaneWidth;
}

inline Eigen::Map<const Lane> lane_at(const float* values) {
    return Eigen::Map<const Lane>(values);
}

}  // namespace miebrdf::render
