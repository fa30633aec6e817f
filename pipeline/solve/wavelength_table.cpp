#include "pipeline/solve/wavelength_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <miebrdf/surface.h>
#include "pipeline/solve/checks.h"
#include "rte/boundary/rough_top.h"
#include "rte/stack/layered_reflection.h"
#include "rte/stokes/polarised_beams.h"

namespace miebrdf {
namespace {

bool any_optical_steps(std::span<const WavelengthTable> tables) {
    return std::any_of(tables.begin(), tables.end(),
                       [](const WavelengthTable& table) { return table.has_optical_steps(); });
}

std::vector<FirstOrder> first_order_of(std::span<const WavelengthTable> tables,
                                       const SolverOptions& solver) {
    std::vector<FirstOrder> first_order;
    const std::size_t together = any_optical_steps(tables) ? 1 : tables.size();
    for (std::size_t first = 0; first < tables.size(); first += together) {
        std::vector<std::vector<rte::ScaledMedium>> stacks;
        for (const WavelengthTable& table : tables.subspan(first, together))
            stacks.push_back(table.media());
        first_order.emplace_back(stacks, solver.single_scattering_correction, solver.tolerance);
    }
    return first_order;
}

double degrees_of_cosine(double cosine) {
    return std::acos(std::clamp(cosine, -1.0, 1.0)) * (180.0 / std::numbers::pi);
}

// The lobe of a rough boundary, as R.
void add_rough_lobe(const WavelengthTable& table, double mu_in, double mu_out,
                    const std::vector<double>& cos_azimuth, std::vector<double>& reflection) {
    const rte::ScaledStack& stack = table.stack();
    if (!stack.boundary || !stack.boundary->is_rough()) return;
    const rte::SurfaceLobe lobe = rte::outer_lobe(*stack.boundary, stack.top_index);
    const double scale = std::numbers::pi * table.lobe_scale(mu_in) * table.lobe_scale(mu_out);
    for (std::size_t a = 0; a < cos_azimuth.size(); ++a) {
        reflection[a] += scale * lobe.brdf(mu_in, mu_out, degrees_of_cosine(cos_azimuth[a]));
    }
}

}  // namespace

const Directions& probe_directions() {
    static const Directions directions{
        {0.05, 0.3, 0.6, 1.0}, {0.05, 0.2, 0.5, 0.8, 1.0}, {0, 45, 90, 135, 180}};
    return directions;
}

WavelengthTable::WavelengthTable(const ResolvedScene& scene, std::size_t w,
                                 const SceneOptics& optics, const SolverOptions& solver,
                                 BrdfPart part, const LightChoice& light, bool whole_matrix) {
    report_.converged = report_.solver.converged = true;
    if (part == BrdfPart::surface) {
        // Of the layers nothing is wanted.
    } else {
        solve(optics, solver, light.components, whole_matrix);
        report_.polarisation_left_out = light.left_out;
    }
    report_.wavelength_nm = scene.wavelength_nm[w];
    if (scene.surface && part != BrdfPart::subsurface) {
        lobe_.emplace(scene.surface_index[w], *scene.surface);
        const rte::SurfaceTransmission transmission(*lobe_, scene.coupling);
        for (const double mu : SmoothPart::nodes()) {
            factor_in_.push_back(transmission.in(mu));
            factor_out_.push_back(transmission.out(mu));
        }
        smooth_.scale(factor_in_, factor_out_);
    }
}

void WavelengthTable::solve(const SceneOptics& optics, const SolverOptions& solver, int components,
                            bool whole_matrix) {
    const rte::Stack& stack = optics.stack;
    report_.stokes = components;
    if (stack.base_kind == rte::BaseKind::none && stack.coats.empty() && !stack.boundary) return;
    SolverOptions options = solver;
    options.tolerance = tolerance_for_transfer(solver.tolerance, optics.mie_error_estimate);
    const rte::SolvedLight light{components, components > 1 && !whole_matrix};
    report_.solver = components > 1
                         ? rte::reflect_polarised(stack, probe_directions(), light, options).report
                         : rte::reflect(stack, probe_directions(), options).report;
    options.streams = report_.solver.streams;
    rte::TabulatedOrders table =
        rte::tabulate_orders(stack, SmoothPart::nodes(), light, report_.solver, options);
    smooth_ = smooth_element(table, light.shown(), 0, 0);
    if (whole_matrix && components > 1) mueller_.emplace(table, components);
    report_.solver.fourier_orders = static_cast<int>(table.orders.size());
    report_.solver.converged = report_.solver.converged && table.converged && table.physical;
    stack_ = std::move(table.stack);
    if (components > 1)
        seen_once_ = rte::media_of_first_order(stack_.media, options.single_scattering_correction);
    if (stack_.boundary && stack_.boundary->is_rough()) {
        const std::vector<double>& nodes = SmoothPart::nodes();
        const Eigen::VectorXd scale = rte::outer_lobe_scale(
            stack_.top_index, *stack_.boundary,
            Eigen::Map<const Eigen::VectorXd>(nodes.data(), Eigen::Index(nodes.size())));
        lobe_scale_.assign(scale.begin(), scale.end());
    }
    judge(report_, optics.mie_error_estimate, solver.tolerance);
}

double WavelengthTable::lobe(const Direction& direction) const {
    return lobe_ ? lobe_->brdf(direction.mu_in, direction.mu_out, direction.azimuth_deg) : 0.0;
}

double WavelengthTable::lobe_scale(double mu) const { return at_cosine(lobe_scale_, mu); }

double WavelengthTable::transmitted(double mu_in, double mu_out) const {
    return lobe_ ? at_cosine(factor_in_, mu_in) * at_cosine(factor_out_, mu_out) : 1.0;
}

SharpPart::SharpPart(std::span<const WavelengthTable> tables, const SolverOptions& solver)
    : tables_(tables), first_order_(first_order_of(tables, solver)) {}

void SharpPart::evaluate(std::span<const Direction> directions, std::span<double> values,
                         EvaluationScratch& scratch) const {
    const double mu_in = directions[0].mu_in, mu_out = directions[0].mu_out;
    const std::size_t count = tables_.size();
    const std::vector<double>& cos_azimuth = scratch.cos_azimuth;
    if (first_order_.size() == 1 && !tables_.front().has_optical_steps()) {
        first_order_.front().evaluate(mu_in, mu_out, cos_azimuth, values, scratch.first_order);
    } else {
        std::vector<double> own(directions.size());
        for (std::size_t w = 0; w < count; ++w) {
            scattered_once(w, mu_in, mu_out, cos_azimuth, own, scratch.first_order);
            add_rough_lobe(tables_[w], mu_in, mu_out, cos_azimuth, own);
            for (std::size_t d = 0; d < directions.size(); ++d) values[d * count + w] = own[d];
        }
    }
    for (std::size_t w = 0; w < count; ++w) {
        const WavelengthTable& table = tables_[w];
        const double transmitted = table.transmitted(mu_in, mu_out) / std::numbers::pi;
        for (std::size_t d = 0; d < directions.size(); ++d) {
            double& value = values[d * count + w];
            value *= transmitted;
            if (table.has_surface()) value += table.lobe(directions[d]);
        }
    }
}

void SharpPart::scattered_once(std::size_t w, double mu_in, double mu_out,
                               std::span<const double> cos_azimuth, std::span<double> reflection,
                               FirstOrder::Scratch& scratch) const {
    const rte::ScaledStack& stack = tables_[w].stack();
    if (stack.boundary && stack.boundary->is_rough()) {
        std::fill(reflection.begin(), reflection.end(), 0.0);
        return;
    }
    const std::vector<rte::Optics>& seen = tables_[w].seen_once();
    if (!rte::has_straight_paths(stack) && !seen.empty()) {
        for (std::size_t a = 0; a < cos_azimuth.size(); ++a)
            reflection[a] = rte::scattered_once(stack, seen, mu_in, mu_out,
                                                degrees_of_cosine(cos_azimuth[a]))(0, 0);
        return;
    }
    if (!rte::has_straight_paths(stack)) {
        const auto in = rte::beams_of(stack, mu_in), out = rte::beams_of(stack, mu_out);
        std::vector<rte::FirstOrderPaths> paths;
        for (std::size_t i = 0; i < in.size(); ++i)
            paths.push_back(rte::first_order_paths(stack.media[i], in[i], out[i]));
        first_order_[w].evaluate_paths(paths, cos_azimuth, reflection);
        return;
    }
    first_order_[w].evaluate(rte::refracted_cosine(stack.top_index, mu_in),
                             rte::refracted_cosine(stack.top_index, mu_out), cos_azimuth,
                             reflection, scratch);
    const double factor = rte::straight_paths_factor(stack.top_index, mu_in, mu_out);
    for (double& value : reflection) value *= factor;
    if (seen.empty() || stack.top_index == 1.0) return;
    for (std::size_t a = 0; a < cos_azimuth.size(); ++a)
        reflection[a] *= rte::change_of_straight_paths(stack, seen, mu_in, mu_out,
                                                       degrees_of_cosine(cos_azimuth[a]));
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

}  // namespace miebrdf
