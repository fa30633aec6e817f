// Light that leaves a sample beside the ports of integrating spheres, by tracing photons.
#pragma once

#include <miebrdf/brdf.h>

#include <vector>

namespace miebrdf {

/// Shares of the incident light that leave further from the axis than a port reaches: of a beam,
/// and of diffuse light that floods the port.
struct LostLight {
    double r_direct = 0.0, t_direct = 0.0, r_diffuse = 0.0, t_diffuse = 0.0;
};

struct Ports {
    double beam_mm = 0.0;                   ///< diameter; 0: a pencil
    double above_mm = 0.0, below_mm = 0.0;  ///< diameters, where light is collected
    double flooded_mm = 0.0;  ///< of the port that diffuse light comes from; 0: none comes
};

/// Photons scatter by Henyey-Greenstein's law of each layer's asymmetry; 50,000 of each kind, the
/// same random numbers for every sample, so that a loss of 5 % is known to 0.1 % of the light and
/// varies smoothly with the sample.
/// @param brdf  a free film of layers whose thickness is given
/// @return one for each wavelength
/// @throws UsageError  for other scenes
std::vector<LostLight> lost_light(const Brdf& brdf, double mu_in, const Ports& ports,
                                  const Control& control);

}  // namespace miebrdf
