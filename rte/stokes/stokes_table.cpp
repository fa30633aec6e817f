
#include <utility>

#include "rte/grid/discretisation.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stokes/stokes_reflection.h"
#include "rte/stokes/stokes_solver.h"

namespace miebrdf::rte {

TabulatedStokes tabulate_polarised(const Stack& asked_stack, const std::vector<double>& mu,
                                   int components, const SolverReport& solved,
                                   const SolverOptions& options) {
    const Stack stack = with_all_moments(asked_stack);
    TabulatedStokes table;
    table.stack = scale_stack(stack, solved.moments, options.delta_m, NarrowPart::ignored);
    const StackGrids grids(table.stack, choose_discretisation(stack, options, solved.streams).grid,
                           solved.streams);
    if (options.single_scattering_correction) split_by_resolution(table.stack, grids);
    RequestedDirections requested;
    requested.mu = Eigen::Map<const Eigen::VectorXd>(mu.data(), Eigen::Index(mu.size()));
    for (int k = 0; k < int(mu.size()); ++k) {
        requested.in.push_back(k);
        requested.out.push_back(k);
    }
    StokesMemory memory;
    StokesScattering multiple = sum_stokes_orders(table.stack, grids, requested, {}, components,
                                                  kFourierTailShare * options.tolerance, options,
                                                  memory, {}, KeptOrders::asked_for);
    table.orders = std::move(multiple.by_fourier_order);
    table.converged = multiple.converged;
    table.physical = multiple.physical;
    return table;
}

}  // namespace miebrdf::rte
