// What a boundary above the layers does to light on its way in and out, as far as albedos see it.
#pragma once

#include <functional>

namespace miebrdf::rte {

struct BoundaryWeights {
    double in = 1.0;   ///< share of the light from mu that gets to the layers
    double out = 1.0;  ///< what light that leaves the layers towards mu counts
};

/// Weights at a cosine in (0, 1], smooth in it; empty: no boundary, both are 1.
using Boundary = std::function<BoundaryWeights(double mu)>;

}  // namespace miebrdf::rte
