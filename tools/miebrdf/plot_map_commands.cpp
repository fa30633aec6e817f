// miebrdf plot hemisphere, slice: colour maps of a scene's BRDF.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include <miebrdf/error.h>
#include "pipeline/plot/hemisphere.h"
#include "pipeline/plot/slice.h"
#include "pipeline/scene/labels.h"
#include "pipeline/scene/number_list.h"
#include "tools/miebrdf/plot_command.h"

namespace miebrdf::program {
namespace {

std::string map_title(const Request& request, double wavelength_nm) {
    return fmt::format("{}, {:g} nm", label_of(request.scene), wavelength_nm);
}

BrdfPart only_component(const ScenePlotArguments& arguments, const Request& request,
                        const std::string& kind) {
    const std::vector<BrdfPart> parts = parse_components(arguments.components, request.scene);
    if (parts.size() != 1) throw UsageError(fmt::format("a {} shows one --component", kind));
    return parts.front();
}

/// Three for each unit of the page: finer than the eye and than a PNG of twice the page.
constexpr int kHemispherePixels = 870;
/// The rim shows what is seen just above the horizon.
constexpr double kLowestView_deg = 89.5;

struct HemisphereArguments : ScenePlotArguments {
    std::string quantity = "brdf";
};

/// Calls use(place in map.value, zenith_deg, azimuth_deg) for every pixel of the upper half disk.
template <typename Use>
void for_each_pixel(const plot::HemisphereMap& map, const Use& use) {
    for (int y = 0; y < map.size / 2; ++y) {
        for (int x = 0; x < map.size; ++x) {
            const auto angles = plot::pixel_angles(map.size, x, y);
            if (!angles) continue;
            use(static_cast<std::size_t>(y * map.size + x),
                std::min(angles->zenith_deg, kLowestView_deg), angles->azimuth_deg);
        }
    }
}

/// A place between two of `count` nodes that are `step` apart, from 0 on.
struct BetweenNodes {
    BetweenNodes(double value, double step, std::size_t count)
        : lower(std::min(static_cast<std::size_t>(value / step), count - 2)),
          share(value / step - static_cast<double>(lower)) {}
    std::size_t lower;
    double share;
};

/// Degree of linear polarisation of what is reflected of unpolarised light: smooth, so that it is
/// interpolated between directions.
bool put_polarisation(const Brdf& brdf, double mu_in, plot::HemisphereMap& map) {
    constexpr std::size_t kZeniths = 61, kAzimuths = 61;
    constexpr double kZenithStep_deg = kLowestView_deg / (kZeniths - 1),
                     kAzimuthStep_deg = 180.0 / (kAzimuths - 1);
    Directions directions{{mu_in}, {}, {}};
    for (std::size_t o = 0; o < kZeniths; ++o)
        directions.mu_out.push_back(cosine_of(static_cast<double>(o) * kZenithStep_deg));
    for (std::size_t a = 0; a < kAzimuths; ++a)
        directions.azimuth_deg.push_back(static_cast<double>(a) * kAzimuthStep_deg);
    const MuellerValues values = brdf.mueller(directions);
    const auto at = [&](std::size_t o, std::size_t a) {
        return values.degree_of_linear_polarisation(0, 0, o, a);
    };
    for_each_pixel(map, [&](std::size_t pixel, double zenith_deg, double azimuth_deg) {
        const BetweenNodes o(zenith_deg, kZenithStep_deg, kZeniths);
        const BetweenNodes a(std::min(azimuth_deg, 360.0 - azimuth_deg), kAzimuthStep_deg,
                             kAzimuths);
        const auto along = [&](std::size_t out) {
            return (1.0 - a.share) * at(out, a.lower) + a.share * at(out, a.lower + 1);
        };
        map.value[pixel] = (1.0 - o.share) * along(o.lower) + o.share * along(o.lower + 1);
    });
    map.value_label = "degree of linear polarisation";
    return values.converged();
}

bool put_brdf(const Brdf& brdf, double mu_in, BrdfPart part, plot::HemisphereMap& map,
              const Shell& shell) {
    std::vector<Direction> directions;
    std::vector<std::size_t> pixels;
    for_each_pixel(map, [&](std::size_t pixel, double zenith_deg, double azimuth_deg) {
        directions.push_back({mu_in, cosine_of(zenith_deg), azimuth_deg});
        pixels.push_back(pixel);
    });
    const BrdfTable table = brdf.table(as_evaluated(brdf, part, shell));
    const auto values = evaluate_all(table, directions, "hemisphere", shell.control());
    for (std::size_t i = 0; i < pixels.size(); ++i) map.value[pixels[i]] = values[i];
    if (!table.report().converged()) shell.note(table.report().summary());
    return table.report().converged();
}

int run_hemisphere(const HemisphereArguments& arguments, const Shell& shell) {
    arguments.plot.check(shell);
    const Request request = arguments.scene.parse();
    const std::vector<double> incidence_deg = incidences(arguments);
    const double wavelength_nm = only_wavelength_nm(request, "hemisphere");
    if (incidence_deg.size() != 1) throw UsageError("a hemisphere shows one --incidence");
    const BrdfPart part = only_component(arguments, request, "hemisphere");
    plot::HemisphereMap map;
    map.size = kHemispherePixels;
    map.value.assign(static_cast<std::size_t>(map.size) * static_cast<std::size_t>(map.size) / 2,
                     std::numeric_limits<double>::quiet_NaN());
    map.incidence_deg = incidence_deg.front();
    if (arguments.logarithmic) map.scale = plot::Scale::logarithmic;
    const double mu_in = cosine_of(map.incidence_deg);
    const Brdf brdf = solved(request, shell.control());
    const bool converged = arguments.quantity == "dolp" ? put_polarisation(brdf, mu_in, map)
                                                        : put_brdf(brdf, mu_in, part, map, shell);
    const auto caption = arguments.plot.caption(shell, map_title(request, wavelength_nm));
    arguments.plot.save(plot::draw_hemisphere(map, caption), shell);
    return converged ? kGood : kNotConverged;
}

struct SliceArguments : ScenePlotArguments {
    double azimuth_deg = 90.0;
    int cells = 290;
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
    const Brdf brdf = solved(request, shell.control());
    const BrdfTable table = brdf.table(as_evaluated(brdf, part, shell));
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
    option(*hemisphere_command, "--quantity", hemisphere->quantity, "",
           "brdf, or dolp: the degree of linear polarisation that the scene gives to unpolarised "
           "light")
        ->check(CLI::IsMember({"brdf", "dolp"}));
    finish(*hemisphere_command, shell, hemisphere, run_hemisphere,
           "Example:\n  miebrdf plot hemisphere --base TiO2 --wavelengths 550 --incidence 60 --log "
           "-o hemisphere.png",
           Writes::file);

    auto slice = std::make_shared<SliceArguments>();
    auto* slice_command =
        add_scene_kind(plot, shell, "slice", "BRDF over half and difference angle (Rusinkiewicz)",
                       slice, kOneWavelength);
    add_component_options(*slice_command, slice);
    option(*slice_command, "--phi-d", slice->azimuth_deg, "",
           "azimuth of the difference angle, degrees")
        ->check(CLI::Range(0.0, 360.0));
    option(*slice_command, "--cells", slice->cells, "",
           "number of cells along each of the two angles")
        ->check(CLI::Range(2, 870));
    option(
        *slice_command, "--range", slice->range, "LOW,HIGH",
        "values at the ends of the colour scale; default: those up to 80 degrees from the normal");
    finish(*slice_command, shell, slice, run_slice,
           "Example:\n  miebrdf plot slice --base TiO2 --coat AlGaAs7@0.1 --roughness 0.3 "
           "--wavelengths 550 --log -o slice.png",
           Writes::file);
}

}  // namespace miebrdf::program
