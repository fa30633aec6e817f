#include "rte/first_order/single_scattering.h"

#include <algorithm>
#include <cmath>

#include "rte/math/legendre.h"

namespace miebrdf::rte {

double cos_scattering_angle(double mu_in, double mu_out, double cos_azimuth) {
    const double sines = std::sqrt((1.0 - mu_in) * (1.0 + mu_in) * (1.0 - mu_out) * (1.0 + mu_out));
    return std::clamp(-mu_in * mu_out + sines * cos_azimuth, -1.0, 1.0);
}

double exact_phase(const Optics& optics, double cos_theta) {
    return optics.phase ? optics.phase(cos_theta) : math::legendre_series(optics.chi, cos_theta);
}

double first_order_strength(const ScaledMedium& medium, bool exact, double cos_theta) {
    const ScaledOptics& scaled = medium.scaled;
    if (exact) {
        return medium.exact.single_scattering_albedo / scaled.depth_factor *
               exact_phase(medium.exact, cos_theta);
    }
    return scaled.albedo *
           math::legendre_series({scaled.chi.data(), std::size_t(scaled.chi.size())}, cos_theta);
}

void first_order_weights(const std::vector<ScaledMedium>& media, double mu_in, double mu_out,
                         std::span<double> weights) {
    const double q = 1.0 / mu_in + 1.0 / mu_out;
    double above = 0.25 / (mu_in + mu_out);  // what is left on the way through the media above
    for (std::size_t i = media.size(); i-- > 0;) {
        const double slant = media[i].optical_depth * q;
        weights[i] = above * -std::expm1(-slant);
        above *= std::exp(-slant);
    }
}

double single_scattering(const std::vector<ScaledMedium>& media, bool exact, double mu_in,
                         double mu_out, double cos_azimuth) {
    const double cos_theta = cos_scattering_angle(mu_in, mu_out, cos_azimuth);
    std::vector<double> weights(media.size());
    first_order_weights(media, mu_in, mu_out, weights);
    double sum = 0.0;
    for (std::size_t i = 0; i < media.size(); ++i) {
        if (weights[i] == 0.0) continue;
        sum += weights[i] * first_order_strength(media[i], exact, cos_theta);
    }
    return sum;
}

}  // namespace miebrdf::rte
