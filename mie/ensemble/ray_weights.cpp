#include "mie/ensemble/ray_weights.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace miebrdf::mie {
namespace {

constexpr int kPowers = 5;       // of ln x, from 0
constexpr int kRowsPerRate = 4;  // cos and sin, each also times ln x

// Chosen by the error of 24 weighted sizes against 768 (tests/mie/ray_weights_test.cpp;
// docs/internals/mie-log.md#rays).
// docs/internals/constants.md says what each constant does.
struct InterferenceRule {
    /// Terms at one angle: the brightest count.
    static constexpr std::size_t kMostRays = 6, kMostRates = 8;
    /// Two phases that differ by less, in radians over all sizes, are one ray.
    static constexpr double kSamePhase = 0.7;
    /// Rays along the edge that all but come to the angle, in radians.
    static constexpr double kNearEdge = 0.35;
    /// Incidences at which deviations are known, and the width in x of pieces with eight nodes:
    /// enough for rates up to some 2.
    static constexpr int kIncidences = 128;
    static constexpr double kWidestPiece = 4;
    /// How far conditions may be missed, in squares, and the largest sum of absolute weights.
    static constexpr double kGiven = 1e-5, kLargestWeights = 8;
    static constexpr int kAnglesPerJob = 8;
};

// The share of light that leaves after some ways through the sphere, over both polarisations.
double share_of(int way, double cos_outside, double inner_path, double index) {
    const double s = (cos_outside - inner_path) / (cos_outside + inner_path);
    const double ratio = index * index * cos_outside;
    const double p = (ratio - inner_path) / (ratio + inner_path);
    double share = 0;
    for (const double reflected : {s * s, p * p}) {
        share +=
            0.5 * (way == 0 ? reflected
                            : (1 - reflected) * (1 - reflected) * std::pow(reflected, way - 1));
    }
    return share;
}

// To within half a turn: std::remainder() takes ten times as long.
double within_half_turn(double angle) {
    return angle - 2 * std::numbers::pi * std::nearbyint(angle / (2 * std::numbers::pi));
}

}  // namespace

RayInterference::RayInterference(double index, const RaySizes& sizes)
    : index_(index),
      smallest_x_(sizes.smallest_x()),
      largest_x_(sizes.largest_x()),
      log_centre_(0.5 * std::log(smallest_x_ * largest_x_)),
      log_half_(0.5 * std::log(largest_x_ / smallest_x_)) {
    constexpr int count = InterferenceRule::kIncidences;
    for (int i = 0; i <= count; ++i) {
        const double outside = 0.5 * std::numbers::pi * i / count;
        incidences_.push_back({outside, std::asin(std::sin(outside) / index)});
    }
    static const math::Quadrature rule = math::gauss_legendre(kLaneCount, 0, 1);
    const double width = largest_x_ - smallest_x_;
    const int pieces = static_cast<int>(std::ceil(width / InterferenceRule::kWidestPiece));
    piece_width_ = width / pieces;
    for (int lane = 0; lane < kLaneCount; ++lane)
        first_nodes_[lane] = smallest_x_ + piece_width_ * rule.nodes[lane];
    double whole = 0;
    for (int piece = 0; piece < pieces; ++piece) {
        Lanes share, scaled_share;
        for (int lane = 0; lane < kLaneCount; ++lane) {
            const double x = first_nodes_[lane] + piece * piece_width_;
            share[lane] = piece_width_ * rule.weights[lane] * sizes.area_at(x);
            scaled_share[lane] = share[lane] * scaled(x);
        }
        whole += share.sum();
        shares_.push_back(share);
        scaled_shares_.push_back(scaled_share);
    }
    means_of_powers_ = Eigen::VectorXd::Zero(kPowers);
    for (int piece = 0; piece < pieces; ++piece) {
        shares_[piece] /= whole;
        scaled_shares_[piece] /= whole;
        for (int lane = 0; lane < kLaneCount; ++lane) {
            const double t = scaled(first_nodes_[lane] + piece * piece_width_);
            double power = shares_[piece][lane];
            for (int i = 0; i < kPowers; ++i, power *= t) means_of_powers_[i] += power;
        }
    }
}

double RayInterference::scaled(double x) const { return (std::log(x) - log_centre_) / log_half_; }

double RayInterference::deviation(int way, double outside, double inside) const {
    return 2 * (outside - way * inside) + (way - 1) * std::numbers::pi;
}

// One that would come to the angle, were its deviation the target.
RayInterference::Ray RayInterference::ray(int way, double outside, double target) const {
    const double b = std::sin(outside), cosine = std::cos(outside);
    const double inner = std::sqrt(index_ * index_ - b * b);
    const double aside = target - deviation(way, outside, std::asin(b / index_));
    // At a bow the deviation does not turn.
    const double turn =
        std::max(std::abs(2 - 2 * way * cosine / inner), std::numeric_limits<double>::min());
    return {2 * (way * inner - cosine) + b * aside,
            share_of(way, cosine, inner, index_) * b * cosine / turn};
}

// Adds those of incidences from `first` to `last`, over which the deviation rises or falls.
void RayInterference::add_rays(int way, double angle, std::size_t first, std::size_t last,
                               std::vector<Ray>& to) const {
    const auto deviation_at = [&](std::size_t i) {
        return deviation(way, incidences_[i].outside, incidences_[i].inside);
    };
    const double at_first = deviation_at(first), at_last = deviation_at(last);
    const double least = std::min(at_first, at_last), most = std::max(at_first, at_last);
    const auto first_turn = static_cast<int>(std::ceil((least - angle) / (2 * std::numbers::pi)));
    const auto last_turn = static_cast<int>(std::floor((most - angle) / (2 * std::numbers::pi)));
    for (int turn = first_turn; turn <= last_turn; ++turn) {
        const double target = angle + 2 * std::numbers::pi * turn;
        std::size_t below = first, above = last;
        while (above - below > 1) {
            const std::size_t middle = (below + above) / 2;
            ((deviation_at(middle) < target) == (at_first < at_last) ? below : above) = middle;
        }
        const double before = deviation_at(below), after = deviation_at(above);
        const double share = before == after ? 0 : (target - before) / (after - before);
        const double step = incidences_[above].outside - incidences_[below].outside;
        to.push_back(ray(way, incidences_[below].outside + share * step, target));
    }
}

std::vector<RayInterference::Ray> RayInterference::rays(int way, double theta) const {
    std::vector<Ray> all;
    const double bow =
        way > index_ ? std::asin(std::sqrt((way * way - index_ * index_) / (way * way - 1))) : 0;
    // Deviations fall up to the bow and rise from there on.
    const std::size_t last = incidences_.size() - 1;
    const auto least =
        static_cast<std::size_t>(std::lround(bow / (0.5 * std::numbers::pi) * double(last)));
    for (const double angle : {theta, -theta}) {
        if (least > 0) add_rays(way, angle, 0, least, all);
        if (least < last) add_rays(way, angle, least, last, all);
        const double at_edge = deviation(way, 0.5 * std::numbers::pi, incidences_.back().inside);
        const double aside = within_half_turn(angle - at_edge);
        if (std::abs(aside) < InterferenceRule::kNearEdge)
            all.push_back(ray(way, 0.5 * std::numbers::pi, at_edge + aside));
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const Ray& a, const Ray& b) { return a.intensity > b.intensity; });
    return all;
}

// cos, cos times ln x, sin, sin times ln x
void RayInterference::put_means(double rate, double* means) const {
    const auto turns = [](const Lanes& phase) {
        ComplexLanes turn;
        for (int lane = 0; lane < kLaneCount; ++lane) {
            turn.re[lane] = std::cos(phase[lane]);
            turn.im[lane] = std::sin(phase[lane]);
        }
        return turn;
    };
    ComplexLanes turn = turns(rate * first_nodes_);
    const double step_re = std::cos(rate * piece_width_), step_im = std::sin(rate * piece_width_);
    ComplexLanes sum{Lanes::Zero(), Lanes::Zero()}, scaled_sum{Lanes::Zero(), Lanes::Zero()};
    for (std::size_t piece = 0; piece < shares_.size(); ++piece) {
        sum.re += shares_[piece] * turn.re;
        sum.im += shares_[piece] * turn.im;
        scaled_sum.re += scaled_shares_[piece] * turn.re;
        scaled_sum.im += scaled_shares_[piece] * turn.im;
        const Lanes re = step_re * turn.re - step_im * turn.im;
        turn.im = step_re * turn.im + step_im * turn.re;
        turn.re = re;
    }
    means[0] = sum.re.sum();
    means[1] = scaled_sum.re.sum();
    means[2] = sum.im.sum();
    means[3] = scaled_sum.im.sum();
}

std::vector<double> RayInterference::rates(int way, double theta) const {
    // Straight forward and back both sides of the sphere are one.
    const double least = 0.5 / largest_x_;
    std::vector<double> phases;
    for (const Ray& ray : rays(way, std::clamp(theta, least, std::numbers::pi - least))) {
        const bool known = std::any_of(phases.begin(), phases.end(), [&](double phase) {
            return std::abs(phase - ray.phase) * largest_x_ < InterferenceRule::kSamePhase;
        });
        if (!known) phases.push_back(ray.phase);
        if (phases.size() == InterferenceRule::kMostRays) break;
    }
    std::vector<double> rates;
    for (std::size_t i = 0; i < phases.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const double rate = std::abs(phases[i] - phases[j]);
            const bool known = std::any_of(rates.begin(), rates.end(), [&](double of) {
                return std::abs(of - rate) * (largest_x_ - smallest_x_) <
                       InterferenceRule::kSamePhase;
            });
            if (!known && rates.size() < InterferenceRule::kMostRates) rates.push_back(rate);
        }
    }
    return rates;
}

RayInterference::Terms RayInterference::terms(int way, double theta) const {
    Terms terms{rates(way, theta), {}};
    terms.means.resize(kPowers + kRowsPerRate * Eigen::Index(terms.rates.size()));
    terms.means.head(kPowers) = means_of_powers_;
    for (std::size_t i = 0; i < terms.rates.size(); ++i)
        put_means(terms.rates[i], terms.means.data() + kPowers + kRowsPerRate * Eigen::Index(i));
    return terms;
}

RayInterference::Sampled RayInterference::sampled(const WeightedSizes& sizes) const {
    const auto count = static_cast<Eigen::Index>(sizes.parameters.size());
    Sampled at{Eigen::ArrayXd(count), Eigen::ArrayXd(count), Eigen::ArrayXd(count)};
    for (Eigen::Index i = 0; i < count; ++i) {
        at.x[i] = sizes.parameters[i];
        at.scaled[i] = scaled(at.x[i]);
        at.root_shares[i] = at.x[i] * std::sqrt(sizes.weights[i]);
    }
    at.root_shares /= at.root_shares.matrix().norm();
    return at;
}

Eigen::VectorXd RayInterference::factors(const Terms& terms, const Sampled& sizes) const {
    const Eigen::ArrayXd &x = sizes.x, &t = sizes.scaled, &roots = sizes.root_shares;
    // Conditions (columns) at the sizes, times the roots of the shares of these.
    thread_local Eigen::MatrixXd conditions, products;
    thread_local Eigen::ArrayXd scaled_roots, turns;
    thread_local Eigen::ArrayXf phase, turned;
    conditions.resize(x.size(), terms.means.size());
    scaled_roots = roots;
    for (int j = 0; j < kPowers; ++j, scaled_roots *= t) conditions.col(j) = scaled_roots;
    scaled_roots = roots * t;
    Eigen::Index condition = kPowers;
    const auto put = [&] {
        conditions.col(condition++) = turned.cast<double>() * roots;
        conditions.col(condition++) = turned.cast<double>() * scaled_roots;
    };
    for (const double rate : terms.rates) {
        // Weights need no more digits than single precision has, which has vectors of sines.
        turns = rate / (2 * std::numbers::pi) * x;
        phase = (2 * std::numbers::pi * (turns - turns.rint())).cast<float>();
        turned = phase.cos();
        put();
        turned = phase.sin();
        put();
    }
    const Eigen::VectorXd missed = terms.means - conditions.transpose() * roots.matrix();
    products.setZero(terms.means.size(), terms.means.size());
    products.selfadjointView<Eigen::Lower>().rankUpdate(conditions.transpose());
    products.diagonal().array() += InterferenceRule::kGiven;
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> solver(products);
    Eigen::VectorXd factors = conditions * solver.solve(missed);
    factors = 1 + factors.array() / roots;
    if (!((factors.array().abs() * roots.square()).sum() <= InterferenceRule::kLargestWeights))
        factors.setOnes();
    return factors;
}

std::array<AngularFunctionsOf<float>::Factors, 2> RayInterference::factors_of_columns(
    const RayGroup& group, const WeightedSizes* const (&sizes)[2],
    const AngularFunctionsOf<float>& angular, const Executor& run) const {
    std::array<AngularFunctionsOf<float>::Factors, 2> all;
    const int ways = group.columns();
    const Sampled both[] = {sampled(*sizes[0]), sampled(*sizes[1])};
    for (const int sample : {0, 1}) {
        const auto count = static_cast<int>(sizes[sample]->parameters.size());
        const int eights = (count + kLaneCount - 1) / kLaneCount;
        all[sample].setZero(angular.angle_count(), eights * kLaneCount * ways);
    }
    const int jobs = (angular.angle_count() + InterferenceRule::kAnglesPerJob - 1) /
                     InterferenceRule::kAnglesPerJob;
    run(jobs, [&](int job) {
        const int end =
            std::min(angular.angle_count(), (job + 1) * InterferenceRule::kAnglesPerJob);
        for (int angle = job * InterferenceRule::kAnglesPerJob; angle < end; ++angle) {
            const double theta = std::acos(angular.cosine(angle));
            for (int way = 0; way < ways; ++way) {
                const Terms of_way = terms(group.first_way + way, theta);
                for (const int sample : {0, 1}) {
                    const Eigen::VectorXd own = factors(of_way, both[sample]);
                    for (Eigen::Index i = 0; i < own.size(); ++i) {
                        const Eigen::Index eight = i / kLaneCount, lane = i % kLaneCount;
                        all[sample](angle, (eight * ways + way) * kLaneCount + lane) =
                            static_cast<float>(own[i]);
                    }
                }
            }
        }
    });
    return all;
}

}  // namespace miebrdf::mie
