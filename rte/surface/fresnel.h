// Reflectance of a smooth boundary, for unpolarised light arriving from the side of index 1.
#pragma once

#include <complex>

#include <miebrdf/surface.h>

namespace miebrdf::rte {

/// Fresnel's equations for n + ik, mean of the two polarisations, in [0, 1].
///
/// Both amplitudes are written with the factor m^2 - 1 taken out (fresnel.cpp), so that a boundary
/// without contrast reflects exactly 0 and a weak one keeps its digits; Born & Wolf 1999, ch. 1.5
/// and 14.2, has the textbook form.
///
/// @param refractive_index  of the far side relative to the near side, n > 0, k >= 0
/// @param cos_incidence  cosine of the angle between ray and normal, in [0, 1]; 0 gives 1
/// Arguments are not checked: this is called for every node of an integral.
double fresnel_reflectance(std::complex<double> refractive_index, double cos_incidence);

/// |m - 1|^2 / |m + 1|^2.
double normal_reflectance(std::complex<double> refractive_index);

/// Schlick 1994, eq. 15: F0 + (1 - F0) (1 - cos)^5.
double schlick_reflectance(double normal_reflectance, double cos_incidence);

/// The reflectance of one boundary by the chosen formula, with what depends on the index alone
/// computed once.
class FresnelReflectance {
  public:
    /// @throws UsageError  unless n > 0, k >= 0 and both are finite
    FresnelReflectance(std::complex<double> refractive_index, FresnelKind kind);
    double operator()(double cos_incidence) const;
    /// Below this cosine everything, or nearly everything, is reflected: the critical angle of a
    /// thinner medium that absorbs little, where the reflectance goes like a square root. 0: there
    /// is none.
    double critical_cosine() const;

  private:
    FresnelKind kind_;
    std::complex<double> index_squared_;
    std::complex<double> contrast_;  ///< m^2 - 1
    double normal_reflectance_;
};

}  // namespace miebrdf::rte
