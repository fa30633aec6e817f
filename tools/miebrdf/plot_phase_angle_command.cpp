// miebrdf plot phase-angle: what is seen against the angle between the source and the viewer.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/plot/chart.h"
#include "pipeline/scene/number_list.h"
#include "tools/miebrdf/plot_scenes.h"

namespace miebrdf::program {
namespace {

struct PhaseAngleArguments : ScenePlotArguments {
    bool radiance_factor = false;
};

constexpr double kLowestViewAngle_deg = 89.5;

/// One view of the plane of incidence.
struct View {
    double phase_deg;  ///< positive from the source over the normal to the mirror side
    double zenith_deg;
    std::size_t azimuth;  ///< 0: mirror side, 1: the source's
};

/// From just above the horizon behind the source to that on the mirror side; closer around the
/// source, where glories and oppositions are narrow.
std::vector<View> views_of(double incidence_deg) {
    std::vector<double> phase_deg = parse_number_list("-90:180:0.5", "phase angle (degrees)");
    for (int i = -60; i <= 60; ++i) phase_deg.push_back(0.05 * i);
    std::sort(phase_deg.begin(), phase_deg.end());
    std::vector<View> views;
    for (const double phase : phase_deg) {
        const double from_normal = phase - incidence_deg;  // positive on the mirror side
        if (std::abs(from_normal) > kLowestViewAngle_deg) continue;
        if (!views.empty() && phase - views.back().phase_deg < 1e-9) continue;
        views.push_back({phase, std::abs(from_normal), from_normal > 0.0 ? 0u : 1u});
    }
    return views;
}

plot::Curve phase_angle_curve(const Request& request, BrdfPart part, double incidence_deg,
                              double factor, const Shell& shell, bool& converged) {
    const std::vector<View> views = views_of(incidence_deg);
    std::vector<double> zenith_deg;
    for (const View& view : views) zenith_deg.push_back(view.zenith_deg);
    const BrdfValues values =
        solved(request, shell.control())
            .evaluate({{cosine_of(incidence_deg)}, cosines_of(zenith_deg), {0.0, 180.0}});
    converged = converged && values.converged();
    const std::vector<double>& brdf = values.slices.front().of(part);
    plot::Curve curve;
    for (std::size_t i = 0; i < views.size(); ++i) {
        curve.x.push_back(views[i].phase_deg);
        curve.y.push_back(factor * brdf[2 * i + views[i].azimuth]);
    }
    return curve;
}

int run_phase_angle(const PhaseAngleArguments& arguments, const Shell& shell) {
    arguments.plot.check(shell);
    const Request request = arguments.scene.parse();
    const double wavelength_nm = only_wavelength_nm(request, "phase-angle chart");
    const std::vector<double> incidence_deg = incidences(arguments);
    const std::vector<ShownScene> scenes = shown_scenes(arguments, request);
    plot::Panel panel;
    panel.height = 260.0;
    panel.x = {
        "phase angle [\u00b0], negative beyond the source", plot::Scale::linear, {}, {}, 30.0};
    panel.y = {arguments.radiance_factor ? "radiance factor I/F" : "BRDF [1/sr]",
               arguments.logarithmic ? plot::Scale::logarithmic : plot::Scale::linear};
    bool converged = true;
    for (const ShownScene& shown : scenes) {
        const std::vector<BrdfPart> parts =
            parse_components(arguments.components, shown.request.scene);
        for (const BrdfPart part : parts) {
            for (const double incidence : incidence_deg) {
                const double factor =
                    arguments.radiance_factor ? std::numbers::pi * cosine_of(incidence) : 1.0;
                plot::Curve curve =
                    phase_angle_curve(shown.request, part, incidence, factor, shell, converged);
                std::vector<std::string> words;
                if (!shown.label.empty()) words.push_back(shown.label);
                if (parts.size() > 1) words.emplace_back(name_of(part));
                if (incidence_deg.size() > 1)
                    words.push_back(fmt::format("incidence {:.3g}\u00b0", incidence));
                curve.label = fmt::format("{}", fmt::join(words, "; "));
                curve.shade = shown.shade;
                panel.curves.push_back(std::move(curve));
            }
        }
    }
    std::string title = fmt::format("{}, {:g} nm", title_of(scenes, arguments), wavelength_nm);
    if (incidence_deg.size() == 1)
        title += fmt::format(", incidence {:.3g}\u00b0", incidence_deg.front());
    arguments.plot.save(plot::draw_chart({panel}, arguments.plot.caption(shell, title)), shell);
    return converged ? kGood : kNotConverged;
}

}  // namespace

void add_phase_angle_plot(CLI::App& plot, Shell& shell) {
    auto arguments = std::make_shared<PhaseAngleArguments>();
    auto* command = add_scene_kind(
        plot, shell, "phase-angle",
        "BRDF against the angle between source and viewer, in the plane of incidence", arguments,
        kOneWavelength);
    add_incidence_option(*command, "0,30,60", arguments);
    add_component_options(*command, arguments);
    add_scene_choices(*command, arguments);
    command->add_flag(
        "--radiance-factor", arguments->radiance_factor,
        "show I/F = pi mu_in BRDF, the radiance relative to that of a white Lambertian "
        "disk lit and seen along its normal");
    finish(*command, shell, arguments, run_phase_angle,
           "Example:\n  miebrdf plot phase-angle --base H2O_ice,radius=50 --tolerance 1e-2 "
           "--incidence 60 --log -o phase-angle.png",
           Writes::file);
}

}  // namespace miebrdf::program
