#include "rte/first_order/first_order_sum.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rte/boundary/rough_boundaries.h"
#include "rte/first_order/glory_correction.h"
#include "rte/first_order/ways.h"
#include "rte/grid/refraction_grid.h"
#include "rte/math/interruption.h"
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

std::vector<bool> near_retro_reflection(const Directions& directions, double within_deg) {
    const double nearest = -cos_of_degrees(within_deg);
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

void FirstOrderSum::add_to(std::vector<double>& reflection, const ScaledStack& stack) {
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
    if (exact && straight) narrow = narrow_change(first_order);

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
                if (stack.ground) {
                    reflection[first * c * c + a] +=
                        ground_reflection(stack, mu_in, mu_out, cos_azimuth_[a]);
                }
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

std::vector<double> FirstOrderSum::narrow_change(const FirstOrder& first_order) {
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
    GloryCorrection narrow({&media, 1}, mu_least_, kGloryShare * options_.tolerance,
                           {.end = first_kept_});
    if (worth_a_table(change.size())) narrow.tabulate();
    narrow.add_to(change.data(), inside_.mu_in, inside_.mu_out, cos_azimuth_);
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
    if (narrow_degrees(media).end <= first_kept_) {
        first_kept_ = std::numeric_limits<int>::max();
        return;
    }
    const double tolerance = kGloryShare * options_.tolerance;
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
