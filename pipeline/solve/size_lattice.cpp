#include "pipeline/solve/size_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include "pipeline/solve/grain_shape.h"
#include "pipeline/solve/optics_memo.h"
#include "pipeline/solve/resolver.h"

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

/// What averages at the lattice have at least, so that depths, albedos and every number of streams
/// share them.
OpticsDemand demand_of_nodes(OpticsDemand demand) {
    constexpr int kMoments = 64;  // of 16 streams
    if (!demand.whole_phase_function)
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

struct Node {
    MediumOptics optics;
    double weight;
};

template <typename Number>
double sum_of(const std::vector<Node>& nodes, const Number& number) {
    double sum = 0.0;
    for (const Node& node : nodes) sum += node.weight * number(node.optics);
    return sum;
}

/// exp of the sum of logarithms; the sum itself where a number is not positive.
template <typename Number>
double product_of(const std::vector<Node>& nodes, const Number& number) {
    const bool all_positive = std::all_of(
        nodes.begin(), nodes.end(), [&](const Node& node) { return number(node.optics) > 0.0; });
    if (!all_positive) return sum_of(nodes, number);
    return std::exp(sum_of(nodes, [&](const MediumOptics& o) { return std::log(number(o)); }));
}

/// Number by number; shorter lists go on with zeros.
template <typename List>
std::vector<double> sum_of_lists(const std::vector<Node>& nodes, const List& list) {
    std::vector<double> sum;
    for (const Node& node : nodes) {
        const std::vector<double>& numbers = list(node.optics);
        sum.resize(std::max(sum.size(), numbers.size()), 0.0);
        for (std::size_t k = 0; k < numbers.size(); ++k) sum[k] += node.weight * numbers[k];
    }
    return sum;
}

MediumOptics between(const std::vector<Node>& nodes) {
    MediumOptics result;
    rte::Optics& o = result.optics;
    o.one_minus_albedo = std::clamp(
        product_of(nodes, [](const MediumOptics& m) { return m.optics.one_minus_albedo; }), 0.0,
        1.0);
    o.single_scattering_albedo = 1.0 - o.one_minus_albedo;
    o.chi = sum_of_lists(
        nodes, [](const MediumOptics& m) -> auto& { return m.optics.chi; });
    for (double& chi : o.chi) chi = std::clamp(chi, -1.0, 1.0);
    if (!o.chi.empty()) o.chi.front() = 1.0;
    result.phase = sum_of_lists(
        nodes, [](const MediumOptics& m) -> auto& { return m.phase; });
    result.phase_error = sum_of_lists(
        nodes, [](const MediumOptics& m) -> auto& { return m.phase_error; });
    result.asymmetry = sum_of(nodes, [](const MediumOptics& m) { return m.asymmetry; });
    result.q_ext = product_of(nodes, [](const MediumOptics& m) { return m.q_ext.value_or(0.0); });
    std::vector<std::pair<double, std::function<double(double)>>> phases;
    for (const Node& node : nodes) {
        o.has_more_moments = o.has_more_moments || node.optics.optics.has_more_moments;
        result.error_estimate = std::max(result.error_estimate, node.optics.error_estimate);
        result.converged = result.converged && node.optics.converged;
        if (node.optics.optics.phase) phases.emplace_back(node.weight, node.optics.optics.phase);
    }
    if (phases.size() == nodes.size()) {
        o.phase = [phases = std::move(phases)](double cos_theta) {
            double sum = 0.0;
            for (const auto& [weight, phase] : phases) sum += weight * phase(cos_theta);
            return std::max(sum, 0.0);
        };
    }
    return result;
}

/// The species at one wavelength, of other sizes.
ResolvedSpecies resized(const ResolvedSpecies& species, std::size_t w, double radius_um,
                        double variance) {
    ResolvedSpecies node{.species = species.species,
                         .particles = {species.particles[w]},
                         .wavelength_nm = {species.wavelength_nm[w]},
                         .sizes = species.sizes};
    node.sizes.effective_radius_um = node.effective_radius_um = radius_um;
    node.sizes.effective_variance = variance;
    node.key = {species_key(node, 0)};
    return node;
}

}  // namespace

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
    if (!species.needs_mie() || has_smooth_phase(species.species) || demand.polarisation)
        return false;
    const mie::SizeDistribution& sizes = species.sizes;
    return mie::has_variance(sizes.kind) && sizes.effective_variance >= kLeastVariance &&
           sizes.effective_variance <= kMostVariance && !is_fixed(sizes);
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
    std::vector<Node> nodes;
    for (std::size_t v = 0; v < count; ++v) {
        const double variance =
            with_variance_ ? std::exp(variances.at[v]) : sizes.effective_variance;
        const double weight = with_variance_ ? variances.weight[v] : 1.0;
        const Stencil radii = stencil_at(std::log(sizes.effective_radius_um),
                                         radius_step_ * std::sqrt(std::log1p(variance)));
        for (std::size_t r = 0; r < radii.at.size(); ++r) {
            const ResolvedSpecies node = resized(species, w, std::exp(radii.at[r]), variance);
            nodes.push_back(
                {remembered_optics(remembering, optics_hash(node, 0, of_nodes),
                                   [&] { return compute_optics(node, 0, of_nodes, run); }),
                 weight * radii.weight[r]});
        }
    }
    MediumOptics result = between(nodes);
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
    OpticsDemand demand = asked;
    const double whole = control.memo != nullptr ? control.memo->whole_tolerance : 0.0;
    if (whole > 0.0 && asked.tolerance >= whole && !asked.polarisation &&
        asked.angles_deg.empty()) {
        demand.whole_phase_function = true;
        demand.tolerance = whole;
    }
    if (const SizeLattice* const lattice = lattice_of(control, species, demand))
        return lattice->optics(species, w, demand, control, run);
    Control remembering = control;
    if (control.memo != nullptr && control.memo->lattice != nullptr && control.cache == nullptr)
        remembering.cache = control.memo->lattice->cache_of(species);
    return remembered_optics(remembering, optics_hash(species, w, demand),
                             [&] { return compute_optics(species, w, demand, run); });
}

}  // namespace miebrdf
