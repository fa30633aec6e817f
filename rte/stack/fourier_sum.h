// The sum over Fourier orders in azimuth: where it ends, and which orders it takes over from a
// solution with fewer nodes.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <span>
#include <vector>

#include <miebrdf/transfer.h>
#include "rte/grid/directions.h"

namespace miebrdf::rte {

struct ScaledStack;
class StackGrids;
struct StackMemory;

/// The size of a Fourier order: the largest over incidences of max |R^m| / max |R^0|, each maximum
/// over outgoing directions and components. The ratio is taken at each incidence because errors are
/// relative to values of the same incidence.
class FourierSizes {
  public:
    /// @param components  rows and columns of each pair of cosines
    explicit FourierSizes(int components = 1) : components_(components) {}

    /// The size of the next order; the first one is kept as R^0.
    /// @param reflection  R^m, out x in
    double next(const Eigen::Ref<const Eigen::MatrixXd>& reflection);
    /// The size of an order after order 0.
    double of(const Eigen::Ref<const Eigen::MatrixXd>& reflection) const;
    /// The size of an order with 4 (mu + mu') R^m = 1 straight back in the top medium, as a smooth
    /// boundary lets it in and out.
    double of_retro_reflection(const ScaledStack& stack,
                               const Eigen::Ref<const Eigen::VectorXd>& mu_in) const;
    /// The largest over incidences of max |R^0| / max |R|, at least 1: turns errors relative to R^0
    /// into errors relative to R. Where all directions of a request lie beside a forward peak, R is
    /// far below R^0 (13 times for Henyey-Greenstein .95 at mu = mu' = .02, azimuth 90 degrees).
    /// @param reflection  R, the sum of the orders so far, incidence by incidence
    double order_zero_over(const std::vector<double>& reflection) const;

  private:
    Eigen::VectorXd by_incidence(const Eigen::Ref<const Eigen::MatrixXd>& reflection) const;
    double relative(const Eigen::VectorXd& largest) const;

    int components_;
    Eigen::VectorXd of_order_zero_;
};

/// Estimates the sum of the Fourier orders after the last one, relative to order 0.
///
/// Sizes v_m of the orders of a smooth phase function fall like r^m, and the rest of the sum is
/// 2 v r / (1 - r), the 2 as in 2 R^m cos(m azimuth). r is the larger of the last two ratios;
/// v = max(v_m, r v_(m-1)), because one order may be small by parity. Where r exceeds .7, the
/// orders are no geometric series: then r = .7 and v = max(v_m, v_(m-1)).
///
/// Light reflected repeatedly between surfaces makes lobes outside the plane of incidence, of which
/// up to four orders in a row may be small. For such a series (`may_dip`) v is the largest of the
/// last four orders, and r^4 its ratio to the largest of the four before, r at least .7.
class FourierTail {
  public:
    explicit FourierTail(double tolerance, bool may_dip = false)
        : tolerance_(tolerance), may_dip_(may_dip) {}

    /// Takes the size of the next order. True once `remaining` is within the tolerance.
    bool ends_with(double largest);

    /// The sum of the orders after the last one, relative to order 0.
    double remaining() const { return remaining_; }

  private:
    static constexpr int kDip = 4;
    double remaining_of_dipping(double largest);

    double tolerance_;
    bool may_dip_;
    std::array<double, 2 * kDip> recent_{};  ///< sizes of the last orders of a series that may dip
    int count_ = 0;
    double order_zero_ = 0.0;
    double before_last_ = 0.0;
    double last_ = 0.0;
    double remaining_ = 0.0;
};

/// Glories and rainbows, spread by the forward peak, have higher Fourier orders than all other
/// light scattered more than once: sizes fall to nothing, the orders change their sign, and sizes
/// rise again (spheres of 10 um, k = .006: 3e-5 of order 0 at m = 28, 7.5e-3 at m = 58). Where
/// light scattered once straight back still has higher orders above the tolerance, up to four of
/// them are solved to find whether the sum has ended.
class FeatureOrders {
  public:
    FeatureOrders(const ScaledStack& stack, const RequestedDirections& requested);

    /// The order that a sum must reach which would otherwise end with m. It is m itself if all
    /// higher orders of light scattered once straight back together, or each of the higher orders
    /// solved, are below the tolerance.
    /// @param scale    FourierSizes::of_retro_reflection
    /// @param size_of  solves an order below `highest` and returns its FourierSizes::of
    int last(int m, int highest, double scale, double tolerance,
             const std::function<double(int order)>& size_of);

    /// The sum of the orders that the last call of last() left out, by those that it solved.
    double left() const { return left_; }

  private:
    void sum_orders();
    std::vector<int> higher_orders(int m, double scale, double tolerance) const;

    const ScaledStack& stack_;
    Eigen::VectorXd mu_;         ///< of incidences, in the topmost medium
    std::vector<double> above_;  ///< [m]: the sum of the orders above m, straight back
    double left_ = 0.0;
};

/// R^m of light scattered more than once for m = 0, 1, ..., out x in (each times the components
/// shown); empty for an order that was not solved.
using FourierOrders = std::vector<Eigen::MatrixXd>;

/// A finer solution takes over the Fourier orders of the coarser one after the first order that
/// agrees: 10 x its difference, relative to order 0, is within the tolerance (after order 0 the
/// same of the order before it). With smooth phase functions nodes change all orders alike: of 442
/// random coated scenes with 10 to 48 nodes, compared at 25 pairs, the difference of the worst
/// order was .2 x that of order 0 in the median, 3.3 x in one of a hundred, 7.6 x at most. Where
/// delta-M cuts off a peak (not is_smooth) nothing may be taken over.
class CoarserFourierOrders {
  public:
    /// @param orders  of the coarser solution; empty: nothing is taken over
    CoarserFourierOrders(const FourierOrders& orders, double tolerance)
        : orders_(orders), tolerance_(tolerance) {}

    /// Compares an order of the finer solution with that of the coarser one.
    void compare(int fourier_order, const Eigen::MatrixXd& finer,
                 const RequestedDirections& requested);

    /// The coarser R^m, or null if the order must be solved.
    const Eigen::MatrixXd* settled(int fourier_order) const;

    /// The error of the orders taken over, relative to order 0.
    double difference() const { return difference_; }

  private:
    const FourierOrders& orders_;
    double tolerance_;
    double order_zero_ = 0.0;
    double difference_ = 0.0;
    bool is_settled_ = false;
};

/// Orders of more pairs of cosines are not kept for finer solutions: 30 orders would take 10 MB.
inline constexpr std::size_t kMostKeptPairs = 40000;

/// Whether delta-M cuts off next to nothing, so that nodes change all Fourier orders alike.
bool is_smooth(const ScaledStack& stack);

/// The factor of element (row, column) of R^m (StackOrder::multiple) in the sum over m: for m > 0
/// 2 sign cos(m azimuth), or 2 sign sin(m azimuth) where `is_sine`; for m = 0 half of it.
struct StokesHarmonic {
    bool is_sine = false;
    double sign = 1.0;
};
StokesHarmonic stokes_harmonic(int row, int column);

/// Reflection by light scattered more than once.
struct MultipleScattering {
    /// [((i * outs + o) * c^2 + row * c + column) * azimuths + a], c = SolvedLight::shown()
    std::vector<double> reflection;
    /// At the incident cosines, of all orders of scattering (from Fourier order 0).
    std::vector<double> plane_albedo, polarised_plane_albedo;
    int fourier_orders = 0;  ///< 1 + the highest one summed
    int iterations = 0;
    double residual = 0.0;
    /// The larger of two errors: of the orders not summed, relative to the largest value at the
    /// incidence, and of the orders taken over, in (mu + mu') R relative to order 0.
    double tail = 0.0;
    bool converged = true;
    bool physical = true;
    FourierOrders by_fourier_order;  ///< as KeptOrders says
};

/// The orders that the sum keeps in by_fourier_order.
enum class KeptOrders {
    for_finer,  ///< those that a finer solution may take over
    for_table,  ///< all orders
};

/// The number of Fourier orders that are not 0 in the requested directions: `orders`, or 1 if all
/// incident or all outgoing light is at mu = 1, where Y_l^m = 0 for m > 0 (3 for Stokes vectors,
/// because d^l_m2 is not 0 for m = 2).
int count_of_fourier_orders(const RequestedDirections& requested, int orders,
                            const SolvedLight& light);

/// R^0 + 2 sum_m R^m cos(m azimuth) of light scattered more than once; for Stokes vectors with the
/// harmonic of each element.
///
/// Ends where the rest of the sum is below `tail_tolerance`, relative to the largest value at the
/// same incidence (or to order 0, if that is less), or after count_of_fourier_orders(). Orders with
/// cos(m azimuth) = 0 at every azimuth are not solved for unpolarised light.
/// @param coarser  by_fourier_order of a solution with fewer nodes, or empty
/// @param exactly  the number of orders; 0: as many as are needed
MultipleScattering sum_fourier_orders(const ScaledStack& stack, const StackGrids& grids,
                                      const RequestedDirections& requested,
                                      std::span<const double> azimuth_deg, const SolvedLight& light,
                                      double tail_tolerance, const SolverOptions& options,
                                      StackMemory& memory, const FourierOrders& coarser = {},
                                      KeptOrders kept = KeptOrders::for_finer, int exactly = 0);

}  // namespace miebrdf::rte
