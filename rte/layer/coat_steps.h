// Coats by steps in optical depth: the paper's way, and a uniform replacement at the same cost.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rte/first_order/single_scattering.h"
#include "rte/half_space/half_space.h"

namespace miebrdf::rte {

/// Adds a coat by `substeps` equal steps of invariant imbedding. With S(R) the bracket of eq. (2)
/// without its loss terms, S = sum_l (-1)^(l-m) a_l phi_l(mu) phi_l(mu') / (4 mu mu'), and
/// q = 1/mu + 1/mu':
///
/// `first_order`: Chen et al. 2013, eq. (2): R' = (1 - h/mu) R (1 - h/mu') + h S(R). Diverges for
/// mu below h.
/// `first_order_patched`: the same, and where h/mu > 1/2 for either cosine the coat's single
/// scattering alone, as the paper does "at small eta" (it does not say how small).
/// `exponential`: losses exactly, sources to second order (Cox & Matthews 2002, ETD2RK):
/// R1 = e^-qh R + h f1(-qh) S(R), R' = R1 + h f2(-qh) [S(R1) - S(R)],
/// f1(z) = (e^z - 1)/z, f2(z) = (e^z - 1 - z)/z^2. Uniform down to grazing.
///
/// @param first_order_below  R of single scattering in everything below, out x in (see
/// first_order_of)
Reflector step_through_coat(CoatMethod method, int substeps, double optical_depth,
                            const ScatteringMode& medium, const Eigen::MatrixXd& first_order_below,
                            const PhaseMode& mode, const ZenithGrid& grid,
                            const RequestedDirections& requested, Reflector base);

/// One azimuthal order of single scattering with the discrete equations' moments, out x in.
Eigen::MatrixXd first_order_of(const std::vector<ScaledMedium>& media, const PhaseMode& mode,
                               const RequestedDirections& requested);

}  // namespace miebrdf::rte
