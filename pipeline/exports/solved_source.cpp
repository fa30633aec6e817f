#include "pipeline/exports/solved_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <complex>
#include <optional>

#include "pipeline/error.h"
#include "pipeline/parallel.h"
#include "pipeline/version.h"

namespace miebrdf::exports {
namespace {

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
    const bool layers = component != Component::surface;
    const auto demand = demand_of(request, layers ? PhaseDemand::whole : PhaseDemand::moments_only);
    const std::vector<SceneOptics> optics = media.optics(wavelength_nm_, demand, control);
    std::vector<std::optional<WavelengthSolution>> solved(optics.size());
    run_parallel("radiative transfer", optics.size(), control, [&](std::size_t w) {
        std::optional<std::complex<double>> surface_index;
        if (request.scene.surface) surface_index = media.surface_index_at(wavelength_nm_[w]);
        solved[w].emplace(optics[w], surface_index, request, component);
    });
    for (std::size_t w = 0; w < solved.size(); ++w) {
        const rte::SolverReport& report = solved[w]->report();
        converged_ = converged_ && (!layers || (report.converged && optics[w].converged));
        error_estimate_ =
            std::max(error_estimate_, report.error_estimate + optics[w].mie_error_estimate);
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
