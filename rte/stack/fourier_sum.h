// The sum over Fourier orders in azimuth, until the directions asked for no longer notice: when it
// may stop, and which orders a solution with fewer nodes has settled already.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <span>
#include <vector>

#include <miebrdf/transfer.h>
#include "rte/grid/directions.h"

namespace miebrdf::rte {

/// Sizes of successive Fourier orders: |R^m|, the largest at each incidence (of all components)
/// relative to that of order 0, and of these the largest. By incidence, as errors are: a bright
/// zenith in the same request says nothing of grazing light.
class FourierSizes {
  public:
    /// @param components  rows and columns of each pair of cosines
    explicit FourierSizes(int components = 1) : components_(components) {}

    /// @param reflection  R^m, out x in; m = 0 first
    double next(const Eigen::Ref<const Eigen::MatrixXd>& reflection);
    /// The size of an order out of turn.
    double of(const Eigen::Ref<const Eigen::MatrixXd>& reflection) const;
    /// The size of 4 (mu + mu') R = 1 near retro-reflection.
    double of_retro_reflection(const Eigen::Ref<const Eigen::VectorXd>& mu_in) const;
    /// Order 0 relative to the largest listed value at the same incidence, the largest such ratio,
    /// at least 1. Across a forward peak values are far below order 0 (Henyey-Greenstein 0.95 at mu
    /// = mu' = 0.02, 90 degrees: 13 times), and orders that matter to them are small beside it.
    /// @param reflection  sum of the orders so far, incidence by incidence
    double over_listed(const std::vector<double>& reflection) const;

  private:
    Eigen::VectorXd by_incidence(const Eigen::Ref<const Eigen::MatrixXd>& reflection) const;
    double relative(const Eigen::VectorXd& largest) const;

    int components_;
    Eigen::VectorXd of_order_zero_;
};

/// Watches the sizes of successive Fourier orders and says when those still to come are below a
/// tolerance relative to order 0.
///
/// Orders of a smooth phase function fall like r^m: once two steps in a row have fallen by r <= 0.7
/// or more, the rest is a geometric series, 2 v r / (1 - r) with the 2 of 2 R^m cos(m azimuth). v
/// is the envelope max(v_m, r v_(m-1)), because one small order may be an accident of parity. Where
/// the orders fall otherwise, the rest is taken as 2.5 times the larger of the last two.
///
/// Lobes off the plane of incidence, of light that several surfaces send to and fro, have orders
/// with longer dips: of a series that may dip the largest of four orders in a row counts, and its
/// fall since the four before.
class FourierTail {
  public:
    explicit FourierTail(double tolerance, bool may_dip = false)
        : tolerance_(tolerance), may_dip_(may_dip) {}

    /// Takes the size of the next order. True once the rest no longer matters.
    bool ends_with(double largest);

    /// The sum of the orders still to come, relative to order 0.
    double remaining() const { return remaining_; }

  private:
    static constexpr int kDip = 4;
    double remaining_of_dipping(double largest);

    double tolerance_;
    bool may_dip_;
    std::array<double, 2 * kDip> recent_{};  ///< sizes, of a series that may dip
    int count_ = 0;
    double order_zero_ = 0.0;
    double before_last_ = 0.0;
    double last_ = 0.0;
    double remaining_ = 0.0;
};

struct ScaledStack;

/// Glories and rainbows, spread by the forward peak, are made of higher orders than all other light
/// that is scattered more than once: orders fall to nothing, change their sign and rise once more
/// (spheres of 10 um, k = 0.006: 3e-5 of order 0 at m = 28, 7.5e-3 at m = 58). Where they may, a
/// few of the higher orders tell whether the sum has ended.
class FeatureOrders {
  public:
    FeatureOrders(const ScaledStack& stack, const RequestedDirections& requested);

    /// The order up to which the sum must go on that would end with m: m itself where all those
    /// features together are below the tolerance, or the orders looked at are.
    /// @param scale    FourierSizes::of_retro_reflection
    /// @param size_of  size of an order, by FourierSizes::of; called for up to four below `highest`
    int last(int m, int highest, double scale, double tolerance,
             const std::function<double(int order)>& size_of) const;

  private:
    std::vector<int> probes(int m, double scale, double tolerance) const;
    double beyond(int m) const;
    Eigen::VectorXd strengths_;  ///< by degree
};

/// R^m of light scattered more than once, out x in (times the components shown), for m = 0, 1, ...;
/// empty for orders left out.
using FourierOrders = std::vector<Eigen::MatrixXd>;

/// A finer solution repeats the Fourier orders of a coarser one until two in a row differ by less
/// than a tolerance, relative to order 0, or order 0 itself by less than a tenth of it; the rest it
/// takes over. Both converge alike in every order as long as the phase functions are smooth: of 442
/// random coated scenes with 10 to 48 nodes, compared at 25 pairs, the worst order was apart 0.2
/// times as far as order 0 in the median, 3.3 times in one of a hundred, 7.6 times at most. Where a
/// peak is cut off they do not, and nothing must be taken over. Few pairs may agree by accident:
/// they need probes (RequestedDirections).
class CoarserFourierOrders {
  public:
    /// @param orders  of the coarser solution; empty: nothing is taken over
    CoarserFourierOrders(const FourierOrders& orders, double tolerance)
        : orders_(orders), tolerance_(tolerance) {}

    /// Takes note of one order of the finer solution.
    void compare(int fourier_order, const Eigen::MatrixXd& finer,
                 const RequestedDirections& requested);

    /// The coarser R^m, or null where the finer one has to be computed.
    const Eigen::MatrixXd* settled(int fourier_order) const;

    /// How far the orders that agreed were apart, relative to order 0: no order that was taken over
    /// is known better.
    double difference() const { return difference_; }

  private:
    const FourierOrders& orders_;
    double tolerance_;
    double order_zero_ = 0.0;
    double difference_ = 0.0;
    int alike_ = 0;
};

/// Incident cosines without probes.
Eigen::VectorXd asked_incidences(const RequestedDirections& requested);

/// Orders of larger tables are not kept: 30 of them would take 10 MB.
inline constexpr std::size_t kMostKeptPairs = 40000;

class StackGrids;
struct StackMemory;

/// Nothing that matters is cut off: every order converges like the first ones.
bool is_smooth(const ScaledStack& stack);

/// Element (row, column) of R at an azimuth is the sum over m of (m = 0 ? 1 : 2) times that of R^m
/// (StackOrder::multiple) times `sign` and cos(m azimuth), or sin(m azimuth) where `is_sine`.
struct StokesHarmonic {
    bool is_sine = false;
    double sign = 1.0;
};
StokesHarmonic stokes_harmonic(int row, int column);

/// Reflection without the first order of scattering, and how it was found.
struct MultipleScattering {
    /// [((i * outs + o) * c^2 + row * c + column) * azimuths + a], c = SolvedLight::shown()
    std::vector<double> reflection;
    /// At the incident cosines, all orders of scattering: what Fourier order 0 knows anyway.
    std::vector<double> plane_albedo, polarised_plane_albedo;
    int fourier_orders = 0;  ///< the highest one summed, plus 1
    int iterations = 0;
    double residual = 0.0;
    /// Fourier orders not summed, relative to the largest listed value at that incidence, or the
    /// doubt in those taken over, relative to order 0: largest (mu + mu') R.
    double tail = 0.0;
    bool converged = true;
    bool physical = true;
    FourierOrders by_fourier_order;  ///< as KeptOrders says
};

/// The orders that the sum keeps in by_fourier_order.
enum class KeptOrders {
    for_finer,  ///< those that a finer solution may take over, probes included; empty: none
    asked_for,  ///< all of them, at the directions asked for: what a table is made of
};

/// How many Fourier orders of `orders` directions can see: at mu = 1 Y_l^m vanishes but for m = 0,
/// of Stokes vectors d^l_m2 but for m = 2.
int highest_fourier_order(const RequestedDirections& requested, int orders,
                          const SolvedLight& light);

/// R^0 + 2 sum_m R^m cos(m azimuth) without the first order of scattering, of Stokes vectors with
/// the harmonics of each element.
///
/// Stops where the orders still to come are below `tail_tolerance`, relative to the largest listed
/// value at the same incidence (or order 0, if that is less). When all incident or all outgoing
/// cosines are 1, where Y_l^m = 0 for m > 0, only m = 0 is computed, of Stokes vectors m <= 2;
/// orders whose cosine is zero at every azimuth (the odd ones across the plane of incidence) are
/// left out where only numbers are wanted.
/// @param coarser  by_fourier_order of a solution with fewer nodes, or empty
/// @param exactly  so many orders, whatever they are; 0: as many as are needed
MultipleScattering sum_fourier_orders(const ScaledStack& stack, const StackGrids& grids,
                                      const RequestedDirections& requested,
                                      std::span<const double> azimuth_deg, const SolvedLight& light,
                                      double tail_tolerance, const SolverOptions& options,
                                      StackMemory& memory, const FourierOrders& coarser = {},
                                      KeptOrders kept = KeptOrders::for_finer, int exactly = 0);

}  // namespace miebrdf::rte
