#include "rte/stack/stack_solver.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "rte/math/tolerance_budget.h"
#include "rte/stack/hidden_layers.h"

namespace miebrdf::rte {

ScaledStack scale_stack(const Stack& stack, int moments, bool delta_m) {
    ScaledStack scaled;
    scaled.moments = moments;
    scaled.base = stack.base_kind;
    scaled.ground_albedo = stack.ground_albedo;
    const auto add = [&](const Optics& optics, double optical_depth) {
        ScaledOptics medium = scale_optics(optics, moments, delta_m);
        const double scaled_depth = bounded_depth(optical_depth * medium.depth_factor);
        ForwardPeak narrow;
        if (medium.truncated > 0.0) {
            narrow = split_forward_peak(optics.chi, medium.first_cutoff);
        }
        scaled.media.push_back({optics, std::move(medium), scaled_depth, std::move(narrow)});
    };
    if (stack.base_kind == BaseKind::half_space) {
        add(stack.base, std::numeric_limits<double>::infinity());
    }
    for (const Coat& coat : stack.coats) {
        if (coat.optical_depth == 0.0) continue;
        if (is_bottomless(coat.optical_depth)) {
            scaled.media.clear();
            scaled.base = BaseKind::half_space;
        }
        add(coat.optics, coat.optical_depth);
    }
    return scaled;
}

StackSolver::StackSolver(const ScaledStack& stack, const ZenithGrid& grid,
                         const RequestedDirections& requested, const SolverOptions& options,
                         StackMemory& memory)
    : stack_(stack),
      grid_(grid),
      requested_(requested),
      options_(options),
      tolerance_(kEquationShare * options.tolerance),
      memory_(memory) {}

const Reflector& StackSolver::solve(int fourier_order, ReflectorParts parts,
                                    const Eigen::VectorXd& sky) {
    make_fourier_mode(fourier_order, stack_.moments, grid_, requested_, memory_.mode);
    const std::size_t first_coat = solve_lowest();
    bool has_sky = false;
    for (std::size_t c = first_coat; c < stack_.media.size() && memory_.reflector.physical; ++c) {
        const bool is_top = c + 1 == stack_.media.size();
        put_on_coat(c, is_top ? parts : ReflectorParts::nodes, sky);
        has_sky = is_top && options_.coat_method == CoatMethod::automatic;
    }
    if (parts == ReflectorParts::sky && !has_sky && memory_.reflector.physical) {
        memory_.reflector.sky_at_requested.noalias() = memory_.reflector.rows * sky;
        memory_.reflector.sky_at_nodes.noalias() = memory_.reflector.nodes * sky;
    }
    return memory_.reflector;
}

void StackSolver::set_medium(const ScaledMedium& medium) {
    const ScaledOptics& scaled = medium.scaled;
    memory_.medium.one_minus_albedo = scaled.one_minus_albedo;
    memory_.medium.lowest_degree = memory_.mode.fourier_order;
    memory_.medium.strengths.resize(memory_.mode.at_nodes.cols());
    for (Eigen::Index c = 0; c < memory_.medium.strengths.size(); ++c) {
        const Eigen::Index l = memory_.mode.fourier_order + c;
        memory_.medium.strengths[c] =
            l < scaled.chi.size() ? scaled.albedo * (2.0 * double(l) + 1.0) * scaled.chi[l] : 0.0;
    }
}

bool StackSolver::may_leave_out_layers() const {
    return !stack_.transmits && options_.coat_method == CoatMethod::automatic &&
           options_.half_space_method == HalfSpaceMethod::automatic;
}

std::size_t StackSolver::solve_lowest() {
    const std::size_t first_coat = stack_.base == BaseKind::half_space ? 1 : 0;
    for (std::size_t c = stack_.media.size(); c-- > first_coat && may_leave_out_layers();) {
        set_medium(stack_.media[c]);
        if (!hides_in_fourier_order(memory_.medium, stack_.media[c].scaled_optical_depth,
                                    tolerance_ * std::min(stack_.brightness, 1.0))) {
            continue;
        }
        solve_half_space(HalfSpaceMethod::automatic, memory_.medium, memory_.mode, grid_,
                         requested_, tolerance_, memory_.work, memory_.reflector);
        return c + 1;
    }
    solve_base();
    return first_coat;
}

void StackSolver::solve_base() {
    memory_.reflector.glow_at_nodes.resize(0);
    if (stack_.transmits) {
        memory_.reflector.glow_at_nodes = flux_weights(grid_);
        memory_.reflector.glow_at_requested.setOnes(requested_.mu.size());
    }
    switch (stack_.base) {
        case BaseKind::lambertian:
            lambertian_ground(stack_.ground_albedo, memory_.mode, grid_, requested_,
                              memory_.reflector);
            return;
        case BaseKind::none:
            no_reflection(grid_, requested_, memory_.reflector);
            return;
        case BaseKind::half_space:
            break;
    }
    set_medium(stack_.media.front());
    solve_half_space(options_.half_space_method, memory_.medium, memory_.mode, grid_, requested_,
                     tolerance_, memory_.work, memory_.reflector);
}

void StackSolver::put_on_coat(std::size_t index, ReflectorParts parts, const Eigen::VectorXd& sky) {
    const ScaledMedium& coat = stack_.media[index];
    set_medium(coat);
    if (options_.coat_method != CoatMethod::automatic) {
        const std::vector<ScaledMedium> below(stack_.media.begin(),
                                              stack_.media.begin() + std::ptrdiff_t(index));
        memory_.reflector = step_through_coat(
            options_.coat_method, options_.coat_substeps, coat.scaled_optical_depth, memory_.medium,
            first_order_of(below, memory_.mode, requested_), memory_.mode, grid_, requested_,
            std::move(memory_.reflector));
        return;
    }
    solve_layer(coat.scaled_optical_depth, memory_.medium, memory_.mode, grid_, requested_, parts,
                tolerance_, memory_.work, memory_.layer);
    if (!memory_.layer.physical) {
        memory_.reflector.physical = false;
        return;
    }
    std::swap(memory_.below, memory_.reflector);
    put_on(memory_.layer, memory_.below, requested_, parts, sky, memory_.work, memory_.reflector);
}

}  // namespace miebrdf::rte
