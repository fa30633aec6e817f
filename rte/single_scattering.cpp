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

double single_scattering(const std::vector<ScaledMedium>& media, bool exact, double mu_in,
                         double mu_out, double cos_azimuth) {
    const double cos_theta = cos_scattering_angle(mu_in, mu_out, cos_azimuth);
    const double q = 1.0 / mu_in + 1.0 / mu_out;
    double sum = 0.0;
    double above = 1.0;  // what is left of the light on its way through the media above
    for (auto medium = media.rbegin(); medium != media.rend() && above > 0.0; ++medium) {
        const ScaledOptics& scaled = medium->scaled;
        const double strength =
            exact ? medium->exact.single_scattering_albedo / scaled.depth_factor *
                        exact_phase(medium->exact, cos_theta)
                  : scaled.albedo * math::legendre_series(
                                        {scaled.chi.data(), size_t(scaled.chi.size())}, cos_theta);
        const double slant = medium->optical_depth * q;
        sum += above * strength * -std::expm1(-slant);
        above *= std::exp(-slant);
    }
    return sum / (4.0 * (mu_in + mu_out));
}

std::vector<double> narrow_feature_correction(const std::vector<ScaledMedium>& media, double mu_in,
                                              double mu_out, std::span<const double> cos_azimuth) {
    std::vector<double> result(cos_azimuth.size(), 0.0);
    std::size_t first = 0;
    std::size_t degrees = 0;
    for (const ScaledMedium& medium : media) {
        if (medium.narrow.rest.empty()) continue;
        first = std::size_t(medium.narrow.first_degree);
        degrees = std::max(degrees, medium.narrow.rest.size());
    }
    if (degrees == 0) return result;

    const double q = 1.0 / mu_in + 1.0 / mu_out;
    const auto peak_at = [](const ScaledMedium& medium, std::size_t k) {
        return k < medium.narrow.peak.size() ? medium.narrow.peak[k] : 0.0;
    };
    std::vector<double> weights(first + degrees, 0.0);
    for (std::size_t k = 0; k < degrees; ++k) {
        double above_peak = 1.0;
        double above_scaled = 1.0;
        for (auto medium = media.rbegin(); medium != media.rend(); ++medium) {
            const double alpha = medium->exact.single_scattering_albedo;
            const double loss = 1.0 - alpha * peak_at(*medium, k);
            const double slant = medium->optical_depth * q;  // with the fraction f
            const double slant_peak = slant * (loss / medium->scaled.depth_factor);
            const double with_peak = above_peak * -std::expm1(-slant_peak) / loss;
            const double with_scaled =
                above_scaled * -std::expm1(-slant) / medium->scaled.depth_factor;
            if (k < medium->narrow.rest.size()) {
                weights[first + k] += alpha * medium->narrow.rest[k] * (with_peak - with_scaled);
            }
            above_peak *= std::exp(-slant_peak);
            above_scaled *= std::exp(-slant);
        }
    }
    for (std::size_t a = 0; a < cos_azimuth.size(); ++a) {
        const double cos_theta = cos_scattering_angle(mu_in, mu_out, cos_azimuth[a]);
        result[a] = math::legendre_series(weights, cos_theta) / (4.0 * (mu_in + mu_out));
    }
    return result;
}

}  // namespace miebrdf::rte
