#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "rte/boundary/rough_boundaries.h"
#include "rte/first_order/first_order.h"
#include "rte/grid/discretisation.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/layered_reflection.h"
#include "rte/stack/requests.h"
#include "rte/stack/solution_memory.h"

namespace miebrdf::rte {
namespace {

/// MirroredLobe at all pairs of cosines, order by order.
void add_mirrored_orders(const std::vector<double>& mu, TabulatedOrders& table) {
    const int count = mirrored_lobe_orders(table.stack);
    Directions samples{mu, mu, {}};  // one more than orders, from 0 to 180 degrees
    for (int a = 0; a <= count; ++a) samples.azimuth_deg.push_back(180.0 * a / count);
    std::vector<double> lobe(mu.size() * mu.size() * samples.azimuth_deg.size(), 0.0);
    add_mirrored_lobe(lobe, samples, table.stack);
    const auto size = Eigen::Index(mu.size());
    const Eigen::Map<const Eigen::MatrixXd> by_pair(lobe.data(), count + 1, size * size);
    for (int m = 0; m < count; ++m) {
        Eigen::VectorXd weights(count + 1);
        for (int a = 0; a <= count; ++a) {
            const double end = a == 0 || a == count ? 0.5 : 1.0;
            weights[a] = end / count * std::cos(std::numbers::pi * double(m * a) / count);
        }
        const Eigen::VectorXd order = by_pair.transpose() * weights;
        if (m == int(table.orders.size())) table.orders.emplace_back();
        Eigen::MatrixXd& sum = table.orders[std::size_t(m)];
        if (sum.size() == 0) sum.setZero(size, size);
        sum += Eigen::Map<const Eigen::MatrixXd>(order.data(), size, size);
    }
}

}  // namespace

TabulatedOrders tabulate_orders(const Stack& asked_stack, const std::vector<double>& mu,
                                const SolvedLight& light, const SolverReport& solved,
                                const SolverOptions& options, SolutionMemory& known) {
    const Stack stack = light.components > 1 ? with_all_moments(asked_stack) : asked_stack;
    TabulatedOrders table;
    table.stack.rough_boundaries = SolutionParts::of(known).rough_boundaries;
    scale_stack(stack, solved.moments, options.delta_m, NarrowPart::ignored, table.stack);
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
                                                     memory, {}, KeptOrders::asked_for);
    table.orders = std::move(multiple.by_fourier_order);
    table.converged = multiple.converged;
    table.physical = multiple.physical;
    const bool is_rough = table.stack.boundary && table.stack.boundary->is_rough();
    if (is_rough && table.stack.has_mirrors() && table.physical) add_mirrored_orders(mu, table);
    return table;
}

}  // namespace miebrdf::rte
