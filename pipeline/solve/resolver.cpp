#include "pipeline/solve/resolver.h"

#include <fmt/format.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "pipeline/cache/job_key.h"
#include "pipeline/scene/medium_kinds.h"
#include "pipeline/scene/species_keys.h"
#include "pipeline/solve/amounts.h"
#include "pipeline/solve/coated.h"
#include "pipeline/solve/grain_shape.h"
#include "pipeline/solve/sampled_spectrum.h"

namespace miebrdf {
namespace {

/// Particles of the index of their host scatter nothing, and an albedo has no meaning.
void require_contrast(const ResolvedSpecies& species) {
    // Quotients of equal numbers are 1; what differs by rounding alone is no contrast either.
    constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
    for (const Particles& at : species.particles) {
        const auto has_none = [&](std::complex<double> index) {
            return std::abs(index / at.host_index - 1.0) <= kRounding;
        };
        if (!all_layers(at, has_none)) continue;
        throw UsageError(fmt::format(
            "{}: its refractive index at {} nm is that of its host, {}: without contrast nothing "
            "scatters; give another medium or another host_index",
            describe(species.species), at.wavelength_nm, at.host_index));
    }
}

/// Effective radius of particles by their surface: volume over mean projected area is r_eff 4/3,
/// and convex bodies have four times the surface of that area (Cauchy).
double radius_of_surface_um(const Species& species, std::optional<double> of_material_g_cm3) {
    const std::optional<double> density =
        species.density_g_cm3 ? species.density_g_cm3 : of_material_g_cm3;
    if (!density) {
        throw UsageError(
            fmt::format("medium '{}': a specific surface needs a density; give it in g/cm3, e.g. "
                        "density=2.5",
                        describe(species)));
    }
    // 1 cm3/g over 1 m2/kg is 1e3 um.
    return 3.0e3 / (*density * *species.sizes.specific_surface_m2_per_kg);
}

/// Sizes of species that bring their optics and an extinction.
void set_given_sizes(ResolvedSpecies& resolved) {
    resolved.effective_radius_um = resolved.given->radius_um(resolved.wavelength_nm.front());
    resolved.outer_radius_um = resolved.effective_radius_um;
    resolved.density_g_cm3 = resolved.species.density_g_cm3;
    if (!resolved.density_g_cm3) resolved.density_g_cm3 = resolved.given->density_g_cm3();
    if (const auto sizes = resolved.given->sizes()) resolved.sizes = *sizes;
}

/// A list of moments or coefficients whose end is not small was cut; short ones may be whole.
std::string cut_note(const Species& species) {
    constexpr double kSmall = 0.01;
    constexpr std::size_t kShort = 16;
    const auto note = [&](std::size_t count, double last) {
        if (count < kShort || std::abs(last) <= kSmall) return std::string();
        return fmt::format(
            "{}: its moments end at l = {} with (2l + 1) chi_l = {:.3g}, which is not small: they "
            "look cut, and the forward peak may be less than it is",
            describe(species), count - 1, last);
    };
    std::string found;
    if (species.kind == Species::Kind::moments && !species.chi.empty())
        found =
            note(species.chi.size(), (2.0 * double(species.chi.size()) - 1.0) * species.chi.back());
    for (const MatrixCoefficients& matrix : species.matrices) {
        if (found.empty()) found = note(matrix.a1.size(), matrix.a1.back());
    }
    return found;
}

std::string key_of(const ResolvedMedium& medium, std::size_t w) {
    const double host = medium.host_absorption[w];
    const ResolvedSpecies& first = medium.species.front();
    if (medium.species.size() == 1 && host == 0.0 && !first.crowded) return first.key[w];
    JobKey key("mixture");
    for (const ResolvedSpecies& species : medium.species)
        key.add(species.key[w]).add(species.volume_fraction);
    return key.add(host).add(first.crowded).hash();
}

/// Size parameters of the host's k. Mie theory takes the host's real part and leaves its absorption
/// to the light between the particles. The far field of an absorbing host (Mishchenko & Yang 2018,
/// J. Quant. Spectrosc. Radiat. Transfer 205, 241) has another scattering cross-section, by 1.6 k x
/// to within 0.4 k x for x of 3 to 50 and indices of 1 to 2.7 in 1.33 and 1.5, and g changes by
/// less than 0.3 k x: a note says so beyond 0.01, and beyond 0.1 a cross-section per particle no
/// longer says what a layer scatters.
constexpr double kWeakHost = 0.01, kOpaqueHost = 0.1, kChangePerDamping = 1.6;

/// Without amounts, a host is left out that takes less than this share of the light when particles
/// fill as little as this share of the volume.
constexpr double kNegligibleHost = 1e-3;
constexpr double kFewParticles = 0.01;

double absorption_per_um(double k, double wavelength_nm) {
    return 4.0e3 * std::numbers::pi * k / wavelength_nm;
}

/// Stands for the particles of a layer that has none: it asks for no work of its own.
ResolvedSpecies no_particles(const std::vector<double>& wavelength_nm) {
    const Species isotropic{.kind = Species::Kind::isotropic, .parameters = {1.0}};
    ResolvedSpecies none{.species = isotropic,
                         .given = kind_of(isotropic).given(isotropic),
                         .wavelength_nm = wavelength_nm,
                         .effective_radius_um = 1.0,
                         .volume_fraction = 0.0};
    for (std::size_t w = 0; w < wavelength_nm.size(); ++w) none.key.push_back(species_key(none, w));
    return none;
}

}  // namespace

/// Only numbers count: two names for the same figures are the same species. All members are named,
/// so that one which is added has to be looked at here.
std::string species_key(const ResolvedSpecies& resolved, std::size_t w) {
    // Crowding, and how much of it there is, belong to the mixture.
    const auto& [species, particles, given, wavelength_nm, size_distribution, effective_radius_um,
                 outer_radius_um, volume_per_core, volume_fraction, of_density, crowded, crowd,
                 spectrum, known_key] = resolved;
    const auto& [kind, name, parameters, chi, table_nm, matrices, index, scattering, sizes,
                 coatings, shape, phase, density_g_cm3, layer_density, amount] = species;
    JobKey key("species");
    if (!particles.empty()) {
        key.add(particles[w]).add(size_distribution).add(shape).add(phase);
        return spectrum ? key.add(spectrum->hash).hash() : key.hash();
    }
    key.add(kind).add(parameters).add(chi);
    const bool has_extinction = resolved.has_extinction();
    if (has_extinction || !matrices.empty()) {
        const rte::Optics optics = given->optics(wavelength_nm[w]);
        key.add(optics.single_scattering_albedo).add(optics.chi).add(bool(optics.phase));
        if (optics.polarisation) key.add<MatrixExpansion>(*optics.polarisation);
    }
    if (has_extinction) key.add(given->extinction(wavelength_nm[w]));
    return key.hash();
}

bool has_mirror(const Scene& scene) {
    return scene.substrate && scene.substrate->kind == Substrate::Kind::mirror;
}

bool has_host(const Host& host) { return !host.name.empty() || host.index != 1.0; }

Resolver::Resolver(const Scene& scene, double example_wavelength_nm, NamedIndexMemo* memo,
                   const IndexShift* shift)
    : scene_(scene),
      example_wavelength_nm_(example_wavelength_nm),
      tells_crowding_(memo == nullptr || memo->tells_crowding),
      spectrum_nm_(memo == nullptr ? std::vector<double>() : memo->spectrum_nm),
      materials_(scene.database, scene.index, memo) {
    if (shift != nullptr) materials_.shift = *shift;
}

ResolvedMedium Resolver::medium(const Medium& medium, const std::vector<double>& wavelength_nm,
                                double optical_depth) {
    ResolvedMedium resolved{.medium = medium};
    const bool by_extinction = has_extinction(medium.species.front());
    const bool needs_host = by_extinction || scene_.boundary || has_mirror(scene_);
    const HostAt host = needs_host ? look_up(host_of(scene_, medium), wavelength_nm) : HostAt{};
    const HostAt spectrum_host = needs_host && !spectrum_nm_.empty()
                                     ? look_up(host_of(scene_, medium), spectrum_nm_)
                                     : HostAt{};
    for (const Species& species : medium.species)
        resolved.species.push_back(this->species(species, wavelength_nm, host, spectrum_host));
    set_amounts(resolved, layer_density_kg_m3(scene_, medium), host.density_g_cm3);
    const bool is_host_alone = has_no_particles(medium);
    if (is_host_alone) resolved.species = {no_particles(wavelength_nm)};
    if (by_extinction) set_host_absorption(host, wavelength_nm, optical_depth, resolved);
    resolved.host_absorption.resize(wavelength_nm.size(), 0.0);
    for (const std::complex<double> index : host.index) resolved.host_index.push_back(index.real());
    if (!is_host_alone) {
        set_effective_host(resolved);
        set_packing(resolved);
    }
    for (std::size_t w = 0; w < wavelength_nm.size(); ++w)
        resolved.key.push_back(key_of(resolved, w));
    return resolved;
}

ResolvedMedium Resolver::base(const Medium& medium, const std::vector<double>& wavelength_nm) {
    ResolvedMedium resolved = this->medium(medium, wavelength_nm);
    require_depth(resolved);
    return resolved;
}

ResolvedMedium Resolver::host_alone(const Medium& medium,
                                    const std::vector<double>& wavelength_nm) {
    const ResolvedSpecies none = no_particles(wavelength_nm);
    ResolvedMedium resolved{.medium = {{none.species}, host_of(scene_, medium)}};
    resolved.species = {none};
    resolved.key = none.key;
    resolved.host_absorption.assign(wavelength_nm.size(), 0.0);
    resolved.host_index = real_index(host_of(scene_, medium), wavelength_nm);
    return resolved;
}

ResolvedDepth Resolver::depth(const Layer& layer, const ResolvedMedium& medium) {
    ResolvedDepth resolved{.depth = layer.depth, .optical_depth = layer.depth.value};
    const Depth& depth = layer.depth;
    if (depth.kind != Depth::Kind::optical_depth) {
        require_particles(layer);
        resolved.column_um = column_um(depth, medium);
    } else if (medium.has_extinction() && depth.wavelength_nm > 0.0 && !std::isinf(depth.value)) {
        resolved.reference = reference(layer);
        require_depth(*resolved.reference);
    } else if (depth.value > 0.0) {
        require_depth(medium);
    }
    return resolved;
}

ResolvedIndex Resolver::index(const Species& species, const std::vector<double>& wavelength_nm) {
    return resolve_index(species, wavelength_nm, scene_.particles.k_floor, materials_);
}

ResolvedIndex Resolver::mirror(const Host& of, const std::vector<double>& wavelength_nm) {
    if (of.name.empty()) return {std::vector(wavelength_nm.size(), of.index), ""};
    const Species material{.kind = Species::Kind::material, .name = of.name};
    return resolve_index(material, wavelength_nm, 0.0, materials_);
}

std::vector<double> Resolver::real_index(const Host& host,
                                         const std::vector<double>& wavelength_nm) {
    std::vector<double> real;
    for (const std::complex<double> index : look_up(host, wavelength_nm).index)
        real.push_back(index.real());
    return real;
}

void Resolver::add_once(std::vector<std::string>& lines, std::string line) {
    if (std::find(lines.begin(), lines.end(), line) == lines.end())
        lines.push_back(std::move(line));
}

Resolver::HostAt Resolver::look_up(const Host& host, const std::vector<double>& wavelength_nm) {
    HostAt at{.name = describe(host)};
    if (host.name.empty()) {
        at.index.assign(wavelength_nm.size(), host.index);
        return at;
    }
    const Species material{.kind = Species::Kind::material, .name = host.name};
    try {
        ResolvedIndex found = resolve_index(material, wavelength_nm, 0.0, materials_);
        at.index = std::move(found.index);
        at.density_g_cm3 = found.density_g_cm3;
        add_source("host " + found.source);
    } catch (const InputError& error) {
        throw InputError(fmt::format("host '{}': {}", host.name, error.what()));
    }
    return at;
}

std::vector<Particles> Resolver::particles(const ResolvedIndex& index,
                                           const std::vector<double>& wavelength_nm,
                                           const HostAt& host) {
    std::vector<Particles> all;
    for (std::size_t w = 0; w < wavelength_nm.size(); ++w)
        all.push_back({wavelength_nm[w], index.index[w], host.index[w].real()});
    return all;
}

ResolvedSpecies Resolver::species(const Species& species, const std::vector<double>& wavelength_nm,
                                  const HostAt& host, const HostAt& spectrum_host) {
    ResolvedSpecies resolved{.species = species, .wavelength_nm = wavelength_nm};
    if (needs_mie(species)) {
        ResolvedIndex index = this->index(species, wavelength_nm);
        resolved.particles = particles(index, wavelength_nm, host);
        resolved.sizes = sizes_of(species, scene_.particles);
        if (species.sizes.specific_surface_m2_per_kg)
            resolved.sizes.effective_radius_um = radius_of_surface_um(species, index.density_g_cm3);
        resolved.effective_radius_um = mie::effective_radius_of(resolved.sizes);
        resolved.density_g_cm3 = index.density_g_cm3;
        add_source(std::move(index.source));
        if (!index.caveat.empty()) add_note(std::move(index.caveat));
        ResolvedSpecies spectrum = resolved;
        add_coatings(resolved, coatings(species, wavelength_nm));
        require_contrast(resolved);
        require_grains(resolved);
        if (can_be_sampled(resolved)) {
            if (!spectrum_nm_.empty()) {
                spectrum.particles =
                    particles(this->index(species, spectrum_nm_), spectrum_nm_, spectrum_host);
                add_coatings(spectrum, coatings(species, spectrum_nm_));
            }
            resolved.spectrum = spectrum_of(spectrum_nm_.empty() ? resolved : spectrum);
        }
    } else {
        add_source(describe(species));
        resolved.given = kind_of(species).given(species);
        if (has_extinction(species)) set_given_sizes(resolved);
        if (std::string note = cut_note(species); !note.empty()) add_note(std::move(note));
    }
    for (std::size_t w = 0; w < wavelength_nm.size(); ++w)
        resolved.key.push_back(species_key(resolved, w));
    return resolved;
}

std::vector<ResolvedIndex> Resolver::coatings(const Species& species,
                                              const std::vector<double>& wavelength_nm) {
    std::vector<ResolvedIndex> all;
    for (const Coating& coating : species.coatings) {
        const Host& of = coating.material;
        const Species material = of.name.empty()
                                     ? Species{.kind = Species::Kind::index,
                                               .parameters = {of.index.real(), of.index.imag()}}
                                     : Species{.kind = Species::Kind::material, .name = of.name};
        try {
            all.push_back(index(material, wavelength_nm));
        } catch (const InputError& error) {
            throw InputError(fmt::format("coating '{}': {}", describe(coating), error.what()));
        }
        add_source("coating " + all.back().source);
    }
    return all;
}

void Resolver::set_host_absorption(const HostAt& host, const std::vector<double>& wavelength_nm,
                                   double optical_depth, ResolvedMedium& medium) {
    medium.host_absorption.assign(wavelength_nm.size(), 0.0);
    if (!medium.has_amounts) {
        leave_out_host(host, wavelength_nm, optical_depth, medium);
        return;
    }
    for (std::size_t w = 0; w < host.index.size(); ++w) {
        const double k = host.index[w].imag();
        if (k == 0.0) continue;
        medium.host_absorption[w] =
            absorption_per_um(k, wavelength_nm[w]) * std::max(0.0, 1.0 - filled_volume(medium));
        note_strong_host(host, k, wavelength_nm[w], medium);
    }
}

void Resolver::leave_out_host(const HostAt& host, const std::vector<double>& wavelength_nm,
                              double optical_depth, const ResolvedMedium& medium) {
    double radius_um = 0.0;
    for (const ResolvedSpecies& species : medium.species)
        radius_um = std::max(radius_um, species.outer_radius_um);
    std::size_t worst = 0;
    double least_volume = 0.0;  // at which the host is weak
    for (std::size_t w = 0; w < host.index.size(); ++w) {
        // Particles extinguish 3 f Q / (4 r), about 3 f / (4 r); light crosses the layer's optical
        // depth, at least about once.
        const double volume = absorption_per_um(host.index[w].imag(), wavelength_nm[w]) *
                              (4.0 / 3.0) * radius_um * std::max(1.0, optical_depth) /
                              kNegligibleHost;
        if (!(volume > least_volume)) continue;
        least_volume = volume;
        worst = w;
    }
    if (least_volume == 0.0) return;
    const std::string text =
        fmt::format("(k {:.3g} at {} nm)", host.index[worst].imag(), wavelength_nm[worst]);
    if (least_volume <= kFewParticles) {
        add_once(notes_, fmt::format("what the host {} absorbs between the particles {} is left "
                                     "out: {} has no amounts; where they fill more than about "
                                     "{:.2g} % of the volume, it is below {} of the light",
                                     host.name, text, describe(medium.medium), 100.0 * least_volume,
                                     kNegligibleHost));
        return;
    }
    throw UsageError(fmt::format(
        "medium '{}': its host {} absorbs {}, so what absorbs between the particles depends on how "
        "many there are; give amounts, e.g. volume=15%, or a host that does not absorb, e.g. "
        "index:{:.4g}",
        describe(medium.medium), host.name, text, host.index[worst].real()));
}

void Resolver::note_strong_host(const HostAt& host, double k, double nm,
                                const ResolvedMedium& medium) {
    for (const ResolvedSpecies& species : medium.species) {
        const double kx = 2.0e3 * std::numbers::pi * species.outer_radius_um * k / nm;
        if (kx <= kWeakHost) continue;
        if (kx > kOpaqueHost) {
            throw UsageError(fmt::format(
                "medium '{}': its host {} absorbs so much within the size of {} that scattering by "
                "single particles is not defined (k x = {:.3g} at {} nm, k {:.3g}); allowed: up to "
                "{}; give smaller particles, a clearer host, or the optics of the layer from a "
                "file (moments:, matrix:)",
                describe(medium.medium), host.name, describe(species.species), kx, nm, k,
                kOpaqueHost));
        }
        add_once(notes_,
                 fmt::format(
                     "host {} absorbs noticeably within the particles of {} (k x = {:.2g} "
                     "at {} nm): Mie theory takes the real part of its index; the far field "
                     "of an absorbing host scatters about {:.0f} % more",
                     host.name, describe(species.species), kx, nm, 100.0 * kChangePerDamping * kx));
    }
}

void Resolver::require_particles(const Layer& layer) {
    if (has_extinction(layer.medium.species.front())) return;
    throw UsageError(
        fmt::format("coat {}@{}: its optics are given without an extinction; give an optical depth",
                    describe(layer.medium), describe(layer.depth)));
}

void Resolver::require_depth(const ResolvedMedium& medium) {
    if (!has_no_particles(medium.medium)) return;
    const auto clear = std::find(medium.host_absorption.begin(), medium.host_absorption.end(), 0.0);
    if (clear == medium.host_absorption.end()) return;
    const auto w = static_cast<std::size_t>(clear - medium.host_absorption.begin());
    throw UsageError(fmt::format(
        "medium '{}': all amounts are 0 and its host absorbs nothing at {} nm, so no thickness of "
        "it has an optical depth, and light that enters a half-space of it never comes back; "
        "allowed: a layer of some thickness (40um) over a substrate (black takes all light), an "
        "amount above 0, or a host that absorbs",
        describe(medium.medium), medium.species.front().wavelength_nm[w]));
}

ResolvedMedium Resolver::reference(const Layer& layer) {
    try {
        // Its notes are made at the wavelengths of the scene already, and a shift is of the index
        // there.
        const std::vector<std::string> notes = notes_;
        const std::optional<IndexShift> shift = std::exchange(materials_.shift, {});
        ResolvedMedium found = medium(layer.medium, {layer.depth.wavelength_nm}, layer.depth.value);
        materials_.shift = shift;
        notes_ = notes;
        return found;
    } catch (const InputError& error) {
        throw InputError(fmt::format(
            "coat {0}@{1}: an optical depth holds at {2} nm, where this material is not known "
            "({3}); give it at another wavelength, e.g. {4}[{5}nm], or the same at all, "
            "{4}[grey]",
            describe(layer.medium), describe(layer.depth), layer.depth.wavelength_nm, error.what(),
            layer.depth.value, example_wavelength_nm_));
    }
}

}  // namespace miebrdf
