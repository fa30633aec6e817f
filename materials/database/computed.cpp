// Materials that are computed, as names like any other: "drude(1,9,0.07)", "temperature(Si,350K)".
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <tuple>
#include <vector>

#include <miebrdf/database.h>
#include "materials/database/models.h"
#include "materials/index/units.h"
#include "materials/readers/text.h"

namespace miebrdf::materials {
namespace {

constexpr std::string_view kTemperatureLabel = "temperature";

struct TemperatureName {
    std::string material;
    double temperature_k = 0.0;
};

/// temperature(NAME,350K) or temperature(NAME,77degC); nothing when the text is none.
std::optional<TemperatureName> parse_temperature(const std::string& name) {
    const auto call = parse_call(name, kTemperatureLabel);
    if (!call || call->name != "temperature") return std::nullopt;
    const auto refuse = [&](const std::string& reason) {
        throw UsageError(fmt::format("'{}': {}; write temperature(NAME,350K)", name, reason));
    };
    if (call->arguments.size() != 2) refuse("a material and a temperature are needed");
    std::string_view text = call->arguments[1];
    double zero_k = 0.0;
    if (text.ends_with("degC")) {
        text.remove_suffix(4);
        zero_k = 273.15;
    } else if (text.ends_with('K')) {
        text.remove_suffix(1);
    }
    const auto value = parse_number(text);
    if (!value || !(*value + zero_k > 0.0 && std::isfinite(*value)))
        refuse(fmt::format("'{}' is not a temperature", call->arguments[1]));
    return TemperatureName{call->arguments[0], *value + zero_k};
}

/// "liquid" in "Sinnock-liquid-122K" or "Liquid krypton at 122 K"; empty where nothing says it.
std::string phase_of(const DatasetInfo& d) {
    const std::string text = lower_case(d.label + " " + d.note);
    for (const std::string_view word : split_words(text, " -_,.;:()/\t\n")) {
        for (const std::string_view phase : {"gas", "liquid", "solid", "amorphous"}) {
            if (word == phase) return std::string(phase);
        }
        if (word == "vapour" || word == "vapor") return "gas";
    }
    return "";
}

/// Whether n + ik may be interpolated from one to the other: the same ray of the same phase.
bool are_alike(const DatasetInfo& a, const DatasetInfo& b) {
    const std::string phase_a = phase_of(a), phase_b = phase_of(b);
    return a.ray == b.ray && (phase_a == phase_b || phase_a.empty() || phase_b.empty());
}

std::string described(const DatasetInfo& d) {
    std::string text = fmt::format("{} K ({}/{}", *d.temperature_k, d.material, d.label);
    if (!d.ray.empty()) text += ", ray " + d.ray;
    const std::string phase = phase_of(d);
    if (!phase.empty()) text += ", " + phase;
    return text + (d.k_known ? ")" : ", k unknown)");
}

/// The two datasets around a temperature; twice the same where one has it. Of several pairs the one
/// of the default dataset's ray, then one with k known in both, then the closest, then the first.
/// @throws InputError  with the temperatures that there are
std::pair<DatasetInfo, DatasetInfo> around(const std::string& name, double temperature_k,
                                           const std::vector<DatasetInfo>& all) {
    std::vector<DatasetInfo> known;
    for (const DatasetInfo& d : all) {
        if (d.temperature_k && d.n_known && d.shortest_nm < d.longest_nm) known.push_back(d);
    }
    std::optional<std::pair<DatasetInfo, DatasetInfo>> best;
    std::tuple<bool, bool, double> best_rank;
    for (const DatasetInfo& colder : known) {
        for (const DatasetInfo& warmer : known) {
            const bool is_one = colder.label == warmer.label;
            const double distance = *warmer.temperature_k - *colder.temperature_k;
            const bool brackets =
                *colder.temperature_k <= temperature_k && temperature_k <= *warmer.temperature_k;
            if (!brackets || is_one != (distance == 0.0) || !are_alike(colder, warmer)) continue;
            const std::tuple rank(colder.ray != all.front().ray,
                                  !(colder.k_known && warmer.k_known), distance);
            if (best && !(rank < best_rank)) continue;
            best.emplace(colder, warmer);
            best_rank = rank;
        }
    }
    if (best) return *best;
    std::sort(known.begin(), known.end(), [](const DatasetInfo& a, const DatasetInfo& b) {
        return *a.temperature_k < *b.temperature_k;
    });
    std::vector<std::string> there;
    for (const DatasetInfo& d : known) there.push_back(described(d));
    throw InputError(
        fmt::format("'{}': {} K does not lie between two datasets of one ray and one phase: {}",
                    name, temperature_k,
                    there.empty() ? "none of them has a temperature"
                                  : fmt::format("{}", fmt::join(there, ", "))));
}

/// Between two datasets k can be interpolated where both know it, or where it is 0.
void require_alike(const std::string& name, const std::vector<double>& grid_nm,
                   const RefractiveIndex& colder, const RefractiveIndex& warmer) {
    // n^2 - 1 goes with the density: in hundreds of degrees a solid or liquid changes it by a few
    // percent, boiling changes it by a factor of hundreds.
    constexpr double kMostChange = 3.0;
    for (const double w : grid_nm) {
        const std::complex<double> cold = colder.at(w), warm = warmer.at(w);
        const double ratio = std::abs(cold * cold - 1.0) / std::abs(warm * warm - 1.0);
        if (!(ratio <= kMostChange && ratio >= 1.0 / kMostChange)) {
            throw InputError(fmt::format(
                "'{}': at {} nm the colder dataset has n + ik = {} + {}i, the warmer one {} + {}i; "
                "allowed: n^2 - 1 within a factor of {}, as of one phase",
                name, w, cold.real(), cold.imag(), warm.real(), warm.imag(), kMostChange));
        }
        if (colder.k_known() == warmer.k_known()) continue;
        const double k = (colder.k_known() ? cold : warm).imag();
        if (k == 0.0) continue;
        throw InputError(fmt::format(
            "'{}': k is {} at {} nm in the {} dataset and unknown in the other, so nothing lies "
            "between; name one of them, or import one with k",
            name, k, w, colder.k_known() ? "colder" : "warmer"));
    }
}

std::vector<double> common_grid(const RefractiveIndex& a, const RefractiveIndex& b,
                                double shortest_nm, double longest_nm) {
    std::vector<double> grid{shortest_nm, longest_nm};
    for (const RefractiveIndex* index : {&a, &b}) {
        for (const double w : index->table().wavelength_nm) {
            if (w > shortest_nm && w < longest_nm) grid.push_back(w);
        }
    }
    std::sort(grid.begin(), grid.end());
    grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
    return grid;
}

/// n and k linear in temperature between two datasets.
IndexFunction between(const std::string& name, const RefractiveIndex& colder,
                      const RefractiveIndex& warmer, double share_of_warmer) {
    IndexFunction function;
    function.shortest_nm = std::max(colder.shortest_nm(), warmer.shortest_nm());
    function.longest_nm = std::min(colder.longest_nm(), warmer.longest_nm());
    if (!(function.shortest_nm < function.longest_nm)) {
        throw InputError(fmt::format(
            "'{}': its datasets have no range in common: {} to {} nm and {} to {} nm", name,
            colder.shortest_nm(), colder.longest_nm(), warmer.shortest_nm(), warmer.longest_nm()));
    }
    function.grid_nm = common_grid(colder, warmer, function.shortest_nm, function.longest_nm);
    require_alike(name, function.grid_nm, colder, warmer);
    function.k_known = colder.k_known() && warmer.k_known();
    function.at = [colder, warmer, share_of_warmer](double wavelength_nm) {
        return (1.0 - share_of_warmer) * colder.at(wavelength_nm) +
               share_of_warmer * warmer.at(wavelength_nm);
    };
    return function;
}

/// A dataset whose figures are those of the index at its own grid.
Dataset sampled(const std::string& name, std::string_view label, const RefractiveIndex& index) {
    Dataset dataset;
    dataset.material = name;
    dataset.label = label;
    dataset.format = label;
    IndexTable table = index.table();
    dataset.n = make_table(Unit::nanometre, table.wavelength_nm, std::move(table.n));
    if (table.k_known)
        dataset.k = make_table(Unit::nanometre, table.wavelength_nm, std::move(table.k));
    return dataset;
}

}  // namespace

std::optional<Database::Computed> Database::computed(const std::string& name,
                                                     const IndexOptions& options) const {
    if (auto model = parse_model(name)) {
        RefractiveIndex index(name, std::move(model->index), options);
        Dataset dataset = sampled(name, kModelLabel, index);
        dataset.title = model->title;
        dataset.source = "model";
        dataset.reference = model->reference;
        return Computed{std::move(dataset), std::move(index)};
    }
    const auto asked = parse_temperature(name);
    if (!asked) return std::nullopt;
    const auto [colder, warmer] = around(name, asked->temperature_k, datasets(asked->material));
    const std::string cold_name = colder.material + "/" + colder.label,
                      warm_name = warmer.material + "/" + warmer.label;
    const double distance = *warmer.temperature_k - *colder.temperature_k;
    const double share =
        distance > 0.0 ? (asked->temperature_k - *colder.temperature_k) / distance : 0.0;
    RefractiveIndex index(name,
                          between(name, refractive_index(cold_name, options),
                                  refractive_index(warm_name, options), share),
                          options);
    Dataset dataset = sampled(name, kTemperatureLabel, index);
    dataset.title = fmt::format("{} at {} K: {:.6g} {} + {:.6g} {}", colder.material,
                                asked->temperature_k, 1.0 - share, cold_name, share, warm_name);
    dataset.source = "interpolation in temperature";
    dataset.reference = colder.reference == warmer.reference
                            ? colder.reference
                            : colder.reference + "; " + warmer.reference;
    dataset.temperature_k = asked->temperature_k;
    const MaterialInfo material = info(asked->material);
    dataset.density_g_cm3 = material.density_g_cm3;
    dataset.density_source = material.density_source;
    return Computed{std::move(dataset), std::move(index)};
}

std::optional<Dataset> Database::unstored(const std::string& name) const {
    if (auto mixed = mixture(name)) return mixed;
    if (auto made = computed(name)) return std::move(made->dataset);
    return std::nullopt;
}

}  // namespace miebrdf::materials
