#include "pipeline/solve/solved_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <complex>
#include <optional>

#include <miebrdf/error.h>
#include <miebrdf/version.h>
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/probe_directions.h"
#include "pipeline/solve/visible_layers.h"

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

/// Smooth parts are mixed once; sharp ones whose wavelengths have no weight are left out.
class SolvedMix : public ChannelMix {
  public:
    SolvedMix(const std::vector<WavelengthSolution>& solutions, const std::vector<SharpPart>& sharp,
              const ColourWeights& weights) {
        for (std::size_t w = 0; w < solutions.size(); ++w) {
            for (std::size_t c = 0; c < 3; ++c) {
                if (weights[w][c] != 0.0) smooth_[c].add(solutions[w].smooth(), weights[w][c]);
            }
        }
        auto next = weights.begin();
        for (const SharpPart& part : sharp) {
            const auto last = next + static_cast<std::ptrdiff_t>(part.wavelengths());
            const ColourWeights own(next, last);
            next = last;
            const bool counts = std::any_of(own.begin(), own.end(), [](const auto& weight) {
                return weight != std::array{0.0, 0.0, 0.0};
            });
            if (counts) parts_.push_back({&part, own});
        }
    }

    void evaluate(std::span<const Direction> directions, std::span<double> values) const override {
        std::fill(values.begin(), values.end(), 0.0);
        std::vector<double> sharp;
        for (std::size_t first = 0, count = 0; first < directions.size(); first += count) {
            const auto rest = directions.subspan(first);
            count = count_sharing_cosines(rest);
            double* const target = values.data() + 3 * first;
            for (std::size_t c = 0; c < 3; ++c)
                add_smooth(smooth_[c], rest.first(count), target + c, 3);
            for (const Part& part : parts_) {
                const std::size_t wavelengths = part.weight.size();
                sharp.resize(count * wavelengths);
                part.sharp->evaluate(rest.first(count), sharp);
                for (std::size_t i = 0; i < sharp.size(); ++i) {
                    for (std::size_t c = 0; c < 3; ++c) {
                        target[i / wavelengths * 3 + c] +=
                            part.weight[i % wavelengths][c] * sharp[i];
                    }
                }
            }
        }
    }

  private:
    struct Part {
        const SharpPart* sharp;
        ColourWeights weight;
    };
    std::vector<Part> parts_;
    std::array<SmoothPart, 3> smooth_;
};

}  // namespace

SolvedSource::SolvedSource(const Request& request, Component component,
                           const std::string& command_line, const RunControl& control)
    : wavelength_nm_(request.wavelength_nm), channels_(channel_names(request.wavelength_nm)) {
    validate(request);
    if (component == Component::surface && !request.scene.surface) {
        throw UsageError("component 'surface' needs a surface; give --roughness, e.g. 0.3");
    }
    const SceneMedia media(request);
    provenance_ = {fmt::format("miebrdf {}", kVersion),
                   command_line,
                   title_of(request.scene),
                   name_of(component),
                   "",
                   media.sources()};
    const bool layers = component != Component::surface;
    const OpticsDemand demand = demand_of(request, PhaseDemand::whole);
    Request probe = request;
    probe.directions = probe_directions();
    const std::vector<SceneOptics> optics =
        layers ? visible_optics(media, probe, wavelength_nm_, demand, control)
               : std::vector<SceneOptics>(wavelength_nm_.size());
    std::vector<std::optional<WavelengthSolution>> solved(optics.size());
    run_parallel("radiative transfer", optics.size(), control, [&](std::size_t w) {
        std::optional<std::complex<double>> surface_index;
        if (request.scene.surface) surface_index = media.surface_index_at(wavelength_nm_[w]);
        solved[w].emplace(optics[w], surface_index, request, component);
    });
    accuracy_.tolerance = request.solver.tolerance;
    for (std::size_t w = 0; w < solved.size(); ++w) {
        if (layers) judge(*solved[w], optics[w], wavelength_nm_[w]);
        solutions_.push_back(std::move(*solved[w]));
    }
    provenance_.accuracy = describe(accuracy_);
    tabulate_sharp_parts(request.solver, control);
}

void SolvedSource::tabulate_sharp_parts(const rte::SolverOptions& solver,
                                        const RunControl& control) {
    constexpr std::size_t kMost = SharpPart::kMostWavelengths;
    std::vector<std::optional<SharpPart>> parts((solutions_.size() + kMost - 1) / kMost);
    run_parallel("first order", parts.size(), control, [&](std::size_t p) {
        const std::size_t first = p * kMost, count = std::min(kMost, solutions_.size() - first);
        parts[p].emplace(std::span(solutions_).subspan(first, count), solver);
    });
    for (auto& part : parts) sharp_.push_back(std::move(*part));
}

void SolvedSource::judge(const WavelengthSolution& solution, const SceneOptics& optics,
                         double wavelength_nm) {
    const rte::SolverReport& report = solution.report();
    accuracy_.converged = accuracy_.converged && report.converged && optics.converged;
    accuracy_.share_within_tolerance -=
        (1.0 - report.share_within_tolerance) / static_cast<double>(wavelength_nm_.size());
    const double estimate = report.error_estimate + optics.mie_error_estimate;
    if (!(estimate > accuracy_.error_estimate)) return;
    accuracy_.error_estimate = estimate;
    accuracy_.mie_error_estimate = optics.mie_error_estimate;
    accuracy_.wavelength_nm = wavelength_nm;
    accuracy_.direction = solution.worst_direction();
}

std::string describe(const SolverAccuracy& accuracy) {
    const std::string estimate = fmt::format("solver's error estimate {:.1e} (tolerance {:.1e})",
                                             accuracy.error_estimate, accuracy.tolerance);
    if (accuracy.converged) return estimate;
    const Direction& worst = accuracy.direction;
    return fmt::format(
        "not converged: {}, largest at {} nm, mu_in {}, mu_out {}, azimuth {} degrees; single "
        "scattering's part of it {:.1e}; {:.3g} % of the directions compared are within tolerance",
        estimate, accuracy.wavelength_nm, worst.mu_in, worst.mu_out, worst.azimuth_deg,
        accuracy.mie_error_estimate, 100.0 * accuracy.share_within_tolerance);
}

void SolvedSource::evaluate(std::span<const Direction> directions, std::span<double> values) const {
    const std::size_t stride = solutions_.size();
    std::vector<double> sharp;
    for (std::size_t first = 0, count = 0; first < directions.size(); first += count) {
        const auto rest = directions.subspan(first);
        count = count_sharing_cosines(rest);
        double* target = values.data() + first * stride;
        for (const SharpPart& part : sharp_) {
            const std::size_t wavelengths = part.wavelengths();
            sharp.resize(count * wavelengths);
            part.evaluate(rest.first(count), sharp);
            for (std::size_t i = 0; i < sharp.size(); ++i)
                target[i / wavelengths * stride + i % wavelengths] = sharp[i];
            target += wavelengths;
        }
        for (std::size_t w = 0; w < stride; ++w) {
            add_smooth(solutions_[w].smooth(), rest.first(count),
                       values.data() + first * stride + w, stride);
        }
    }
}

std::unique_ptr<ChannelMix> SolvedSource::mix(const ColourWeights& weights) const {
    return std::make_unique<SolvedMix>(solutions_, sharp_, weights);
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
