// miebrdf export: a scene's BRDF in the formats that renderers and tools read.
#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include <miebrdf/brdf.h>
#include <miebrdf/error.h>
#include <miebrdf/formats.h>
#include <miebrdf/version.h>
#include "pipeline/solve/single_scattering.h"
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/export_options.h"

namespace miebrdf::program {
namespace {

std::string describe(const ExportedFile& file) {
    std::string line = file.path.string();
    line += file.bytes > 0 ? fmt::format(": {} bytes", file.bytes) : ": written";
    if (!file.deviation) return line + ", exact at its directions";
    line += "; read back, relative error (rms)";
    for (std::size_t band = 0; band < 3; ++band) {
        line += fmt::format("{} {:.2g} at {}", band == 0 ? "" : ",", file.deviation->rms[band],
                            kDeviationBands[band]);
    }
    return line + fmt::format(", {:.2g} near the mirror direction", file.deviation->lobe);
}

/// What `--json` tells of the files.
Table table_of(const std::vector<ExportedFile>& files, const ResultReport& report) {
    Table table;
    table.facts = {{"error_estimate", rounded(report.error_estimate(), 3)},
                   {"tolerance", report.tolerance},
                   {"converged", std::string(report.converged() ? "yes" : "no")}};
    table.columns = {"file", "bytes"};
    for (const char* band : kDeviationBands) {
        table.columns.push_back(fmt::format("rms_deviation ({})", band));
    }
    table.columns.emplace_back("lobe_deviation");
    for (const ExportedFile& file : files) {
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

int export_albedo(const std::string& format, const Brdf& brdf, const Shell& shell) {
    const AlbedoValues values = brdf.albedo({1.0});
    ReflectanceSpectrum spectrum;
    spectrum.wavelength_nm = brdf.wavelength_nm();
    spectrum.value = values.spherical_albedo;
    spectrum.comments = {
        fmt::format("miebrdf {}", kVersion), shell.command_line(),
        "spherical albedo (reflectance under diffuse light), wavelengths in nm in vacuum"};
    for (const std::string& source : values.sources)
        spectrum.comments.push_back("source: " + source);
    export_spectrum(spectrum, format, shell.common().output);
    tell_written(values.converged(), shell);
    return values.converged() ? kGood : kNotConverged;
}

int export_scattering(const std::string& format, const Brdf& brdf, const Shell& shell) {
    // The base alone: layers are for light transfer.
    if (brdf.scene().substrate)
        throw UsageError("scattering: a substrate has no single scattering; give a --base");
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
    ScatteringTable table;
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
    export_scattering(table, format, shell.common().output);
    tell_written(converged, shell);
    return converged ? kGood : kNotConverged;
}

int write_export(const Brdf& brdf, const ExportArguments& arguments, const Shell& shell) {
    const std::string& output = shell.common().output;
    const ExportOptions options = arguments.file();
    const BrdfTable table =
        brdf.table({parse_brdf_part(arguments.component()), shell.command_line()});
    std::vector<ExportedFile> files;
    try {
        files = export_brdf(table, arguments.format(), output, options, shell.control());
    } catch (const TooCoarse& error) {
        shell.note(fmt::format("error: {}; --max-error accepts it as it is", error.what()));
        return kCheckFailed;
    }
    for (const auto& file : files) shell.note(describe(file));
    const ResultReport& report = table.report();
    shell.tell_written(table_of(files, report));
    shell.note(report.summary() + (report.converged() ? "" : "; all values are written"));
    return report.converged() ? kGood : kNotConverged;
}

Job prepare_export(const std::shared_ptr<ExportArguments>& arguments, const Shell& shell) {
    const std::string& output = shell.common().output;
    if (output.empty() || output == "-")
        throw UsageError("export needs -o FILE (in a scene file, an 'output')");
    arguments->check_format();
    const Request request = arguments->scene();
    const Brdf brdf = solved(request, shell.control());
    const std::string format = arguments->format().name;
    if (arguments->format().content == FormatContent::spectrum)
        return [brdf, format, &shell] { return export_albedo(format, brdf, shell); };
    if (arguments->format().content == FormatContent::scattering)
        return [brdf, format, &shell] { return export_scattering(format, brdf, shell); };
    arguments->file();  // refuses lists that are wrong
    return [brdf, arguments, &shell] { return write_export(brdf, *arguments, shell); };
}

}  // namespace

void add_export(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<ExportArguments>();
    arguments->add_to(command, shell);
    shell.add_common_options(command, Writes::file);
    command.footer(
        "Example:\n  miebrdf export --format rgl --base TiO2 --coat AlGaAs7@0.1 --wavelengths "
        "400:700:10 "
        "-o algaas7_on_tio2.bsdf");
    shell.on_prepare(command, [arguments, &shell] { return prepare_export(arguments, shell); });
}

}  // namespace miebrdf::program
