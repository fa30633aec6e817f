#include "rte/stokes/stokes_solver.h"

#include <algorithm>
#include <utility>

#include "rte/math/tolerance_budget.h"
#include "rte/stack/hidden_layers.h"

namespace miebrdf::rte {
namespace {

// Whether b2 makes a block's equations unsymmetric.
bool is_coupled(const StokesBlock& block) {
    return block.size() > 1 && block.back() == StokesComponent::V;
}

}  // namespace

StokesSolver::StokesSolver(const ScaledStack& stack, const ZenithGrid& grid,
                           const RequestedDirections& requested, int components,
                           const SolverOptions& options, StokesMemory& memory)
    : stack_(stack),
      components_(components),
      tolerance_(kEquationShare * options.tolerance),
      memory_(memory) {
    for (const ScaledMedium& medium : stack.media) {
        strengths_.push_back(matrix_strengths(medium));
        has_b2_ = has_b2_ || strengths_.back().has_b2();
    }
    for (int rows = 1; rows <= 4; ++rows) {
        grids_[std::size_t(rows)] = repeated(grid, rows);
        requested_[std::size_t(rows)] = repeated(requested, rows);
    }
}

const StokesOrder& StokesSolver::solve(int fourier_order) {
    start(fourier_order);
    for (const StokesBlock& block : stokes_blocks(fourier_order, components_, has_b2_)) {
        solve_block(block);
        if (!order_.physical) break;
    }
    return order_;
}

const StokesOrder& StokesSolver::solve_albedos() {
    start(0);
    solve_block(stokes_blocks(0, components_, false).front());
    return order_;
}

void StokesSolver::start(int fourier_order) {
    make_stokes_tables(fourier_order, stack_.moments, grids_[1], requested_[1], memory_.tables);
    order_ = {};
    order_.multiple.setZero(Eigen::Index(requested_[1].out.size()) * components_,
                            Eigen::Index(requested_[1].in.size()) * components_);
}

ReflectorParts StokesSolver::parts_of(const StokesBlock& block) const {
    const bool has_energy =
        memory_.tables.fourier_order == 0 && block.front() == StokesComponent::I;
    return has_energy ? ReflectorParts::sky : ReflectorParts::pairs;
}

void StokesSolver::solve_block(const StokesBlock& block) {
    const ReflectorParts parts = parts_of(block);
    const std::size_t first_coat = solve_lowest(block);
    sky_ = flux_weights(grid_of(block));
    memory_.mode.keep_intensity(sky_);
    Reflector& reflector = memory_.reflector;
    bool has_sky = false;
    for (std::size_t c = first_coat; c < stack_.media.size() && reflector.physical; ++c) {
        const bool is_top = c + 1 == stack_.media.size();
        put_on_coat(c, block, is_top ? parts : ReflectorParts::nodes);
        has_sky = is_top;
    }
    order_.physical = order_.physical && reflector.physical;
    if (!reflector.physical) return;
    if (parts == ReflectorParts::sky && !has_sky) {
        reflector.sky_at_requested.noalias() = reflector.rows * sky_;
        reflector.sky_at_nodes.noalias() = reflector.nodes * sky_;
    }
    keep(block);
    if (parts == ReflectorParts::sky) keep_albedos();
}

void StokesSolver::set_medium(const StokesBlock& block, std::size_t index) {
    memory_.medium.one_minus_albedo = stack_.media[index].scaled.one_minus_albedo;
    make_block_mode(memory_.tables, block, strengths_[index], grid_of(block), requested_of(block),
                    memory_.mode, memory_.medium);
}

std::size_t StokesSolver::solve_lowest(const StokesBlock& block) {
    const std::size_t first_coat = stack_.base == BaseKind::half_space ? 1 : 0;
    const double allowed = tolerance_ * std::min(stack_.brightness, 1.0);
    for (std::size_t c = stack_.media.size(); c-- > first_coat;) {
        const double depth = stack_.media[c].scaled_optical_depth;
        if (!hides_in_fourier_order({}, depth, allowed)) continue;  // whatever it scatters
        set_medium(block, c);
        if (!hides_in_fourier_order(memory_.medium, depth, allowed)) continue;
        solve_medium_as_half_space(c, block);
        return c + 1;
    }
    solve_base(block);
    return first_coat;
}

void StokesSolver::solve_medium_as_half_space(std::size_t index, const StokesBlock& block) {
    if (is_coupled(block)) {
        solve_coupled_half_space(memory_.tables, block, strengths_[index], memory_.mode,
                                 memory_.medium, grids_[1], requested_[1], grid_of(block),
                                 requested_of(block), tolerance_, memory_.coupled,
                                 memory_.reflector);
        return;
    }
    solve_half_space(HalfSpaceMethod::automatic, memory_.medium, memory_.mode, grid_of(block),
                     requested_of(block), tolerance_, memory_.work, memory_.reflector);
}

void StokesSolver::solve_base(const StokesBlock& block) {
    memory_.reflector.glow_at_nodes.resize(0);
    if (stack_.base == BaseKind::half_space) {
        set_medium(block, 0);
        solve_medium_as_half_space(0, block);
        return;
    }
    make_block_mode(memory_.tables, block, {}, grid_of(block), requested_of(block), memory_.mode,
                    memory_.medium);
    if (stack_.base == BaseKind::lambertian) {
        lambertian_ground(stack_.ground_albedo, memory_.mode, grid_of(block), requested_of(block),
                          memory_.reflector);
    } else {
        no_reflection(grid_of(block), requested_of(block), memory_.reflector);
    }
}

void StokesSolver::put_on_coat(std::size_t index, const StokesBlock& block, ReflectorParts parts) {
    set_medium(block, index);
    const RequestedDirections& requested = requested_of(block);
    if (is_coupled(block)) {
        solve_coupled_layer(stack_.media[index].scaled_optical_depth, memory_.tables, block,
                            strengths_[index], memory_.mode, memory_.medium, grids_[1],
                            requested_[1], requested, tolerance_, memory_.coupled, memory_.layer);
        memory_.reflector.physical = memory_.layer.physical;
        if (!memory_.layer.physical) return;
        std::swap(memory_.below, memory_.reflector);
        put_on_coupled(memory_.layer, memory_.below, requested, int(block.size()), parts,
                       memory_.reflector);
        return;
    }
    solve_layer(stack_.media[index].scaled_optical_depth, memory_.medium, memory_.mode,
                grid_of(block), requested, parts, tolerance_, memory_.work, memory_.layer);
    if (!memory_.layer.physical) {
        memory_.reflector.physical = false;
        return;
    }
    std::swap(memory_.below, memory_.reflector);
    put_on(memory_.layer, memory_.below, requested, parts, sky_, memory_.work, memory_.reflector);
}

// The solvers answer with upward light for downward light whose U and V have the opposite sign:
// R = X D4.
void StokesSolver::keep(const StokesBlock& block) {
    const Reflector& reflector = memory_.reflector;
    order_.iterations = std::max(order_.iterations, reflector.iterations);
    order_.residual = std::max(order_.residual, reflector.residual);
    order_.converged = order_.converged && reflector.converged;
    const auto c = Eigen::Index(block.size());
    const Eigen::Index out = reflector.multiple.rows() / c, in = reflector.multiple.cols() / c;
    for (Eigen::Index column = 0; column < c; ++column) {
        const auto to_column = Eigen::Index(block[std::size_t(column)]);
        const double sign = to_column < 2 ? 1.0 : -1.0;
        for (Eigen::Index row = 0; row < c; ++row) {
            const auto to_row = Eigen::Index(block[std::size_t(row)]);
            for (Eigen::Index i = 0; i < in; ++i) {
                for (Eigen::Index o = 0; o < out; ++o) {
                    order_.multiple(o * components_ + to_row, i * components_ + to_column) =
                        sign * reflector.multiple(o * c + row, i * c + column);
                }
            }
        }
    }
}

// By reciprocity from the light under a uniform sky. 2 sum_q w_q mu_q R(mu, mu_q) = (2 R D) D.
void StokesSolver::keep_albedos() {
    const Reflector& reflector = memory_.reflector;
    for (const int in : requested_[1].in) {
        order_.plane_albedo.push_back(reflector.sky_at_requested[2 * in]);
        order_.polarised_plane_albedo.push_back(reflector.sky_at_requested[2 * in + 1]);
    }
    order_.spherical_albedo = sky_.dot(reflector.sky_at_nodes) / sky_.squaredNorm();
}

}  // namespace miebrdf::rte
