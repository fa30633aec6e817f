// miebrdf plot nk, optics, phase: what is known of media before any radiative transfer.
#include <fmt/format.h>

#include <miebrdf/error.h>
#include "pipeline/plot/spectra.h"
#include "pipeline/scene/number_list.h"
#include "pipeline/solve/medium_optics.h"
#include "pipeline/solve/parallel.h"
#include "tools/miebrdf/plot_command.h"

namespace miebrdf::program {
namespace {

constexpr double kMieTolerance = 1e-3;  // a tenth of a line's width in a chart of this size

struct MediumPlotArguments {
    std::vector<std::string> media;
    bool polar = false;
    int decades = 0;
    MaterialArguments materials;
    ParticleArguments particles;
    PlotArguments plot;
};

/// Optics of every medium at every wavelength: [medium][wavelength].
std::vector<std::vector<MediumOptics>> compute(const MediumPlotArguments& arguments,
                                               const std::vector<double>& wavelength_nm,
                                               const std::vector<double>& angles_deg,
                                               const Shell& shell) {
    ParticleOptions particles = arguments.particles.parse();
    validate(particles);
    OpticsDemand demand;
    demand.highest_moment = 1;
    demand.angles_deg = angles_deg;
    demand.tolerance = particles.tolerance > 0.0 ? particles.tolerance : kMieTolerance;
    MediumResolver resolver(arguments.materials.database());
    std::vector<ResolvedMedium> media;
    for (const std::string& name : arguments.media)
        media.push_back(resolver.resolve(parse_medium(name)));

    const std::size_t count = wavelength_nm.size();
    std::vector<std::vector<MediumOptics>> optics(media.size(), std::vector<MediumOptics>(count));
    const mie::Executor pieces = pieces_of_job(shell.control());
    run_parallel("single scattering", media.size() * count, shell.control(), [&](std::size_t job) {
        optics[job / count][job % count] = medium_optics(
            media[job / count], wavelength_nm[job % count], particles, demand, pieces);
    });
    return optics;
}

int run_nk(const MediumPlotArguments& arguments, const Shell& shell) {
    arguments.plot.check(shell);
    MediumResolver resolver(arguments.materials.database());
    const std::vector<double> wanted = arguments.materials.wavelengths_nm();
    std::vector<plot::IndexCurve> curves;
    for (const std::string& name : arguments.media) {
        const ResolvedMedium medium = resolver.resolve(parse_medium(name));
        plot::IndexCurve curve{name, {}, {}, {}};
        for (const double nm : wanted) {
            if (medium.table && !medium.table->covers(nm)) continue;  // ends where its table ends
            const auto index = medium.index_at(nm, 0.0);
            if (!index) continue;
            curve.wavelength_nm.push_back(nm);
            curve.n.push_back(index->real());
            curve.k.push_back(index->imag());
        }
        if (curve.n.empty()) {
            throw UsageError(
                fmt::format("'{}' has no refractive index at these wavelengths", name));
        }
        curves.push_back(std::move(curve));
    }
    arguments.plot.save(
        plot::draw_nk(std::move(curves), arguments.plot.caption(shell, "Complex refractive index")),
        shell);
    return kGood;
}

int run_optics(const MediumPlotArguments& arguments, const Shell& shell) {
    arguments.plot.check(shell);
    const std::vector<double> wavelengths = arguments.materials.wavelengths_nm();
    const auto optics = compute(arguments, wavelengths, {}, shell);
    std::vector<plot::OpticsCurve> curves;
    bool converged = true;
    for (std::size_t m = 0; m < optics.size(); ++m) {
        plot::OpticsCurve curve{arguments.media[m], wavelengths, {}, {}, {}};
        for (const MediumOptics& o : optics[m]) {
            curve.single_scattering_albedo.push_back(o.optics.single_scattering_albedo);
            curve.asymmetry.push_back(o.asymmetry);
            if (o.q_ext) curve.q_ext.push_back(*o.q_ext);
            converged = converged && o.converged;
        }
        curves.push_back(std::move(curve));
    }
    arguments.plot.save(
        plot::draw_optics(curves, arguments.plot.caption(shell, "Single scattering")), shell);
    return converged ? kGood : kNotConverged;
}

/// Finer where Mie's forward peak and glory are.
std::vector<double> phase_angles() {
    return parse_number_list("0:2:0.05,2.1:10:0.1,10.5:170:0.5,170.1:180:0.1",
                             "scattering angle (degrees)");
}

int run_phase(const MediumPlotArguments& arguments, const Shell& shell) {
    arguments.plot.check(shell);
    const std::vector<double> wavelengths = arguments.materials.wavelengths_nm();
    const std::vector<double> angles = phase_angles();
    const auto optics = compute(arguments, wavelengths, angles, shell);
    std::vector<plot::PhaseCurve> curves;
    bool converged = true;
    for (std::size_t m = 0; m < optics.size(); ++m) {
        for (std::size_t w = 0; w < wavelengths.size(); ++w) {
            curves.push_back({fmt::format("{}, {:g} nm", arguments.media[m], wavelengths[w]),
                              angles, optics[m][w].phase});
            converged = converged && optics[m][w].converged;
        }
    }
    const plot::Caption caption = arguments.plot.caption(shell, "Phase function");
    arguments.plot.save(arguments.polar ? plot::draw_phase_polar(curves, caption, arguments.decades)
                                        : plot::draw_phase(curves, caption),
                        shell);
    return converged ? kGood : kNotConverged;
}

CLI::App* add_kind(CLI::App& plot, Shell& shell, const std::string& kind, const std::string& title,
                   const std::string& wavelengths, MediumPlotArguments& arguments) {
    auto* command = plot.add_subcommand(kind, title);
    command
        ->add_option("media", arguments.media,
                     "one curve for each: NAME, index:N,K, hg:ALBEDO,G, ...")
        ->type_name("MEDIUM...")
        ->required();
    arguments.materials.add_to(*command, wavelengths);
    arguments.plot.add_to(*command);
    shell.add_common_options(*command, Writes::file);
    return command;
}

}  // namespace

void add_medium_plots(CLI::App& plot, Shell& shell) {
    auto nk = std::make_shared<MediumPlotArguments>();
    auto* nk_command = add_kind(plot, shell, "nk", "n and k against wavelength", "360:830:2", *nk);
    nk_command->footer("Example:\n  miebrdf plot nk GaP TiO2 AlGaAs7 -o nk.svg");
    shell.on_run(*nk_command, [nk, &shell] { return run_nk(*nk, shell); });

    auto optics = std::make_shared<MediumPlotArguments>();
    auto* optics_command =
        add_kind(plot, shell, "optics", "albedo, asymmetry and extinction against wavelength",
                 "400:700:10", *optics);
    optics->particles.add_to(*optics_command);
    optics_command->footer("Example:\n  miebrdf plot optics TiO2 AlGaAs7 -o optics.png");
    shell.on_run(*optics_command, [optics, &shell] { return run_optics(*optics, shell); });

    auto phase = std::make_shared<MediumPlotArguments>();
    auto* phase_command = add_kind(plot, shell, "phase",
                                   "phase function against the scattering angle", "550", *phase);
    phase->particles.add_to(*phase_command);
    phase_command->add_flag("--polar", phase->polar, "around the particle, logarithmic radius");
    phase_command
        ->add_option("--decades", phase->decades, "of the polar radius; 0: as many as are needed")
        ->check(CLI::Range(0, 12))
        ->capture_default_str();
    phase_command->footer(
        "Example:\n  miebrdf plot phase AlGaAs7 hg:0.9,0.75 --wavelengths 550 -o phase.png");
    shell.on_run(*phase_command, [phase, &shell] { return run_phase(*phase, shell); });
}

}  // namespace miebrdf::program
