// The steps of StackSolver: the base, then coats and boundaries put on it.
#include <algorithm>
#include <utility>

#include "rte/boundary/rough_top.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/hidden_layers.h"
#include "rte/stack/stack_solver.h"

namespace miebrdf::rte {

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

bool StackSolver::has_automatic_methods() const {
    return options_.coat_method == CoatMethod::automatic &&
           options_.half_space_method == HalfSpaceMethod::automatic;
}

bool StackSolver::may_leave_out_layers() const {
    return !stack_.transmits && has_automatic_methods();
}

std::optional<std::size_t> StackSolver::find_hiding_coat() {
    const std::size_t first_coat = stack_.base == BaseKind::half_space ? 1 : 0;
    const double allowed = tolerance_ * std::min(stack_.brightness, 1.0);
    for (std::size_t c = stack_.media.size(); c-- > first_coat && may_leave_out_layers();) {
        const double depth = stack_.media[c].scaled_optical_depth;
        if (!hides_in_fourier_order({}, depth, allowed)) continue;  // not even without scattering
        set_medium(c);
        if (hides_in_fourier_order(memory_.medium, depth, allowed)) return c;
    }
    return std::nullopt;
}

std::size_t StackSolver::solve_lowest(std::optional<std::size_t> hiding) {
    if (!hiding) {
        solve_base();
        return stack_.base == BaseKind::half_space ? 1 : 0;
    }
    set_medium(*hiding);
    solve_as_half_space(HalfSpaceMethod::automatic, *hiding);
    return *hiding + 1;
}

void StackSolver::name_layers_below_top() {
    if (stack_.media.size() < 2 || stack_.ground || !has_automatic_methods()) return;
    const auto add = [&](const auto&... numbers) {
        const auto add_one = [&](const auto& number) {
            below_top_.append(reinterpret_cast<const char*>(&number), sizeof number);
        };
        (add_one(numbers), ...);
    };
    const auto add_list = [&](const auto& list) {
        add(list.size());
        for (const auto& number : list) add(number);
    };
    add(components_, tolerance_, couples_V_, has_fresnel_, stack_.moments, stack_.base,
        stack_.ground_albedo, stack_.mirror_index, stack_.ground_index, stack_.transmits);
    for (std::size_t m = 0; m + 1 < stack_.media.size(); ++m) {
        const ScaledMedium& medium = stack_.media[m];
        add(medium.index, medium.scaled_optical_depth, medium.scaled.one_minus_albedo,
            medium.scaled.albedo);
        add_list(medium.scaled.chi);
        if (components_ == 1) continue;
        const auto& [a3, a4, b2, first, second, cosine, sine, upper, lower, circular_cosine,
                     circular_sine] = strengths_[m];
        for (const Eigen::VectorXd* list : {&a3, &a4, &b2, &first, &second, &cosine, &sine, &upper,
                                            &lower, &circular_cosine, &circular_sine})
            add_list(*list);
    }
    for (std::size_t k = 0; k < grids_.indices().size(); ++k) {
        const double index = grids_.indices()[k];
        add(index);
        add_list(grids_.of(index).mu);
        add_list(grids_.of(index).weights);
        add_list(memory_.requested[k].mu);
        for (const auto* list :
             {&memory_.requested[k].out, &memory_.requested[k].in, &memory_.requested[k].beside})
            add_list(*list);
    }
}

KeptLayers::Place StackSolver::place_of_block(std::optional<std::size_t> hiding) const {
    const std::size_t lowest = hiding.value_or(0);
    return {fourier_order_, int(block_->front()), hiding ? lowest + 1 : 0,
            fourier_order_ > 0 ? memory_.brightness[lowest] : 0.0};
}

bool StackSolver::take_kept_layers(std::optional<std::size_t> hiding) {
    const auto kept = stack_.kept_layers->find(below_top_, place_of_block(hiding));
    if (kept == nullptr) return false;
    const std::size_t top = stack_.media.size() - 1;
    set_medium(top);  // the mode of the block
    memory_.brightness = kept->brightness;
    reflector_ = &free_reflector(stack_.media[top - 1].index);
    *reflector_ = kept->layers;
    return true;
}

std::size_t StackSolver::solve_mirrors() {
    Reflector& mirrors = free_reflector(stack_.top_index);
    mirrors = {};
    mirrors.nodes = unscattered_.asDiagonal();
    mirrors.physical = true;
    reflector_ = &mirrors;
    tell({.kind = StackStep::Kind::mirrors, .result = &mirrors});
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
    tell({.kind = StackStep::Kind::half_space,
          .result = reflector_,
          .medium = medium,
          .mode = &mode_of(n),
          .scattering = &memory_.medium,
          .grid = &grid_of(n),
          .requested = &requested_in(n),
          .eigenmodes = &memory_.work.eigenmode_solver,
          .has_eigenmodes = !memory_.work.is_swept});
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
    } else if (stack_.ground) {
        memory_.ground.fill(*stack_.ground, mode, nodes_of(n), cosines_in(n), stack_.moments, grid,
                            requested, ground);
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
    if (stack_.transmits) find_ground_emission(mode, grid, requested, ground);
    tell({.kind = StackStep::Kind::ground,
          .result = &ground,
          .mode = &mode,
          .grid = &grid,
          .requested = &requested});
}

void StackSolver::find_ground_emission(const FourierMode& mode, const ZenithGrid& grid,
                                       const RequestedDirections& requested,
                                       Reflector& ground) const {
    ground.transmittance_at_nodes = (grid.weights.array() * grid.mu.array()).sqrt();
    mode.keep_intensity(ground.transmittance_at_nodes);
    ground.transmittance_at_requested.setOnes(requested.mu.size());
    mode.keep_intensity(ground.transmittance_at_requested);
    if (stack_.ground) {  // 1 - reflected: absorbed
        ground.transmittance_at_requested -= ground.rows * ground.transmittance_at_nodes;
        ground.transmittance_at_nodes -= ground.nodes * ground.transmittance_at_nodes;
    } else if (stack_.base == BaseKind::mirror) {  // 1 - reflected: transmitted
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
        tell({.kind = StackStep::Kind::layer,
              .result = &result,
              .below = reflector_,
              .medium = medium,
              .mode = &mode,
              .scattering = &memory_.medium,
              .grid = &grid_of(n),
              .requested = &requested,
              .layer = &layer,
              .eigenmodes = &memory_.work.eigenmode_solver});
    }
    reflector_ = &result;
}

// Boundaries are kept, because reflectances are the same in all Fourier orders and in all stacks of
// the same indices.
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
    const auto tell_of = [&](const SmoothBoundary& boundary) {
        tell({.kind = StackStep::Kind::boundary,
              .result = &result,
              .below = reflector_,
              .requested = &requested_in(below),
              .boundary = &boundary});
    };
    if (components_ == 1) {
        const SmoothBoundary& boundary = boundary_between(below, above);
        put_boundary_on(boundary, *reflector_, requested_in(below), parts, memory_.sky,
                        memory_.work, result);
        tell_of(boundary);
    } else {
        const FresnelReflections matrices(below, above, nodes_of(below), nodes_of(above),
                                          cosines_in(below));
        if (is_coupled()) {
            put_boundary_on_coupled(matrices, *block_, requested_in(below), parts, *reflector_,
                                    result);
        } else {
            const SmoothBoundary boundary = polarised_boundary(matrices, *block_);
            put_boundary_on(boundary, *reflector_, requested_in(below), parts, memory_.sky,
                            memory_.work, result);
            tell_of(boundary);
        }
    }
    reflector_ = &result;
}

void StackSolver::put_on_top(ReflectorParts parts) {
    if (!rough_top_) {
        put_on_boundary(stack_.top_index, 1.0, parts);
        return;
    }
    Reflector& result = free_reflector(1.0);
    rough_top_->put_on(fourier_order_, *reflector_, parts, result);
    tell({.kind = StackStep::Kind::rough_top,
          .result = &result,
          .below = reflector_,
          .requested = &asked_,
          .rough = rough_top_.get()});
    reflector_ = &result;
}

}  // namespace miebrdf::rte
