#include "rte/stack/stack_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rte/half_space/solved_half_spaces.h"

namespace miebrdf::rte {
namespace {

std::size_t bytes_of_mode(int columns, const ZenithGrid& grid,
                          const RequestedDirections& requested) {
    const auto nodes = 2 * std::size_t(grid.size());
    const std::size_t cosines =
        std::size_t(requested.mu.size()) + requested.out.size() + requested.in.size();
    return sizeof(double) * (nodes + cosines) * std::size_t(columns);
}

bool are_same(const RequestedDirections& a, const RequestedDirections& b) {
    return a.mu.size() == b.mu.size() && a.mu == b.mu && a.out == b.out && a.in == b.in;
}

// What the equations of one order are solved to, of the tolerance of the whole.
constexpr double share_of_equations = 0.01;

}  // namespace

const ZenithGrid& SharedTables::grid(GridKind kind, int count) {
    const std::pair key(kind, count);
    const auto known = grids_.find(key);
    if (known != grids_.end()) return known->second;
    return grids_.emplace(key, make_zenith_grid(kind, count)).first->second;
}

bool SharedTables::owns(const ZenithGrid& grid) const {
    return std::any_of(grids_.begin(), grids_.end(),
                       [&](const auto& entry) { return &entry.second == &grid; });
}

const PhaseMode& SharedTables::mode(int order, int degrees, const ZenithGrid& grid,
                                    const RequestedDirections& requested) {
    if (!are_same(requested, requested_)) {
        modes_.clear();
        bytes_ = 0;
        requested_ = requested;
    }
    const Key key{&grid, order, degrees};
    const auto known = modes_.find(key);
    if (known != modes_.end()) return known->second;
    const std::size_t bytes = bytes_of_mode(degrees - order, grid, requested);
    const bool keep = owns(grid) && bytes_ + bytes <= most_bytes_;
    PhaseMode& mode = keep ? modes_[key] : not_kept_;
    if (keep) bytes_ += bytes;
    make_phase_mode(order, degrees, grid, requested, mode);
    return mode;
}

StackSolver::StackSolver(const ScaledStack& stack, const ZenithGrid& grid,
                         const RequestedDirections& requested, const SolverOptions& options,
                         StackMemory& memory)
    : stack_(stack),
      grid_(grid),
      requested_(requested),
      options_(options),
      tolerance_(share_of_equations * options.tolerance),
      memory_(memory) {}

const Reflector& StackSolver::solve(int order, ReflectorParts parts, const Eigen::VectorXd& sky) {
    mode_ = &memory_.tables.mode(order, stack_.moments, grid_, requested_);
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
    memory_.medium.lowest_degree = mode_->order;
    memory_.medium.strengths.resize(mode_->at_nodes.cols());
    for (Eigen::Index c = 0; c < memory_.medium.strengths.size(); ++c) {
        const Eigen::Index l = mode_->order + c;
        memory_.medium.strengths[c] =
            l < scaled.chi.size() ? scaled.albedo * (2.0 * double(l) + 1.0) * scaled.chi[l] : 0.0;
    }
}

bool StackSolver::hides_what_is_below(const ScaledMedium& coat) {
    if (options_.coat_method != CoatMethod::automatic ||
        options_.half_space_method != HalfSpaceMethod::automatic) {
        return false;
    }
    // With q = strongest(): U and V are at least (1 - q) M^-1, so that nothing decays more slowly
    // than exp(-(1 - q) tau). Down and up, with some room for what the coat reflects itself.
    constexpr double room = 4.0;
    set_medium(coat);
    const double slowest = 1.0 - memory_.medium.strongest();
    return slowest > 0.0 && room * std::exp(-2.0 * slowest * coat.optical_depth) <= tolerance_;
}

std::size_t StackSolver::solve_lowest() {
    const std::size_t first_coat = stack_.base == BaseKind::half_space ? 1 : 0;
    for (std::size_t c = stack_.media.size(); c-- > first_coat;) {
        if (!hides_what_is_below(stack_.media[c])) continue;
        solve_half_space(HalfSpaceMethod::automatic, memory_.medium, *mode_, grid_, requested_,
                         tolerance_, memory_.work, memory_.reflector);
        return c + 1;
    }
    solve_base();
    return first_coat;
}

void StackSolver::solve_base() {
    switch (stack_.base) {
        case BaseKind::lambertian:
            lambertian_ground(stack_.ground_albedo, *mode_, grid_, requested_, memory_.reflector);
            return;
        case BaseKind::none:
            no_reflection(grid_, requested_, memory_.reflector);
            return;
        case BaseKind::half_space:
            break;
    }
    set_medium(stack_.media.front());
    const double tolerance =
        options_.half_space_tolerance > 0.0 ? options_.half_space_tolerance : tolerance_;
    if (options_.half_spaces != nullptr) {
        options_.half_spaces->solve(
            {options_.half_space_method, memory_.medium, *mode_, grid_, requested_, tolerance},
            memory_.work, memory_.reflector);
        return;
    }
    solve_half_space(options_.half_space_method, memory_.medium, *mode_, grid_, requested_,
                     tolerance, memory_.work, memory_.reflector);
}

void StackSolver::put_on_coat(std::size_t index, ReflectorParts parts, const Eigen::VectorXd& sky) {
    const ScaledMedium& coat = stack_.media[index];
    set_medium(coat);
    if (options_.coat_method != CoatMethod::automatic) {
        const std::vector<ScaledMedium> below(stack_.media.begin(),
                                              stack_.media.begin() + std::ptrdiff_t(index));
        memory_.reflector =
            step_through_coat(options_.coat_method, options_.coat_substeps, coat.optical_depth,
                              memory_.medium, first_order_of(below, *mode_, requested_), *mode_,
                              grid_, requested_, std::move(memory_.reflector));
        return;
    }
    OrderWork& work = memory_.work;
    solve_layer(coat.optical_depth, memory_.medium, *mode_, grid_, requested_, parts, tolerance_,
                work, memory_.layer);
    if (!memory_.layer.physical) {
        memory_.reflector.physical = false;
        return;
    }
    std::swap(memory_.below, memory_.reflector);
    put_on(memory_.layer, memory_.below, requested_, parts, sky, work, memory_.reflector);
}

}  // namespace miebrdf::rte
