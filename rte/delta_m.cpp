#include "rte/delta_m.h"

#include <algorithm>
#include <cmath>

namespace miebrdf::rte {
namespace {

double chi_at(const Optics& optics, std::size_t degree) {
    return degree < optics.chi.size() ? optics.chi[degree] : 0.0;
}

// The peak that L moments cannot carry. Every remaining chi'_l must stay within [-1, 1]:
// (chi - f) / (1 - f) >= -1 is f <= (1 + chi) / 2.
double forward_fraction(const Optics& optics, std::size_t moments) {
    const double f = chi_at(optics, moments);
    if (!(f > 0.0 && chi_at(optics, moments + 1) >= 0.0)) return 0.0;
    for (std::size_t l = 0; l < moments; ++l) {
        if (!(f <= 0.5 * (1.0 + chi_at(optics, l)))) return 0.0;
    }
    // A peak whose last moment rounds to 1 leaves nothing to scale by.
    return std::min(f, 1.0 - 1e-9);
}

}  // namespace

Eigen::VectorXd ScaledOptics::strengths() const {
    Eigen::VectorXd result(chi.size());
    for (Eigen::Index l = 0; l < chi.size(); ++l) result[l] = albedo * (2.0 * l + 1.0) * chi[l];
    return result;
}

ScaledOptics scale_optics(const Optics& optics, int moments, bool delta_m) {
    ScaledOptics scaled;
    scaled.truncated = delta_m ? forward_fraction(optics, moments) : 0.0;
    const double f = scaled.truncated;
    // 1 - alpha f = (1 - f) + (1 - alpha) f: no digits lost when both are close to 1.
    scaled.depth_factor = (1.0 - f) + optics.one_minus_albedo * f;
    scaled.one_minus_albedo = optics.one_minus_albedo / scaled.depth_factor;
    scaled.albedo = optics.single_scattering_albedo * (1.0 - f) / scaled.depth_factor;
    scaled.chi.resize(moments);
    for (int l = 0; l < moments; ++l) scaled.chi[l] = (chi_at(optics, l) - f) / (1.0 - f);
    return scaled;
}

}  // namespace miebrdf::rte
