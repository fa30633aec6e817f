// The sum over Fourier orders in azimuth: where it may end, and which orders it takes over from a
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

/// The size of a Fourier order: at each incidence the largest |R^m| (of all directions and
/// components) relative to the largest |R^0|, and of these ratios the largest. Errors are relative
/// to values of the same incidence, too: a bright zenith says nothing of grazing light.
class FourierSizes {
  public:
    /// @param components  rows and columns of each pair of cosines
    explicit FourierSizes(int components = 1) : components_(components) {}

    /// The size of the next order; order 0 comes first.
    /// @param reflection  R^m, out x in
    double next(const Eigen::Ref<const Eigen::MatrixXd>& reflection);
    /// The size of any order after order 0.
    double of(const Eigen::Ref<const Eigen::MatrixXd>& reflection) const;
    /// The size of an order with 4 (mu + mu') R^m = 1 straight back in the top medium, which a
    /// smooth boundary lets in and out again.
    double of_retro_reflection(const ScaledStack& stack,
                               const Eigen::Ref<const Eigen::VectorXd>& mu_in) const;
    /// max |R^0| / max |R| at an incidence, the largest over incidences, at least 1. Where all
    /// directions asked for lie across a forward peak, R is far below R^0 (13 times for
    /// Henyey-Greenstein .95 at mu = mu' = .02, 90 degrees), and errors are relative to R.
    /// @param reflection  R, the sum of the orders so far, incidence by incidence
    double over_listed(const std::vector<double>& reflection) const;

  private:
    Eigen::VectorXd by_incidence(const Eigen::Ref<const Eigen::MatrixXd>& reflection) const;
    double relative(const Eigen::VectorXd& largest) const;

    int components_;
    Eigen::VectorXd of_order_zero_;
};

/// Estimates the sum of the Fourier orders after the last one, relative to order 0.
///
/// Orders v_m of a smooth phase function fall like r^m. The rest is the geometric series
/// 2 v r / (1 - r), where the 2 is that of 2 R^m cos(m azimuth), r <= .7 the slower one of the last
/// two falls, and v = max(v_m, r v_(m-1)), because one small order may be an accident of parity.
/// Orders that fall more slowly are not trusted to be a series: r = .7, v = max(v_m, v_(m-1)).
///
/// Light reflected repeatedly between surfaces makes lobes outside the plane of incidence; their
/// Fourier orders may be small for up to four in a row. For such a series (`may_dip`) v is the
/// largest of the last four orders, r its fall from the four before, .7 at least.
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
/// light scattered more than once: the orders fall to nothing, change their sign and rise again
/// (spheres of 10 um, k = .006: 3e-5 of order 0 at m = 28, 7.5e-3 at m = 58). Where moments allow
/// this, up to four higher orders are solved to find whether the sum has ended.
class FeatureOrders {
  public:
    FeatureOrders(const ScaledStack& stack, const RequestedDirections& requested);

    /// The last order of a sum that would otherwise end with m: m itself where these features
    /// together are below the tolerance, or the higher orders that are looked at are.
    /// @param scale    FourierSizes::of_retro_reflection
    /// @param size_of  solves an order and returns its FourierSizes::of; called for up to four
    /// orders
    ///                 below `highest`
    int last(int m, int highest, double scale, double tolerance,
             const std::function<double(int order)>& size_of) const;

  private:
    std::vector<int> higher_orders(int m, double scale, double tolerance) const;
    double beyond(int m) const;
    Eigen::VectorXd strengths_;  ///< by degree
};

/// R^m of light scattered more than once for m = 0, 1, ..., out x in (times the components shown);
/// orders that were not solved are empty.
using FourierOrders = std::vector<Eigen::MatrixXd>;

/// A finer solution solves Fourier orders until one (order 0, or a later one and that before it)
/// differs from the coarser solution's by less than a tenth of the tolerance, relative to order 0;
/// all later orders it takes over. Both
/// solutions converge alike in every order where phase functions are smooth: of 442 random coated
/// scenes with 10 to 48 nodes, compared at 25 pairs, the difference in the worst order was .2 times
/// that in order 0 in the median, 3.3 times in one of a hundred, 7.6 times at most. Where delta-M
/// cuts off a peak they do not, and nothing may be taken over.
class CoarserFourierOrders {
  public:
    /// @param orders  of the coarser solution; empty: nothing is taken over
    CoarserFourierOrders(const FourierOrders& orders, double tolerance)
        : orders_(orders), tolerance_(tolerance) {}

    /// Compares an order of the finer solution with the coarser one.
    void compare(int fourier_order, const Eigen::MatrixXd& finer,
                 const RequestedDirections& requested);

    /// The coarser R^m, or null where the order has to be solved.
    const Eigen::MatrixXd* settled(int fourier_order) const;

    /// The doubt in orders taken over, relative to order 0.
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

class StackGrids;
struct StackMemory;

/// Whether delta-M cuts off next to nothing: then all Fourier orders converge alike with more
/// nodes.
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
    /// At the incident cosines, by light of all orders of scattering: Fourier order 0 gives them.
    std::vector<double> plane_albedo, polarised_plane_albedo;
    int fourier_orders = 0;  ///< 1 + the highest one summed
    int iterations = 0;
    double residual = 0.0;
    /// The larger one of two estimates: orders not summed, relative to the largest value at the
    /// incidence; the doubt in orders taken over, as (mu + mu') R relative to order 0.
    double tail = 0.0;
    bool converged = true;
    bool physical = true;
    FourierOrders by_fourier_order;  ///< as KeptOrders says
};

/// The orders that the sum keeps in by_fourier_order.
enum class KeptOrders {
    for_finer,  ///< for a finer solution to take over; none where it may not
    for_table,  ///< all orders
};

/// The number of Fourier orders that are not 0 in the requested directions: `orders`, but 1 where
/// all incident or all outgoing light is at mu = 1, where Y_l^m = 0 for m > 0 (Stokes vectors: 3,
/// because d^l_m2 is not 0 for m = 2).
int highest_fourier_order(const RequestedDirections& requested, int orders,
                          const SolvedLight& light);

/// R^0 + 2 sum_m R^m cos(m azimuth) of light scattered more than once; for Stokes vectors with the
/// harmonic of each element.
///
/// Ends where the orders left are below `tail_tolerance`, relative to the largest value at the same
/// incidence (or order 0, if that is less), or with highest_fourier_order. Orders with
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
