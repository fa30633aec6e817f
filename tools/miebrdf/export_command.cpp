// miebrdf export: a scene's BRDF in the formats that renderers and tools read.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include <miebrdf/formats.h>
#include <miebrdf/version.h>
#include "pipeline/solve/brdf.h"
#include "pipeline/solve/medium_optics.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/solved_source.h"
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/export_options.h"

namespace miebrdf::program {
namespace {

std::string describe(const exports::ExportedFile& file) {
    std::string line = file.path.string();
    line += file.bytes > 0 ? fmt::format(": {} bytes", file.bytes) : ": written";
    if (!file.deviation) return line + ", exact at its directions";
    line += "; read back, relative error (rms)";
    for (std::size_t band = 0; band < 3; ++band) {
        line += fmt::format("{} {:.2g} at {}", band == 0 ? "" : ",", file.deviation->rms[band],
                            exports::kDeviationBands[band]);
    }
    return line + fmt::format(", {:.2g} near the mirror direction", file.deviation->lobe);
}

/// What `--json` tells of the files.
Table table_of(const std::vector<exports::ExportedFile>& files,
               const exports::SolverAccuracy& accuracy) {
    Table table;
    table.facts = {{"error_estimate", rounded(accuracy.error_estimate, 3)},
                   {"tolerance", accuracy.tolerance},
                   {"converged", std::string(accuracy.converged ? "yes" : "no")}};
    table.columns = {"file", "bytes"};
    for (const char* band : exports::kDeviationBands) {
        table.columns.push_back(fmt::format("rms_deviation ({})", band));
    }
    table.columns.emplace_back("lobe_deviation");
    for (const exports::ExportedFile& file : files) {
        std::vector<Cell> row = {file.path.string(), double(file.bytes)};
        row.resize(table.columns.size());  // empty: exact at its directions
        for (std::size_t band = 0; file.deviation && band < 3; ++band) {
            row[2 + band] = rounded(file.deviation->rms[band], 3);
        }
        if (file.deviation) row.back() = rounded(file.deviation->lobe, 3);
        table.rows.push_back(std::move(row));
    }
    return table;
}

/// Moments of a single-scattering table; what radiative-transfer codes with 64 streams use.
constexpr int kHighestMoment = 128;

void tell_written(bool converged, const Shell& shell) {
    shell.tell_written({.facts = {{"converged", std::string(converged ? "yes" : "no")}},
                        .columns = {"file"},
                        .rows = {{shell.common().output}}});
}

/// Spherical albedos.
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
    exports::export_spectrum(spectrum, format, shell.common().output);
    tell_written(result.converged, shell);
    return result.converged ? kGood : kNotConverged;
}

/// Albedo and moments of the base's single scattering.
int export_scattering(const std::string& format, const Request& request, const Shell& shell) {
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
    exports::export_scattering(table, format, shell.common().output);
    tell_written(converged, shell);
    return converged ? kGood : kNotConverged;
}

int export_values(const ExportArguments& arguments, const Request& request, const Shell& shell) {
    const exports::ExportOptions options = arguments.file();
    const exports::SolvedSource source(request, exports::parse_component(arguments.component()),
                                       shell.command_line(), shell.control());
    std::vector<exports::ExportedFile> files;
    try {
        files = exports::export_brdf(source, arguments.format(), shell.common().output, options,
                                     shell.control());
    } catch (const exports::TooCoarse& error) {
        shell.note(
            fmt::format("error: {} (--resolution); --max-error accepts it as it is", error.what()));
        return kCheckFailed;
    }
    for (const auto& file : files) shell.note(describe(file));
    const exports::SolverAccuracy& accuracy = source.accuracy();
    shell.tell_written(table_of(files, accuracy));
    shell.note(describe(accuracy) + (accuracy.converged ? "" : "; all values are written"));
    return accuracy.converged ? kGood : kNotConverged;
}

int run_export(const ExportArguments& arguments, const Shell& shell) {
    const std::string& output = shell.common().output;
    if (output.empty() || output == "-") throw UsageError("export needs -o FILE");
    arguments.check_format();
    const exports::Format& format = arguments.format();
    const Request request = arguments.scene();
    switch (format.content) {
        case exports::FormatContent::spectrum:
            return export_albedo(format.name, request, shell);
        case exports::FormatContent::scattering:
            return export_scattering(format.name, request, shell);
        default:
            return export_values(arguments, request, shell);
    }
}

/// One line for each format.
std::string list_of_formats() {
    std::string text = "Formats:\n";
    for (const exports::Format& format : exports::all_formats()) {
        text += fmt::format("  {:<11} {} ({})\n", format.name, format.readers, format.holds);
    }
    return text;
}

}  // namespace

void add_export_command(CLI::App& program, Shell& shell) {
    auto* command =
        program.add_subcommand("export", "the BRDF of a scene as a file for renderers and tools");
    auto arguments = std::make_shared<ExportArguments>();
    arguments->add_to(*command);
    shell.add_common_options(*command, Writes::file);
    command->footer(
        list_of_formats() +
        "Example:\n  miebrdf export --format rgl --base TiO2 --coat AlGaAs7@0.1 --wavelengths "
        "400:700:10 "
        "-o algaas7_on_tio2.bsdf");
    shell.on_run(*command, [arguments, &shell] { return run_export(*arguments, shell); });
}

}  // namespace miebrdf::program
