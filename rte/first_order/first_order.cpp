#include "rte/first_order/first_order.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rte/boundary/rough_boundaries.h"
#include "rte/boundary/smooth_boundary.h"
#include "rte/first_order/beams.h"
#include "rte/first_order/meridian_planes.h"
#include "rte/first_order/ways.h"
#include "rte/math/legendre.h"

namespace miebrdf::rte {

double exact_phase(const Optics& optics, double cos_theta) {
    return optics.phase ? optics.phase(cos_theta) : math::legendre_series(optics.chi, cos_theta);
}

FirstOrder::FirstOrder(const ScaledStack& stack, bool exact) : stack_(&stack) {
    if (exact) return;
    for (const ScaledMedium& medium : stack.media) seen_.push_back(as_seen_by_equations(medium));
}

void FirstOrder::find_weights(double mu_in, double mu_out, std::vector<PhaseWeights>& list) const {
    const std::vector<ScaledMedium>& media = stack_->media;
    const std::size_t count = media.size();
    list.assign(count, {});
    if (stack_->boundary && stack_->boundary->is_rough()) return;
    if (is_straight()) {
        const double in = refracted_cosine(stack_->top_index, mu_in);
        const double out = refracted_cosine(stack_->top_index, mu_out);
        const double factor = straight_paths_factor(stack_->top_index, mu_in, mu_out);
        const auto depth_of = [&](std::size_t k) {
            return media[count - 1 - k].scaled_optical_depth;
        };
        find_straight_weights(count, depth_of, in, out, [&](std::size_t k, double weight) {
            list[count - 1 - k] = {in, out, factor * weight, 0.0};
        });
    } else {
        const auto in = beams_of<double>(*stack_, mu_in), out = beams_of<double>(*stack_, mu_out);
        for (std::size_t k = 0; k < count; ++k) {
            const ShareWeights share(media[k], in[k].mu, out[k].mu);
            list[k] = {in[k].mu, out[k].mu,
                       share.back * (in[k].down * out[k].down + in[k].up * out[k].up),
                       share.forward * (in[k].down * out[k].up + in[k].up * out[k].down)};
        }
    }
    for (std::size_t k = 0; k < count; ++k) {
        const double strength = strength_of(media[k], optics(k));
        list[k].back *= strength;
        list[k].forward *= strength;
    }
}

double FirstOrder::reflection(double mu_in, double mu_out, double cos_azimuth) const {
    const std::vector<PhaseWeights> list = weights(mu_in, mu_out);
    double sum = ground_reflection(*stack_, mu_in, mu_out, cos_azimuth);
    for (std::size_t k = 0; k < list.size(); ++k) {
        const auto& [in, out, back, forward] = list[k];
        const ScatteringAngles angles(in, out);
        if (back > 0.0) sum += back * exact_phase(optics(k), angles.back(cos_azimuth));
        if (forward > 0.0) sum += forward * exact_phase(optics(k), angles.forward(cos_azimuth));
    }
    return sum;
}

Eigen::Matrix4d FirstOrder::matrix(double mu_in, double mu_out, double azimuth_deg) const {
    std::vector<ScatteringMatrix> back, forward;
    const double cosine = std::cos(azimuth_deg * (std::numbers::pi / 180.0));
    Eigen::Matrix4d M = scattered_matrix(*this, polarised_ways(*this, mu_in, mu_out), cosine,
                                         azimuth_deg, back, forward);
    M(0, 0) += ground_reflection(*stack_, mu_in, mu_out, cosine);
    return M;
}

void FirstOrder::find_polarised_ratio(
    double mu_in, double mu_out, std::span<const double> cos_azimuth, std::span<double> ratio,
    const std::function<ScatteringMatrix(std::size_t medium, double cos_angle)>& matrix_at) const {
    const std::vector<PolarisedWays> ways = polarised_ways(*this, mu_in, mu_out);
    const std::vector<PhaseWeights> of_phase = weights(mu_in, mu_out);
    for (std::size_t a = 0; a < cos_azimuth.size(); ++a) {
        const double cosine = std::clamp(cos_azimuth[a], -1.0, 1.0);
        const double half_cosine = std::sqrt(0.5 * (1.0 + cosine));
        const double half_sine = std::sqrt(0.5 * (1.0 - cosine));
        double polarised = 0.0, unpolarised = 0.0;
        for (std::size_t k = 0; k < of_phase.size(); ++k) {
            const ScatteringAngles angles(ways[k].mu_in, ways[k].mu_out);
            const ScatteringMatrix back = matrix_at(k, angles.back(cosine));
            ScatteringMatrix forward;
            if (ways[k].forward > 0.0) forward = matrix_at(k, angles.forward(cosine));
            polarised += ways[k].intensity(back, forward, half_cosine, half_sine);
            unpolarised += of_phase[k].back * back.a1 + of_phase[k].forward * forward.a1;
        }
        ratio[a] = unpolarised > 0.0 ? polarised / unpolarised : 1.0;
    }
}

double ground_reflection(const ScaledStack& stack, double mu_in, double mu_out,
                         double cos_azimuth) {
    if (!stack.ground) return 0.0;
    double depth = 0.0;
    for (const ScaledMedium& medium : stack.media) depth += medium.scaled_optical_depth;
    const double left = std::exp(-depth * (1.0 / mu_in + 1.0 / mu_out));
    return left > 0.0 ? left * stack.ground->reflection(mu_in, mu_out, cos_azimuth) : 0.0;
}

double straight_paths_factor(double n, double mu_in_air, double mu_out_air) {
    if (n == 1.0) return 1.0;
    return (1.0 - boundary_reflectance(1.0, n, mu_in_air)) *
           (1.0 - boundary_reflectance(1.0, n, mu_out_air)) / (n * n);
}

SurfaceLobe outer_lobe(const Boundary& boundary, double index) {
    return {index, {.beckmann_alpha = boundary.roughness, .distribution = boundary.distribution}};
}

namespace {

MirroredLobe mirrored_lobe(const ScaledStack& stack) {
    return {stack.top_index,
            {stack.boundary->roughness, stack.boundary->distribution},
            [&](double mu) { return unscattered_return(stack, mu); }};
}

Eigen::VectorXd compensation(const ScaledStack& stack, const Eigen::VectorXd& mu) {
    return stack.rough_boundaries->facet_compensation(stack.top_index, *stack.boundary, mu);
}

}  // namespace

void add_mirrored_lobe(std::vector<double>& reflection, const Directions& directions,
                       const ScaledStack& stack) {
    const auto scale_at = [&](const std::vector<double>& cosines) {
        return compensation(
            stack, Eigen::Map<const Eigen::VectorXd>(cosines.data(), Eigen::Index(cosines.size())));
    };
    mirrored_lobe(stack).add_to(reflection, directions, scale_at(directions.mu_in),
                                scale_at(directions.mu_out));
}

std::vector<Eigen::MatrixXd> mirrored_lobe_orders(const Eigen::VectorXd& mu,
                                                  const ScaledStack& stack) {
    const MirroredLobe lobe = mirrored_lobe(stack);
    return lobe.by_order(mu, compensation(stack, mu), std::min(lobe.orders(), kMostBoundaryOrders));
}

double single_scattering(const std::vector<ScaledMedium>& media, bool exact, double mu_in,
                         double mu_out, double cos_azimuth) {
    const double cos_theta = cos_scattering_angle(mu_in, mu_out, cos_azimuth);
    const std::size_t count = media.size();
    const auto depth_of = [&](std::size_t k) { return media[count - 1 - k].scaled_optical_depth; };
    double sum = 0.0;
    find_straight_weights(count, depth_of, mu_in, mu_out, [&](std::size_t k, double weight) {
        if (weight == 0.0) return;
        const ScaledMedium& medium = media[count - 1 - k];
        const Optics seen = exact ? Optics() : as_seen_by_equations(medium);
        const Optics& optics = exact ? medium.exact : seen;
        sum += weight * strength_of(medium, optics) * exact_phase(optics, cos_theta);
    });
    return sum;
}

}  // namespace miebrdf::rte
