// miebrdf plot hemisphere, slice: colour maps of a scene's BRDF.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include <miebrdf/error.h>
#include "pipeline/plot/hemisphere.h"
#include "pipeline/plot/slice.h"
#include "pipeline/scene/number_list.h"
#include "tools/miebrdf/plot_command.h"

namespace miebrdf::program {
namespace {

std::vector<double> centres(const std::vector<double>& edges) {
    std::vector<double> list;
    for (std::size_t i = 0; i + 1 < edges.size(); ++i)
        list.push_back(0.5 * (edges[i] + edges[i + 1]));
    return list;
}

std::string map_title(const Request& request, double wavelength_nm) {
    return fmt::format("{}, {:g} nm", title_of(request.scene), wavelength_nm);
}

BrdfPart only_component(const ScenePlotArguments& arguments, const Request& request,
                        const std::string& kind) {
    const std::vector<BrdfPart> parts = parse_components(arguments.components, request.scene);
    if (parts.size() != 1) throw UsageError(fmt::format("a {} shows one --component", kind));
    return parts.front();
}

struct HemisphereArguments : ScenePlotArguments {
    std::string quantity = "brdf";
};

/// Degree of linear polarisation of what is reflected of unpolarised light.
bool put_polarisation(const Brdf& brdf, const Directions& directions, plot::HemisphereMap& map) {
    const MuellerValues values = brdf.mueller(directions);
    for (std::size_t o = 0; o < directions.mu_out.size(); ++o) {
        for (std::size_t a = 0; a < directions.azimuth_deg.size(); ++a)
            map.value.push_back(values.degree_of_linear_polarisation(0, 0, o, a));
    }
    map.value_label = "degree of linear polarisation";
    return values.converged();
}

int run_hemisphere(const HemisphereArguments& arguments, const Shell& shell) {
    arguments.plot.check(shell);
    const Request request = arguments.scene.parse();
    const std::vector<double> incidence_deg = incidences(arguments);
    const double wavelength_nm = only_wavelength_nm(request, "hemisphere");
    if (incidence_deg.size() != 1) throw UsageError("a hemisphere shows one --incidence");
    const BrdfPart part = only_component(arguments, request, "hemisphere");
    plot::HemisphereMap map;
    map.zenith_edges_deg = parse_number_list("0:90:2", "zenith angle (degrees)");
    map.azimuth_edges_deg = parse_number_list("0:180:3", "azimuth (degrees)");
    map.incidence_deg = incidence_deg.front();
    if (arguments.logarithmic) map.scale = plot::Scale::logarithmic;
    const Brdf brdf = solved(request, shell.control());
    const Directions directions = {cosines_of(incidence_deg),
                                   cosines_of(centres(map.zenith_edges_deg)),
                                   centres(map.azimuth_edges_deg)};
    bool converged = false;
    if (arguments.quantity == "dolp") {
        converged = put_polarisation(brdf, directions, map);
    } else {
        const BrdfValues values = brdf.evaluate(directions);
        map.value = values.slices.front().of(part);
        converged = values.converged();
    }
    const auto caption = arguments.plot.caption(shell, map_title(request, wavelength_nm));
    arguments.plot.save(plot::draw_hemisphere(map, caption), shell);
    return converged ? kGood : kNotConverged;
}

struct SliceArguments : ScenePlotArguments {
    double azimuth_deg = 90.0;
    int cells = 90;
    std::string range;
};

/// Directions that choose the ends of the colours: towards grazing a BRDF with a surface lobe grows
/// without bound, and the rest of the picture would be of one colour.
constexpr double kSteepest = 0.17364817766693;  // cos 80 degrees

/// The ends of the colours: those asked for, else of the values that are not at grazing.
void set_range(plot::SliceMap& map, const std::string& range,
               const std::vector<Direction>& directions, const std::vector<double>& values) {
    if (!range.empty()) {
        const auto [low, high] = parse_range(range, map.scale == plot::Scale::logarithmic);
        map.lowest = low;
        map.highest = high;
        return;
    }
    for (std::size_t i = 0; i < directions.size(); ++i) {
        if (!(std::min(directions[i].mu_in, directions[i].mu_out) >= kSteepest)) continue;
        if (map.scale == plot::Scale::logarithmic && !(values[i] > 0)) continue;
        map.lowest = std::min(map.lowest.value_or(values[i]), values[i]);
        map.highest = std::max(map.highest.value_or(values[i]), values[i]);
    }
    if (map.lowest == map.highest) map.lowest = map.highest = std::nullopt;
}

int run_slice(const SliceArguments& arguments, const Shell& shell) {
    arguments.plot.check(shell);
    const Request request = arguments.scene.parse();
    const double wavelength_nm = only_wavelength_nm(request, "slice");
    const BrdfPart part = only_component(arguments, request, "slice");
    if (!arguments.range.empty()) parse_range(arguments.range, arguments.logarithmic);
    plot::SliceMap map;
    map.half_cells = map.difference_cells = arguments.cells;
    map.azimuth_deg = arguments.azimuth_deg;
    map.scale = arguments.logarithmic ? plot::Scale::logarithmic : plot::Scale::linear;
    std::vector<Direction> directions;
    std::vector<std::size_t> cells;
    const double step_deg = 90.0 / arguments.cells;
    for (int d = 0; d < arguments.cells; ++d) {
        for (int h = 0; h < arguments.cells; ++h) {
            map.value.push_back(std::numeric_limits<double>::quiet_NaN());
            const auto direction = plot::slice_direction((h + 0.5) * step_deg, (d + 0.5) * step_deg,
                                                         arguments.azimuth_deg);
            if (!direction) continue;
            directions.push_back(*direction);
            cells.push_back(map.value.size() - 1);
        }
    }
    const BrdfTable table = solved(request, shell.control()).table({part, shell.command_line()});
    const auto values = evaluate_all(table, directions, "slice", shell.control());
    for (std::size_t i = 0; i < cells.size(); ++i) map.value[cells[i]] = values[i];
    set_range(map, arguments.range, directions, values);
    const auto caption = arguments.plot.caption(shell, map_title(request, wavelength_nm));
    arguments.plot.save(plot::draw_slice(map, caption), shell);
    if (!table.report().converged()) shell.note(table.report().summary());
    return table.report().converged() ? kGood : kNotConverged;
}

}  // namespace

void add_map_plots(CLI::App& plot, Shell& shell) {
    auto hemisphere = std::make_shared<HemisphereArguments>();
    auto* hemisphere_command = add_scene_kind(
        plot, shell, "hemisphere", "BRDF over all outgoing directions", hemisphere, kOneWavelength);
    add_incidence_option(*hemisphere_command, "45", hemisphere);
    add_component_options(*hemisphere_command, hemisphere);
    hemisphere_command
        ->add_option("--quantity", hemisphere->quantity,
                     "brdf, or dolp: the degree of linear polarisation that the scene gives to "
                     "unpolarised light")
        ->check(CLI::IsMember({"brdf", "dolp"}))
        ->capture_default_str();
    hemisphere_command->footer(
        "Example:\n  miebrdf plot hemisphere --base TiO2 --wavelengths 550 --incidence 60 --log -o "
        "hemisphere.png");
    shell.on_run(*hemisphere_command,
                 [hemisphere, &shell] { return run_hemisphere(*hemisphere, shell); });

    auto slice = std::make_shared<SliceArguments>();
    auto* slice_command =
        add_scene_kind(plot, shell, "slice", "BRDF over half and difference angle (Rusinkiewicz)",
                       slice, kOneWavelength);
    add_component_options(*slice_command, slice);
    slice_command
        ->add_option("--phi-d", slice->azimuth_deg, "azimuth of the difference angle, degrees")
        ->check(CLI::Range(0.0, 360.0))
        ->capture_default_str();
    slice_command
        ->add_option("--cells", slice->cells, "number of cells along each of the two angles")
        ->check(CLI::Range(2, 360))
        ->capture_default_str();
    slice_command
        ->add_option("--range", slice->range,
                     "values at the ends of the colour scale; default: those up to 80 degrees from "
                     "the normal")
        ->type_name("LOW,HIGH");
    slice_command->footer(
        "Example:\n  miebrdf plot slice --base TiO2 --coat AlGaAs7@0.1 --roughness 0.3 "
        "--wavelengths 550 --log -o slice.png");
    shell.on_run(*slice_command, [slice, &shell] { return run_slice(*slice, shell); });
}

}  // namespace miebrdf::program
