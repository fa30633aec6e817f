#include "pipeline/solve/first_order.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rte/math/tolerance_budget.h"

namespace miebrdf {
namespace {

/// Half of the shortest wave that a phase function of so many moments can have.
double narrowest_panel(const std::vector<std::vector<rte::ScaledMedium>>& stacks) {
    std::size_t moments = 2;
    for (const auto& media : stacks) {
        for (const rte::ScaledMedium& medium : media)
            moments = std::max(moments, medium.exact.chi.size());
    }
    return std::numbers::pi / static_cast<double>(moments);
}

}  // namespace

FirstOrder::FirstOrder(const std::vector<std::vector<rte::ScaledMedium>>& stacks, bool exact,
                       double tolerance)
    : wavelengths_(stacks.size()) {
    std::size_t layers = 0;
    for (const auto& media : stacks) layers = std::max(layers, media.size());
    // A layer that is not there at a wavelength has no depth.
    depth_ = Eigen::ArrayXXd::Zero(Eigen::Index(wavelengths_), Eigen::Index(layers));
    std::vector<const rte::ScaledMedium*> media_of(layers * wavelengths_, nullptr);
    for (std::size_t w = 0; w < wavelengths_; ++w) {
        for (std::size_t layer = 0; layer < stacks[w].size(); ++layer) {
            const rte::ScaledMedium& medium = stacks[w][stacks[w].size() - 1 - layer];
            depth_(Eigen::Index(w), Eigen::Index(layer)) = medium.scaled_optical_depth;
            media_of[layer * wavelengths_ + w] = &medium;
        }
    }
    const auto phases = [&](const Eigen::VectorXd& angles) {
        Eigen::MatrixXd values =
            Eigen::MatrixXd::Zero(angles.size(), Eigen::Index(media_of.size()));
        for (std::size_t f = 0; f < media_of.size(); ++f) {
            for (Eigen::Index a = 0; a < angles.size() && media_of[f] != nullptr; ++a) {
                values(a, Eigen::Index(f)) =
                    rte::first_order_strength(*media_of[f], exact, std::cos(angles[a]));
            }
        }
        return values;
    };
    if (layers > 0) {
        phases_.emplace(phases, narrowest_panel(stacks),
                        math::AngleTolerance{.relative = kPhaseTableShare * tolerance});
    }
    if (exact) {
        narrow_ = rte::NarrowFeatures(stacks, kLeastCosine, kNarrowFeaturesShare * tolerance);
        narrow_.tabulate();
    }
}

void FirstOrder::set_weights(double slant, double factor, Scratch& scratch) const {
    scratch.weights.resize(depth_.rows(), depth_.cols());
    scratch.above.setConstant(depth_.rows(), factor);  // light left on its way down
    for (Eigen::Index layer = 0; layer < depth_.cols(); ++layer) {
        scratch.lost =
            (-slant * depth_.col(layer)).unaryExpr([](double x) { return std::expm1(x); });
        scratch.weights.col(layer) = -scratch.above * scratch.lost;
        scratch.above *= 1.0 + scratch.lost;
    }
}

void FirstOrder::evaluate(double mu_in, double mu_out, std::span<const double> cos_azimuth,
                          std::span<double> reflection, Scratch& scratch) const {
    std::fill(reflection.begin(), reflection.end(), 0.0);
    scratch.angles.resize(cos_azimuth.size());
    for (std::size_t a = 0; a < cos_azimuth.size(); ++a)
        scratch.angles[a] = std::acos(rte::cos_scattering_angle(mu_in, mu_out, cos_azimuth[a]));
    narrow_.add_at(reflection.data(), std::max(mu_in, kLeastCosine), std::max(mu_out, kLeastCosine),
                   scratch.angles, scratch.narrow);
    if (!phases_) return;
    set_weights(1.0 / mu_in + 1.0 / mu_out, 1.0 / (4.0 * (mu_in + mu_out)), scratch);
    const Eigen::ArrayXXd& weights = scratch.weights;
    scratch.phases.resize(weights.size());
    for (std::size_t a = 0; a < cos_azimuth.size(); ++a) {
        phases_->evaluate(scratch.angles[a], scratch.phases);
        // Summed in an array that is always aligned alike: where Eigen begins with vectors, which
        // the compiler gives other roundings than scalars, must not depend on the caller's memory.
        scratch.sums = (weights * Eigen::Map<const Eigen::ArrayXXd>(scratch.phases.data(),
                                                                    weights.rows(), weights.cols()))
                           .rowwise()
                           .sum();
        for (std::size_t w = 0; w < wavelengths_; ++w)
            reflection[a * wavelengths_ + w] += scratch.sums[Eigen::Index(w)];
    }
}

void FirstOrder::evaluate_paths(std::span<const rte::FirstOrderPaths> layers,
                                std::span<const double> cos_azimuth,
                                std::span<double> reflection) const {
    std::fill(reflection.begin(), reflection.end(), 0.0);
    Eigen::VectorXd phases(depth_.size());
    for (std::size_t a = 0; a < cos_azimuth.size() && phases_; ++a) {
        for (std::size_t i = 0; i < layers.size(); ++i) {
            const auto& [mu_in, mu_out, back, forward] = layers[i];
            const auto add = [&](double weight, double cos_angle) {
                if (!(weight > 0.0)) return;
                phases_->evaluate(std::acos(cos_angle), phases);
                // Functions are listed from the top down.
                reflection[a] +=
                    weight * phases[Eigen::Index((layers.size() - 1 - i) * wavelengths_)];
            };
            add(back, rte::cos_scattering_angle(mu_in, mu_out, cos_azimuth[a]));
            add(forward, rte::cos_forward_angle(mu_in, mu_out, cos_azimuth[a]));
        }
    }
}

}  // namespace miebrdf
