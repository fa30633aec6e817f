#include "tools/miebrdf/spectrum_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include <miebrdf/error.h>
#include <miebrdf/version.h>
#include "pipeline/formats/spectrum_writer.h"
#include "pipeline/io/atomic_file.h"
#include "pipeline/solve/brdf.h"
#include "pipeline/solve/medium_optics.h"
#include "pipeline/solve/parallel.h"

namespace miebrdf::program {
namespace {

/// Moments of a single-scattering table; what radiative-transfer codes with 64 streams use.
constexpr int kHighestMoment = 128;

void tell_written(bool converged, const Shell& shell) {
    shell.tell_written({.facts = {{"converged", std::string(converged ? "yes" : "no")}},
                        .columns = {"file"},
                        .rows = {{shell.common().output}}});
}

int export_albedo(const std::string& format, Request request, const Shell& shell) {
    request.directions.mu_in = {1.0};
    std::sort(request.wavelength_nm.begin(), request.wavelength_nm.end());
    const AlbedoResult result = compute_albedo(request, shell.control());
    exports::Spectrum spectrum;
    for (const AlbedoSlice& slice : result.slices) {
        spectrum.wavelength_nm.push_back(slice.wavelength_nm);
        spectrum.value.push_back(slice.spherical_albedo);
    }
    spectrum.comments = {
        fmt::format("miebrdf {}", kVersion), shell.command_line(),
        "spherical albedo (reflectance under diffuse light), wavelengths in nm in vacuum"};
    for (const std::string& source : result.sources)
        spectrum.comments.push_back("source: " + source);
    AtomicFile file(shell.common().output);
    if (format == "spd") {
        exports::write_spd(spectrum, file.stream());
    } else {
        exports::write_mitsuba_irregular(spectrum, file.stream());
    }
    file.commit();
    tell_written(result.converged, shell);
    return result.converged ? kGood : kNotConverged;
}

int export_scattering(const Request& request, const Shell& shell) {
    validate(request);
    const ResolvedMedium medium = MediumResolver(request.database).resolve(request.scene.base);
    OpticsDemand demand;
    demand.highest_moment = kHighestMoment;
    if (request.scene.particles.tolerance > 0.0)
        demand.tolerance = request.scene.particles.tolerance;
    std::vector<MediumOptics> optics(request.wavelength_nm.size());
    const mie::Executor pieces = pieces_of_job(shell.control());
    run_parallel("single scattering", optics.size(), shell.control(), [&](std::size_t w) {
        optics[w] = medium_optics(medium, request.wavelength_nm[w], request.scene.particles, demand,
                                  pieces);
    });
    exports::ScatteringTable table;
    table.wavelength_nm = request.wavelength_nm;
    bool converged = true;
    for (const MediumOptics& o : optics) {
        table.single_scattering_albedo.push_back(o.optics.single_scattering_albedo);
        table.asymmetry.push_back(o.asymmetry);
        table.q_ext.push_back(o.q_ext.value_or(std::numeric_limits<double>::quiet_NaN()));
        table.chi.push_back(o.optics.chi);
        converged = converged && o.converged;
    }
    const nlohmann::ordered_json metadata = {
        {"generator", fmt::format("miebrdf {}", kVersion)},
        {"command", shell.command_line()},
        {"medium", describe(request.scene.base)},
        {"source", medium.source},
        {"chi", "Legendre moments, chi_0 = 1, without 2l + 1"},
        {"lm_a1", "(2l + 1) chi_l, the Legendre coefficients of the phase function with mean 1"},
        {"ssa", "scattering / extinction"},
        {"q_ext", "extinction efficiency; not a number for media without particles"}};
    table.metadata = metadata.dump(1);
    exports::write_scattering_npz(table, shell.common().output);
    tell_written(converged, shell);
    return converged ? kGood : kNotConverged;
}

}  // namespace

bool is_spectrum_format(const std::string& format) {
    return format == "spd" || format == "irregular" || format == "scattering";
}

int export_spectrum(const std::string& format, const Request& request, const Shell& shell) {
    return format == "scattering" ? export_scattering(request, shell)
                                  : export_albedo(format, request, shell);
}

}  // namespace miebrdf::program
