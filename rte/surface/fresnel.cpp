#include "rte/surface/fresnel.h"

#include <fmt/format.h>

#include <cmath>

#include <miebrdf/error.h>

namespace miebrdf::rte {

namespace {

/// m = n + ik, c the cosine of incidence, q = sqrt(m^2 - sin^2): the textbook amplitudes are
///     r_s = (c - q) / (c + q),   r_p = (m^2 c - q) / (m^2 c + q).
/// Times denominator / denominator, with q^2 - c^2 = m^2 - 1 = (m - 1)(m + 1) =: contrast:
///     r_s = -contrast / (c + q)^2,   r_p = contrast (m^2 c^2 - sin^2) / (m^2 c + q)^2.
/// k >= 0 puts q into the first quadrant, the wave that decays away from the boundary.
double exact_reflectance(std::complex<double> m2, std::complex<double> contrast, double c) {
    if (contrast == 0.0) return 0.0;  // also at grazing, where c + q = 0
    const double sin2 = (1.0 - c) * (1.0 + c);
    // The first form of q^2 keeps its digits for m close to 1, the second for m close to 0.
    const std::complex<double> q =
        std::sqrt(std::norm(contrast) < 0.25 ? contrast + c * c : m2 - sin2);
    const double brewster = std::norm(m2 * (c * c) - sin2);
    const double s = std::norm(c + q);
    const double p = std::norm(m2 * c + q);
    return 0.5 * std::norm(contrast) * (1.0 / (s * s) + brewster / (p * p));
}

}  // namespace

double fresnel_reflectance(std::complex<double> refractive_index, double cos_incidence) {
    const std::complex<double> m = refractive_index;
    return exact_reflectance(m * m, (m - 1.0) * (m + 1.0), cos_incidence);
}

double normal_reflectance(std::complex<double> refractive_index) {
    return std::norm(refractive_index - 1.0) / std::norm(refractive_index + 1.0);
}

double schlick_reflectance(double normal_reflectance, double cos_incidence) {
    const double x = 1.0 - cos_incidence;
    return normal_reflectance + (1.0 - normal_reflectance) * (x * x) * (x * x) * x;
}

FresnelReflectance::FresnelReflectance(std::complex<double> refractive_index, FresnelKind kind)
    : kind_(kind),
      index_squared_(refractive_index * refractive_index),
      contrast_((refractive_index - 1.0) * (refractive_index + 1.0)),
      normal_reflectance_(normal_reflectance(refractive_index)) {
    const double n = refractive_index.real();
    const double k = refractive_index.imag();
    if (!(n > 0 && k >= 0 && std::isfinite(n) && std::isfinite(k))) {
        throw UsageError("refractive_index", fmt::format("{} + {}i", n, k),
                         "finite, n > 0, k >= 0");
    }
}

double FresnelReflectance::operator()(double cos_incidence) const {
    return kind_ == FresnelKind::exact ? exact_reflectance(index_squared_, contrast_, cos_incidence)
                                       : schlick_reflectance(normal_reflectance_, cos_incidence);
}

double FresnelReflectance::critical_cosine() const {
    const double square = index_squared_.real();  // of the sine
    const bool is_thinner = square > 0.0 && square < 1.0 && contrast_ != 0.0;
    const bool absorbs_little = index_squared_.imag() <= 0.5 * square;
    return kind_ == FresnelKind::exact && is_thinner && absorbs_little ? std::sqrt(1.0 - square)
                                                                       : 0.0;
}

}  // namespace miebrdf::rte
