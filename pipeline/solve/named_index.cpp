#include "pipeline/solve/named_index.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <filesystem>

#include "pipeline/scene/medium_kinds.h"

namespace miebrdf {
namespace {

std::string source_line(const materials::MaterialInfo& info) {
    // A table of one's own may come without title and reference.
    std::vector<std::string> parts;
    for (const std::string* part : {&info.title, &info.reference}) {
        if (!part->empty()) parts.push_back(*part);
    }
    if (parts.empty()) parts = {fmt::format("dataset {}, {}", info.default_dataset, info.source)};
    std::string line = fmt::format("{}: {}", info.name, fmt::join(parts, "; "));
    if (!info.k_known) line += "; k was not measured and is taken as 0";
    return line;
}

}  // namespace

Materials::Materials(const std::string& file, const materials::IndexOptions& options)
    : file_(file), options_(options) {
    if (!file.empty() && !std::filesystem::exists(file)) {
        throw InputError(fmt::format("materials database '{}' does not exist", file));
    }
}

materials::Database& Materials::open() {
    if (!database_) {
        database_.emplace(materials::Database::layered(
            file_.empty() ? materials::default_user_database() : std::filesystem::path(file_)));
    }
    return *database_;
}

materials::RefractiveIndex Materials::index(const std::string& name) {
    return open().refractive_index(name, options_);
}

ResolvedIndex resolve_index(const Species& species, const std::vector<double>& wavelength_nm,
                            double k_floor, Materials& materials) {
    ResolvedIndex resolved;
    const auto add = [&](std::complex<double> n_ik) {
        resolved.index.emplace_back(n_ik.real(), std::max(n_ik.imag(), k_floor));
    };
    if (species.kind == "index") {
        resolved.source = describe(Species{.kind = species.kind, .parameters = species.parameters});
        for (std::size_t w = 0; w < wavelength_nm.size(); ++w)
            add({species.parameters[0], species.parameters[1]});
        return resolved;
    }
    const bool own = species.kind == "table";
    const auto table = own ? own_index(species) : materials.index(species.name);
    resolved.source = own ? fmt::format("{}: n + ik as given, at {} wavelengths", species.name,
                                        species.index.size())
                          : source_line(materials.open().info(species.name));
    std::size_t outside = 0;
    for (const double nm : wavelength_nm) {
        add(table.at(nm));
        outside += !table.covers(nm);
    }
    if (outside > 0) {
        resolved.source += fmt::format(
            "; {} of {} wavelengths are outside {} to {} nm: values of "
            "the nearer end",
            outside, wavelength_nm.size(), table.shortest_nm(), table.longest_nm());
    }
    return resolved;
}

ResolvedIndex resolve_index(const Species& species, const std::vector<double>& wavelength_nm,
                            const std::string& database, double k_floor) {
    Materials materials(database);
    return resolve_index(species, wavelength_nm, k_floor, materials);
}

}  // namespace miebrdf
