// miebrdf export: a scene's BRDF in the formats that renderers and tools read.
#include <fmt/format.h>

#include <algorithm>
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
#include "tools/miebrdf/result_facts.h"

namespace miebrdf::program {
namespace {

/// One line for the file, and one for each region of what was read back.
std::string describe(const ExportedFile& file) {
    std::string text = file.path.string();
    text += file.bytes > 0 ? fmt::format(": {} bytes", file.bytes) : ": written";
    if (file.resolution > 0)
        text += fmt::format(", --resolution {} (the standard is too coarse here)", file.resolution);
    if (!file.deviation) return text + ", exact at its directions";
    text += "; read back as its readers do, relative errors (rms, and the worst value):";
    for (const RegionDeviation& region : file.deviation->regions)
        text += fmt::format("\n  {:<22} {:<8.2g} {}", region.name, region.rms, worst_of(region));
    return text;
}

/// The table of the files that `--json` prints.
Table table_of(const std::vector<ExportedFile>& files) {
    Table table;
    table.columns = {"file", "bytes"};
    const bool read_back = !files.empty() && files.front().deviation.has_value();
    if (read_back) {
        for (const RegionDeviation& region : files.front().deviation->regions) {
            table.columns.push_back(fmt::format("rms_deviation ({})", region.name));
            table.columns.push_back(fmt::format("worst_deviation ({})", region.name));
        }
    }
    for (const ExportedFile& file : files) {
        std::vector<Cell> row = {file.path.string(), double(file.bytes)};
        if (file.deviation) {
            for (const RegionDeviation& region : file.deviation->regions) {
                row.emplace_back(rounded(region.rms, 3));
                row.emplace_back(rounded(region.worst, 3));
            }
        }
        table.rows.push_back(std::move(row));
    }
    return table;
}

/// How the values that were asked for came out.
struct Requested {
    ResultReport report;
    std::string warning;  ///< of directions that nobody asked for by name
};

/// Directions of a table or a renderer's format reach down to the horizon, where forward peaks of
/// large particles are solved last, and through retro-reflection, where single values are noisy.
/// What misses there alone is a warning; elsewhere, and at directions that were listed, it is a
/// failure, as it is for `brdf`.
Requested requested_of(const Brdf& brdf, const ResultReport& report, const ExportOptions& options,
                       const ExportArguments& arguments) {
    const BrdfPart part = parse_brdf_part(arguments.component());
    const BrdfParts parts{part == BrdfPart::subsurface, part == BrdfPart::surface,
                          part == BrdfPart::total};
    constexpr std::size_t kMostAsked = 100000;  // more would cost as much again as the file
    const Directions& lists = options.directions;
    const std::size_t asked = lists.mu_in.size() * lists.mu_out.size() * lists.azimuth_deg.size();
    if (arguments.lists_all_directions() && asked <= kMostAsked)
        return {brdf.evaluate(lists, parts), ""};
    if (report.converged()) return {report, ""};
    constexpr double kGrazing = 0.2;
    const Directions steep{{kGrazing, 0.3, 0.6, 1.0}, {0.25, 0.5, 0.8, 0.95}, {0, 60, 120}};
    const ResultReport rest = brdf.evaluate(steep, parts);
    if (!rest.converged()) return {report, ""};
    const WavelengthReport& worst = report.worst();
    const bool grazes = std::min(worst.solver.worst_mu_in, worst.solver.worst_mu_out) < kGrazing;
    const std::string where =
        grazes ? fmt::format("grazing directions (mu < {})", kGrazing) : "single directions";
    return {rest, fmt::format("warning: {} miss the tolerance of {:.1e}: error estimate {:.1e} at "
                              "{} nm, mu_in {}, mu_out {}, azimuth {}",
                              where, report.tolerance, worst.error_estimate, worst.wavelength_nm,
                              worst.solver.worst_mu_in, worst.solver.worst_mu_out,
                              worst.solver.worst_azimuth_deg)};
}

void tell_written(bool converged, const Shell& shell) {
    shell.tell_written({.facts = {{"converged", std::string(converged ? "yes" : "no")}},
                        .columns = {"file"},
                        .rows = {{shell.common().output}}});
}

/// Renderers take a reflectance for 0 where its file says nothing. Grey comes out as grey within
/// 0.5 % from these on, and green from the default of 480 to 620 nm.
void warn_of_narrow_range(const std::vector<double>& wavelength_nm, const Shell& shell) {
    constexpr double kFirst_nm = 400.0, kLast_nm = 700.0;
    if (wavelength_nm.front() <= kFirst_nm && wavelength_nm.back() >= kLast_nm) return;
    shell.note(
        fmt::format("warning: Mitsuba 3 and pbrt-v4 take 0 outside {} to {} nm, where the "
                    "file ends; colours need --wavelengths {}:{}:10",
                    wavelength_nm.front(), wavelength_nm.back(), kFirst_nm, kLast_nm));
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
    if (!values.mirror_reflectance.empty()) {
        const double share = values.mirror_reflectance[values.mirror_reflectance.size() / 2][0];
        spectrum.comments.push_back(fmt::format(
            "mirror reflection included: {:.3g} % along the normal at {} nm; below a dielectric of "
            "the renderer's own it counts twice",
            100.0 * share, spectrum.wavelength_nm[spectrum.wavelength_nm.size() / 2]));
        shell.note(spectrum.comments.back());
    }
    export_spectrum(spectrum, format, shell.common().output);
    tell_written(values.converged(), shell);
    warn_of_narrow_range(spectrum.wavelength_nm, shell);
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
    demand.whole_phase_function = true;  // a peak that is cut short is no phase function
    if (scene.particles.tolerance > 0.0) demand.tolerance = scene.particles.tolerance;
    std::vector<std::size_t> wavelengths(brdf.wavelength_nm().size());
    std::iota(wavelengths.begin(), wavelengths.end(), std::size_t{0});
    const auto optics = optics_of(resolved, {0}, wavelengths, demand, shell.control());
    ScatteringTable table;
    table.wavelength_nm = brdf.wavelength_nm();
    bool converged = true, is_cut = false;
    for (const std::vector<MediumOptics>& media : optics) {
        const MediumOptics& o = media.front();
        table.single_scattering_albedo.push_back(o.optics.single_scattering_albedo);
        table.asymmetry.push_back(o.asymmetry);
        table.q_ext.push_back(o.q_ext.value_or(std::numeric_limits<double>::quiet_NaN()));
        table.chi.push_back(o.optics.chi);
        converged = converged && o.converged;
        is_cut = is_cut || o.optics.has_more_moments;
    }
    if (is_cut) {
        shell.note(
            fmt::format("the phase function has more moments than the {} in the file. Their sum is "
                        "not the phase function; codes that apply delta-M can use them",
                        table.chi.front().size()));
    }
    nlohmann::ordered_json metadata = {
        {"generator", fmt::format("miebrdf {}", kVersion)},
        {"command", shell.command_line()},
        {"medium", describe(scene.base)},
        {"source", resolved.sources.front()},
        {"chi", "Legendre moments, chi_0 = 1, without 2l + 1"},
        {"complete", !is_cut},
        {"lm_a1", "(2l + 1) chi_l, the Legendre coefficients of the phase function with mean 1"},
        {"ssa", "scattering / extinction"},
        {"q_ext", "extinction efficiency; not a number for media without particles"}};
    if (brdf.scene().boundary || !brdf.scene().layers.empty()) {
        metadata["left_out"] = "the boundary and the layers of the scene: this is its base alone";
        shell.note("not in the file: " + metadata["left_out"].get<std::string>());
    }
    table.metadata = metadata.dump(1);
    export_scattering(table, format, shell.common().output);
    tell_written(converged, shell);
    return converged ? kGood : kNotConverged;
}

/// Says before the work begins what will need much room.
void announce_size(const ExportArguments& arguments, std::size_t wavelengths, const Shell& shell) {
    constexpr std::uintmax_t kMuch = 100'000'000;
    const std::uintmax_t bytes = expected_bytes(arguments.format(), arguments.file(), wavelengths);
    if (bytes < kMuch) return;
    shell.note(fmt::format("the file will have about {} MB; a smaller --resolution needs less",
                           bytes / 1'000'000));
}

/// Writes the files of a BRDF; nothing where they would be too coarse, which is said.
std::optional<std::vector<ExportedFile>> write_files(const BrdfSource& source,
                                                     const ExportArguments& arguments,
                                                     const ExportOptions& options,
                                                     const Shell& shell) {
    announce_size(arguments, source.channels().size(), shell);
    const std::string left_out = left_out_of(arguments.format(), source.provenance());
    if (!left_out.empty()) shell.note("not in the file: " + left_out);
    try {
        const auto files = export_brdf(source, arguments.format(), shell.common().output, options,
                                       shell.control());
        for (const ExportedFile& file : files) shell.note(describe(file));
        return files;
    } catch (const TooCoarse& error) {
        shell.note(
            fmt::format("error: {}; --accept-error writes the file all the same", error.what()));
        return std::nullopt;
    }
}

/// The largest directional albedo of what was written, at all incidences, as `check` integrates it;
/// empty: the format does not tell.
std::optional<double> largest_albedo_of(const std::vector<ExportedFile>& files) {
    std::optional<double> largest;
    for (const ExportedFile& file : files) {
        try {
            const FileCheck check = check_file(file.path.string());
            if (check.largest_albedo)
                largest = std::max(largest.value_or(0.0), *check.largest_albedo);
        } catch (const InputError&) {  // a file beside others, of another kind
        }
    }
    return largest;
}

/// Measured directions as a file.
int write_measured(const Measurements& measured, const ExportArguments& arguments,
                   const Shell& shell) {
    Provenance provenance;
    provenance.version = std::string("miebrdf ") + kVersion;
    provenance.command_line = shell.command_line();
    const InterpolatedBrdf brdf = interpolated_brdf(measured, provenance, shell.control());
    for (const std::string& doubt : measured.doubts) shell.note("doubt: " + doubt);
    for (const std::string& doubt : brdf.doubts) shell.note("doubt: " + doubt);
    const auto files = write_files(*brdf.source, arguments, arguments.file(), shell);
    if (!files) return kCheckFailed;
    const std::optional<double> largest = largest_albedo_of(*files);
    shell.note(fmt::format(
        "{}; worst of those left out {:+.2g} % at mu_in {:.3g}, mu_out {:.3g}, azimuth {:.4g}; "
        "largest directional albedo {:.3g} from mu_in {:.3g} up, as measured{}",
        brdf.source->provenance().accuracy, 100.0 * brdf.worst, brdf.where.mu_in, brdf.where.mu_out,
        brdf.where.azimuth_deg, brdf.largest_albedo, brdf.least_mu_in,
        largest ? fmt::format("; {:.3g} with the extrapolated incidences below", *largest) : ""));
    Table table = table_of(*files);
    table.facts = {{"measured", measured.file},
                   {"values", double(brdf.values)},
                   {"residual_rms", rounded(brdf.residual_rms, 3)},
                   {"leave_one_out_rms", rounded(brdf.leave_one_out_rms, 3)},
                   {"largest_measured_albedo", rounded(brdf.largest_albedo, 4)}};
    if (largest) table.facts.emplace_back("largest_albedo", rounded(*largest, 4));
    shell.tell_written(std::move(table));
    return kGood;
}

int write_export(const Brdf& brdf, const ExportArguments& arguments, const Shell& shell) {
    ExportOptions options = arguments.file();
    if (arguments.format().name == "mtlx") options.subsurface = subsurface_of(brdf);
    std::string command = shell.command_line();
    if (brdf.scene().surface && arguments.coupling_by_default())
        command += " --coupling reciprocal";  // files say what they hold
    const BrdfTable table = brdf.table({.part = parse_brdf_part(arguments.component()),
                                        .command_line = command,
                                        .whole_matrix = arguments.format().whole_matrix});
    const auto files = write_files(table, arguments, options, shell);
    if (!files) return kCheckFailed;
    const Requested requested = requested_of(brdf, table.report(), options, arguments);
    const bool converged = requested.report.converged();
    Table written = table_of(*files);
    written.facts = {{"error_estimate", rounded(requested.report.error_estimate(), 3)},
                     {"tolerance", requested.report.tolerance},
                     {"converged", std::string(converged ? "yes" : "no")}};
    shell.tell_written(std::move(written));
    shell.note(requested.report.summary());
    if (!requested.warning.empty()) shell.note(requested.warning);
    if (!converged) shell.set_advice(advice_on(requested.report.shortfalls()));
    return converged ? kGood : kNotConverged;
}

/// What passes a film.
int write_transmitted(const Brdf& brdf, const ExportArguments& arguments, const Shell& shell) {
    const FilmTransmission film(brdf, shell.command_line());
    const auto files = write_files(film, arguments, arguments.file(), shell);
    if (!files) return kCheckFailed;
    const bool converged = film.report().converged();
    Table written = table_of(*files);
    written.facts = {{"error_estimate", rounded(film.report().error_estimate(), 3)},
                     {"tolerance", film.report().tolerance},
                     {"converged", std::string(converged ? "yes" : "no")}};
    shell.tell_written(std::move(written));
    shell.note(film.report().summary());
    if (!converged) shell.set_advice(advice_on(film.report().shortfalls()));
    return converged ? kGood : kNotConverged;
}

Job prepare_export(const std::shared_ptr<ExportArguments>& arguments, const Shell& shell) {
    const std::string& output = shell.common().output;
    if (output.empty() || output == "-")
        throw UsageError("export needs -o FILE (in a scene file, an 'output')");
    arguments->check_format();
    if (arguments->from_measurements()) {
        arguments->file();  // refuses lists that are wrong
        return [measured = arguments->measurements(), arguments, &shell] {
            return write_measured(measured, *arguments, shell);
        };
    }
    const Request request = arguments->scene();
    const Brdf brdf = solved(request, shell.control());
    const std::string format = arguments->format().name;
    if (arguments->format().content == FormatContent::spectrum)
        return [brdf, format, &shell] { return export_albedo(format, brdf, shell); };
    if (arguments->format().content == FormatContent::scattering)
        return [brdf, format, &shell] { return export_scattering(format, brdf, shell); };
    arguments->file();  // refuses lists that are wrong
    if (arguments->component() == kTransmitted)
        return [brdf, arguments, &shell] { return write_transmitted(brdf, *arguments, shell); };
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
        "-o algaas7_on_tio2.bsdf\n  miebrdf export --format rgl --from goniometer.csv -o "
        "sample.bsdf");
    shell.on_prepare(command, [arguments, &shell] { return prepare_export(arguments, shell); });
}

}  // namespace miebrdf::program
