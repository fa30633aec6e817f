#include "pipeline/exports/solved_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "pipeline/error.h"
#include "pipeline/exports/phase_table.h"
#include "pipeline/parallel.h"
#include "pipeline/version.h"

namespace miebrdf::exports {
namespace {

/// Replaces a phase function known at listed angles only by one for every angle.
double tabulate_phase(rte::Optics& optics, const Medium& medium,
                      const std::vector<double>& angles_deg) {
    if (!needs_mie(medium) || !optics.phase) return 0.0;
    PhaseTable table(angles_deg, optics.phase);
    const double error = table.error_estimate();
    optics.phase = std::move(table);
    return error;
}

std::string title_of(const Scene& scene) {
    std::string title = describe(scene.base);
    for (const CoatMedium& coat : scene.coats) {
        title = fmt::format("{} (optical depth {}) on {}", describe(coat.medium),
                            coat.optical_depth, title);
    }
    if (scene.surface)
        title += fmt::format(", surface roughness {}", scene.surface->beckmann_alpha);
    return title;
}

}  // namespace

SolvedSource::SolvedSource(const Request& request, Component component,
                           const std::string& command_line, const RunControl& control)
    : wavelength_nm_(request.wavelength_nm), channels_(channel_names(request.wavelength_nm)) {
    validate(request);
    if (component == Component::surface && !request.scene.surface) {
        throw UsageError("component 'surface' needs a surface; give --roughness, e.g. 0.3");
    }
    const SceneMedia media(request);
    provenance_ = {fmt::format("miebrdf {}", kVersion), command_line, title_of(request.scene),
                   name_of(component), media.sources()};
    OpticsDemand demand = demand_of(request, PhaseDemand::none);
    if (request.solver.single_scattering_correction && component != Component::surface) {
        demand.angles_deg = phase_table_angles_deg();
    }
    std::vector<SceneOptics> optics = media.optics(demand, control);
    std::vector<std::optional<WavelengthSolution>> solved(optics.size());
    std::vector<double> phase_errors(optics.size(), 0.0);
    run_parallel("radiative transfer", optics.size(), control, [&](std::size_t w) {
        rte::Stack& stack = optics[w].stack;
        phase_errors[w] = tabulate_phase(stack.base, request.scene.base, demand.angles_deg);
        for (std::size_t c = 0; c < stack.coats.size(); ++c) {
            phase_errors[w] = std::max(
                phase_errors[w], tabulate_phase(stack.coats[c].optics,
                                                request.scene.coats[c].medium, demand.angles_deg));
        }
        solved[w].emplace(optics[w], request, component);
    });
    for (std::size_t w = 0; w < solved.size(); ++w) {
        const rte::SolverReport& report = solved[w]->report();
        const bool layers = component != Component::surface;
        converged_ = converged_ && (!layers || (report.converged && optics[w].converged));
        error_estimate_ =
            std::max(error_estimate_, report.error_estimate + optics[w].mie_error_estimate);
        phase_error_estimate_ = std::max(phase_error_estimate_, phase_errors[w]);
        solutions_.push_back(std::move(*solved[w]));
    }
}

void SolvedSource::evaluate(std::span<const Direction> directions, std::span<double> values) const {
    for (std::size_t w = 0; w < solutions_.size(); ++w) {
        solutions_[w].evaluate(directions, values.data() + w, solutions_.size());
    }
}

Component parse_component(const std::string& name) {
    for (const Component component :
         {Component::total, Component::subsurface, Component::surface}) {
        if (name == name_of(component)) return component;
    }
    throw UsageError(
        fmt::format("unknown component '{}'; allowed: total, subsurface, surface", name));
}

const char* name_of(Component component) {
    switch (component) {
        case Component::subsurface:
            return "subsurface";
        case Component::surface:
            return "surface";
        case Component::total:
            break;
    }
    return "total";
}

}  // namespace miebrdf::exports
