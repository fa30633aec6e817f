// miebrdf plot: charts of media and scenes.
#include "tools/miebrdf/plot_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <miebrdf/error.h>
#include <miebrdf/version.h>
#include "pipeline/scene/number_list.h"

namespace miebrdf::program {

void PlotArguments::add_to(CLI::App& command) {
    option(command, "--title", title_, "TEXT",
           "title above the chart; default: a description of what is shown");
    option(command, "--scale", scale_, "",
           "pixels of a PNG for each unit of the page, which is 460 units wide")
        ->check(CLI::Range(0.1, 20.0));
}

plot::Caption PlotArguments::caption(const Shell& shell, const std::string& otherwise) const {
    return {title_.empty() ? otherwise : title_, shell.command_line()};
}

void PlotArguments::check(const Shell& shell) const {
    const std::string& output = shell.common().output;
    const bool to_file = !output.empty() && output != "-";
    if (to_file) plot::check_picture_path(output);
    if (shell.common().json && !to_file) {
        throw UsageError("--json lists the file that was written: give -o FILE, too");
    }
}

void PlotArguments::save(const plot::Picture& picture, const Shell& shell) const {
    const std::string& output = shell.common().output;
    if (output.empty() || output == "-") {
        shell.write_text(picture.svg);
    } else {
        plot::save_picture(picture, output, scale_);
        shell.tell_written({.columns = {"file"}, .rows = {{output}}});
    }
}

void add_plot(CLI::App& command, Shell& shell) {
    command.require_subcommand(1);
    command.set_version_flag("--version", version_text);
    command.footer("Example:\n  miebrdf plot nk GaP TiO2 -o nk.png");
    add_scene_plots(command, shell);
    add_profile_plot(command, shell);
    add_phase_angle_plot(command, shell);
    add_map_plots(command, shell);
    add_polarisation_plot(command, shell);
    add_medium_plots(command, shell);
    add_columns_plot(command, shell);
}

CLI::App* add_scene_kind(CLI::App& plot, Shell& shell, const std::string& kind,
                         const std::string& title, const ScenePlot& arguments,
                         const std::string& default_wavelengths) {
    auto* command = plot.add_subcommand(kind, title);
    arguments->scene.add_to(*command, shell, SceneArguments::Base::required, default_wavelengths);
    arguments->plot.add_to(*command);
    return command;
}

void add_incidence_option(CLI::App& command, const std::string& incidence,
                          const ScenePlot& arguments) {
    arguments->incidence = incidence;
    option(command, "--incidence,--theta-in,--sun-zenith", arguments->incidence, "LIST",
           "angles of incidence, degrees from the normal");
    option(command, "--mu-in", arguments->cosines, "LIST",
           "the same as cosines, in place of --incidence");
}

void add_component_options(CLI::App& command, const ScenePlot& arguments) {
    option(command, "--component", arguments->components, "",
           "parts of the BRDF, with commas between: total, subsurface, surface");
    command.add_flag("--log", arguments->logarithmic, "logarithmic scale of the values");
}

namespace {

/// The cosine of 89.9 degrees, the lowest incidence of a chart.
constexpr double kLeastCosine = 0.001746;

}  // namespace

double cosine_of(double degrees) { return std::cos(degrees * std::numbers::pi / 180); }

std::vector<double> cosines_of(const std::vector<double>& degrees) {
    std::vector<double> list;
    list.reserve(degrees.size());
    for (const double angle : degrees) list.push_back(cosine_of(angle));
    return list;
}

std::vector<double> incidences(const ScenePlotArguments& arguments) {
    if (!arguments.cosines.empty()) {
        std::vector<double> list = parse_number_list(arguments.cosines, "mu_in", kLeastCosine, 1.0);
        for (double& mu : list) mu = std::acos(mu) * 180.0 / std::numbers::pi;
        return list;
    }
    return parse_number_list(arguments.incidence, "incidence (degrees)", 0.0, 89.9);
}

std::vector<double> reflection_angles(const std::string& list,
                                      const std::vector<double>& incidence_deg, double step,
                                      int count, double largest) {
    std::vector<double> angles = parse_number_list(list, "zenith angle (degrees)");
    for (const double incidence : incidence_deg) {
        for (int i = -count; i <= count; ++i) {
            const double angle = incidence + step * i;
            if (angle >= 0.0 && angle <= largest) angles.push_back(angle);
        }
    }
    std::sort(angles.begin(), angles.end());
    const auto same = [](double a, double b) { return b - a < 1e-9; };
    angles.erase(std::unique(angles.begin(), angles.end(), same), angles.end());
    return angles;
}

std::pair<double, double> parse_range(const std::string& text, bool logarithmic) {
    const std::vector<double> ends = parse_number_list(text, "range");
    if (ends.size() != 2 || !(ends[0] < ends[1]) || (logarithmic && !(ends[0] > 0))) {
        throw UsageError(fmt::format("range '{}'; wanted: LOW,HIGH, ascending{}", text,
                                     logarithmic ? " and positive" : ""));
    }
    return {ends[0], ends[1]};
}

double only_wavelength_nm(const Request& request, const std::string& kind) {
    if (request.wavelength_nm.size() != 1) {
        throw UsageError(fmt::format("a {} shows one of --wavelengths; given: {}", kind,
                                     request.wavelength_nm.size()));
    }
    return request.wavelength_nm.front();
}

}  // namespace miebrdf::program
