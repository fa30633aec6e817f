#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <miebrdf/error.h>
#include "pipeline/render/solved_brdf.h"
#include "pipeline/render/table_nodes.h"
#include "pipeline/solve/brdf.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/probe_directions.h"
#include "pipeline/solve/visible_layers.h"
#include "rte/grid/discretisation.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/fourier_sum.h"
#include "rte/stack/stack_solver.h"

namespace miebrdf::render {

/// Fills a SolvedBrdf wavelength by wavelength.
class SolvedBrdfBuilder {
  public:
    SolvedBrdfBuilder(const std::vector<Request>& requests, const TableSize& size,
                      const RunControl& control)
        : control_(control) {
        for (const Request& request : requests) add_optics(request);
        brdf_->cosines_ = std::size_t(size.cosines);
        brdf_->azimuths_ = std::size_t(size.azimuths);
        solver_ = requests.front().solver;
        const std::vector<double> cosines = cosine_nodes(size.cosines);
        nodes_.mu = Eigen::Map<const Eigen::VectorXd>(cosines.data(), size.cosines);
        for (int k = 0; k < size.cosines; ++k) {
            nodes_.in.push_back(k);
            nodes_.out.push_back(k);
        }
        azimuth_deg_ = azimuth_nodes_deg(size.azimuths);
    }

    std::shared_ptr<const SolvedBrdf> build(const Scene& scene, Component component) {
        const std::size_t count = optics_.size();
        brdf_->component_ = component;
        brdf_->stride_ = lanes_for(count) * kLaneWidth;
        brdf_->table_.resize(brdf_->cosines_ * brdf_->cosines_ * brdf_->azimuths_ * brdf_->stride_);
        std::vector<std::vector<rte::ScaledMedium>> stacks(count);
        std::vector<rte::SolverReport> reports(count);
        run_parallel("radiative transfer", count, control_,
                     [&](std::size_t w) { reports[w] = solve(w, stacks[w]); });
        brdf_->first_order_.emplace(stacks, solver_.single_scattering_correction);
        add_surface(scene);
        for (std::size_t w = 0; w < count; ++w) {
            const double error = reports[w].error_estimate + optics_[w].mie_error_estimate;
            brdf_->error_estimate_ = std::max(brdf_->error_estimate_, error);
            brdf_->converged_ = brdf_->converged_ && reports[w].converged && optics_[w].converged;
        }
        return brdf_;
    }

  private:
    void add_optics(const Request& request) {
        const SceneMedia media(request);
        const OpticsDemand demand = demand_of(request, PhaseDemand::whole);
        Request probe = request;
        probe.directions = probe_directions();
        for (SceneOptics& optics :
             visible_optics(media, probe, request.wavelength_nm, demand, control_)) {
            optics_.push_back(std::move(optics));
        }
        if (request.scene.surface) {
            for (const double w : request.wavelength_nm)
                surface_index_.push_back(media.surface_index_at(w));
        }
        for (const double wavelength : request.wavelength_nm)
            brdf_->wavelength_nm_.push_back(wavelength);
        for (const std::string& line : media.sources()) {
            const auto& known = brdf_->sources_;
            if (std::find(known.begin(), known.end(), line) == known.end())
                brdf_->sources_.push_back(line);
        }
    }

    /// Column w of the table: (mu_in + mu_out) R without the first order.
    rte::SolverReport solve(std::size_t w, std::vector<rte::ScaledMedium>& media) {
        const rte::Stack& stack = optics_[w].stack;
        rte::SolverReport report = rte::reflect(stack, probe_directions(), solver_).report;
        rte::SolverOptions options = solver_;
        options.streams = report.streams;
        const rte::ScaledStack scaled = rte::scale_stack(stack, report.moments, options.delta_m);
        const rte::ZenithGrid grid = rte::make_zenith_grid(
            rte::choose_discretisation(stack, options, report.streams).grid, report.streams);
        const rte::MultipleScattering multiple = rte::sum_fourier_orders(
            scaled, grid, nodes_, azimuth_deg_, kFourierTailShare * options.tolerance, options);
        media = scaled.media;
        fill(w, multiple);
        report.converged = report.converged && multiple.converged;
        return report;
    }

    void fill(std::size_t w, const rte::MultipleScattering& multiple) {
        std::size_t index = 0;
        for (Eigen::Index i = 0; i < nodes_.mu.size(); ++i) {
            for (Eigen::Index o = 0; o < nodes_.mu.size(); ++o) {
                for (std::size_t a = 0; a < azimuth_deg_.size(); ++a, ++index) {
                    const double value = (nodes_.mu[i] + nodes_.mu[o]) * multiple.reflection[index];
                    if (!multiple.physical || !std::isfinite(value)) {
                        throw InputError(
                            fmt::format("no physical solution at {} nm; try other streams "
                                        "or a smaller tolerance",
                                        brdf_->wavelength_nm_[w]));
                    }
                    brdf_->table_[index * brdf_->stride_ + w] = float(value);
                }
            }
        }
    }

    void add_surface(const Scene& scene) {
        if (!scene.surface) return;
        brdf_->surface_.emplace(surface_index_, *scene.surface, scene.coupling,
                                int(brdf_->cosines_));
    }

    const RunControl& control_;
    std::shared_ptr<SolvedBrdf> brdf_ = std::make_shared<SolvedBrdf>();
    std::vector<SceneOptics> optics_;
    std::vector<std::complex<double>>
        surface_index_;  ///< at each wavelength; empty without surface
    rte::SolverOptions solver_;
    rte::RequestedDirections nodes_;
    std::vector<double> azimuth_deg_;
};

std::shared_ptr<const SolvedBrdf> solve_brdf(std::vector<Request> requests, Component component,
                                             const TableSize& size, const RunControl& control) {
    if (size.cosines < 4 || size.azimuths < 4) {
        throw UsageError(fmt::format("table of {} cosines and {} azimuths; allowed: 4 or more",
                                     size.cosines, size.azimuths));
    }
    if (requests.empty()) throw UsageError("no wavelength to render");
    for (Request& request : requests) {
        request.directions = {{1.0}, {1.0}, {0.0}};  // what validate() looks at; not used
        validate(request);
    }
    if (component == Component::surface && !requests.front().scene.surface) {
        throw UsageError(
            "component 'surface' needs a surface; give one with --roughness, e.g. 0.3");
    }
    SolvedBrdfBuilder builder(requests, size, control);
    return builder.build(requests.front().scene, component);
}

InterpolationError interpolation_error(const SolvedBrdf& brdf, Request request,
                                       const RunControl& control) {
    request.directions = {};
    for (int i = 0; i < 8; ++i) {
        // Two lists that are not each other's, nor the table's.
        request.directions.mu_in.push_back(0.05 + 0.13 * i);
        request.directions.mu_out.push_back(0.07 + 0.13 * i);
    }
    request.directions.azimuth_deg = {1.0, 22.0, 58.0, 91.0, 127.0, 158.0, 179.0};
    const BrdfResult exact = compute_brdf(request, control);
    const rte::Directions& d = request.directions;
    const std::size_t block = d.mu_out.size() * d.azimuth_deg.size();
    std::vector<double> errors, values(brdf.wavelengths());
    for (std::size_t i = 0; i < d.mu_in.size(); ++i) {
        std::size_t index = i * block;
        for (const double mu_out : d.mu_out) {
            for (const double azimuth : d.azimuth_deg) {
                brdf.evaluate(d.mu_in[i], mu_out, std::cos(azimuth * std::numbers::pi / 180.0),
                              values);
                for (std::size_t w = 0; w < values.size(); ++w) {
                    const std::vector<double>& total = exact.slices[w].total;
                    const auto first = total.begin() + std::ptrdiff_t(i * block);
                    const double largest = *std::max_element(first, first + std::ptrdiff_t(block));
                    errors.push_back(std::abs(values[w] - total[index]) / largest);
                }
                ++index;
            }
        }
    }
    std::sort(errors.begin(), errors.end());
    return {errors[errors.size() / 2], errors.back()};
}

}  // namespace miebrdf::render
