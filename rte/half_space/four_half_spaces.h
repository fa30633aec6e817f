// Half-spaces in four Fourier orders side by side, for few nodes.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace miebrdf::rte {

struct FourierMedium;
struct FourierWork;
struct RequestedDirections;

/// R of four successive Fourier orders above 0 between requested cosines, by sweeps of the fixed
/// point with each matrix element of all four in one register (rte/math/four_doubles.h), until all
/// have arrived. Sweeps take a third to a half of the time of one order after the other, up to some
/// twenty of them; then eigenmodes are faster.
class FourHalfSpaces {
  public:
    static constexpr int kOrders = 4;
    /// More do not fit into the cache next to the processor; 24 nodes take longer than one by one.
    static constexpr int kMostNodes = 16, kMostCosines = 32;

    void clear() { first_ = 0; }

    /// Light scattered more than once as of Reflector::multiple; null where it was not found.
    const Eigen::MatrixXd* multiple(int fourier_order) const;

    /// Begins with orders `first` and above, of which none is known yet. False if they are better
    /// solved one by one: too many nodes or cosines, or a processor whose registers are too short.
    bool begin(int first, Eigen::Index nodes, const RequestedDirections& requested);
    /// The next order.
    /// @param work  after form_sides
    /// @param tolerance  as of solve_half_space
    /// @return false if eigenmodes are the faster way
    bool add(const FourierMedium& medium, double tolerance, const FourierWork& work);
    void solve(const RequestedDirections& requested, const FourierWork& work);

  private:
    double* matrix(std::size_t which);
    void sweep_nodes(const FourierWork& work);
    void sweep_rows(const RequestedDirections& requested, const FourierWork& work);
    void find_pairs(const RequestedDirections& requested);

    int first_ = 0;  ///< 0: none
    int count_ = 0;
    int nodes_ = 0, cosines_ = 0;
    Eigen::Index matrix_size_ = 0;  ///< of doubles, for each of the matrices in memory_
    std::array<double, kOrders> once_ = {}, accuracy_ = {}, ratio_ = {};
    std::array<bool, kOrders> has_arrived_ = {};
    std::array<Eigen::MatrixXd, kOrders> multiple_;
    Eigen::VectorXd memory_;
};

}  // namespace miebrdf::rte
