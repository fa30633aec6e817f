#include "rte/stack/fourier_sum.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>

#include "rte/first_order/narrow_features.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/stack_solver.h"

namespace miebrdf::rte {
namespace {

// Slower series are not trusted to be geometric.
constexpr double kSlowestRatio = 0.7;
// The rest of a series that is not geometric, in terms of the larger of its last two.
constexpr double kSeveral = 2.5;
// Orders in a row that must agree with those of a coarser solution before the rest is taken over.
constexpr int kEnoughAlike = 2;

double ratio(double value, double to) { return to > 0.0 ? value / to : 1.0; }

}  // namespace

double FourierSizes::next(const Eigen::Ref<const Eigen::MatrixXd>& reflection) {
    const Eigen::VectorXd largest = reflection.cwiseAbs().colwise().maxCoeff().transpose();
    if (of_order_zero_.size() == 0) of_order_zero_ = largest;
    return relative(largest);
}

double FourierSizes::of(const Eigen::Ref<const Eigen::MatrixXd>& reflection) const {
    return relative(reflection.cwiseAbs().colwise().maxCoeff().transpose());
}

double FourierSizes::of_retro_reflection(const Eigen::Ref<const Eigen::VectorXd>& mu_in) const {
    return relative(0.125 * mu_in.cwiseInverse());
}

double FourierSizes::over_listed(const std::vector<double>& reflection) const {
    const std::size_t block = reflection.size() / std::size_t(of_order_zero_.size());
    double ratio = 1.0;
    for (Eigen::Index i = 0; i < of_order_zero_.size(); ++i) {
        double largest = 0.0;
        for (std::size_t k = 0; k < block; ++k)
            largest = std::max(largest, std::abs(reflection[std::size_t(i) * block + k]));
        if (largest > 0.0) ratio = std::max(ratio, of_order_zero_[i] / largest);
    }
    return ratio;
}

int FeatureOrders::last(int m, int highest, double scale, double tolerance,
                        const std::function<double(int)>& size_of) const {
    const std::vector<int> orders = probes(m, scale, tolerance);
    int last = m;
    for (const int order : orders) {
        if (order >= highest) break;
        if (!(2.0 * size_of(order) * (orders.back() - m) <= tolerance)) last = order;
    }
    return last;
}

double FourierSizes::relative(const Eigen::VectorXd& largest) const {
    double size = 0.0;
    for (Eigen::Index i = 0; i < largest.size(); ++i) {
        if (largest[i] > 0.0) size = std::max(size, largest[i] / of_order_zero_[i]);
    }
    return size;
}

FeatureOrders::FeatureOrders(const ScaledStack& stack, const RequestedDirections& requested)
    : strengths_(NarrowStrengths(stack.media).of_kept(2.0 / requested.mu.maxCoeff())) {}

// Of P_l near retro-reflection, the orders above m are the share 2/pi acos(m / l).
double FeatureOrders::beyond(int m) const {
    double sum = 0.0;
    for (Eigen::Index l = m + 1; l < strengths_.size(); ++l)
        sum += strengths_[l] * (2.0 / std::numbers::pi) * std::acos(double(m) / double(l));
    return sum;
}

std::vector<int> FeatureOrders::probes(int m, double scale, double tolerance) const {
    std::vector<int> orders;
    if (!(scale * beyond(m) > tolerance)) return orders;
    int last = m + 1;  // where what lies beyond has fallen to a tenth of the tolerance
    for (int step = int(strengths_.size()); step > 0; step /= 2) {
        if (last + step < int(strengths_.size()) && scale * beyond(last + step) > 0.1 * tolerance)
            last += step;
    }
    for (const double share : {0.2, 0.4, 0.6, 0.8}) {
        const int order = m + int(std::lround(share * (last - m)));
        if (order > m && (orders.empty() || order > orders.back())) orders.push_back(order);
    }
    return orders;
}

bool FourierTail::ends_with(double largest) {
    if (count_ == 0) order_zero_ = largest;
    const double fall = std::max(ratio(largest, last_), ratio(last_, before_last_));
    const bool is_geometric = count_ >= 3 && fall <= kSlowestRatio;
    remaining_ = kSeveral * ratio(std::max(largest, count_ > 0 ? last_ : largest), order_zero_);
    if (is_geometric) {
        const double envelope = std::max(largest, fall * last_);
        remaining_ = 2.0 * ratio(envelope, order_zero_) * fall / (1.0 - fall);
    }
    if (order_zero_ == 0.0) remaining_ = 0.0;
    const bool ends = count_ > 0 && remaining_ <= tolerance_;
    before_last_ = last_;
    last_ = largest;
    ++count_;
    return ends;
}

namespace {

// Largest (mu + mu') |R| over the requested pairs: bounded also at grazing angles.
double largest_bounded(const Eigen::Ref<const Eigen::MatrixXd>& reflection,
                       const RequestedDirections& requested) {
    double largest = 0.0;
    for (Eigen::Index i = 0; i < reflection.cols(); ++i) {
        for (Eigen::Index o = 0; o < reflection.rows(); ++o) {
            const double sum = requested.mu[requested.out[o]] + requested.mu[requested.in[i]];
            largest = std::max(largest, sum * std::abs(reflection(o, i)));
        }
    }
    return largest;
}

}  // namespace

void CoarserFourierOrders::compare(int fourier_order, const Eigen::MatrixXd& finer,
                                   const RequestedDirections& requested) {
    if (fourier_order == 0) order_zero_ = largest_bounded(finer, requested);
    const auto at = std::size_t(fourier_order);
    if (at >= orders_.size() || orders_[at].size() != finer.size()) return;
    const double difference = largest_bounded(finer - orders_[at], requested);
    const bool is_alike = difference <= tolerance_ * order_zero_;
    alike_ = is_alike ? alike_ + 1 : 0;
    // Other orders are apart up to this times as far as order 0.
    constexpr double other_orders = 10.0;
    const bool is_first =
        fourier_order == 0 && other_orders * difference <= tolerance_ * order_zero_;
    if (is_first && order_zero_ > 0.0) {
        alike_ = kEnoughAlike;
        difference_ = other_orders * difference / order_zero_;
        return;
    }
    if (!is_alike || order_zero_ == 0.0) {
        difference_ = 0.0;
    } else {
        difference_ = std::max(difference_, difference / order_zero_);
    }
}

const Eigen::MatrixXd* CoarserFourierOrders::settled(int fourier_order) const {
    const auto at = std::size_t(fourier_order);
    if (alike_ < kEnoughAlike || at >= orders_.size() || orders_[at].size() == 0) return nullptr;
    return &orders_[at];
}

bool is_smooth(const ScaledStack& stack) {
    constexpr double no_peak = 1e-4;
    return std::all_of(stack.media.begin(), stack.media.end(), [](const ScaledMedium& medium) {
        return medium.scaled.truncated <= no_peak;
    });
}

Eigen::VectorXd asked_incidences(const RequestedDirections& requested) {
    Eigen::VectorXd mu_in(Eigen::Index(requested.asked_in()));
    for (std::size_t i = 0; i < requested.asked_in(); ++i)
        mu_in[Eigen::Index(i)] = requested.mu[requested.in[i]];
    return mu_in;
}

namespace {

// The sum of (2 - delta_m0) R^m cos(m azimuth), several orders at a time: a product of matrices.
class AzimuthSum {
  public:
    /// @param pairs  of cosines
    /// @param sum    [pair * azimuths + azimuth], zero
    AzimuthSum(std::span<const double> azimuth_deg, std::size_t pairs, std::vector<double>& sum)
        : azimuth_deg_(azimuth_deg),
          cosines_(Eigen::Index(azimuth_deg.size()), at_once(pairs)),
          turn_(Eigen::Index(azimuth_deg.size())),
          direction_(Eigen::Index(azimuth_deg.size())),
          orders_(Eigen::Index(pairs), at_once(pairs)),
          sum_(sum) {
        for (Eigen::Index a = 0; a < turn_.size(); ++a) turn_[a] = unit(1, a);
    }

    void add(int m, const Eigen::Block<const Eigen::MatrixXd>& multiple) {
        // Exact ones now and then, and turned by one azimuth in between.
        for (; next_ <= m; ++next_) {
            if (next_ % kMostAtOnce == 0) {
                for (Eigen::Index a = 0; a < direction_.size(); ++a) direction_[a] = unit(next_, a);
            } else {
                direction_ *= turn_;
            }
        }
        cosines_.col(count_) = (m == 0 ? 1.0 : 2.0) * direction_.real();
        Eigen::Map<Eigen::MatrixXd>(orders_.col(count_).data(), multiple.rows(), multiple.cols()) =
            multiple;
        if (++count_ == orders_.cols()) finish();
    }

    /// Until then orders may be missing from the sum.
    void finish() {
        Eigen::Map<Eigen::MatrixXd> sum(sum_.data(), cosines_.rows(), orders_.rows());
        const auto cosines = cosines_.leftCols(count_);
        const auto orders = orders_.leftCols(count_).transpose();
        if (sum.rows() + sum.cols() <= kLargestCoefficientWise) {
            // Coefficient by coefficient Eigen rounds as the address of the result has it: always
            // alike in memory of its own.
            sum += (cosines * orders).eval();
        } else {
            sum.noalias() += cosines * orders;
        }
        count_ = 0;
    }

  private:
    static constexpr int kMostAtOnce = 16;
    static constexpr Eigen::Index kLargestCoefficientWise = 32;  ///< more than Eigen's limit of 20

    /// Large tables wait in 2 MB.
    static Eigen::Index at_once(std::size_t pairs) {
        constexpr std::size_t most = 1 << 18;
        return std::clamp<Eigen::Index>(Eigen::Index(most / std::max<std::size_t>(pairs, 1)), 1,
                                        kMostAtOnce);
    }

    std::complex<double> unit(int m, Eigen::Index azimuth) const {
        return std::polar(1.0, m * azimuth_deg_[std::size_t(azimuth)] * (std::numbers::pi / 180.0));
    }

    std::span<const double> azimuth_deg_;
    Eigen::MatrixXd cosines_;           ///< azimuths x orders that wait
    Eigen::ArrayXcd turn_, direction_;  ///< exp(i azimuth), and of the last order
    Eigen::MatrixXd orders_;            ///< pairs x orders that wait
    int next_ = 0, count_ = 0;
    std::vector<double>& sum_;
};

// How the equations of one order were solved, and the plane albedos from order 0.
void note(const Reflector& reflector, int fourier_order, const RequestedDirections& requested,
          MultipleScattering& sum) {
    sum.iterations = std::max(sum.iterations, reflector.iterations);
    sum.residual = std::max(sum.residual, reflector.residual);
    sum.converged = sum.converged && reflector.converged;
    if (fourier_order > 0) return;
    // 2 sum_q w_q mu_q R(mu, mu_q) = sum_q (2 R D)_q D_q.
    for (std::size_t i = 0; i < requested.asked_in(); ++i) {
        const int in = requested.in[i];
        const double mirrored = reflector.specular.size() > 0 ? reflector.specular[in] : 0.0;
        sum.plane_albedo.push_back(mirrored + reflector.sky_at_requested[in]);
    }
}

// What was asked for, without probes.
auto asked_part(const Eigen::MatrixXd& multiple, const RequestedDirections& requested) {
    return multiple.topLeftCorner(Eigen::Index(requested.asked_out()),
                                  Eigen::Index(requested.asked_in()));
}

}  // namespace

MultipleScattering sum_fourier_orders(const ScaledStack& stack, const StackGrids& grids,
                                      const RequestedDirections& requested,
                                      std::span<const double> azimuth_deg, double tail_tolerance,
                                      const SolverOptions& options, StackMemory* memory,
                                      const FourierOrders& coarser_orders) {
    std::optional<StackMemory> own;
    const std::size_t azimuths = azimuth_deg.size();
    MultipleScattering sum;
    sum.reflection.assign(requested.asked_in() * requested.asked_out() * azimuths, 0.0);
    const int highest = only_fourier_order_zero(requested) ? 1 : stack.moments;
    const bool keep =
        is_smooth(stack) && requested.in.size() * requested.out.size() <= kMostKeptPairs;

    StackSolver solver(stack, grids, requested, options,
                       memory != nullptr ? *memory : own.emplace());
    FourierTail tail(tail_tolerance);
    FourierSizes sizes;
    CoarserFourierOrders coarser(coarser_orders, kCoarserOrdersShare * options.tolerance);
    const FeatureOrders features(stack, requested);
    const Eigen::VectorXd mu_in = asked_incidences(requested);
    AzimuthSum by_azimuth(azimuth_deg, requested.asked_in() * requested.asked_out(),
                          sum.reflection);
    double dimmer = 1.0;  // listed values than order 0
    int m = 0, least = 0;
    for (bool ended = false; m < highest && !ended; ++m) {
        if (m > 0 && fourier_order_vanishes(m, azimuth_deg)) continue;
        const Eigen::MatrixXd* multiple = coarser.settled(m);
        if (multiple == nullptr) {
            const Reflector& reflector =
                m == 0 ? solver.solve(m, ReflectorParts::sky, flux_weights(grids.top()))
                       : solver.solve(m, ReflectorParts::pairs);
            if (!reflector.physical) {
                sum.physical = false;
                return sum;
            }
            note(reflector, m, requested, sum);
            multiple = &reflector.multiple;
            coarser.compare(m, *multiple, requested);
        }
        sum.fourier_orders = m + 1;
        const auto asked = asked_part(*multiple, requested);
        by_azimuth.add(m, asked);
        ended = tail.ends_with(sizes.next(asked)) && m >= least;
        if (ended) {
            by_azimuth.finish();
            dimmer = sizes.over_listed(sum.reflection);
        }
        ended = ended && dimmer * tail.remaining() <= tail_tolerance;
        if (keep) {
            sum.by_fourier_order.resize(std::size_t(m) + 1);
            sum.by_fourier_order.back() = *multiple;
        }
        if (!ended) continue;
        least = features.last(
            m, highest, sizes.of_retro_reflection(mu_in), tail_tolerance / dimmer, [&](int order) {
                const Reflector& reflector = solver.solve(order, ReflectorParts::pairs);
                return sizes.of(asked_part(reflector.multiple, requested));
            });
        ended = least <= m;
    }
    by_azimuth.finish();
    sum.tail = m == highest ? 0.0 : dimmer * tail.remaining();  // 0: every order there is
    if (coarser.settled(m - 1) != nullptr) sum.tail = std::max(sum.tail, coarser.difference());
    return sum;
}

}  // namespace miebrdf::rte
