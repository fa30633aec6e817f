#include "rte/first_order/glory_correction.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "rte/first_order/first_order.h"
#include "rte/math/interruption.h"
#include "rte/math/legendre.h"
#include "rte/math/matrices.h"

namespace miebrdf::rte {
namespace {

// Nodes of interpolation in log q. A coat of tau = 0.1 takes 9 at a tolerance of 1e-3.
constexpr int kFewPoints = 9, kMostPoints = 48;

// sum_l strengths(j, l) P_l(cos angle): row = angle, column = j.
Eigen::MatrixXd sum_degrees(const Eigen::MatrixXd& strengths, const Eigen::VectorXd& angles) {
    return math::legendre_sums(strengths, angles.array().cos());
}

math::AngleTable table_of(const Eigen::MatrixXd& strengths, double tolerance) {
    const double shortest_wave = 2.0 * std::numbers::pi / double(strengths.cols());
    return {[&](const Eigen::VectorXd& angles) { return sum_degrees(strengths, angles); },
            0.5 * shortest_wave, math::AngleTolerance{.absolute = tolerance}};
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
template <typename Strengths>
Eigen::MatrixXd strengths_at(const std::vector<GloryStrengths>& stacks,
                             const Strengths& strengths_of, const Eigen::VectorXd& log_q) {
    std::vector<Eigen::VectorXd> rows;
    Eigen::Index degrees = 0;
    for (const double at : log_q) {
        for (const GloryStrengths& stack : stacks) {
            rows.push_back(strengths_of(stack, std::exp(at)));
            degrees = std::max(degrees, rows.back().size());
        }
    }
    Eigen::MatrixXd strengths = Eigen::MatrixXd::Zero(Eigen::Index(rows.size()), degrees);
    for (std::size_t r = 0; r < rows.size(); ++r)
        strengths.row(Eigen::Index(r)).head(rows[r].size()) = rows[r].transpose();
    return strengths;
}

// Adds the sum over k of weights times values [k * stacks + stack], for each stack.
template <typename Values>
void add_weighted(const Values& values, const Eigen::VectorXd& weights, double* sums) {
    const Eigen::Index stacks = values.size() / weights.size();
    if (stacks == 1) {
        *sums += values.reshaped().dot(weights);
        return;
    }
    for (Eigen::Index k = 0; k < weights.size(); ++k) {
        for (Eigen::Index stack = 0; stack < stacks; ++stack)
            sums[stack] += weights[k] * values[k * stacks + stack];
    }
}

// Ascending: orthonormal, and complete, whatever the Gram matrix has lost in rounding.
Eigen::MatrixXd left_singular_vectors(const Eigen::MatrixXd& of) {
    math::SymmetricEigen gram;
    if (of.rows() <= of.cols()) {
        gram.compute(of * of.transpose());
        return gram.vectors();
    }
    // The fewer columns of a tall matrix span as many dimensions.
    const Eigen::HouseholderQR<Eigen::MatrixXd> factors(of);
    const Eigen::MatrixXd triangle =
        factors.matrixQR().topRows(of.cols()).triangularView<Eigen::Upper>();
    gram.compute(triangle * triangle.transpose());
    Eigen::MatrixXd vectors = Eigen::MatrixXd::Zero(of.rows(), of.cols());
    vectors.topRows(of.cols()) = gram.vectors();
    vectors.applyOnTheLeft(factors.householderQ());
    return vectors;
}

struct Reduced {
    Eigen::MatrixXd at_nodes;   // functions (columns) at the nodes (rows)
    Eigen::MatrixXd strengths;  // row = function * stacks + stack, column = degree
};

// Replaces one function for each node by as few as the tolerance allows.
// of_node: column = degree * stacks + stack
Reduced reduce_rank(const Eigen::MatrixXd& of_node, Eigen::Index stacks, double tolerance) {
    const Eigen::Index others = of_node.cols();
    const Eigen::MatrixXd vectors = left_singular_vectors(of_node);
    Eigen::MatrixXd rest = of_node;
    Eigen::Index rank = 0;
    for (double left = tolerance; rank < vectors.cols() && !(left <= 0.1 * tolerance); ++rank) {
        const auto basis = vectors.col(vectors.cols() - 1 - rank);
        rest.noalias() -= basis * (basis.transpose() * of_node);
        left = 0.0;  // the largest sum over degrees, |P_l| <= 1
        for (Eigen::Index stack = 0; stack < stacks; ++stack) {
            const auto of_stack = rest(Eigen::all, Eigen::seq(stack, others - 1, stacks));
            left = std::max(left, of_stack.cwiseAbs().rowwise().sum().maxCoeff());
        }
    }
    Reduced reduced;
    reduced.at_nodes = vectors.rightCols(rank);
    const Eigen::MatrixXd rows = reduced.at_nodes.transpose() * of_node;
    reduced.strengths.resize(rank * stacks, others / stacks);
    for (Eigen::Index k = 0; k < rank; ++k)
        reduced.strengths.middleRows(k * stacks, stacks) =
            rows.row(k).reshaped(stacks, others / stacks);
    return reduced;
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

bool worth_a_table(std::size_t directions) { return directions > 2000; }

Eigen::MatrixXd narrow_phase(const std::vector<ScaledMedium>& media, int first_degree,
                             const Eigen::VectorXd& angles, double tolerance) {
    const Eigen::Index degrees = std::max(narrow_degrees(media).end, 1);
    Eigen::MatrixXd strengths = Eigen::MatrixXd::Zero(Eigen::Index(media.size()), degrees);
    for (std::size_t i = 0; i < media.size(); ++i) {
        const auto& [first, peak, structure] = media[i].narrow;
        for (int l = std::max(first, first_degree); l < first + int(structure.size()); ++l)
            strengths(Eigen::Index(i), l) = (2.0 * l + 1.0) * structure[std::size_t(l - first)];
    }
    if (!worth_a_table(std::size_t(angles.size()))) return sum_degrees(strengths, angles);
    const math::AngleTable table = table_of(strengths, tolerance);
    Eigen::MatrixXd values(angles.size(), strengths.rows());
    Eigen::VectorXd at_angle(strengths.rows());
    for (Eigen::Index a = 0; a < angles.size(); ++a) {
        table.evaluate(angles[a], at_angle);
        values.row(a) = at_angle.transpose();
    }
    return values;
}

GloryCorrection::GloryCorrection(std::span<const std::vector<ScaledMedium>> stacks, double mu_least,
                                 double tolerance, const DegreeRange& degrees, NarrowSum sum)
    : stacks_(stacks.size()), tolerance_(tolerance) {
    const double lowest = log_q_of(1.0, 1.0);
    const double highest = log_q_of(mu_least, mu_least);
    log_q_middle_ = 0.5 * (lowest + highest);
    log_q_half_ = std::max(0.5 * (highest - lowest), 1e-3);
    std::vector<GloryStrengths> all;
    for (const auto& media : stacks) all.emplace_back(media, degrees, sum);
    const bool one_q = !depends_on_q(stacks);
    known_ = slant_functions(all, one_q, std::mem_fn(&GloryStrengths::of_all), tolerance_);
    strengths_ = known_.strengths;
    if (sum == NarrowSum::correction) add_unresolved(all, one_q);
}

void GloryCorrection::tabulate() {
    if (!none()) table_.emplace(table_of(strengths_, tolerance_));
}

Eigen::VectorXd GloryCorrection::SlantFunctions::at(double t) const {
    if (strengths.size() == 0) return {};
    if (nodes.count() == 1) return Eigen::VectorXd::Ones(1);
    return at_nodes.transpose() * nodes.weights(t);
}

GloryCorrection::SlantFunctions GloryCorrection::slant_functions(
    const std::vector<GloryStrengths>& stacks, bool one_q, const Strengths& strengths_of,
    double tolerance) const {
    const auto log_q = [&](double t) { return log_q_middle_ + log_q_half_ * t; };
    SlantFunctions functions;
    Eigen::MatrixXd& strengths = functions.strengths;
    for (int count = one_q ? 1 : kFewPoints;; count += count / 2) {
        functions.nodes = math::ChebyshevPoints(count);
        functions.at_nodes = Eigen::MatrixXd::Identity(count, count);
        Eigen::VectorXd at_nodes(count);
        for (int j = 0; j < count; ++j) at_nodes[j] = log_q(functions.nodes[j]);
        strengths = strengths_at(stacks, strengths_of, at_nodes);
        if (strengths.isZero(0.0)) strengths.resize(0, 0);
        if (strengths.size() == 0 || count == 1) return functions;
        drop_tail(strengths, 0.1 * tolerance);
        // Between the outermost nodes and in the middle: where polynomials through them are worst.
        double error = 0.0;
        for (const double place : {0.0, 1.0, 0.5 * count}) {
            const double t = std::cos(std::numbers::pi * place / count);
            Eigen::MatrixXd difference =
                -strengths_at(stacks, strengths_of, Eigen::VectorXd::Constant(1, log_q(t)))
                     .leftCols(strengths.cols());
            const Eigen::VectorXd weights = functions.nodes.weights(t);
            for (int j = 0; j < count; ++j)
                difference +=
                    weights[j] * strengths.middleRows(j * difference.rows(), difference.rows());
            error = std::max(error, difference.cwiseAbs().rowwise().sum().maxCoeff());
        }
        if (error <= tolerance || count >= kMostPoints) break;
    }
    // One row for each node, all stacks and degrees beside each other (strengths is column-major).
    const Eigen::Index stack_count = Eigen::Index(stacks_), columns = strengths.cols();
    Eigen::MatrixXd of_node(functions.nodes.count(), stack_count * columns);
    for (Eigen::Index j = 0; j < of_node.rows(); ++j) {
        of_node.row(j) = strengths.middleRows(j * stack_count, stack_count).reshaped().transpose();
    }
    Reduced reduced = reduce_rank(of_node, stack_count, tolerance);
    functions.at_nodes = std::move(reduced.at_nodes);
    strengths = std::move(reduced.strengths);
    return functions;
}

void GloryCorrection::add_unresolved(const std::vector<GloryStrengths>& stacks, bool one_q) {
    // Sums over degrees are over all angles of zenith here, and two of these count.
    unresolved_ = slant_functions(stacks, one_q, std::mem_fn(&GloryStrengths::of_unresolved),
                                  0.5 * kResolvedAngles * tolerance_);
    const Eigen::MatrixXd& strengths = unresolved_.strengths;
    const Eigen::Index stack_count = Eigen::Index(stacks_);
    const Eigen::Index functions = strengths.rows() / stack_count;
    const Eigen::Index degrees = (strengths.cols() + kResolvedAngles - 1) / kResolvedAngles;
    if (strengths.size() == 0) return;
    Eigen::MatrixXd of_pair =
        Eigen::MatrixXd::Zero(functions * kResolvedAngles, stack_count * degrees);
    for (Eigen::Index j = 0; j < functions; ++j) {
        for (Eigen::Index stack = 0; stack < stack_count; ++stack) {
            for (Eigen::Index c = 0; c < strengths.cols(); ++c) {
                of_pair(j * kResolvedAngles + c % kResolvedAngles,
                        c / kResolvedAngles * stack_count + stack) =
                    strengths(j * stack_count + stack, c);
            }
        }
    }
    Reduced reduced = reduce_rank(of_pair, stack_count, tolerance_);
    at_pairs_ = std::move(reduced.at_nodes);
    const Eigen::Index known = strengths_.rows(), columns = std::max(strengths_.cols(), degrees);
    Eigen::MatrixXd both = Eigen::MatrixXd::Zero(known + reduced.strengths.rows(), columns);
    both.topLeftCorner(known, strengths_.cols()) = strengths_;
    both.bottomLeftCorner(reduced.strengths.rows(), degrees) = reduced.strengths;
    strengths_ = std::move(both);
}

void GloryCorrection::weights_at(double mu_in, double mu_out, Eigen::VectorXd& weights) const {
    const double t = (std::log(1.0 / mu_in + 1.0 / mu_out) - log_q_middle_) / log_q_half_;
    const Eigen::VectorXd known = known_.at(t), unresolved = unresolved_.at(t);
    weights.setZero(known.size() + at_pairs_.cols());
    weights.head(known.size()) = known;
    for (const double mu : {mu_in, mu_out}) {
        const double place = std::acos(mu) * (2.0 / std::numbers::pi) * (kResolvedAngles - 1);
        const Eigen::Index k = std::min(Eigen::Index(place), Eigen::Index(kResolvedAngles - 2));
        const double beyond = place - double(k);
        for (Eigen::Index j = 0; j < unresolved.size(); ++j) {
            const Eigen::Index row = j * kResolvedAngles + k;
            weights.tail(at_pairs_.cols()) +=
                unresolved[j] *
                ((1.0 - beyond) * at_pairs_.row(row) + beyond * at_pairs_.row(row + 1)).transpose();
        }
    }
    weights /= 4.0 * (mu_in + mu_out);
}

void GloryCorrection::add_to(double* reflection, std::span<const double> mu_in,
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
            weights_at(in, out, weights);
            for (std::size_t a = 0; a < cos_azimuth.size(); ++a, ++k)
                add_weighted(sums.row(k), weights, &reflection[std::size_t(k) * stacks_]);
        }
    }
}

void GloryCorrection::add_from_table(double* reflection, std::span<const double> mu_in,
                                     std::span<const double> mu_out,
                                     std::span<const double> cos_azimuth) const {
    Scratch scratch;
    std::vector<double> angles(cos_azimuth.size());
    for (const double in : mu_in) {
        for (const double out : mu_out) {
            math::interruption_point();
            std::transform(
                cos_azimuth.begin(), cos_azimuth.end(), angles.begin(),
                [&](double cosine) { return std::acos(cos_scattering_angle(in, out, cosine)); });
            add_at(reflection, in, out, angles, scratch);
            reflection += angles.size() * stacks_;
        }
    }
}

void GloryCorrection::add_at(double* reflection, double mu_in, double mu_out,
                             std::span<const double> scattering_angles, Scratch& scratch) const {
    if (none()) return;
    scratch.values.resize(strengths_.rows());
    weights_at(mu_in, mu_out, scratch.weights);
    for (const double angle : scattering_angles) {
        table_->evaluate(angle, scratch.values);
        add_weighted(scratch.values, scratch.weights, reflection);
        reflection += stacks_;
    }
}

}  // namespace miebrdf::rte
