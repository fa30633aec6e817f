// BRDFs in the layout that Eradiate reads for measured surfaces (its BSDF `mqdiffuse`): `brdf` over
// cos_theta_o, phi_d, cos_theta_i and, for several wavelengths, w. Cosines go from 0 to 1, phi_d
// from 0 to 2 pi without its end, all in even steps. phi_d is the azimuth of the outgoing minus
// that of the incoming direction, both away from the surface: 0 is back towards the source.
#pragma once

#include <vector>

#include "pipeline/sweep/sweep.h"

namespace miebrdf::sweep {

/// @throws UsageError  for other outputs than the BRDF, and for axes that the layout has not
void require_eradiate_axes(const Sweep& sweep);

/// The solver's cosine in place of 0, where a BRDF of light scattered once, 1 / (mu_in + mu_out),
/// has no limit: this part of the first step gives linear interpolation its mean over the cell at
/// the corner to half a percent.
inline constexpr double kGrazingStep = 0.15;

/// phi_d of each place, in radians.
std::vector<double> eradiate_azimuths(const Axis& azimuth);

/// A scene's BRDF, laid out as wavelength, incidence, reflection, azimuth, in Eradiate's order.
std::vector<double> in_eradiate_order(const Sweep& sweep, const double* brdf);

}  // namespace miebrdf::sweep
