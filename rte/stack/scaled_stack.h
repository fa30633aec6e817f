// A stack of media as the discrete equations see it.
#pragma once

#include <vector>

#include "rte/first_order/single_scattering.h"
#include "rte/stack/stack.h"

namespace miebrdf::rte {

/// A stack as the discrete equations see it.
struct ScaledStack {
    std::vector<ScaledMedium> media;  ///< from the bottom up; media[0] is the half-space, if any
    BaseKind base = BaseKind::half_space;
    double ground_albedo = 0.0;
    int moments = 1;  ///< Legendre moments of the medium that has most
};

}  // namespace miebrdf::rte
