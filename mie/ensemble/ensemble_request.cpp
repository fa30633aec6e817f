#include "mie/ensemble/ensemble_request.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "mie/sphere/terms.h"

namespace miebrdf::mie {

void validate(const EnsembleRequest& r) {
    if (!(r.host_index >= 0.1 && r.host_index <= 10)) {
        throw std::invalid_argument(fmt::format("host index {}; allowed: 0.1 to 10", r.host_index));
    }
    if (!(r.wavelength_nm > 0 && std::isfinite(r.wavelength_nm))) {
        throw std::invalid_argument(
            fmt::format("wavelength {} nm; allowed: positive and finite", r.wavelength_nm));
    }
    if (!(r.tolerance > 0 && r.tolerance < 1)) {
        throw std::invalid_argument(fmt::format("tolerance {}; allowed: (0, 1)", r.tolerance));
    }
    if (!(r.phase_floor >= 0)) {
        throw std::invalid_argument(
            fmt::format("phase floor {}; allowed: 0 or above", r.phase_floor));
    }
    if (!(r.phase_tolerance > 0)) {
        throw std::invalid_argument(
            fmt::format("phase tolerance {}; allowed: above 0", r.phase_tolerance));
    }
    if (!(r.table_tolerance > 0)) {
        throw std::invalid_argument(
            fmt::format("table tolerance {}; allowed: above 0", r.table_tolerance));
    }
    if (!(r.highest_moment >= -1 && r.highest_moment <= 100000)) {
        throw std::invalid_argument(
            fmt::format("highest moment {}; allowed: -1 (none) to 100000", r.highest_moment));
    }
    const double n = r.refractive_index.real(), k = r.refractive_index.imag();
    if (!(n / r.host_index >= 0.01 && n / r.host_index <= 100 && k >= 0 && k <= 1e3)) {
        throw std::invalid_argument(fmt::format(
            "refractive index {} + {}i; allowed: n/host in [0.01, 100], k in [0, 1000]", n, k));
    }
}

std::complex<double> relative_index_of(const EnsembleRequest& request) {
    return request.refractive_index / request.host_index;
}

double wave_number_per_um(const EnsembleRequest& request) {
    return 2 * std::numbers::pi * request.host_index / (request.wavelength_nm * 1e-3);
}

int highest_moment_of(const EnsembleRequest& request) {
    return 2 *
           number_of_terms(wave_number_per_um(request) * radius_range(request.sizes).largest_um);
}

}  // namespace miebrdf::mie
