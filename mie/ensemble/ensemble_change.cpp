#include "mie/ensemble/ensemble_change.h"

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

// A half-space of similar spheres has an albedo A with 1 - A about
// sqrt(6 (1 - omega) / (1 - omega g)): d(1 - A) = (1 - A)/2 d ln(1 - omega), at most 0.15.
double change_by_absorption(const EnsembleOptics& a, const EnsembleOptics& b) {
    if (!(a.one_minus_albedo > 0 && b.one_minus_albedo > 0)) return 0;
    const double similar =
        b.one_minus_albedo / (1 - b.single_scattering_albedo * std::min(b.asymmetry, 1.0));
    const double sensitivity = std::min(0.15, 0.5 * std::sqrt(6 * similar));
    return sensitivity * std::abs(std::log(a.one_minus_albedo / b.one_minus_albedo));
}

double phase_change(const EnsembleOptics& a, const EnsembleOptics& b) {
    double change = 0;
    for (std::size_t i = 0; i < b.phase.size(); ++i) {
        change = std::max(change, std::abs(a.phase[i] / b.phase[i] - 1));
    }
    return change;
}

}  // namespace miebrdf::mie
