#include "pipeline/solve/resolved_scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

#include <miebrdf/database.h>
#include "pipeline/cache/job_key.h"
#include "pipeline/scene/medium_kinds.h"
#include "pipeline/scene/particle_sizes.h"

namespace miebrdf {
namespace {

/// The user's own materials over the embedded ones, opened for the first medium that has a name:
/// scenes without names need no database.
class Materials {
  public:
    explicit Materials(const std::string& file, const materials::IndexOptions& options = {})
        : file_(file), options_(options) {
        if (!file.empty() && !std::filesystem::exists(file)) {
            throw InputError(fmt::format("materials database '{}' does not exist", file));
        }
    }

    materials::Database& open() {
        if (!database_) {
            database_.emplace(materials::Database::layered(
                file_.empty() ? materials::default_user_database() : std::filesystem::path(file_)));
        }
        return *database_;
    }

    materials::RefractiveIndex index(const std::string& name) {
        return open().refractive_index(name, options_);
    }

  private:
    std::string file_;
    materials::IndexOptions options_;
    std::optional<materials::Database> database_;
};

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

ResolvedIndex index_of(const Medium& medium, const std::vector<double>& wavelength_nm,
                       double k_floor, Materials& materials) {
    ResolvedIndex resolved;
    const auto add = [&](std::complex<double> n_ik) {
        resolved.index.emplace_back(n_ik.real(), std::max(n_ik.imag(), k_floor));
    };
    if (medium.kind == "index") {
        Medium bare = medium;
        bare.sizes = {};
        resolved.source = describe(bare);
        for (std::size_t w = 0; w < wavelength_nm.size(); ++w)
            add({medium.parameters[0], medium.parameters[1]});
        return resolved;
    }
    const bool own = medium.kind == "table";
    const auto table = own ? own_index(medium) : materials.index(medium.name);
    resolved.source = own ? fmt::format("{}: n + ik as given, at {} wavelengths", medium.name,
                                        medium.index.size())
                          : source_line(materials.open().info(medium.name));
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

/// Particles of the index of their host scatter nothing, and an albedo has no meaning.
void require_contrast(const ResolvedMedium& medium, const std::vector<double>& wavelength_nm,
                      double host_index) {
    // Quotients of equal numbers are 1; what differs by rounding alone is no contrast either.
    constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
    for (std::size_t w = 0; w < medium.index.size(); ++w) {
        if (std::abs(medium.index[w] / host_index - 1.0) > kRounding) continue;
        throw UsageError(fmt::format(
            "{}: its refractive index at {} nm is that of its host, {}: without contrast nothing "
            "scatters; give another medium or another host_index",
            describe(medium.medium), wavelength_nm[w], host_index));
    }
}

/// Only numbers count: two names for the same figures are the same medium.
std::string key_of(const ResolvedMedium& medium, std::size_t w, double nm, double host_index) {
    JobKey key("medium");
    if (medium.needs_mie()) {
        key.add(medium.index[w]).add(nm).add(medium.sizes).add(host_index);
    } else {
        key.add(std::string_view(medium.medium.kind)).add(medium.medium.parameters);
        key.add(medium.medium.chi);
    }
    return key.hash();
}

ResolvedMedium resolve_medium(const Medium& medium, const Scene& scene,
                              const std::vector<double>& wavelength_nm, Materials& materials,
                              std::vector<std::string>& sources) {
    ResolvedMedium resolved{.medium = medium};
    std::string source = describe(medium);
    if (needs_mie(medium)) {
        ResolvedIndex index = index_of(medium, wavelength_nm, scene.particles.k_floor, materials);
        resolved.index = std::move(index.index);
        source = std::move(index.source);
        resolved.sizes = sizes_of(medium, scene.particles);
        require_contrast(resolved, wavelength_nm, scene.particles.host_index);
    }
    if (std::find(sources.begin(), sources.end(), source) == sources.end())
        sources.push_back(std::move(source));
    for (std::size_t w = 0; w < wavelength_nm.size(); ++w) {
        resolved.key.push_back(key_of(resolved, w, wavelength_nm[w], scene.particles.host_index));
    }
    return resolved;
}

void resolve_surface(const Scene& scene, Materials& materials, ResolvedScene& resolved) {
    resolved.surface = scene.surface;
    resolved.coupling = scene.coupling;
    if (!scene.surface) return;
    if (scene.surface_index) {
        resolved.surface_index.assign(resolved.wavelength_nm.size(), *scene.surface_index);
        return;
    }
    const Medium& top = top_medium(scene);
    if (!needs_mie(top)) {
        throw UsageError(fmt::format(
            "the surface of '{}' has no refractive index; give surface_index, or leave the "
            "surface out",
            describe(top)));
    }
    ResolvedIndex index = index_of(top, resolved.wavelength_nm, scene.particles.k_floor, materials);
    resolved.surface_index = std::move(index.index);
    auto& sources = resolved.sources;
    if (std::find(sources.begin(), sources.end(), index.source) == sources.end())
        sources.push_back(std::move(index.source));
}

}  // namespace

ResolvedScene resolve(const Scene& scene, const std::vector<double>& wavelength_nm) {
    Materials materials(scene.database, scene.index);
    ResolvedScene resolved{.wavelength_nm = wavelength_nm, .particles = scene.particles};
    const auto add = [&](const Medium& medium) {
        resolved.media.push_back(
            resolve_medium(medium, scene, wavelength_nm, materials, resolved.sources));
    };
    add(scene.base);
    for (const Layer& layer : scene.layers) {
        if (layer.optical_depth == 0.0) {
            resolved.empty_layers.push_back(layer);
            continue;
        }
        add(layer.medium);
        resolved.optical_depth.push_back(layer.optical_depth);
    }
    resolve_surface(scene, materials, resolved);
    return resolved;
}

ResolvedIndex resolve_index(const Medium& medium, const std::vector<double>& wavelength_nm,
                            const std::string& database, double k_floor) {
    Materials materials(database);
    return index_of(medium, wavelength_nm, k_floor, materials);
}

void ResolvedScene::add_to(JobKey& key, std::size_t wavelength) const {
    for (std::size_t i = 0; i < media.size(); ++i) {
        if (i > 0) key.add(optical_depth[i - 1]);
        key.add(std::string_view(media[i].key[wavelength]));
    }
}

}  // namespace miebrdf
