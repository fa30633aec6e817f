// Results describe themselves here.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/solve/polarisation.h"

namespace miebrdf {

BrdfPart parse_brdf_part(const std::string& name) {
    for (const BrdfPart part : {BrdfPart::total, BrdfPart::subsurface, BrdfPart::surface}) {
        if (name == name_of(part)) return part;
    }
    throw UsageError(
        fmt::format("unknown component '{}'; allowed: total, subsurface, surface", name));
}

const char* name_of(BrdfPart part) {
    switch (part) {
        case BrdfPart::subsurface:
            return "subsurface";
        case BrdfPart::surface:
            return "surface";
        case BrdfPart::total:
            break;
    }
    return "total";
}

bool ResultReport::converged() const {
    return std::all_of(wavelengths.begin(), wavelengths.end(),
                       [](const WavelengthReport& report) { return report.converged; });
}

const WavelengthReport& ResultReport::worst() const {
    return *std::max_element(wavelengths.begin(), wavelengths.end(),
                             [](const WavelengthReport& a, const WavelengthReport& b) {
                                 return a.error_estimate < b.error_estimate;
                             });
}

const WavelengthReport& ResultReport::noisiest() const {
    return *std::max_element(wavelengths.begin(), wavelengths.end(),
                             [](const WavelengthReport& a, const WavelengthReport& b) {
                                 return a.phase_noise.largest < b.phase_noise.largest;
                             });
}

double ResultReport::error_estimate() const { return worst().error_estimate; }

namespace {

/// Within a degree, along whose circles glories of large spheres lie.
bool is_straight_back(const rte::SolverReport& solver) {
    const auto deg = [](double mu) { return std::acos(mu) * 180.0 / std::numbers::pi; };
    const double in = deg(solver.worst_mu_in), out = deg(solver.worst_mu_out);
    // Along the normal all azimuths are one.
    const double across = std::abs(solver.worst_azimuth_deg - 180.0) *
                          std::sqrt((1.0 - solver.worst_mu_in) * (1.0 + solver.worst_mu_in));
    return std::hypot(in - out, across) <= 1.0;
}

/// Nothing but what leaving polarisation out may change is beyond what was asked for.
bool is_polarisation_alone(const WavelengthReport& report, double tolerance) {
    return !report.converged && report.solver.converged && report.error_estimate <= tolerance &&
           report.polarisation_left_out > tolerance;
}

}  // namespace

std::vector<std::string> ResultReport::shortfalls() const {
    std::vector<std::string> lines;
    for (const WavelengthReport& report : wavelengths) {
        if (report.converged) continue;
        std::string& line = lines.emplace_back(fmt::format(
            "{} nm: error estimate {:.2e}", report.wavelength_nm, report.error_estimate));
        const rte::SolverReport& solver = report.solver;
        if (is_polarisation_alone(report, tolerance)) {
            line += fmt::format(
                ", but polarisation was left out, which may change values by up to {:.1g} of the "
                "largest at that incidence (estimate): stokes 3 computes it, except below rough "
                "boundaries; stokes 1 asks for light without it",
                report.polarisation_left_out);
            continue;
        }
        if (!(solver.worst_mu_out > 0.0)) continue;  // an albedo
        const PhaseNoise& noise = report.phase_noise;
        if (solver.error_estimate + report.mie_error_estimate < 0.5 * report.error_estimate) {
            line += fmt::format(
                " at mu_in {}, mu_out {}, azimuth {}: points of the phase function (a glory or a "
                "rainbow) that the number of sphere sizes does not settle; a larger tolerance "
                "accepts it, other directions are better",
                noise.mu_in, noise.mu_out, noise.azimuth_deg);
            continue;
        }
        if (solver.converged) {  // nothing alone is too much
            line += fmt::format(
                ": radiative transfer up to {:.1e} (mu_in {}, mu_out {}, azimuth {}), points of "
                "the phase function up to {:.1e} (mu_in {}, mu_out {}, azimuth {}), size averages "
                "{:.1e}",
                solver.error_estimate, solver.worst_mu_in, solver.worst_mu_out,
                solver.worst_azimuth_deg, 2.0 * noise.largest, noise.mu_in, noise.mu_out,
                noise.azimuth_deg, report.mie_error_estimate);
            continue;
        }
        line += fmt::format(
            " at mu_in {}, mu_out {}, azimuth {}; {:.4g} % of the values are within the tolerance",
            solver.worst_mu_in, solver.worst_mu_out, solver.worst_azimuth_deg,
            100.0 * solver.share_within_tolerance);
        if (is_straight_back(solver)) {
            line +=
                " (straight back towards the light; glories of large spheres there are narrower "
                "than nodes resolve, and more of them hardly help: directions a degree away are "
                "better)";
        }
    }
    return lines;
}

std::string ResultReport::shortfall() const {
    return fmt::format("{}", fmt::join(shortfalls(), "\n"));
}

std::vector<std::string> ResultReport::polarisation() const {
    std::size_t polarised = 0;
    int components = 1;
    double left_out = 0.0;
    bool shows = false;
    for (const WavelengthReport& at : wavelengths) {
        polarised += at.stokes > 1 ? 1 : 0;
        components = std::max(components, at.stokes);
        left_out = std::max(left_out, at.polarisation_left_out);
        shows = shows || is_polarisation_alone(at, tolerance);
    }
    std::vector<std::string> lines;
    if (polarised > 0) {
        lines.push_back(fmt::format("{} components of light at {} of {} wavelengths", components,
                                    polarised, wavelengths.size()));
    }
    if (left_out >= kNotCompared) {
        lines.push_back(
            "left out: what it changes is not looked at (a rough surface, crowded particles and "
            "methods by name are for unpolarised light)");
    } else if (shows || left_out > std::max(tolerance, kPromisedWithoutPolarisation)) {
        lines.push_back(fmt::format(
            "left out, although it shows: it may change values by up to {:.1g} of the largest at "
            "that incidence (estimate; stokes 3 computes it, except below rough boundaries)",
            left_out));
    } else if (left_out > 0.0) {
        lines.push_back(fmt::format(
            "left out: it changes values by less than {:.1g} of the largest at that incidence "
            "(estimate; stokes 3 computes it)",
            left_out));
    }
    return lines;
}

std::string ResultReport::summary() const {
    const WavelengthReport& least = worst();
    std::string estimate = fmt::format("solver's error estimate {:.1e} (tolerance {:.1e})",
                                       least.error_estimate, tolerance);
    if (converged()) return estimate;
    // Something else than the estimate: polarisation that was left out.
    if (least.error_estimate <= tolerance) return "not converged: " + shortfalls().front();
    double share = 0.0;
    for (const WavelengthReport& report : wavelengths)
        share += report.solver.share_within_tolerance / static_cast<double>(wavelengths.size());
    return fmt::format(
        "not converged: {}, largest at {} nm, mu_in {}, mu_out {}, azimuth {} degrees; single "
        "scattering's part of it {:.1e}; {:.3g} % of the directions compared are within tolerance",
        estimate, least.wavelength_nm, least.solver.worst_mu_in, least.solver.worst_mu_out,
        least.solver.worst_azimuth_deg, least.mie_error_estimate, 100.0 * share);
}

const std::vector<double>& BrdfValues::Slice::of(BrdfPart part) const {
    switch (part) {
        case BrdfPart::subsurface:
            return subsurface;
        case BrdfPart::surface:
            return surface;
        case BrdfPart::total:
            break;
    }
    return total;
}

double BrdfValues::at(std::size_t wavelength, std::size_t in, std::size_t out, std::size_t azimuth,
                      BrdfPart part) const {
    const std::size_t outs = directions.mu_out.size(), azimuths = directions.azimuth_deg.size();
    if (wavelength >= slices.size() || in >= directions.mu_in.size() || out >= outs ||
        azimuth >= azimuths) {
        throw UsageError(fmt::format(
            "no value at [{}, {}, {}, {}]; there are {} wavelengths, {} "
            "mu_in, {} mu_out, {} azimuths",
            wavelength, in, out, azimuth, slices.size(), directions.mu_in.size(), outs, azimuths));
    }
    const std::vector<double>& values = slices[wavelength].of(part);
    if (values.empty())
        throw UsageError(fmt::format("there are no values of the part '{}'", name_of(part)));
    return values[(in * outs + out) * azimuths + azimuth];
}

double AlbedoValues::at(std::size_t wavelength, std::size_t in) const {
    if (wavelength >= plane_albedo.size() || in >= mu_in.size()) {
        throw UsageError(fmt::format("no albedo at [{}, {}]; there are {} wavelengths, {} mu_in",
                                     wavelength, in, plane_albedo.size(), mu_in.size()));
    }
    return plane_albedo[wavelength][in];
}

}  // namespace miebrdf
