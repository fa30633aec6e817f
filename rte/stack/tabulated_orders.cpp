#include <algorithm>
#include <utility>

#include "rte/boundary/rough_boundaries.h"
#include "rte/first_order/first_order.h"
#include "rte/grid/discretisation.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/layered_reflection.h"
#include "rte/stack/solution_memory.h"

namespace miebrdf::rte {
namespace {

/// Adds the Fourier orders of MirroredLobe between all cosines.
void add_mirrored_orders(const Eigen::VectorXd& mu, TabulatedOrders& table) {
    std::vector<Eigen::MatrixXd> lobe = mirrored_lobe_orders(mu, table.stack);
    table.orders.resize(std::max(table.orders.size(), lobe.size()));
    for (std::size_t m = 0; m < lobe.size(); ++m) {
        Eigen::MatrixXd& sum = table.orders[m];
        sum.size() == 0 ? sum = std::move(lobe[m]) : sum += lobe[m];
    }
}

}  // namespace

TabulatedOrders tabulate_orders(const Stack& asked_stack, const std::vector<double>& mu,
                                const SolvedLight& light, const SolverReport& solved,
                                const SolverOptions& options, SolutionMemory& known) {
    const Stack stack = light.components > 1 ? with_all_moments(asked_stack) : asked_stack;
    TabulatedOrders table;
    table.stack.rough_boundaries = SolutionParts::of(known).rough_boundaries;
    scale_stack(stack, solved.moments, options.delta_m, table.stack);
    const StackGrids grids(table.stack, choose_discretisation(stack, options, solved.streams).grid,
                           solved.streams);
    if (options.single_scattering_correction) split_by_resolution(table.stack, grids);
    RequestedDirections requested;
    requested.mu = Eigen::Map<const Eigen::VectorXd>(mu.data(), Eigen::Index(mu.size()));
    for (int k = 0; k < int(mu.size()); ++k) {
        requested.in.push_back(k);
        requested.out.push_back(k);
    }
    StackMemory memory;
    MultipleScattering multiple = sum_fourier_orders(table.stack, grids, requested, {}, light,
                                                     kFourierTailShare * options.tolerance, options,
                                                     memory, {}, KeptOrders::for_table);
    table.orders = std::move(multiple.by_fourier_order);
    table.converged = multiple.converged;
    table.physical = multiple.physical;
    const bool is_rough = table.stack.boundary && table.stack.boundary->is_rough();
    if (is_rough && table.stack.has_mirrors() && table.physical)
        add_mirrored_orders(requested.mu, table);
    return table;
}

}  // namespace miebrdf::rte
