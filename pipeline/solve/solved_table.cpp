#include "pipeline/solve/solved_table.h"

#include <fmt/format.h>
#include <miebrdf/version.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <miebrdf/surface.h>
#include "pipeline/solve/brdf_state.h"
#include "pipeline/solve/checks.h"
#include "pipeline/solve/optics_memo.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/surface_part.h"
#include "rte/boundary/rough_boundaries.h"
#include "rte/grid/discretisation.h"
#include "rte/stack/layered_reflection.h"

namespace miebrdf {
namespace {

rte::SpectralFirstOrder first_order_of(std::span<const SolvedWavelength> wavelengths,
                                       const SolverOptions& solver) {
    std::vector<rte::SpectralFirstOrder::Wavelength> list;
    for (const SolvedWavelength& at : wavelengths) list.push_back({&at.stack(), at.is_polarised()});
    return {list, solver.single_scattering_correction, solver.tolerance};
}

/// Solves every wavelength, in parallel.
std::vector<SolvedWavelength> solve_wavelengths(const SolvedTable& state, int unchecked_nodes,
                                                const Control& control) {
    const ResolvedScene& scene = state.scene;
    const std::size_t count = scene.wavelength_nm.size();
    std::vector<LightChoice> light(count);
    std::vector<SceneOptics> optics(count);
    if (state.part != BrdfPart::surface) {
        const auto demand = demand_of(state.solver, scene.particles.tolerance, PhaseDemand::whole);
        const LayerRequest request{scene, probe_directions(), state.solver};
        const std::vector<std::size_t> all = all_wavelengths(scene);
        light = light_of(request, all, control);
        std::vector<char> polarised(count);
        for (std::size_t w = 0; w < count; ++w) polarised[w] = light[w].components > 1;
        optics = visible_optics(scene, request.directions, state.solver.tolerance, all, polarised,
                                demand, control);
    }
    std::vector<std::optional<SolvedWavelength>> solved(count);
    run_parallel("radiative transfer", count, control, [&](std::size_t w) {
        rte::SolutionMemory memory = memory_of(control);
        solved[w].emplace(scene, w, optics[w], state.solver, state.part, light[w],
                          state.components > 1, unchecked_nodes, memory, control);
    });
    std::vector<SolvedWavelength> wavelengths;
    wavelengths.reserve(solved.size());
    for (auto& at : solved) wavelengths.push_back(std::move(*at));
    return wavelengths;
}

/// The first order of all wavelengths, some at a time, in parallel.
std::vector<SharpPart> make_sharp_parts(const SolvedTable& state, const Control& control) {
    const std::size_t most = SharpPart::kMostWavelengths;
    const std::span<const SolvedWavelength> all = state.wavelengths;
    std::vector<std::optional<SharpPart>> made((all.size() + most - 1) / most);
    run_parallel("first order", made.size(), control, [&](std::size_t p) {
        const std::size_t first = p * most, count = std::min(most, all.size() - first);
        made[p].emplace(all.subspan(first, count), state.solver);
    });
    std::vector<SharpPart> parts;
    parts.reserve(made.size());
    for (auto& part : made) parts.push_back(std::move(*part));
    return parts;
}

}  // namespace

const Directions& probe_directions() {
    static const Directions directions{
        {0.05, 0.3, 0.6, 1.0}, {0.05, 0.2, 0.5, 0.8, 1.0}, {0, 45, 90, 135, 180}};
    return directions;
}

SolvedWavelength::SolvedWavelength(const ResolvedScene& scene, std::size_t w,
                                   const SceneOptics& optics, const SolverOptions& solver,
                                   BrdfPart part, const LightChoice& light, bool whole_matrix,
                                   int unchecked_nodes, rte::SolutionMemory& memory,
                                   const Control& control) {
    report_.converged = report_.solver.converged = true;
    if (part != BrdfPart::surface) {
        solve(optics, solver, light.components, whole_matrix, unchecked_nodes, memory);
        state_light(light, report_);
    }
    report_.wavelength_nm = scene.wavelength_nm[w];
    if (scene.surface && part != BrdfPart::subsurface) {
        lobe_.emplace(scene.surface_index[w], *scene.surface);
        SurfacePart shares = surface_part(scene, w, {SmoothPart::nodes(), SmoothPart::nodes(), {}},
                                          SurfaceDemand::whole, control);
        factor_in_ = std::move(shares.in);
        factor_out_ = std::move(shares.out);
        smooth_.scale(factor_in_, factor_out_);
    }
}

void SolvedWavelength::solve(const SceneOptics& optics, const SolverOptions& solver, int components,
                             bool whole_matrix, int unchecked_nodes, rte::SolutionMemory& memory) {
    const rte::Stack& stack = optics.stack;
    if (stack.base_kind == rte::BaseKind::none && stack.coats.empty() && !stack.boundary) return;
    SolverOptions options = solver;
    options.tolerance = tolerance_for_transfer(solver.tolerance, optics.mie_error_estimate);
    const rte::SolvedLight light{components, components > 1 && !whole_matrix};
    int& moments = report_.solver.moments;
    if (unchecked_nodes > 0) {
        report_.solver.streams = unchecked_nodes;
        moments = rte::choose_discretisation(stack, options, unchecked_nodes).moments;
        report_.solver.converged = true;
    } else {
        report_.solver =
            components > 1
                ? rte::reflect_polarised(stack, probe_directions(), light, options, &memory).report
                : rte::reflect(stack, probe_directions(), options, &memory).report;
    }
    options.streams = report_.solver.streams;
    // Without an estimate of the error glories are not split off either (BrdfState).
    options.single_scattering_correction &= unchecked_nodes == 0;
    const auto tabulated = [&] {
        return rte::tabulate_orders(stack, SmoothPart::nodes(), light, report_.solver, options,
                                    memory);
    };
    rte::TabulatedOrders table = tabulated();
    while (unchecked_nodes > 0 && !table.physical && moments > 1) {
        moments = 3 * moments / 4;
        table = tabulated();
    }
    smooth_ = smooth_element(table, light.shown(), 0, 0);
    if (whole_matrix && components > 1) mueller_.emplace(table, components);
    report_.solver.fourier_orders = static_cast<int>(table.orders.size());
    report_.solver.converged = report_.solver.converged && table.converged && table.physical;
    stack_ = std::move(table.stack);
    is_polarised_ = components > 1;
    if (stack_.boundary && stack_.boundary->is_rough()) {
        const std::vector<double>& nodes = SmoothPart::nodes();
        const Eigen::VectorXd scale = stack_.rough_boundaries->outer_lobe_scale(
            stack_.top_index, *stack_.boundary,
            Eigen::Map<const Eigen::VectorXd>(nodes.data(), Eigen::Index(nodes.size())));
        lobe_scale_.assign(scale.begin(), scale.end());
        lobe_ = rte::outer_lobe(*stack_.boundary, stack_.top_index);
    }
    judge(report_, optics.mie_error_estimate, solver.tolerance);
}

double SolvedWavelength::lobe(const Direction& direction) const {
    const auto& [mu_in, mu_out, azimuth_deg] = direction;
    return lobe_ ? lobe_scale(mu_in) * lobe_scale(mu_out) * lobe_->brdf(mu_in, mu_out, azimuth_deg)
                 : 0.0;
}

double SolvedWavelength::lobe_scale(double mu) const {
    return lobe_scale_.empty() ? 1.0 : at_cosine(lobe_scale_, mu);
}

double SolvedWavelength::transmitted(double mu_in, double mu_out) const {
    return factor_in_.empty() ? 1.0 : at_cosine(factor_in_, mu_in) * at_cosine(factor_out_, mu_out);
}

SharpPart::SharpPart(std::span<const SolvedWavelength> wavelengths, const SolverOptions& solver)
    : wavelengths_(wavelengths),
      first_order_(first_order_of(wavelengths, solver)),
      has_lobe_(std::any_of(wavelengths.begin(), wavelengths.end(),
                            [](const SolvedWavelength& at) { return at.has_lobe(); })) {}

SharpPart::SharpPart(const SharpPart& exact, std::span<const SolvedWavelength> wavelengths,
                     bool first_order_is_smooth)
    : wavelengths_(wavelengths), has_lobe_(exact.has_lobe_) {
    if (!first_order_is_smooth) first_order_ = exact.first_order_;
}

void SharpPart::evaluate(std::span<const Direction> directions, std::span<double> values,
                         EvaluationScratch& scratch) const {
    const double mu_in = directions[0].mu_in, mu_out = directions[0].mu_out;
    const std::size_t count = wavelengths();
    if (first_order_)
        first_order_->evaluate(mu_in, mu_out, scratch.cos_azimuth, values, scratch.first_order);
    else
        std::fill(values.begin(), values.end(), 0.0);
    for (std::size_t w = 0; w < count && !is_empty(); ++w) {
        const SolvedWavelength& at = wavelengths_[w];
        const double transmitted = at.transmitted(mu_in, mu_out) / std::numbers::pi;
        for (std::size_t d = 0; d < directions.size(); ++d) {
            double& value = values[d * count + w];
            value *= transmitted;
            if (at.has_lobe()) value += at.lobe(directions[d]);
        }
    }
}

void set_cosines(std::span<const Direction> directions, EvaluationScratch& scratch) {
    scratch.cos_azimuth.clear();
    for (const Direction& d : directions)
        scratch.cos_azimuth.push_back(std::cos(d.azimuth_deg * (std::numbers::pi / 180)));
}

void SmoothSum::add(const SmoothPart& smooth, double* values, std::size_t stride,
                    EvaluationScratch& scratch) const {
    smooth.series_at(in_, out_, mu_sum_, scratch.series);
    for (std::size_t d = 0; d < scratch.cos_azimuth.size(); ++d)
        values[d * stride] +=
            math::cosine_sum(scratch.series, scratch.cos_azimuth[d]) / std::numbers::pi;
}

namespace {

/// Notes mirror reflections, which are in no value of the table.
void note_mirrors(const ResolvedScene& scene, Provenance& provenance) {
    if (scene.boundary && scene.boundary->is_rough()) return;
    // The eye sees best at 555 nm.
    const auto middle = std::min_element(
        scene.wavelength_nm.begin(), scene.wavelength_nm.end(),
        [](double a, double b) { return std::abs(a - 555.0) < std::abs(b - 555.0); });
    const auto at = std::size_t(middle - scene.wavelength_nm.begin());
    const double n = scene.top_index(at);
    if (n > 1.0) {
        provenance.mirror_index = n;
        provenance.left_out = fmt::format(
            "the mirror reflection of the smooth boundary (index {:.4g}, {:.2g} % along the "
            "normal), which goes into one direction alone: in the renderer add a smooth "
            "dielectric of that index over black",
            n, 100.0 * (n - 1) * (n - 1) / ((n + 1) * (n + 1)));
    }
    // Unscattered light comes back from mirrors, from the lower side of free films, and from steps
    // of the host's index.
    bool has_steps = n > 1.0 && scene.substrate == Substrate::Kind::none;
    for (const ResolvedMedium& medium : scene.present_media())
        has_steps = has_steps || (scene.boundary && medium.host_index[at] != n);
    const bool has_mirror = scene.substrate == Substrate::Kind::mirror;
    if (!has_mirror && !has_steps) return;
    provenance.left_out += fmt::format(
        "{}what the {} below reflect{} into the mirror direction without scattering: in the "
        "renderer add a smooth conductor weakened to the mirror reflectance of the scene's "
        "albedo{}",
        provenance.left_out.empty() ? "" : "; ", has_mirror ? "mirror" : "smooth surfaces",
        has_mirror ? "s" : "", provenance.left_out.empty() ? "" : ", less that of the boundary");
}

}  // namespace

SolvedTable::SolvedTable(const ResolvedScene& resolved, const std::string& title,
                         const SolverOptions& options, const TableOptions& table_options,
                         const Control& control, int unchecked_nodes)
    : scene(resolved),
      solver(options),
      part(table_options.part),
      channels(channel_names(resolved.wavelength_nm)),
      components(part == BrdfPart::surface ? 1 : std::max(1, options.stokes)) {
    wavelengths = solve_wavelengths(*this, unchecked_nodes, control);
    report.tolerance = solver.tolerance;
    report.sources = scene.sources;
    report.notes = scene.notes;
    for (const SolvedWavelength& at : wavelengths) report.wavelengths.push_back(at.report());
    provenance = {std::string("miebrdf ") + kVersion,
                  table_options.command_line,
                  title,
                  name_of(part),
                  report.summary(),
                  fmt::format("{}", fmt::join(report.polarisation(), "; ")),
                  scene.sources};
    if (part != BrdfPart::surface) note_mirrors(scene, provenance);
    sharp = make_sharp_parts(*this, control);
}

}  // namespace miebrdf
