// The scattering matrix of a medium: checked, at an angle, and of mixtures.
#pragma once

#include <span>

#include <miebrdf/optics.h>

namespace miebrdf::rte {

/// @throws UsageError  naming the coefficient that is out of range
void validate(const Polarisation& polarisation);

/// F at a scattering angle: exact where the medium has it, else the sum of its coefficients; a1
/// alone for a medium without polarisation.
/// @param cos_theta  in [-1, 1]
ScatteringMatrix exact_matrix(const Optics& optics, double cos_theta);

/// Rayleigh scattering by molecules; rho in [0, 6/7].
std::shared_ptr<const Polarisation> rayleigh_polarisation(double depolarisation_factor);

/// Coefficients of a mixture: those of its components by their shares of the scattering; null if
/// none has any.
/// @param share  as MixedPhase::share
std::shared_ptr<const Polarisation> mix_polarisation(std::span<const Optics> components,
                                                     std::span<const double> share);

}  // namespace miebrdf::rte
