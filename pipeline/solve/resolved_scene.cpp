#include "pipeline/solve/resolved_scene.h"

#include <fmt/format.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "pipeline/cache/job_key.h"
#include "pipeline/scene/medium_kinds.h"
#include "pipeline/solve/resolver.h"
#include "pipeline/solve/rules.h"

namespace miebrdf {
namespace {

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

void name_surface_index(const ResolvedScene& resolved, const std::string& whose,
                        Resolver& resolver) {
    const std::complex<double> first = resolved.surface_index.front();
    resolver.add_source(fmt::format("surface of {}: n {:.4g}, k {:.4g} at {} nm", whose,
                                    first.real(), first.imag(), resolved.wavelength_nm.front()));
}

void resolve_surface(const Scene& scene, Resolver& resolver, ResolvedScene& resolved) {
    resolved.surface = scene.surface;
    resolved.coupling = scene.coupling.value_or(rte::SurfaceCoupling::paper);
    if (!scene.surface) return;
    if (scene.surface_index) {
        resolved.surface_index.assign(resolved.wavelength_nm.size(), *scene.surface_index);
        name_surface_index(resolved, "the index given", resolver);
        return;
    }
    const Medium& top = top_medium(scene);
    if (has_host(host_of(scene, top))) {
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
    const Species& only = top.species.front();
    ResolvedIndex index = only.coatings.empty() ? resolver.index(only, resolved.wavelength_nm)
                                                : resolver.mirror(only.coatings.back().material,
                                                                  resolved.wavelength_nm);
    resolved.surface_index = std::move(index.index);
    if (!index.source.empty()) resolver.add_source(std::move(index.source));
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

/// The acrylic paints of the embedded set have the scattering of their white as the unit of length.
void note_relative_pastes(const Scene& scene, Resolver& resolver) {
    const auto is_relative = [](const Species& species) {
        return species.kind == Species::Kind::paste && species.name.starts_with("acrylic_") &&
               species.name.find_first_of("./\\") == std::string::npos;
    };
    const auto look_at = [&](const Medium& medium, bool has_length) {
        const auto count = std::count_if(medium.species.begin(), medium.species.end(), is_relative);
        if (count == 0 || (!has_length && count == std::ptrdiff_t(medium.species.size()))) return;
        resolver.add_note(
            fmt::format("{}: the acrylic pastes are known by the ratio of absorption and "
                        "scattering alone (unit: "
                        "the scattering of their white per mm); thicknesses of them, and mixtures "
                        "with anything "
                        "but each other, have no absolute meaning",
                        describe(medium)));
    };
    if (!scene.substrate) look_at(scene.base, false);
    for (const Layer& layer : scene.layers)
        look_at(layer.medium, layer.depth.kind == Depth::Kind::thickness_um);
}

/// The host directly under the air: without layers it fills a film of varnish.
const Host& top_host(const Scene& scene) {
    const bool is_bare_ground = scene.layers.empty() && scene.substrate;
    return is_bare_ground ? scene.particles.host : host_of(scene, top_medium(scene));
}

/// Whether anything between the particles has another index than air.
bool refracts(const ResolvedScene& scene) {
    const auto is_step = [](double n) { return std::abs(n - 1.0) >= rte::kLeastIndexStep; };
    for (std::size_t w = 0; w < scene.wavelength_nm.size(); ++w) {
        if (is_step(scene.top_index(w))) return true;
        for (const ResolvedMedium& medium : scene.present_media())
            if (is_step(medium.host_index[w])) return true;
    }
    return false;
}

/// A host like air (1.0003) sends back less than 2 (n - 1) = 2e-3 of diffuse light, and facets
/// change a part of that: below it the boundary is smooth, since rough ones want 1.05.
void smooth_out_air(const Scene& scene, Resolver& resolver, ResolvedScene& resolved) {
    constexpr double kLikeAir = 1e-3;
    if (!resolved.boundary->is_rough()) return;
    for (std::size_t w = 0; w < resolved.wavelength_nm.size(); ++w) {
        const double step = resolved.top_index(w) - 1.0;
        if (!(step >= rte::kLeastIndexStep && step <= kLikeAir)) return;
    }
    resolved.boundary = rte::Boundary{.matrices = resolved.boundary->matrices};
    resolver.add_note(
        fmt::format("the boundary {} is taken as smooth: its host {} has nearly the index of air",
                    describe(*scene.boundary), describe(top_host(scene))));
}

void resolve_boundary(const Scene& scene, Resolver& resolver, ResolvedScene& resolved) {
    resolved.boundary = scene.boundary;
    note_missing_boundary(scene, resolver);
    note_relative_pastes(scene, resolver);
    if (!resolved.has_optical_steps()) return;
    resolved.scene_host_index = resolver.real_index(scene.particles.host, resolved.wavelength_nm);
    if (has_mirror(scene)) {
        ResolvedIndex mirror = resolver.mirror(scene.substrate->mirror, resolved.wavelength_nm);
        resolved.mirror_index = std::move(mirror.index);
        if (!mirror.source.empty()) resolver.add_source("mirror " + std::move(mirror.source));
    }
    if (!scene.boundary) return;
    if (!top_host(scene).name.empty())
        resolved.boundary->matrices = rte::BoundaryMatrices::interpolated;
    for (std::size_t w = 0; w < resolved.wavelength_nm.size(); ++w) {
        for (const ResolvedMedium& medium : resolved.present_media()) {
            const double index = medium.host_index[w];
            if (index >= rte::kLeastIndex && index <= rte::kLargestIndex) continue;
            throw UsageError(fmt::format(
                "boundary: the host of '{}' has the index {:.4g} at {} nm; allowed: 1 to 3",
                describe(medium.medium), index, resolved.wavelength_nm[w]));
        }
    }
    smooth_out_air(scene, resolver, resolved);
    if (!refracts(resolved)) {
        resolver.add_note(
            "the boundary changes nothing: what lies between the particles has the index of air; "
            "give its host (in PMMA, host_index 1.5)");
    }
}

/// An albedo of 1 surprises who thinks of real matter.
void note_no_absorption(const ResolvedScene& scene, Resolver& resolver) {
    const std::size_t all = scene.wavelength_nm.size();
    std::size_t count = 0;
    for (std::size_t w = 0; w < all; ++w) count += absorbs_nothing(scene, w) ? 1 : 0;
    if (count == 0) return;
    resolver.add_note(fmt::format(
        "nothing absorbs{}: the layers return all light that enters them; where that is not "
        "meant, give what absorbs (a k above 0, soot, a dark ground) or a k_floor (at 550 nm "
        "H2O_ice has 2e-9, soda_lime_glass 2e-7, dust_saharan 4e-3)",
        count == all ? "" : fmt::format(" at {} of {} wavelengths", count, all)));
}

void note_energy(const Substrate& ground, Resolver& resolver) {
    const rte::GroundEnergy energy = rte::energy_of(ground.brdf);
    if (energy.above_one_below_mu > 0.0) {
        resolver.add_note(
            fmt::format("{} returns more light than it gets at mu_in {:.2g} and below",
                        describe(ground), energy.above_one_below_mu));
    }
    if (energy.is_negative)
        resolver.add_note(describe(ground) + " has a BRDF below 0 in some directions");
}

}  // namespace

ResolvedScene resolve(const Scene& scene, const std::vector<double>& wavelength_nm,
                      NamedIndexMemo* memo, const IndexShift* shift) {
    Resolver resolver(scene, wavelength_nm.empty() ? kDepthWavelengthNm : wavelength_nm.front(),
                      memo, shift);
    ResolvedScene resolved{.wavelength_nm = wavelength_nm, .particles = scene.particles};
    if (scene.substrate) {
        resolved.substrate = scene.substrate->kind;
        for (const double nm : wavelength_nm)
            resolved.ground_albedo.push_back(ground_albedo_at(*scene.substrate, nm));
        resolver.add_source("substrate " + describe(*scene.substrate));
        if (scene.substrate->kind == Substrate::Kind::brdf) {
            resolved.ground = scene.substrate->brdf;
            note_energy(*scene.substrate, resolver);
        }
        resolved.media.emplace_back();
    } else {
        resolved.media.push_back(resolver.base(scene.base, wavelength_nm));
    }
    for (const Layer& layer : scene.layers) {
        if (layer.depth.value == 0.0) {
            resolved.empty_layers.push_back(layer);
            if (is_left_out(scene, layer)) continue;
            resolved.media.push_back(resolver.host_alone(layer.medium, wavelength_nm));
            resolved.depths.push_back({});
            continue;
        }
        const bool is_optical = layer.depth.kind == Depth::Kind::optical_depth;
        resolved.media.push_back(resolver.medium(
            layer.medium, wavelength_nm,
            is_optical ? layer.depth.value : std::numeric_limits<double>::infinity()));
        resolved.depths.push_back(resolver.depth(layer, resolved.media.back()));
    }
    resolve_surface(scene, resolver, resolved);
    resolve_boundary(scene, resolver, resolved);
    note_no_absorption(resolved, resolver);
    resolved.sources = resolver.take_sources();
    resolved.notes = resolver.take_notes();
    return resolved;
}

double ResolvedScene::top_index(std::size_t wavelength) const {
    if (!boundary) return 1.0;
    if (media.size() == first_medium()) return scene_host_index[wavelength];
    return media.back().host_index[wavelength];
}

void ResolvedScene::add_to(JobKey& key, std::size_t wavelength) const {
    key.add(substrate).add(boundary);
    if (has_optical_steps()) {
        key.add(scene_host_index[wavelength]);
        for (const ResolvedMedium& medium : present_media()) key.add(medium.host_index[wavelength]);
    }
    if (!mirror_index.empty()) key.add(mirror_index[wavelength]);
    if (substrate) key.add(ground_albedo[wavelength]);
    if (ground) key.add(ground->kind).add(std::span<const double>(ground->values));
    for (std::size_t i = first_medium(); i < media.size(); ++i) {
        key.add(media[i].key[wavelength]);
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
        if (follows) key.add(depth.reference->key.front());
    }
}

}  // namespace miebrdf
