// miebrdf sphere: Mie theory for single spheres.
#include <fmt/format.h>

#include "mie/sphere/amplitudes.h"
#include "mie/sphere/sphere.h"
#include "pipeline/scene/number_list.h"
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

}  // namespace miebrdf::program
