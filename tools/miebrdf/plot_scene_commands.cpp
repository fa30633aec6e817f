// miebrdf plot lobe, spectrum: what a scene reflects.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "pipeline/colour/colour.h"
#include "pipeline/plot/lobe.h"
#include "pipeline/plot/spectra.h"
#include "pipeline/scene/number_list.h"
#include "tools/miebrdf/plot_command.h"

namespace miebrdf::program {
namespace {

/// The scene itself and the same with every --compare base in its place.
std::vector<Scene> scenes(const ScenePlotArguments& arguments, const Scene& first) {
    std::vector<Scene> list{first};
    for (const std::string& base : arguments.compare) {
        list.push_back(first);
        list.back().base = parse_medium(base);
    }
    return list;
}

/// One curve out of a result: the plane of incidence for one mu_in.
plot::LobeCurve lobe_curve(const std::vector<double>& values, std::size_t incidence,
                           const std::vector<double>& zenith_deg, bool with_cosine) {
    plot::LobeCurve curve;
    const std::size_t count = zenith_deg.size();
    const auto add = [&](double angle_deg, std::size_t o, std::size_t azimuth) {
        curve.angle_deg.push_back(angle_deg);
        const double factor = with_cosine ? cosine_of(angle_deg) : 1.0;
        curve.value.push_back(factor * values[(incidence * count + o) * 2 + azimuth]);
    };
    for (std::size_t o = count; o-- > 1;) add(-zenith_deg[o], o, 1);  // the source's side
    for (std::size_t o = 0; o < count; ++o) add(zenith_deg[o], o, 0);
    return curve;
}

int run_lobe(const ScenePlotArguments& arguments, const Shell& shell) {
    arguments.plot.check(shell);
    Request request = arguments.scene.parse();
    const std::vector<double> incidence_deg = incidences(arguments);
    const std::vector<std::string> components = split_list(arguments.components);
    const std::vector<double> zenith_deg =
        parse_number_list("0:88:1,88.5,89,89.5", "zenith angle (degrees)");
    request.directions = {cosines_of(incidence_deg), cosines_of(zenith_deg), {0.0, 180.0}};

    std::vector<plot::LobeCurve> curves;
    bool converged = true;
    const std::vector<Scene> all_scenes = scenes(arguments, request.scene);
    for (const Scene& scene : all_scenes) {
        request.scene = scene;
        const BrdfResult result = compute_brdf(request, shell.control());
        converged = converged && result.converged;
        for (const SpectralSlice& slice : result.slices) {
            for (const std::string& component : components) {
                for (std::size_t i = 0; i < incidence_deg.size(); ++i) {
                    curves.push_back(lobe_curve(component_of(slice, component), i, zenith_deg,
                                                arguments.cosine));
                    curves.back().incidence_deg = incidence_deg[i];
                    // A label names only what differs between the curves.
                    std::vector<std::string> parts;
                    if (all_scenes.size() > 1) parts.push_back(describe(scene.base));
                    if (result.slices.size() > 1)
                        parts.push_back(fmt::format("{:g} nm", slice.wavelength_nm));
                    if (components.size() > 1) parts.push_back(component);
                    if (incidence_deg.size() > 1)
                        parts.push_back(fmt::format("{:g}\u00b0", incidence_deg[i]));
                    curves.back().label = fmt::format("{}", fmt::join(parts, ", "));
                }
            }
        }
    }
    std::string title = title_of(all_scenes);
    if (request.wavelength_nm.size() == 1)
        title += fmt::format(", {:g} nm", request.wavelength_nm.front());
    const plot::LobeOptions options{arguments.cosine ? "BRDF cos \u03b8 [1/sr]" : "BRDF [1/sr]",
                                    arguments.logarithmic, arguments.decades};
    arguments.plot.save(plot::draw_lobe(curves, options, arguments.plot.caption(shell, title)),
                        shell);
    return converged ? kGood : kNotConverged;
}

int run_spectrum(const ScenePlotArguments& arguments, const Shell& shell) {
    arguments.plot.check(shell);
    Request request = arguments.scene.parse();
    std::sort(request.wavelength_nm.begin(), request.wavelength_nm.end());  // rgb comes descending
    const std::vector<double> incidence_deg = incidences(arguments);
    request.directions.mu_in = cosines_of(incidence_deg);
    const ObserverWeights weights = observer_weights(request.wavelength_nm);

    std::vector<plot::Spectrum> spectra;
    const auto add = [&](const std::string& label, std::vector<double> values) {
        const LinearSrgb colour = to_linear_srgb(to_xyz(weights, values));
        spectra.push_back({label, request.wavelength_nm, std::move(values), colour});
    };
    bool converged = true;
    const std::vector<Scene> all_scenes = scenes(arguments, request.scene);
    for (const Scene& scene : all_scenes) {
        request.scene = scene;
        const AlbedoResult result = compute_albedo(request, shell.control());
        converged = converged && result.converged;
        const std::string prefix = all_scenes.size() > 1 ? describe(scene.base) + ", " : "";
        std::vector<double> spherical;
        for (const AlbedoSlice& slice : result.slices) spherical.push_back(slice.spherical_albedo);
        add(prefix + "spherical", std::move(spherical));
        for (std::size_t i = 0; i < incidence_deg.size(); ++i) {
            std::vector<double> plane;
            for (const AlbedoSlice& slice : result.slices) plane.push_back(slice.plane_albedo[i]);
            add(fmt::format("{}incidence {:g}\u00b0", prefix, incidence_deg[i]), std::move(plane));
        }
    }
    arguments.plot.save(
        plot::draw_spectrum(spectra, "albedo", arguments.plot.caption(shell, title_of(all_scenes))),
        shell);
    return converged ? kGood : kNotConverged;
}

void add_compare(CLI::App& command, const ScenePlot& arguments) {
    command
        .add_option("--compare", arguments->compare,
                    "the same scene on another base as well; repeatable")
        ->type_name("MEDIUM")
        ->allow_extra_args(false);
}

}  // namespace

void add_scene_plots(CLI::App& plot, Shell& shell) {
    auto lobe = std::make_shared<ScenePlotArguments>();
    auto* lobe_command =
        add_scene_kind(plot, shell, "lobe", "BRDF in the plane of incidence", lobe);
    add_incidence_option(*lobe_command, "0,30,60", lobe);
    add_component_options(*lobe_command, lobe);
    add_compare(*lobe_command, lobe);
    lobe_command->add_flag("--cosine", lobe->cosine, "show BRDF times the cosine of reflection");
    lobe_command->add_option("--decades", lobe->decades, "of a logarithmic radius")
        ->check(CLI::Range(1, 12))
        ->capture_default_str();
    lobe_command->footer(
        "Example:\n  miebrdf plot lobe --base TiO2 --coat AlGaAs7@0.1 --roughness 0.3 "
        "--wavelengths 550 -o lobe.png");
    shell.on_run(*lobe_command, [lobe, &shell] { return run_lobe(*lobe, shell); });

    auto spectrum = std::make_shared<ScenePlotArguments>();
    auto* spectrum_command = add_scene_kind(plot, shell, "spectrum",
                                            "spherical and plane albedo against wavelength, and "
                                            "their colours under D65",
                                            spectrum);
    add_incidence_option(*spectrum_command, "0,60", spectrum);
    add_compare(*spectrum_command, spectrum);
    spectrum_command->footer(
        "Example:\n  miebrdf plot spectrum --base AlGaAs7 --wavelengths 400:700:10 -o "
        "spectrum.svg");
    shell.on_run(*spectrum_command, [spectrum, &shell] { return run_spectrum(*spectrum, shell); });
}

}  // namespace miebrdf::program
