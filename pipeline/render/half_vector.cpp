#include "pipeline/render/half_vector.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace miebrdf::render {

HalfVector half_vector(double mu_in, double mu_out, double cos_azimuth) {
    const double sin_in = std::sqrt(std::max(0.0, (1.0 - mu_in) * (1.0 + mu_in)));
    const double sin_out = std::sqrt(std::max(0.0, (1.0 - mu_out) * (1.0 + mu_out)));
    const double cos_between = mu_in * mu_out - sin_in * sin_out * cos_azimuth;
    const double cos_light = std::sqrt(std::max(0.0, 0.5 * (1.0 + cos_between)));
    // |light + view| = 2 cos_light; never 0 for two directions above the horizon.
    return {std::min(1.0, (mu_in + mu_out) / (2.0 * cos_light)), cos_light};
}

double beckmann_density(double cos_normal, double alpha) {
    const double cos2 = cos_normal * cos_normal;
    const double tan2 = (1.0 - cos_normal) * (1.0 + cos_normal) / cos2;
    const double alpha2 = alpha * alpha;
    return std::exp(-tan2 / alpha2) / (std::numbers::pi * alpha2 * cos2 * cos2);
}

}  // namespace miebrdf::render
