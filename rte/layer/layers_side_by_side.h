// Layers in several Fourier orders side by side, each on what lies below it, for few nodes.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "rte/half_space/half_spaces_side_by_side.h"

namespace miebrdf::rte {

/// What LayerOperator and put_on (layer.h) are for one order, for as many as HalfSpacesSideBySide
/// finds at once, without eigenmodes. With K^2 = V U, M = V^-1 K coth(K tau/2) and
/// P = V^-1 K tanh(K tau/2) of twice the optical depth are the arithmetic and the harmonic mean of
/// both:
///     M' = (M + P) / 2,   P'^-1 = (M^-1 + P^-1) / 2,
/// the means whose common limit is a half-space (rte/math/means_side_by_side.h). They begin with a
/// thin layer, M = 2/h V^-1 + h/6 U and P^-1 = 2/h U^-1 + h/6 V, and end with
/// R = (I + P)^-1 + (I + M)^-1 - I. Requested cosines are nodes of weight zero throughout: rows of
/// matrices that hold nothing above the diagonal there. No element of R is off by more than the
/// tolerance, relative to the largest (docs/maths-rte.md).
class LayersSideBySide {
  public:
    static constexpr int kMostOrders = HalfSpacesSideBySide::kMostOrders;

    /// A layer on what `below` is; one layer after the other in the same memory.
    /// @param problem  of the layer; brightness is not needed
    /// @param depth    scaled optical depth, > 0 and finite
    /// @param below    of the same orders and directions: null for nothing
    /// @param is_top   only pairs are wanted
    /// @return whether `reflector` is known: not where hardly anything absorbs in order 0, nor of a
    ///         depth that takes too many means
    template <typename Doubles>
    bool put_on(int first, const ProblemSideBySide& problem, double depth,
                const ReflectorSideBySide<Doubles>* below, bool is_top);

    /// With `is_top` without nodes and rows; valid until the call after the next.
    template <typename Doubles>
    ReflectorSideBySide<Doubles> reflector();

    /// Reflector::sky_at_nodes and sky_at_requested of order 0, which is the first, after `put_on`.
    template <typename Doubles>
    void reflect_sky(const Eigen::VectorXd& sky, const ReflectorSideBySide<Doubles>* below,
                     Eigen::VectorXd& at_nodes, Eigen::VectorXd& at_requested);

    /// Of the last layer, order by order from the first: its equations have a physical solution.
    const std::array<bool, kMostOrders>& physical() const { return physical_; }

  private:
    template <typename Doubles>
    Doubles* matrix(std::size_t which);
    template <typename Doubles>
    void allocate(const RequestedDirections& requested);
    template <typename Doubles>
    void invert(const Doubles* nodes, const Doubles* rows, Doubles* inverse, Doubles* inverse_rows);
    template <typename Doubles>
    void start_thin(double depth);
    template <typename Doubles>
    void take_means();
    template <typename Doubles>
    void find_layer();
    template <typename Doubles>
    void find_pairs(const RequestedDirections& requested);
    template <typename Doubles>
    void meet(const ReflectorSideBySide<Doubles>& below);
    template <typename Doubles>
    void add_pairs(const ReflectorSideBySide<Doubles>& below, const RequestedDirections& requested);
    template <typename Doubles>
    void add_rows();

    int nodes_ = 0, cosines_ = 0, lanes_ = 0;
    int slot_ = 0;  ///< of two results, the last
    Eigen::Index matrix_size_ = 0;
    Eigen::VectorXd inverse_mu_, mu_, diagonal_, direct_;  ///< of nodes; of cosines the others
    std::array<bool, kMostOrders> physical_ = {};
    Eigen::VectorXd memory_;
};

}  // namespace miebrdf::rte
