#include "pipeline/solve/size_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pipeline/solve/grain_shape.h"
#include "pipeline/solve/optics_memo.h"
#include "pipeline/solve/resolver.h"
#include "pipeline/solve/sampled_spectrum.h"
#include "pipeline/solve/weighted_optics.h"

namespace miebrdf {
namespace {

/// Beyond these a law is a single size, or as wide as all sizes there are.
constexpr double kLeastVariance = 1e-3, kMostVariance = 3.0;

bool have_same_sizes(const mie::SizeDistribution& a, const mie::SizeDistribution& b) {
    return a.kind == b.kind && a.effective_radius_um == b.effective_radius_um &&
           a.effective_variance == b.effective_variance;
}

/// Four neighbours of a place on a line of even steps, and Lagrange's weights.
struct Stencil {
    std::array<double, 4> at, weight;
};

Stencil stencil_at(double x, double step) {
    const double first = std::floor(x / step) - 1.0;
    const double t = x / step - first;  // 1 to 2
    Stencil stencil{};
    for (int i = 0; i < 4; ++i) {
        stencil.at[i] = (first + i) * step;
        stencil.weight[i] = 1.0;
        for (int j = 0; j < 4; ++j) {
            if (j != i) stencil.weight[i] *= (t - j) / (i - j);
        }
    }
    return stencil;
}

/// What averages of a lattice, and of spectra that a fit samples, have at least, so that depths,
/// albedos and every number of streams share them.
OpticsDemand demand_of_nodes(OpticsDemand demand) {
    constexpr int kMoments = 64;  // of 16 streams
    if (!demand.whole_phase_function && !is_of_average(demand))
        demand.highest_moment = std::max(demand.highest_moment, kMoments);
    return demand;
}

/// As many moments as were asked for, of more.
void cut_moments(rte::Optics& optics, const OpticsDemand& demand) {
    const auto count = std::size_t(std::max(demand.highest_moment, 0)) + 1;
    if (demand.whole_phase_function || optics.chi.size() <= count) return;
    optics.chi.resize(count);
    optics.has_more_moments = true;
}

/// The species at one wavelength, of other sizes.
ResolvedSpecies resized(const ResolvedSpecies& species, std::size_t w, double radius_um,
                        double variance) {
    ResolvedSpecies node{.species = species.species,
                         .particles = {species.particles[w]},
                         .wavelength_nm = {species.wavelength_nm[w]},
                         .sizes = species.sizes,
                         .spectrum = species.spectrum};
    node.sizes.effective_radius_um = node.effective_radius_um = radius_um;
    node.sizes.effective_variance = variance;
    node.key = {species_key(node, 0)};
    return node;
}

}  // namespace

bool has_width(const mie::SizeDistribution& sizes) {
    return mie::has_variance(sizes.kind) && sizes.effective_variance >= kLeastVariance &&
           sizes.effective_variance <= kMostVariance;
}

SizeLattice::SizeLattice(double radius_step, std::vector<mie::SizeDistribution> fixed,
                         bool with_variance, std::shared_ptr<ResultCache> cache)
    : radius_step_(radius_step),
      fixed_(std::move(fixed)),
      with_variance_(with_variance),
      cache_(std::move(cache)) {}

bool SizeLattice::is_fixed(const mie::SizeDistribution& sizes) const {
    return std::any_of(fixed_.begin(), fixed_.end(), [&](const mie::SizeDistribution& fixed) {
        return have_same_sizes(fixed, sizes);
    });
}

std::shared_ptr<ResultCache> SizeLattice::cache_of(const ResolvedSpecies& species) const {
    return species.needs_mie() && is_fixed(species.sizes) ? cache_ : nullptr;
}

bool SizeLattice::covers(const ResolvedSpecies& species, const OpticsDemand& demand) const {
    if (!species.needs_mie() || demand.polarisation) return false;
    return has_width(species.sizes) && !is_fixed(species.sizes);
}

MediumOptics SizeLattice::optics(const ResolvedSpecies& species, std::size_t w,
                                 const OpticsDemand& demand, const Control& control,
                                 const mie::Executor& run) const {
    Control remembering = control;
    remembering.cache = cache_;
    const OpticsDemand of_nodes = demand_of_nodes(demand);
    const mie::SizeDistribution& sizes = species.sizes;
    Stencil variances = stencil_at(std::log(sizes.effective_variance), kVarianceStep);
    const std::size_t count = with_variance_ ? variances.at.size() : 1;
    std::vector<WeightedOptics> nodes;
    for (std::size_t v = 0; v < count; ++v) {
        const double variance =
            with_variance_ ? std::exp(variances.at[v]) : sizes.effective_variance;
        const double weight = with_variance_ ? variances.weight[v] : 1.0;
        const Stencil radii = stencil_at(std::log(sizes.effective_radius_um),
                                         radius_step_ * std::sqrt(std::log1p(variance)));
        for (std::size_t r = 0; r < radii.at.size(); ++r) {
            const ResolvedSpecies node = resized(species, w, std::exp(radii.at[r]), variance);
            nodes.push_back(
                {averaged_optics(remembering, node, 0, of_nodes, run), weight * radii.weight[r]});
        }
    }
    MediumOptics result = sum_of(nodes);
    cut_moments(result.optics, demand);
    return result;
}

const SizeLattice* lattice_of(const Control& control, const ResolvedSpecies& species,
                              const OpticsDemand& demand) {
    const SizeLattice* const lattice =
        control.memo != nullptr ? control.memo->lattice.get() : nullptr;
    return lattice != nullptr && lattice->covers(species, demand) ? lattice : nullptr;
}

MediumOptics species_optics(const Control& control, const ResolvedSpecies& species, std::size_t w,
                            const OpticsDemand& asked, const mie::Executor& run) {
    if (has_smooth_phase(species.species)) {
        return smooth_optics(species, w, asked,
                             species_optics(control, averaged_particles(species, w), 0,
                                            demand_of_average(species.species, asked), run));
    }
    OpticsDemand demand = asked;
    const double whole = control.memo != nullptr ? control.memo->whole_tolerance : 0.0;
    if (whole > 0.0 && asked.tolerance >= whole && !asked.polarisation &&
        asked.angles_deg.empty() && !is_of_average(asked)) {
        demand.whole_phase_function = true;
        demand.tolerance = whole;
    }
    if (const SizeLattice* const lattice = lattice_of(control, species, demand))
        return lattice->optics(species, w, demand, control, run);
    Control remembering = control;
    if (control.memo != nullptr && control.memo->lattice != nullptr && control.cache == nullptr)
        remembering.cache = control.memo->lattice->cache_of(species);
    // Evaluations of a fit ask for the same spectrum with different numbers of nodes.
    const bool is_of_fit =
        is_sampled(control, species, demand) && !control.memo->names().spectrum_nm.empty();
    if (!is_of_fit) return averaged_optics(remembering, species, w, demand, run);
    MediumOptics optics = averaged_optics(remembering, species, w, demand_of_nodes(demand), run);
    cut_moments(optics.optics, demand);
    return optics;
}

}  // namespace miebrdf
