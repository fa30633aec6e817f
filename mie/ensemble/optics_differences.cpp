#include "mie/ensemble/optics_differences.h"

#include <algorithm>
#include <cmath>

namespace miebrdf::mie {

double largest_change(const EnsembleOptics& a, const EnsembleOptics& b) {
    double change = std::max({std::abs(a.q_ext / b.q_ext - 1),
                              std::abs(a.single_scattering_albedo / b.single_scattering_albedo - 1),
                              std::abs(a.asymmetry - b.asymmetry)});
    for (std::size_t l = 0; l < a.chi.size(); ++l) {
        change = std::max(change, std::abs(a.chi[l] - b.chi[l]));
    }
    return change;
}

double change_by_absorption(const EnsembleOptics& a, const EnsembleOptics& b) {
    if (!(a.one_minus_albedo > 0 && b.one_minus_albedo > 0)) return 0;
    const double similar =
        b.one_minus_albedo / (1 - b.single_scattering_albedo * std::min(b.asymmetry, 1.0));
    const double sensitivity = std::min(0.15, 0.5 * std::sqrt(6 * similar));
    return sensitivity * std::abs(std::log(a.one_minus_albedo / b.one_minus_albedo));
}

double half_space_albedo(const EnsembleOptics& optics) {
    const double similar = optics.one_minus_albedo /
                           (1 - optics.single_scattering_albedo * std::min(optics.asymmetry, 1.0));
    const double s = std::sqrt(std::clamp(similar, 0.0, 1.0));
    return (1 - s) * (1 - 0.139 * s) / (1 + 1.17 * s);
}

}  // namespace miebrdf::mie
