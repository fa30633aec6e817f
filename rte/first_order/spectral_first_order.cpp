#include "rte/first_order/spectral_first_order.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rte/grid/refraction_grid.h"
#include "rte/math/tolerance_budget.h"
#include "rte/phase/polarisation.h"

namespace miebrdf::rte {
namespace {

bool bends(const ScaledStack& stack) { return stack.refracts() || stack.has_mirrors(); }

void add_ground(const ScaledStack& stack, double mu_in, double mu_out,
                std::span<const double> cos_azimuth, double* reflection, std::size_t stride) {
    for (std::size_t a = 0; stack.ground && a < cos_azimuth.size(); ++a)
        reflection[a * stride] += ground_reflection(stack, mu_in, mu_out, cos_azimuth[a]);
}

}  // namespace

SpectralFirstOrder::SpectralFirstOrder(std::span<const Wavelength> wavelengths, bool exact,
                                       double tolerance) {
    bool any_bends = false;
    for (const Wavelength& wavelength : wavelengths) {
        wavelengths_.push_back({{*wavelength.stack, exact}, wavelength.is_polarised});
        any_bends = any_bends || bends(*wavelength.stack);
    }
    const std::span<const Known> all = wavelengths_;
    const std::size_t together = any_bends ? 1 : all.size();
    for (std::size_t first = 0; first < all.size(); first += together)
        groups_.emplace_back(all.subspan(first, together), exact, tolerance);
}

SpectralFirstOrder::Group::Group(std::span<const Known> wavelengths, bool exact, double tolerance) {
    std::size_t layers = 0, moments = 2;
    std::vector<std::vector<ScaledMedium>> stacks;
    for (const Known& known : wavelengths) {
        stacks.push_back(known.first_order.stack().media);
        layers = std::max(layers, stacks.back().size());
        for (const ScaledMedium& medium : stacks.back())
            moments = std::max(moments, medium.exact.chi.size());
    }
    // A layer that is not there at a wavelength has no depth.
    depth = strength = Eigen::ArrayXXd::Zero(Eigen::Index(stacks.size()), Eigen::Index(layers));
    std::vector<const Optics*> seen(layers * stacks.size(), nullptr);
    for (std::size_t w = 0; w < stacks.size(); ++w) {
        for (std::size_t layer = 0; layer < stacks[w].size(); ++layer) {
            const std::size_t medium = stacks[w].size() - 1 - layer;
            const Optics& optics = wavelengths[w].first_order.optics(medium);
            const auto row = Eigen::Index(w), column = Eigen::Index(layer);
            depth(row, column) = stacks[w][medium].scaled_optical_depth;
            strength(row, column) =
                optics.single_scattering_albedo / stacks[w][medium].scaled.depth_factor;
            seen[layer * stacks.size() + w] = &optics;
        }
    }
    const auto phases_at = [&](const Eigen::VectorXd& angles) {
        Eigen::MatrixXd values = Eigen::MatrixXd::Zero(angles.size(), Eigen::Index(seen.size()));
        for (std::size_t f = 0; f < seen.size(); ++f) {
            for (Eigen::Index a = 0; a < angles.size() && seen[f] != nullptr; ++a)
                values(a, Eigen::Index(f)) = exact_phase(*seen[f], std::cos(angles[a]));
        }
        return values;
    };
    // Half of the shortest wave that a phase function of so many moments can have.
    const double narrowest = std::numbers::pi / double(moments);
    if (layers > 0) {
        phases.emplace(phases_at, narrowest,
                       math::AngleTolerance{.relative = kPhaseTableShare * tolerance});
    }
    const Known& one = wavelengths.front();
    const bool polarises = one.is_polarised && bends(one.first_order.stack());
    if (polarises && layers > 0) {
        const auto shares_at = [&](const Eigen::VectorXd& angles) {
            Eigen::MatrixXd values = Eigen::MatrixXd::Zero(angles.size(), Eigen::Index(3 * layers));
            for (std::size_t layer = 0; layer < layers; ++layer) {
                for (Eigen::Index a = 0; a < angles.size(); ++a) {
                    const ScatteringMatrix F = exact_matrix(*seen[layer], std::cos(angles[a]));
                    if (F.a1 > 0.0)
                        values.block<1, 3>(a, Eigen::Index(3 * layer)) =
                            Eigen::RowVector3d(F.a2, F.a3, F.b1) / F.a1;
                }
            }
            return values;
        };
        shares.emplace(shares_at, narrowest,
                       math::AngleTolerance{.absolute = kPhaseTableShare * tolerance});
    }
    if (exact) {
        narrow = GloryCorrection(stacks, kLeastCosine, kGloryShare * tolerance);
        narrow.tabulate();
    }
}

ScatteringMatrix SpectralFirstOrder::Group::matrix_at(std::size_t medium, double cos_angle,
                                                      Scratch& scratch) const {
    const double angle = std::acos(cos_angle);
    const Eigen::Index layers = depth.cols(), layer = layers - 1 - Eigen::Index(medium);
    scratch.phases.resize(layers);
    scratch.shares.resize(3 * layers);
    phases->evaluate(angle, scratch.phases);
    shares->evaluate(angle, scratch.shares);
    const double a1 = scratch.phases[layer];
    const Eigen::Vector3d share = a1 * scratch.shares.segment<3>(3 * layer);
    return {.a1 = a1, .a2 = share[0], .a3 = share[1], .b1 = share[2]};
}

void SpectralFirstOrder::Group::evaluate_straight(double mu_in, double mu_out,
                                                  std::span<const double> cos_azimuth,
                                                  std::span<double> reflection,
                                                  Scratch& scratch) const {
    std::fill(reflection.begin(), reflection.end(), 0.0);
    scratch.angles.resize(cos_azimuth.size());
    const ScatteringAngles between(mu_in, mu_out);
    for (std::size_t a = 0; a < cos_azimuth.size(); ++a)
        scratch.angles[a] = std::acos(between.back(cos_azimuth[a]));
    narrow.add_at(reflection.data(), std::max(mu_in, kLeastCosine), std::max(mu_out, kLeastCosine),
                  scratch.angles, scratch.narrow);
    if (!phases) return;
    scratch.weights.resize(depth.rows(), depth.cols());
    for (Eigen::Index w = 0; w < depth.rows(); ++w) {
        find_straight_weights(
            std::size_t(depth.cols()), [&](std::size_t k) { return depth(w, Eigen::Index(k)); },
            mu_in, mu_out,
            [&](std::size_t k, double weight) { scratch.weights(w, Eigen::Index(k)) = weight; });
    }
    scratch.weights *= strength;
    const Eigen::ArrayXXd& weights = scratch.weights;
    const auto count = std::size_t(weights.rows());
    scratch.phases.resize(weights.size());
    for (std::size_t a = 0; a < cos_azimuth.size(); ++a) {
        phases->evaluate(scratch.angles[a], scratch.phases);
        // Summed in an array that is always aligned alike: where Eigen begins with vectors, which
        // the compiler gives other roundings than scalars, must not depend on the caller's memory.
        scratch.sums = (weights * Eigen::Map<const Eigen::ArrayXXd>(scratch.phases.data(),
                                                                    weights.rows(), weights.cols()))
                           .rowwise()
                           .sum();
        for (std::size_t w = 0; w < count; ++w)
            reflection[a * count + w] += scratch.sums[Eigen::Index(w)];
    }
}

void SpectralFirstOrder::Group::evaluate_all_ways(const std::vector<PhaseWeights>& weights,
                                                  std::span<const double> cos_azimuth,
                                                  std::span<double> reflection,
                                                  Scratch& scratch) const {
    std::fill(reflection.begin(), reflection.end(), 0.0);
    scratch.phases.resize(Eigen::Index(weights.size()));
    for (std::size_t a = 0; a < cos_azimuth.size() && phases; ++a) {
        for (std::size_t k = 0; k < weights.size(); ++k) {
            const ScatteringAngles angles(weights[k].mu_in, weights[k].mu_out);
            const auto add = [&](double weight, double cos_angle) {
                if (!(weight > 0.0)) return;
                phases->evaluate(std::acos(cos_angle), scratch.phases);
                // Functions are listed from the top down.
                reflection[a] += weight * scratch.phases[Eigen::Index(weights.size() - 1 - k)];
            };
            add(weights[k].back, angles.back(cos_azimuth[a]));
            add(weights[k].forward, angles.forward(cos_azimuth[a]));
        }
    }
}

void SpectralFirstOrder::evaluate(double mu_in, double mu_out, std::span<const double> cos_azimuth,
                                  std::span<double> reflection, Scratch& scratch) const {
    if (groups_.size() == 1 && !bends(at_wavelength(0).stack())) {
        groups_.front().evaluate_straight(mu_in, mu_out, cos_azimuth, reflection, scratch);
        for (std::size_t w = 0; w < wavelengths(); ++w)
            add_ground(at_wavelength(w).stack(), mu_in, mu_out, cos_azimuth, &reflection[w],
                       wavelengths());
        return;
    }
    const std::size_t count = wavelengths();
    scratch.own.resize(cos_azimuth.size());
    for (std::size_t w = 0; w < count; ++w) {
        evaluate_alone(w, mu_in, mu_out, cos_azimuth, scratch.own, scratch);
        for (std::size_t a = 0; a < cos_azimuth.size(); ++a)
            reflection[a * count + w] = scratch.own[a];
    }
}

void SpectralFirstOrder::evaluate_alone(std::size_t w, double mu_in, double mu_out,
                                        std::span<const double> cos_azimuth,
                                        std::span<double> reflection, Scratch& scratch) const {
    if (groups_.size() < wavelengths()) {
        std::vector<double> all(cos_azimuth.size() * wavelengths());
        evaluate(mu_in, mu_out, cos_azimuth, all, scratch);
        for (std::size_t a = 0; a < cos_azimuth.size(); ++a)
            reflection[a] = all[a * wavelengths() + w];
        return;
    }
    const FirstOrder& first_order = at_wavelength(w);
    const ScaledStack& stack = first_order.stack();
    if (!first_order.is_straight() || (stack.boundary && stack.boundary->is_rough())) {
        groups_[w].evaluate_all_ways(first_order.weights(mu_in, mu_out), cos_azimuth, reflection,
                                     scratch);
    } else {
        groups_[w].evaluate_straight(refracted_cosine(stack.top_index, mu_in),
                                     refracted_cosine(stack.top_index, mu_out), cos_azimuth,
                                     reflection, scratch);
        const double factor = straight_paths_factor(stack.top_index, mu_in, mu_out);
        for (double& value : reflection) value *= factor;
    }
    add_ground(stack, mu_in, mu_out, cos_azimuth, reflection.data(), 1);
    if (!groups_[w].shares) return;
    // Boundaries and mirrors polarise, which changes how much is scattered and leaves.
    std::vector<double> ratio(cos_azimuth.size());
    first_order.find_polarised_ratio(mu_in, mu_out, cos_azimuth, ratio,
                                     [&](std::size_t medium, double cos_angle) {
                                         return groups_[w].matrix_at(medium, cos_angle, scratch);
                                     });
    for (std::size_t a = 0; a < ratio.size(); ++a) reflection[a] *= ratio[a];
}

}  // namespace miebrdf::rte
