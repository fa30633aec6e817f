// Means of 1 - rho_dt over the hemisphere: how much light a rough surface lets in.
#pragma once

#include <functional>

#include "rte/surface/directional_reflectance.h"

namespace miebrdf::rte {

/// What the directions of incidence weigh in a mean over the hemisphere.
enum class HemisphereMean {
    solid_angle,  ///< all directions alike: integral over mu in (0, 1)
    cosine,       ///< as a diffuse illumination arrives: 2 * integral over mu dmu
};

/// Mean of 1 - rho(mu). With `solid_angle` this is the averaged diffuse reflectance factor of
/// Chen et al. 2013, Table 1 (which says neither which mean nor which G; rte/surface/table1.h).
///
/// Gauss nodes in t with mu = t^2, so that the steep end at grazing is resolved for small
/// roughness too; doubled until the mean moves by less than the tolerance.
///
/// @param rho  directional reflectance, called for mu in (0, 1)
/// @param tolerance  absolute, > 0; the error of `rho` itself is not seen
IntegralResult mean_transmittance(const std::function<double(double mu)>& rho, HemisphereMean mean,
                                  double tolerance = 1e-5);

}  // namespace miebrdf::rte
