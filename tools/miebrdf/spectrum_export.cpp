#include "tools/miebrdf/spectrum_export.h"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include <miebrdf/error.h>
#include <miebrdf/version.h>
#include "pipeline/formats/spectrum_writer.h"
#include "pipeline/io/atomic_file.h"
#include "pipeline/solve/single_scattering.h"

namespace miebrdf::program {
namespace {

/// Moments of a single-scattering table; what radiative-transfer codes with 64 streams use.
constexpr int kHighestMoment = 128;

void tell_written(bool converged, const Shell& shell) {
    shell.tell_written({.facts = {{"converged", std::string(converged ? "yes" : "no")}},
                        .columns = {"file"},
                        .rows = {{shell.common().output}}});
}

int export_albedo(const std::string& format, const Brdf& brdf, const Shell& shell) {
    const AlbedoValues values = brdf.albedo({1.0});
    exports::Spectrum spectrum;
    spectrum.wavelength_nm = brdf.wavelength_nm();
    spectrum.value = values.spherical_albedo;
    spectrum.comments = {
        fmt::format("miebrdf {}", kVersion), shell.command_line(),
        "spherical albedo (reflectance under diffuse light), wavelengths in nm in vacuum"};
    for (const std::string& source : values.sources)
        spectrum.comments.push_back("source: " + source);
    AtomicFile file(shell.common().output);
    if (format == "spd") {
        exports::write_spd(spectrum, file.stream());
    } else {
        exports::write_mitsuba_irregular(spectrum, file.stream());
    }
    file.commit();
    tell_written(values.converged(), shell);
    return values.converged() ? kGood : kNotConverged;
}

int export_scattering(const Brdf& brdf, const Shell& shell) {
    // The base alone: layers are for light transfer.
    const Scene scene{.base = brdf.scene().base,
                      .particles = brdf.scene().particles,
                      .database = brdf.scene().database};
    const ResolvedScene resolved = resolve(scene, brdf.wavelength_nm());
    OpticsDemand demand;
    demand.highest_moment = kHighestMoment;
    if (scene.particles.tolerance > 0.0) demand.tolerance = scene.particles.tolerance;
    std::vector<std::size_t> wavelengths(brdf.wavelength_nm().size());
    std::iota(wavelengths.begin(), wavelengths.end(), std::size_t{0});
    const auto optics = optics_of(resolved, {0}, wavelengths, demand, shell.control());
    exports::ScatteringTable table;
    table.wavelength_nm = brdf.wavelength_nm();
    bool converged = true;
    for (const std::vector<MediumOptics>& media : optics) {
        const MediumOptics& o = media.front();
        table.single_scattering_albedo.push_back(o.optics.single_scattering_albedo);
        table.asymmetry.push_back(o.asymmetry);
        table.q_ext.push_back(o.q_ext.value_or(std::numeric_limits<double>::quiet_NaN()));
        table.chi.push_back(o.optics.chi);
        converged = converged && o.converged;
    }
    const nlohmann::ordered_json metadata = {
        {"generator", fmt::format("miebrdf {}", kVersion)},
        {"command", shell.command_line()},
        {"medium", describe(scene.base)},
        {"source", resolved.sources.front()},
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

int export_spectrum(const std::string& format, const Brdf& brdf, const Shell& shell) {
    return format == "scattering" ? export_scattering(brdf, shell)
                                  : export_albedo(format, brdf, shell);
}

}  // namespace miebrdf::program
