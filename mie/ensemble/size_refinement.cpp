#include "mie/ensemble/size_refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace miebrdf::mie {
namespace {

// ln q_ext, ln(1 - albedo), albedo and g.
using Scalars = Eigen::Array4d;
constexpr int kLogOfAbsorption = 1, kAsymmetry = 3;

Scalars scalars_of(double extinguished, double absorbed, double asymmetry) {
    return {std::log(extinguished), absorbed > 0 ? std::log(absorbed) : 0.0, absorbed, asymmetry};
}

Scalars scalars_of(const SphereSums& sums) {
    const double extinguished = sums.scattered + sums.absorbed;
    return scalars_of(extinguished, sums.absorbed / extinguished,
                      2 * sums.asymmetric / sums.scattered);
}

// The changes of the scalars that count alike. A half-space of similar spheres has an albedo A with
// 1 - A about sqrt(6 (1 - omega) / (1 - omega g)): d(1 - A) = (1 - A)/2 d ln(1 - omega), at most
// 0.15; and light that is scattered forward is light that is not scattered, so that g counts as
// 1 - g does.
Scalars weights_of(const EnsembleOptics& optics) {
    return {1.0, std::min(0.15, 0.5 * std::sqrt(6 * similar_absorption(optics))),
            1 / std::max(optics.single_scattering_albedo, 1e-30),
            1 / std::clamp(1 - optics.asymmetry, 1e-6, 1.0)};
}
Scalars weights_of(const SphereSums& sums) { return weights_of(efficiencies_of(sums, 1.0)); }

// Series may be of different lengths: what a shorter one lacks is zero.
Eigen::ArrayXd difference(const Eigen::ArrayXd& a, const Eigen::ArrayXd& b) {
    Eigen::ArrayXd result = Eigen::ArrayXd::Zero(std::max(a.size(), b.size()));
    result.head(a.size()) = a;
    result.head(b.size()) -= b;
    return result;
}

SphereSums mean_of(SphereSums a, const SphereSums& b) {
    a.add(b);
    a.scale(0.5);
    return a;
}

// The averages of some sums, and what they change by those of more sizes.
class Refinement {
  public:
    Refinement(const Ensemble& ensemble, const SizeSummation& summation)
        : ensemble_(ensemble), summation_(summation) {}

    RefinedAverage single();
    /// Whether Gauss rules are enough.
    bool by_gauss_nodes(double tolerance);
    void by_even_nodes(int most_sizes);
    RefinedAverage result() && { return std::move(result_); }

  private:
    SizeNodes even_nodes(int count, double offset) const {
        return even_size_nodes(ensemble_.sizes, ensemble_.range, count, offset);
    }
    /// After a doubling: `sums` in place of those before.
    double change_by(SizeSums sums, bool all);
    double scatter() const;
    void sum_all_again(int count);
    double change_of_averages() const {
        return summation_.size_of(result_.change, result_.averages, result_.sums.spheres);
    }
    void put_error(double error);
    bool is_enough() const { return result_.error_estimate <= tolerance_; }

    const Ensemble& ensemble_;
    const SizeSummation& summation_;
    std::array<SphereSums, 4> lattices_ = {};  // in the order of their first sizes
    RefinedAverage result_ = {};
    double tolerance_ = 0;
};

RefinedAverage Refinement::single() {
    result_.sums = summation_.sum({{ensemble_.range.largest_um}, {1.0}}, true);
    result_.averages = summation_.averages(result_.sums);
    result_.error_estimate = AverageLimits::kRounding;
    result_.sizes = 1;
    return std::move(result_);
}

void Refinement::put_error(double error) {
    tolerance_ = summation_.tolerance(result_.sums.spheres);
    result_.error_estimate = stated_error(SizeRule::kSafety * error, tolerance_);
}

double Refinement::change_by(SizeSums sums, bool all) {
    const SphereSums before = result_.sums.spheres;
    if (all) {
        result_.sums = std::move(sums);
        const Eigen::ArrayXd averages = summation_.averages(result_.sums);
        result_.change = difference(averages, result_.averages);
        result_.averages = averages;
    } else {
        result_.sums.spheres = sums.spheres;
    }
    const Scalars change = scalars_of(result_.sums.spheres) - scalars_of(before);
    return (change.abs() * weights_of(result_.sums.spheres)).maxCoeff();
}

bool Refinement::by_gauss_nodes(double tolerance) {
    const auto sum = [&](int count) {
        result_.sizes = count;
        return summation_.sum(smooth_size_nodes(ensemble_.sizes, ensemble_.range, count), true);
    };
    result_.sums = sum(SizeRule::kFirstGauss);
    result_.averages = summation_.averages(result_.sums);
    for (int count = 2 * SizeRule::kFirstGauss; count <= SizeRule::kMostGauss; count *= 2) {
        const double of_scalars = change_by(sum(count), true);
        put_error(std::max(of_scalars, change_of_averages()));
        if (is_enough()) return true;
    }
    // What is wanted beyond the tolerance is not worth sampling ripple.
    return result_.error_estimate <= tolerance;
}

// The largest standard error of the mean of the four.
double Refinement::scatter() const {
    const Scalars mean = scalars_of(result_.sums.spheres);
    Scalars squares = Scalars::Zero();
    for (const SphereSums& lattice : lattices_) squares += (scalars_of(lattice) - mean).square();
    Scalars errors = (squares / (4.0 * 3.0)).sqrt() * weights_of(result_.sums.spheres);
    errors[kLogOfAbsorption] *= SizeRule::kAbsorptionScatter;
    return errors.maxCoeff();
}

void Refinement::sum_all_again(int count) {
    result_.sums = summation_.sum(even_nodes(count / 2, 1.0), true);
    const Eigen::ArrayXd half = summation_.averages(result_.sums);
    result_.sums.add(summation_.sum(even_nodes(count / 2, 0.5), true));
    result_.sums.scale(0.5);
    result_.averages = summation_.averages(result_.sums);
    result_.change = difference(result_.averages, half);
}

void Refinement::by_even_nodes(int most_sizes) {
    // Sums over every other size, and over those between, each of them a rule of its own.
    const auto split = [](const SizeSums& sums, SphereSums& first, SphereSums& second) {
        first = sums.every_other;
        first.scale(2);
        second = sums.spheres;
        second.scale(2);
        SphereSums less = first;
        less.scale(-1);
        second.add(less);
    };
    bool all = true;         // moments are summed, too
    double of_averages = 0;  // their change, before the factor of safety
    double asymmetry = 0;    // when they were summed last
    result_.is_smooth = false;
    result_.sums = summation_.sum(even_nodes(SizeRule::kFirstEven / 2, 1.0), all);
    result_.averages = summation_.averages(result_.sums);
    split(result_.sums, lattices_[1], lattices_[3]);
    for (int count = SizeRule::kFirstEven;; count *= 2) {
        SizeSums sums = summation_.sum(even_nodes(count / 2, 0.5), all);
        if (count > SizeRule::kFirstEven) {
            lattices_[3] = mean_of(lattices_[1], lattices_[3]);
            lattices_[1] = mean_of(lattices_[0], lattices_[2]);
        }
        split(sums, lattices_[0], lattices_[2]);
        if (all) {
            sums.add(result_.sums);
            sums.scale(0.5);
        } else {
            sums.spheres = mean_of(sums.spheres, result_.sums.spheres);
        }
        const double of_scalars = change_by(std::move(sums), all);
        const Scalars scalars = scalars_of(result_.sums.spheres);
        const double tolerance = summation_.tolerance(result_.sums.spheres);
        const auto judge_averages = [&] {
            of_averages = change_of_averages();
            asymmetry = scalars[kAsymmetry];
        };
        if (all) judge_averages();
        double moved = std::abs(scalars[kAsymmetry] - asymmetry);
        if (SizeRule::kSafety * moved > tolerance) {
            sum_all_again(count);
            judge_averages();
            all = true;
            moved = 0;
        }
        result_.sizes = count;
        put_error(std::max({of_scalars, scatter(), of_averages, moved}));
        if (is_enough() || 2 * count > most_sizes) return;
        if (all && count > SizeRule::kFirstEven)
            all = SizeRule::kSafety * of_averages > AverageLimits::kPartShare * tolerance;
    }
}

}  // namespace

bool is_smooth_in_size(const Ensemble& ensemble) {
    return ensemble.scatterer.damping(ensemble.effective_x()) > SizeRule::kSmoothDamping ||
           ensemble.scatterer.outer_x(ensemble.largest_x()) < SizeRule::kSmallSphere;
}

RefinedAverage refine_sizes(const Ensemble& ensemble, const SizeSummation& summation,
                            double tolerance, int most_sizes) {
    Refinement refinement(ensemble, summation);
    if (ensemble.law().single_size) return refinement.single();
    if (!is_smooth_in_size(ensemble) || !refinement.by_gauss_nodes(tolerance))
        refinement.by_even_nodes(most_sizes);
    return std::move(refinement).result();
}

double difference_between(const EnsembleOptics& a, const EnsembleOptics& b) {
    const auto scalars = [](const EnsembleOptics& o) {
        return scalars_of(o.q_ext, o.one_minus_albedo, o.asymmetry);
    };
    const auto moments = [](const EnsembleOptics& o) {
        return Eigen::ArrayXd(
            Eigen::Map<const Eigen::ArrayXd>(o.chi.data(), Eigen::Index(o.chi.size())));
    };
    const Eigen::ArrayXd of_moments = difference(moments(a), moments(b));
    return std::max(((scalars(a) - scalars(b)).abs() * weights_of(b)).maxCoeff(),
                    of_moments.size() > 0 ? of_moments.abs().maxCoeff() : 0.0);
}

EnsembleOptics efficiencies_of(const SphereSums& sums, double share) {
    EnsembleOptics optics;
    optics.q_sca = 2 * sums.scattered / share;
    optics.q_abs = 2 * sums.absorbed / share;
    optics.q_ext = optics.q_sca + optics.q_abs;
    optics.one_minus_albedo = optics.q_abs / optics.q_ext;
    optics.single_scattering_albedo = optics.q_sca / optics.q_ext;
    optics.asymmetry = 2 * sums.asymmetric / sums.scattered;
    return optics;
}

}  // namespace miebrdf::mie
