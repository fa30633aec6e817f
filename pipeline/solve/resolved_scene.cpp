#include "pipeline/solve/resolved_scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>

#include <miebrdf/database.h>
#include "pipeline/cache/job_key.h"
#include "pipeline/scene/medium_kinds.h"
#include "pipeline/scene/species_keys.h"
#include "pipeline/solve/amounts.h"
#include "pipeline/solve/packing.h"

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

ResolvedIndex index_of(const Species& species, const std::vector<double>& wavelength_nm,
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

/// Particles of the index of their host scatter nothing, and an albedo has no meaning.
void require_contrast(const ResolvedSpecies& species) {
    // Quotients of equal numbers are 1; what differs by rounding alone is no contrast either.
    constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
    for (const Particles& at : species.particles) {
        if (std::abs(at.index / at.host_index - 1.0) > kRounding) continue;
        throw UsageError(fmt::format(
            "{}: its refractive index at {} nm is that of its host, {}: without contrast nothing "
            "scatters; give another medium or another host_index",
            describe(species.species), at.wavelength_nm, at.host_index));
    }
}

/// Only numbers count: two names for the same figures are the same species.
std::string key_of(const ResolvedSpecies& species, std::size_t w) {
    JobKey key("species");
    if (species.needs_mie()) {
        const Particles& at = species.particles[w];
        key.add(at.index).add(at.wavelength_nm).add(species.sizes).add(at.host_index);
    } else {
        key.add(std::string_view(species.species.kind)).add(species.species.parameters);
        key.add(species.species.chi);
    }
    return key.hash();
}

std::string key_of(const ResolvedMedium& medium, std::size_t w) {
    const double host = medium.host_absorption[w];
    const ResolvedSpecies& first = medium.species.front();
    if (medium.species.size() == 1 && host == 0.0 && !first.crowded) return first.key[w];
    JobKey key("mixture");
    for (const ResolvedSpecies& species : medium.species)
        key.add(std::string_view(species.key[w])).add(species.volume_fraction);
    return key.add(host).add(first.crowded).hash();
}

/// Notes beyond this: absorption of the host within a particle's size is no longer small.
constexpr double kWeakHost = 0.01;

bool has_mirror(const Scene& scene) {
    return scene.substrate && scene.substrate->kind == Substrate::Kind::mirror;
}

/// Looks up the parts of one scene.
class Resolver {
  public:
    /// @param some_nm  a wavelength at which the scene is wanted, for advice
    Resolver(const Scene& scene, double some_nm)
        : scene_(scene), some_nm_(some_nm), materials_(scene.database, scene.index) {}

    ResolvedMedium medium(const Medium& medium, const std::vector<double>& wavelength_nm) {
        ResolvedMedium resolved{.medium = medium};
        const bool needs_host = needs_mie(medium) || scene_.boundary || has_mirror(scene_);
        const HostAt host = needs_host ? look_up(host_of(scene_, medium), wavelength_nm) : HostAt{};
        for (const Species& species : medium.species)
            resolved.species.push_back(this->species(species, wavelength_nm, host));
        set_amounts(resolved, scene_.particles.layer_density_kg_m3, host.density_g_cm3);
        if (needs_mie(medium)) set_host_absorption(host, wavelength_nm, resolved);
        resolved.host_absorption.resize(wavelength_nm.size(), 0.0);
        for (const std::complex<double> index : host.index)
            resolved.host_index.push_back(index.real());
        set_packing(resolved);
        for (std::size_t w = 0; w < wavelength_nm.size(); ++w)
            resolved.key.push_back(key_of(resolved, w));
        return resolved;
    }

    ResolvedDepth depth(const Layer& layer, const ResolvedMedium& medium) {
        ResolvedDepth resolved{.depth = layer.depth, .optical_depth = layer.depth.value};
        const Depth& depth = layer.depth;
        if (depth.kind != Depth::Kind::optical_depth) {
            require_particles(layer);
            resolved.column_um = column_um(depth, medium);
        } else if (medium.needs_mie() && depth.wavelength_nm > 0.0 && !std::isinf(depth.value)) {
            resolved.reference = reference(layer);
        }
        return resolved;
    }

    ResolvedIndex index(const Species& species, const std::vector<double>& wavelength_nm) {
        return index_of(species, wavelength_nm, scene_.particles.k_floor, materials_);
    }

    ResolvedIndex mirror(const Host& of, const std::vector<double>& wavelength_nm) {
        if (of.name.empty()) return {std::vector(wavelength_nm.size(), of.index), ""};
        const Species material{.kind = "material", .name = of.name};
        return index_of(material, wavelength_nm, 0.0, materials_);
    }

    std::vector<double> real_index(const Host& host, const std::vector<double>& wavelength_nm) {
        std::vector<double> real;
        for (const std::complex<double> index : look_up(host, wavelength_nm).index)
            real.push_back(index.real());
        return real;
    }

    void add_note(std::string note) { add_once(notes_, std::move(note)); }
    void add_source(std::string source) { add_once(sources_, std::move(source)); }
    std::vector<std::string> take_sources() { return std::move(sources_); }
    std::vector<std::string> take_notes() { return std::move(notes_); }

  private:
    struct HostAt {
        std::string name = {};
        std::vector<std::complex<double>> index = {};
        std::optional<double> density_g_cm3 = {};
    };

    static void add_once(std::vector<std::string>& lines, std::string line) {
        if (std::find(lines.begin(), lines.end(), line) == lines.end())
            lines.push_back(std::move(line));
    }

    HostAt look_up(const Host& host, const std::vector<double>& wavelength_nm) {
        HostAt at{.name = describe(host)};
        if (host.name.empty()) {
            at.index.assign(wavelength_nm.size(), host.index);
            return at;
        }
        const Species material{.kind = "material", .name = host.name};
        try {
            ResolvedIndex found = index_of(material, wavelength_nm, 0.0, materials_);
            at.index = std::move(found.index);
            add_source("host " + found.source);
        } catch (const InputError& error) {
            throw InputError(fmt::format("host '{}': {}", host.name, error.what()));
        }
        at.density_g_cm3 = materials_.open().info(host.name).density_g_cm3;
        return at;
    }

    std::optional<double> density_of(const Species& species) {
        if (species.density_g_cm3 || species.kind != "material") return species.density_g_cm3;
        return materials_.open().info(species.name).density_g_cm3;
    }

    ResolvedSpecies species(const Species& species, const std::vector<double>& wavelength_nm,
                            const HostAt& host) {
        ResolvedSpecies resolved{.species = species};
        if (needs_mie(species)) {
            ResolvedIndex index = this->index(species, wavelength_nm);
            for (std::size_t w = 0; w < wavelength_nm.size(); ++w) {
                resolved.particles.push_back(
                    {wavelength_nm[w], index.index[w], host.index[w].real()});
            }
            resolved.sizes = sizes_of(species, scene_.particles);
            resolved.effective_radius_um = mie::effective_radius_of(resolved.sizes);
            resolved.density_g_cm3 = density_of(species);
            require_contrast(resolved);
            add_source(std::move(index.source));
        } else {
            add_source(describe(species));
        }
        for (std::size_t w = 0; w < wavelength_nm.size(); ++w)
            resolved.key.push_back(key_of(resolved, w));
        return resolved;
    }

    /// What lies between the particles absorbs as a species of albedo 0 would (Mie theory itself
    /// takes the real part of the host's index).
    void set_host_absorption(const HostAt& host, const std::vector<double>& wavelength_nm,
                             ResolvedMedium& medium) {
        medium.host_absorption.assign(wavelength_nm.size(), 0.0);
        for (std::size_t w = 0; w < host.index.size(); ++w) {
            const double k = host.index[w].imag();
            if (k == 0.0) continue;
            if (!medium.has_amounts) {
                throw UsageError(fmt::format(
                    "medium '{}': its host {} absorbs (k {:.3g} at {} nm), so what absorbs between "
                    "the particles depends on how many there are; give amounts, e.g. volume=15%, "
                    "or a host that does not absorb, e.g. index:{:.4g}",
                    describe(medium.medium), host.name, k, wavelength_nm[w], host.index[w].real()));
            }
            const double per_um = 4.0e3 * std::numbers::pi * k / wavelength_nm[w];
            medium.host_absorption[w] = per_um * std::max(0.0, 1.0 - filled_volume(medium));
            note_strong_host(host, k, wavelength_nm[w], medium);
        }
    }

    void note_strong_host(const HostAt& host, double k, double nm, const ResolvedMedium& medium) {
        for (const ResolvedSpecies& species : medium.species) {
            const double kx = 2.0e3 * std::numbers::pi * species.effective_radius_um * k / nm;
            if (kx <= kWeakHost) continue;
            add_once(notes_,
                     fmt::format("host {} absorbs noticeably within the particles of {}: Mie "
                                 "theory takes it as transparent (k x > {})",
                                 host.name, describe(species.species), kWeakHost));
        }
    }

    /// Beyond this share of the volume, what neighbours change is said.
    static constexpr double kCrowded = 0.05;

    void set_packing(ResolvedMedium& medium) {
        if (!medium.needs_mie()) return;
        const bool asked = scene_.particles.packing == Packing::percus_yevick;
        if (asked && !medium.has_amounts) {
            throw UsageError(fmt::format(
                "medium '{}': packing percus-yevick needs amounts; give volume=, mass= (with "
                "layer_density_kg_m3) or number=",
                describe(medium.medium)));
        }
        for (ResolvedSpecies& species : medium.species) {
            species.crowded = asked;
            if (asked || !medium.has_amounts || species.volume_fraction <= kCrowded) continue;
            if (const auto change = crowding(species, 0)) note_crowding(species, *change);
        }
    }

    void note_crowding(const ResolvedSpecies& species, double change) {
        add_once(notes_,
                 fmt::format("{} fills {:.3g} % of the volume: independent scattering is assumed; "
                             "hard spheres would have {:.3g} times the reduced scattering at {} nm "
                             "(packing percus-yevick)",
                             describe(species.species), 100.0 * species.volume_fraction, change,
                             species.particles.front().wavelength_nm));
    }

    static void require_particles(const Layer& layer) {
        if (needs_mie(layer.medium)) return;
        throw UsageError(fmt::format(
            "coat {}@{}: its optics are given without an extinction; give an optical depth",
            describe(layer.medium), describe(layer.depth)));
    }

    ResolvedMedium reference(const Layer& layer) {
        try {
            return medium(layer.medium, {layer.depth.wavelength_nm});
        } catch (const InputError& error) {
            throw InputError(fmt::format(
                "coat {0}@{1}: an optical depth holds at {2} nm, where this material is not known "
                "({3}); give it at another wavelength, e.g. {4}[{5}nm], or the same at all, "
                "{4}[grey]",
                describe(layer.medium), describe(layer.depth), layer.depth.wavelength_nm,
                error.what(), layer.depth.value, some_nm_));
        }
    }

    const Scene& scene_;
    double some_nm_;
    Materials materials_;
    std::vector<std::string> sources_, notes_;
};

double ground_albedo_at(const Substrate& ground, double nm) {
    if (ground.kind != Substrate::Kind::lambertian) return 0.0;
    const std::vector<double>& at = ground.wavelength_nm;
    if (at.size() < 2) return ground.albedo.front();
    if (!(nm >= at.front() && nm <= at.back())) {
        throw InputError(fmt::format("substrate '{}' has no albedo at {} nm; it covers {} to {} nm",
                                     describe(ground), nm, at.front(), at.back()));
    }
    const auto above = std::upper_bound(at.begin() + 1, at.end() - 1, nm);
    const auto i = static_cast<std::size_t>(above - at.begin());
    const double t = (nm - at[i - 1]) / (at[i] - at[i - 1]);
    return (1.0 - t) * ground.albedo[i - 1] + t * ground.albedo[i];
}

/// A surface is that of what lies between the particles, where there is anything but air.
bool has_host(const Host& host) { return !host.name.empty() || host.index != 1.0; }

void name_surface_index(const ResolvedScene& resolved, const std::string& whose,
                        Resolver& resolver) {
    const std::complex<double> first = resolved.surface_index.front();
    resolver.add_source(fmt::format("surface of {}: n {:.4g}, k {:.4g} at {} nm", whose,
                                    first.real(), first.imag(), resolved.wavelength_nm.front()));
}

void resolve_surface(const Scene& scene, Resolver& resolver, ResolvedScene& resolved) {
    resolved.surface = scene.surface;
    resolved.coupling = scene.coupling;
    if (!scene.surface) return;
    if (scene.surface_index) {
        resolved.surface_index.assign(resolved.wavelength_nm.size(), *scene.surface_index);
        name_surface_index(resolved, "the index given", resolver);
        return;
    }
    const Medium& top = top_medium(scene);
    if (needs_mie(top) && has_host(host_of(scene, top))) {
        resolved.surface_index = resolver.mirror(host_of(scene, top), resolved.wavelength_nm).index;
        name_surface_index(resolved, "the host " + describe(host_of(scene, top)), resolver);
        return;
    }
    if (!needs_mie(top) || top.species.size() > 1) {
        throw UsageError(fmt::format(
            "the surface of '{}' has no refractive index of its own; give surface_index, or leave "
            "the surface out",
            describe(top)));
    }
    ResolvedIndex index = resolver.index(top.species.front(), resolved.wavelength_nm);
    resolved.surface_index = std::move(index.index);
    resolver.add_source(std::move(index.source));
    name_surface_index(resolved, "the particles, " + describe(top), resolver);
}

/// Paint and varnish have a boundary that throws back more than half of the diffuse light inside.
void note_missing_boundary(const Scene& scene, Resolver& resolver) {
    if (scene.boundary || scene.surface || scene.layers.empty()) return;
    const Host& host = host_of(scene, scene.layers.back().medium);
    if (!scene.layers.back().medium.host || !has_host(host)) return;
    resolver.add_note(fmt::format(
        "light passes between air and the host {} as if there were no boundary; films of paint, "
        "varnish or ice have one (boundary smooth)",
        describe(host)));
}

void resolve_boundary(const Scene& scene, Resolver& resolver, ResolvedScene& resolved) {
    resolved.boundary = scene.boundary;
    note_missing_boundary(scene, resolver);
    if (!resolved.has_optical_steps()) return;
    resolved.scene_host_index = resolver.real_index(scene.particles.host, resolved.wavelength_nm);
    if (has_mirror(scene)) {
        ResolvedIndex mirror = resolver.mirror(scene.substrate->mirror, resolved.wavelength_nm);
        resolved.mirror_index = std::move(mirror.index);
        if (!mirror.source.empty()) resolver.add_source("mirror " + std::move(mirror.source));
    }
    if (!scene.boundary) return;
    for (std::size_t w = 0; w < resolved.wavelength_nm.size(); ++w) {
        for (std::size_t m = resolved.first_medium(); m < resolved.media.size(); ++m) {
            const double index = resolved.media[m].host_index[w];
            if (index >= rte::kLeastIndex && index <= rte::kLargestIndex) continue;
            throw UsageError(fmt::format(
                "boundary: the host of '{}' has the index {:.4g} at {} nm; allowed: 1 to 3",
                describe(resolved.media[m].medium), index, resolved.wavelength_nm[w]));
        }
    }
    if (std::abs(resolved.top_index(0) - 1.0) < rte::kLeastIndexStep) {
        resolver.add_note(
            "the boundary changes nothing: what lies between the particles of the top layer has "
            "the index of air; give its host (in PMMA, host_index 1.5)");
    }
}

}  // namespace

ResolvedScene resolve(const Scene& scene, const std::vector<double>& wavelength_nm) {
    Resolver resolver(scene, wavelength_nm.empty() ? kDepthWavelengthNm : wavelength_nm.front());
    ResolvedScene resolved{.wavelength_nm = wavelength_nm, .particles = scene.particles};
    if (scene.substrate) {
        resolved.substrate = scene.substrate->kind;
        for (const double nm : wavelength_nm)
            resolved.ground_albedo.push_back(ground_albedo_at(*scene.substrate, nm));
        resolver.add_source("substrate " + describe(*scene.substrate));
        resolved.media.emplace_back();
    } else {
        resolved.media.push_back(resolver.medium(scene.base, wavelength_nm));
    }
    for (const Layer& layer : scene.layers) {
        if (layer.depth.value == 0.0) {
            resolved.empty_layers.push_back(layer);
            continue;
        }
        resolved.media.push_back(resolver.medium(layer.medium, wavelength_nm));
        resolved.depths.push_back(resolver.depth(layer, resolved.media.back()));
    }
    resolve_surface(scene, resolver, resolved);
    resolve_boundary(scene, resolver, resolved);
    resolved.sources = resolver.take_sources();
    resolved.notes = resolver.take_notes();
    return resolved;
}

ResolvedIndex resolve_index(const Species& species, const std::vector<double>& wavelength_nm,
                            const std::string& database, double k_floor) {
    Materials materials(database);
    return index_of(species, wavelength_nm, k_floor, materials);
}

double ResolvedScene::top_index(std::size_t wavelength) const {
    if (!boundary) return 1.0;
    if (media.size() == first_medium()) return scene_host_index[wavelength];
    return media.back().host_index[wavelength];
}

void ResolvedScene::add_to(JobKey& key, std::size_t wavelength) const {
    key.add(substrate);
    key.add(boundary.has_value());
    if (boundary) key.add(boundary->roughness).add(boundary->distribution);
    if (has_optical_steps()) {
        key.add(scene_host_index[wavelength]);
        for (std::size_t i = first_medium(); i < media.size(); ++i)
            key.add(media[i].host_index[wavelength]);
    }
    if (!mirror_index.empty()) key.add(mirror_index[wavelength]);
    if (substrate) key.add(ground_albedo[wavelength]);
    for (std::size_t i = first_medium(); i < media.size(); ++i) {
        key.add(std::string_view(media[i].key[wavelength]));
        if (i == 0) continue;
        const ResolvedDepth& depth = depths[i - 1];
        key.add(depth.is_grey() || depth.reference ? depth.optical_depth : 0.0);
        key.add(depth.column_um);
        if (depth.column_um) {
            for (const ResolvedSpecies& species : media[i].species)
                key.add(species.volume_fraction);
        }
        // A depth given at this very wavelength is the same as a grey one.
        const bool follows =
            depth.reference && depth.depth.wavelength_nm != wavelength_nm[wavelength];
        key.add(follows);
        if (follows) key.add(std::string_view(depth.reference->key.front()));
    }
}

}  // namespace miebrdf
