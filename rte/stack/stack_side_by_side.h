// A stack in several Fourier orders side by side, for few nodes.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "rte/half_space/half_space.h"
#include "rte/half_space/half_spaces_side_by_side.h"
#include "rte/layer/layers_side_by_side.h"

namespace miebrdf::rte {

struct ScaledStack;

/// Successive Fourier orders of one stack between requested cosines. Not for boundaries, mirrors
/// and the paper's methods.
class StackSideBySide {
  public:
    /// As they are for StackSolver.
    struct Question {
        const ScaledStack& stack;
        const ZenithGrid& grid;
        const RequestedDirections& requested;
        double tolerance;
        int orders;                       ///< that are likely to be asked for, this one included
        bool wants_nodes;                 ///< too, and rows: something lies above
        const Eigen::VectorXd& sky;       ///< for order 0, unless nodes are wanted
        std::vector<double>& brightness;  ///< of order 0, by medium: set by order 0
        FourierModes& modes;
        KernelsSideBySide& kernels;  ///< of this stack's grid
    };

    /// Forgets all results.
    void clear() { count_ = 0; }

    /// One order, found together with those that come next: `multiple` and nodes and rows or, of
    /// order 0, the answer to the sky.
    /// One solution is kept, that of the kernels it was found with.
    /// @return false where orders are better solved one by one
    bool find(int fourier_order, const Question& question, Reflector& result);

  private:
    bool knows(int fourier_order, const Question& question) const;
    bool solve(int first, const Question& question);
    template <typename Doubles>
    bool solve_with(int first, const Question& question, std::size_t lowest);
    template <typename Doubles>
    ReflectorSideBySide<Doubles> ground(int first, const Question& question);
    template <typename Doubles>
    void reflect_sky(const ReflectorSideBySide<Doubles>& half_space, const Question& question);
    ProblemSideBySide problem_of(std::size_t medium, const Question& question);

    int first_ = 0, count_ = 0, lanes_ = 0;
    const KernelsSideBySide* kernels_ = nullptr;             ///< of the last solution
    const double *nodes_ = nullptr, *moved_rows_ = nullptr;  ///< of the last solution, in its lanes
    std::array<bool, HalfSpacesSideBySide::kMostOrders> has_arrived_ = {};
    std::array<Eigen::MatrixXd, HalfSpacesSideBySide::kMostOrders> multiple_;
    Eigen::VectorXd sky_at_nodes_, sky_at_requested_;  ///< of order 0
    Eigen::VectorXd strengths_;                        ///< of the medium that is being solved
    Reflector ground_;                                 ///< in order 0
    Eigen::VectorXd ground_memory_;
    HalfSpacesSideBySide half_space_;
    LayersSideBySide layers_;
};

}  // namespace miebrdf::rte
