// miebrdf sphere, optics, phase: single scattering by a sphere, by a medium.
#include <fmt/format.h>

#include <miebrdf/error.h>
#include "mie/sphere/amplitudes.h"
#include "mie/sphere/sphere.h"
#include "pipeline/scene/number_list.h"
#include "pipeline/solve/medium_optics.h"
#include "pipeline/solve/parallel.h"
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {
namespace {

struct SphereArguments {
    std::string index;
    std::string size_parameters;
    std::string angles;
};

Table efficiencies(std::complex<double> index, const std::vector<double>& size_parameters,
                   bool& all_reached) {
    Table table;
    table.columns = {"n", "k", "size_parameter", "q_ext", "q_sca", "q_abs", "q_back", "asymmetry"};
    for (const double x : size_parameters) {
        const mie::SphereOptics sphere = mie::scatter_by_sphere(index, x);
        all_reached = all_reached && sphere.reached;
        table.rows.push_back({index.real(), index.imag(), x, sphere.q_ext, sphere.q_sca,
                              sphere.q_abs, sphere.q_back, sphere.asymmetry});
    }
    return table;
}

Table amplitudes(std::complex<double> index, const std::vector<double>& size_parameters,
                 const std::vector<double>& angles_deg) {
    Table table;
    table.facts.emplace_back("units", "angle_deg in degrees; S1, S2 for time factor exp(-i w t)");
    table.columns = {"n", "k", "size_parameter", "angle_deg", "s1_re", "s1_im", "s2_re", "s2_im"};
    for (const double x : size_parameters) {
        const mie::Amplitudes a = mie::scattering_amplitudes(index, x, angles_deg);
        for (std::size_t i = 0; i < angles_deg.size(); ++i) {
            table.rows.push_back({index.real(), index.imag(), x, angles_deg[i], a.s1[i].real(),
                                  a.s1[i].imag(), a.s2[i].real(), a.s2[i].imag()});
        }
    }
    return table;
}

int run(const SphereArguments& arguments, const Shell& shell) {
    const std::complex<double> index = parse_index(arguments.index, "index");
    const auto sizes = parse_number_list(arguments.size_parameters, "size parameter");
    bool all_reached = true;
    Table table = arguments.angles.empty()
                      ? efficiencies(index, sizes, all_reached)
                      : amplitudes(index, sizes,
                                   parse_number_list(arguments.angles, "scattering angle (degrees)",
                                                     0.0, 180.0));
    if (!all_reached)
        table.facts.emplace_back("not converged", "some series were not summed to rounding");
    shell.write(std::move(table));
    return all_reached ? kGood : kNotConverged;
}

constexpr double kDefaultMieTolerance = 1e-4;

struct MediumArguments {
    std::string medium;
    int highest_moment = -1;
    std::string angles;
    MaterialArguments materials;
    ParticleArguments particles;
};

struct MediumSpectrum {
    std::string source;
    std::string particles;  ///< empty: no Mie theory
    std::vector<double> wavelength_nm;
    std::vector<MediumOptics> optics;
    bool converged = true;
};

MediumSpectrum compute(const MediumArguments& arguments, const std::vector<double>& angles_deg,
                       const RunControl& control) {
    const ParticleOptions particles = arguments.particles.parse();
    validate(particles);
    OpticsDemand demand;
    demand.highest_moment = arguments.highest_moment;
    demand.angles_deg = angles_deg;
    demand.tolerance = particles.tolerance > 0.0 ? particles.tolerance : kDefaultMieTolerance;

    MediumSpectrum spectrum;
    spectrum.wavelength_nm = arguments.materials.wavelengths_nm();
    MediumResolver resolver(arguments.materials.database());
    const ResolvedMedium medium = resolver.resolve(parse_medium(arguments.medium));
    require_contrast(medium, spectrum.wavelength_nm, particles);
    spectrum.source = medium.source;
    if (needs_mie(medium.medium))
        spectrum.particles = describe_particles(particles_of(medium.medium, particles));
    spectrum.optics.resize(spectrum.wavelength_nm.size());
    const mie::Executor pieces = pieces_of_job(control);
    run_parallel("single scattering", spectrum.optics.size(), control, [&](std::size_t w) {
        spectrum.optics[w] =
            medium_optics(medium, spectrum.wavelength_nm[w], particles, demand, pieces);
    });
    for (const MediumOptics& optics : spectrum.optics) {
        spectrum.converged = spectrum.converged && optics.converged;
    }
    return spectrum;
}

void add_facts(Table& table, const MediumSpectrum& spectrum, const std::string& units) {
    table.facts.emplace_back("units", units);
    table.facts.emplace_back("source", spectrum.source);
    if (!spectrum.particles.empty()) table.facts.emplace_back("particles", spectrum.particles);
    if (!spectrum.converged) {
        table.facts.emplace_back("not converged", "the size average missed its tolerance");
    }
}

Cell cell_of(const std::optional<double>& value) { return value ? Cell(*value) : Cell(); }

int run_optics(const MediumArguments& arguments, const Shell& shell) {
    const MediumSpectrum spectrum = compute(arguments, {}, shell.control());
    Table table;
    add_facts(table, spectrum, "wavelength_nm: nm in vacuum; all others dimensionless");
    table.columns = {"wavelength_nm", "n", "k", "single_scattering_albedo", "asymmetry", "q_ext",
                     "error_estimate"};
    for (int l = 0; l <= arguments.highest_moment; ++l)
        table.columns.push_back(fmt::format("chi_{}", l));
    for (std::size_t w = 0; w < spectrum.optics.size(); ++w) {
        const MediumOptics& o = spectrum.optics[w];
        std::vector<Cell> row = {spectrum.wavelength_nm[w],
                                 o.refractive_index ? Cell(o.refractive_index->real()) : Cell(),
                                 o.refractive_index ? Cell(o.refractive_index->imag()) : Cell(),
                                 o.optics.single_scattering_albedo,
                                 o.asymmetry,
                                 cell_of(o.q_ext),
                                 o.error_estimate};
        for (int l = 0; l <= arguments.highest_moment; ++l) {
            const auto& chi = o.optics.chi;
            row.emplace_back(l < static_cast<int>(chi.size()) ? chi[l] : 0.0);
        }
        table.rows.push_back(std::move(row));
    }
    shell.write(std::move(table));
    return spectrum.converged ? kGood : kNotConverged;
}

int run_phase(const MediumArguments& arguments, const Shell& shell) {
    const auto angles =
        parse_number_list(arguments.angles, "scattering angle (degrees)", 0.0, 180.0);
    const MediumSpectrum spectrum = compute(arguments, angles, shell.control());
    Table table;
    add_facts(table, spectrum,
              "wavelength_nm: nm in vacuum; angle_deg: degrees; phase: mean over the sphere = 1");
    table.columns = {"wavelength_nm", "angle_deg", "phase"};
    for (std::size_t w = 0; w < spectrum.optics.size(); ++w) {
        for (std::size_t a = 0; a < angles.size(); ++a) {
            table.rows.push_back(
                {spectrum.wavelength_nm[w], angles[a], spectrum.optics[w].phase[a]});
        }
    }
    shell.write(std::move(table));
    return spectrum.converged ? kGood : kNotConverged;
}

void add_medium_options(CLI::App& command, MediumArguments& arguments) {
    command
        .add_option("medium", arguments.medium,
                    "a material's NAME, source:KEY, index:N,K, isotropic:ALBEDO, "
                    "rayleigh:ALBEDO, hg:ALBEDO,G or moments:FILE; spheres may have their "
                    "sizes beside them: TiO2,radius=0.2,variance=0.1,distribution=gamma")
        ->type_name("MEDIUM")
        ->required();
    arguments.materials.add_to(command, "rgb");
    arguments.particles.add_to(command);
}

}  // namespace

void add_sphere(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<SphereArguments>();
    command
        .add_option("--index", arguments->index, "refractive index relative to the host, n + ik")
        ->type_name("N,K")
        ->required();
    command
        .add_option("--size-parameter", arguments->size_parameters,
                    "2 pi radius / wavelength in the host, list or range")
        ->type_name("LIST")
        ->required();
    command
        .add_option("--angles", arguments->angles,
                    "scattering angles in degrees: print amplitudes S1, S2 there instead")
        ->type_name("LIST");
    shell.add_common_options(command);
    command.footer("Example:\n  miebrdf sphere --index 1.5,0.01 --size-parameter 1,10,100");
    shell.on_run(command, [arguments, &shell] { return run(*arguments, shell); });
}

void add_optics(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<MediumArguments>();
    add_medium_options(command, *arguments);
    command.add_option("--moments", arguments->highest_moment, "print chi_0 to chi_L")
        ->type_name("L")
        ->check(CLI::Range(0, 100000));
    shell.add_common_options(command);
    command.footer("Example:\n  miebrdf optics TiO2 --wavelengths 400:700:50 --moments 8");
    shell.on_run(command, [arguments, &shell] { return run_optics(*arguments, shell); });
}

void add_phase(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<MediumArguments>();
    add_medium_options(command, *arguments);
    arguments->angles = "0:180:1";
    command.add_option("--angles", arguments->angles, "scattering angles in degrees")
        ->type_name("LIST")
        ->capture_default_str();
    shell.add_common_options(command);
    command.footer("Example:\n  miebrdf phase water --wavelengths 550 --angles 0:180:1");
    shell.on_run(command, [arguments, &shell] { return run_phase(*arguments, shell); });
}

}  // namespace miebrdf::program
