// miebrdf export: a scene's BRDF in the formats that renderers and tools read.
#include <fmt/format.h>

#include <cmath>

#include "pipeline/error.h"
#include "pipeline/exports/brdf_export.h"
#include "pipeline/exports/rgb_weights.h"
#include "pipeline/exports/solved_source.h"
#include "pipeline/number_list.h"
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/scene_options.h"
#include "tools/miebrdf/spectrum_export.h"

namespace miebrdf::program {
namespace {

struct ExportArguments {
    SceneArguments scene;
    std::string component = "total";
    std::string mu_in, mu_out, azimuth;
    std::string rgb = "auto";
    bool merl_centres = false;
    exports::ExportOptions options;
};

exports::ExportOptions parse(const ExportArguments& arguments,
                             const std::vector<double>& wavelength_nm) {
    exports::ExportOptions options = arguments.options;
    if (!arguments.mu_in.empty()) {
        options.grid.mu_in = parse_number_list(arguments.mu_in, "mu_in", 0.0, 1.0, true);
    }
    if (!arguments.mu_out.empty()) {
        options.grid.mu_out = parse_number_list(arguments.mu_out, "mu_out", 0.0, 1.0, true);
    }
    if (!arguments.azimuth.empty()) {
        options.grid.azimuth_deg =
            parse_number_list(arguments.azimuth, "azimuth (degrees)", -360.0, 360.0);
    }
    options.merl_sample =
        arguments.merl_centres ? exports::MerlSample::centre : exports::MerlSample::lower_edge;
    options.rgb = exports::rgb_weights(arguments.rgb, wavelength_nm);
    return options;
}

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

int run_export(const ExportArguments& arguments, const Shell& shell) {
    const std::string& output = shell.common().output;
    if (output.empty() || output == "-") throw UsageError("export needs -o FILE");
    const Request request = arguments.scene.parse();
    if (is_spectrum_format(arguments.options.format)) {
        return export_spectrum(arguments.options.format, request, shell);
    }
    const exports::ExportOptions options = parse(arguments, request.wavelength_nm);
    const exports::SolvedSource source(request, exports::parse_component(arguments.component),
                                       shell.command_line(), shell.control());
    try {
        for (const auto& file : exports::export_brdf(source, options, output, shell.control())) {
            shell.note(describe(file));
        }
    } catch (const exports::TooCoarse& error) {
        shell.note(std::string("error: ") + error.what());
        return kCheckFailed;
    }
    const exports::SolverAccuracy& accuracy = source.accuracy();
    shell.note(describe(accuracy) + (accuracy.converged ? "" : "; all values are written"));
    return accuracy.converged ? kGood : kNotConverged;
}

}  // namespace

void add_export_command(CLI::App& program, Shell& shell) {
    auto* command =
        program.add_subcommand("export", "the BRDF of a scene as a file for renderers and tools");
    auto arguments = std::make_shared<ExportArguments>();
    command
        ->add_option("--format", arguments->options.format,
                     fmt::format("{}, spd, irregular, scattering",
                                 fmt::join(exports::export_formats(), ", ")))
        ->type_name("NAME")
        ->required();
    arguments->scene.add_to(*command);
    command->add_option("--component", arguments->component, "total, subsurface or surface")
        ->capture_default_str();
    auto* group = command->add_option_group("File");
    group
        ->add_option("--resolution", arguments->options.resolution,
                     "fineness, format by format (docs/formats); 0: the format's default")
        ->check(CLI::Range(0, 4096))
        ->capture_default_str();
    group
        ->add_option("--incident-angles", arguments->options.incident_angles,
                     "rgl: angles of incidence")
        ->capture_default_str();
    group->add_option("--mu-in", arguments->mu_in, "csv, json, npz, exr: cosines of incidence")
        ->type_name("LIST");
    group->add_option("--mu-out", arguments->mu_out, "csv, json, npz, exr: cosines of reflection")
        ->type_name("LIST");
    group
        ->add_option("--azimuth", arguments->azimuth,
                     "csv, json, npz, exr: degrees, 0 = mirror side")
        ->type_name("LIST");
    group
        ->add_option(
            "--rgb", arguments->rgb,
            "colour of RGB formats: cie (observer and D65), wavelengths (the nearest to 620, 535, "
            "480 nm), auto: cie where the wavelengths cover the visible")
        ->capture_default_str();
    group->add_flag("--bin-centres", arguments->merl_centres,
                    "merl: sample bins at their centres, for readers that do not interpolate");
    group
        ->add_option(
            "--max-error", arguments->options.largest_error,
            "largest relative error (rms, at mu > 0.2 and near the mirror direction) that is "
            "accepted on reading back; 0: the format's own")
        ->capture_default_str();
    shell.add_common_options(*command);
    command->footer(
        "Example:\n  miebrdf export --format rgl --base TiO2 --coat AlGaAs7@0.1 --wavelengths "
        "400:700:10 "
        "-o algaas7_on_tio2.bsdf");
    shell.on_run(*command, [arguments, &shell] { return run_export(*arguments, shell); });
}

}  // namespace miebrdf::program
