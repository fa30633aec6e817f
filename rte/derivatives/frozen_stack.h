// A stack in the discretisation of a solution that is known: nodes, moments, cutoffs and Fourier
// orders do not depend on its numbers.
#pragma once

#include <span>
#include <vector>

#include "rte/derivatives/stack_derivatives.h"
#include "rte/grid/discretisation.h"
#include "rte/stack/scaled_stack.h"

namespace miebrdf::rte {

/// Equations are solved to rounding.
inline constexpr double kFrozenTolerance = 1e-12;

class FrozenStack {
  public:
    /// Moments and Fourier orders that are 0 in the stack and not in its changes are kept, too.
    /// @param solved  its streams, moments and Fourier orders; 0: those that solving begins with
    FrozenStack(const Stack& stack, std::span<const StackChange> changes,
                const SolverOptions& options, const SolverReport& solved);

    /// The scaled form of another stack of the same layers, cut off as this one is.
    ScaledStack scaled_like(const Stack& other) const;
    StackGrids grids_of(const ScaledStack& scaled) const;

    const ScaledStack& scaled() const { return scaled_; }
    const StackGrids& grids() const { return grids_; }
    int fourier_orders() const { return fourier_orders_; }
    const SolverOptions& options() const { return options_; }

  private:
    ScaledStack scale(const Stack& stack) const;

    SolverOptions options_;
    Discretisation discretisation_;
    int fourier_orders_;
    ScaledStack scaled_;
    StackGrids grids_;
};

/// ReflectionTable::reflection, [pair][element][azimuth] of StokesHarmonic elements.
std::vector<double> frozen_reflection(const FrozenStack& frozen, const ScaledStack& scaled,
                                      const StackGrids& grids, const Directions& directions,
                                      const SolvedLight& light);
/// The part of it that is scattered once.
std::vector<double> frozen_first_order(const FrozenStack& frozen, const ScaledStack& scaled,
                                       const Directions& directions, const SolvedLight& light);
/// Fills in all of an AlbedoTable but the mirror's part and the report.
AlbedoTable frozen_albedo(const FrozenStack& frozen, const ScaledStack& scaled,
                          const StackGrids& grids, const AlbedoQuestion& question,
                          const std::function<SurfaceWeights(double mu)>& surface);

}  // namespace miebrdf::rte
