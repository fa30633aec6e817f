#include "pipeline/solve/table1.h"

#include <algorithm>

#include <miebrdf/surface.h>
#include "pipeline/solve/parallel.h"

namespace miebrdf {
namespace {

constexpr const char* kChannels[] = {"R", "G", "B"};

/// One entry still to be computed.
struct Cell {
    std::size_t medium;
    rte::SurfaceOptions surface;
    Table1Entry entry;
};

std::optional<double> printed_value(const std::string& material, std::size_t channel,
                                    const Table1Request& request) {
    if (!request.wavelength_nm.empty() || request.beckmann_alpha) return std::nullopt;
    for (const rte::Table1Row& row : rte::table1_printed()) {
        if (row.material == material) return row.factor[channel];
    }
    return std::nullopt;
}

std::vector<std::string> materials_of(const Table1Request& request) {
    if (!request.materials.empty()) return request.materials;
    std::vector<std::string> names;
    for (const rte::Table1Row& row : rte::table1_printed()) names.push_back(row.material);
    return names;
}

std::vector<Cell> list_cells(const std::vector<std::string>& materials,
                             const Table1Request& request) {
    std::vector<Cell> cells;
    for (const rte::Table1Convention& convention : request.conventions) {
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
                                  wavelengths[w], 0.0, printed_value(materials[m], w, request)}});
            }
        }
    }
    return cells;
}

}  // namespace

Table1Result compute_table1(const Table1Request& request, const RunControl& control) {
    const std::vector<std::string> materials = materials_of(request);
    MediumResolver resolver(request.database);
    std::vector<ResolvedMedium> media;
    Table1Result result;
    for (const std::string& name : materials) {
        media.push_back(resolver.resolve(DatabaseMedium{name}));
        result.sources.push_back(media.back().source);
    }
    std::vector<Cell> cells = list_cells(materials, request);
    run_parallel("diffuse reflectance", cells.size(), control, [&](std::size_t i) {
        Cell& cell = cells[i];
        const auto index = media[cell.medium].index_at(cell.entry.wavelength_nm, 0.0);
        cell.entry.factor =
            rte::SurfaceLobe(*index, cell.surface).averaged_diffuse_reflectance_factor();
    });
    for (Cell& cell : cells) result.entries.push_back(std::move(cell.entry));
    return result;
}

}  // namespace miebrdf
