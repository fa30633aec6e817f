#include "pipeline/solve/effective_host.h"

#include <cmath>
#include <complex>

namespace miebrdf {
namespace {

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

}  // namespace

double effective_host_index(const ResolvedMedium& medium, std::size_t w) {
    const double n = medium.species.front().particles[w].host_index, host = n * n;
    std::complex<double> sum = 0.0;
    for (const ResolvedSpecies& species : medium.species) {
        const std::complex<double> inside = permittivity(species, w);
        sum += species.volume_fraction * (inside - host) / (inside + 2.0 * host);
    }
    return std::sqrt(host * (1.0 + 2.0 * sum) / (1.0 - sum)).real();
}

}  // namespace miebrdf
