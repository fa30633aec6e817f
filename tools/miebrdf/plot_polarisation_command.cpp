// miebrdf plot polarisation: what a scene makes of unpolarised light, along the principal plane.
#include <fmt/format.h>

#include <numbers>

#include "pipeline/plot/chart.h"
#include "pipeline/scene/labels.h"
#include "pipeline/scene/number_list.h"
#include "tools/miebrdf/plot_command.h"

namespace miebrdf::program {
namespace {

/// Viewing angles of the principal plane, the source's side negative, and their values.
struct PrincipalPlane {
    std::vector<double> angle_deg, reflection, polarisation;
};

PrincipalPlane principal_plane(const MuellerValues& values, const std::vector<double>& zenith_deg,
                               std::size_t w, std::size_t in) {
    PrincipalPlane plane;
    const auto add = [&](double angle_deg, std::size_t out, std::size_t azimuth) {
        const double I = values.at(w, in, out, azimuth);
        plane.angle_deg.push_back(angle_deg);
        plane.reflection.push_back(std::numbers::pi * I);
        plane.polarisation.push_back(-100.0 * values.at(w, in, out, azimuth, 1) / I);
    };
    for (std::size_t o = zenith_deg.size(); o-- > 1;) add(-zenith_deg[o], o, 1);
    for (std::size_t o = 0; o < zenith_deg.size(); ++o) add(zenith_deg[o], o, 0);
    return plane;
}

int run_polarisation(const ScenePlotArguments& arguments, const Shell& shell) {
    arguments.plot.check(shell);
    const Request request = arguments.scene.parse();
    const std::vector<double> incidence_deg = incidences(arguments);
    const std::vector<double> zenith_deg =
        parse_number_list("0:86:1,87,88,89", "zenith angle (degrees)");
    const MuellerValues values =
        solved(request, shell.control())
            .mueller({cosines_of(incidence_deg), cosines_of(zenith_deg), {0.0, 180.0}});
    const std::string viewing =
        "viewing angle [\u00b0]: source's side negative, mirror side positive";
    plot::Panel reflection{{viewing, plot::Scale::linear, -90.0, 90.0, 30.0},
                           {"R (\u03c0 BRDF)", plot::Scale::linear, 0.0},
                           {},
                           170.0};
    plot::Panel polarisation{{viewing, plot::Scale::linear, -90.0, 90.0, 30.0},
                             {"\u2212Q/I [%]", plot::Scale::linear},
                             {},
                             210.0};
    polarisation.note = "above 0: across the plane, below: in it";
    int colour = 0;
    for (std::size_t w = 0; w < request.wavelength_nm.size(); ++w) {
        for (std::size_t i = 0; i < incidence_deg.size(); ++i, ++colour) {
            const PrincipalPlane plane = principal_plane(values, zenith_deg, w, i);
            const std::string label = fmt::format("{:g} nm, incidence {:g}\u00b0",
                                                  request.wavelength_nm[w], incidence_deg[i]);
            reflection.curves.push_back(
                {label, plane.angle_deg, plane.reflection, plot::Mark::line, colour, {}});
            polarisation.curves.push_back(
                {label, plane.angle_deg, plane.polarisation, plot::Mark::line, colour, {}});
        }
    }
    const auto caption = arguments.plot.caption(shell, label_of(request.scene));
    arguments.plot.save(plot::draw_chart({reflection, polarisation}, caption), shell);
    return values.converged() ? kGood : kNotConverged;
}

}  // namespace

void add_polarisation_plot(CLI::App& plot, Shell& shell) {
    auto arguments = std::make_shared<ScenePlotArguments>();
    auto* command = add_scene_kind(plot, shell, "polarisation",
                                   "polarisation of reflected light along the principal plane",
                                   arguments, kOneWavelength);
    add_incidence_option(*command, "45", arguments);
    finish(*command, shell, arguments, run_polarisation,
           "Example:\n  miebrdf plot polarisation --base rayleigh:0.9 --incidence 30,60 -o "
           "polarisation.png",
           Writes::file);
}

}  // namespace miebrdf::program
