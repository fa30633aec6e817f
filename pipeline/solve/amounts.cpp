#include "pipeline/solve/amounts.h"

#include <fmt/format.h>

#include <algorithm>

#include <miebrdf/error.h>
#include <miebrdf/sizes.h>
#include "pipeline/scene/medium_kinds.h"
#include "pipeline/scene/scene_parts.h"

namespace miebrdf {
namespace {

constexpr double kKgPerM3 = 1000.0;  // of 1 g/cm3
constexpr double kFractionRounding = 1e-12;

bool fills_layer(const ResolvedSpecies& species) { return kind_of(species.species).fills_layer; }

bool has_kind(const ResolvedSpecies& species, Amount::Kind kind) {
    return species.species.amount && species.species.amount->kind == kind;
}

double density_of(const ResolvedSpecies& species) {
    if (species.density_g_cm3) return *species.density_g_cm3;
    throw UsageError(
        fmt::format("medium '{}': no density is known, and masses need one; give it in g/cm3, e.g. "
                    "{},density=2.5",
                    describe(species.species), describe(species.species)));
}

/// By mass: its fraction, or the rest of all others.
double mass_fraction_of(const ResolvedSpecies& species, double sum_of_others) {
    return species.species.amount ? species.species.amount->value : 1.0 - sum_of_others;
}

/// Volume fractions of species that are all given by mass.
void set_by_mass(ResolvedMedium& medium, std::optional<double> layer_density_kg_m3,
                 std::optional<double> host_density_g_cm3) {
    double sum = 0.0;
    bool has_rest = false;
    for (const ResolvedSpecies& species : medium.species) {
        if (species.species.amount) sum += species.species.amount->value;
        has_rest = has_rest || !species.species.amount;
    }
    double volume_per_mass = 0.0;  // cm3/g of layer
    for (ResolvedSpecies& species : medium.species) {
        species.volume_fraction = mass_fraction_of(species, sum) / density_of(species);
        volume_per_mass += species.volume_fraction;
    }
    const bool is_whole = has_rest || sum >= 1.0 - kFractionRounding;
    double layer_density = 0.0;  // g/cm3
    if (layer_density_kg_m3) {
        layer_density = *layer_density_kg_m3 / kKgPerM3;
    } else if (is_whole && std::any_of(medium.species.begin(), medium.species.end(), fills_layer)) {
        // Particles in a paste leave no gaps; particles alone, as of snow, do.
        layer_density = 1.0 / volume_per_mass;
    } else if (!is_whole && host_density_g_cm3) {
        layer_density = 1.0 / (volume_per_mass + (1.0 - sum) / *host_density_g_cm3);
    } else if (!is_whole) {
        throw UsageError(fmt::format(
            "medium '{}': the mass fractions add up to {}; give the bulk density of the layer "
            "(layer_density_kg_m3), a host of known density, or leave the amount of the main "
            "species out: it is the rest",
            describe(medium.medium), sum));
    } else {
        return;  // ratios are all that is known
    }
    medium.has_amounts = true;
    for (ResolvedSpecies& species : medium.species) species.volume_fraction *= layer_density;
}

double by_number(const ResolvedSpecies& species) {
    const double per_um3 = species.species.amount->value * 1e-12;  // of 1 per cm3
    if (species.given)
        return species.given->share_of_number(per_um3, species.wavelength_nm.front());
    try {
        const double volume_um3 = 4.0 / 3.0 * species.effective_radius_um *
                                  mie::mean_cross_section_um2(species.sizes) *
                                  species.volume_per_core;
        return per_um3 * volume_um3;
    } catch (const UsageError& error) {
        throw UsageError(fmt::format("medium '{}': {}", describe(species.species), error.what()));
    }
}

void require_possible(const ResolvedMedium& medium) {
    const std::string text = describe(medium.medium);
    for (const ResolvedSpecies& species : medium.species) {
        const double most = fills_layer(species) ? 1.0 : kDensestPacking;
        if (species.volume_fraction <= most + kFractionRounding) continue;
        throw UsageError(fmt::format(
            "medium '{}': {} would fill {:.4g} of the volume; allowed: up to {}, the densest "
            "packing of equal spheres (look at amounts, densities and layer_density_kg_m3)",
            text, describe(species.species), species.volume_fraction, kDensestPacking));
    }
    const double sum = filled_volume(medium);
    if (sum <= 1.0 + kFractionRounding) return;
    throw UsageError(fmt::format(
        "medium '{}': its species would fill {:.4g} of the volume; allowed: up to 1", text, sum));
}

}  // namespace

bool has_no_particles(const Medium& medium) {
    return std::all_of(medium.species.begin(), medium.species.end(), [](const Species& species) {
        return species.amount && species.amount->value == 0.0;
    });
}

std::optional<double> layer_density_kg_m3(const Scene& scene, const Medium& medium) {
    std::optional<double> own;
    for (const Species& species : medium.species) {
        const std::optional<double>& said = species.layer_density_kg_m3;
        if (own && said && *own != *said)
            throw UsageError(fmt::format("medium '{}': layer-density {} and {}; a layer has one",
                                         describe(medium), *own, *said));
        if (said) own = said;
    }
    return own ? own : scene.particles.layer_density_kg_m3;
}

void set_amounts(ResolvedMedium& medium, std::optional<double> layer_density_kg_m3,
                 std::optional<double> host_density_g_cm3) {
    ResolvedSpecies& first = medium.species.front();
    if (has_no_particles(medium.medium)) {
        medium.has_amounts = true;
        for (ResolvedSpecies& species : medium.species) species.volume_fraction = 0.0;
        return;
    }
    if (medium.species.size() == 1 && !first.species.amount) {
        if (fills_layer(first)) {
            medium.has_amounts = true;
            return;
        }
        // All the mass of a layer of known density is that of its only species.
        if (!layer_density_kg_m3 || !first.density_g_cm3) return;
        const double fraction = *layer_density_kg_m3 / (kKgPerM3 * *first.density_g_cm3);
        if (fraction > kDensestPacking) return;
        first.volume_fraction = fraction;
        medium.has_amounts = true;
        return;
    }
    const bool all_mass =
        std::all_of(medium.species.begin(), medium.species.end(), [](const auto& species) {
            return !species.species.amount || has_kind(species, Amount::Kind::mass_fraction);
        });
    if (all_mass) {
        set_by_mass(medium, layer_density_kg_m3, host_density_g_cm3);
    } else {
        medium.has_amounts = true;
        for (ResolvedSpecies& species : medium.species) {
            const Amount& amount = *species.species.amount;
            if (amount.kind == Amount::Kind::volume_fraction) {
                species.volume_fraction = amount.value;
            } else if (amount.kind == Amount::Kind::number_per_cm3) {
                species.volume_fraction = by_number(species);
            } else if (layer_density_kg_m3) {
                species.volume_fraction =
                    amount.value * *layer_density_kg_m3 / (kKgPerM3 * density_of(species));
            } else {
                throw UsageError(fmt::format(
                    "medium '{}': a mass fraction beside volumes or numbers needs the bulk density "
                    "of the layer; give layer_density_kg_m3",
                    describe(medium.medium)));
            }
        }
    }
    if (medium.has_amounts) require_possible(medium);
    if (medium.species.size() > 1)
        std::erase_if(medium.species, [](const auto& one) { return one.volume_fraction == 0.0; });
}

double column_um(const Depth& depth, const ResolvedMedium& medium) {
    if (depth.kind == Depth::Kind::thickness_um) {
        if (medium.has_amounts) return depth.value;
        throw UsageError(fmt::format(
            "coat {}@{}: a thickness needs amounts; give volume=, mass= (with layer_density_kg_m3) "
            "or number=, e.g. volume=15%, the layer's density alone where the material's is known "
            "(density=), or an optical depth",
            describe(medium.medium), describe(depth)));
    }
    if (has_no_particles(medium.medium)) {
        throw UsageError(fmt::format(
            "coat {}@{}: all amounts are 0, and no thickness has a mass of such particles; give a "
            "thickness, e.g. 40um, or an amount above 0",
            describe(medium.medium), describe(depth)));
    }
    double mass_per_um = 0.0;
    for (const ResolvedSpecies& species : medium.species)
        mass_per_um += 1e-6 * kKgPerM3 * species.volume_fraction * density_of(species);
    return depth.value / mass_per_um;
}

double filled_volume(const ResolvedMedium& medium) {
    double sum = 0.0;
    for (const ResolvedSpecies& species : medium.species) sum += species.volume_fraction;
    return sum;
}

}  // namespace miebrdf
