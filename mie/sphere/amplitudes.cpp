#include "mie/sphere/amplitudes.h"

#include <fmt/format.h>

#include <boost/math/special_functions/cos_pi.hpp>
#include <stdexcept>

namespace miebrdf::mie {

double cosine_of_scattering_angle(double angle_deg) {
    if (!(angle_deg >= 0 && angle_deg <= 180)) {
        throw std::invalid_argument(
            fmt::format("scattering angle {} degrees; allowed: 0 to 180", angle_deg));
    }
    if (angle_deg == 60) return 0.5;
    if (angle_deg == 120) return -0.5;
    return boost::math::cos_pi(angle_deg / 180);
}

Amplitudes scattering_amplitudes(const Coefficients& coefficients,
                                 std::span<const double> angles_deg) {
    const int terms = static_cast<int>(coefficients.a.size());
    Amplitudes amplitudes;
    for (const double angle_deg : angles_deg) {
        const double mu = cosine_of_scattering_angle(angle_deg);
        std::complex<double> s1 = 0, s2 = 0;
        double pi_before = 0, pi = 1;  // pi_0, pi_1
        for (int n = 1; n <= terms; ++n) {
            // Wiscombe 1980: s = mu pi_n, t = s - pi_{n-1};
            // tau_n = n t - pi_{n-1}, pi_{n+1} = s + (n + 1)/n t.
            const double s = mu * pi;
            const double t = s - pi_before;
            const double tau = n * t - pi_before;
            const double weight = (2.0 * n + 1.0) / (n * (n + 1.0));
            const std::complex<double> a = weight * coefficients.a[n - 1];
            const std::complex<double> b = weight * coefficients.b[n - 1];
            s1 += a * pi + b * tau;
            s2 += a * tau + b * pi;
            pi_before = pi;
            pi = s + (n + 1.0) / n * t;
        }
        amplitudes.s1.push_back(s1);
        amplitudes.s2.push_back(s2);
    }
    return amplitudes;
}

Amplitudes scattering_amplitudes(std::complex<double> relative_index, double size_parameter,
                                 std::span<const double> angles_deg) {
    return scattering_amplitudes(mie_coefficients(relative_index, size_parameter), angles_deg);
}

}  // namespace miebrdf::mie
