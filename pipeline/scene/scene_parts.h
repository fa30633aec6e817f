// The checks of the parts of a scene, for those that check the whole.
#pragma once

#include <miebrdf/scene.h>

namespace miebrdf {

/// Share of the volume that equal spheres fill at most (Hales 2005: 0.7405).
inline constexpr double kDensestPacking = 0.74;

/// @throws UsageError  naming the value and the allowed range, like all others here
void validate(const Medium& medium);
void validate(const Host& host);
void validate(const Depth& depth);
void validate(const Substrate& substrate);

}  // namespace miebrdf
