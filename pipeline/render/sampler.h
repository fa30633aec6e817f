// Well-spread random numbers that depend on pixel and sample alone, not on threads or their order.
#pragma once

#include <array>
#include <cstdint>

namespace miebrdf::render {

/// A sequence of points in the unit square for one sample of one pixel: the first four Sobol
/// dimensions, Owen-scrambled and shuffled by hashing, anew for every two pairs ("padding"; Burley
/// 2020, Practical hash-based Owen scrambling, J. Computer Graphics Techniques 9(4)). Samples
/// 0 ... 2^k - 1 of a pixel are well spread in every pair for every k, and the first pair (place in
/// the pixel) together with the second (first direction or place on a light) too.
class Sampler {
  public:
    Sampler(std::uint32_t x, std::uint32_t y, std::uint32_t seed, std::uint32_t sample);

    /// The next pair of numbers, each in [0, 1).
    std::array<double, 2> next();

  private:
    std::uint32_t pixel_;
    std::uint32_t sample_;
    std::uint32_t pair_ = 0;
};

}  // namespace miebrdf::render
