// miebrdf plot lobe, spectrum: what a scene reflects.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include <miebrdf/colour.h>
#include "pipeline/plot/colour_map.h"
#include "pipeline/plot/lobe.h"
#include "pipeline/plot/spectra.h"
#include "pipeline/scene/number_list.h"
#include "tools/miebrdf/measured_options.h"
#include "tools/miebrdf/plot_scenes.h"

namespace miebrdf::program {
namespace {

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

/// A label names only what differs between the curves.
struct Differs {
    bool wavelengths, components, incidences;
};

std::string label_of(const Differs& differs, const ShownScene& shown, double wavelength_nm,
                     BrdfPart part, double incidence_deg) {
    std::vector<std::string> parts;
    if (!shown.label.empty()) parts.push_back(shown.label);
    if (differs.wavelengths) parts.push_back(fmt::format("{:g} nm", wavelength_nm));
    if (differs.components) parts.emplace_back(name_of(part));
    if (differs.incidences) parts.push_back(fmt::format("incidence {:.3g}\u00b0", incidence_deg));
    return fmt::format("{}", fmt::join(parts, "; "));
}

int run_lobe(const ScenePlotArguments& arguments, const Shell& shell) {
    arguments.plot.check(shell);
    const Request request = arguments.scene.parse();
    const std::vector<double> incidence_deg = incidences(arguments);
    // Eight for each degree: the bows of drops of 0.1 mm are a degree wide.
    const std::vector<double> zenith_deg =
        reflection_angles("0:89.5:0.125", incidence_deg, 0.0625, 32, 89.5);
    const Directions directions = {cosines_of(incidence_deg), cosines_of(zenith_deg), {0.0, 180.0}};
    const std::vector<double>& wavelength_nm = request.wavelength_nm;
    const std::vector<ShownScene> all_scenes = shown_scenes(arguments, request);

    std::vector<plot::LobeCurve> curves;
    bool converged = true;
    for (const ShownScene& shown : all_scenes) {
        const std::vector<BrdfPart> parts =
            parse_components(arguments.components, shown.request.scene);
        const Differs differs{wavelength_nm.size() > 1, parts.size() > 1, incidence_deg.size() > 1};
        const BrdfValues values = solved(shown.request, shell.control()).evaluate(directions);
        converged = converged && values.converged();
        for (std::size_t w = 0; w < wavelength_nm.size(); ++w) {
            for (const BrdfPart part : parts) {
                for (std::size_t i = 0; i < incidence_deg.size(); ++i) {
                    curves.push_back(
                        lobe_curve(values.slices[w].of(part), i, zenith_deg, arguments.cosine));
                    curves.back().incidence_deg = incidence_deg[i];
                    curves.back().shade = shown.shade;
                    curves.back().label =
                        label_of(differs, shown, wavelength_nm[w], part, incidence_deg[i]);
                }
            }
        }
    }
    std::string title = title_of(all_scenes, arguments);
    if (wavelength_nm.size() == 1) title += fmt::format(", {:g} nm", wavelength_nm.front());
    const plot::LobeOptions options{arguments.cosine ? "BRDF cos \u03b8 [1/sr]" : "BRDF [1/sr]",
                                    arguments.logarithmic, arguments.decades};
    arguments.plot.save(plot::draw_lobe(curves, options, arguments.plot.caption(shell, title)),
                        shell);
    return converged ? kGood : kNotConverged;
}

/// Measured shares within the wavelengths shown, one set of points for each sample.
std::vector<plot::Spectrum> measured_points(const std::string& path,
                                            const std::vector<double>& shown_nm) {
    Measurements list = read_measured(path);
    std::erase_if(list.values, [&](const MeasuredValue& v) {
        return !is_share(v.quantity) || !(v.wavelength_nm >= shown_nm.front()) ||
               !(v.wavelength_nm <= shown_nm.back());
    });
    if (list.values.empty()) {
        throw InputError(fmt::format("points '{}': no reflectance from {:g} to {:g} nm", path,
                                     shown_nm.front(), shown_nm.back()));
    }
    std::vector<plot::Spectrum> spectra;
    for (plot::Curve& curve : measured_curves(list, plot::Mark::points)) {
        spectra.push_back({curve.label,
                           std::move(curve.x),
                           std::move(curve.y),
                           {},
                           curve.shade,
                           plot::Mark::points});
    }
    return spectra;
}

int run_spectrum(const ScenePlotArguments& arguments, const Shell& shell) {
    arguments.plot.check(shell);
    Request request = arguments.scene.parse();
    std::sort(request.wavelength_nm.begin(), request.wavelength_nm.end());  // rgb comes descending
    std::vector<double> incidence_deg = incidences(arguments);
    // Members of a family differ in one number; a second one would need colours of its own.
    if (!arguments.vary.empty()) incidence_deg.resize(1);
    const ObserverWeights weights = observer_weights(request.wavelength_nm);

    std::vector<plot::Spectrum> spectra;
    // Scenes have colours, the kinds of light dashes; the legend has each once.
    int scene = 0;
    const auto add = [&](const ShownScene& shown, const std::string& what, int kind,
                         std::vector<double> values) {
        const LinearSrgb colour = to_linear_srgb(to_xyz(weights, values));
        spectra.push_back({shown.label.empty() ? what
                           : kind == 0         ? shown.label
                                               : "",
                           request.wavelength_nm, std::move(values), colour, shown.shade,
                           plot::Mark::line,
                           scene % plot::kCurveColours + plot::kCurveColours * kind});
    };
    bool converged = true;
    const std::vector<ShownScene> all_scenes = shown_scenes(arguments, request);
    for (const ShownScene& shown : all_scenes) {
        const AlbedoValues values =
            solved(shown.request, shell.control()).albedo(cosines_of(incidence_deg));
        converged = converged && values.converged();
        if (shown.shade) {
            add(shown, "", 0, values.spherical_albedo);
            continue;
        }
        add(shown, "spherical", 0, values.spherical_albedo);
        for (std::size_t i = 0; i < incidence_deg.size(); ++i) {
            std::vector<double> plane;
            for (const std::vector<double>& at : values.plane_albedo) plane.push_back(at[i]);
            add(shown, fmt::format("incidence {:.3g}\u00b0", incidence_deg[i]), int(i) + 1,
                std::move(plane));
        }
        ++scene;
    }
    for (std::size_t i = 0; scene > 1 && i <= incidence_deg.size(); ++i) {
        const std::string kind =
            i == 0 ? "spherical" : fmt::format("incidence {:.3g}\u00b0", incidence_deg[i - 1]);
        spectra.push_back({"any colour: " + kind,
                           {},
                           {},
                           {},
                           {},
                           plot::Mark::line,
                           plot::kCurveColours * int(i)});
    }
    for (const std::string& path : arguments.points) {
        for (plot::Spectrum& points : measured_points(path, request.wavelength_nm))
            spectra.push_back(std::move(points));
    }
    arguments.plot.save(
        plot::draw_spectrum(spectra, arguments.vary.empty() ? "albedo" : "spherical albedo",
                            arguments.plot.caption(shell, title_of(all_scenes, arguments))),
        shell);
    return converged ? kGood : kNotConverged;
}

}  // namespace

void add_scene_plots(CLI::App& plot, Shell& shell) {
    auto lobe = std::make_shared<ScenePlotArguments>();
    auto* lobe_command =
        add_scene_kind(plot, shell, "lobe", "BRDF in the plane of incidence", lobe);
    add_incidence_option(*lobe_command, "0,30,60", lobe);
    add_component_options(*lobe_command, lobe);
    add_scene_choices(*lobe_command, lobe);
    lobe_command->add_flag("--cosine", lobe->cosine,
                           "show the BRDF times the cosine of the angle of reflection");
    option(*lobe_command, "--decades", lobe->decades, "", "decades that a logarithmic radius shows")
        ->check(CLI::Range(1, 12));
    finish(*lobe_command, shell, lobe, run_lobe,
           "Example:\n  miebrdf plot lobe --base TiO2 --coat AlGaAs7@0.1 --roughness 0.3 "
           "--wavelengths 550 -o lobe.png",
           Writes::file);

    auto spectrum = std::make_shared<ScenePlotArguments>();
    auto* spectrum_command = add_scene_kind(plot, shell, "spectrum",
                                            "spherical and plane albedo against wavelength, and "
                                            "their colours under D65",
                                            spectrum);
    add_incidence_option(*spectrum_command, "0,60", spectrum);
    add_scene_choices(*spectrum_command, spectrum);
    option(
        *spectrum_command, "--points", spectrum->points, "FILE",
        "measured spectra to draw as points: whatever `miebrdf measured` reads; repeat it for more")
        ->allow_extra_args(false);
    finish(
        *spectrum_command, shell, spectrum, run_spectrum,
        "Example:\n  miebrdf plot spectrum --base AlGaAs7 --wavelengths 400:700:10 -o spectrum.svg",
        Writes::file);
}

}  // namespace miebrdf::program
