#include "rte/stack/stack_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "rte/boundary/rough_top.h"
#include "rte/boundary/smooth_boundary.h"
#include "rte/first_order/narrow_features.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/hidden_layers.h"

namespace miebrdf::rte {

namespace {

// Indices as boundaries see them: steps too small for one are none.
void find_indices(const Stack& stack, ScaledStack& scaled) {
    double lowest = stack.base_index;
    if (stack.base_kind != BaseKind::half_space) {
        const auto coat = std::find_if(stack.coats.begin(), stack.coats.end(),
                                       [](const Coat& c) { return c.optical_depth > 0.0; });
        if (coat != stack.coats.end()) lowest = coat->index;
    }
    scaled.mirror_index = stack.mirror_index;
    scaled.boundary = stack.boundary;
    scaled.ground_index = lowest;
    if (!stack.boundary) {
        // A mirror is what it is to the medium above, boundaries or not.
        scaled.mirror_index /= lowest;
        scaled.ground_index = scaled.top_index = 1.0;
        for (ScaledMedium& medium : scaled.media) medium.index = 1.0;
        return;
    }
    double above = 1.0;
    const auto snap = [&above](double& index) {
        if (std::abs(index - above) < kLeastIndexStep * above) index = above;
        above = index;
    };
    for (std::size_t i = scaled.media.size(); i-- > 0;) snap(scaled.media[i].index);
    if (!scaled.media.empty()) scaled.ground_index = scaled.media.front().index;
    snap(scaled.ground_index);
    scaled.top_index = scaled.media.empty() ? scaled.ground_index : scaled.media.back().index;
    if (scaled.top_index == 1.0) scaled.boundary.reset();
}

}  // namespace

bool ScaledStack::refracts() const {
    return top_index != 1.0 || ground_index != 1.0 ||
           std::any_of(media.begin(), media.end(),
                       [](const ScaledMedium& medium) { return medium.index != 1.0; });
}

bool ScaledStack::has_mirrors() const {
    return base == BaseKind::mirror ||
           std::any_of(media.begin(), media.end(),
                       [this](const ScaledMedium& medium) { return medium.index != top_index; });
}

ScaledStack scale_stack(const Stack& stack, int moments, bool delta_m, NarrowPart wanted) {
    ScaledStack scaled;
    scale_stack(stack, moments, delta_m, wanted, scaled);
    return scaled;
}

BaseKind lowest_kind(const Stack& stack) {
    const bool is_hidden = std::any_of(stack.coats.begin(), stack.coats.end(), [](const Coat& c) {
        return c.optical_depth != 0.0 && is_bottomless(c.optical_depth);
    });
    return is_hidden ? BaseKind::half_space : stack.base_kind;
}

void scale_stack(const Stack& stack, int moments, bool delta_m, NarrowPart wanted,
                 ScaledStack& scaled) {
    scaled.transmits = false;
    scaled.brightness = 0.0;
    scaled.moments = moments;
    scaled.base = stack.base_kind;
    scaled.ground_albedo = stack.ground_albedo;
    std::size_t count = 0;
    const auto add = [&](const Optics& optics, double optical_depth, double index) {
        if (count == scaled.media.size()) scaled.media.emplace_back();
        ScaledMedium& medium = scaled.media[count++];
        medium.exact = optics;
        scale_optics(optics, moments, delta_m, medium.scaled);
        medium.scaled_optical_depth = bounded_depth(optical_depth * medium.scaled.depth_factor);
        medium.narrow = {};
        medium.unresolved_shares.clear();
        if (medium.scaled.truncated > 0.0 && wanted == NarrowPart::split)
            medium.narrow = split_forward_peak(optics.chi, medium.scaled.first_cutoff);
        medium.index = index;
    };
    if (stack.base_kind == BaseKind::half_space) {
        add(stack.base, std::numeric_limits<double>::infinity(), stack.base_index);
    }
    for (const Coat& coat : stack.coats) {
        if (coat.optical_depth == 0.0) continue;
        if (is_bottomless(coat.optical_depth)) {
            count = 0;
            scaled.base = BaseKind::half_space;
        }
        add(coat.optics, coat.optical_depth, coat.index);
    }
    scaled.media.resize(count);
    find_indices(stack, scaled);
}

StackGrids::StackGrids(ZenithGrid grid) : indices_{1.0}, grids_{std::move(grid)} {}

StackGrids::StackGrids(const ScaledStack& stack, GridKind kind, int count)
    : kind_(kind), count_(count), indices_{1.0} {
    if (!stack.refracts()) {
        grids_.push_back(make_zenith_grid(kind, count));
        return;
    }
    std::vector<double> scattering;
    for (const ScaledMedium& medium : stack.media) scattering.push_back(medium.index);
    if (scattering.empty()) scattering.push_back(stack.ground_index);
    constexpr int least_rough = 4;
    const bool is_rough = stack.boundary && stack.boundary->is_rough();
    if (is_rough) count_ = std::max(count, least_rough);
    refraction_.emplace(scattering, count_);
    scattering_ = scattering;
    scattering.push_back(1.0);
    std::sort(scattering.begin(), scattering.end());
    scattering.erase(std::unique(scattering.begin(), scattering.end()), scattering.end());
    indices_ = std::move(scattering);
    for (const double index : indices_) grids_.push_back(refraction_->in_medium(index));
}

bool StackGrids::fit(const ScaledStack& stack, GridKind kind, int count) const {
    if (kind != kind_ || count != count_) return false;
    if (!stack.refracts()) return scattering_.empty();
    if (stack.boundary && stack.boundary->is_rough()) return false;
    if (stack.media.empty())
        return scattering_.size() == 1 && scattering_.front() == stack.ground_index;
    return std::equal(
        stack.media.begin(), stack.media.end(), scattering_.begin(), scattering_.end(),
        [](const ScaledMedium& medium, double index) { return medium.index == index; });
}

const ZenithGrid& StackGrids::of(double index) const {
    const auto at = std::find(indices_.begin(), indices_.end(), index);
    return grids_[std::size_t(at - indices_.begin())];
}

void split_by_resolution(ScaledStack& stack, const StackGrids& grids) {
    for (ScaledMedium& medium : stack.media) {
        medium.narrow = split_forward_peak(medium.exact.chi, 1, medium.scaled.first_cutoff);
        medium.unresolved_shares.clear();
        if (medium.narrow.rest.empty()) continue;
        medium.unresolved_shares = unresolved_shares(
            resolved_waves(grids.of(medium.index), kResolvedAngles), int(medium.scaled.chi.size()));
    }
}

StackSolver::StackSolver(const ScaledStack& stack, const StackGrids& grids,
                         const RequestedDirections& requested, const SolverOptions& options,
                         StackMemory& memory)
    : stack_(stack),
      grids_(grids),
      options_(options),
      tolerance_(kEquationShare * options.tolerance),
      memory_(memory) {
    memory_.brightness.assign(stack.media.size(), 0.0);
    const bool has_mirrors = stack.has_mirrors();
    const bool is_rough = stack.boundary && stack.boundary->is_rough();
    memory_.requested.resize(grids.indices().size());
    for (std::size_t k = 0; k < grids.indices().size(); ++k) {
        // No beam enters through a rough boundary: what lies below is met from its nodes alone.
        RequestedDirections& own = memory_.requested[k];
        if (is_rough) {
            own = {};
        } else {
            refract(requested, grids.indices()[k], own);
        }
        if (has_mirrors) own = with_cosines_beside(own);
    }
    memory_.tables.resize(memory_.requested.size());
    memory_.modes.resize(memory_.requested.size());
    memory_.reflectors.resize(memory_.requested.size());
    if (is_rough) {
        rough_top_ =
            std::make_unique<RoughTop>(stack.top_index, *stack.boundary,
                                       grids.refraction().within(stack.top_index), requested);
    }
}

StackSolver::~StackSolver() = default;

// Where what is solved next goes: not on what has been solved so far.
Reflector& StackSolver::free_reflector(double index) {
    auto& [one, other] = memory_.reflectors[place_of(index)];
    return reflector_ == &one ? other : one;
}

std::size_t StackSolver::place_of(double index) const {
    const auto& indices = grids_.indices();
    return std::size_t(std::find(indices.begin(), indices.end(), index) - indices.begin());
}

const Reflector& StackSolver::solve(int fourier_order, ReflectorParts parts,
                                    const Eigen::VectorXd& sky) {
    const std::vector<double>& indices = grids_.indices();
    for (std::size_t k = 0; k < indices.size(); ++k) {
        memory_.modes[k] = &memory_.tables[k].find(fourier_order, stack_.moments,
                                                   grids_.of(indices[k]), memory_.requested[k]);
    }
    const bool has_boundary = stack_.top_index != 1.0;
    const std::size_t first_coat = solve_lowest();
    bool has_sky = has_boundary;
    double index = first_coat > 0 ? stack_.media[first_coat - 1].index : stack_.ground_index;
    for (std::size_t c = first_coat; c < stack_.media.size() && reflector_->physical; ++c) {
        const bool is_top = c + 1 == stack_.media.size() && !has_boundary;
        const double next = stack_.media[c].index;
        if (next != index) put_on_boundary(index, next, ReflectorParts::nodes, sky);
        index = next;
        if (!reflector_->physical) break;
        put_on_coat(c, is_top ? parts : ReflectorParts::nodes, sky);
        has_sky = has_boundary || (is_top && options_.coat_method == CoatMethod::automatic);
    }
    if (has_boundary && reflector_->physical) put_on_top(fourier_order, parts, sky);
    if (parts == ReflectorParts::sky && !has_sky && reflector_->physical) {
        reflector_->sky_at_requested.noalias() = reflector_->rows * sky;
        reflector_->sky_at_nodes.noalias() = reflector_->nodes * sky;
    }
    return *reflector_;
}

void StackSolver::put_on_top(int fourier_order, ReflectorParts parts, const Eigen::VectorXd& sky) {
    if (!rough_top_) {
        put_on_boundary(stack_.top_index, 1.0, parts, sky);
        return;
    }
    Reflector& result = free_reflector(1.0);
    rough_top_->put_on(fourier_order, *reflector_, parts, result);
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

void StackSolver::put_on_boundary(double below, double above, ReflectorParts parts,
                                  const Eigen::VectorXd& sky) {
    Reflector& result = free_reflector(above);
    put_boundary_on(boundary_between(below, above), *reflector_, requested_in(below), parts, sky,
                    memory_.work, result);
    reflector_ = &result;
}

void StackSolver::set_medium(std::size_t index) {
    const ScaledOptics& scaled = stack_.media[index].scaled;
    const FourierMode& mode = *memory_.modes.front();
    memory_.medium.one_minus_albedo = scaled.one_minus_albedo;
    memory_.medium.lowest_degree = mode.fourier_order;
    memory_.medium.brightness = mode.fourier_order > 0 ? memory_.brightness[index] : 0.0;
    memory_.medium.strengths.resize(mode.at_nodes.cols());
    for (Eigen::Index c = 0; c < memory_.medium.strengths.size(); ++c) {
        const Eigen::Index l = mode.fourier_order + c;
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
        set_medium(c);
        if (!hides_in_fourier_order(memory_.medium, stack_.media[c].scaled_optical_depth,
                                    tolerance_ * std::min(stack_.brightness, 1.0))) {
            continue;
        }
        solve_as_half_space(HalfSpaceMethod::automatic, c);
        return c + 1;
    }
    solve_base();
    return first_coat;
}

void StackSolver::solve_as_half_space(HalfSpaceMethod method, std::size_t index) {
    const double n = stack_.media[index].index;
    reflector_ = &free_reflector(n);
    solve_half_space(method, memory_.medium, mode_of(n), grids_.of(n), requested_in(n), tolerance_,
                     memory_.work, *reflector_);
    if (memory_.medium.lowest_degree == 0) memory_.brightness[index] = memory_.work.brightness;
}

void StackSolver::solve_base() {
    if (stack_.base == BaseKind::half_space) {
        set_medium(0);
        solve_as_half_space(options_.half_space_method, 0);
        return;
    }
    const double index = stack_.ground_index;
    const FourierMode& mode = mode_of(index);
    const ZenithGrid& grid = grids_.of(index);
    const RequestedDirections& requested = requested_in(index);
    Reflector& ground = free_reflector(index);
    reflector_ = &ground;
    if (stack_.base == BaseKind::lambertian) {
        lambertian_ground(stack_.ground_albedo, mode, grid, requested, ground);
    } else if (stack_.base == BaseKind::mirror) {
        mirror_ground(boundary_reflectance(index, stack_.mirror_index, grid.mu),
                      boundary_reflectance(index, stack_.mirror_index, requested.mu), requested,
                      ground);
    } else {
        no_reflection(grid, requested, ground);
    }
    ground.has_glow = stack_.transmits;
    if (!stack_.transmits) return;
    ground.glow_at_nodes = (grid.weights.array() * grid.mu.array()).sqrt();
    ground.glow_at_requested.setOnes(requested.mu.size());
    if (stack_.base == BaseKind::mirror) {  // what it does not reflect passes it
        ground.glow_at_nodes -= ground.nodes * ground.glow_at_nodes;
        ground.glow_at_requested -= ground.specular;
    }
}

void StackSolver::put_on_coat(std::size_t index, ReflectorParts parts, const Eigen::VectorXd& sky) {
    const ScaledMedium& coat = stack_.media[index];
    set_medium(index);
    const FourierMode& mode = mode_of(coat.index);
    const ZenithGrid& grid = grids_.of(coat.index);
    const RequestedDirections& requested = requested_in(coat.index);
    if (options_.coat_method != CoatMethod::automatic) {
        const std::vector<ScaledMedium> below(stack_.media.begin(),
                                              stack_.media.begin() + std::ptrdiff_t(index));
        *reflector_ = step_through_coat(
            options_.coat_method, options_.coat_substeps, coat.scaled_optical_depth, memory_.medium,
            first_order_of(below, mode, requested), mode, grid, requested, std::move(*reflector_));
        return;
    }
    solve_layer(coat.scaled_optical_depth, memory_.medium, mode, grid, requested, parts, tolerance_,
                memory_.work, memory_.layer);
    if (!memory_.layer.physical) {
        reflector_->physical = false;
        return;
    }
    Reflector& result = free_reflector(coat.index);
    put_on(memory_.layer, *reflector_, requested, parts, sky, memory_.work, result);
    reflector_ = &result;
}

}  // namespace miebrdf::rte
