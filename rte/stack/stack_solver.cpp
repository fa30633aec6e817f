#include "rte/stack/stack_solver.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "rte/boundary/rough_top.h"
#include "rte/first_order/first_order.h"
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

}  // namespace

void StackOrder::clear() {
    plane_albedo.clear();
    polarised_plane_albedo.clear();
    transmittance.clear();
    spherical_albedo = residual = 0.0;
    iterations = 0;
    converged = physical = true;
}

StackSolver::StackSolver(const ScaledStack& stack, const StackGrids& grids,
                         const RequestedDirections& requested, int components,
                         const SolverOptions& options, StackMemory& memory)
    : stack_(stack),
      grids_(grids),
      asked_(requested),
      options_(options),
      components_(components),
      tolerance_(kEquationShare * options.tolerance),
      has_fresnel_(stack.refracts() || stack.has_mirrors()),
      memory_(memory) {
    memory_.brightness.assign(stack.media.size(), 0.0);
    const bool has_mirrors = stack.has_mirrors();
    const bool is_rough = stack.boundary && stack.boundary->is_rough();
    const std::size_t count = grids.indices().size();
    memory_.requested.resize(count);
    for (std::size_t k = 0; k < count; ++k) {
        // No beam enters through a rough boundary: what lies below is met from its nodes alone.
        RequestedDirections& own = memory_.requested[k];
        if (is_rough) {
            own = {};
        } else {
            refract(requested, grids.indices()[k], own);
        }
        if (has_mirrors) own = with_cosines_beside(own);
    }
    memory_.tables.resize(count);
    memory_.modes.resize(count);
    memory_.reflectors.resize(count);
    if (is_rough) {
        if (stack.has_mirrors()) {
            unscattered_ = grids.of(stack.top_index).mu.unaryExpr([&](double mu) {
                return unscattered_return(stack, mu);
            });
        }
        rough_top_ = std::make_unique<RoughTop>(stack.top_index, *stack.boundary,
                                                grids.refraction().within(stack.top_index),
                                                requested, unscattered_);
    }
    if (components == 1) return;
    for (const ScaledMedium& medium : stack.media) {
        strengths_.push_back(matrix_strengths(medium));
        couples_V_ = couples_V_ || strengths_.back().has_b2();
    }
    // Total reflection and metals turn U into V, whatever the media do.
    couples_V_ = couples_V_ || (components == 4 && has_fresnel_);
    for (std::size_t k = 0; k < count; ++k) {
        Rows& all = rows_.emplace_back();
        for (int rows = 1; rows <= 4; ++rows) {
            all.grids[std::size_t(rows)] = repeated(grids.of(grids.indices()[k]), rows);
            all.requested[std::size_t(rows)] = repeated(memory_.requested[k], rows);
        }
    }
    memory_.stokes_tables.resize(count);
}

StackSolver::~StackSolver() = default;

int StackSolver::fourier_orders() const {
    return unscattered_.size() > 0 ? std::max(kMostBoundaryOrders, stack_.moments) : stack_.moments;
}

const StackOrder& StackSolver::solve(int fourier_order) {
    start(fourier_order);
    if (components_ == 1) {
        static const StokesBlock number{StokesComponent::I};
        solve_block(number);
    } else {
        memory_.order.multiple.setZero(Eigen::Index(asked_.out.size()) * components_,
                                       Eigen::Index(asked_.in.size()) * components_);
        for (const StokesBlock& block : stokes_blocks(fourier_order, components_, couples_V_)) {
            solve_block(block);
            if (!memory_.order.physical) break;
        }
    }
    return memory_.order;
}

const StackOrder& StackSolver::solve_albedos(const Eigen::VectorXd& let_in,
                                             const Eigen::VectorXd& let_out) {
    static const StokesBlock number{StokesComponent::I},
        linear{StokesComponent::I, StokesComponent::Q};
    start(0);
    solve_block(components_ == 1 ? number : linear, &let_in, &let_out);
    return memory_.order;
}

void StackSolver::start(int fourier_order) {
    fourier_order_ = fourier_order;
    memory_.order.clear();
    if (fourier_order >= stack_.moments) return;  // nothing is scattered in this order
    const std::vector<double>& indices = grids_.indices();
    for (std::size_t k = 0; k < indices.size(); ++k) {
        const ZenithGrid& grid = grids_.of(indices[k]);
        if (components_ == 1) {
            memory_.modes[k] =
                &memory_.tables[k].find(fourier_order, stack_.moments, grid, memory_.requested[k]);
            continue;
        }
        StokesTables& tables = memory_.stokes_tables[k];
        tables.along_axes = has_fresnel_;
        make_stokes_tables(fourier_order, stack_.moments, grid, memory_.requested[k], tables);
    }
}

void StackSolver::solve_block(const StokesBlock& block, const Eigen::VectorXd* let_in,
                              const Eigen::VectorXd* let_out) {
    block_ = &block;
    const bool has_energy = fourier_order_ == 0 && block.front() == StokesComponent::I;
    const ReflectorParts parts = has_energy ? ReflectorParts::sky : ReflectorParts::pairs;
    const bool has_boundary = stack_.top_index != 1.0;
    const bool scatters = fourier_order_ < stack_.moments;
    const std::size_t first_coat = scatters ? solve_lowest() : solve_mirrors();
    if (has_energy) find_skies(let_in, let_out);
    bool has_sky = has_boundary;
    double index = first_coat > 0 ? stack_.media[first_coat - 1].index : stack_.ground_index;
    for (std::size_t c = first_coat; c < stack_.media.size() && reflector_->physical; ++c) {
        const bool is_top = c + 1 == stack_.media.size() && !has_boundary;
        const double next = stack_.media[c].index;
        if (next != index) put_on_boundary(index, next, ReflectorParts::nodes);
        index = next;
        if (!reflector_->physical) break;
        if (stack_.media[c].scaled_optical_depth == 0.0) continue;  // its surfaces are all it has
        put_on_coat(c, is_top ? parts : ReflectorParts::nodes);
        has_sky = has_boundary || (is_top && options_.coat_method == CoatMethod::automatic);
    }
    if (has_boundary && reflector_->physical) put_on_top(parts);
    StackOrder& order = memory_.order;
    order.physical = order.physical && reflector_->physical;
    if (!reflector_->physical) return;
    order.iterations = std::max(order.iterations, reflector_->iterations);
    order.residual = std::max(order.residual, reflector_->residual);
    order.converged = order.converged && reflector_->converged;
    if (has_energy && !has_sky) {
        reflector_->sky_at_requested.noalias() = reflector_->rows * memory_.sky;
        reflector_->sky_at_nodes.noalias() = reflector_->nodes * memory_.sky;
    }
    if (has_energy) keep_albedos();
    keep_pairs();
}

// A sky looks down with what light from there counts on its way out: reciprocity.
void StackSolver::find_skies(const Eigen::VectorXd* let_in, const Eigen::VectorXd* let_out) {
    const ZenithGrid& nodes = grids_.top();
    Eigen::VectorXd& D = memory_.uniform;
    memory_.let_in = (nodes.weights.array() * nodes.mu.array()).sqrt();
    spread_over_rows(memory_.let_in, D);
    if (let_in == nullptr) {
        memory_.let_in = memory_.sky = D;
        return;
    }
    spread_over_rows(*let_in, memory_.let_in);
    spread_over_rows(*let_out, memory_.sky);
}

void StackSolver::spread_over_rows(const Eigen::VectorXd& at_nodes, Eigen::VectorXd& rows) const {
    const auto c = Eigen::Index(block_->size());
    rows.resize(at_nodes.size() * c);
    for (Eigen::Index r = 0; r < rows.size(); ++r) rows[r] = at_nodes[r / c];
    mode_of(1.0).keep_intensity(rows);
}

bool StackSolver::is_coupled() const {
    return block_->size() > 1 && block_->back() == StokesComponent::V;
}

// The next solution goes here, not on what has been solved so far.
Reflector& StackSolver::free_reflector(double index) {
    auto& [one, other] = memory_.reflectors[place_of(index)];
    return reflector_ == &one ? other : one;
}

std::size_t StackSolver::place_of(double index) const {
    const auto& indices = grids_.indices();
    return std::size_t(std::find(indices.begin(), indices.end(), index) - indices.begin());
}

const FourierMode& StackSolver::mode_of(double index) const {
    return components_ == 1 ? *memory_.modes[place_of(index)] : memory_.stokes_mode;
}

const ZenithGrid& StackSolver::grid_of(double index) const {
    return components_ == 1 ? grids_.of(index) : rows_[place_of(index)].grids[block_->size()];
}

const RequestedDirections& StackSolver::requested_in(double index) const {
    return components_ == 1 ? memory_.requested[place_of(index)]
                            : rows_[place_of(index)].requested[block_->size()];
}

void StackSolver::put_on_top(ReflectorParts parts) {
    if (!rough_top_) {
        put_on_boundary(stack_.top_index, 1.0, parts);
        return;
    }
    Reflector& result = free_reflector(1.0);
    rough_top_->put_on(fourier_order_, *reflector_, parts, result);
    reflector_ = &result;
}

// Reflectances are the same in all Fourier orders, and in stacks of the same indices.
const SmoothBoundary& StackSolver::boundary_between(double below, double above) {
    constexpr std::size_t most = 8;
    const Eigen::VectorXd& nodes = grids_.of(below).mu;
    const RequestedDirections& requested = requested_in(below);
    const auto alike = [](const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
        return a.size() == b.size() && a == b;
    };
    for (const KnownBoundary& known : memory_.boundaries) {
        const SmoothBoundary& boundary = known.boundary;
        if (boundary.index_below == below && boundary.index_above == above &&
            boundary.nodes_above == grids_.refraction().nodes_below(above) &&
            alike(known.nodes, nodes) && alike(known.requested, requested.mu)) {
            return boundary;
        }
    }
    if (memory_.boundaries.size() == most) memory_.boundaries.erase(memory_.boundaries.begin());
    memory_.boundaries.push_back(
        {SmoothBoundary(below, above, grids_.refraction(), requested), nodes, requested.mu});
    return memory_.boundaries.back().boundary;
}

void StackSolver::put_on_boundary(double below, double above, ReflectorParts parts) {
    Reflector& result = free_reflector(above);
    if (components_ == 1) {
        put_boundary_on(boundary_between(below, above), *reflector_, requested_in(below), parts,
                        memory_.sky, memory_.work, result);
    } else {
        const FresnelReflections matrices(below, above, nodes_of(below), nodes_of(above),
                                          cosines_in(below));
        if (is_coupled()) {
            put_boundary_on_coupled(matrices, *block_, requested_in(below), parts, *reflector_,
                                    result);
        } else {
            put_boundary_on(polarised_boundary(matrices, *block_), *reflector_, requested_in(below),
                            parts, memory_.sky, memory_.work, result);
        }
    }
    reflector_ = &result;
}

void StackSolver::set_medium(std::size_t medium) {
    const ScaledMedium& of_stack = stack_.media[medium];
    FourierMedium& seen = memory_.medium;
    seen.one_minus_albedo = of_stack.scaled.one_minus_albedo;
    seen.brightness = fourier_order_ > 0 ? memory_.brightness[medium] : 0.0;
    if (components_ > 1) {
        make_block_mode(stokes_tables_of(of_stack.index), *block_, strengths_[medium],
                        grid_of(of_stack.index), requested_in(of_stack.index), memory_.stokes_mode,
                        seen);
        return;
    }
    const ScaledOptics& scaled = of_stack.scaled;
    seen.lowest_degree = fourier_order_;
    seen.degrees.clear();
    seen.strengths.resize(mode_of(of_stack.index).at_nodes.cols());
    for (Eigen::Index c = 0; c < seen.strengths.size(); ++c) {
        const Eigen::Index l = fourier_order_ + c;
        seen.strengths[c] =
            l < scaled.chi.size() ? scaled.albedo * (2.0 * double(l) + 1.0) * scaled.chi[l] : 0.0;
    }
}

bool StackSolver::may_leave_out_layers() const {
    return !stack_.transmits && options_.coat_method == CoatMethod::automatic &&
           options_.half_space_method == HalfSpaceMethod::automatic;
}

std::size_t StackSolver::solve_lowest() {
    const std::size_t first_coat = stack_.base == BaseKind::half_space ? 1 : 0;
    const double allowed = tolerance_ * std::min(stack_.brightness, 1.0);
    for (std::size_t c = stack_.media.size(); c-- > first_coat && may_leave_out_layers();) {
        const double depth = stack_.media[c].scaled_optical_depth;
        if (!hides_in_fourier_order({}, depth, allowed)) continue;  // whatever it scatters
        set_medium(c);
        if (!hides_in_fourier_order(memory_.medium, depth, allowed)) continue;
        solve_as_half_space(HalfSpaceMethod::automatic, c);
        return c + 1;
    }
    solve_base();
    return first_coat;
}

std::size_t StackSolver::solve_mirrors() {
    Reflector& mirrors = free_reflector(stack_.top_index);
    mirrors = {};
    mirrors.nodes = unscattered_.asDiagonal();
    mirrors.physical = true;
    reflector_ = &mirrors;
    return stack_.media.size();
}

void StackSolver::solve_base() {
    if (stack_.base != BaseKind::half_space) {
        solve_ground();
        return;
    }
    set_medium(0);
    solve_as_half_space(options_.half_space_method, 0);
}

void StackSolver::solve_as_half_space(HalfSpaceMethod method, std::size_t medium) {
    const double n = stack_.media[medium].index;
    reflector_ = &free_reflector(n);
    if (is_coupled()) {
        solve_coupled_half_space(stokes_tables_of(n), *block_, strengths_[medium],
                                 memory_.stokes_mode, memory_.medium, nodes_of(n), cosines_in(n),
                                 grid_of(n), requested_in(n), tolerance_, memory_.coupled,
                                 *reflector_);
        return;
    }
    solve_half_space(method, memory_.medium, mode_of(n), grid_of(n), requested_in(n), tolerance_,
                     memory_.work, *reflector_);
    if (fourier_order_ == 0 && block_->front() == StokesComponent::I)
        memory_.brightness[medium] = memory_.work.brightness;
}

Eigen::VectorXd StackSolver::mirror_at(double index, const Eigen::VectorXd& mu) const {
    return components_ == 1 ? boundary_reflectance(index, stack_.mirror_index, mu)
                            : polarised_mirror(index, stack_.mirror_index, mu, *block_);
}

void StackSolver::solve_ground() {
    const double n = stack_.ground_index;
    const ZenithGrid& grid = grid_of(n);
    const RequestedDirections& requested = requested_in(n);
    if (components_ > 1) {
        make_block_mode(stokes_tables_of(n), *block_, {}, grid, requested, memory_.stokes_mode,
                        memory_.medium);
    }
    const FourierMode& mode = mode_of(n);
    Reflector& ground = free_reflector(n);
    reflector_ = &ground;
    if (stack_.base == BaseKind::lambertian) {
        lambertian_ground(stack_.ground_albedo, mode, grid, requested, ground);
    } else if (stack_.base == BaseKind::mirror && is_coupled()) {
        coupled_mirror(n, stack_.mirror_index, nodes_of(n), cosines_in(n), requested, *block_,
                       ground);
    } else if (stack_.base == BaseKind::mirror) {
        mirror_ground(mirror_at(n, nodes_of(n).mu), mirror_at(n, cosines_in(n).mu), requested,
                      ground);
    } else {
        no_reflection(grid, requested, ground);
    }
    ground.has_transmittance = stack_.transmits;
    if (!stack_.transmits) return;
    ground.transmittance_at_nodes = (grid.weights.array() * grid.mu.array()).sqrt();
    mode.keep_intensity(ground.transmittance_at_nodes);
    ground.transmittance_at_requested.setOnes(requested.mu.size());
    mode.keep_intensity(ground.transmittance_at_requested);
    if (stack_.base == BaseKind::mirror) {  // what it does not reflect passes it
        ground.transmittance_at_nodes -= ground.nodes * ground.transmittance_at_nodes;
        ground.transmittance_at_requested -=
            ground.specular.cwiseProduct(ground.transmittance_at_requested);
    }
}

void StackSolver::put_on_coat(std::size_t medium, ReflectorParts parts) {
    const ScaledMedium& coat = stack_.media[medium];
    set_medium(medium);
    const double n = coat.index;
    const FourierMode& mode = mode_of(n);
    const RequestedDirections& requested = requested_in(n);
    if (options_.coat_method != CoatMethod::automatic) {
        const std::vector<ScaledMedium> below(stack_.media.begin(),
                                              stack_.media.begin() + std::ptrdiff_t(medium));
        *reflector_ = step_through_coat(options_.coat_method, options_.coat_substeps,
                                        coat.scaled_optical_depth, memory_.medium,
                                        first_order_of(below, mode, requested), mode, grid_of(n),
                                        requested, std::move(*reflector_));
        return;
    }
    LayerOperator& layer = memory_.layer;
    if (is_coupled()) {
        solve_coupled_layer(coat.scaled_optical_depth, stokes_tables_of(n), *block_,
                            strengths_[medium], mode, memory_.medium, nodes_of(n), cosines_in(n),
                            requested, tolerance_, memory_.coupled, layer);
    } else {
        solve_layer(coat.scaled_optical_depth, memory_.medium, mode, grid_of(n), requested, parts,
                    tolerance_, memory_.work, layer);
    }
    if (!layer.physical) {
        reflector_->physical = false;
        return;
    }
    Reflector& result = free_reflector(n);
    if (is_coupled()) {
        put_on_coupled(layer, *reflector_, requested, int(block_->size()), parts, result);
    } else {
        put_on(layer, *reflector_, requested, parts, memory_.sky, memory_.work, result);
    }
    reflector_ = &result;
}

// The solvers answer with upward light for downward light whose U and V have the opposite sign:
// R = X D4.
void StackSolver::keep_pairs() {
    Eigen::MatrixXd& all = memory_.order.multiple;
    const Eigen::MatrixXd& solved = reflector_->multiple;
    if (components_ == 1) {
        all.swap(reflector_->multiple);
        return;
    }
    const auto c = Eigen::Index(block_->size());
    const Eigen::Index out = solved.rows() / c, in = solved.cols() / c;
    const bool turns = has_fresnel_ && block_->front() == StokesComponent::I;
    Eigen::MatrixXd pair(c, c);
    for (Eigen::Index i = 0; i < in; ++i) {
        for (Eigen::Index o = 0; o < out; ++o) {
            pair = solved.block(o * c, i * c, c, c);
            if (turns) turn_back(pair);
            for (Eigen::Index column = 0; column < c; ++column) {
                const auto to_column = Eigen::Index((*block_)[std::size_t(column)]);
                const double sign = to_column < 2 ? 1.0 : -1.0;
                for (Eigen::Index row = 0; row < c; ++row) {
                    const auto to_row = Eigen::Index((*block_)[std::size_t(row)]);
                    all(o * components_ + to_row, i * components_ + to_column) =
                        sign * pair(row, column);
                }
            }
        }
    }
}

// 2 sum_q w_q mu_q R(mu, mu_q) = (2 R D) D, by reciprocity from the light under a uniform sky.
void StackSolver::keep_albedos() {
    StackOrder& order = memory_.order;
    const auto c = Eigen::Index(block_->size());
    const std::array<double, 4>& I = mode_of(1.0).unpolarised;
    const std::array<double, 2> Q = has_fresnel_ ? std::array{I[0], -I[1]} : std::array{0.0, 1.0};
    const auto along = [&](const auto& axis, const Eigen::VectorXd& rows, int in) {
        double sum = 0.0;
        for (Eigen::Index k = 0; k < c; ++k) sum += axis[std::size_t(k)] * rows[c * in + k];
        return sum;
    };
    const auto mirrored = [&](const auto& axis, int in) {
        double sum = 0.0;
        for (Eigen::Index k = 0; k < c && reflector_->specular.size() > 0; ++k) {
            const auto row = std::size_t(k);
            sum += axis[row] * I[row] * reflector_->specular[c * in + k];
        }
        return sum;
    };
    for (const int in : asked_.in) {
        order.plane_albedo.push_back(mirrored(I, in) + along(I, reflector_->sky_at_requested, in));
        if (c == 1) continue;
        order.polarised_plane_albedo.push_back(mirrored(Q, in) +
                                               along(Q, reflector_->sky_at_requested, in));
    }
    const Eigen::VectorXd &D = memory_.uniform, &let_in = memory_.let_in;
    const double entering = let_in.dot(D);  // 0: the surface above is a mirror
    order.spherical_albedo = entering > 0.0 ? let_in.dot(reflector_->sky_at_nodes) / entering : 0.0;
    if (!stack_.transmits) return;
    const double absorbed = 1.0 - stack_.ground_albedo;
    for (const int in : asked_.in)
        order.transmittance.push_back(absorbed *
                                      along(I, reflector_->transmittance_at_requested, in));
    order.transmittance.push_back(absorbed * D.dot(reflector_->transmittance_at_nodes) /
                                  D.squaredNorm());
}

}  // namespace miebrdf::rte
