// The correction of the first order that delta-M needs, degree by degree (narrow_features.h sums
// it).
#pragma once

#include <vector>

#include "rte/first_order/single_scattering.h"

namespace miebrdf::rte {

/// The coefficients of P_l(cos Theta), l = 0, 1, ..., in C of narrow_features.h at one
/// q = 1/mu_in + 1/mu_out; empty if there are none.
std::vector<double> narrow_strengths(const std::vector<ScaledMedium>& media, double q);

}  // namespace miebrdf::rte
