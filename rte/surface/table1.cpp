#include <miebrdf/table1.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <numbers>

#include <miebrdf/error.h>

namespace miebrdf::rte {

const std::vector<Table1Convention>& table1_conventions() {
    using enum MicrofacetDistribution;
    using enum Shadowing;
    using enum FresnelKind;
    static const std::vector<Table1Convention> conventions = {
        {"beckmann-smith-schlick",
         "Beckmann D, height-correlated Smith G, Schlick F with F0 of n + ik",
         {.beckmann_alpha = 0.3,
          .distribution = beckmann,
          .shadowing = smith_correlated,
          .fresnel = schlick},
         {620, 535, 480},
         0.0027},
        {"beckmann-smith-exact",
         "Beckmann D, height-correlated Smith G, exact Fresnel F",
         {.beckmann_alpha = 0.3,
          .distribution = beckmann,
          .shadowing = smith_correlated,
          .fresnel = exact},
         {620, 535, 480},
         0.0305},
        {"ggx-smith-exact",
         "GGX D, separable Smith G with Beckmann's Lambda, exact Fresnel F",
         {.beckmann_alpha = 0.3,
          .distribution = ggx,
          .shadowing = smith_separable,
          .fresnel = exact,
          .shadowing_distribution = beckmann},
         {612, 530, 468},
         0.0018},
        {"beckmann-v-cavity-schlick",
         "Beckmann D with alpha = 0.3 sqrt(2), V-cavity G, Schlick F with F0 of n + ik",
         {.beckmann_alpha = 0.3 * std::numbers::sqrt2,
          .distribution = beckmann,
          .shadowing = v_cavity,
          .fresnel = schlick},
         {585, 512, 465},
         0.0033},
    };
    return conventions;
}

const Table1Convention& table1_convention(const std::string& name) {
    std::vector<std::string> names;
    for (const Table1Convention& convention : table1_conventions()) {
        if (convention.name == name) return convention;
        names.push_back(convention.name);
    }
    throw UsageError("convention", name, fmt::format("{}", fmt::join(names, ", ")));
}

const std::vector<Table1Row>& table1_printed() {
    static const std::vector<Table1Row> rows = {
        {"GaP", {0.68224, 0.66708, 0.64471}},
        {"SiO2", {0.90465, 0.90404, 0.90343}},
        {"TiO2", {0.72505, 0.71400, 0.70362}},
        {"AlGaAs7", {0.67603, 0.65280, 0.63531}},
    };
    return rows;
}

}  // namespace miebrdf::rte
