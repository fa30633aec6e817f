// miebrdf plot: charts of media and scenes.
#include "tools/miebrdf/plot_command.h"

#include <fmt/format.h>

#include <miebrdf/error.h>
#include <miebrdf/version.h>

namespace miebrdf::program {

void PlotArguments::add_to(CLI::App& command) {
    command.add_option("--title", title_, "above the chart; default: what is shown")
        ->type_name("TEXT");
    command.add_option("--scale", scale_, "pixels of a PNG for each unit of the page (460 wide)")
        ->check(CLI::Range(0.1, 20.0))
        ->capture_default_str();
}

plot::Caption PlotArguments::caption(const Shell& shell, const std::string& otherwise) const {
    return {title_.empty() ? otherwise : title_, shell.command_line()};
}

void PlotArguments::check(const Shell& shell) const {
    const std::string& output = shell.common().output;
    const bool to_file = !output.empty() && output != "-";
    if (to_file) plot::check_picture_path(output);
    if (shell.common().json && !to_file) {
        throw UsageError("--json tells on standard output what was written: give -o FILE, too");
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
    command.set_version_flag("--version", fmt::format("miebrdf {}", kVersion));
    command.footer("Example:\n  miebrdf plot nk GaP TiO2 -o nk.png");
    add_scene_plots(command, shell);
    add_profile_plot(command, shell);
    add_map_plots(command, shell);
    add_medium_plots(command, shell);
}

}  // namespace miebrdf::program
