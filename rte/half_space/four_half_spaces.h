// Half-spaces in four Fourier orders side by side, for few nodes.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "rte/grid/directions.h"

namespace miebrdf::rte {

class FourierModes;
struct Reflector;

/// A half-space as FourHalfSpaces sees it.
struct FourProblem {
    const Eigen::VectorXd& strengths;  ///< alpha (2l+1) chi_l, l = 0 ... L - 1
    double one_minus_albedo;
    double brightness;  ///< of order 0, as of FourierMedium; 0: not known yet
    const ZenithGrid& grid;
    const RequestedDirections& requested;
    double tolerance;  ///< as of solve_half_space
};

/// R of four successive Fourier orders between requested cosines, with each matrix element of all
/// four in one register (rte/math/four_doubles.h): where few sweeps of the fixed point do, by these
/// from X = 0, else by means of matrices that become Z (half_space.h), and a sweep that says how
/// well. Four orders of 12 to 20 nodes take as long as one or two by eigenmodes, of 32 as three.
class FourHalfSpaces {
  public:
    static constexpr int kOrders = 4;
    /// More take longer than one by one.
    static constexpr int kMostNodes = 32, kMostCosines = 32;

    /// Forgets all results. Tables stay.
    void clear() { count_ = 0; }

    /// Light scattered more than once as of Reflector::multiple; null where it was not found.
    const Eigen::MatrixXd* multiple(int fourier_order) const;

    /// Orders `first` and above, which then are known, or found to be better solved one by one: too
    /// many nodes or cosines, registers too short, hardly any absorption.
    /// @param modes  for tables that have not been seen yet
    /// @return whether `first` is known
    bool solve(int first, const FourProblem& problem, FourierModes& modes);

    /// Of order 0, if it is known: nodes, rows and what lies at their base; and its brightness.
    double order_zero(Reflector& reflector) const;

  private:
    /// Y at nodes and cosines, column by column, element by element four orders.
    struct Table {
        int first = 0;
        Eigen::VectorXd values = {};
    };

    double* matrix(std::size_t which);
    const double* table_of(int first, const FourProblem& problem, FourierModes& modes);
    void form_kernels(int first, const FourProblem& problem, const double* table);
    void find_accuracies(int first, const FourProblem& problem);
    bool few_sweeps_suffice() const;
    void start_from_nothing();
    bool start_from_means();
    void sweep_nodes();
    void sweep_rows();
    void solve_rows();
    void find_pairs(const RequestedDirections& requested);

    int first_ = 0, count_ = 0;
    int nodes_ = 0, cosines_ = 0;
    Eigen::Index matrix_size_ = 0;  ///< of doubles, for each of the matrices in memory_
    std::array<double, kOrders> once_ = {}, accuracy_ = {}, ratio_ = {};
    std::array<bool, kOrders> has_arrived_ = {};
    std::array<Eigen::MatrixXd, kOrders> multiple_;
    Eigen::VectorXd memory_;

    // Of the grid and cosines that `tables_` are of.
    int degrees_ = 0;
    ZenithGrid grid_;
    Eigen::VectorXd requested_;
    Eigen::VectorXd inverse_mu_, mu_over_flux_weights_;
    Eigen::MatrixXd to_nodes_;
    std::vector<Table> tables_;
    Table passing_;  ///< of orders that are too many to be kept
};

}  // namespace miebrdf::rte
