// miebrdf sphere, optics, phase: single scattering by a sphere, by a medium.
#include <fmt/format.h>

#include <numbers>
#include <optional>

#include <miebrdf/ensemble.h>
#include <miebrdf/error.h>
#include <miebrdf/sphere.h>
#include "pipeline/scene/number_list.h"
#include "rte/phase/polarisation.h"
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {
namespace {

struct SphereArguments {
    std::string index;
    std::optional<double> aspect;
    std::string size_parameters;
    std::vector<std::string> coatings;
    std::string angles;
};

// The index of the core, and coatings from inside out.
struct Particle {
    std::complex<double> index;
    std::vector<mie::SphereLayer> coatings;

    std::vector<mie::SphereLayer> of_size(double x) const {
        std::vector<mie::SphereLayer> layers = {{index, x}};
        layers.insert(layers.end(), coatings.begin(), coatings.end());
        return layers;
    }
};

mie::SphereLayer parse_coating(const std::string& words) {
    const std::size_t last = words.rfind(',');
    if (last == std::string::npos || words.find(',') == last) {
        throw UsageError(fmt::format(
            "--coating: '{}'; allowed: N,K,Y, the coating's index and the size parameter of its "
            "outside, such as 1.46,0,12",
            words));
    }
    return {parse_index(std::vector<WordValue>{words.substr(0, last)}, "index of the coating"),
            parse_number(words.substr(last + 1), "size parameter of the coating")};
}

Table efficiencies(const Particle& particle, const std::vector<double>& size_parameters) {
    const std::complex<double> index = particle.index;
    Table table;
    std::string status;  // a word on rounding, the same for all sizes above the smallest
    table.facts.emplace_back(
        "units", std::string(particle.coatings.empty() ? "" : "size_parameter of the core; ") +
                     "efficiencies: cross-sections over the section of the "
                     "whole particle; q_back: radar backscattering, 4 pi "
                     "times the cross-section per steradian straight back");
    table.columns = {"n", "k", "size_parameter", "q_ext", "q_sca", "q_abs", "q_back", "asymmetry"};
    for (const double x : size_parameters) {
        const mie::SphereOptics sphere = particle.coatings.empty()
                                             ? mie::scatter_by_sphere(index, x)
                                             : mie::scatter_by_sphere(particle.of_size(x));
        if (!sphere.reached) status = sphere.status;
        table.rows.push_back({index.real(), index.imag(), x, sphere.q_ext, sphere.q_sca,
                              sphere.q_abs, sphere.q_back, sphere.asymmetry});
    }
    if (!status.empty()) table.facts.emplace_back("note", status);
    return table;
}

/// Spheroids in random orientation, by the T-matrix.
Table spheroids(std::complex<double> index, double aspect,
                const std::vector<double>& size_parameters, bool& converged) {
    Table table;
    table.facts.emplace_back(
        "units",
        "spheroids in random orientation; aspect: equatorial axis over the axis of rotation; "
        "size_parameter and the section of efficiencies: of the sphere of the same volume; q_back: "
        "4 pi times the cross-section per steradian straight back; error_estimate: of Q and g");
    table.columns = {"n",     "k",     "aspect", "size_parameter", "q_ext",
                     "q_sca", "q_abs", "q_back", "asymmetry",      "error_estimate"};
    for (const double x : size_parameters) {
        mie::EnsembleRequest request;
        request.sizes = {mie::SizeDistributionKind::mono, x};
        request.wavelength_nm = 2e3 * std::numbers::pi;  // k = 1/um
        request.refractive_index = index;
        request.aspect = aspect;
        const mie::EnsembleOptics optics = mie::average_matrix(request).optics;
        double back = 0.0, sign = 1.0;
        for (std::size_t l = 0; l < optics.chi.size(); ++l, sign = -sign)
            back += sign * (2.0 * static_cast<double>(l) + 1.0) * optics.chi[l];
        converged = converged && optics.converged;
        table.rows.push_back({index.real(), index.imag(), aspect, x, optics.q_ext, optics.q_sca,
                              optics.q_abs, optics.q_sca * back, optics.asymmetry,
                              optics.error_estimate});
    }
    return table;
}

Table amplitudes(const Particle& particle, const std::vector<double>& size_parameters,
                 const std::vector<double>& angles_deg) {
    const std::complex<double> index = particle.index;
    Table table;
    table.facts.emplace_back("units", "angle_deg in degrees; S1, S2 for time factor exp(-i w t)");
    table.columns = {"n", "k", "size_parameter", "angle_deg", "s1_re", "s1_im", "s2_re", "s2_im"};
    for (const double x : size_parameters) {
        const mie::Amplitudes a = mie::scattering_amplitudes(particle.of_size(x), angles_deg);
        for (std::size_t i = 0; i < angles_deg.size(); ++i) {
            table.rows.push_back({index.real(), index.imag(), x, angles_deg[i], a.s1[i].real(),
                                  a.s1[i].imag(), a.s2[i].real(), a.s2[i].imag()});
        }
    }
    return table;
}

int run(const SphereArguments& arguments, const Shell& shell) {
    Particle particle{parse_index(std::vector<WordValue>{arguments.index}, "index"), {}};
    for (const std::string& words : arguments.coatings)
        particle.coatings.push_back(parse_coating(words));
    const auto sizes = parse_number_list(arguments.size_parameters, "size parameter");
    if (arguments.aspect) {
        if (!arguments.coatings.empty() || !arguments.angles.empty()) {
            throw UsageError(
                "--aspect: spheroids here are of one material and in random orientation: leave "
                "--coating and --angles out; their scattering matrix: miebrdf phase --stokes "
                "\"index:N,K,radius=R,distribution=mono,shape=spheroid,aspect=A,method=t-matrix\"");
        }
        bool converged = true;
        return shell.write(spheroids(particle.index, *arguments.aspect, sizes, converged),
                           converged);
    }
    Table table = arguments.angles.empty()
                      ? efficiencies(particle, sizes)
                      : amplitudes(particle, sizes,
                                   parse_number_list(arguments.angles, "scattering angle (degrees)",
                                                     0.0, 180.0));
    return shell.write(std::move(table));
}

constexpr double kDefaultMieTolerance = 1e-4;

struct MediumArguments {
    std::string medium;
    std::optional<int> highest_moment;
    std::string angles;
    bool matrix = false;
    MediaArguments media;

    MediaSpectra look_up(const std::vector<double>& angles_deg) const {
        return media.look_up({medium}, {.highest_moment = highest_moment.value_or(-1),
                                        .angles_deg = angles_deg,
                                        .tolerance = kDefaultMieTolerance,
                                        .polarisation = matrix});
    }
};

void add_facts(Table& table, const MediaSpectra& spectra, const std::string& units) {
    table.facts.emplace_back("units", units);
    table.facts.emplace_back("source", spectra.scene.sources.front());
    if (!spectra.particles.empty()) table.facts.emplace_back("particles", spectra.particles);
    if (!spectra.converged())
        table.facts.emplace_back("not converged", "the size average missed its tolerance");
}

std::vector<Cell> optics_row(const MediaSpectra& spectra, std::size_t w) {
    const MediumOptics& o = spectra.optics[w].front();
    const ResolvedMedium& medium = spectra.scene.media.front();
    // The index of a mixture is that of nothing in it.
    std::optional<std::complex<double>> index;
    if (medium.needs_mie() && medium.species.size() == 1)
        index = medium.species.front().particles[w].index;
    std::vector<Cell> row = {spectra.scene.wavelength_nm[w],
                             index ? Cell(index->real()) : Cell(),
                             index ? Cell(index->imag()) : Cell(),
                             o.optics.single_scattering_albedo,
                             o.asymmetry,
                             cell_of(o.q_ext),
                             o.error_estimate};
    const auto& chi = o.optics.chi;
    for (int l = 0; l <= spectra.demand.highest_moment; ++l)
        row.emplace_back(l < static_cast<int>(chi.size()) ? chi[l] : 0.0);
    return row;
}

int write_optics(MediaSpectra spectra, const Shell& shell) {
    spectra.compute(shell.control());
    Table table;
    // Ensembles of files have a cross-section, or an extinction in a unit that nobody knows: their
    // area is not known, so there is no Q.
    const auto& species = spectra.scene.media.front().species;
    const FileScattering& file = species.front().species.scattering;
    const bool has_area = species.size() > 1 || file.extinction.empty() || !file.radius_um.empty();
    const char* extinction = has_area                  ? "q_ext"
                             : file.has_cross_sections ? "extinction_um2"
                                                       : "extinction";
    add_facts(table, spectra,
              fmt::format("wavelength_nm: nm in vacuum; {}all others dimensionless",
                          has_area                  ? ""
                          : file.has_cross_sections ? "extinction_um2: um2 of a particle; "
                                                    : "extinction: in the unit of the file; "));
    table.columns = {"wavelength_nm", "n", "k", "single_scattering_albedo", "asymmetry", extinction,
                     "error_estimate"};
    for (int l = 0; l <= spectra.demand.highest_moment; ++l)
        table.columns.push_back(fmt::format("chi_{}", l));
    for (std::size_t w = 0; w < spectra.optics.size(); ++w)
        table.rows.push_back(optics_row(spectra, w));
    return shell.write(std::move(table), spectra.converged());
}

int write_phase(MediaSpectra spectra, const Shell& shell) {
    spectra.compute(shell.control());
    Table table;
    add_facts(table, spectra,
              "wavelength_nm: nm in vacuum; angle_deg: degrees; phase: mean over the sphere = 1; "
              "error_estimate: of phase, absolute, one in a hundred errs by more");
    table.columns = {"wavelength_nm", "angle_deg", "phase", "error_estimate"};
    const std::vector<double>& angles = spectra.demand.angles_deg;
    for (std::size_t w = 0; w < spectra.optics.size(); ++w) {
        for (std::size_t a = 0; a < angles.size(); ++a) {
            const MediumOptics& optics = spectra.optics[w].front();
            table.rows.push_back({spectra.scene.wavelength_nm[w], angles[a], optics.phase[a],
                                  optics.phase_error[a]});
        }
    }
    return shell.write(std::move(table), spectra.converged());
}

/// The scattering matrix: of unpolarised media its first element alone.
int write_matrix(MediaSpectra spectra, const std::vector<double>& angles_deg, const Shell& shell) {
    spectra.compute(shell.control());
    Table table;
    add_facts(table, spectra,
              "wavelength_nm: nm in vacuum; angle_deg: degrees; f11 ... f34: scattering matrix of "
              "randomly oriented particles, mean of f11 over the sphere = 1, Stokes vectors "
              "I,Q,U,V with the scattering plane as reference, f12 = f21, f43 = -f34; "
              "error_estimate: of albedo and coefficients");
    table.columns = {"wavelength_nm", "angle_deg", "f11", "f22",           "f33",
                     "f44",           "f12",       "f34", "error_estimate"};
    for (std::size_t w = 0; w < spectra.optics.size(); ++w) {
        const MediumOptics& optics = spectra.optics[w].front();
        for (const double angle : angles_deg) {
            const rte::ScatteringMatrix f =
                rte::exact_matrix(optics.optics, mie::cosine_of_scattering_angle(angle));
            table.rows.push_back({spectra.scene.wavelength_nm[w], angle, f.a1, f.a2, f.a3, f.a4,
                                  f.b1, f.b2, optics.error_estimate});
        }
    }
    return shell.write(std::move(table), spectra.converged());
}

void add_medium_options(CLI::App& command, Shell& shell, MediumArguments& arguments) {
    option(command, "medium", arguments.medium, "MEDIUM", forms_of_media())->required();
    arguments.media.add_to(command, shell, "rgb");
}

}  // namespace

void add_sphere(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<SphereArguments>();
    option(command, "--index", arguments->index, "N,K",
           "refractive index relative to the host, n + ik")
        ->required();
    option(command, "--size-parameter", arguments->size_parameters, "LIST",
           "2 pi radius / wavelength in the host, list or range")
        ->required();
    option(command, "--coating", arguments->coatings, "N,K,Y",
           "a coating: its index and the size parameter of its outer radius. Repeat it for more, "
           "from inside out")
        ->take_all();
    option(
        command, "--aspect", arguments->aspect, "A",
        "a spheroid in random orientation in place of the sphere: its equatorial axis over its "
        "axis of rotation, 0.25 to 4; size parameters are those of the sphere of the same volume");
    option(command, "--angles", arguments->angles, "LIST",
           "print the amplitudes S1, S2 at these scattering angles (degrees) instead");
    finish(command, shell, arguments, run,
           "Columns: efficiencies q_ext, q_sca, q_abs are cross-sections over that of the whole "
           "particle;\nq_back is the radar backscattering efficiency, 4 pi times the cross-section "
           "per steradian at\n180 degrees over it, |sum (2n + 1) (-1)^n (a_n - b_n)|^2 / y^2; "
           "asymmetry is <cos Theta>.\n\nExample:\n  miebrdf sphere --index 1.5,0.01 "
           "--size-parameter 1,10,100");
}

void add_optics(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<MediumArguments>();
    add_medium_options(command, shell, *arguments);
    option(command, "--moments", arguments->highest_moment, "L",
           "also print the Legendre moments chi_0 to chi_L")
        ->check(CLI::Range(0, 100000));
    shell.add_common_options(command);
    command.footer("Example:\n  miebrdf optics TiO2 --wavelengths 400:700:50 --moments 8");
    shell.on_prepare(command, [arguments, &shell]() -> Job {
        return [spectra = arguments->look_up({}), &shell] { return write_optics(spectra, shell); };
    });
}

void add_phase(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<MediumArguments>();
    add_medium_options(command, shell, *arguments);
    arguments->angles = "0:180:1";
    option(command, "--angles", arguments->angles, "LIST", "scattering angles in degrees");
    command.add_flag("--stokes", arguments->matrix,
                     "print the scattering matrix f11, f22, f33, f44, f12, f34 in place of the "
                     "phase function f11");
    shell.add_common_options(command);
    command.footer("Example:\n  miebrdf phase water --wavelengths 550 --angles 0:180:1");
    shell.on_prepare(command, [arguments, &shell]() -> Job {
        const auto angles_deg =
            parse_number_list(arguments->angles, "scattering angle (degrees)", 0.0, 180.0);
        if (arguments->matrix) {
            return [spectra = arguments->look_up({}), angles_deg, &shell] {
                return write_matrix(spectra, angles_deg, shell);
            };
        }
        return [spectra = arguments->look_up(angles_deg), &shell] {
            return write_phase(spectra, shell);
        };
    });
}

}  // namespace miebrdf::program
