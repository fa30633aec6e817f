// The permittivity of a mixture from those of its parts.
#pragma once

#include <complex>
#include <span>
#include <string_view>
#include <vector>

namespace miebrdf::materials {

/// A part of a mixture: its permittivity (n + ik)^2 and its share of the volume.
struct MixturePart {
    std::complex<double> permittivity;
    double fraction = 0.0;
};

struct MixingRule {
    const char* name;       ///< "bruggeman"
    const char* title;      ///< "Bruggeman"
    const char* reference;  ///< publication
    std::size_t most_parts;
    std::complex<double> (*permittivity)(std::span<const MixturePart> parts);
};
/// All rules, in the order in which help texts list them. With eps_i, f_i of the parts:
///   bruggeman        sum f_i (eps_i - eps) / (eps_i + 2 eps) = 0, two parts
///   maxwell-garnett  (eps - eps_h) / (eps + 2 eps_h) = sum f_i (eps_i - eps_h) / (eps_i + 2
///   eps_h);
///                    spheres in a host, which is the last part
///   looyenga         eps^(1/3) = sum f_i eps_i^(1/3)
///   volume           eps = sum f_i eps_i
///   average          n + ik = sum f_i (n_i + ik_i)
std::span<const MixingRule> mixing_rules();

/// Null when there is none of this name.
const MixingRule* find_mixing_rule(std::string_view name);

}  // namespace miebrdf::materials
