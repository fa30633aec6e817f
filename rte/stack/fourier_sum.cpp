#include "rte/stack/fourier_sum.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "rte/first_order/first_order.h"
#include "rte/math/legendre.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/stack_solver.h"

namespace miebrdf::rte {
namespace {

// The largest ratio of orders that are trusted to be a geometric series. (`miebrdf stress`,
// promises, counts converged results that err by more than their tolerance.)
constexpr double kSlowestRatio = 0.7;

double ratio(double value, double to) { return to > 0.0 ? value / to : 1.0; }

// (Rest of a geometric series) / (its last order) = 2 r / (1 - r); no more than if all orders of a
// boundary were as large.
double rest_of_series(double fall) {
    const double most = kMostBoundaryOrders;
    return 2.0 * (fall < 1.0 ? std::min(fall / (1.0 - fall), most) : most);
}

// The largest (mu + mu') |R| over the requested pairs: it stays bounded at grazing angles.
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

double FourierSizes::next(const Eigen::Ref<const Eigen::MatrixXd>& reflection) {
    const Eigen::VectorXd largest = by_incidence(reflection);
    if (of_order_zero_.size() == 0) of_order_zero_ = largest;
    return relative(largest);
}

Eigen::VectorXd FourierSizes::by_incidence(
    const Eigen::Ref<const Eigen::MatrixXd>& reflection) const {
    const Eigen::VectorXd by_column = reflection.cwiseAbs().colwise().maxCoeff().transpose();
    Eigen::VectorXd largest(by_column.size() / components_);
    for (Eigen::Index i = 0; i < largest.size(); ++i)
        largest[i] = by_column.segment(i * components_, components_).maxCoeff();
    return largest;
}

double FourierSizes::relative(const Eigen::VectorXd& largest) const {
    double size = 0.0;
    for (Eigen::Index i = 0; i < largest.size(); ++i) {
        if (largest[i] > 0.0) size = std::max(size, largest[i] / of_order_zero_[i]);
    }
    return size;
}

double FourierSizes::of(const Eigen::Ref<const Eigen::MatrixXd>& reflection) const {
    return relative(by_incidence(reflection));
}

double FourierSizes::of_retro_reflection(const ScaledStack& stack,
                                         const Eigen::Ref<const Eigen::VectorXd>& mu_in) const {
    const bool is_rough = stack.boundary && stack.boundary->is_rough();
    const double n = is_rough || stack.has_mirrors() ? 1.0 : stack.top_index;
    return relative(mu_in.unaryExpr([n](double mu) {
        return 0.125 * straight_paths_factor(n, mu, mu) / refracted_cosine(n, mu);
    }));
}

double FourierSizes::order_zero_over(const std::vector<double>& reflection) const {
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

double FourierTail::remaining_of_dipping(double largest) {
    recent_[std::size_t(count_ % (2 * kDip))] = largest;
    double now = 0.0, before = 0.0;
    for (int back = 0; back < 2 * kDip && back <= count_; ++back) {
        double& group = back < kDip ? now : before;
        group = std::max(group, recent_[std::size_t((count_ - back) % (2 * kDip))]);
    }
    const double size = ratio(now, order_zero_);
    const double fall = count_ + 1 < 2 * kDip ? 0.0 : std::pow(ratio(now, before), 1.0 / kDip);
    return size * rest_of_series(std::max(kSlowestRatio, fall));
}

bool FourierTail::ends_with(double largest) {
    if (count_ == 0) order_zero_ = largest;
    const double fall = std::max(ratio(largest, last_), ratio(last_, before_last_));
    const bool is_geometric = count_ >= 3 && fall <= kSlowestRatio;
    const double envelope = std::max(largest, is_geometric ? fall * last_ : last_);
    remaining_ = ratio(envelope, order_zero_) * rest_of_series(is_geometric ? fall : kSlowestRatio);
    if (may_dip_) remaining_ = remaining_of_dipping(largest);
    if (order_zero_ == 0.0) remaining_ = 0.0;
    const bool ends = count_ > 0 && remaining_ <= tolerance_;
    before_last_ = last_;
    last_ = largest;
    ++count_;
    return ends;
}

FeatureOrders::FeatureOrders(const ScaledStack& stack, const RequestedDirections& requested)
    : stack_(stack), mu_(requested.mu(requested.in).unaryExpr([&](double mu) {
          return refracted_cosine(stack.top_index, mu);
      })) {}

// 4 (mu + mu) times the Fourier orders of light scattered once by half-spaces of each medium.
void FeatureOrders::sum_orders() {
    Eigen::MatrixXd functions;
    for (const ScaledMedium& medium : stack_.media) {
        Eigen::VectorXd strengths = medium.scaled.strengths();
        for (Eigen::Index l = 1; l < strengths.size(); l += 2) strengths[l] = -strengths[l];
        const Eigen::Index degrees = strengths.size();
        above_.resize(std::max(above_.size(), std::size_t(degrees)), 0.0);
        double sum = 0.0;
        for (Eigen::Index m = degrees - 1; m > 0; --m) {
            math::legendre_functions(int(m), int(degrees), mu_, functions);
            sum +=
                2.0 * (functions.cwiseAbs2() * strengths.tail(degrees - m)).cwiseAbs().maxCoeff();
            above_[std::size_t(m - 1)] = std::max(above_[std::size_t(m - 1)], sum);
        }
    }
}

std::vector<int> FeatureOrders::higher_orders(int m, double scale, double tolerance) const {
    std::vector<int> orders;
    int last = m;  // all orders above it together are below the tolerance
    while (std::size_t(last) < above_.size() && scale * above_[std::size_t(last)] > tolerance)
        ++last;
    if (last == m) return orders;
    for (const double share : {0.2, 0.4, 0.6, 0.8}) {
        const int order = m + int(std::lround(share * (last - m)));
        if (order > m && (orders.empty() || order > orders.back())) orders.push_back(order);
    }
    return orders;
}

int FeatureOrders::last(int m, int highest, double scale, double tolerance,
                        const std::function<double(int)>& size_of) {
    if (above_.empty()) sum_orders();
    const std::vector<int> orders = higher_orders(m, scale, tolerance);
    int last = m;
    left_ = 0.0;
    for (const int order : orders) {
        if (order >= highest) break;
        const double all = 2.0 * size_of(order) * (orders.back() - m);
        if (all <= tolerance)
            left_ = std::max(left_, all);
        else
            last = order;
    }
    return last;
}

void CoarserFourierOrders::compare(int fourier_order, const Eigen::MatrixXd& finer,
                                   const RequestedDirections& requested) {
    if (fourier_order == 0) order_zero_ = largest_bounded(finer, requested);
    const auto at = std::size_t(fourier_order);
    if (at >= orders_.size() || orders_[at].size() != finer.size()) return;
    // (Difference of any later order) / (difference of this order) is at most this.
    constexpr double other_orders = 10.0;
    if (order_zero_ == 0.0) return;
    const double now = other_orders * largest_bounded(finer - orders_[at], requested) / order_zero_;
    // The order before counts, too: all odd or all even orders may be 0, as at the zenith.
    const double of_both = std::max(now, difference_);
    is_settled_ = of_both <= tolerance_;
    difference_ = is_settled_ ? of_both : now;
}

const Eigen::MatrixXd* CoarserFourierOrders::settled(int fourier_order) const {
    const auto at = std::size_t(fourier_order);
    if (!is_settled_ || at >= orders_.size() || orders_[at].size() == 0) return nullptr;
    return &orders_[at];
}

bool is_smooth(const ScaledStack& stack) {
    constexpr double no_peak = 1e-4;
    return std::all_of(stack.media.begin(), stack.media.end(), [](const ScaledMedium& medium) {
        return medium.scaled.truncated <= no_peak;
    });
}

namespace {

// Sums (2 - delta_m0) R^m cos(m azimuth), or sin(m azimuth) for some elements of Stokes vectors,
// for up to 16 orders at a time as a product of matrices.
class AzimuthSum {
  public:
    /// @param pairs       of cosines
    /// @param components  rows and columns of each pair
    /// @param sum         [(pair * components^2 + element) * azimuths + azimuth], zero
    AzimuthSum(std::span<const double> azimuth_deg, std::size_t pairs, int components,
               std::vector<double>& sum)
        : azimuth_deg_(azimuth_deg),
          components_(components),
          at_once_(at_once(pairs * std::size_t(components * components))),
          cosines_(Eigen::Index(azimuth_deg.size()), at_once_),
          sines_(components > 1 ? Eigen::Index(azimuth_deg.size()) : 0, at_once_),
          turn_(Eigen::Index(azimuth_deg.size())),
          direction_(Eigen::Index(azimuth_deg.size())),
          orders_(std::size_t(components * components)),
          sum_(sum) {
        for (Eigen::MatrixXd& element : orders_) element.resize(Eigen::Index(pairs), at_once_);
        for (Eigen::Index a = 0; a < turn_.size(); ++a) turn_[a] = unit(1, a);
    }

    void add(int m, const Eigen::MatrixXd& multiple) {
        // exp(i m azimuth): exact for every 16th order, multiplied by exp(i azimuth) in between.
        for (; next_ <= m; ++next_) {
            if (next_ % kMostAtOnce == 0) {
                for (Eigen::Index a = 0; a < direction_.size(); ++a) direction_[a] = unit(next_, a);
            } else {
                direction_ *= turn_;
            }
        }
        const double factor = m == 0 ? 1.0 : 2.0;
        cosines_.col(count_) = factor * direction_.real();
        if (components_ > 1) sines_.col(count_) = factor * direction_.imag();
        const Eigen::Index c = components_, outs = multiple.rows() / c, ins = multiple.cols() / c;
        for (Eigen::Index e = 0; e < c * c; ++e) {
            Eigen::Map<Eigen::MatrixXd>(orders_[std::size_t(e)].col(count_).data(), outs, ins) =
                multiple(Eigen::seqN(e / c, outs, c), Eigen::seqN(e % c, ins, c));
        }
        if (++count_ == at_once_) finish();
    }

    /// Adds the orders collected so far.
    void finish() {
        const Eigen::Index azimuths = cosines_.rows(), elements = Eigen::Index(orders_.size());
        for (Eigen::Index e = 0; e < elements && azimuths > 0; ++e) {
            const StokesHarmonic harmonic =
                stokes_harmonic(int(e) / components_, int(e) % components_);
            const Eigen::MatrixXd& element = orders_[std::size_t(e)];
            Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>> sum(
                sum_.data() + e * azimuths, azimuths, element.rows(),
                Eigen::OuterStride<>(elements * azimuths));
            const auto waves = (harmonic.is_sine ? sines_ : cosines_).leftCols(count_);
            const auto orders = element.leftCols(count_).transpose();
            // In aligned memory, because Eigen's rounding of small products depends on alignment.
            product_.noalias() = waves * orders;
            sum += harmonic.sign * product_;
        }
        count_ = 0;
    }

  private:
    static constexpr int kMostAtOnce = 16;

    /// As many orders as fit into 2 MB.
    static Eigen::Index at_once(std::size_t values) {
        constexpr std::size_t most = 1 << 18;
        return std::clamp<Eigen::Index>(Eigen::Index(most / std::max<std::size_t>(values, 1)), 1,
                                        kMostAtOnce);
    }

    std::complex<double> unit(int m, Eigen::Index azimuth) const {
        return std::polar(1.0, m * azimuth_deg_[std::size_t(azimuth)] * (std::numbers::pi / 180.0));
    }

    std::span<const double> azimuth_deg_;
    int components_;
    Eigen::Index at_once_;
    Eigen::MatrixXd cosines_, sines_;      ///< azimuths x orders collected
    Eigen::ArrayXcd turn_, direction_;     ///< exp(i azimuth), exp(i m azimuth) of the last order
    std::vector<Eigen::MatrixXd> orders_;  ///< by element; pairs x orders collected
    Eigen::MatrixXd product_;
    int next_ = 0, count_ = 0;
    std::vector<double>& sum_;
};

// Keeps convergence and, from order 0, albedos.
void note(const StackOrder& order, int fourier_order, MultipleScattering& sum) {
    sum.iterations = std::max(sum.iterations, order.iterations);
    sum.residual = std::max(sum.residual, order.residual);
    sum.converged = sum.converged && order.converged;
    if (fourier_order > 0) return;
    sum.plane_albedo = order.plane_albedo;
    sum.polarised_plane_albedo = order.polarised_plane_albedo;
}

/// R^m of the components shown.
const Eigen::MatrixXd& shown_part(const StackOrder& order, const SolvedLight& light,
                                  Eigen::MatrixXd& intensity) {
    if (light.shown() == light.components) return order.multiple;
    const Eigen::Index c = light.components, outs = order.multiple.rows() / c;
    intensity =
        order.multiple(Eigen::seqN(0, outs, c), Eigen::seqN(0, order.multiple.cols() / c, c));
    return intensity;
}

}  // namespace

int count_of_fourier_orders(const RequestedDirections& requested, int moments,
                            const SolvedLight& light) {
    if (!only_fourier_order_zero(requested)) return moments;
    return light.components == 1 ? 1 : std::min(3, moments);
}

StokesHarmonic stokes_harmonic(int row, int column) {
    const bool is_diagonal = (row < 2) == (column < 2);
    return {!is_diagonal, is_diagonal || row > column ? 1.0 : -1.0};
}

MultipleScattering sum_fourier_orders(const ScaledStack& stack, const StackGrids& grids,
                                      const RequestedDirections& requested,
                                      std::span<const double> azimuth_deg, const SolvedLight& light,
                                      double tail_tolerance, const SolverOptions& options,
                                      StackMemory& memory, const FourierOrders& coarser_orders,
                                      KeptOrders kept, int exactly) {
    const int c = light.shown();
    const RequestedDirections rows = repeated(requested, c);
    MultipleScattering sum;
    sum.reflection.assign(rows.in.size() * rows.out.size() * azimuth_deg.size(), 0.0);
    const bool keep = kept == KeptOrders::for_table ||
                      (is_smooth(stack) && rows.in.size() * rows.out.size() <= kMostKeptPairs);

    StackSolver solver(stack, grids, requested, light.components, options, memory);
    const int all_orders = count_of_fourier_orders(requested, solver.fourier_orders(), light);
    const int highest = exactly > 0 ? std::min(exactly, all_orders) : all_orders;
    FourierTail tail(tail_tolerance, solver.has_boundary_orders());
    FourierSizes sizes(c);
    CoarserFourierOrders coarser(coarser_orders, kCoarserOrdersShare * options.tolerance);
    FeatureOrders features(stack, requested);
    const Eigen::VectorXd mu_in = requested.mu(requested.in);
    AzimuthSum by_azimuth(azimuth_deg, requested.in.size() * requested.out.size(), c,
                          sum.reflection);
    Eigen::MatrixXd intensity;
    double order_zero_over_sum = 1.0;  // turns errors relative to R^0 into errors relative to R
    int m = 0, least = 0;
    for (bool ended = false; m < highest && !ended; ++m) {
        if (m > 0 && c == 1 && fourier_order_vanishes(m, azimuth_deg) &&
            kept == KeptOrders::for_finer) {
            continue;
        }
        const Eigen::MatrixXd* multiple = coarser.settled(m);
        if (multiple == nullptr) {
            const StackOrder& order = solver.solve(m);
            if (!order.physical) {
                sum.physical = false;
                return sum;
            }
            note(order, m, sum);
            multiple = &shown_part(order, light, intensity);
            coarser.compare(m, *multiple, rows);
        }
        sum.fourier_orders = m + 1;
        by_azimuth.add(m, *multiple);
        ended = exactly == 0 && tail.ends_with(sizes.next(*multiple)) && m >= least;
        if (ended) {
            by_azimuth.finish();
            order_zero_over_sum = sizes.order_zero_over(sum.reflection);
        }
        ended = ended && order_zero_over_sum * tail.remaining() <= tail_tolerance;
        if (keep) {
            sum.by_fourier_order.resize(std::size_t(m) + 1);
            sum.by_fourier_order.back() = *multiple;
        }
        if (!ended) continue;
        least = features.last(
            m, highest, sizes.of_retro_reflection(stack, mu_in),
            tail_tolerance / order_zero_over_sum,
            [&](int order) { return sizes.of(shown_part(solver.solve(order), light, intensity)); });
        ended = least <= m;
    }
    by_azimuth.finish();
    const bool are_all = m == highest && highest <= stack.moments;
    sum.tail = are_all ? 0.0 : order_zero_over_sum * std::max(tail.remaining(), features.left());
    if (coarser.settled(m - 1) != nullptr) sum.tail = std::max(sum.tail, coarser.difference());
    return sum;
}

}  // namespace miebrdf::rte
