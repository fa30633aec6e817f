#include "rte/single_scattering.h"

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

double single_scattering(const std::vector<ScaledMedium>& media, bool exact, double mu_in,
                         double mu_out, double cos_azimuth) {
    const double cos_theta = cos_scattering_angle(mu_in, mu_out, cos_azimuth);
    const double q = 1.0 / mu_in + 1.0 / mu_out;
    double sum = 0.0;
    double above = 1.0;  // what is left of the light on its way through the media above
    for (auto medium = media.rbegin(); medium != media.rend() && above > 0.0; ++medium) {
        const double strength = first_order_strength(*medium, exact, cos_theta);
        const double slant = medium->optical_depth * q;
        sum += above * strength * -std::expm1(-slant);
        above *= std::exp(-slant);
    }
    return sum / (4.0 * (mu_in + mu_out));
}

}  // namespace miebrdf::rte
