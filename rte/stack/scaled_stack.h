// A stack of media as the discrete equations see it.
#pragma once

#include <vector>

#include <miebrdf/optics.h>
#include "rte/phase/scaled_medium.h"

namespace miebrdf::rte {

/// A stack as the discrete equations see it.
struct ScaledStack {
    std::vector<ScaledMedium> media;  ///< from the bottom up; media[0] is the half-space, if any
    BaseKind base = BaseKind::half_space;
    double ground_albedo = 0.0;
    int moments = 1;  ///< Legendre moments of the medium that has most
};

/// The stack as the discrete equations see it: delta-M, layers without depth left out, everything
/// below an infinitely deep coat left out.
ScaledStack scale_stack(const Stack& stack, int moments, bool delta_m);

}  // namespace miebrdf::rte
