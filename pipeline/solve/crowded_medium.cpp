// Crowded particles of a medium: who crowds them, the host that they see, and what is noted.
#include <fmt/format.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <utility>

#include "pipeline/solve/amounts.h"
#include "pipeline/solve/packing.h"
#include "pipeline/solve/resolver.h"

namespace miebrdf {
namespace {

/// Beyond this share of the volume, what neighbours change is said.
constexpr double kCrowded = 0.05;
/// Size parameters in the host: Maxwell Garnett's rule is of dipoles; this is rutile of .15 um in
/// paint, in blue light.
constexpr double kLargestDissolved = 3.0;

bool has_structure(Packing packing) {
    return packing == Packing::percus_yevick || packing == Packing::percus_yevick_effective_host;
}
bool has_effective_host(Packing packing) {
    return packing == Packing::effective_host || packing == Packing::percus_yevick_effective_host;
}

std::vector<CrowdMember> crowd_of(const ResolvedMedium& medium) {
    std::vector<CrowdMember> crowd;
    for (const ResolvedSpecies& species : medium.species) {
        if (species.volume_fraction == 0.0) continue;
        crowd.push_back({species.volume_fraction, species.effective_radius_um,
                         species.outer_radius_um, species.particles, species.key});
    }
    return crowd;
}

bool has_only_spheres(const ResolvedMedium& medium) {
    return std::all_of(medium.species.begin(), medium.species.end(),
                       [](const ResolvedSpecies& species) { return species.needs_mie(); });
}

/// Whether this packing, which is asked for, changes the medium.
/// @throws UsageError  for particles of a file, and for amounts that are missing
bool packs(const ResolvedMedium& medium, const char* packing) {
    const bool only_spheres = has_only_spheres(medium);
    if (!only_spheres && medium.has_extinction()) {
        throw UsageError(fmt::format(
            "medium '{}': packing {} is for spheres; whether a file includes crowding is not known",
            describe(medium.medium), packing));
    }
    if (only_spheres && !medium.has_amounts) {
        throw UsageError(
            fmt::format("medium '{}': packing {} needs amounts; give volume=, mass= (with "
                        "layer_density_kg_m3) or number=",
                        describe(medium.medium), packing));
    }
    return only_spheres;
}

/// Permittivity of a homogeneous sphere with the dipole of a coated one (Bohren & Huffman 1983,
/// section 5.4), layer by layer, at the effective radius.
std::complex<double> permittivity(const ResolvedSpecies& species, std::size_t w) {
    const Particles& at = species.particles[w];
    std::complex<double> inner = at.index * at.index;
    double inner_um = species.effective_radius_um, share = 1.0, thickness_um = 0.0;
    for (const mie::ParticleCoating& coating : at.coatings) {
        share += coating.share_of_radius;
        thickness_um += coating.thickness_um;
        const double outer_um = share * species.effective_radius_um + thickness_um;
        const double f = std::pow(inner_um / outer_um, 3);
        const std::complex<double> shell = coating.refractive_index * coating.refractive_index;
        inner = shell * (inner * (1.0 + 2.0 * f) + 2.0 * shell * (1.0 - f)) /
                (inner * (1.0 - f) + shell * (2.0 + f));
        inner_um = outer_um;
    }
    return inner;
}

/// The real refractive index around a sphere of a medium whose others are dissolved in the host
/// (Maxwell Garnett 1904): with beta = (e - h) / (e + 2 h), e the permittivity of a species, h of
/// the host, and f the volume fractions,
///     e_eff = h (1 + 2 sum f beta) / (1 - sum f beta).
/// Coated spheres count with the permittivity of a sphere of one material and the same dipole.
/// Absorption by the particles is that of Mie theory, not of this host.
/// @param medium  of spheres with amounts
double effective_host_index(const ResolvedMedium& medium, std::size_t w) {
    const double n = medium.species.front().particles[w].host_index, host = n * n;
    std::complex<double> sum = 0.0;
    for (const ResolvedSpecies& species : medium.species) {
        const std::complex<double> inside = permittivity(species, w);
        sum += species.volume_fraction * (inside - host) / (inside + 2.0 * host);
    }
    return std::sqrt(host * (1.0 + 2.0 * sum) / (1.0 - sum)).real();
}

}  // namespace

void Resolver::set_effective_host(ResolvedMedium& medium) {
    if (!has_effective_host(scene_.particles.packing) || !packs(medium, "effective-host")) return;
    const std::vector<double>& nm = medium.species.front().wavelength_nm;
    std::vector<std::pair<double, double>> hosts;  // with their wavelengths
    double largest = 0.0;                          // size parameter
    for (std::size_t w = 0; w < nm.size(); ++w) {
        const double n = effective_host_index(medium, w);
        hosts.emplace_back(n, nm[w]);
        for (ResolvedSpecies& species : medium.species) {
            species.particles[w].host_index = n;
            species.key[w] = species_key(species, w);
            largest =
                std::max(largest, 2e3 * std::numbers::pi * n * species.outer_radius_um / nm[w]);
        }
    }
    const auto [least, most] = std::minmax_element(hosts.begin(), hosts.end());
    add_once(notes_, fmt::format("{}: packing effective-host has particles scatter in an index of "
                                 "{:.4g} ({} nm) to {:.4g} ({} nm)",
                                 describe(medium.medium), least->first, least->second, most->first,
                                 most->second));
    if (largest > kLargestDissolved)
        add_once(notes_, fmt::format("{}: packing effective-host is for particles below the "
                                     "wavelength; their size parameter is up to {:.2g}",
                                     describe(medium.medium), largest));
}

void Resolver::set_packing(ResolvedMedium& medium) {
    const bool asked = has_structure(scene_.particles.packing);
    if (asked ? !packs(medium, "percus-yevick") : !has_only_spheres(medium)) return;
    for (ResolvedSpecies& species : medium.species) {
        species.crowded = asked;
        if (asked && species.species.shape.kind != GrainShape::Kind::sphere) {
            add_once(notes_, fmt::format("packing percus-yevick takes the grains of {} as spheres "
                                         "of their effective radius",
                                         describe(species.species)));
        }
        if (!asked && (!medium.has_amounts || filled_volume(medium) <= kCrowded)) continue;
        species.crowd = crowd_of(medium);
        if (species.crowd.empty()) species.crowded = false;
    }
    if (tells_crowding_ && scene_.particles.packing == Packing::independent && medium.has_amounts &&
        filled_volume(medium) > kCrowded)
        note_crowding(medium);
}

void Resolver::note_crowding(const ResolvedMedium& medium) {
    constexpr std::size_t kMostWavelengths = 9;  // the change is smooth; each takes 1 to 16 ms
    const std::vector<double>& nm = medium.species.front().wavelength_nm;
    std::vector<std::size_t> by_wavelength(nm.size());
    std::iota(by_wavelength.begin(), by_wavelength.end(), 0);
    std::sort(by_wavelength.begin(), by_wavelength.end(),
              [&](std::size_t a, std::size_t b) { return nm[a] < nm[b]; });
    const std::size_t count = std::min(nm.size(), kMostWavelengths);
    std::vector<std::pair<double, double>> changes;  // with their wavelengths
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t w = by_wavelength[count > 1 ? i * (nm.size() - 1) / (count - 1) : 0];
        if (const auto change = crowding(medium, w)) changes.emplace_back(*change, nm[w]);
    }
    if (changes.empty()) return;
    const auto [least, most] = std::minmax_element(changes.begin(), changes.end());
    const std::string range =
        least == most ? fmt::format("{:.2g} times the reduced scattering at {} nm", least->first,
                                    least->second)
                      : fmt::format("{:.2g} ({} nm) to {:.2g} ({} nm) times the reduced scattering",
                                    least->first, least->second, most->first, most->second);
    add_once(notes_,
             fmt::format("{} fills {:.3g} % of the volume: independent scattering is "
                         "assumed; hard spheres would have {} (packing percus-yevick), those of "
                         "a high index less (packing effective-host)",
                         describe(medium.medium), 100.0 * filled_volume(medium), range));
}

}  // namespace miebrdf
