#include "tools/miebrdf/result_facts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>

#include "pipeline/solve/rules.h"
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {
namespace {

/// Adds what a result says about itself at each wavelength, without its physics.
void add_report(Table& table, const ResultReport& result) {
    table.report_columns = {"wavelength_nm", "converged", "error_estimate", "mie_error_estimate",
                            "phase_noise",   "streams",   "moments",        "azimuthal_orders"};
    for (const WavelengthReport& report : result.wavelengths) {
        const rte::SolverReport& solver = report.solver;
        table.report.push_back({report.wavelength_nm, std::string(report.converged ? "yes" : "no"),
                                report.error_estimate, report.mie_error_estimate,
                                report.phase_noise.largest, double(solver.streams),
                                double(solver.moments), double(solver.fourier_orders)});
    }
}

/// The optical depth of every layer at every wavelength; one number where they agree.
void add_depths(Table& table, const ResultReport& result, const Scene& scene) {
    std::size_t layer = 0;
    for (std::size_t c = 0; c < scene.layers.size(); ++c) {
        if (is_left_out(scene, scene.layers[c])) continue;
        std::vector<std::string> texts;
        bool same = true;
        double first = std::numeric_limits<double>::quiet_NaN();
        for (const WavelengthReport& at : result.wavelengths) {
            if (layer >= at.optical_depths.size()) continue;
            const double depth = at.optical_depths[layer];
            if (texts.empty()) first = depth;
            same = same && depth == first;
            texts.push_back(fmt::format("{:.6g} at {} nm", depth, at.wavelength_nm));
        }
        ++layer;
        if (texts.empty()) continue;
        table.facts.emplace_back(
            "optical_depth",
            fmt::format(
                "coat {} ({}@{}): {}", c + 1, describe(scene.layers[c].medium),
                describe(scene.layers[c].depth),
                same ? fmt::format("{:.6g}", first) : fmt::format("{}", fmt::join(texts, ", "))));
    }
}

}  // namespace

void add_facts(Table& table, const ResultReport& result, const Scene& scene,
               const std::string& units) {
    table.facts.emplace_back("units", units);
    for (const std::string& source : result.sources) table.facts.emplace_back("source", source);
    if (const std::string particles = describe_particles(scene); !particles.empty())
        table.facts.emplace_back("particles", particles);
    add_depths(table, result, scene);
    for (const std::string& note : result.notes) table.facts.emplace_back("note", note);
    table.facts.emplace_back("tolerance", result.tolerance);
    table.facts.emplace_back("error_estimate", rounded(result.error_estimate(), 3));
    const WavelengthReport& noisiest = result.noisiest();
    const PhaseNoise& noise = noisiest.phase_noise;
    if (noise.largest > 0.1 * result.tolerance) {
        table.facts.emplace_back("phase_noise",
                                 fmt::format("{:.2e} at most, of single directions (rms, relative "
                                             "like error_estimate, which has "
                                             "twice this in it), at {} nm, mu_in {}, mu_out {}, "
                                             "azimuth {}; from the number of sphere "
                                             "sizes; a smaller --tolerance lowers it",
                                             noise.largest, noisiest.wavelength_nm, noise.mu_in,
                                             noise.mu_out, noise.azimuth_deg));
    }
    for (const std::string& line : result.polarisation())
        table.facts.emplace_back("polarisation", line);
    table.facts.emplace_back("method", result.wavelengths.front().solver.method);
    for (const std::string& line : result.shortfalls())
        table.facts.emplace_back("not converged", line);
    add_report(table, result);
}

std::string advice_on(const std::vector<std::string>& shortfalls) {
    std::string advice = "not converged: " + shortfalls.front();
    if (shortfalls.size() > 1) advice += fmt::format("; and {} more", shortfalls.size() - 1);
    return advice + "; all values are written. A larger --tolerance accepts it";
}

Facts page_facts(const Scene& scene, const ResultReport& result, const std::string& command_line) {
    Table table;
    add_facts(table, result, scene,
              "BRDF in 1/sr without the cosine; wavelengths in nm, in vacuum");
    Facts facts = {{"scene", describe(scene)}, {"command", command_line}};
    for (const auto& [name, value] : table.facts) {
        const auto* number = std::get_if<double>(&value);
        facts.emplace_back(
            name, number != nullptr ? fmt::format("{}", *number) : std::get<std::string>(value));
    }
    return facts;
}

}  // namespace miebrdf::program
