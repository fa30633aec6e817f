// miebrdf plot nk, optics, phase: what is known of media before any radiative transfer.
#include <fmt/format.h>

#include <miebrdf/error.h>
#include "pipeline/plot/spectra.h"
#include "pipeline/scene/labels.h"
#include "pipeline/scene/number_list.h"
#include "pipeline/solve/named_index.h"
#include "tools/miebrdf/materials_command.h"
#include "tools/miebrdf/plot_command.h"
#include "tools/miebrdf/plot_scenes.h"
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {
namespace {

constexpr double kMieTolerance = 1e-3;  // a tenth of a line's width in a chart of this size

struct MediumPlotArguments {
    std::vector<std::string> media;
    std::string vary;  ///< of optics and phase
    bool polar = false;
    int decades = 0;
    MediaArguments options;  ///< of optics and phase
    SceneArguments scene;    ///< of nk: wavelengths and database
    PlotArguments plot;
};

/// Optics of every medium at every wavelength.
MediaSpectra compute(const MediumPlotArguments& arguments, const std::vector<double>& angles_deg,
                     const Shell& shell) {
    std::vector<std::string> media;
    for (const ShownMedium& one : shown_media(arguments.media, arguments.vary))
        media.push_back(one.text);
    MediaSpectra spectra = arguments.options.look_up(
        media, {.highest_moment = 1, .angles_deg = angles_deg, .tolerance = kMieTolerance});
    spectra.compute(shell.control());
    return spectra;
}

/// n and k where they are known: the curve ends where its table ends.
plot::IndexCurve index_curve(const std::string& name, const std::vector<double>& wavelength_nm,
                             const std::string& database) {
    plot::IndexCurve curve{name, {}, {}, {}};
    const auto add = [&](double nm, std::complex<double> index) {
        curve.wavelength_nm.push_back(nm);
        curve.n.push_back(index.real());
        curve.k.push_back(index.imag());
    };
    const Species shown = species(name);
    if (shown.kind == Species::Kind::material) {
        const auto table = open_database(database).refractive_index(shown.name);
        for (const double nm : wavelength_nm) {
            if (table.covers(nm)) add(nm, table.at(nm));
        }
    } else if (needs_mie(shown)) {
        const ResolvedIndex resolved = resolve_index(shown, wavelength_nm, database);
        for (std::size_t w = 0; w < wavelength_nm.size(); ++w)
            add(wavelength_nm[w], resolved.index[w]);
    }
    if (curve.n.empty())
        throw UsageError(fmt::format("'{}' has no refractive index at these wavelengths", name));
    return curve;
}

int run_nk(const MediumPlotArguments& arguments, const Shell& shell) {
    arguments.plot.check(shell);
    const Request request = arguments.scene.parse();
    std::vector<plot::IndexCurve> curves;
    for (const std::string& name : arguments.media)
        curves.push_back(index_curve(name, request.wavelength_nm, request.scene.database));
    arguments.plot.save(
        plot::draw_nk(std::move(curves), arguments.plot.caption(shell, "Complex refractive index")),
        shell);
    return kGood;
}

/// "Single scattering of TiO2" for a family, whose curves say the rest.
std::string family_title(const std::string& what, const MediumPlotArguments& arguments) {
    if (arguments.vary.empty()) return what;
    return what + " of " + label_of(medium(arguments.media.front()));
}

int run_optics(const MediumPlotArguments& arguments, const Shell& shell) {
    arguments.plot.check(shell);
    const MediaSpectra spectra = compute(arguments, {}, shell);
    std::vector<plot::OpticsCurve> curves;
    const std::vector<ShownMedium> shown = shown_media(arguments.media, arguments.vary);
    for (std::size_t m = 0; m < shown.size(); ++m) {
        plot::OpticsCurve& curve = curves.emplace_back(plot::OpticsCurve{
            shown[m].label, spectra.scene.wavelength_nm, {}, {}, {}, shown[m].shade});
        for (const std::vector<MediumOptics>& media : spectra.optics) {
            const MediumOptics& o = media[m];
            curve.single_scattering_albedo.push_back(o.optics.single_scattering_albedo);
            curve.asymmetry.push_back(o.asymmetry);
            if (o.q_ext) curve.q_ext.push_back(*o.q_ext);
        }
    }
    arguments.plot.save(
        plot::draw_optics(
            curves, arguments.plot.caption(shell, family_title("Single scattering", arguments))),
        shell);
    return spectra.converged() ? kGood : kNotConverged;
}

/// Finer where Mie's forward peak and glory are.
std::vector<double> phase_angles() {
    return parse_number_list("0:2:0.05,2.1:10:0.1,10.5:170:0.5,170.1:180:0.1",
                             "scattering angle (degrees)");
}

int run_phase(const MediumPlotArguments& arguments, const Shell& shell) {
    arguments.plot.check(shell);
    const std::vector<double> angles = phase_angles();
    const MediaSpectra spectra = compute(arguments, angles, shell);
    const std::vector<double>& wavelength_nm = spectra.scene.wavelength_nm;
    std::vector<plot::PhaseCurve> curves;
    const std::vector<ShownMedium> shown = shown_media(arguments.media, arguments.vary);
    // What all curves have in common stands in the title alone.
    const bool one_medium = shown.size() == 1, one_wavelength = wavelength_nm.size() == 1;
    for (std::size_t m = 0; m < shown.size(); ++m) {
        for (std::size_t w = 0; w < wavelength_nm.size(); ++w) {
            const std::string nm = fmt::format("{:g} nm", wavelength_nm[w]);
            curves.push_back({one_wavelength ? shown[m].label
                              : one_medium   ? nm
                                             : shown[m].label + ", " + nm,
                              angles, spectra.optics[w][m].phase, shown[m].shade});
        }
    }
    std::string title = family_title("Phase function", arguments);
    if (one_medium && !one_wavelength && arguments.vary.empty()) title += " of " + shown[0].label;
    if (one_wavelength) title += fmt::format(", {:g} nm", wavelength_nm[0]);
    const plot::Caption caption = arguments.plot.caption(shell, title);
    arguments.plot.save(arguments.polar ? plot::draw_phase_polar(curves, caption, arguments.decades)
                                        : plot::draw_phase(curves, caption),
                        shell);
    return spectra.converged() ? kGood : kNotConverged;
}

CLI::App* add_kind(CLI::App& plot, const std::string& kind, const std::string& title,
                   MediumPlotArguments& arguments) {
    auto* command = plot.add_subcommand(kind, title);
    option(*command, "media", arguments.media, "MEDIUM...",
           "one curve for each: NAME, index:N,K, hg:ALBEDO,G, ...")
        ->required();
    arguments.plot.add_to(*command);
    return command;
}

void add_vary(CLI::App& command, MediumPlotArguments& arguments) {
    option(command, "--vary", arguments.vary, "FAMILY",
           "a family of one medium: radius=FROM:TO:COUNT or radius=A,B,C (um), or concentration of "
           "its first species");
}

}  // namespace

void add_medium_plots(CLI::App& plot, Shell& shell) {
    auto nk = std::make_shared<MediumPlotArguments>();
    auto* nk_command = add_kind(plot, "nk", "n and k against wavelength", *nk);
    nk->scene.add_to(*nk_command, shell, {"wavelengths", "database"}, "360:830:2");
    finish(*nk_command, shell, nk, run_nk, "Example:\n  miebrdf plot nk GaP TiO2 AlGaAs7 -o nk.svg",
           Writes::file);

    auto optics = std::make_shared<MediumPlotArguments>();
    auto* optics_command =
        add_kind(plot, "optics", "albedo, asymmetry and extinction against wavelength", *optics);
    optics->options.add_to(*optics_command, shell, "400:700:10");
    add_vary(*optics_command, *optics);
    finish(*optics_command, shell, optics, run_optics,
           "Example:\n  miebrdf plot optics TiO2 AlGaAs7 -o optics.png", Writes::file);

    auto phase = std::make_shared<MediumPlotArguments>();
    auto* phase_command =
        add_kind(plot, "phase", "phase function against the scattering angle", *phase);
    phase->options.add_to(*phase_command, shell, "550");
    add_vary(*phase_command, *phase);
    phase_command->add_flag("--polar", phase->polar,
                            "draw it around the particle, with a logarithmic radius");
    option(*phase_command, "--decades", phase->decades, "",
           "decades that the polar radius shows; 0: as many as needed")
        ->check(CLI::Range(0, 12));
    finish(*phase_command, shell, phase, run_phase,
           "Example:\n  miebrdf plot phase AlGaAs7 hg:0.9,0.75 --wavelengths 550 -o phase.png",
           Writes::file);
}

}  // namespace miebrdf::program
