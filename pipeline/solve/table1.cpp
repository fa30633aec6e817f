#include <fmt/format.h>
#include <fmt/ranges.h>
#include <miebrdf/error.h>
#include <miebrdf/table1.h>

#include <algorithm>
#include <numbers>

#include <miebrdf/surface.h>
#include "pipeline/solve/named_index.h"
#include "pipeline/solve/parallel.h"

namespace miebrdf {

const std::vector<Table1Convention>& table1_conventions() {
    using enum rte::MicrofacetDistribution;
    using enum rte::Shadowing;
    using enum rte::FresnelKind;
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
         0.0034},
    };
    return conventions;
}

const Table1Convention& table1_convention(const std::string& name) {
    std::vector<std::string> names;
    for (const Table1Convention& convention : table1_conventions()) {
        if (convention.name == name) return convention;
        names.push_back(convention.name);
    }
    throw UsageError(
        fmt::format("unknown Table 1 convention '{}'; allowed: {}", name, fmt::join(names, ", ")));
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

namespace {

constexpr const char* kChannels[] = {"R", "G", "B"};

/// One entry still to be computed.
struct FactorCell {
    std::size_t medium;
    rte::SurfaceOptions surface;
    Table1Entry entry;
    std::size_t place = 0;  ///< of its wavelength among those of its medium
};

std::optional<double> printed_value(const std::string& material, std::size_t channel,
                                    const Table1Request& request) {
    if (!request.wavelength_nm.empty() || request.beckmann_alpha) return std::nullopt;
    for (const Table1Row& row : table1_printed()) {
        if (row.material == material) return row.factor[channel];
    }
    return std::nullopt;
}

std::vector<std::string> materials_of(const Table1Request& request) {
    if (!request.materials.empty()) return request.materials;
    std::vector<std::string> names;
    for (const Table1Row& row : table1_printed()) names.push_back(row.material);
    return names;
}

std::vector<FactorCell> list_cells(const std::vector<std::string>& materials,
                                   const Table1Request& request) {
    std::vector<FactorCell> cells;
    for (const Table1Convention& convention : request.conventions) {
        rte::SurfaceOptions surface = convention.surface;
        if (request.beckmann_alpha) surface.beckmann_alpha = *request.beckmann_alpha;
        const bool rgb = request.wavelength_nm.empty();
        const std::vector<double> wavelengths =
            rgb ? std::vector<double>(convention.rgb_nm.begin(), convention.rgb_nm.end())
                : request.wavelength_nm;
        for (std::size_t m = 0; m < materials.size(); ++m) {
            for (std::size_t w = 0; w < wavelengths.size(); ++w) {
                cells.push_back({m,
                                 surface,
                                 {convention.name, materials[m], rgb ? kChannels[w] : "",
                                  wavelengths[w], 0.0, printed_value(materials[m], w, request)},
                                 0});
            }
        }
    }
    return cells;
}

}  // namespace

Table1Result compute_table1(const Table1Request& request, const Control& control) {
    const std::vector<std::string> materials = materials_of(request);
    Table1Result result;
    std::vector<FactorCell> cells = list_cells(materials, request);
    std::vector<std::vector<double>> wavelengths(materials.size());
    for (FactorCell& cell : cells) {
        cell.place = wavelengths[cell.medium].size();
        wavelengths[cell.medium].push_back(cell.entry.wavelength_nm);
    }
    std::vector<ResolvedIndex> media;
    for (std::size_t m = 0; m < materials.size(); ++m) {
        const Species material{.kind = Species::Kind::material, .name = materials[m]};
        media.push_back(resolve_index(material, wavelengths[m], request.database));
        result.sources.push_back(media.back().source);
    }
    run_parallel("diffuse reflectance", cells.size(), control, [&](std::size_t i) {
        FactorCell& cell = cells[i];
        cell.entry.factor = rte::SurfaceLobe(media[cell.medium].index[cell.place], cell.surface)
                                .averaged_diffuse_reflectance_factor();
    });
    for (FactorCell& cell : cells) result.entries.push_back(std::move(cell.entry));
    return result;
}

}  // namespace miebrdf
