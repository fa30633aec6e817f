// miebrdf plot columns: columns of tables against each other, results beside measurements.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

#include <miebrdf/error.h>
#include "materials/readers/text_table.h"
#include "pipeline/plot/chart.h"
#include "tools/miebrdf/plot_command.h"

namespace miebrdf::program {
namespace {

struct ColumnsArguments {
    std::vector<std::string> tables, points;
    std::string x = "wavelength_nm", y, x_label, y_label, y_range;
    PlotArguments plot;
};

/// A file, or LABEL=FILE.
struct Labelled {
    std::string label, path;
};
Labelled labelled(const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals != std::string::npos && !std::filesystem::exists(text))
        return {text.substr(0, equals), text.substr(equals + 1)};
    return {std::filesystem::path(text).stem().string(), text};
}

/// A column's name for people: "plane_albedo" -> "plane albedo", "radius_um" -> "radius [µm]".
std::string axis_words(std::string column) {
    constexpr std::pair<const char*, const char*> kNames[] = {
        {"wavelength_nm", "vacuum wavelength [nm]"},
        {"mu_in", "cosine of incidence"},
        {"mu_out", "cosine of reflection"},
        {"brdf", "BRDF [1/sr]"},
        {"hdrf", "HDRF"},
        {"n", "n"},
        {"k", "k"}};
    for (const auto& [name, words] : kNames) {
        if (column == name) return words;
    }
    constexpr std::pair<const char*, const char*> kUnits[] = {
        {"_nm", " [nm]"}, {"_um", " [\u00b5m]"}, {"_deg", " [\u00b0]"}};
    std::string unit;
    for (const auto& [ending, text] : kUnits) {
        if (!column.ends_with(ending)) continue;
        unit = text;
        column.resize(column.size() - std::string_view(ending).size());
        if (column.ends_with("_per")) {
            column.resize(column.size() - 4);
            unit = " [1/\u00b5m]";
        }
        break;
    }
    std::replace(column.begin(), column.end(), '_', ' ');
    return column + unit;
}

int run(const ColumnsArguments& arguments, const Shell& shell) {
    arguments.plot.check(shell);
    plot::Panel panel;
    panel.x.label = arguments.x_label.empty() ? axis_words(arguments.x) : arguments.x_label;
    panel.y.label = arguments.y_label.empty() ? axis_words(arguments.y) : arguments.y_label;
    if (!arguments.y_range.empty()) {
        const auto [low, high] = parse_range(arguments.y_range, false);
        panel.y.lowest = low;
        panel.y.highest = high;
    }
    const auto add = [&](const std::string& text, plot::Mark mark) {
        const auto [label, path] = labelled(text);
        const materials::NumberTable table(path);
        for (const std::string& name : {arguments.x, arguments.y}) {
            // The command line named it: a wrong request, not a damaged file.
            if (table.find(name) == nullptr)
                throw UsageError(fmt::format("{}: no column '{}'; there are {}", path, name,
                                             fmt::join(table.names(), ", ")));
        }
        panel.curves.push_back(
            {label, table.column(arguments.x), table.column(arguments.y), mark, {}, {}});
        // Points of the n-th table belong to the n-th curve of the same label.
        for (std::size_t c = 0; mark == plot::Mark::points && c + 1 < panel.curves.size(); ++c) {
            if (panel.curves[c].label != label) continue;
            panel.curves.back().colour = int(c);
            panel.curves.back().label.clear();
        }
    };
    for (const std::string& table : arguments.tables) add(table, plot::Mark::line);
    for (const std::string& table : arguments.points) add(table, plot::Mark::points);
    arguments.plot.save(
        plot::draw_chart(
            {panel}, arguments.plot.caption(shell, panel.y.label + " against " + panel.x.label)),
        shell);
    return kGood;
}

}  // namespace

void add_columns_plot(CLI::App& plot, Shell& shell) {
    auto arguments = std::make_shared<ColumnsArguments>();
    auto* command = plot.add_subcommand(
        "columns", "columns of CSV tables: results as lines, others as points beside them");
    option(*command, "tables", arguments->tables, "TABLE",
           "tables whose rows become a line each: FILE.csv, or LABEL=FILE.csv")
        ->required();
    option(*command, "--y", arguments->y, "NAME", "column that is shown")->required();
    option(*command, "--x", arguments->x, "NAME", "column along the abscissa");
    option(
        *command, "--points", arguments->points, "TABLE",
        "a table shown as points, in the colour of the line of the same label; repeat it for more")
        ->allow_extra_args(false);
    option(*command, "--x-label", arguments->x_label, "TEXT", "label of the abscissa");
    option(*command, "--y-label", arguments->y_label, "TEXT", "label of the ordinate");
    option(*command, "--range", arguments->y_range, "RANGE", "ends of the ordinate: LOW,HIGH");
    arguments->plot.add_to(*command);
    finish(
        *command, shell, arguments, run,
        "Example:\n  miebrdf plot columns clean.csv 'sooty=soot.csv' --y plane_albedo -o snow.png",
        Writes::file);
}

}  // namespace miebrdf::program
