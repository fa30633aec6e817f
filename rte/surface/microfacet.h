// The statistics of a rough surface made of small mirrors: which normals there are (D) and which
// of them are lit and seen (G).
#pragma once

#include <miebrdf/surface.h>

namespace miebrdf::rte {

/// D(h) per unit of solid angle, normalised so that the integral of D cos(theta_h) over the
/// hemisphere is 1 (the mirrors project onto the whole surface).
///   Beckmann: exp(-t) / (pi a^2 cos^4),  GGX: 1 / (pi a^2 cos^4 (1 + t)^2),  t = tan^2 / a^2
/// @param tan2_half  tan^2(theta_h) of the mirror's normal, >= 0
double normal_density(MicrofacetDistribution distribution, double alpha, double tan2_half);

/// mu / G1(mu) = mu (1 + Lambda(mu)): finite and smooth down to mu = 0, where it is
/// alpha / (2 sqrt(pi)) for Beckmann and alpha / 2 for GGX.
///   Beckmann: Lambda = (exp(-a^2) / (a sqrt(pi)) - erfc(a)) / 2,  a = mu / (alpha sin(theta))
///   GGX:      Lambda = (sqrt(1 + 1/a^2) - 1) / 2
/// Smith 1967; Walter et al. 2007, section 5; Heitz 2014, eq. 68 and 72.
double cosine_over_masking(MicrofacetDistribution distribution, double alpha, double mu);

/// One pair of rays as seen by the mirrors that send one into the other.
struct FacetGeometry {
    double mu_in;      ///< > 0
    double mu_out;     ///< > 0
    double cos_half;   ///< cos(theta_h), of the mirror's normal
    double cos_facet;  ///< cosine of incidence on the mirror
};

/// G / (mu_in mu_out): kept together because at grazing both go to zero.
class ShadowingOverCosines {
  public:
    /// @throws std::invalid_argument  for options out of range
    explicit ShadowingOverCosines(const SurfaceOptions& options);

    /// mu / G1(mu) of the chosen Lambda, to be computed once for a ray used often.
    double cosine_over_masking(double mu) const;

    double operator()(const FacetGeometry& geometry) const;
    /// The same with cosine_over_masking(mu_in) already known.
    double operator()(const FacetGeometry& geometry, double in_over_masking) const;

  private:
    Shadowing shadowing_;
    MicrofacetDistribution distribution_;
    double alpha_;
};

}  // namespace miebrdf::rte
