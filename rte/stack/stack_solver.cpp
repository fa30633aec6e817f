#include "rte/stack/stack_solver.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <miebrdf/error.h>
#include "rte/boundary/rough_top.h"
#include "rte/first_order/beams.h"
#include "rte/math/interruption.h"
#include "rte/math/tolerance_budget.h"

namespace miebrdf::rte {
namespace {

// Turns rows and columns 0 and 1 from light parallel and perpendicular to the meridian plane into I
// and Q.
void turn_to_stokes(Eigen::MatrixXd& pair) {
    const Eigen::MatrixXd rows = pair.topRows(2);
    pair.row(0) = (rows.row(0) + rows.row(1)) / std::numbers::sqrt2;
    pair.row(1) = (rows.row(0) - rows.row(1)) / std::numbers::sqrt2;
    const Eigen::MatrixXd columns = pair.leftCols(2);
    pair.col(0) = (columns.col(0) + columns.col(1)) / std::numbers::sqrt2;
    pair.col(1) = (columns.col(0) - columns.col(1)) / std::numbers::sqrt2;
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
    if (stack.ground && options.coat_method != CoatMethod::automatic) {
        throw UsageError("over a ground by its BRDF coats are put by the automatic method alone");
    }
    memory_.brightness.assign(stack.media.size(), 0.0);
    const bool has_mirrors = stack.has_mirrors();
    const bool is_rough = stack.boundary && stack.boundary->is_rough();
    const std::size_t count = grids.indices().size();
    memory_.requested.resize(count);
    for (std::size_t k = 0; k < count; ++k) {
        // Through a rough boundary no beam enters: light below it is known at the nodes alone.
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
        rough_top_ = std::make_unique<RoughTop>(
            *stack.rough_boundaries, stack.top_index, *stack.boundary,
            grids.refraction().within(stack.top_index), requested, unscattered_);
    }
    if (components > 1) set_up_stokes();
    if (stack.kept_layers != nullptr) name_layers_below_top();
}

void StackSolver::set_up_stokes() {
    for (const ScaledMedium& medium : stack_.media) {
        strengths_.push_back(matrix_strengths(medium));
        couples_V_ = couples_V_ || strengths_.back().has_b2();
    }
    // Total reflection and metals turn U into V even where media do not (b2 = 0).
    couples_V_ = couples_V_ || (components_ == 4 && has_fresnel_);
    const std::size_t count = grids_.indices().size();
    for (std::size_t k = 0; k < count; ++k) {
        Rows& all = rows_.emplace_back();
        for (int rows = 1; rows <= 4; ++rows) {
            all.grids[std::size_t(rows)] = repeated(grids_.of(grids_.indices()[k]), rows);
            all.requested[std::size_t(rows)] = repeated(memory_.requested[k], rows);
        }
    }
    memory_.stokes_tables.resize(count);
}

StackSolver::~StackSolver() = default;

int StackSolver::fourier_orders() const {
    return has_boundary_orders() ? std::max(kMostBoundaryOrders, stack_.moments) : stack_.moments;
}

const StackOrder& StackSolver::solve(int fourier_order) {
    math::interruption_point();
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
    if (fourier_order >= stack_.moments) return;  // this order has no scattered light
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
    const std::optional<std::size_t> hiding = scatters ? find_hiding_coat() : std::nullopt;
    const std::size_t top = stack_.media.size() - 1;
    const bool may_keep = scatters && !below_top_.empty() && follower_ == nullptr && hiding != top;
    const bool is_kept = may_keep && take_kept_layers(hiding);
    const std::size_t first_coat = is_kept    ? top
                                   : scatters ? solve_lowest(hiding)
                                              : solve_mirrors();
    if (has_energy) find_skies(let_in, let_out);
    bool has_sky = has_boundary;
    double index = first_coat > 0 ? stack_.media[first_coat - 1].index : stack_.ground_index;
    for (std::size_t c = first_coat; c < stack_.media.size() && reflector_->physical; ++c) {
        if (may_keep && !is_kept && c == top) {
            stack_.kept_layers->keep(below_top_, place_of_block(hiding),
                                     {*reflector_, memory_.brightness});
        }
        const bool is_top = c == top && !has_boundary;
        const double next = stack_.media[c].index;
        if (next != index) put_on_boundary(index, next, ReflectorParts::nodes);
        index = next;
        if (!reflector_->physical) break;
        if (stack_.media[c].scaled_optical_depth == 0.0) continue;  // two surfaces, nothing between
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
    tell({.kind = StackStep::Kind::whole, .result = reflector_});
    keep_pairs();
}

void StackSolver::tell(StackStep step) const {
    if (follower_ != nullptr && step.result->physical) follower_->follow(step);
}

// By reciprocity the flux weighted by let_out is the response to a sky of radiance let_out.
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

// Of the two reflectors of this index the one that does not hold the layers solved so far.
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

void StackSolver::keep_pairs() {
    if (components_ == 1) {
        memory_.order.multiple.swap(reflector_->multiple);
    } else {
        spread_block(reflector_->multiple, memory_.order.multiple);
    }
}

// The solvers' X counts U and V of downward light with the opposite sign: R = X D4.
void StackSolver::spread_block(const Eigen::MatrixXd& solved, Eigen::MatrixXd& all) const {
    const auto c = Eigen::Index(block_->size());
    const Eigen::Index out = solved.rows() / c, in = solved.cols() / c;
    const bool turns = has_fresnel_ && block_->front() == StokesComponent::I;
    Eigen::MatrixXd pair(c, c);
    for (Eigen::Index i = 0; i < in; ++i) {
        for (Eigen::Index o = 0; o < out; ++o) {
            pair = solved.block(o * c, i * c, c, c);
            if (turns) turn_to_stokes(pair);
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

// The plane albedo 2 sum_q w_q mu_q R(mu, mu_q) is by reciprocity the response to a uniform sky.
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
    const double entering = let_in.dot(D);  // 0 where the surface above lets no light in
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
