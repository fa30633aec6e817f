#include "materials/index/mixing_rules.h"

#include <cmath>
#include <limits>

namespace miebrdf::materials {
namespace {

using Complex = std::complex<double>;
using Parts = std::span<const MixturePart>;

template <typename Function>
Complex weighted_sum(Parts parts, const Function& of) {
    Complex sum = 0;
    for (const MixturePart& part : parts) sum += part.fraction * of(part.permittivity);
    return sum;
}

Complex volume(Parts parts) {
    return weighted_sum(parts, [](Complex eps) { return eps; });
}

Complex average(Parts parts) {
    const Complex n_ik = weighted_sum(parts, [](Complex eps) { return std::sqrt(eps); });
    return n_ik * n_ik;
}

Complex looyenga(Parts parts) {
    // The principal cube root: absorption (Im >= 0) stays absorption.
    const Complex root = weighted_sum(parts, [](Complex eps) { return std::pow(eps, 1.0 / 3.0); });
    return root * root * root;
}

Complex maxwell_garnett(Parts parts) {
    const Complex host = parts.back().permittivity;
    Complex sum = 0;
    for (const MixturePart& part : parts.first(parts.size() - 1)) {
        sum += part.fraction * (part.permittivity - host) / (part.permittivity + 2.0 * host);
    }
    return host * (1.0 + 2.0 * sum) / (1.0 - sum);
}

// With b = (3 f_1 - 1) eps_1 + (3 f_2 - 1) eps_2 the equation reads
//     2 eps^2 - b eps - eps_1 eps_2 = 0.
// Its roots are ends of one diameter about b/4; the physical one absorbs, or, where nothing does,
// is the positive one.
Complex bruggeman(Parts parts) {
    if (parts.size() == 1) return parts.front().permittivity;
    const auto& [eps_1, f_1] = parts[0];
    const auto& [eps_2, f_2] = parts[1];
    const Complex b = (3 * f_1 - 1) * eps_1 + (3 * f_2 - 1) * eps_2;
    const Complex root = std::sqrt(b * b + 8.0 * eps_1 * eps_2);
    const Complex one = (b + root) / 4.0, other = (b - root) / 4.0;
    const double rounding = 1e-14 * (std::abs(one) + std::abs(other));
    const bool one_absorbs = one.imag() >= -rounding, other_absorbs = other.imag() >= -rounding;
    if (one_absorbs != other_absorbs) return one_absorbs ? one : other;
    const Complex near = looyenga(parts);
    return std::abs(one - near) <= std::abs(other - near) ? one : other;
}

constexpr std::size_t kAnyNumber = std::numeric_limits<std::size_t>::max();

constexpr MixingRule kRules[] = {
    {"bruggeman", "Bruggeman", "D. A. G. Bruggeman, Ann. Phys. 416, 636 (1935)", 2, bruggeman},
    {"maxwell-garnett", "Maxwell Garnett",
     "J. C. Maxwell Garnett, Philos. Trans. R. Soc. A 203, 385 (1904)", kAnyNumber,
     maxwell_garnett},
    {"looyenga", "Looyenga", "H. Looyenga, Physica 31, 401 (1965)", kAnyNumber, looyenga},
    {"volume", "Volume average of the permittivity", "", kAnyNumber, volume},
    {"average", "Average of the refractive index", "", kAnyNumber, average},
};

}  // namespace

std::span<const MixingRule> mixing_rules() { return kRules; }

const MixingRule* find_mixing_rule(std::string_view name) {
    for (const MixingRule& rule : kRules) {
        if (name == rule.name) return &rule;
    }
    return nullptr;
}

}  // namespace miebrdf::materials
