// miebrdf plot profile: a BRDF against the angle of reflection, by several methods.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <miebrdf/error.h>
#include <miebrdf/measured.h>
#include "pipeline/plot/chart.h"
#include "pipeline/scene/labels.h"
#include "pipeline/scene/number_list.h"
#include "tools/miebrdf/plot_command.h"

namespace miebrdf::program {
namespace {

/// A single value of others, to be drawn beside curves.
struct ProfilePoint {
    double wavelength_nm, mu_in, mu_out, azimuth_deg;
    double brdf;  ///< 1/sr
};

/// BRDFs and reflectance factors (divided by pi) of a file of measurements or of `miebrdf brdf`.
/// @throws InputError  with file and line
std::vector<ProfilePoint> read_profile_points(const std::string& path) {
    std::vector<ProfilePoint> points;
    for (const MeasuredValue& v : read_measured(path).values) {
        const bool is_brdf = v.quantity == MeasuredQuantity::brdf;
        if (!is_brdf && v.quantity != MeasuredQuantity::reflectance_factor) continue;
        points.push_back({v.wavelength_nm, v.mu_in, v.mu_out, v.azimuth_deg,
                          is_brdf ? v.value : v.value / std::numbers::pi});
    }
    return points;
}

struct ProfileArguments : ScenePlotArguments {
    double azimuth_deg = 180.0;
    std::vector<std::string> coat_methods;
    std::string range;
    std::string points;
    std::string points_label = "points";
};

std::string label_of(rte::CoatMethod method) {
    switch (method) {
        case rte::CoatMethod::first_order:
            return "first order in \u03c4";
        case rte::CoatMethod::first_order_patched:
            return "first order, patched";
        case rte::CoatMethod::exponential:
            return "exponential";
        case rte::CoatMethod::automatic:
            break;
    }
    return "exact";
}

plot::AxisOptions value_axis(const ProfileArguments& arguments) {
    plot::AxisOptions axis{"BRDF [1/sr]",
                           arguments.logarithmic ? plot::Scale::logarithmic : plot::Scale::linear};
    if (arguments.range.empty()) return axis;
    const auto [low, high] = parse_range(arguments.range, arguments.logarithmic);
    axis.lowest = low;
    axis.highest = high;
    return axis;
}

/// Points of one incidence and the wavelength and azimuth shown, by angle of reflection.
plot::Curve points_near(const std::vector<ProfilePoint>& points, const ProfileArguments& arguments,
                        double wavelength_nm, double incidence_deg) {
    plot::Curve curve{arguments.points_label, {}, {}, plot::Mark::points, 0, {}};
    for (const ProfilePoint& p : points) {
        // Files state cosines and angles to a few digits.
        const bool here = std::abs(p.wavelength_nm - wavelength_nm) <= 1e-6 &&
                          std::abs(p.azimuth_deg - arguments.azimuth_deg) <= 1e-6 &&
                          std::abs(p.mu_in - cosine_of(incidence_deg)) <= 1e-3;
        if (!here || !(std::abs(p.mu_out) <= 1.0)) continue;
        curve.x.push_back(std::acos(p.mu_out) * 180.0 / std::acos(-1.0));
        curve.y.push_back(p.brdf);
    }
    return curve;
}

int run_profile(const ProfileArguments& arguments, const Shell& shell) {
    arguments.plot.check(shell);
    Request request = arguments.scene.parse();
    const double wavelength_nm = only_wavelength_nm(request, "profile");
    const std::vector<double> incidence_deg = incidences(arguments);
    const std::vector<double> zenith_deg =
        reflection_angles("0:88:0.5,88.2:89.8:0.2", incidence_deg, 0.05, 40, 89.9);
    const plot::AxisOptions axis = value_axis(arguments);
    std::vector<ProfilePoint> points;
    if (!arguments.points.empty()) points = read_profile_points(arguments.points);
    const Directions directions = {
        cosines_of(incidence_deg), cosines_of(zenith_deg), {arguments.azimuth_deg}};
    const std::vector<BrdfPart> parts = parse_components(arguments.components, request.scene);
    if (parts.size() != 1) throw UsageError("a profile shows one --component");

    std::vector<rte::CoatMethod> methods{request.solver.coat_method};
    for (const std::string& name : arguments.coat_methods) {
        apply(*find_scene_word("coat-method"), std::vector<WordValue>{name}, request);
        methods.push_back(request.solver.coat_method);
    }
    std::vector<plot::Panel> panels(incidence_deg.size());
    bool converged = true;
    for (std::size_t m = 0; m < methods.size(); ++m) {
        request.solver.coat_method = methods[m];
        const BrdfValues result = solved(request, shell.control()).evaluate(directions);
        // The first method is the answer; the others are shown for what they are.
        if (m == 0) converged = result.converged();
        const std::vector<double>& values = result.slices.front().of(parts.front());
        for (std::size_t i = 0; i < panels.size(); ++i) {
            const auto first = values.begin() + static_cast<std::ptrdiff_t>(i * zenith_deg.size());
            // The answer is drawn last: over the others where they agree.
            panels[i].curves.insert(
                panels[i].curves.begin(),
                {methods.size() > 1 ? label_of(methods[m]) : "",
                 zenith_deg,
                 {first, first + static_cast<std::ptrdiff_t>(zenith_deg.size())},
                 plot::Mark::line,
                 static_cast<int>(m),
                 {}});
        }
    }
    bool any_point = false;
    for (std::size_t i = 0; i < panels.size(); ++i) {
        plot::Panel& panel = panels[i];
        panel.x = {"angle of reflection [\u00b0]", plot::Scale::linear, 0.0, 90.0, 15.0};
        panel.y = axis;
        panel.note = fmt::format("incidence {:.3g}\u00b0", incidence_deg[i]);
        panel.height = panels.size() == 1 ? 260.0 : 160.0;
        plot::Curve near = points_near(points, arguments, wavelength_nm, incidence_deg[i]);
        any_point = any_point || !near.x.empty();
        if (!near.x.empty()) panel.curves.push_back(std::move(near));
    }
    if (!points.empty() && !any_point) {
        throw InputError(
            fmt::format("points '{}': none at {:g} nm, azimuth {:g} and these incidences",
                        arguments.points, wavelength_nm, arguments.azimuth_deg));
    }
    const auto caption = arguments.plot.caption(
        shell, fmt::format("{}, {:g} nm, azimuth {:g}\u00b0", label_of(request.scene),
                           wavelength_nm, arguments.azimuth_deg));
    arguments.plot.save(plot::draw_chart(panels, caption), shell);
    return converged ? kGood : kNotConverged;
}

}  // namespace

void add_profile_plot(CLI::App& plot, Shell& shell) {
    auto profile = std::make_shared<ProfileArguments>();
    auto* command = add_scene_kind(plot, shell, "profile", "BRDF against the angle of reflection",
                                   profile, kOneWavelength);
    add_incidence_option(*command, "0,30,60", profile);
    add_component_options(*command, profile);
    option(*command, "--azimuth", profile->azimuth_deg, "",
           "degrees; 180 is back towards the source, 0 the mirror side")
        ->check(CLI::Range(0.0, 360.0));
    option(*command, "--compare-coat-method", profile->coat_methods, "METHOD",
           "show the result of this --coat-method, too; repeat it for more")
        ->allow_extra_args(false);
    option(*command, "--range", profile->range, "LOW,HIGH", "ends of the value axis");
    option(*command, "--points", profile->points, "FILE",
           "values to draw as points: a table like that of `miebrdf brdf`, or whatever `miebrdf "
           "measured` reads");
    option(*command, "--points-label", profile->points_label, "TEXT",
           "name of these points in the legend");
    finish(*command, shell, profile, run_profile,
           "Example:\n  miebrdf plot profile --base TiO2 --coat AlGaAs7@0.1 --wavelengths 450 "
           "--incidence 0,60 --compare-coat-method first-order --log --range 0.1,3 -o profile.png",
           Writes::file);
}

}  // namespace miebrdf::program
