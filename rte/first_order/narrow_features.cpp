#include "rte/first_order/narrow_features.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rte/first_order/first_order.h"
#include "rte/math/matrices.h"

namespace miebrdf::rte {
namespace {

// Of interpolation in log q.
constexpr int kMostPoints = 48;

// One degree of a medium's phase function.
struct DegreeOfMedium {
    double rest = 0.0;       // N_l
    double peak = 0.0;       // F_l
    double kept_peak = 0.0;  // what the discrete equations have of F_l: all of it below the cutoffs
    double share_kept = 1.0;  // of N_l in the discrete equations
};

DegreeOfMedium degree_of(const ScaledMedium& medium, int l) {
    DegreeOfMedium degree;
    const double f = medium.scaled.truncated;
    const int k = l - medium.narrow.first_degree;
    degree.share_kept = 1.0 - medium.scaled.share_scaled_away(l);
    degree.peak = degree.kept_peak = f;
    if (k < 0 || medium.narrow.peak.empty()) return degree;
    const bool listed = k < int(medium.narrow.peak.size());
    degree.peak = listed ? medium.narrow.peak[std::size_t(k)] : 0.0;
    if (k < int(medium.narrow.rest.size())) degree.rest = medium.narrow.rest[std::size_t(k)];
    if (l < medium.scaled.chi.size()) {
        degree.kept_peak += (1.0 - f) * medium.scaled.chi[l] - degree.share_kept * degree.rest;
    }
    return degree;
}

// The factor G of each medium, from the top down: how much light reaches it, and how much of that
// it can scatter, when a fraction of its scattering counts as none.
class AttenuatedPath {
  public:
    explicit AttenuatedPath(double q) : q_(q) {}

    double scatter(const ScaledMedium& medium, double not_scattered) {
        const double alpha = medium.exact.single_scattering_albedo;
        const double loss = (1.0 - not_scattered) + medium.exact.one_minus_albedo * not_scattered;
        if (loss == medium.scaled.depth_factor || alpha == 0.0) {
            return advance(medium.scaled_optical_depth * q_) / medium.scaled.depth_factor;
        }
        return advance(medium.scaled_optical_depth * q_ * (loss / medium.scaled.depth_factor)) /
               loss;
    }

  private:
    double advance(double slant) {
        const double absorbed = above_ * -std::expm1(-slant);
        above_ -= absorbed;
        return absorbed;
    }

    double q_;
    double above_ = 1.0;
};

// sum_l strengths(j, l) P_l(cos angle): row = angle, column = j. The recurrence is a chain in l, so
// many angles go side by side; the sums are matrix products of blocks of degrees.
Eigen::MatrixXd sum_degrees(const Eigen::MatrixXd& strengths, const Eigen::VectorXd& angles) {
    constexpr Eigen::Index group = 256;  // with a block of degrees, what a second-level cache holds
    constexpr Eigen::Index block = 64;
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(angles.size(), strengths.rows());
    Eigen::MatrixXd legendre;
    for (Eigen::Index first = 0; first < angles.size(); first += group) {
        const Eigen::Index count = std::min(group, angles.size() - first);
        const Eigen::ArrayXd x = angles.segment(first, count).array().cos();
        Eigen::ArrayXd before = Eigen::ArrayXd::Zero(count);
        Eigen::ArrayXd here = Eigen::ArrayXd::Ones(count);
        legendre.resize(count, block);
        for (Eigen::Index start = 0; start < strengths.cols(); start += block) {
            const Eigen::Index degrees = std::min(block, strengths.cols() - start);
            for (Eigen::Index d = 0; d < degrees; ++d) {
                const double l = double(start + d);
                legendre.col(d) = here.matrix();
                before = ((2.0 * l + 1.0) / (l + 1.0)) * x * here - (l / (l + 1.0)) * before;
                before.swap(here);
            }
            sums.middleRows(first, count).noalias() +=
                legendre.leftCols(degrees) * strengths.middleCols(start, degrees).transpose();
        }
    }
    return sums;
}

double log_q_of(double mu_in, double mu_out) { return std::log(1.0 / mu_in + 1.0 / mu_out); }

// Only a finite layer makes strengths depend on q.
bool depends_on_q(std::span<const std::vector<ScaledMedium>> stacks) {
    return std::any_of(stacks.begin(), stacks.end(), [](const auto& media) {
        return std::any_of(media.begin(), media.end(), [](const ScaledMedium& medium) {
            return std::isfinite(medium.scaled_optical_depth);
        });
    });
}

// Row = place in the list of log q * stacks + stack, column = degree.
Eigen::MatrixXd strengths_at(std::span<const std::vector<ScaledMedium>> stacks,
                             const Eigen::VectorXd& log_q) {
    std::vector<std::vector<double>> rows;
    std::size_t degrees = 0;
    for (const double at : log_q) {
        for (const auto& media : stacks) {
            rows.push_back(narrow_strengths(media, std::exp(at)));
            degrees = std::max(degrees, rows.back().size());
        }
    }
    Eigen::MatrixXd strengths = Eigen::MatrixXd::Zero(Eigen::Index(rows.size()),  //
                                                      Eigen::Index(degrees));
    for (std::size_t r = 0; r < rows.size(); ++r) {
        for (std::size_t l = 0; l < rows[r].size(); ++l)
            strengths(Eigen::Index(r), Eigen::Index(l)) = rows[r][l];
    }
    return strengths;
}

// Adds the sum over k of weights times values [k * stacks + stack], for each stack.
template <typename Values>
void add_weighted(const Values& values, const Eigen::VectorXd& weights, double* sums) {
    const Eigen::Index stacks = values.size() / weights.size();
    for (Eigen::Index k = 0; k < weights.size(); ++k) {
        for (Eigen::Index stack = 0; stack < stacks; ++stack)
            sums[stack] += weights[k] * values[k * stacks + stack];
    }
}

// Degrees at the end that sum to less than the tolerance at every angle: |P_l| <= 1.
void drop_tail(Eigen::MatrixXd& strengths, double tolerance) {
    double dropped = 0.0;
    Eigen::Index degrees = strengths.cols();
    while (degrees > 1) {
        dropped += strengths.col(degrees - 1).cwiseAbs().maxCoeff();
        if (!(dropped <= tolerance)) break;
        --degrees;
    }
    strengths.conservativeResize(Eigen::NoChange, degrees);
}

}  // namespace

std::vector<double> narrow_strengths(const std::vector<ScaledMedium>& media, double q) {
    int first = 0;
    int end = 0;
    for (const ScaledMedium& medium : media) {
        if (medium.narrow.rest.empty()) continue;
        first = end == 0 ? medium.narrow.first_degree : std::min(first, medium.narrow.first_degree);
        end = std::max(end, medium.narrow.first_degree + int(medium.narrow.rest.size()));
    }
    std::vector<double> strengths(std::size_t(end), 0.0);
    std::vector<double> without;  // from the top down, of no degree in particular
    AttenuatedPath no_peak(q);
    for (auto medium = media.rbegin(); medium != media.rend(); ++medium)
        without.push_back(no_peak.scatter(*medium, medium->scaled.truncated));
    for (int l = first; l < end; ++l) {
        AttenuatedPath true_peak(q), kept_peak(q);
        // The discrete equations know a peak only up to their own moments.
        const bool any_kept = std::any_of(media.begin(), media.end(), [l](const auto& medium) {
            return l < medium.scaled.chi.size();
        });
        for (std::size_t m = 0; m < media.size(); ++m) {
            const ScaledMedium& medium = media[media.size() - 1 - m];
            const DegreeOfMedium degree = degree_of(medium, l);
            const double with_true = true_peak.scatter(medium, degree.peak);
            const double with_kept =
                any_kept ? kept_peak.scatter(medium, degree.kept_peak) : without[m];
            strengths[std::size_t(l)] +=
                (2.0 * l + 1.0) * medium.exact.single_scattering_albedo * degree.rest *
                ((with_true - without[m]) - degree.share_kept * (with_kept - without[m]));
        }
    }
    return strengths;
}

NarrowFeatures::NarrowFeatures(std::span<const std::vector<ScaledMedium>> stacks, double mu_least,
                               double tolerance)
    : stacks_(stacks.size()), tolerance_(tolerance) {
    const double lowest = log_q_of(1.0, 1.0);
    const double highest = log_q_of(mu_least, mu_least);
    log_q_middle_ = 0.5 * (lowest + highest);
    log_q_half_ = std::max(0.5 * (highest - lowest), 1e-3);
    find_strengths(stacks);
    reduce_rank();
}

void NarrowFeatures::tabulate() {
    if (none()) return;
    const double shortest_wave = 2.0 * std::numbers::pi / double(strengths_.cols());
    table_.emplace([&](const Eigen::VectorXd& angles) { return sum_degrees(strengths_, angles); },
                   0.5 * shortest_wave, math::AngleTolerance{.absolute = tolerance_});
}

void NarrowFeatures::find_strengths(std::span<const std::vector<ScaledMedium>> stacks) {
    const auto log_q = [&](double t) { return log_q_middle_ + log_q_half_ * t; };
    for (int count = depends_on_q(stacks) ? 6 : 1;; count += count / 2) {
        nodes_ = math::ChebyshevPoints(count);
        Eigen::VectorXd at_nodes(count);
        for (int j = 0; j < count; ++j) at_nodes[j] = log_q(nodes_[j]);
        strengths_ = strengths_at(stacks, at_nodes);
        if (none() || count == 1) return;
        drop_tail(strengths_, 0.1 * tolerance_);
        // Between the outermost nodes and in the middle: where polynomials through them are worst.
        double error = 0.0;
        for (const double place : {0.0, 1.0, 0.5 * count}) {
            const double t = std::cos(std::numbers::pi * place / count);
            Eigen::MatrixXd difference =
                -strengths_at(stacks, Eigen::VectorXd::Constant(1, log_q(t)))
                     .leftCols(strengths_.cols());
            const Eigen::VectorXd weights = nodes_.weights(t);
            for (int j = 0; j < count; ++j) {
                difference +=
                    weights[j] * strengths_.middleRows(j * difference.rows(), difference.rows());
            }
            error = std::max(error, difference.cwiseAbs().rowwise().sum().maxCoeff());
        }
        if (error <= tolerance_ || count >= kMostPoints) return;
    }
}

void NarrowFeatures::reduce_rank() {
    const Eigen::Index nodes = nodes_.count();
    at_nodes_ = Eigen::MatrixXd::Identity(nodes, nodes);
    if (none() || nodes == 1) return;
    // One row for each node, all stacks and degrees beside each other (strengths_ is column-major).
    const Eigen::Index others = Eigen::Index(stacks_) * strengths_.cols();
    Eigen::MatrixXd of_node(nodes, others);
    for (Eigen::Index j = 0; j < nodes; ++j) {
        of_node.row(j) = strengths_.middleRows(j * Eigen::Index(stacks_), Eigen::Index(stacks_))
                             .reshaped()
                             .transpose();
    }
    // The left singular vectors, ascending: complete whatever the Gram matrix has lost in rounding.
    math::SymmetricEigen gram;
    gram.compute(of_node * of_node.transpose());
    const auto vectors = gram.vectors();
    Eigen::MatrixXd rest = of_node;
    Eigen::Index rank = 0;
    for (double left = tolerance_; rank < nodes && !(left <= 0.1 * tolerance_); ++rank) {
        const auto basis = vectors.col(nodes - 1 - rank);
        rest.noalias() -= basis * (basis.transpose() * of_node);
        left = 0.0;  // the largest sum over degrees, |P_l| <= 1
        for (Eigen::Index stack = 0; stack < Eigen::Index(stacks_); ++stack) {
            const auto of_stack = rest(Eigen::all, Eigen::seq(stack, others - 1, stacks_));
            left = std::max(left, of_stack.cwiseAbs().rowwise().sum().maxCoeff());
        }
    }
    at_nodes_ = vectors.rightCols(rank);
    const Eigen::MatrixXd reduced = at_nodes_.transpose() * of_node;
    strengths_.resize(rank * Eigen::Index(stacks_), strengths_.cols());
    for (Eigen::Index k = 0; k < rank; ++k) {
        strengths_.middleRows(k * Eigen::Index(stacks_), Eigen::Index(stacks_)) =
            reduced.row(k).reshaped(Eigen::Index(stacks_), strengths_.cols());
    }
}

void NarrowFeatures::weights_at(double q, Eigen::VectorXd& weights) const {
    if (nodes_.count() == 1) {
        weights.setOnes(1);
        return;
    }
    const double t = (std::log(q) - log_q_middle_) / log_q_half_;
    weights.noalias() = at_nodes_.transpose() * nodes_.weights(t);
}

void NarrowFeatures::add_to(double* reflection, std::span<const double> mu_in,
                            std::span<const double> mu_out,
                            std::span<const double> cos_azimuth) const {
    if (none()) return;
    if (table_) {
        add_from_table(reflection, mu_in, mu_out, cos_azimuth);
        return;
    }
    std::vector<double> angles;
    for (const double in : mu_in) {
        for (const double out : mu_out) {
            for (const double cosine : cos_azimuth)
                angles.push_back(std::acos(cos_scattering_angle(in, out, cosine)));
        }
    }
    const Eigen::MatrixXd sums = sum_degrees(
        strengths_, Eigen::Map<const Eigen::VectorXd>(angles.data(), Eigen::Index(angles.size())));
    Eigen::VectorXd weights;
    Eigen::Index k = 0;
    for (const double in : mu_in) {
        for (const double out : mu_out) {
            weights_at(1.0 / in + 1.0 / out, weights);
            weights /= 4.0 * (in + out);
            for (std::size_t a = 0; a < cos_azimuth.size(); ++a, ++k)
                add_weighted(sums.row(k), weights, &reflection[std::size_t(k) * stacks_]);
        }
    }
}

void NarrowFeatures::add_from_table(double* reflection, std::span<const double> mu_in,
                                    std::span<const double> mu_out,
                                    std::span<const double> cos_azimuth) const {
    Scratch scratch;
    std::vector<double> angles(cos_azimuth.size());
    for (const double in : mu_in) {
        for (const double out : mu_out) {
            std::transform(
                cos_azimuth.begin(), cos_azimuth.end(), angles.begin(),
                [&](double cosine) { return std::acos(cos_scattering_angle(in, out, cosine)); });
            add_at(reflection, in, out, angles, scratch);
            reflection += angles.size() * stacks_;
        }
    }
}

void NarrowFeatures::add_at(double* reflection, double mu_in, double mu_out,
                            std::span<const double> scattering_angles, Scratch& scratch) const {
    if (none()) return;
    scratch.values.resize(strengths_.rows());
    weights_at(1.0 / mu_in + 1.0 / mu_out, scratch.weights);
    scratch.weights /= 4.0 * (mu_in + mu_out);
    for (const double angle : scattering_angles) {
        table_->evaluate(angle, scratch.values);
        add_weighted(scratch.values, scratch.weights, reflection);
        reflection += stacks_;
    }
}

}  // namespace miebrdf::rte
