// miebrdf brdf and miebrdf albedo: a scene's reflection.
#include <fmt/format.h>

#include <numbers>

#include "pipeline/solve/brdf.h"
#include "tools/miebrdf/albedo_colour.h"
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/reflection_options.h"

namespace miebrdf::program {
namespace {

/// The part of a slice that a component name stands for.
const std::vector<double>& component_of(const SpectralSlice& slice, const std::string& name) {
    if (name == "subsurface") return slice.subsurface;
    if (name == "surface") return slice.surface;
    return slice.total;
}

Cell cell_of(const std::optional<double>& value) { return value ? Cell(*value) : Cell(); }

/// What a slice says about itself, without its physics.
template <typename Slice>
std::vector<Cell> report_row(const Slice& slice) {
    const rte::SolverReport& report = slice.report;
    return {slice.wavelength_nm,       slice.converged ? std::string("yes") : std::string("no"),
            slice.error_estimate,      slice.mie_error_estimate,
            slice.phase_noise.largest, double(report.streams),
            double(report.moments),    double(report.fourier_orders)};
}

const std::vector<std::string> kReportColumns = {
    "wavelength_nm", "converged", "error_estimate", "mie_error_estimate",
    "phase_noise",   "streams",   "moments",        "azimuthal_orders"};

void add_report(Table& table, const BrdfResult& result) {
    table.report_columns = kReportColumns;
    table.report_columns.insert(table.report_columns.end(),
                                {"layers_reciprocity_defect", "layers_largest_albedo",
                                 "reciprocity_defect", "largest_albedo", "least_value"});
    for (const SpectralSlice& slice : result.slices) {
        std::vector<Cell>& row = table.report.emplace_back(report_row(slice));
        row.push_back(cell_of(slice.layers_physics.reciprocity_defect));
        row.push_back(cell_of(slice.layers_physics.largest_albedo));
        row.push_back(cell_of(slice.physics.reciprocity_defect));
        row.push_back(cell_of(slice.physics.largest_albedo));
        row.emplace_back(slice.physics.least_value);
    }
}

void add_report(Table& table, const AlbedoResult& result) {
    table.report_columns = kReportColumns;
    for (const AlbedoSlice& slice : result.slices) table.report.push_back(report_row(slice));
}

/// What missed the tolerance, and where: often one corner of the hemisphere, not the whole.
template <typename Slice>
std::string shortfall(const Slice& slice) {
    std::string text =
        fmt::format("{} nm: error estimate {:.2e}", slice.wavelength_nm, slice.error_estimate);
    const rte::SolverReport& report = slice.report;
    if (report.worst_mu_out > 0.0) {
        text += fmt::format(
            " at mu_in {}, mu_out {}, azimuth {}; {:.4g} % of the values are within "
            "the tolerance",
            report.worst_mu_in, report.worst_mu_out, report.worst_azimuth_deg,
            100.0 * report.share_within_tolerance);
    }
    return text;
}

/// What the output says about how it was computed.
template <typename Result>
void add_facts(Table& table, const Result& result, const Request& request,
               const std::string& units) {
    table.facts.emplace_back("units", units);
    for (const std::string& source : result.sources) table.facts.emplace_back("source", source);
    if (const std::string particles = describe_particles(request.scene); !particles.empty())
        table.facts.emplace_back("particles", particles);
    table.facts.emplace_back("tolerance", request.solver.tolerance);
    table.facts.emplace_back("error_estimate", rounded(result.error_estimate, 3));
    const PhaseNoise& noise = result.phase_noise;
    if (noise.largest > 0.1 * request.solver.tolerance) {
        table.facts.emplace_back(
            "phase_noise",
            fmt::format(
                "{:.2e} at most, of single directions (rms, relative like error_estimate and "
                "not in it), at {} nm, mu_in {}, mu_out {}, azimuth {}; from the number of sphere "
                "sizes; a smaller --tolerance lowers it",
                noise.largest, result.phase_noise_wavelength_nm, noise.mu_in, noise.mu_out,
                noise.azimuth_deg));
    }
    table.facts.emplace_back("method", result.slices.front().report.method);
    for (const auto& slice : result.slices) {
        if (slice.converged) continue;
        table.facts.emplace_back("not converged", shortfall(slice));
    }
    add_report(table, result);
}

void add_rows(Table& table, const SpectralSlice& slice, const rte::Directions& d,
              const std::vector<std::string>& components, double factor) {
    std::size_t index = 0;
    for (const double mu_in : d.mu_in) {
        for (const double mu_out : d.mu_out) {
            for (const double azimuth_deg : d.azimuth_deg) {
                auto& row = table.rows.emplace_back(
                    std::vector<Cell>{slice.wavelength_nm, mu_in, mu_out, azimuth_deg});
                for (const std::string& name : components) {
                    row.emplace_back(factor * component_of(slice, name)[index]);
                }
                ++index;
            }
        }
    }
}

int run_brdf(const BrdfArguments& arguments, const Shell& shell) {
    const Request request = arguments.parse();
    const bool as_reflection = arguments.quantity() == "reflection";
    const BrdfResult result = compute_brdf(request, shell.control());

    Table table;
    add_facts(
        table, result, request,
        std::string("wavelength_nm: nm in vacuum; mu: cosine from the normal; azimuth_deg: 0 = "
                    "mirror side, 180 = towards the source; ") +
            (as_reflection ? "reflection: pi times the BRDF, 1 for white Lambertian"
                           : "brdf: 1/sr, cosine not included"));
    table.columns = {"wavelength_nm", "mu_in", "mu_out", "azimuth_deg"};
    const std::vector<std::string> components = arguments.components();
    for (const std::string& name : components) {
        table.columns.push_back(components.size() == 1 ? arguments.quantity()
                                                       : arguments.quantity() + "_" + name);
    }
    for (const SpectralSlice& slice : result.slices) {
        add_rows(table, slice, request.directions, components,
                 as_reflection ? std::numbers::pi : 1.0);
    }
    shell.write(std::move(table));
    return result.converged ? kGood : kNotConverged;
}

int run_albedo(const AlbedoArguments& arguments, const Shell& shell) {
    const Request request = arguments.parse();
    const AlbedoResult result = compute_albedo(request, shell.control());
    Table table;
    if (const auto illuminant = arguments.illuminant()) {
        add_facts(table, result, request,
                  "mu_in: cosine from the normal; x, y, z: white of the illuminant has y = 1; lab: "
                  "CIE 1976, white 100, 0, 0; srgb: encoded, not clipped");
        add_colours(table, result, request.directions.mu_in, *illuminant);
        shell.write(std::move(table));
        return result.converged ? kGood : kNotConverged;
    }
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

/// A command whose options are `Arguments`.
template <typename Arguments>
void add_command(CLI::App& program, Shell& shell, const char* name, const char* description,
                 const char* example, int (*run)(const Arguments&, const Shell&)) {
    auto* command = program.add_subcommand(name, description);
    auto arguments = std::make_shared<Arguments>();
    arguments->add_to(*command);
    shell.add_common_options(*command);
    command->footer(std::string("Example:\n  ") + example);
    shell.on_run(*command, [arguments, run, &shell] { return run(*arguments, shell); });
}

}  // namespace

void add_brdf_command(CLI::App& program, Shell& shell) {
    add_command<BrdfArguments>(
        program, shell, "brdf", "the spectral BRDF of a coated, rough material",
        "miebrdf brdf --base TiO2 --coat AlGaAs7@0.1 --roughness 0.3 --wavelengths 400:700:10 "
        "--mu-in 0.5,1 --mu-out 0.1:1:0.1 --azimuth 0,90,180",
        run_brdf);
}

void add_albedo_command(CLI::App& program, Shell& shell) {
    add_command<AlbedoArguments>(
        program, shell, "albedo", "plane and spherical albedo of a scene",
        "miebrdf albedo --base TiO2 --coat AlGaAs7@0.1 --wavelengths 400:700:50", run_albedo);
}

}  // namespace miebrdf::program
