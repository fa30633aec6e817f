#include "tools/miebrdf/export_options.h"

#include <fmt/format.h>

#include <algorithm>

#include <miebrdf/error.h>
#include "pipeline/formats/rgb_weights.h"
#include "pipeline/scene/number_list.h"
#include "tools/miebrdf/export_formats.h"

namespace miebrdf::program {

void ExportArguments::add_to(CLI::App& command, Shell& shell) {
    command_ = &command;
    command
        .add_option("--format", options_.format,
                    fmt::format("{}", fmt::join(all_export_formats(), ", ")))
        ->type_name("NAME")
        ->required();
    scene_.add_to(command, shell);
    command.add_option("--component", component_, "total, subsurface or surface")
        ->capture_default_str();
    add_file_options(command);
}

void ExportArguments::add_file_options(CLI::App& command) {
    auto* group = command.add_option_group("File");
    group
        ->add_option("--resolution", options_.resolution,
                     "all but merl, klems, spd, irregular, scattering: fineness, format by format "
                     "(docs/formats); 0: the format's default")
        ->check(CLI::Range(0, 4096))
        ->capture_default_str();
    group->add_option("--incident-angles", options_.incident_angles, "rgl: angles of incidence")
        ->capture_default_str();
    group->add_option("--mu-in", mu_in_, "csv, json, npz, exr: cosines of incidence")
        ->type_name("LIST");
    group->add_option("--mu-out", mu_out_, "csv, json, npz, exr: cosines of reflection")
        ->type_name("LIST");
    group->add_option("--azimuth", azimuth_, "csv, json, npz, exr: degrees, 0 = mirror side")
        ->type_name("LIST");
    group
        ->add_option(
            "--rgb", rgb_,
            "colour of exr, pbrt, rgl, merl, radiance, klems: cie (observer and D65), wavelengths "
            "(the nearest to 620, 535, 480 nm), auto: cie where the wavelengths cover the visible")
        ->capture_default_str();
    group->add_flag("--bin-centres", merl_centres_,
                    "merl: sample bins at their centres, for readers that do not interpolate");
    group
        ->add_option(
            "--max-error", options_.largest_error,
            "formats that are read back (pbrt to klems): largest relative error (rms, at "
            "mu > 0.2 and near the mirror direction) that is accepted; 0: the format's own")
        ->capture_default_str();
}

bool ExportArguments::given(const std::string& option) const {
    // Words of the scene may come from a scene file, where no option is typed.
    return scene_.given(option.substr(2)) || command_->get_option(option)->count() > 0;
}

void ExportArguments::check_format() const {
    const std::vector<std::string> taken = file_options_of(format());
    for (const std::string& name : ignored_options_of(format())) {
        if (!given(name)) continue;
        throw UsageError(fmt::format(
            "format '{}' has no use for {}; {}", format(), name,
            taken.empty()
                ? std::string("it has no options of the file")
                : fmt::format("of the file's options it takes {}", fmt::join(taken, ", "))));
    }
    if (command_->get_option("--resolution")->count() > 0 && !mu_in_.empty() && !mu_out_.empty() &&
        !azimuth_.empty()) {
        throw UsageError("--resolution is for lists that are not given; here all three are");
    }
    parse_brdf_part(component_);
}

Request ExportArguments::scene() const {
    Request request = scene_.parse();
    std::sort(request.wavelength_nm.begin(), request.wavelength_nm.end());  // rgb comes descending
    return request;
}

exports::ExportOptions ExportArguments::file(const std::vector<double>& wavelength_nm) const {
    exports::ExportOptions options = options_;
    if (!mu_in_.empty()) options.grid.mu_in = parse_number_list(mu_in_, "mu_in", 0.0, 1.0, true);
    if (!mu_out_.empty())
        options.grid.mu_out = parse_number_list(mu_out_, "mu_out", 0.0, 1.0, true);
    if (!azimuth_.empty()) {
        options.grid.azimuth_deg = parse_number_list(azimuth_, "azimuth (degrees)", -360.0, 360.0);
    }
    options.merl_sample =
        merl_centres_ ? exports::MerlSample::centre : exports::MerlSample::lower_edge;
    options.rgb = exports::rgb_weights(rgb_, wavelength_nm);
    return options;
}

}  // namespace miebrdf::program
