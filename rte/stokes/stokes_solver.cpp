#include "rte/stokes/stokes_solver.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "rte/math/tolerance_budget.h"
#include "rte/stack/hidden_layers.h"

namespace miebrdf::rte {
namespace {

constexpr double kHalf = std::numbers::sqrt2 / 2.0;

// From the axes of the meridian planes to I and Q: the first two rows and columns.
void turn_back(Eigen::MatrixXd& pair) {
    const Eigen::MatrixXd rows = pair.topRows(2);
    pair.row(0) = kHalf * (rows.row(0) + rows.row(1));
    pair.row(1) = kHalf * (rows.row(0) - rows.row(1));
    const Eigen::MatrixXd columns = pair.leftCols(2);
    pair.col(0) = kHalf * (columns.col(0) + columns.col(1));
    pair.col(1) = kHalf * (columns.col(0) - columns.col(1));
}

// Whether b2 makes a block's equations unsymmetric.
bool is_coupled(const StokesBlock& block) {
    return block.size() > 1 && block.back() == StokesComponent::V;
}

}  // namespace

StokesSolver::StokesSolver(const ScaledStack& stack, const StackGrids& grids,
                           const RequestedDirections& requested, int components,
                           const SolverOptions& options, StokesMemory& memory)
    : stack_(stack),
      grids_(grids),
      components_(components),
      has_fresnel_(stack.refracts() || stack.has_mirrors()),
      tolerance_(kEquationShare * options.tolerance),
      memory_(memory) {
    for (const ScaledMedium& medium : stack.media) {
        strengths_.push_back(matrix_strengths(medium));
        couples_V_ = couples_V_ || strengths_.back().has_b2();
    }
    // Total reflection and metals turn U into V, whatever the media do.
    couples_V_ = couples_V_ || (components == 4 && has_fresnel_);
    for (const double index : grids.indices()) {
        RequestedDirections inside = refracted(requested, index);
        if (stack.has_mirrors()) inside = with_cosines_beside(std::move(inside));
        Rows& all = rows_.emplace_back();
        for (int rows = 1; rows <= 4; ++rows) {
            all.grids[std::size_t(rows)] = repeated(grids.of(index), rows);
            all.requested[std::size_t(rows)] = repeated(inside, rows);
        }
    }
    memory_.tables.resize(rows_.size());
}

std::size_t StokesSolver::place_of(double index) const {
    const auto& indices = grids_.indices();
    return std::size_t(std::find(indices.begin(), indices.end(), index) - indices.begin());
}

const StokesOrder& StokesSolver::solve(int fourier_order) {
    start(fourier_order);
    for (const StokesBlock& block : stokes_blocks(fourier_order, components_, couples_V_)) {
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
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        StokesTables& tables = memory_.tables[k];
        tables.along_axes = has_fresnel_;
        make_stokes_tables(fourier_order, stack_.moments, rows_[k].grids[1], rows_[k].requested[1],
                           tables);
    }
    order_ = {};
    const RequestedDirections& requested = rows_.front().requested[1];
    order_.multiple.setZero(Eigen::Index(requested.out.size()) * components_,
                            Eigen::Index(requested.in.size()) * components_);
}

ReflectorParts StokesSolver::parts_of(int fourier_order, const StokesBlock& block) const {
    const bool has_energy = fourier_order == 0 && block.front() == StokesComponent::I;
    return has_energy ? ReflectorParts::sky : ReflectorParts::pairs;
}

void StokesSolver::solve_block(const StokesBlock& block) {
    const ReflectorParts parts = parts_of(memory_.tables.front().fourier_order, block);
    const bool has_boundary = stack_.top_index != 1.0;
    const std::size_t first_coat = solve_lowest(block);
    sky_ = flux_weights(grid_of(1.0, block.size()));
    memory_.mode.keep_intensity(sky_);
    Reflector& reflector = memory_.reflector;
    bool has_sky = has_boundary;
    double index = first_coat > 0 ? stack_.media[first_coat - 1].index : stack_.ground_index;
    for (std::size_t c = first_coat; c < stack_.media.size() && reflector.physical; ++c) {
        const bool is_top = c + 1 == stack_.media.size() && !has_boundary;
        const double next = stack_.media[c].index;
        if (next != index) put_on_boundary(index, next, block, ReflectorParts::nodes);
        index = next;
        if (!reflector.physical) break;
        put_on_coat(c, block, is_top ? parts : ReflectorParts::nodes);
        has_sky = has_boundary || is_top;
    }
    if (has_boundary && reflector.physical) put_on_boundary(index, 1.0, block, parts);
    order_.physical = order_.physical && reflector.physical;
    if (!reflector.physical) return;
    if (parts == ReflectorParts::sky && !has_sky) {
        reflector.sky_at_requested.noalias() = reflector.rows * sky_;
        reflector.sky_at_nodes.noalias() = reflector.nodes * sky_;
    }
    keep(block);
    if (parts == ReflectorParts::sky) keep_albedos();
}

void StokesSolver::put_on_boundary(double below, double above, const StokesBlock& block,
                                   ReflectorParts parts) {
    const FresnelReflections matrices(below, above, grid_of(below, 1), grid_of(above, 1),
                                      requested_of(below, 1));
    std::swap(memory_.below, memory_.reflector);
    if (is_coupled(block)) {
        put_boundary_on_coupled(matrices, block, requested_of(below, block.size()), parts,
                                memory_.below, memory_.reflector);
        return;
    }
    put_boundary_on(polarised_boundary(matrices, block), memory_.below,
                    requested_of(below, block.size()), parts, sky_, memory_.work,
                    memory_.reflector);
}

void StokesSolver::set_medium(const StokesBlock& block, std::size_t index) {
    const double n = stack_.media[index].index;
    memory_.medium.one_minus_albedo = stack_.media[index].scaled.one_minus_albedo;
    make_block_mode(tables_of(n), block, strengths_[index], grid_of(n, block.size()),
                    requested_of(n, block.size()), memory_.mode, memory_.medium);
}

std::size_t StokesSolver::solve_lowest(const StokesBlock& block) {
    const std::size_t first_coat = stack_.base == BaseKind::half_space ? 1 : 0;
    const double allowed = tolerance_ * std::min(stack_.brightness, 1.0);
    for (std::size_t c = stack_.media.size(); c-- > first_coat && !stack_.transmits;) {
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
    const double n = stack_.media[index].index;
    const ZenithGrid& grid = grid_of(n, block.size());
    const RequestedDirections& requested = requested_of(n, block.size());
    if (is_coupled(block)) {
        solve_coupled_half_space(tables_of(n), block, strengths_[index], memory_.mode,
                                 memory_.medium, grid_of(n, 1), requested_of(n, 1), grid, requested,
                                 tolerance_, memory_.coupled, memory_.reflector);
        return;
    }
    solve_half_space(HalfSpaceMethod::automatic, memory_.medium, memory_.mode, grid, requested,
                     tolerance_, memory_.work, memory_.reflector);
}

void StokesSolver::solve_base(const StokesBlock& block) {
    if (stack_.base != BaseKind::half_space) {
        solve_ground(block);
        return;
    }
    set_medium(block, 0);
    solve_medium_as_half_space(0, block);
}

void StokesSolver::solve_ground(const StokesBlock& block) {
    const double n = stack_.ground_index;
    const ZenithGrid& grid = grid_of(n, block.size());
    const RequestedDirections& requested = requested_of(n, block.size());
    FourierMode& mode = memory_.mode;
    Reflector& ground = memory_.reflector;
    make_block_mode(tables_of(n), block, {}, grid, requested, mode, memory_.medium);
    if (stack_.base == BaseKind::lambertian) {
        lambertian_ground(stack_.ground_albedo, mode, grid, requested, ground);
    } else if (stack_.base == BaseKind::mirror && is_coupled(block)) {
        coupled_mirror(n, stack_.mirror_index, grid_of(n, 1), requested_of(n, 1), requested, block,
                       ground);
    } else if (stack_.base == BaseKind::mirror) {
        mirror_ground(polarised_mirror(n, stack_.mirror_index, grid_of(n, 1).mu, block),
                      polarised_mirror(n, stack_.mirror_index, requested_of(n, 1).mu, block),
                      requested, ground);
    } else {
        no_reflection(grid, requested, ground);
    }
    ground.has_glow = stack_.transmits;
    if (!stack_.transmits) return;
    ground.glow_at_nodes = flux_weights(grid);
    mode.keep_intensity(ground.glow_at_nodes);
    ground.glow_at_requested.setOnes(requested.mu.size());
    mode.keep_intensity(ground.glow_at_requested);
    if (stack_.base == BaseKind::mirror) {  // what it does not reflect passes it
        ground.glow_at_nodes -= ground.nodes * ground.glow_at_nodes;
        ground.glow_at_requested -= ground.specular.cwiseProduct(ground.glow_at_requested);
    }
}

void StokesSolver::put_on_coat(std::size_t index, const StokesBlock& block, ReflectorParts parts) {
    set_medium(block, index);
    const double n = stack_.media[index].index;
    const RequestedDirections& requested = requested_of(n, block.size());
    if (is_coupled(block)) {
        solve_coupled_layer(stack_.media[index].scaled_optical_depth, tables_of(n), block,
                            strengths_[index], memory_.mode, memory_.medium, grid_of(n, 1),
                            requested_of(n, 1), requested, tolerance_, memory_.coupled,
                            memory_.layer);
        memory_.reflector.physical = memory_.layer.physical;
        if (!memory_.layer.physical) return;
        std::swap(memory_.below, memory_.reflector);
        put_on_coupled(memory_.layer, memory_.below, requested, int(block.size()), parts,
                       memory_.reflector);
        return;
    }
    solve_layer(stack_.media[index].scaled_optical_depth, memory_.medium, memory_.mode,
                grid_of(n, block.size()), requested, parts, tolerance_, memory_.work,
                memory_.layer);
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
    const bool turns = has_fresnel_ && block.front() == StokesComponent::I;
    Eigen::MatrixXd pair(c, c);
    for (Eigen::Index i = 0; i < in; ++i) {
        for (Eigen::Index o = 0; o < out; ++o) {
            pair = reflector.multiple.block(o * c, i * c, c, c);
            if (turns) turn_back(pair);
            for (Eigen::Index column = 0; column < c; ++column) {
                const auto to_column = Eigen::Index(block[std::size_t(column)]);
                const double sign = to_column < 2 ? 1.0 : -1.0;
                for (Eigen::Index row = 0; row < c; ++row) {
                    const auto to_row = Eigen::Index(block[std::size_t(row)]);
                    order_.multiple(o * components_ + to_row, i * components_ + to_column) =
                        sign * pair(row, column);
                }
            }
        }
    }
}

// By reciprocity from the light under a uniform sky. 2 sum_q w_q mu_q R(mu, mu_q) = (2 R D) D.
void StokesSolver::keep_albedos() {
    const Reflector& reflector = memory_.reflector;
    const Eigen::Vector2d I = has_fresnel_ ? Eigen::Vector2d(kHalf, kHalf) : Eigen::Vector2d(1, 0);
    const Eigen::Vector2d Q = has_fresnel_ ? Eigen::Vector2d(kHalf, -kHalf) : Eigen::Vector2d(0, 1);
    const bool has_mirror = reflector.specular.size() > 0;
    const auto along = [](const Eigen::VectorXd& rows, int in, const Eigen::Vector2d& axis) {
        return axis.dot(rows.segment(2 * in, 2));
    };
    for (const int in : rows_.front().requested[1].in) {
        double albedo = along(reflector.sky_at_requested, in, I);
        double polarised = along(reflector.sky_at_requested, in, Q);
        if (has_mirror) {
            const Eigen::VectorXd& s = reflector.specular;
            albedo += 0.5 * (s[2 * in] + s[2 * in + 1]);
            polarised += 0.5 * (s[2 * in] - s[2 * in + 1]);
        }
        order_.plane_albedo.push_back(albedo);
        order_.polarised_plane_albedo.push_back(polarised);
    }
    const double flux = sky_.squaredNorm();
    order_.spherical_albedo = sky_.dot(reflector.sky_at_nodes) / flux;
    if (!stack_.transmits) return;
    for (const int in : rows_.front().requested[1].in)
        order_.transmittance.push_back(along(reflector.glow_at_requested, in, I));
    order_.transmittance.push_back(sky_.dot(reflector.glow_at_nodes) / flux);
}

}  // namespace miebrdf::rte
