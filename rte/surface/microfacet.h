// The statistics of a rough surface made of small mirrors: which normals there are (D), which of
// them are lit and seen (G), and in which slopes both are integrated.
#pragma once

#include <vector>

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
    /// @throws UsageError  for options out of range
    explicit ShadowingOverCosines(const SurfaceOptions& options);

    /// mu / G1(mu) of the chosen Lambda, to be computed once for a ray used often.
    double cosine_over_masking(double mu) const;

    double operator()(const FacetGeometry& geometry) const;
    /// Evaluates it with cosine_over_masking(mu_in) already known.
    double operator()(const FacetGeometry& geometry, double in_over_masking) const;

  private:
    Shadowing shadowing_;
    MicrofacetDistribution distribution_;
    double alpha_;
};

/// One direction of incidence; mu in (0, 1].
class SlopePlane {
  public:
    explicit SlopePlane(double mu_in);

    double mu() const { return mu_; }
    double sine() const { return sine_; }

    /// Slopes that reflect above the horizon: the disk (x - tan)^2 + y^2 < 1 / mu^2.
    double largest_y() const { return 1.0 / mu_; }
    double lowest_x(double y) const;
    double highest_x(double y) const;

    /// Where the V-cavity's min(1, 2 cos_half min(mu_in, mu_out) / cos_facet) changes branch along
    /// a line of constant y, ascending.
    std::vector<double> v_cavity_kinks(double y) const;
    /// Where y > 0 those kinks begin, end or meet, ascending: between these the integral over a
    /// line is a smooth function of y.
    std::vector<double> v_cavity_corners() const;

    /// Where a mirror is met at this cosine of incidence, along a line of constant y, ascending:
    /// two values, one or none.
    std::vector<double> incidence_kinks(double cos_facet, double y) const;
    /// Where y > 0 those two meet or leave the disk, ascending.
    std::vector<double> incidence_corners(double cos_facet) const;

  private:
    double root(double y) const;

    double mu_;
    double sine_;
};

}  // namespace miebrdf::rte
