#include "rte/first_order/first_order.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "rte/boundary/rough_boundaries.h"
#include "rte/boundary/smooth_boundary.h"
#include "rte/first_order/beams.h"
#include "rte/first_order/glory_correction.h"
#include "rte/first_order/meridian_planes.h"
#include "rte/grid/refraction_grid.h"
#include "rte/math/interruption.h"
#include "rte/math/legendre.h"
#include "rte/math/tolerance_budget.h"
#include "rte/phase/polarisation.h"

namespace miebrdf::rte {
namespace {

double cos_of_degrees(double angle_deg) { return std::cos(angle_deg * (std::numbers::pi / 180.0)); }

std::vector<double> cosines_of(const std::vector<double>& angles_deg) {
    std::vector<double> cosines(angles_deg.size());
    std::transform(angles_deg.begin(), angles_deg.end(), cosines.begin(), cos_of_degrees);
    return cosines;
}

/// (exp(-tau / mu) - exp(-tau / mu')) / (mu - mu'), 0 for a layer without bottom.
double forward_quotient(double tau, double mu, double other) {
    if (std::isinf(tau)) return 0.0;
    const double a = tau / std::max(mu, other), b = tau / std::min(mu, other);
    const double x = b - a;
    const double mean = x > 0.0 ? -std::expm1(-x) / x : 1.0;
    return std::exp(-a) * mean * tau / (mu * other);
}

/// alpha / (1 - alpha f): what P has to be multiplied by.
double strength_of(const ScaledMedium& medium, const Optics& seen) {
    return seen.single_scattering_albedo / medium.scaled.depth_factor;
}

/// dR/dP per strength of the light that turns back and of the light that goes on, per share of both
/// beams.
struct ShareWeights {
    double back, forward;
    ShareWeights(const ScaledMedium& medium, double mu_in, double mu_out) {
        const double tau = medium.scaled_optical_depth, n2 = medium.index * medium.index;
        back = -std::expm1(-tau * (1.0 / mu_in + 1.0 / mu_out)) / (4.0 * n2 * (mu_in + mu_out));
        forward = forward_quotient(tau, mu_in, mu_out) / (4.0 * n2);
    }
};

/// The ways of polarised light in and out of one medium.
struct PolarisedWays {
    double mu_in, mu_out;
    double back, forward;  // PhaseWeights but for the beams
    Eigen::Matrix4d in_down, in_up, out_down, out_up;

    /// @param F  of light that turns back, and of light that goes on
    Eigen::Matrix4d matrix(const ScatteringMatrix& F, const ScatteringMatrix& F_forward,
                           double azimuth_deg) const {
        const Eigen::Vector4d mirrored(1.0, 1.0, -1.0, -1.0);
        const auto upside_down = [&](const Eigen::Matrix4d& M) -> Eigen::Matrix4d {
            return mirrored.asDiagonal() * M * mirrored.asDiagonal();
        };
        const Eigen::Matrix4d turned = turned_to_meridians(F, mu_in, mu_out, azimuth_deg);
        Eigen::Matrix4d sum = back * (out_down * turned * in_down);
        if (!(forward > 0.0)) return sum;
        const Eigen::Matrix4d on = turned_forward(F_forward, mu_in, mu_out, azimuth_deg);
        sum += back * (out_up * upside_down(turned) * in_up) +
               forward * (out_up * on * in_down + out_down * upside_down(on) * in_up);
        return sum;
    }
};

std::vector<PolarisedWays> polarised_ways(const FirstOrder& first_order, double mu_in,
                                          double mu_out) {
    const ScaledStack& stack = first_order.stack();
    const auto in = beams_of<FresnelMatrix>(stack, mu_in);
    const auto out = beams_of<FresnelMatrix>(stack, mu_out);
    std::vector<PolarisedWays> ways;
    ways.reserve(in.size());
    for (std::size_t k = 0; k < in.size(); ++k) {
        const ScaledMedium& medium = stack.media[k];
        const ShareWeights share(medium, in[k].mu, out[k].mu);
        const double strength = strength_of(medium, first_order.optics(k));
        const bool any_up = in[k].up.unpolarised() > 0.0 || out[k].up.unpolarised() > 0.0;
        ways.push_back({in[k].mu, out[k].mu, strength * share.back,
                        any_up ? strength * share.forward : 0.0, mueller_of(in[k].down),
                        mueller_of(in[k].up), mueller_of(out[k].down), mueller_of(out[k].up)});
    }
    return ways;
}

int most_moments(const std::vector<ScaledMedium>& media) {
    Eigen::Index most = 0;
    for (const ScaledMedium& medium : media) most = std::max(most, medium.scaled.chi.size());
    return int(most);
}

ForwardPeak from_degree(const ForwardPeak& whole, int degree) {
    const auto tail = [&](const std::vector<double>& list) {
        const int before = std::clamp(degree - whole.first_degree, 0, int(list.size()));
        return std::vector<double>(list.begin() + before, list.end());
    };
    return {degree, tail(whole.peak), tail(whole.structure)};
}

}  // namespace

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
    double sum = 0.0;
    for (std::size_t k = 0; k < list.size(); ++k) {
        const auto& [in, out, back, forward] = list[k];
        const ScatteringAngles angles(in, out);
        if (back > 0.0) sum += back * exact_phase(optics(k), angles.back(cos_azimuth));
        if (forward > 0.0) sum += forward * exact_phase(optics(k), angles.forward(cos_azimuth));
    }
    return sum;
}

namespace {

Eigen::Matrix4d matrix_of(const FirstOrder& first_order, const std::vector<PolarisedWays>& ways,
                          double cosine, double azimuth_deg, std::vector<ScatteringMatrix>& back,
                          std::vector<ScatteringMatrix>& forward) {
    back.resize(ways.size());
    forward.resize(ways.size());
    Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
    for (std::size_t k = 0; k < ways.size(); ++k) {
        const ScatteringAngles angles(ways[k].mu_in, ways[k].mu_out);
        back[k] = exact_matrix(first_order.optics(k), angles.back(cosine));
        if (ways[k].forward > 0.0)
            forward[k] = exact_matrix(first_order.optics(k), angles.forward(cosine));
        sum += ways[k].matrix(back[k], forward[k], azimuth_deg);
    }
    return sum;
}

}  // namespace

Eigen::Matrix4d FirstOrder::matrix(double mu_in, double mu_out, double azimuth_deg) const {
    std::vector<ScatteringMatrix> back, forward;
    return matrix_of(*this, polarised_ways(*this, mu_in, mu_out), cos_of_degrees(azimuth_deg),
                     azimuth_deg, back, forward);
}

void FirstOrder::find_polarised_ratio(double mu_in, double mu_out,
                                      std::span<const double> cos_azimuth,
                                      std::span<double> ratio) const {
    const std::vector<PolarisedWays> ways = polarised_ways(*this, mu_in, mu_out);
    const std::vector<PhaseWeights> of_phase = weights(mu_in, mu_out);
    std::vector<ScatteringMatrix> back, forward;
    for (std::size_t a = 0; a < cos_azimuth.size(); ++a) {
        const double cosine = std::clamp(cos_azimuth[a], -1.0, 1.0);
        const double polarised =
            matrix_of(*this, ways, cosine, std::acos(cosine) * (180.0 / std::numbers::pi), back,
                      forward)(0, 0);
        double unpolarised = 0.0;
        for (std::size_t k = 0; k < of_phase.size(); ++k)
            unpolarised += of_phase[k].back * back[k].a1 + of_phase[k].forward * forward[k].a1;
        ratio[a] = unpolarised > 0.0 ? polarised / unpolarised : 1.0;
    }
}

double straight_paths_factor(double n, double mu_in_air, double mu_out_air) {
    if (n == 1.0) return 1.0;
    return (1.0 - boundary_reflectance(1.0, n, mu_in_air)) *
           (1.0 - boundary_reflectance(1.0, n, mu_out_air)) / (n * n);
}

SurfaceLobe outer_lobe(const Boundary& boundary, double index) {
    return {index, {.beckmann_alpha = boundary.roughness, .distribution = boundary.distribution}};
}

int mirrored_lobe_orders(const ScaledStack& stack) {
    // A passage turns light by (n - 1) times the slope of its facet, and GGX slopes of alpha give
    // orders that fall like exp(-alpha (n - 1) m).
    constexpr double fall = 9.0;
    const double orders = fall / (stack.boundary->roughness * (stack.top_index - 1.0));
    return int(std::clamp(orders, 12.0, double(kMostBoundaryOrders)));
}

void add_mirrored_lobe(std::vector<double>& reflection, const Directions& directions,
                       const ScaledStack& stack) {
    const Boundary& boundary = *stack.boundary;
    const MirroredLobe lobe(stack.top_index, {boundary.roughness, boundary.distribution},
                            [&](double mu) { return unscattered_return(stack, mu); });
    const auto scale_at = [&](const std::vector<double>& cosines) {
        return stack.rough_boundaries->facet_compensation(
            stack.top_index, boundary,
            Eigen::Map<const Eigen::VectorXd>(cosines.data(), Eigen::Index(cosines.size())));
    };
    lobe.add_to(reflection, directions, scale_at(directions.mu_in), scale_at(directions.mu_out));
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

std::vector<bool> near_retro_reflection(const Directions& directions) {
    const double nearest = -cos_of_degrees(5.0);
    const std::vector<double> cos_azimuth = cosines_of(directions.azimuth_deg);
    std::vector<bool> backwards;
    backwards.reserve(directions.mu_in.size() * directions.mu_out.size() * cos_azimuth.size());
    for (const double mu_in : directions.mu_in) {
        for (const double mu_out : directions.mu_out) {
            const ScatteringAngles angles(mu_in, mu_out);
            for (const double cosine : cos_azimuth)
                backwards.push_back(angles.back(cosine) <= nearest);
        }
    }
    return backwards;
}

FirstOrderSum::FirstOrderSum(const Directions& directions, const SolverOptions& options,
                             int components, int shown)
    : directions_(directions),
      is_polarised_(components > 1),
      shown_(shown),
      options_(options),
      cos_azimuth_(cosines_of(directions.azimuth_deg)) {}

void FirstOrderSum::add_outer_lobe(std::vector<double>& reflection,
                                   const ScaledStack& stack) const {
    const SurfaceLobe lobe = outer_lobe(*stack.boundary, stack.top_index);
    const auto scale_at = [&](const std::vector<double>& cosines) -> Eigen::VectorXd {
        return stack.rough_boundaries->outer_lobe_scale(
            stack.top_index, *stack.boundary,
            Eigen::Map<const Eigen::VectorXd>(cosines.data(), Eigen::Index(cosines.size())));
    };
    const Eigen::VectorXd in = scale_at(directions_.mu_in), out = scale_at(directions_.mu_out);
    std::size_t next = 0;
    for (std::size_t i = 0; i < directions_.mu_in.size(); ++i) {
        for (std::size_t o = 0; o < directions_.mu_out.size(); ++o) {
            const double scale = std::numbers::pi * in[Eigen::Index(i)] * out[Eigen::Index(o)];
            for (const double azimuth : directions_.azimuth_deg)
                reflection[next++] +=
                    scale * lobe.brdf(directions_.mu_in[i], directions_.mu_out[o], azimuth);
        }
    }
}

void FirstOrderSum::evaluate(const FirstOrder& first_order) {
    const std::size_t media = first_order.stack().media.size();
    const std::size_t azimuths = cos_azimuth_.size(), directions = pairs() * azimuths;
    const auto resize = [&](Scattered& scattered) {
        if (!is_polarised_) {
            scattered.phase.resize(media * directions);
        } else {
            scattered.matrix.resize(media * directions);
        }
    };
    const auto set = [&](Scattered& scattered, std::size_t at, std::size_t medium, double cosine) {
        if (!is_polarised_) {
            scattered.phase[at] = exact_phase(first_order.optics(medium), cosine);
        } else {
            scattered.matrix[at] = exact_matrix(first_order.optics(medium), cosine);
        }
    };
    const bool any_forward = !first_order.is_straight();
    resize(back_);
    if (any_forward) resize(forward_);
    std::size_t first = 0;
    for (const double mu_in : directions_.mu_in) {
        for (const double mu_out : directions_.mu_out) {
            math::interruption_point();
            const std::vector<PhaseWeights> weights = first_order.weights(mu_in, mu_out);
            for (std::size_t k = 0; k < media; ++k) {
                const ScatteringAngles angles(weights[k].mu_in, weights[k].mu_out);
                for (std::size_t a = 0; a < azimuths; ++a) {
                    const std::size_t at = k * directions + first + a;
                    set(back_, at, k, angles.back(cos_azimuth_[a]));
                    if (any_forward) set(forward_, at, k, angles.forward(cos_azimuth_[a]));
                }
            }
            first += azimuths;
        }
    }
}

void FirstOrderSum::add_to(std::vector<double>& reflection, const ScaledStack& stack,
                           std::vector<double>* unresolved) {
    if (stack.boundary && stack.boundary->is_rough()) {
        add_outer_lobe(reflection, stack);
        if (stack.has_mirrors()) add_mirrored_lobe(reflection, directions_, stack);
        return;
    }
    const bool exact = options_.single_scattering_correction;
    const FirstOrder first_order(stack, exact);
    if (!exact || (back_.phase.empty() && back_.matrix.empty())) evaluate(first_order);
    const bool straight = first_order.is_straight();
    std::vector<double> narrow;  // no narrow features are known of light that mirrors return
    if (exact && straight) narrow = narrow_change(first_order, unresolved);

    const std::size_t media = stack.media.size(), azimuths = cos_azimuth_.size();
    const std::size_t directions = pairs() * azimuths;
    const auto c = std::size_t(shown_);
    std::vector<PhaseWeights> weights;
    std::size_t first = 0;
    for (const double mu_in : directions_.mu_in) {
        for (const double mu_out : directions_.mu_out) {
            math::interruption_point();
            first_order.find_weights(mu_in, mu_out, weights);
            const double factor = straight_paths_factor(stack.top_index, mu_in, mu_out);
            std::vector<PolarisedWays> ways;
            if (is_polarised_) ways = polarised_ways(first_order, mu_in, mu_out);
            for (std::size_t a = 0; a < azimuths; ++a) {
                const std::size_t direction = first + a;
                double sum = 0.0, change = narrow.empty() ? 0.0 : factor * narrow[direction];
                for (std::size_t k = 0; k < media; ++k) {
                    const std::size_t at = k * directions + direction;
                    sum +=
                        weights[k].back * (is_polarised_ ? back_.matrix[at].a1 : back_.phase[at]);
                    if (!straight)
                        sum += weights[k].forward *
                               (is_polarised_ ? forward_.matrix[at].a1 : forward_.phase[at]);
                    if (!narrow_.empty()) change -= weights[k].back * narrow_phase_[at];
                }
                if (unresolved != nullptr && !unresolved->empty())
                    (*unresolved)[direction] *= factor;
                if (!is_polarised_) {
                    reflection[direction] += sum + change;
                    continue;
                }
                Eigen::Matrix4d M = Eigen::Matrix4d::Zero();
                for (std::size_t k = 0; k < media; ++k) {
                    const std::size_t at = k * directions + direction;
                    M += ways[k].matrix(back_.matrix[at],
                                        straight ? ScatteringMatrix{} : forward_.matrix[at],
                                        directions_.azimuth_deg[a]);
                }
                // Light of a glory keeps its polarisation: the whole matrix changes alike.
                if (sum > 0.0) M *= 1.0 + change / sum;
                for (std::size_t e = 0; e < c * c; ++e)
                    reflection[first * c * c + e * azimuths + a] +=
                        M(Eigen::Index(e / c), Eigen::Index(e % c));
            }
            first += azimuths;
        }
    }
}

std::vector<double> FirstOrderSum::narrow_change(const FirstOrder& first_order,
                                                 std::vector<double>* unresolved) {
    const std::vector<ScaledMedium>& media = first_order.stack().media;
    if (!has_kept_narrow(media)) {
        inside_ = refracted(directions_, first_order.stack().top_index);
        for (const auto* cosines : {&inside_.mu_in, &inside_.mu_out}) {
            for (const double mu : *cosines) mu_least_ = std::min(mu_least_, mu);
        }
        keep_narrow(media);
    }
    std::vector<double> change = narrow_;
    change.resize(pairs() * cos_azimuth_.size(), 0.0);
    // Degrees that depend on the nodes.
    GloryCorrection narrow({&media, 1}, mu_least_, kNarrowFeaturesShare * options_.tolerance,
                           {.end = first_kept_});
    if (worth_a_table(change.size())) narrow.tabulate();
    const bool wanted = unresolved != nullptr && narrow.has_unresolved();
    if (wanted) unresolved->assign(change.size(), 0.0);
    narrow.add_to(change.data(), inside_.mu_in, inside_.mu_out, cos_azimuth_,
                  wanted ? unresolved->data() : nullptr);
    return change;
}

bool FirstOrderSum::has_kept_narrow(const std::vector<ScaledMedium>& media) const {
    if (!narrow_is_known_) return false;
    if (narrow_.empty()) return true;
    if (most_moments(media) > first_kept_) return false;
    for (std::size_t i = 0; i < media.size(); ++i) {
        const ForwardPeak here = from_degree(media[i].narrow, first_kept_);
        if (here.peak != kept_[i].peak || here.structure != kept_[i].structure) return false;
    }
    return true;
}

void FirstOrderSum::keep_narrow(const std::vector<ScaledMedium>& media) {
    narrow_is_known_ = true;
    narrow_.clear();
    kept_.clear();
    // The first numbers of nodes have fewer moments; where others double there is a new first
    // degree.
    constexpr int least = 128;
    first_kept_ = std::max(least, 2 * most_moments(media));
    constexpr int worth = 2;  // times as many
    if (narrow_degrees(media).end < worth * first_kept_) {
        first_kept_ = std::numeric_limits<int>::max();
        return;
    }
    const double tolerance = kNarrowFeaturesShare * options_.tolerance;
    narrow_.assign(pairs() * cos_azimuth_.size(), 0.0);
    GloryCorrection features({&media, 1}, mu_least_, tolerance, {.first = first_kept_},
                             NarrowSum::features);
    if (worth_a_table(narrow_.size())) features.tabulate();
    features.add_to(narrow_.data(), inside_.mu_in, inside_.mu_out, cos_azimuth_);
    Eigen::VectorXd angles(Eigen::Index(narrow_.size()));
    Eigen::Index k = 0;
    for (const double mu_in : inside_.mu_in) {
        for (const double mu_out : inside_.mu_out) {
            for (const double cosine : cos_azimuth_)
                angles[k++] = std::acos(cos_scattering_angle(mu_in, mu_out, cosine));
        }
    }
    narrow_phase_.resize(media.size() * narrow_.size());
    Eigen::Map<Eigen::MatrixXd>(narrow_phase_.data(), angles.size(), Eigen::Index(media.size())) =
        narrow_phase(media, first_kept_, angles, tolerance);
    for (const ScaledMedium& medium : media)
        kept_.push_back(from_degree(medium.narrow, first_kept_));
}

}  // namespace miebrdf::rte
