// miebrdf brdf and miebrdf albedo: a scene's reflection.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "pipeline/brdf.h"
#include "pipeline/error.h"
#include "pipeline/number_list.h"
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {
namespace {

struct BrdfArguments {
    SceneArguments scene;
    std::string mu_in;
    std::string mu_out;
    std::string azimuth = "0";
    std::string components = "total";
    std::string quantity = "brdf";
};

struct AlbedoArguments {
    SceneArguments scene;
    std::string mu_in = "0.1:1:0.1";
};

/// The part of a slice that a component name stands for.
const std::vector<double>& component_of(const SpectralSlice& slice, const std::string& name) {
    if (name == "subsurface") return slice.subsurface;
    if (name == "surface") return slice.surface;
    return slice.total;
}

std::vector<std::string> parse_components(const BrdfArguments& arguments, const Scene& scene) {
    std::vector<std::string> names = split_list(arguments.components);
    for (const std::string& name : names) {
        if (name != "total" && name != "subsurface" && name != "surface") {
            throw UsageError(fmt::format("unknown component '{}'; allowed: total, subsurface, surface", name));
        }
        if (name == "surface" && !scene.surface) {
            throw UsageError("component 'surface' needs a surface; give --roughness, e.g. 0.3");
        }
    }
    return names;
}

/// What the output says about how it was computed.
template <typename Result>
void add_facts(Table& table, const Result& result, const Request& request, const std::string& units) {
    table.facts.emplace_back("units", units);
    for (const std::string& source : result.sources) table.facts.emplace_back("source", source);
    table.facts.emplace_back("tolerance", fmt::format("{}", request.solver.tolerance));
    table.facts.emplace_back("error_estimate", fmt::format("{:.2e}", result.error_estimate));
    int streams = 0, orders = 0, moments = 0;
    for (const auto& slice : result.slices) {
        streams = std::max(streams, slice.report.streams);
        orders = std::max(orders, slice.report.azimuthal_orders);
        moments = std::max(moments, slice.report.moments);
    }
    table.facts.emplace_back("method",
                             fmt::format("{}; {} streams, {} moments, {} azimuthal orders",
                                         result.slices.front().report.method, streams, moments, orders));
    for (const auto& slice : result.slices) {
        if (slice.converged) continue;
        table.facts.emplace_back("not converged", fmt::format("{} nm: error estimate {:.2e}",
                                                              slice.wavelength_nm, slice.error_estimate));
    }
}

int run_brdf(const BrdfArguments& arguments, const Shell& shell) {
    Request request = arguments.scene.parse();
    request.directions.mu_in = parse_number_list(arguments.mu_in, "mu_in", 0.0, 1.0, true);
    request.directions.mu_out = parse_number_list(arguments.mu_out, "mu_out", 0.0, 1.0, true);
    request.directions.azimuth_deg =
        parse_number_list(arguments.azimuth, "azimuth (degrees)", -360.0, 360.0);
    const auto components = parse_components(arguments, request.scene);
    if (arguments.quantity != "brdf" && arguments.quantity != "reflection") {
        throw UsageError(fmt::format("unknown quantity '{}'; allowed: brdf, reflection", arguments.quantity));
    }
    const bool as_reflection = arguments.quantity == "reflection";
    const double factor = as_reflection ? std::numbers::pi : 1.0;
    const BrdfResult result = compute_brdf(request, shell.control());

    Table table;
    add_facts(table, result, request,
              std::string("wavelength_nm: nm in vacuum; mu: cosine from the normal; azimuth_deg: 0 = "
                          "mirror side, 180 = towards the source; ") +
                  (as_reflection ? "reflection: pi times the BRDF, 1 for white Lambertian"
                                 : "brdf: 1/sr, cosine not included"));
    table.columns = {"wavelength_nm", "mu_in", "mu_out", "azimuth_deg"};
    for (const std::string& name : components) {
        table.columns.push_back(components.size() == 1 ? arguments.quantity
                                                       : arguments.quantity + "_" + name);
    }
    const rte::Directions& d = request.directions;
    for (const SpectralSlice& slice : result.slices) {
        std::size_t index = 0;
        for (const double mu_in : d.mu_in) {
            for (const double mu_out : d.mu_out) {
                for (const double azimuth_deg : d.azimuth_deg) {
                    std::vector<Cell> row = {slice.wavelength_nm, mu_in, mu_out, azimuth_deg};
                    for (const std::string& name : components) {
                        row.emplace_back(factor * component_of(slice, name)[index]);
                    }
                    table.rows.push_back(std::move(row));
                    ++index;
                }
            }
        }
    }
    shell.write(std::move(table));
    return result.converged ? kGood : kNotConverged;
}

int run_albedo(const AlbedoArguments& arguments, const Shell& shell) {
    Request request = arguments.scene.parse();
    request.directions.mu_in = parse_number_list(arguments.mu_in, "mu_in", 0.0, 1.0, true);
    const AlbedoResult result = compute_albedo(request, shell.control());
    Table table;
    add_facts(table, result, request,
              "wavelength_nm: nm in vacuum; mu_in: cosine from the normal; albedos dimensionless");
    table.columns = {"wavelength_nm", "mu_in", "plane_albedo", "spherical_albedo"};
    for (const AlbedoSlice& slice : result.slices) {
        for (std::size_t i = 0; i < slice.plane_albedo.size(); ++i) {
            table.rows.push_back({slice.wavelength_nm, request.directions.mu_in[i],
                                  slice.plane_albedo[i], slice.spherical_albedo});
        }
    }
    shell.write(std::move(table));
    return result.converged ? kGood : kNotConverged;
}

}  // namespace

void add_brdf_command(CLI::App& program, Shell& shell) {
    auto* command = program.add_subcommand("brdf", "the spectral BRDF of a coated, rough material");
    auto arguments = std::make_shared<BrdfArguments>();
    arguments->scene.add_to(*command);
    command->add_option("--mu-in", arguments->mu_in, "cosines of incidence, in (0, 1]")
        ->type_name("LIST")
        ->required();
    command->add_option("--mu-out", arguments->mu_out, "cosines of reflection, in (0, 1]")
        ->type_name("LIST")
        ->required();
    command->add_option("--azimuth", arguments->azimuth,
                        "degrees; 0 = mirror side, 180 = back towards the source")
        ->type_name("LIST")
        ->capture_default_str();
    command->add_option("--component", arguments->components,
                        "total, subsurface, surface; several give a column each")
        ->type_name("LIST")
        ->capture_default_str();
    command->add_option("--quantity", arguments->quantity, "brdf (1/sr) or reflection (pi times it)")
        ->capture_default_str();
    shell.add_common_options(*command);
    command->footer(
        "Example:\n  miebrdf brdf --base TiO2 --coat AlGaAs7@0.1 --roughness 0.3 --wavelengths "
        "400:700:10 --mu-in 0.5,1 --mu-out 0.1:1:0.1 --azimuth 0,90,180");
    shell.on_run(*command, [arguments, &shell] { return run_brdf(*arguments, shell); });
}

void add_albedo_command(CLI::App& program, Shell& shell) {
    auto* command = program.add_subcommand("albedo", "plane and spherical albedo of a scene");
    auto arguments = std::make_shared<AlbedoArguments>();
    arguments->scene.add_to(*command);
    command->add_option("--mu-in", arguments->mu_in, "cosines of incidence, in (0, 1]")
        ->type_name("LIST")
        ->capture_default_str();
    shell.add_common_options(*command);
    command->footer("Example:\n  miebrdf albedo --base TiO2 --coat AlGaAs7@0.1 --wavelengths 400:700:50");
    shell.on_run(*command, [arguments, &shell] { return run_albedo(*arguments, shell); });
}

}  // namespace miebrdf::program
