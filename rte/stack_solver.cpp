#include "rte/stack_solver.h"

#include <utility>

#include "rte/coat_steps.h"

namespace miebrdf::rte {
namespace {

// What the equations of one order are solved to, of the tolerance of the whole.
constexpr double share_of_equations = 0.01;

}  // namespace

StackSolver::StackSolver(const ScaledStack& stack, const ZenithGrid& grid,
                         const RequestedDirections& requested, const SolverOptions& options)
    : stack_(stack),
      grid_(grid),
      requested_(requested),
      options_(options),
      tolerance_(share_of_equations * options.tolerance),
      coats_(stack.media.size()) {}

const Reflector& StackSolver::solve(int order, ReflectorParts parts, const Eigen::VectorXd& sky) {
    make_phase_mode(order, stack_.moments, grid_, requested_, mode_);
    solve_base();
    const std::size_t first_coat = stack_.base == BaseKind::half_space ? 1 : 0;
    bool has_sky = false;
    for (std::size_t c = first_coat; c < stack_.media.size() && reflector_.physical; ++c) {
        const bool is_top = c + 1 == stack_.media.size();
        put_on_coat(c, is_top ? parts : ReflectorParts::nodes, sky);
        has_sky = is_top && options_.coat_method == CoatMethod::automatic;
    }
    if (parts == ReflectorParts::sky && !has_sky && reflector_.physical) {
        reflector_.sky_at_requested.noalias() = reflector_.rows * sky;
        reflector_.sky_at_nodes.noalias() = reflector_.nodes * sky;
    }
    return reflector_;
}

void StackSolver::set_medium(const ScaledMedium& medium) {
    const ScaledOptics& scaled = medium.scaled;
    medium_.one_minus_albedo = scaled.one_minus_albedo;
    medium_.lowest_degree = mode_.order;
    medium_.strengths.resize(mode_.at_nodes.cols());
    for (Eigen::Index c = 0; c < medium_.strengths.size(); ++c) {
        const Eigen::Index l = mode_.order + c;
        medium_.strengths[c] =
            l < scaled.chi.size() ? scaled.albedo * (2.0 * double(l) + 1.0) * scaled.chi[l] : 0.0;
    }
}

void StackSolver::solve_base() {
    switch (stack_.base) {
        case BaseKind::lambertian:
            lambertian_ground(stack_.ground_albedo, mode_, grid_, requested_, reflector_);
            return;
        case BaseKind::none:
            no_reflection(grid_, requested_, reflector_);
            return;
        case BaseKind::half_space:
            break;
    }
    set_medium(stack_.media.front());
    solve_half_space(options_.half_space_method, medium_, mode_, grid_, requested_, tolerance_,
                     half_space_, reflector_);
}

void StackSolver::put_on_coat(std::size_t index, ReflectorParts parts, const Eigen::VectorXd& sky) {
    const ScaledMedium& coat = stack_.media[index];
    set_medium(coat);
    if (options_.coat_method != CoatMethod::automatic) {
        const std::vector<ScaledMedium> below(stack_.media.begin(),
                                              stack_.media.begin() + std::ptrdiff_t(index));
        reflector_ =
            step_through_coat(options_.coat_method, options_.coat_substeps, coat.optical_depth,
                              medium_, first_order_of(below, mode_, requested_), mode_, grid_,
                              requested_, std::move(reflector_));
        return;
    }
    LayerWork& work = coats_[index];
    solve_layer(coat.optical_depth, medium_, mode_, grid_, requested_, parts, tolerance_, work,
                layer_);
    if (!layer_.physical) {
        reflector_.physical = false;
        return;
    }
    std::swap(below_, reflector_);
    put_on(layer_, below_, requested_, parts, sky, work, reflector_);
}

}  // namespace miebrdf::rte
