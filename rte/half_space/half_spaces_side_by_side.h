// Half-spaces in several Fourier orders side by side, for few nodes.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "rte/grid/directions.h"
#include "rte/half_space/kernels_side_by_side.h"

namespace miebrdf::rte {

/// A half-space as HalfSpacesSideBySide sees it, and a layer as LayersSideBySide does.
struct ProblemSideBySide {
    const Eigen::VectorXd& strengths;  ///< alpha (2l+1) chi_l, l = 0 ... L - 1
    double one_minus_albedo;
    double brightness;  ///< of order 0, as of FourierMedium; 0: not known yet
    const ZenithGrid& grid;
    const RequestedDirections& requested;
    double tolerance;  ///< as of solve_half_space
    int orders;        ///< that are likely to be asked for, from the first on
    KernelsSideBySide& kernels;
    FourierModes& modes;  ///< for tables that the kernels have not seen yet
};

/// What reflects, in several Fourier orders side by side: all stored by columns.
template <typename Doubles>
struct ReflectorSideBySide {
    Doubles* nodes;       ///< X, n x n
    Doubles* moved_rows;  ///< mu times Reflector::rows, cosines x n
    Doubles* pairs;       ///< Reflector::multiple, out x in
};

/// R of successive Fourier orders between requested cosines, with each matrix element of all of
/// them in one register (rte/math/matrices_side_by_side.h): eight orders where the library is
/// compiled for AVX-512 and more than four are left, four for AVX. Where few sweeps of the fixed
/// point do, by these from X = 0, else by means of matrices that become Z (half_space.h), and a
/// sweep that says how well. Four or, with AVX-512, eight orders of 12 to 20 nodes take as long as
/// one or two by eigenmodes, of 32 as three.
class HalfSpacesSideBySide {
  public:
    static constexpr int kMostOrders = 8;
    /// More take longer than one by one.
    static constexpr int kMostCosines = 32;
    /// The same of nodes: 64, or 32 where eight orders go side by side (their matrices are twice as
    /// large as those of four, and one by one is faster there).
    static int most_nodes();

    /// Forgets all results. Tables stay.
    void clear() { count_ = 0; }

    /// Light scattered more than once as of Reflector::multiple; null where it was not found.
    const Eigen::MatrixXd* multiple(int fourier_order) const;

    /// Orders `first` and above, which then are known, or found to be better solved one by one: too
    /// many nodes or cosines, hardly any absorption, or a library that is not compiled for AVX.
    /// @return whether `first` is known
    bool solve(int first, const ProblemSideBySide& problem);

    /// How many orders `solve` finds at once, of which so many are likely to be asked for; 0 where
    /// registers hold no four doubles.
    static int lanes_of(int orders);
    /// What the last call of `solve` has found, in as many lanes; valid until the next one.
    template <typename Doubles>
    ReflectorSideBySide<Doubles> reflector();

    /// Of order 0, if the last call of `solve` began with it: largest 4 (mu + mu') |R| between
    /// nodes, as FourierMedium::brightness.
    double brightness() const;

    /// From here on slow eigenmodes cost digits in order 0.
    static constexpr double kLeastAbsorption = 1e-5;

  private:
    template <typename Doubles>
    bool solve_with(int first, const ProblemSideBySide& problem);
    template <typename Doubles>
    Doubles* matrix(std::size_t which);
    void set_grid(const ProblemSideBySide& problem);
    template <typename Doubles>
    void find_accuracies(int first, const ProblemSideBySide& problem);
    bool few_sweeps_suffice() const;
    template <typename Doubles>
    void start_from_nothing();
    template <typename Doubles>
    bool start_from_means();
    template <typename Doubles>
    void sweep_nodes();
    template <typename Doubles>
    void sweep_rows();
    template <typename Doubles>
    void solve_rows();
    template <typename Doubles>
    void find_pairs(const RequestedDirections& requested);

    int first_ = 0, count_ = 0;
    int lanes_ = 0;  ///< orders side by side, those beyond the last degree among them
    int nodes_ = 0, cosines_ = 0;
    Eigen::Index matrix_size_ = 0;  ///< of doubles, for each of the matrices in memory_
    std::array<double, kMostOrders> once_ = {}, accuracy_ = {}, ratio_ = {};
    std::array<bool, kMostOrders> has_arrived_ = {};
    std::array<Eigen::MatrixXd, kMostOrders> multiple_;
    Eigen::VectorXd memory_;

    // Of their grid and cosines.
    Eigen::VectorXd requested_;
    Eigen::VectorXd inverse_mu_, mu_over_flux_weights_;
    Eigen::MatrixXd to_nodes_;
};

}  // namespace miebrdf::rte
