// miebrdf materials plot: n and k over wavelength as a picture.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include <miebrdf/error.h>
#include "pipeline/plot/spectra.h"
#include "pipeline/scene/number_list.h"
#include "tools/miebrdf/materials_command.h"

namespace miebrdf::program {
namespace {

struct PlotArguments {
    DatabaseArgument database;
    std::vector<std::string> names;
    std::string range;
    double scale = 2.0;
};

/// As many points as make a smooth curve, the ends of the data among them.
std::vector<double> wavelengths_of(const materials::RefractiveIndex& index, double from,
                                   double to) {
    constexpr int kPoints = 400;
    std::vector<double> wavelengths;
    const double first = std::max(from, index.shortest_nm()),
                 last = std::min(to, index.longest_nm());
    if (!(first <= last)) return wavelengths;
    for (int i = 0; i <= kPoints; ++i) {
        wavelengths.push_back(i == kPoints ? last : first + (last - first) * i / kPoints);
    }
    return wavelengths;
}

plot::IndexCurve curve_of(const materials::Database& database, const std::string& name, double from,
                          double to) {
    const auto dataset = database.dataset_info(name);
    plot::IndexCurve curve;
    curve.label = dataset.material + "/" + dataset.label;
    try {
        const auto index = database.refractive_index(curve.label);
        for (const double wavelength_nm : wavelengths_of(index, from, to)) {
            const auto m = index.at(wavelength_nm);
            curve.wavelength_nm.push_back(wavelength_nm);
            curve.n.push_back(m.real());
            curve.k.push_back(m.imag());
        }
        if (curve.n.empty()) {
            throw InputError(fmt::format("{} covers {} to {} nm: nothing to draw", curve.label,
                                         index.shortest_nm(), index.longest_nm()));
        }
    } catch (const std::logic_error& error) {
        throw InputError(error.what());
    }
    return curve;
}

int run_plot(const PlotArguments& arguments, const Shell& shell) {
    const std::string& output = shell.common().output;
    if (output.empty() || output == "-")
        throw UsageError("a plot needs -o FILE.svg or -o FILE.png");
    double from = 0.0, to = std::numeric_limits<double>::infinity();
    if (!arguments.range.empty()) {
        const std::vector<std::string> ends = split_list(arguments.range, ':');
        if (ends.size() != 2)
            throw UsageError(fmt::format("--range '{}': expected A:B", arguments.range));
        from = parse_wavelength_nm(ends[0]);
        to = parse_wavelength_nm(ends[1]);
        if (from > to) std::swap(from, to);
    }
    const materials::Database database = arguments.database.open();
    std::vector<plot::IndexCurve> curves;
    for (const std::string& name : arguments.names) {
        curves.push_back(curve_of(database, name, from, to));
    }
    const plot::Caption caption{"", shell.command_line()};
    plot::save_picture(plot::draw_nk(std::move(curves), caption), output, arguments.scale);
    shell.tell_written({.columns = {"file"}, .rows = {{output}}});
    return kGood;
}

}  // namespace

void add_materials_plot_command(CLI::App& materials, Shell& shell) {
    auto arguments = std::make_shared<PlotArguments>();
    auto* command = materials.add_subcommand("plot", "n and k over wavelength, as SVG or PNG");
    command
        ->add_option("names", arguments->names, "NAME, NAME/DATASET or SOURCE:KEY; several overlay")
        ->required();
    command->add_option("--range", arguments->range, "only wavelengths A:B (nm or units)")
        ->type_name("A:B");
    command->add_option("--scale", arguments->scale, "PNG pixels for each SVG unit")
        ->check(CLI::Range(0.1, 20.0))
        ->capture_default_str();
    arguments->database.add_to(*command);
    shell.add_common_options(*command, Writes::file);
    command->footer("Example:\n  miebrdf materials plot GaP TiO2 -o nk.svg");
    shell.on_run(*command, [arguments, &shell] { return run_plot(*arguments, shell); });
}

}  // namespace miebrdf::program
