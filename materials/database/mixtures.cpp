// Mixtures as materials: "bruggeman(TiO2:30%,SiO2)" is a name like any other.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <miebrdf/database.h>
#include "materials/database/models.h"
#include "materials/index/mixing_rules.h"
#include "materials/readers/text.h"
#include "materials/readers/text_table.h"

namespace miebrdf::materials {
namespace {

constexpr std::string_view kLabel = "mixture";
constexpr std::size_t kMostWavelengths = 20000;

struct Mixture {
    const MixingRule* rule = nullptr;
    struct Part {
        std::string name;
        double fraction = 0.0;
    };
    std::vector<Part> parts;
};

[[noreturn]] void refuse(const std::string& name, const std::string& reason) {
    throw UsageError(fmt::format("mixture '{}': {}", name, reason));
}

void settle_fractions(Mixture& mixture, const std::string& name,
                      const std::vector<std::optional<double>>& given) {
    const auto missing = std::count(given.begin(), given.end(), std::nullopt);
    const bool powder = std::string_view(mixture.rule->name) == "average" && given.size() == 2;
    double sum = 0;
    for (const auto& fraction : given) {
        if (!fraction) continue;
        if (!(*fraction >= 0 && *fraction <= 1))
            refuse(name, fmt::format("fraction {}; allowed: 0 to 1, or 0% to 100%", *fraction));
        sum += *fraction;
    }
    if (missing > 1 && !(powder && missing == 2))
        refuse(name,
               "write a fraction of the volume for all parts but one; allowed: TiO2:30%,SiO2");
    constexpr double kRounding = 1e-9;
    if (missing == 0 ? std::abs(sum - 1) > kRounding : sum > 1 + kRounding)
        refuse(name, fmt::format("the fractions add up to {}; allowed: 1", sum));
    const double powder_shares[] = {2.0 / 3.0, 1.0 / 3.0};
    for (std::size_t i = 0; i < given.size(); ++i) {
        const double rest = missing == 2 ? powder_shares[i] : std::max(0.0, 1 - sum);
        mixture.parts[i].fraction = given[i].value_or(rest);
    }
}

std::string join(const std::vector<std::string>& texts) {
    return fmt::format("{}", fmt::join(texts, "; "));
}

/// Nothing when the text is no RULE(...) of a known rule; "/mixture" may follow, the label of its
/// dataset. One fraction may be missing and is the rest; average(o,e) without any is that of a
/// powder of a uniaxial crystal, 2/3 and 1/3.
/// @throws UsageError  for parts that are missing or too many, and fractions that do not add up
std::optional<Mixture> parse_mixture(const std::string& asked) {
    const std::string name(without_blanks(asked));
    const auto call = parse_call(name, kLabel);
    if (!call) return std::nullopt;
    Mixture mixture;
    mixture.rule = find_mixing_rule(call->name);
    if (mixture.rule == nullptr) return std::nullopt;
    if (std::count(name.begin(), name.end(), '(') > 4)
        refuse(name, "more than 4 rules in one name");
    std::vector<std::optional<double>> given;
    for (const std::string& part : call->arguments) {
        // A colon without a number behind it belongs to a name (sopra:GAP).
        const std::size_t colon = part.rfind(':');
        const auto fraction =
            colon == std::string::npos ? std::nullopt : table_number(part.substr(colon + 1));
        given.push_back(fraction);
        mixture.parts.push_back(
            {std::string(without_blanks(fraction ? part.substr(0, colon) : part)), 0.0});
        if (mixture.parts.back().name.empty()) refuse(name, "a part without a name");
    }
    if (given.size() < 2 || given.size() > mixture.rule->most_parts) {
        refuse(name, fmt::format("{} part{}; {} takes {}", given.size(),
                                 given.size() == 1 ? "" : "s", mixture.rule->name,
                                 mixture.rule->most_parts == 2 ? "two" : "two or more"));
    }
    settle_fractions(mixture, name, given);
    return mixture;
}

/// Whether a part of unknown k is transparent: a dispersion formula, of the collections or of the
/// user, describes a material where it does not absorb.
bool is_transparent(const Dataset& part) {
    return (part.n && !part.n->tabulated()) || part.format == kModelLabel;
}

/// A part that nobody measured k of, beside one that absorbs, leaves the mixture's k unknown.
/// @param largest_k  of each part; 0: unknown, or none
void require_k(const Mixture& mixture, const std::string& name,
               const std::vector<Dataset>& datasets, const std::vector<double>& largest_k) {
    const auto absorbing = std::max_element(largest_k.begin(), largest_k.end());
    if (!(*absorbing > 0.0)) return;
    for (std::size_t i = 0; i < datasets.size(); ++i) {
        if (datasets[i].k || is_transparent(datasets[i])) continue;
        throw InputError(fmt::format(
            "mixture '{}': k of {} ({}/{}) is unknown, while {} absorbs (k up to {}); allowed: "
            "parts "
            "with known k, and parts given by a dispersion formula, which do not absorb",
            name, mixture.parts[i].name, datasets[i].material, datasets[i].label,
            mixture.parts[std::size_t(absorbing - largest_k.begin())].name, *absorbing));
    }
}

/// Tabulated at every wavelength of the parts' tables where all parts are known, and at seven
/// between any two of them.
/// @param datasets  of the parts, for titles, references and densities
/// @throws InputError  when the parts have no wavelength in common
Dataset mix(const Mixture& mixture, const std::string& name,
            const std::vector<RefractiveIndex>& indices, const std::vector<Dataset>& datasets) {
    double shortest_nm = 0, longest_nm = indices.front().longest_nm();
    for (const RefractiveIndex& index : indices) {
        shortest_nm = std::max(shortest_nm, index.shortest_nm());
        longest_nm = std::min(longest_nm, index.longest_nm());
    }
    if (!(shortest_nm < longest_nm)) {
        std::string ranges;
        for (std::size_t i = 0; i < indices.size(); ++i) {
            ranges += fmt::format("{}{} ({} to {} nm)", i > 0 ? ", " : "", mixture.parts[i].name,
                                  indices[i].shortest_nm(), indices[i].longest_nm());
        }
        throw InputError(
            fmt::format("mixture '{}': its parts have no range in common: {}", name, ranges));
    }
    std::set<double> grid{shortest_nm, longest_nm};
    for (const RefractiveIndex& index : indices) {
        for (const double w : index.table().wavelength_nm) {
            if (w > shortest_nm && w < longest_nm) grid.insert(w);
        }
    }
    // Between two rows of the parts the mixture may bend more than they do (a resonance of small
    // spheres of gold). Seven more wavelengths in each interval follow it closely enough that how
    // the mixture itself is interpolated does not matter.
    for (auto w = grid.begin(); std::next(w) != grid.end() && grid.size() < kMostWavelengths;) {
        const double first = *w, last = *++w;
        if (!(last > first * (1 + 1e-9))) continue;
        for (int i = 1; i < 8; ++i) grid.insert(w, 1 / (((8 - i) / first + i / last) / 8));
    }
    std::vector<double> wavelength_nm, n, k, largest_k(indices.size(), 0.0);
    for (const double w : grid) {
        // Wavelengths that differ by rounding alone: the same row of two tables.
        if (!wavelength_nm.empty() && !(w > wavelength_nm.back() * (1 + 1e-12))) continue;
        std::vector<MixturePart> parts;
        for (std::size_t i = 0; i < indices.size(); ++i) {
            const std::complex<double> m = indices[i].at(w);
            parts.push_back({m * m, mixture.parts[i].fraction});
            largest_k[i] = std::max(largest_k[i], m.imag());
        }
        const std::complex<double> m = std::sqrt(mixture.rule->permittivity(parts));
        wavelength_nm.push_back(w);
        n.push_back(m.real());
        k.push_back(std::max(0.0, m.imag()));
    }

    Dataset mixed;
    mixed.material = name;
    mixed.label = kLabel;
    mixed.source = "mixing rule";
    mixed.format = "mixture";
    mixed.n = make_table(Unit::nanometre, wavelength_nm, n);
    require_k(mixture, name, datasets, largest_k);
    const auto knows_k = [](const Dataset& part) { return part.k.has_value(); };
    const bool absorbs = *std::max_element(largest_k.begin(), largest_k.end()) > 0.0;
    if (absorbs || std::all_of(datasets.begin(), datasets.end(), knows_k))
        mixed.k = make_table(Unit::nanometre, wavelength_nm, k);
    for (const Dataset& part : datasets) {
        if (!mixed.k || part.k) continue;
        mixed.note += fmt::format(
            "{}k of {}/{} is 0, its dispersion formula being that of a "
            "transparent range",
            mixed.note.empty() ? "" : "; ", part.material, part.label);
    }
    std::vector<std::string> titles, references;
    if (*mixture.rule->reference != '\0') references.emplace_back(mixture.rule->reference);
    double density = 0;
    bool density_known = true;
    for (std::size_t i = 0; i < datasets.size(); ++i) {
        const Dataset& part = datasets[i];
        titles.push_back(
            fmt::format("{:.6g} {}/{}", mixture.parts[i].fraction, part.material, part.label));
        references.push_back(fmt::format("{}: {}", part.material, part.reference));
        density_known = density_known && part.density_g_cm3;
        density += mixture.parts[i].fraction * part.density_g_cm3.value_or(0.0);
    }
    mixed.title = fmt::format("{}: {}", mixture.rule->title, fmt::join(titles, " + "));
    mixed.reference = join(references);
    if (density_known) {
        mixed.density_g_cm3 = density;
        mixed.density_source = "of the parts, by volume";
    }
    return mixed;
}

}  // namespace

std::optional<Dataset> Database::mixture(const std::string& name) const {
    const auto parsed = parse_mixture(name);
    if (!parsed) return std::nullopt;
    std::vector<RefractiveIndex> indices;
    std::vector<Dataset> parts;
    for (const auto& part : parsed->parts) {
        indices.push_back(refractive_index(part.name));
        parts.push_back(dataset(part.name));
        const MaterialInfo material = info(part.name);
        if (!parts.back().density_g_cm3) parts.back().density_g_cm3 = material.density_g_cm3;
    }
    return mix(*parsed, name, indices, parts);
}

}  // namespace miebrdf::materials
